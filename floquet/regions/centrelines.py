"""Where a narrow region is at each amplitude, and how unstable, from a few columns beside it and in it."""

from __future__ import annotations

import numpy as np
from numba import njit

# x falls with Omega as between modes of constant frequencies, but for this factor.
STEEPNESS = 3.0
# As much steeper it may be where that says how narrow a region is.
STEEPER = 1.5
# A node counts where it is inside the region, or that near to its middle, as part of the square of the half width.
NEAR = 0.25
# Frequencies that agree to this part of themselves are the same.
SAME = 1e-9


@njit(cache=True, nogil=True)
def middles(Omega, f, apart, exact, height, most, centre, slope, close):  # type: ignore[no-untyped-def]
    """Return for each level, as arrays (k,):

    * where the middle of a region is, NaN where unknown;
    * the square of its half width, as part of f there;
    * f there as the nearest node has it;
    * the most that f can be there, since nodes beside it are stable;
    * the nearest node, if it is inside the region, else -1;
    * whether it is near enough to count;
    * where the middle may be where it is unknown: straight on from two nodes on one side;
    * by how much the middle may be off.

    The middle is where x is zero, by a cubic through the nodes on both sides. x is Omega sqrt(height - f), with the
    sign of ``apart``, or Omega apart / 2 where this is ``exact``: a straight line in Omega if the two modes have
    constant frequencies.

    Parameters
    ----------
    Omega, f, apart
        Those of `Nodes`.
    exact : bool
        Whether ``apart`` is known inside the region, too.
    height, most : ndarray, shape (k,)
        f in the middle, as far as it is known; where it is more than ``most``, something else is unstable.
    centre, slope, close : float
        Where the resonance is, how x falls with Omega there, and how far a node on one side only may be.
    """
    count, levels = f.shape
    place, square, top = np.full(levels, np.nan), np.zeros(levels), np.zeros(levels)
    room = np.full(levels, np.inf)
    likely, doubt = np.full(levels, np.nan), np.zeros(levels)
    inside, measured = np.full(levels, -1), np.zeros(levels, np.bool_)
    at, x = np.empty(count), np.empty(count)
    last = centre
    for k in range(levels):
        high = height[k]
        known = _measures(Omega, f[:, k], apart[:, k], exact, high, centre, at, x)
        place[k], steepness, doubt[k] = _between(at, x, known, slope, last)
        if steepness == 0.0 and not exact:  # too steep for a region that high?
            high = _highest(Omega, f[:, k], apart[:, k], high, centre, slope)
            known = _measures(Omega, f[:, k], apart[:, k], exact, high, centre, at, x)
            place[k], steepness, doubt[k] = _between(at, x, known, slope, last)
        if steepness == 0.0:  # known on one side only, but close
            for a in range(known):
                way = -x[a] / slope
                if abs(way) < close and (steepness == 0.0 or abs(way) < abs(place[k] - at[a])):
                    place[k], steepness = at[a] + way, slope
        if steepness == 0.0:
            likely[k] = _straight_on(at, x, known, slope)
            continue
        last = place[k]
        nearest = -1
        for c in range(count):
            if np.isnan(f[c, k]):
                continue
            if nearest < 0 or abs(Omega[c] - last) < abs(Omega[nearest] - last):
                nearest = c
            if f[c, k] <= 0.0:
                room[k] = min(room[k], (steepness * (Omega[c] - last) / Omega[c]) ** 2)
        off = (steepness * (Omega[nearest] - last) / Omega[nearest]) ** 2
        top[k], square[k] = f[nearest, k] + off, (last / steepness) ** 2
        if f[nearest, k] > 0.0 and top[k] <= most[k]:
            inside[k] = nearest
        measured[k] = top[k] <= most[k] and (f[nearest, k] > 0.0 or off < NEAR * abs(high))
    return place, square, top, room, inside, measured, likely, doubt


@njit(cache=True, nogil=True)
def _measures(Omega, f, apart, exact, height, centre, at, x):  # type: ignore[no-untyped-def]
    """Set x, and the place of the node, where it is known; return at how many nodes."""
    known = 0
    for c in range(f.size):
        if np.isnan(f[c]) or abs(Omega[c] - centre) <= SAME * centre:
            continue  # from the resonance itself two modes start as one: which is which is unknown
        if exact or (apart[c] != 0.0 and f[c] < height):
            off = apart[c] / 2 if exact else np.sqrt(height - f[c])
            x[known] = np.copysign(Omega[c] * off, apart[c])
            at[known] = Omega[c]
            known += 1
    return known


@njit(cache=True, nogil=True)
def _between(at, x, known, slope, last):  # type: ignore[no-untyped-def]
    """Return where x is zero between two of the ``known`` nodes, nearest to ``last``, how x falls there, 0 if there is
    no such place, and by how much the place may be off."""
    place, steepness, doubt = np.nan, 0.0, 0.0
    for a in range(known - 1):
        if x[a] >= 0.0 and x[a + 1] < 0.0:
            rate = (x[a + 1] - x[a]) / (at[a + 1] - at[a])
            if slope * STEEPNESS < rate < slope / STEEPNESS:
                found, off = _zero(at, x, known, a, rate)
                if steepness == 0.0 or abs(found - last) < abs(place - last):
                    place, steepness, doubt = found, rate, off
    return place, steepness, doubt


@njit(cache=True, nogil=True)
def _highest(Omega, f, apart, height, centre, slope):  # type: ignore[no-untyped-def]
    """Return ``height``, or less where the region lies between two stable nodes that are too near for it.

    On both sides h - f is the square of how x falls on the way to the middle.
    """
    before = -1
    for c in range(f.size):
        if np.isnan(f[c]) or abs(Omega[c] - centre) <= SAME * centre:
            continue
        if before >= 0 and apart[before] > 0.0 and apart[c] < 0.0 and max(f[before], f[c]) <= 0.0:
            fall = STEEPER * slope * (Omega[before] - Omega[c]) / Omega[c]
            height = min(height, f[before] + ((fall + (f[c] - f[before]) / fall) / 2) ** 2)
        before = c
    return height


@njit(cache=True, nogil=True)
def _straight_on(at, x, known, slope):  # type: ignore[no-untyped-def]
    """Return where x is zero beyond two of the ``known`` nodes, no further than they are apart; NaN if nowhere."""
    for a in range(known - 1):
        first, second = at[a], at[a + 1]
        rate = (x[a + 1] - x[a]) / (second - first)
        if slope * STEEPNESS < rate < slope / STEEPNESS:
            found = first - x[a] / rate
            if 2 * first - second <= found <= 2 * second - first:
                return found
    return np.nan


@njit(cache=True, nogil=True)
def _zero(at, x, known, a, rate):  # type: ignore[no-untyped-def]
    """Return where x is zero between nodes a and a + 1 of the ``known`` ones, and how much it depends on the others."""
    begin, end = a, a + 2
    for step in (-1, 1):  # one more on each side, if it is no stranger
        b = a - 1 if step < 0 else a + 2
        if 0 <= b < known:
            c = a if step < 0 else a + 1
            beside = (x[b] - x[c]) / (at[b] - at[c])
            if rate * STEEPNESS < beside < rate / STEEPNESS:
                begin, end = min(begin, b), max(end, b + 1)
    first, second = at[a], at[a + 1]
    found, straight = root(at[begin:end], x[begin:end]), first - x[a] / rate
    if not first <= found <= second:
        return straight, second - first
    left, right = a, a + 2
    if end - begin == 4:  # without one of the two further ones
        left, right = (begin, right) if abs(x[begin]) < abs(x[end - 1]) else (left, end)
    return found, abs(found - root(at[left:right], x[left:right]))


@njit(cache=True, nogil=True)
def root(at, x):  # type: ignore[no-untyped-def]
    """Return where x (k,) is zero, by the polynomial through the places ``at`` as a function of x."""
    found = 0.0
    for b in range(x.size):
        weight = 1.0
        for c in range(x.size):
            if c != b:
                weight *= x[c] / (x[c] - x[b])
        found += weight * at[b]
    return found
