"""What one point of a plane says of its edges: functions of the multipliers that are negative beyond an edge.

Each belongs to the pair of multipliers that is nearest to the edge, and is symmetric in the two, so that it is analytic
where they coalesce, unlike the multipliers themselves:

* at an edge at +1 or -1 it is 2 - s or 2 + s for the sum s = mu + 1/mu of a conservative or reversible subsystem, and
  the product of two mu - 1 or mu + 1 for another;
* where two pairs of a conservative or reversible subsystem meet and leave the unit circle, it is the square of the
  difference of their sums;
* where a complex pair of another subsystem leaves it, - log|mu|.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from floquet.boundary import monodromy_matrix, subsystems_at
from floquet.chart import Point
from floquet.kind import Kind
from periodic import PeriodicSystem, has_stiffness_alone
from periodic.checks import ComplexArray

# A multiplier of a conservative or reversible subsystem is off the unit circle if its log|mu| is larger: those that
# have met on it are wrong by the square root of rounding.
LEAST_GROWTH = 1e-6


class Look(NamedTuple):
    """One point of a plane.

    Attributes
    ----------
    kind : Kind
        Stable or how it is unstable, without doubt.
    plus, minus : float
        For edges at +1 and at -1, dimensionless.
    meeting : float
        For two pairs that meet, dimensionless; infinite if no subsystem has two.
    decay : float
        - largest log|mu| of subsystems that are neither conservative nor reversible; infinite if there are none.
    """

    kind: Kind
    plus: float
    minus: float
    meeting: float
    decay: float

    def of(self, kind: int) -> tuple[float, ...]:
        """Return the functions that may change their sign at an edge of a kind of instability."""
        if kind == Kind.COMPLEX:
            return self.meeting, self.decay
        return (self.plus,) if kind == Kind.PLUS_ONE else (self.minus,)


def look(point: Point) -> Look:
    """Integrate a point.

    Raises
    ------
    ValueError
        If the solution overflows or the integration would take too long.
    """
    plus = minus = meeting = decay = np.inf
    strongest, kind = 0.0, Kind.STABLE
    for subsystem in _subsystems(point):
        mu = np.linalg.eigvals(monodromy_matrix(subsystem, point.Omega, point.eps)).astype(complex)
        first = int(np.abs(mu).argmax())
        with np.errstate(divide="ignore"):
            growth = float(np.log(np.abs(mu[first])))
        if subsystem.reciprocal:
            sums = _sums(mu)
            real = sums.real[sums.imag == 0]
            plus, minus = min(plus, *(2 - real).tolist(), 4.0), min(minus, *(2 + real).tolist(), 4.0)
            meeting = min(meeting, _meeting(sums))
        else:
            plus, minus = min(plus, _nearest(mu)), min(minus, _nearest(-mu))
            decay = min(decay, -growth)
        if growth > (LEAST_GROWTH if subsystem.reciprocal else 0.0) and growth > strongest:
            strongest, kind = growth, _kind(complex(mu[first]))
    return Look(kind, plus, minus, meeting, decay)


def _subsystems(point: Point) -> Sequence[Any]:
    """Return the subsystems at a point; of periodic stiffness alone they are the same for like frequencies."""
    member, slowest = point.member, point.Omega / (2 * np.pi)
    if has_stiffness_alone(member):
        return _kept(member, point.eps, 2.0 ** math.floor(math.log2(slowest)))
    return subsystems_at(member, point.Omega, point.eps, slowest)


@lru_cache(maxsize=64)
def _kept(system: PeriodicSystem, eps: float, slowest: float) -> Sequence[Any]:
    return subsystems_at(system, 2 * np.pi * slowest, eps, slowest)


def _kind(mu: complex) -> Kind:
    if mu.imag:  # real multipliers of a real matrix are exactly real
        return Kind.COMPLEX
    return Kind.PLUS_ONE if mu.real > 0 else Kind.MINUS_ONE


def _sums(mu: ComplexArray) -> ComplexArray:
    """Return mu + 1/mu of each pair mu, 1/mu."""
    left = mu[np.argsort(-np.abs(mu), kind="stable")].tolist()
    sums = []
    while len(left) > 1:
        one = left.pop(0)
        partner = min(range(len(left)), key=lambda i: abs(left[i] * one - 1))
        sums.append(one + left.pop(partner))
    found = np.array(sums)
    # of a pair on the unit circle, or of two real ones, the sum is real but for rounding
    return np.where(np.abs(found.imag) <= LEAST_GROWTH * (1 + np.abs(found)), found.real, found)


def _meeting(sums: ComplexArray) -> float:
    """Return the square of the smallest difference of two real sums; of two conjugate ones if there are any."""
    turning = np.abs(sums.imag) / (1 + np.abs(sums))
    if turning.any():
        return float(-4 * turning.max() ** 2)
    real = np.sort(sums.real)
    if len(real) < 2:
        return np.inf
    return float((np.diff(real) ** 2 / ((1 + np.abs(real[1:])) * (1 + np.abs(real[:-1])))).min())


def _nearest(mu: ComplexArray) -> float:
    """Return the lowest product (mu_1 - 1) (mu_2 - 1), in units of max(1, |mu|), of conjugates or of two real ones.

    Real ones are taken together by size; a single one counts as 1 - mu.
    """
    size = np.maximum(np.abs(mu), 1.0)
    complex_pairs = (np.abs(mu - 1) / size)[mu.imag > 0] ** 2
    real = np.sort(mu.real[mu.imag == 0])[::-1]
    parts = (1 - real) / np.maximum(np.abs(real), 1.0)
    together = parts[: len(parts) // 2 * 2].reshape(-1, 2).prod(axis=1)
    return float(
        min([*complex_pairs.tolist(), *together.tolist(), *parts[len(parts) // 2 * 2 :].tolist()], default=np.inf)
    )
