"""The top of a hill by parabolas: near a resonance the test function is nearly one."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

# Most points on the way to the top. A parabola needs about 6.
MAX_CLIMB_POINTS = 40
# A height of the parabola that changes by less than this part from one point to the next is final.
HEIGHT_TOLERANCE = 0.01
# How far beyond the best points the next may lie, in their distance.
MAX_CLIMB = 4.0


class Height(NamedTuple):
    """The test function at one frequency."""

    Omega: float
    value: float


def climb(
    points: list[Height],
    value: Callable[[float], float],
    resolution: float,
    within: tuple[float, float],
    enough: Callable[[Height, float], bool],
) -> Height:
    """Return the top of a hill, or a point on it that is high enough.

    Parameters
    ----------
    points : list of Height
        Three points on it, which are put in order and joined by others.
    value : callable
        The test function.
    resolution : float
        In Omega.
    within : (float, float)
        The frequencies between which the top is looked for.
    enough : callable
        Whether the best point, whose value is positive and which is so far from the expected top, will do.

    Notes
    -----
    Parabolas through the three best points, until the best will do, or the hill certainly ends below zero.
    """
    previous = np.inf
    for _ in range(MAX_CLIMB_POINTS):
        points.sort(key=lambda point: -point.value)
        best = points[0]
        x, height, curvature = _parabola(points[:3])
        reach = MAX_CLIMB * max(abs(point.Omega - best.Omega) for point in points[1:3])
        if curvature >= 0:
            x = best.Omega + np.sign(best.Omega - points[2].Omega) * reach / 2
        low, high = max(best.Omega - reach, within[0]), min(best.Omega + reach, within[1])
        x = float(min(max(x, low), high))
        way = abs(x - best.Omega)
        if way <= resolution or (best.value > 0 and enough(best, way)):
            break
        is_final = curvature < 0 and height < 0 and abs(height - previous) < HEIGHT_TOLERANCE * abs(height)
        if is_final or any(x == point.Omega for point in points):
            break
        previous = height
        points.append(Height(x, value(x)))
    return points[0]


def _parabola(points: list[Height]) -> tuple[float, float, float]:
    """Return place, value and curvature of the extremum of the parabola through three points."""
    (x0, y0), (x1, y1), (x2, y2) = points
    first, second = (y1 - y0) / (x1 - x0), (y2 - y0) / (x2 - x0)
    curvature = (second - first) / (x2 - x1)
    slope = first - curvature * (x1 - x0)  # at x0
    if curvature == 0:
        return x0, y0, 0.0
    return x0 - slope / (2 * curvature), y0 - slope**2 / (4 * curvature), curvature
