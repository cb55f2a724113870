"""The monodromy matrix at one point (Omega, eps): plain, accurate, and with its error."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property, lru_cache, partial
from typing import NamedTuple

import numpy as np

from floquet.kind import Kind
from floquet.oracle.factors import accurate_multipliers
from floquet.oracle.frozen import short_form
from floquet.oracle.general import multipliers_of, passage, split
from floquet.oracle.multipliers import Spectrum, by_modulus, combine, spectrum
from floquet.oracle.period import MATRIX_TOLERANCE, period_map, propagate, steps_of_period
from floquet.oracle.products import ProductEigenvalues
from floquet.oracle.reduction import Subsystem, reduce_system, rigid_basis
from periodic import AnyFamily, AnySystem, PeriodicSystem, any_member_at
from periodic.checks import ComplexArray, FloatArray, real_number

# Smallest and largest relative error of the matrix that may be asked for.
MIN_MATRIX_TOLERANCE, MAX_MATRIX_TOLERANCE = 1e-15, 1e-3
# Relative error of a multiplier above which the period is integrated once more, in parts.
MULTIPLIER_TOLERANCE = 1e-8
# A quick look takes the error of the matrix, relative to its norm, to be this many times what the series aim at.
QUICK_ERROR_FACTOR = 10


class _Solved(NamedTuple):
    """One subsystem at one point: what is known of its multipliers, and how to find them more accurately."""

    spectrum: Spectrum
    reciprocal: bool
    again: Callable[[], ProductEigenvalues]


class _Period(NamedTuple):
    """A whole system over one period: the matrix, the norm of its error, the subsystems, the count of rigid motions."""

    matrix: FloatArray
    error: float
    solved: tuple[_Solved, ...]
    rigid: int


@dataclass(frozen=True, eq=False)
class Monodromy:
    """The monodromy matrix of a system at one (Omega, eps), its multipliers and the verdict.

    Attributes
    ----------
    matrix : ndarray, shape (2n, 2n)
        Phi(T), T = 2 pi / Omega, in the coordinates q = (W', W) of eq. (13), from just after t = 0; of a first-order
        system (n, n), in its states.
    growth_rate : float
        max log|mu| / T without rigid motions, per unit of time; 0 for a stable conservative system.
    error : float
        Estimated spectral norm of the error of ``matrix``, divided by max(1, norm of ``matrix``).
    log_modulus_error : float
        Estimated error of max log|mu| = growth_rate T; near a double multiplier it is of the order of the square root
        of ``error``.
    kind : Kind
        Stable, unstable through a multiplier near +1, near -1 or a complex pair, or undecided. Rigid motions are not
        judged.
    rigid : int
        Number of rigid motions: no stiffness, damping or gyroscopic matrix acts on them and the excitation never
        touches them, as on the common rotation of a drivetrain with free ends. Such a motion drifts linearly for ever,
        with a double multiplier 1. That is no instability of the excitation, so the verdict is about all other motions.
    """

    matrix: FloatArray
    growth_rate: float
    error: float
    log_modulus_error: float
    kind: Kind
    rigid: int
    _solved: tuple[_Solved, ...] = field(repr=False)

    @property
    def multipliers(self) -> ComplexArray:
        """The multipliers by decreasing modulus, small ones as right as large ones (complex ndarray).

        They are as many as ``matrix`` has rows. Those of a stable conservative or reversible system are on the unit
        circle. Each rigid motion has 1 twice. A multiplier too small for float64 is 0. If the eigenvalues of ``matrix``
        are not accurate enough, the period is integrated once more, in parts, when multipliers or their errors are
        first asked for.
        """
        return self._multipliers[0]

    @property
    def multiplier_errors(self) -> FloatArray:
        """Estimated errors of ``multipliers`` relative to their moduli, shape (2n,).

        They are below 1e-8, unless multipliers are so close to each other that an error of the motion makes them meet,
        or growth and decay within the period exceed what float64 can hold.
        """
        return self._multipliers[1]

    @cached_property
    def _multipliers(self) -> tuple[ComplexArray, FloatArray]:
        found = [(np.ones(2 * self.rigid, complex), np.zeros(2 * self.rigid))]
        found += [_multipliers(solved) for solved in self._solved]
        mu, errors = (np.concatenate(arrays) for arrays in zip(*found, strict=True))
        order = by_modulus(mu)
        result = mu[order], errors[order]
        for array in result:
            array.setflags(write=False)
        return result


def monodromy(system: AnyFamily, Omega: float, eps: float, *, tolerance: float = MATRIX_TOLERANCE) -> Monodromy:
    """Integrate a periodic system over one period.

    Parameters
    ----------
    system : PeriodicSystem, FirstOrderSystem or SystemFamily
        The system, or a family, of which the member at ``Omega`` is taken.
    Omega : float
        Excitation frequency, > 0.
    eps : float
        Excitation amplitude, any sign.
    tolerance : float
        Wanted error of the matrix relative to max(1, its norm), between 1e-15 and 1e-3. Rounding may not allow it:
        ``Monodromy.error`` tells what was achieved.

    Returns
    -------
    Monodromy

    Raises
    ------
    ValueError
        If an argument is of the wrong type, not finite or out of range; if the solution grows by more than a factor of
        1e150 in one period; if the period is so long that the integration would take more than five minutes; if the
        mass matrix becomes singular within the period.

    Notes
    -----
    The solution is a Taylor series in each of many steps of equal length (`floquet.oracle.taylor`), with as many terms
    as the step needs. The error estimate has two parts: the difference from eight random solutions that are integrated
    once more with half the step, and what rounding in each part of the period amounts to at its end. The second part
    is there because two integrations may agree by chance. Nothing is shared with `stability_chart`.

    Systems with other terms than harmonics of the stiffness are integrated from jump to jump, by Taylor series or,
    where all is constant, by exponentials. Where the mass jumps, the momentum M W' goes on.
    """
    Omega = real_number("Omega", Omega, positive=True)
    eps = real_number("eps", eps)
    tolerance = real_number("tolerance", tolerance, positive=True)
    if not MIN_MATRIX_TOLERANCE <= tolerance <= MAX_MATRIX_TOLERANCE:
        raise ValueError(
            f"tolerance = {tolerance!r} is out of range; "
            f"give a number from {MIN_MATRIX_TOLERANCE:.0e} to {MAX_MATRIX_TOLERANCE:.0e}"
        )
    member = any_member_at(system, Omega)
    plain = short_form(member, eps)
    period = _general(member, Omega, eps, tolerance) if plain is None else _stiffness(plain, Omega, eps, tolerance)
    joint = combine([one.spectrum for one in period.solved])
    error = period.error / max(1.0, float(np.linalg.norm(period.matrix, 2)))
    period.matrix.setflags(write=False)
    growth_rate = joint.log_modulus * Omega / (2 * np.pi)
    return Monodromy(period.matrix, growth_rate, error, joint.error, joint.kind, period.rigid, period.solved)


def _stiffness(system: PeriodicSystem, Omega: float, eps: float, tolerance: float) -> _Period:
    """Integrate a system with periodic stiffness alone, eq. (11)."""
    subsystems = reduce_system(system, eps, Omega / (2 * np.pi))
    rigid = rigid_basis(system, eps)
    matrix = _drift(system, rigid, Omega)
    errors, solved = [], []
    for subsystem in subsystems:
        found = period_map(subsystem, Omega, eps, tolerance)
        matrix += subsystem.to_q @ found.matrix @ subsystem.from_q
        errors.append(found.error_in_q)
        again = partial(accurate_multipliers, subsystem, Omega, eps, MULTIPLIER_TOLERANCE)
        solved.append(_Solved(_spectrum(subsystem, found.matrix, found.error), subsystem.reciprocal, again))
    return _Period(matrix, float(np.linalg.norm(errors)), tuple(solved), rigid.shape[1])


def _general(system: AnySystem, Omega: float, eps: float, tolerance: float) -> _Period:
    """Integrate any system."""
    subsystems, rigid = split(system, Omega, eps)
    matrix = _drift(system, rigid, Omega) if isinstance(system, PeriodicSystem) else np.zeros_like(system.constant)
    errors, solved = [], []
    for subsystem in subsystems:
        found = passage(subsystem, Omega, eps, tolerance)
        matrix += subsystem.to_q @ found.map.matrix @ subsystem.from_q
        errors.append(found.map.error_in_q)
        judged = spectrum(found.map.matrix, found.map.error, reciprocal=subsystem.reciprocal, form=subsystem.form)
        again = partial(multipliers_of, found, subsystem.coefficients.unknown)
        solved.append(_Solved(judged, subsystem.reciprocal, again))
    return _Period(matrix, float(np.linalg.norm(errors)), tuple(solved), rigid.shape[1])


def _drift(system: PeriodicSystem, rigid: FloatArray, Omega: float) -> FloatArray:
    """Return the part of the monodromy matrix of the rigid motions (n, r)."""
    still = rigid @ rigid.T @ system.mass
    return np.block([[still, np.zeros_like(still)], [2 * np.pi / Omega * still, still]])


def is_unstable(family: AnyFamily, Omega: float, eps: float, modes: int = 0) -> bool:
    """Return whether integration finds instability at a point.

    This costs less than half of `monodromy`: it takes the same series, but believes them to be as accurate as they aim
    to be, and stops at the first unstable subsystem. It looks first at the subsystem with as many coordinates as
    ``modes`` says.
    """
    member = any_member_at(family, Omega)
    plain = short_form(member, eps)
    if plain is None:
        return monodromy(member, Omega, eps).kind > Kind.STABLE
    subsystems = _scaled_subsystems(plain, Omega, eps)
    for subsystem in sorted(subsystems, key=lambda subsystem: abs(len(subsystem.equations.w) - modes)):
        start = np.eye(2 * len(subsystem.equations.w))
        Phi = propagate(subsystem, Omega, eps, steps_of_period(subsystem, Omega), MATRIX_TOLERANCE, start)
        error = QUICK_ERROR_FACTOR * MATRIX_TOLERANCE * max(1.0, float(np.linalg.norm(Phi, 2)))
        if _spectrum(subsystem, Phi, error).kind > Kind.STABLE:
            return True
    return False


def _spectrum(subsystem: Subsystem, Phi: FloatArray, error: float) -> Spectrum:
    return spectrum(Phi, error, reciprocal=subsystem.reciprocal, bounded=subsystem.bounded, form=subsystem.form)


def _multipliers(solved: _Solved) -> tuple[ComplexArray, FloatArray]:
    """Return the multipliers of one subsystem and their relative errors; from parts of the period if that is better."""
    known = solved.spectrum
    if known.errors.max() <= MULTIPLIER_TOLERANCE:
        return known.multipliers, known.errors
    found = solved.again()
    if found.errors.max() > known.errors.max():
        return known.multipliers, known.errors
    on_circle = solved.reciprocal and known.kind == Kind.STABLE
    return found.values / np.abs(found.values) if on_circle else found.values, found.errors


@lru_cache(maxsize=16)
def _reduced(system: PeriodicSystem, eps: float, slowest: float) -> list[Subsystem]:
    return reduce_system(system, eps, slowest)


def _scaled_subsystems(system: PeriodicSystem, Omega: float, eps: float) -> list[Subsystem]:
    """Return the subsystems at ``eps``, scaled from those at the next power of two above it.

    So a search over many points reduces the system only a few times. Scales and bounds are those of the power of two,
    an amplitude at least as large.
    """
    above = float(np.copysign(2.0 ** np.ceil(np.log2(abs(eps))), eps)) if eps else 0.0
    scale = eps / above if above else 1.0
    subsystems = []
    for subsystem in _reduced(system, above, 2.0 ** np.floor(np.log2(Omega / (2 * np.pi)))):
        alpha = np.column_stack([subsystem.equations.alpha[:, :1], scale * subsystem.equations.alpha[:, 1:]])
        equations = subsystem.equations._replace(alpha=alpha, beta=scale * subsystem.equations.beta)
        subsystems.append(subsystem._replace(equations=equations))
    return subsystems
