"""The two solutions that a resonance brings together: which they are, and whether they are unstable."""

from __future__ import annotations

from itertools import combinations
from typing import NamedTuple

import numpy as np

from floquet.boundary.solutions import Solutions
from floquet.kind import Kind
from periodic.checks import ComplexArray

# Mean decay of the pair in one period that is rounding.
MIN_PAIR_DECAY = 1e-11
# Part of a solution in the span of the reference below which it is no longer one of the pair.
MIN_PAIR_PART = 0.5
# Multipliers that agree to this part of themselves are equal: their solutions are known up to mixtures.
EQUAL_MULTIPLIERS = 1e-7
# Parts that are as large as this compared with each other do not tell which solution belongs to the pair.
COMPARABLE_PARTS = 0.9


class Reference(NamedTuple):
    """What a pair is recognised by.

    Attributes
    ----------
    solutions : ndarray of complex, shape (S, 2)
        Its initial values at a point near by, as states (W', W) or x.
    lock : float or None
        The multiplier at which the two meet if both belong to one mode, +1 or -1.
    decay : float
        Sum of the decay rates of the two modes without excitation.
    """

    solutions: ComplexArray
    lock: float | None
    decay: float


class Point(NamedTuple):
    """A pair at one point, and whether the subsystem is unstable there.

    Attributes
    ----------
    value : float
        Test function, positive where the subsystem is unstable. That of the pair, or, where another solution grows and
        the pair does not, the square of its growth.
    own : float
        Test function of the pair alone.
    members : list of int
        The pair among the solutions.
    likeness : float
        Cosine of the largest angle, in energy, between the pair and its reference. Where other multipliers are equal to
        those of the pair, of the mixtures that are most like the reference.
    reference : Reference
        The pair as a reference for points near by.
    found : Solutions
    """

    value: float
    own: float
    members: list[int]
    likeness: float
    reference: Reference
    found: Solutions

    @property
    def Omega(self) -> float:
        """The frequency."""
        return self.found.Omega

    @property
    def growth_rate(self) -> float:
        """Growth rate of the pair, negative if both solutions decay."""
        return float(np.log(np.abs(self.found.multipliers[self.members]).max()) * self.Omega / (2 * np.pi))

    @property
    def error(self) -> float:
        """Error of ``own``."""
        mu, shift = self.found.multipliers[self.members], self.found.sensitivity[self.members].sum() * self.found.error
        return instability(mu, self.reference.lock, self.found.subsystem.reciprocal, float(shift))[1]

    @property
    def kind(self) -> Kind:
        """How the subsystem is unstable, if it is: as the pair, if that is unstable."""
        mu, growth = self.found.multipliers, self.found.growth
        dominant = max(self.members, key=lambda i: abs(mu[i])) if self.own > 0 else int(growth.argmax())
        if mu[dominant].imag:  # real multipliers of a real matrix are exactly real
            return Kind.COMPLEX
        return Kind.PLUS_ONE if mu[dominant].real > 0 else Kind.MINUS_ONE


def judge(found: Solutions, reference: Reference) -> Point:
    """Return the pair that lies most in the span of ``reference``, and what it and the other solutions do."""
    subsystem, mu = found.subsystem, found.multipliers
    span, _ = np.linalg.qr(subsystem.from_q @ reference.solutions)
    members = _choose(found, span.conj().T @ found.vectors, reference)
    together = np.abs(mu[:, None] / mu[members] - 1).min(axis=1) <= EQUAL_MULTIPLIERS
    basis, _ = np.linalg.qr(found.vectors[:, together])
    _, cosines, nearest = np.linalg.svd(span.conj().T @ basis)
    likeness = float(cosines[-1])
    own, _ = instability(mu[members], reference.lock, subsystem.reciprocal, 0.0)
    growth = float(found.growth.max())
    value = own if own > 0 or growth <= 0 else growth**2
    solutions = found.initial(members)
    if together.sum() > len(members):  # of solutions that may be mixed at will those that are most like the last ones
        solutions = np.asarray(subsystem.to_q @ basis @ nearest[: len(members)].conj().T)
    following = Reference(solutions, reference.lock, reference.decay)
    return Point(value, own, members, likeness, following, found)


def growing(found: Solutions) -> Reference:
    """Return the pair of the solution that grows most, as a reference for points near by."""
    mu = found.multipliers
    first = int(found.growth.argmax())
    if mu[first].imag:
        others = [i for i in range(len(mu)) if i != first and mu[i] != mu[first].conj()]
        second = min(others, key=lambda i: abs(1 - mu[i] / mu[first] * abs(mu[first] / mu[i])), default=first)
        return Reference(found.initial([first, second]), None, 0.0)
    lock = float(np.sign(mu[first].real))
    second = _partner(mu, first, 0.0)
    return Reference(found.initial([first, second]), lock, 0.0)


def _choose(found: Solutions, inside: ComplexArray, reference: Reference) -> list[int]:
    """Return the two solutions that have large parts ``inside`` (2, N) the reference.

    Where other multipliers are equal or so close that solutions mix, more than two have, or fewer. Of a single mode
    then one multiplier is enough: its partner is its conjugate or, both being real, the one with which it has the
    product that the decay of the mode demands; of several such pairs the one nearest to instability is taken. Of two
    different modes those that span the reference best are taken.
    """
    mu, part = found.multipliers, np.linalg.norm(inside, axis=0)
    order = np.argsort(-part)
    candidates = np.flatnonzero(part > max(MIN_PAIR_PART, COMPARABLE_PARTS * part[order[1]])).tolist()
    if len(candidates) == 2:
        return candidates
    if reference.lock is None:
        pairs = [[i, k] for i, k in combinations(candidates, 2) if mu[i] != mu[k].conj()]
        if found.subsystem.reciprocal:  # what is off the unit circle resonates with its mirror image
            off = {i: int(np.abs(mu - 1 / mu[i].conj()).argmin()) for i in np.flatnonzero(found.growth).tolist()}
            pairs = [[i, k] for i, k in pairs if off.get(i, k) == k and off.get(k, i) == i] or pairs
        score = [abs(np.linalg.det(inside[:, pair])) for pair in pairs]
    else:
        decay = reference.decay * 2 * np.pi / found.Omega
        pairs = [[first, second] for first in candidates for second in [_partner(mu, first, decay)] if second != first]
        score = [instability(mu[pair], reference.lock, True, 0.0)[0] for pair in pairs]
    return pairs[int(np.argmax(score))] if pairs else order[:2].tolist()


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
    """Return the multiplier that belongs to the same mode as ``first``; itself if there is none."""
    if mu[first].imag:
        return int(np.abs(mu - mu[first].conj()).argmin())
    others = [i for i in np.flatnonzero(mu.imag == 0) if i != first]
    return int(min(others, key=lambda i: abs(np.log(abs(mu[i] * mu[first])) + decay), default=first))
