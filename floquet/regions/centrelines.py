"""The centreline of a narrow region at each amplitude, and f on it, from a few columns beside it and in it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from periodic.checks import FloatArray

# x falls with Omega as between modes of constant frequencies, but for this factor.
MAX_SLOPE_RATIO = 3.0
# It may fall this many times as steeply where that bounds the height of a region.
HEIGHT_SLOPE_RATIO = 1.5
# A column beside a region measures f on its centreline if (distance / half width)^2 is less than this.
MAX_SQUARED_DISTANCE = 0.25
# Two frequencies are the same if they agree to this part of themselves.
SAME_FREQUENCY = 1e-9


class Centreline(NamedTuple):
    """What is known of the centreline of a region at k amplitudes; arrays (k,).

    Attributes
    ----------
    Omega
        Where it is; NaN where unknown.
    square
        The square of the half width, as part of f on the centreline.
    height
        f on the centreline, as the nearest column has it.
    bound
        The most that f can be there, since columns beside it are stable.
    inside
        The number of the nearest column if that is inside the region, else -1.
    measured
        Whether the nearest column is near enough to measure f.
    likely
        Where it may be where it is unknown: straight on from two columns on one side.
    uncertainty
        By how much ``Omega`` may be off.
    """

    Omega: FloatArray
    square: FloatArray
    height: FloatArray
    bound: FloatArray
    inside: NDArray[np.intp]
    measured: NDArray[np.bool_]
    likely: FloatArray
    uncertainty: FloatArray


@njit(cache=True, nogil=True)
def centreline(Omega, f, detuning, exact, height, most, centre, slope, close):  # type: ignore[no-untyped-def]
    """Return the `Centreline` of a region.

    It is where x is zero, by a cubic through the columns on both sides. x is Omega sqrt(height - f) with the sign of
    ``detuning``, or Omega detuning / 2 where the latter is ``exact``. It is a straight line in Omega if the two modes
    have constant frequencies.

    Parameters
    ----------
    Omega, f, detuning
        Those of `Detuning`.
    exact : bool
        Whether ``detuning`` is known inside the region, too.
    height, most : ndarray, shape (k,)
        f on the centreline, as far as it is known; where it is more than ``most``, something else is unstable.
    centre, slope, close : float
        Where the resonance is, how x falls with Omega there, and how far away a column may be if columns are on one
        side only.
    """
    count, amplitudes = f.shape
    place, square, top = np.full(amplitudes, np.nan), np.zeros(amplitudes), np.zeros(amplitudes)
    room = np.full(amplitudes, np.inf)
    likely, doubt = np.full(amplitudes, np.nan), np.zeros(amplitudes)
    inside, measured = np.full(amplitudes, -1), np.zeros(amplitudes, np.bool_)
    at, x = np.empty(count), np.empty(count)
    last = centre
    for k in range(amplitudes):
        high = height[k]
        known = _measures(Omega, f[:, k], detuning[:, k], exact, high, centre, at, x)
        place[k], steepness, doubt[k] = _between(at, x, known, slope, last)
        if steepness == 0.0 and not exact:  # too steep for a region that high?
            high = _highest(Omega, f[:, k], detuning[:, k], high, centre, slope)
            known = _measures(Omega, f[:, k], detuning[:, k], exact, high, centre, at, x)
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
        measured[k] = top[k] <= most[k] and (f[nearest, k] > 0.0 or off < MAX_SQUARED_DISTANCE * abs(high))
    return Centreline(place, square, top, room, inside, measured, likely, doubt)


@njit(cache=True, nogil=True)
def _measures(Omega, f, detuning, exact, height, centre, at, x):  # type: ignore[no-untyped-def]
    """Set x and its frequency ``at`` in the columns in which it is known. Return their number."""
    known = 0
    for c in range(f.size):
        if np.isnan(f[c]) or abs(Omega[c] - centre) <= SAME_FREQUENCY * centre:
            continue  # at the resonance itself two modes start as one: which is which is unknown
        if exact or (detuning[c] != 0.0 and f[c] < height):
            off = detuning[c] / 2 if exact else np.sqrt(height - f[c])
            x[known] = np.copysign(Omega[c] * off, detuning[c])
            at[known] = Omega[c]
            known += 1
    return known


@njit(cache=True, nogil=True)
def _between(at, x, known, slope, last):  # type: ignore[no-untyped-def]
    """Return where x is zero between two of the ``known`` columns, how x falls there, and how far the zero may be off.

    Of several zeros the one nearest to ``last`` is taken. x falls by 0 if there is none.
    """
    place, steepness, doubt = np.nan, 0.0, 0.0
    for a in range(known - 1):
        if x[a] >= 0.0 and x[a + 1] < 0.0:
            rate = (x[a + 1] - x[a]) / (at[a + 1] - at[a])
            if slope * MAX_SLOPE_RATIO < rate < slope / MAX_SLOPE_RATIO:
                found, off = _zero(at, x, known, a, rate)
                if steepness == 0.0 or abs(found - last) < abs(place - last):
                    place, steepness, doubt = found, rate, off
    return place, steepness, doubt


@njit(cache=True, nogil=True)
def _highest(Omega, f, detuning, height, centre, slope):  # type: ignore[no-untyped-def]
    """Return ``height``, or less where the region lies between two stable columns that are too near for it.

    On both sides height - f is the square of how far x falls on the way to the centreline.
    """
    before = -1
    for c in range(f.size):
        if np.isnan(f[c]) or abs(Omega[c] - centre) <= SAME_FREQUENCY * centre:
            continue
        if before >= 0 and detuning[before] > 0.0 and detuning[c] < 0.0 and max(f[before], f[c]) <= 0.0:
            fall = HEIGHT_SLOPE_RATIO * slope * (Omega[before] - Omega[c]) / Omega[c]
            height = min(height, f[before] + ((fall + (f[c] - f[before]) / fall) / 2) ** 2)
        before = c
    return height


@njit(cache=True, nogil=True)
def _straight_on(at, x, known, slope):  # type: ignore[no-untyped-def]
    """Return where x is zero beyond two of the ``known`` columns, no further than their distance; NaN if nowhere."""
    for a in range(known - 1):
        first, second = at[a], at[a + 1]
        rate = (x[a + 1] - x[a]) / (second - first)
        if slope * MAX_SLOPE_RATIO < rate < slope / MAX_SLOPE_RATIO:
            found = first - x[a] / rate
            if 2 * first - second <= found <= 2 * second - first:
                return found
    return np.nan


@njit(cache=True, nogil=True)
def _zero(at, x, known, a, rate):  # type: ignore[no-untyped-def]
    """Return the zero of x between columns a and a + 1 of the ``known`` ones, and how much it depends on the others."""
    begin, end = a, a + 2
    for step in (-1, 1):  # one more on each side, if x goes on alike
        b = a - 1 if step < 0 else a + 2
        if 0 <= b < known:
            c = a if step < 0 else a + 1
            beside = (x[b] - x[c]) / (at[b] - at[c])
            if rate * MAX_SLOPE_RATIO < beside < rate / MAX_SLOPE_RATIO:
                begin, end = min(begin, b), max(end, b + 1)
    first, second = at[a], at[a + 1]
    found, straight = polynomial_zero(at[begin:end], x[begin:end]), first - x[a] / rate
    if not first <= found <= second:
        return straight, second - first
    left, right = a, a + 2
    if end - begin == 4:  # without one of the two further ones
        left, right = (begin, right) if abs(x[begin]) < abs(x[end - 1]) else (left, end)
    return found, abs(found - polynomial_zero(at[left:right], x[left:right]))


@njit(cache=True, nogil=True)
def polynomial_zero(at, x):  # type: ignore[no-untyped-def]
    """Return where x (k,) is zero, by the polynomial that gives the places ``at`` as a function of x."""
    found = 0.0
    for b in range(x.size):
        weight = 1.0
        for c in range(x.size):
            if c != b:
                weight *= x[c] / (x[c] - x[b])
        found += weight * at[b]
    return found
