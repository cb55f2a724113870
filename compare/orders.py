"""Orders in eps: what is left of a gap between two edges as eps -> 0."""

from __future__ import annotations

import numpy as np

from periodic.checks import FloatArray

# Largest value at eps = 0 of a gap over eps^order, as part of its largest value on the ladder: the error of the
# polynomial through the rungs.
MAX_REMAINDER = 0.02
# Part of its value one rung further up to which a gap over eps^order falls on the lowest rung, if it goes to zero with
# eps. Of what goes to a value that is not zero, more is left there.
MAX_PART_LEFT = 0.85


def fitted_order(eps: FloatArray, gap: FloatArray) -> float:
    """Return the order of ``gap`` in eps as eps -> 0, from the three smallest rungs.

    Two local orders, log(gap ratio) / log(eps ratio), extrapolated linearly to eps = 0: on gap = a eps^m + b eps^(m+1)
    a single ratio is off by O(eps), the extrapolation by O(eps^2). NaN if a gap is missing or zero.
    """
    e, g = eps[:3], gap[:3]
    if not (np.isfinite(g).all() and (g > 0).all()):
        return float("nan")
    local = np.diff(np.log(g)) / np.diff(np.log(e))
    middle = 0.5 * (e[1:] + e[:-1])
    return float(local[0] - (local[1] - local[0]) * middle[0] / (middle[1] - middle[0]))


def vanishes(eps: FloatArray, difference: FloatArray, order: int, resolution: float) -> bool:
    """Return whether a signed difference of edges has no part of order ``order``, or lower, in eps.

    Divided by eps^order the difference has to go to zero with eps: the polynomial through all rungs says where it goes.
    A wrong slope, or a wrong centre, stays however small eps becomes. ``resolution`` is the error of a difference.
    """
    quotient = difference / eps**order
    if not np.isfinite(quotient).all():
        return False
    allowed = MAX_REMAINDER * np.abs(quotient).max() + noise(eps, order, resolution)
    return bool(abs(_at_zero(eps) @ quotient) <= allowed)


def still_falls(eps: FloatArray, difference: FloatArray, order: int) -> bool:
    """Return whether a difference over eps^order falls from rung to rung, so that these do not say where it goes.

    Where three states act on each other over gaps that are not large against their coupling, the series in eps starts
    far below the rungs, and no polynomial through these tells its limit.
    """
    size = np.abs(difference / eps**order)
    return bool(size[0] < MAX_PART_LEFT * size[1])


def noise(eps: FloatArray, order: int, resolution: float) -> float:
    """Return the error at eps = 0 of a difference over eps^order, where the difference has the error ``resolution``."""
    return float(resolution * np.abs(_at_zero(eps) / eps**order).sum())


def _at_zero(eps: FloatArray) -> FloatArray:
    """Return Lagrange's weights: the value at 0 of the polynomial through values at ``eps``."""
    others = [np.delete(eps, k) for k in range(eps.size)]
    return np.array([np.prod(rest / (rest - e)) for e, rest in zip(eps, others, strict=True)])
