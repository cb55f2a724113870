"""The Floquet solutions of one subsystem at one point: multipliers, initial values, and how far they can be wrong."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from floquet.boundary.subsystems import (
    TRACING_TOLERANCE,
    AnySubsystem,
    home,
    is_stepwise,
    monodromy_error,
    monodromy_matrix,
    subsystems_at,
)
from floquet.oracle import eigensystem
from periodic import AnyFamily, AnySystem
from periodic.checks import ComplexArray, FloatArray

# Errors of the matrix where they have not been measured, in the same unit: ten times what is aimed at.
ASSUMED_ERROR = 10 * TRACING_TOLERANCE
# A multiplier is off the unit circle if it is so by this many of its errors.
CLEAR_ERRORS = 10.0
# Solutions at so many points are kept: those of one search.
MAX_KEPT_POINTS = 64


class OutOfReachError(Exception):
    """Nothing can be integrated at this point (no frequency, or growth beyond all bounds), or a pair is lost there."""


class Solutions(NamedTuple):
    """The N Floquet solutions of a subsystem.

    Attributes
    ----------
    Omega, eps : float
        The point.
    multipliers : ndarray of complex, shape (N,)
    vectors : ndarray of complex, shape (N, N)
        Their initial values in energy coordinates, normalised, in columns.
    sensitivity : ndarray, shape (N,)
        Error of log mu for an error 1 of the monodromy matrix, to first order.
    error : float
        Error of the monodromy matrix (spectral norm), assumed or measured.
    subsystem : Subsystem or GeneralSubsystem
    """

    Omega: float
    eps: float
    multipliers: ComplexArray
    vectors: ComplexArray
    sensitivity: FloatArray
    error: float
    subsystem: AnySubsystem

    @property
    def growth(self) -> FloatArray:
        """log|mu| of each solution, 0 where it is not off the unit circle by more than its error, shape (N,)."""
        with np.errstate(divide="ignore"):
            growth = np.log(np.abs(self.multipliers))
        return np.where(np.abs(growth) > CLEAR_ERRORS * self.sensitivity * self.error, growth, 0.0)

    def initial(self, members: list[int]) -> ComplexArray:
        """Return the initial values of some solutions as states, (W', W) or x, shape (S, count)."""
        return np.asarray(self.subsystem.to_q @ self.vectors[:, members])


class Integrator:
    """Integrates the subsystem that a given solution belongs to, wherever it is asked.

    Parameters
    ----------
    family : AnyFamily
    solution : ndarray, shape (S,)
        A state: (W', W), or x of a first-order system.
    slowest : float
        Scale of coordinates without stiffness, as in `reduce_system`.
    """

    def __init__(self, family: AnyFamily, solution: ComplexArray, slowest: float) -> None:
        self.family, self.solution, self.slowest = family, solution, slowest
        self._latest: tuple[AnySystem, float, AnySubsystem] | None = None
        self._kept: dict[tuple[float, float], Solutions] = {}

    def at(self, Omega: float, eps: float) -> Solutions:
        """Return the solutions at a point.

        Raises
        ------
        OutOfReachError
            If there are none.
        """
        if (Omega, eps) not in self._kept:
            subsystem = self._subsystem(Omega, eps)
            try:
                Phi = monodromy_matrix(subsystem, Omega, eps)
            except ValueError as beyond:
                raise OutOfReachError from beyond
            if len(self._kept) == MAX_KEPT_POINTS:
                self._kept.pop(next(iter(self._kept)))
            error = ASSUMED_ERROR * max(1.0, float(np.linalg.norm(Phi)))
            self._kept[Omega, eps] = _solutions(Omega, eps, Phi, error, subsystem)
        return self._kept[Omega, eps]

    def is_exact(self, Omega: float, eps: float) -> bool:
        """Return whether the subsystem is constant between jumps, so that its integration is exact but for rounding."""
        return is_stepwise(self._subsystem(Omega, eps))

    def error(self, Omega: float, eps: float) -> float:
        """Return the measured error of the monodromy matrix at a point that `at` has reached."""
        return monodromy_error(self._subsystem(Omega, eps), Omega, eps)

    def _subsystem(self, Omega: float, eps: float) -> AnySubsystem:
        """Return the subsystem at a point; reduced anew only if the system or eps has changed."""
        if Omega <= 0:
            raise OutOfReachError
        member = self.family.at(Omega)
        if self._latest is None or self._latest[0] is not member or self._latest[1] != eps:
            subsystems = subsystems_at(member, Omega, eps, self.slowest)
            self._latest = (member, eps, home(subsystems, self.solution))
        return self._latest[2]


def _solutions(Omega: float, eps: float, Phi: FloatArray, error: float, subsystem: AnySubsystem) -> Solutions:
    mu, left, right = eigensystem(Phi)
    with np.errstate(divide="ignore"):
        sensitivity = 1 / np.abs(np.einsum("ij,ij->j", left.conj(), right)) / np.abs(mu)
    return Solutions(Omega, eps, mu, right, sensitivity, error, subsystem)
