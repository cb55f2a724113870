"""The Floquet solutions of a system at the places of one period, from the oracle's factors."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy.linalg as sla
from numpy.typing import NDArray

from floquet.modes.places import Places, places_for
from floquet.oracle import (
    GeneralSubsystem,
    ProductSolutions,
    factors_between,
    largest_rate,
    product_solutions,
    split,
)
from periodic import AnySystem, PeriodicSystem
from periodic.checks import ComplexArray, FloatArray


class Pieces(NamedTuple):
    """A system at one point, in independent subsystems, beside its rigid motions R (n, r), R^T M R = I."""

    system: AnySystem
    Omega: float
    eps: float
    subsystems: list[GeneralSubsystem]
    rigid: FloatArray

    @property
    def states(self) -> int:
        """Number of states, rigid motions included."""
        return self.system.size * (2 if isinstance(self.system, PeriodicSystem) else 1)

    @property
    def period(self) -> float:
        """T = 2 pi / Omega."""
        return 2 * np.pi / self.Omega

    def factors(self, phases: FloatArray) -> FloatArray:
        """Return the matrices (p, S, S) that take the state from each of the phases (p + 1,) to the next."""
        found = np.zeros((len(phases) - 1, self.states, self.states))
        for subsystem in self.subsystems:
            matrices = factors_between(subsystem, self.Omega, self.eps, phases).matrices
            found += subsystem.to_q @ matrices @ subsystem.from_q
        if self.rigid.size:
            still = self.rigid @ self.rigid.T @ self.system.mass  # type: ignore[union-attr]
            n = len(still)
            found[:, :n, :n] += still
            found[:, n:, n:] += still
            found[:, n:, :n] += (np.diff(phases) * self.period)[:, None, None] * still
        return found


def pieces_of(system: AnySystem, Omega: float, eps: float) -> Pieces:
    """Return the independent subsystems of a member."""
    subsystems, rigid = split(system, Omega, eps)
    return Pieces(system, Omega, eps, subsystems, rigid)


class Solutions(NamedTuple):
    """The Floquet solutions of a system, N of them, at p phases of a cycle.

    Attributes
    ----------
    log_values : ndarray of complex, shape (N,)
        Logarithms of the multipliers.
    errors : ndarray, shape (N,)
        Their estimated errors.
    right : ndarray of complex, shape (p, S, N)
        The solutions at each phase, in the state.
    left : ndarray of complex, shape (p, N, S)
        left[k] @ right[k] = 1.
    logs : ndarray, shape (p, N)
        Solutions at the next phase are exp(logs[k]) times those that `right` has there,
    closing : ndarray of complex, shape (N, N)
        and at the end those at the beginning times ``closing``.
    clusters : tuple of tuple of int
        Numbers of solutions that cannot be told apart.
    subsystem : ndarray of int, shape (N,)
        Number of the subsystem of each solution.
    """

    log_values: ComplexArray
    errors: FloatArray
    right: ComplexArray
    left: ComplexArray
    logs: FloatArray
    closing: ComplexArray
    clusters: tuple[tuple[int, ...], ...]
    subsystem: NDArray[np.intp]

    @property
    def begun(self) -> FloatArray:
        """Logarithm of the growth from the first phase to each, shape (p, N)."""
        return np.vstack([np.zeros(self.logs.shape[1]), np.cumsum(self.logs, axis=0)[:-1]])


def solutions_at(pieces: Pieces, phases: FloatArray) -> Solutions:
    """Return the Floquet solutions at ``phases`` (p + 1,), the last of which is the first, one period later."""
    found: list[tuple[GeneralSubsystem, ProductSolutions]] = []
    for subsystem in pieces.subsystems:
        parts = factors_between(subsystem, pieces.Omega, pieces.eps, phases)
        found.append((subsystem, product_solutions(*parts)))
    if not found:
        p, S = len(phases) - 1, pieces.states
        empty = np.zeros(0)
        return Solutions(
            empty.astype(complex), empty, np.zeros((p, S, 0), complex), np.zeros((p, 0, S), complex),
            np.zeros((p, 0)), np.zeros((0, 0), complex), (), np.zeros(0, dtype=np.intp),
        )  # fmt: skip
    starts = np.cumsum([0, *(len(one.errors) for _, one in found)]).tolist()
    return Solutions(
        np.concatenate([_settled(subsystem, one) for subsystem, one in found]),
        np.concatenate([one.errors for _, one in found]),
        np.concatenate([subsystem.to_q @ one.right for subsystem, one in found], axis=2),
        np.concatenate([one.left @ subsystem.from_q for subsystem, one in found], axis=1),
        np.concatenate([one.logs for _, one in found], axis=1),
        sla.block_diag(*(one.closing for _, one in found)),
        tuple(
            tuple(start + i for i in cluster)
            for start, (_, one) in zip(starts, found, strict=False)
            for cluster in one.clusters
        ),
        np.repeat(np.arange(len(found)), [len(one.errors) for _, one in found]),
    )


def _settled(subsystem: GeneralSubsystem, found: ProductSolutions) -> ComplexArray:
    """Return the logarithms of the multipliers; on the unit circle where they cannot have left it."""
    logs = found.log_values
    held = subsystem.reciprocal and bool((np.abs(logs.real) <= found.errors).all())
    return np.asarray(1j * logs.imag, dtype=complex) if held else logs


def period_places(pieces: Pieces) -> Places:
    """Return places that resolve every motion of a system."""
    rate = max((largest_rate(subsystem) for subsystem in pieces.subsystems), default=0.0)
    return places_for(pieces.system, pieces.eps, rate, pieces.Omega)


def period_logarithms(solutions: Solutions) -> ComplexArray:
    """Return the logarithm (N, N) of what a period does to the solutions: diagonal but for clusters.

    A cluster's is that of its matrix, with eigenvalues close to the logarithm of their mean.
    """
    found = np.diag(solutions.log_values)
    for cluster in solutions.clusters:
        if len(cluster) > 1:
            here = np.ix_(cluster, cluster)
            angle = solutions.log_values[cluster[0]].imag
            turned = solutions.closing[here] * np.exp(-1j * angle)
            growth = solutions.logs[:, cluster[0]].sum()
            found[here] = sla.logm(turned) + (growth + 1j * angle) * np.eye(len(cluster))
    return found


def periodic_parts(solutions: Solutions, logarithms: ComplexArray, phases: FloatArray) -> ComplexArray:
    """Return p = x(t) e^{-L t} (p, S, N) at ``phases`` (p,), parts of a period from the first, L T = ``logarithms``."""
    found = solutions.right * np.exp(solutions.begun - np.outer(phases, solutions.log_values))[:, None, :]
    for cluster in solutions.clusters:
        if len(cluster) > 1:
            members = list(cluster)
            rest = logarithms[np.ix_(members, members)] - solutions.log_values[cluster[0]] * np.eye(len(members))
            found[:, :, members] = found[:, :, members] @ np.array([sla.expm(-rest * phase) for phase in phases])
    return found
