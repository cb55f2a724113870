"""The two multipliers that a resonance brings together: which they are, and whether they are unstable."""

from __future__ import annotations

from itertools import combinations
from typing import NamedTuple

import numpy as np
import scipy.linalg as sla

from floquet.boundary.resonance import Modes, Resonance
from floquet.oracle import Subsystem, eigensystem, modulation, period_map, propagate, reduce_system, steps_of_period
from periodic import PeriodicSystem, SystemFamily
from periodic.checks import ComplexArray

# Tolerance of the integration. The series cost little more than at 1e-11, and an edge is only as good as the
# multipliers.
PAIR_TOLERANCE = 1e-13
# Mean decay of the pair in one period that is rounding.
MIN_PAIR_DECAY = 1e-11
# Part of an eigenvector in the span of the two resonating solutions below which it is no longer one of them.
MIN_PAIR_PART = 0.5
# Parts that are as large as this compared with each other do not tell which eigenvector belongs to the pair.
COMPARABLE_PARTS = 0.9


class LostError(Exception):
    """The pair of multipliers can no longer be told from the others."""


class Point(NamedTuple):
    """The pair at one Omega: test function f, its error (NaN if not asked for), and the two solutions in (W', W)."""

    Omega: float
    value: float
    error: float
    multipliers: ComplexArray
    solutions: ComplexArray


class Pair:
    """The pair of multipliers of one resonance.

    Attributes
    ----------
    coupled : bool
        Whether the two modes belong to the same subsystem: if not, nothing can make them unstable together.
    strength : float
        Relative change of stiffness by the excitation at eps = 1.
    lock : float or None
        The point at which the two multipliers meet if both belong to one mode, +1 or -1.
    """

    def __init__(self, family: SystemFamily, resonance: Resonance, modes: Modes) -> None:
        self.family = family
        self.solutions, self.decay = modes.solutions(resonance), modes.decay(resonance)
        self.slowest = resonance.centre / (2 * np.pi)
        subsystems = reduce_system(family.at(resonance.centre), 1.0, self.slowest)
        first, second = (_home(subsystems, solution) for solution in self.solutions.T)
        self.coupled = first is second
        self.strength = modulation(first.equations)
        self.lock = (-1.0) ** resonance.j if resonance.p == resonance.q else None
        self._latest: tuple[PeriodicSystem, float, Subsystem] | None = None

    def at(self, Omega: float, eps: float, reference: ComplexArray, *, with_error: bool = False) -> Point:
        """Return the pair: the multipliers whose eigenvectors lie most in the span of ``reference`` (2n, 2).

        Raises
        ------
        LostError
            If there are no two such multipliers, or no such frequency.
        """
        if Omega <= 0:
            raise LostError
        subsystem = self._subsystem(Omega, eps)
        if with_error:
            found = period_map(subsystem, Omega, eps, PAIR_TOLERANCE)
            Phi, error = found.matrix, found.error
        else:
            Phi = propagate(
                subsystem, Omega, eps, steps_of_period(subsystem, Omega), PAIR_TOLERANCE, np.eye(len(subsystem.from_q))
            )
            error = np.nan
        mu, left, right = eigensystem(Phi)
        span, _ = np.linalg.qr(subsystem.from_q @ reference)
        both = self._choose(mu, span.conj().T @ right, 2 * np.pi / Omega)
        with np.errstate(divide="ignore"):
            condition = 1 / np.abs(np.einsum("ij,ij->j", left[:, both].conj(), right[:, both]))
        shift = float(np.sum(condition / np.abs(mu[both])) * error)
        value, error = instability(mu[both], self.lock, subsystem.reciprocal, shift)
        return Point(Omega, value, error, mu[both], subsystem.to_q @ right[:, both])

    def likeness(self, point: Point, eps: float) -> float:
        """Return the cosine of the largest angle, in energy, between the two solutions at ``point`` and at eps = 0."""
        from_q = self._subsystem(point.Omega, eps).from_q
        return float(np.cos(sla.subspace_angles(from_q @ self.solutions, from_q @ point.solutions).max()))

    def _subsystem(self, Omega: float, eps: float) -> Subsystem:
        """Return the subsystem of the pair; computed anew only if the system or eps has changed."""
        member = self.family.at(Omega)
        if self._latest is None or self._latest[0] is not member or self._latest[1] != eps:
            subsystems = reduce_system(member, eps, self.slowest)
            self._latest = (member, eps, _home(subsystems, self.solutions[:, 0]))
        return self._latest[2]

    def _choose(self, mu: ComplexArray, inside: ComplexArray, T: float) -> list[int]:
        """Return the two multipliers whose eigenvectors have large parts ``inside`` (2, count) the reference.

        Where other multipliers are equal or so close that eigenvectors mix, more than two eigenvectors have, or fewer.
        Of a single mode then one multiplier is enough: its partner is its conjugate or, both being real, the one with
        which it has the product that the decay of the mode demands; of several such pairs the one nearest to
        instability is taken. Of two different modes those that span the reference best are taken.
        """
        part = np.linalg.norm(inside, axis=0)
        candidates = np.flatnonzero(part > max(MIN_PAIR_PART, COMPARABLE_PARTS * np.sort(part)[-2])).tolist()
        if len(candidates) == 2:
            return candidates
        if self.lock is None:
            pairs = [list(pair) for pair in combinations(candidates, 2)]
            score = [abs(np.linalg.det(inside[:, pair])) for pair in pairs]
        else:
            decay = self.decay * T
            pairs = [[first, _partner(mu, first, decay)] for first in candidates]
            score = [instability(mu[pair], self.lock, True, 0.0)[0] for pair in pairs]
        if not pairs:
            raise LostError
        return pairs[int(np.argmax(score))]


def instability(mu: ComplexArray, lock: float | None, reciprocal: bool, shift: float) -> tuple[float, float]:
    """Return the test function f of two multipliers, positive if they are unstable, and its error.

    Parameters
    ----------
    mu : ndarray of complex, shape (2,)
        The pair.
    lock : float or None
        The point near which they meet, if it is fixed.
    reciprocal : bool
        Whether the system is conservative or reversible.
    shift : float
        Sum of the errors of log mu, to first order in that of the monodromy matrix.

    Notes
    -----
    With a = log mu_1, b = log mu_2,

        Delta = ((a - b) / 2)^2,   p = - Re(a + b),

    are symmetric functions of the pair and therefore analytic where the two coalesce, unlike the multipliers
    themselves. By the criterion of Routh and Hurwitz for z^2 + p z + p^2/4 - Delta with complex Delta the pair is
    unstable if and only if

        f = Re Delta + (Im Delta / p)^2 - p^2 / 4 > 0.

    For conservative and reversible systems p = Im Delta = 0 and f = Re Delta is the square of the growth inside the
    region, and minus the square of half the angle between the multipliers outside. In another region, where the pair of
    one mode has met at the opposite point, half the angle stays pi, and Re Delta = growth^2 - pi^2: for this region
    that is outside, however large the growth, and f turns off before it would change its sign.
    """
    difference = np.log(mu[0] / mu[1]) if lock is None else np.log(mu[0] / lock) - np.log(mu[1] / lock)
    Delta = complex((difference / 2) ** 2)
    error = abs(difference) / 2 * shift
    p = 0.0 if reciprocal else -float(np.log(np.abs(mu)).sum())
    opposite = lock is not None and not mu.imag.any() and bool((mu.real * lock < 0).all())
    if opposite and p >= -MIN_PAIR_DECAY:
        growth = difference.real / 2
        return -(np.pi**2) / (1 + (growth / np.pi) ** 2) - p**2 / 4, error + p / 2 * shift
    if abs(p) < MIN_PAIR_DECAY:
        return Delta.real, error
    if p < 0:  # growing already in the mean of the two
        return np.sqrt(Delta).real ** 2 + p**2 / 4, error - p / 2 * shift
    skew = Delta.imag / p
    error *= 1 + 2 * abs(skew) / p
    return Delta.real + skew**2 - p**2 / 4, error + (p / 2 + 2 * skew**2 / p) * shift


def _partner(mu: ComplexArray, first: int, decay: float) -> int:
    """Return the multiplier that belongs to the same mode as ``first``."""
    if mu[first].imag:
        return int(np.abs(mu - mu[first].conj()).argmin())
    others = [i for i in np.flatnonzero(mu.imag == 0) if i != first]
    if not others:
        raise LostError
    return int(min(others, key=lambda i: abs(np.log(abs(mu[i] * mu[first])) + decay)))


def _home(subsystems: list[Subsystem], solution: ComplexArray) -> Subsystem:
    """Return the subsystem that a solution belongs to."""
    return max(subsystems, key=lambda subsystem: float(np.linalg.norm(subsystem.from_q @ solution)))
