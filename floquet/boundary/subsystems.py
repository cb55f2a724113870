"""The independent subsystems of any linear periodic system: which there are, and how one moves over a period.

Systems of eq. (11), with periodic stiffness alone, have an integrator of their own in `floquet.oracle`; all others take
that of `floquet.oracle.general`. What the rest of the room needs of a subsystem both have: ``to_q``, ``from_q``,
``reciprocal`` and ``form``.
"""

from __future__ import annotations

import numpy as np

from floquet.oracle import Subsystem, constant_matrix, period_map, propagate, reduce_system, steps_of_period
from floquet.oracle.general import GeneralSubsystem, passage, period_matrix, split
from periodic import AnySystem, has_stiffness_alone
from periodic.checks import ComplexArray, FloatArray

# Tolerance of the integration, relative to the norm of the matrix. The series cost little more than at 1e-11, and an
# edge is only as good as the multipliers.
TRACING_TOLERANCE = 1e-13

AnySubsystem = Subsystem | GeneralSubsystem


def subsystems_at(system: AnySystem, Omega: float, eps: float, slowest: float) -> list[AnySubsystem]:
    """Return the subsystems at a point; ``slowest`` is the scale of coordinates without stiffness (`reduce_system`)."""
    if has_stiffness_alone(system):
        return list(reduce_system(system, eps, slowest))
    return list(split(system, Omega, eps).subsystems)


def free_subsystems(system: AnySystem, Omega: float) -> list[AnySubsystem]:
    """Return the subsystems into which the excited system splits, for a look at them without excitation."""
    # of eq. (11) at any amplitude but zero: at zero each mode is a subsystem
    return subsystems_at(system, Omega, float(has_stiffness_alone(system)), Omega / (2 * np.pi))


def home(subsystems: list[AnySubsystem], solution: ComplexArray) -> AnySubsystem:
    """Return the subsystem that a solution, a state (S,), belongs to."""
    return max(subsystems, key=lambda subsystem: float(np.linalg.norm(subsystem.from_q @ solution)))


def free_matrix(subsystem: AnySubsystem) -> FloatArray:
    """Return the matrix A (N, N) of y' = A y without excitation."""
    if isinstance(subsystem, Subsystem):
        return constant_matrix(subsystem.equations)
    return subsystem.coefficients.constant


def is_stepwise(subsystem: AnySubsystem) -> bool:
    """Return whether a subsystem is constant between jumps."""
    return isinstance(subsystem, GeneralSubsystem) and subsystem.coefficients.is_constant_between_jumps


def monodromy_matrix(subsystem: AnySubsystem, Omega: float, eps: float) -> FloatArray:
    """Return the monodromy matrix (N, N) in y.

    Raises
    ------
    ValueError
        If the solution overflows or the integration would take too long.
    """
    if isinstance(subsystem, GeneralSubsystem):
        return period_matrix(subsystem, Omega, eps)
    start = np.eye(len(subsystem.from_q))
    return propagate(subsystem, Omega, eps, steps_of_period(subsystem, Omega), TRACING_TOLERANCE, start)


def monodromy_error(subsystem: AnySubsystem, Omega: float, eps: float) -> float:
    """Return the measured error of `monodromy_matrix`."""
    if isinstance(subsystem, GeneralSubsystem):
        better = passage(subsystem, Omega, eps, TRACING_TOLERANCE).map
        return better.error + float(np.linalg.norm(period_matrix(subsystem, Omega, eps) - better.matrix))
    return float(period_map(subsystem, Omega, eps, TRACING_TOLERANCE, halvings=0).error)
