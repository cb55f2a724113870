"""What one point of a plane says of its edges: functions of the multipliers that change their sign at an edge.

They are symmetric functions of all multipliers of a subsystem, and so analytic where two of them coalesce, unlike the
multipliers themselves:

* at an edge at +1 or -1 the product of all mu - 1 or mu + 1 changes its sign;
* where two pairs of a conservative or reversible subsystem meet and leave the unit circle, the discriminant of its sums
  mu + 1/mu does;
* where a complex pair of another subsystem leaves it, the largest log|mu|.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from floquet.boundary import monodromy_matrix, subsystems_at
from floquet.chart import Point
from floquet.kind import Kind
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
        Products of mu - 1 and of mu + 1, each factor in units of max(1, |mu|).
    meeting : float
        Discriminant of the sums mu + 1/mu of the conservative and reversible subsystems.
    decay : float
        - largest log|mu| of the other subsystems; infinite if there are none.
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
    plus = minus = meeting = 1.0
    decay, strongest, kind = np.inf, 0.0, Kind.STABLE
    for subsystem in subsystems_at(point.member, point.Omega, point.eps, point.Omega / (2 * np.pi)):
        mu = np.linalg.eigvals(monodromy_matrix(subsystem, point.Omega, point.eps)).astype(complex)
        size = np.maximum(np.abs(mu), 1.0)
        plus *= float(np.prod((mu - 1) / size).real)
        minus *= float(np.prod((mu + 1) / size).real)
        first = int(np.abs(mu).argmax())
        with np.errstate(divide="ignore"):
            growth = float(np.log(np.abs(mu[first])))
        if subsystem.reciprocal:
            meeting *= _discriminant(mu)
        else:
            decay = min(decay, -growth)
        if growth > (LEAST_GROWTH if subsystem.reciprocal else 0.0) and growth > strongest:
            strongest, kind = growth, _kind(complex(mu[first]))
    return Look(kind, plus, minus, meeting, decay)


def _kind(mu: complex) -> Kind:
    if mu.imag:  # real multipliers of a real matrix are exactly real
        return Kind.COMPLEX
    return Kind.PLUS_ONE if mu.real > 0 else Kind.MINUS_ONE


def _discriminant(mu: ComplexArray) -> float:
    """Return the product of the squares of all differences of the sums mu + 1/mu, each in units of their size.

    The multipliers come in pairs mu, 1/mu, of which one is on or outside the unit circle.
    """
    order = np.argsort(-np.abs(mu), kind="stable")
    left, sums = [complex(mu[i]) for i in order], []
    while len(left) > 1:
        one = left.pop(0)
        partner = min(range(len(left)), key=lambda i: abs(left[i] * one - 1))
        sums.append(one + left.pop(partner))
    s = np.array(sums)
    i, j = np.triu_indices(len(s), 1)
    size = 1 + np.abs(s)
    return float(np.prod((s[i] - s[j]) ** 2 / (size[i] * size[j])).real)
