"""Where a region comes from: followed from a point inside down to small amplitudes."""

from __future__ import annotations

import numpy as np

from tests.hunt.statements.magnus import Flows
from tests.hunt.statements.parts import Array

# Each level over the last, and the last one over the first.
LEVEL, LAST = 0.75, 0.03
# Points in which a stretch is looked for, and how far beyond the last one, in its widths.
POINTS, BEYOND = 21, 1.2
# A stretch that is wider than this part of its distance from where it is expected to start may divide.
FAR = 0.2
# Halvings by which an end is found.
HALVINGS = 4


def stretch(flows: Flows, Omega: float, eps: float, low: float, high: float) -> tuple[float, float]:
    """Return the ends of the unstable stretch round an unstable ``Omega`` within [low, high]."""
    ends = []
    for limit in (low, high):
        grid = np.linspace(Omega, limit, POINTS)
        stable = np.flatnonzero(flows.state(grid, eps) != 1)
        if not stable.size or stable[0] == 0:
            ends.append(limit if not stable.size else Omega)
            continue
        a, b = float(grid[stable[0] - 1]), float(grid[stable[0]])
        for _ in range(HALVINGS):
            middle = (a + b) / 2
            a, b = (middle, b) if flows.state(middle, eps)[0] == 1 else (a, middle)
        ends.append((a + b) / 2)
    return ends[0], ends[1]


def origin(
    flows: Flows, Omega: float, eps: float, reach: float, power: int, toward: float
) -> tuple[float, float] | None:
    """Return the frequency to which the region round (Omega, eps) comes down as eps -> 0, and its uncertainty.

    Where it divides on the way, the branch nearest to ``toward`` is followed.
    Damping shrinks with eps to the given power, so that a region of that order does not close on the way. None if it is
    lost all the same.
    """
    low, high = stretch(flows, Omega, eps, Omega - reach, Omega + reach)
    places: list[tuple[float, float, float]] = [(eps, (low + high) / 2, high - low)]
    level = eps
    while level > LAST * eps:
        level *= LEVEL
        e, middle, width = places[-1]
        shift = 0.0
        if len(places) > 1:
            shift = (middle - places[-2][1]) / (e**2 - places[-2][0] ** 2) * (level**2 - e**2)
        around = middle + shift + max(width, abs(shift)) * np.linspace(-BEYOND, BEYOND, POINTS)
        if around[0] < 0.1 * toward:
            return None
        here = flows.damped((level / eps) ** power)
        unstable = here.state(around, level) == 1
        if not unstable.any():
            break
        best = _nearest(around, unstable, middle + shift if width < FAR * abs(middle - toward) else toward)
        low, high = stretch(here, best, level, best - 1.5 * width, best + 1.5 * width)
        places.append((level, (low + high) / 2, high - low))
    if places[-1][0] > 0.3 * eps:
        return None
    (e1, m1, w1), (e2, m2, _) = places[-1], places[min(len(places) - 1, 3) * -1 - 1]
    centre = m1 - (m2 - m1) / (e2**2 - e1**2) * e1**2
    return centre, w1 + abs(centre - m1)


def _nearest(grid: Array, unstable: Array, wanted: float) -> float:
    inside = grid[unstable.astype(bool)]
    return float(inside[np.abs(inside - wanted).argmin()])
