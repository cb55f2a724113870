"""Unstable intervals of neighbouring columns joined into regions with closed outlines."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from periodic.checks import FloatArray

# An edge jumps between two columns if it is there this many times as steep as beside them.
MIN_JUMP_STEEPNESS = 4.0
# Where an edge runs along that of the window, both meet there but for this part of the range of eps.
MEETING_ROUNDING = 1e-9


class Interval(NamedTuple):
    """One unstable interval of a column: its ends in eps and the `Kind` just inside them."""

    low: float
    high: float
    low_kind: int
    high_kind: int


class Loop(NamedTuple):
    """A closed polyline: its corners, the first not repeated at the end, and the `Kind` of each, arrays (k,)."""

    Omega: FloatArray
    eps: FloatArray
    kind: NDArray[np.int8]


def closed(Omega: FloatArray, eps: FloatArray, kind: NDArray[np.integer]) -> Loop:
    """Return the polyline with these corners, read-only."""
    loop = Loop(Omega, eps, kind.astype(np.int8))
    for array in loop:
        array.setflags(write=False)
    return loop


# The unstable intervals of a column, from below. A span lies between two neighbouring columns.
Column = list[Interval]
IntervalId = tuple[int, int]  # number of the column, number of the interval in it
Corner = tuple[int, int, str, int]  # column, interval, "low" | "high" | "left" | "right", number of a stable gap


def links(left: Column, right: Column) -> list[tuple[int, int]]:
    """Return the pairs of intervals of two columns that are connected, from below.

    Intervals are connected if they overlap, unless only a stable gap that rises or falls from one column to the other
    lets them overlap. A gap is taken to go on if it is between the same kinds of instability in both columns.
    """
    found = [(i, k) for i, a in enumerate(left) for k, b in enumerate(right) if max(a.low, b.low) < min(a.high, b.high)]
    overlapping = set(found)

    def is_across(i: int, k: int) -> bool:
        rises = {(i - 1, k), (i, k + 1)} <= overlapping and _gap_kinds(left, i - 1) == _gap_kinds(right, k)
        falls = {(i, k - 1), (i + 1, k)} <= overlapping and _gap_kinds(left, i) == _gap_kinds(right, k - 1)
        return rises or falls

    return [pair for pair in found if not is_across(*pair)]


def _gap_kinds(column: Column, i: int) -> tuple[int, int]:
    """Return the kinds of instability below and above the stable gap that is above interval ``i``."""
    return column[i].high_kind, column[i + 1].low_kind


def components(columns: Sequence[Column]) -> list[set[IntervalId]]:
    """Return the sets of connected intervals, from the left."""
    parent = {(c, i): (c, i) for c, column in enumerate(columns) for i in range(len(column))}

    def root(place: IntervalId) -> IntervalId:
        while parent[place] != place:
            parent[place] = parent[parent[place]]
            place = parent[place]
        return place

    for c in range(len(columns) - 1):
        for i, k in links(columns[c], columns[c + 1]):
            one, two = sorted((root((c, i)), root((c + 1, k))))
            parent[two] = one
    found: dict[IntervalId, set[IntervalId]] = {}
    for place in parent:
        found.setdefault(root(place), set()).add(place)
    return list(found.values())


def loops(Omega: FloatArray, columns: Sequence[Column], members: set[IntervalId], finest: float) -> list[Loop]:
    """Return the closed polylines round the connected intervals ``members``.

    The outer one comes first and runs counterclockwise. Those round stable islands follow and run clockwise.

    Each pair of linked intervals spans a quadrilateral. Where an interval is linked to several on one side, stable gaps
    begin between these: it is divided at the middle of each gap. Sides that two quadrilaterals share cancel. The
    remaining sides form closed polylines. In spans up to ``finest`` wide an edge may jump.
    """
    bottom = min(interval.low for column in columns for interval in column)
    top = max(interval.high for column in columns for interval in column)
    where: dict[Corner, tuple[float, float, int]] = {}
    neighbours: dict[Corner, list[Corner]] = {}

    def join(a: Corner, b: Corner) -> None:
        neighbours.setdefault(a, []).append(b)
        neighbours.setdefault(b, []).append(a)

    for c, i in members:
        interval = columns[c][i]
        where[c, i, "low", 0] = (Omega[c], interval.low, interval.low_kind)
        where[c, i, "high", 0] = (Omega[c], interval.high, interval.high_kind)
    first, last = min(c for c, _ in members), max(c for c, _ in members)
    linked: set[tuple[int, int, str]] = set()
    for c in range(first, last):
        pairs = [(i, k) for i, k in links(columns[c], columns[c + 1]) if (c, i) in members]
        may_jump = Omega[c + 1] - Omega[c] <= finest
        for number, (i, k) in enumerate(pairs):
            linked |= {(c, i, "right"), (c + 1, k, "left")}
            lower = _corners(pairs, number, number - 1, c, "low")
            upper = _corners(pairs, number, number + 1, c, "high")
            for (a, b), end in ((lower, 0), (upper, 1)):
                bend = _bend(Omega, columns, c, (i, k), end) if a[2] == b[2] and may_jump else None
                if bend is None:
                    join(a, b)
                else:
                    bent = (c, i, f"{a[2]} bend", k)
                    where[bent] = (bend[0], min(max(bend[1], bottom), top), where[a][2])
                    join(a, bent)
                    join(bent, b)
            if number + 1 < len(pairs):
                _place_gap_corner(where, Omega, columns, c, pairs[number], pairs[number + 1], upper)
    for c, i in members:
        for side, step in (("left", -1), ("right", 1)):
            if (c, i, side) in linked:
                continue
            apex = None
            if 0 <= c + step < len(columns):
                inner = [a if step > 0 else b for a, b in _linked(columns, c, -step) if (b if step > 0 else a) == i]
                if len(inner) == 1:
                    apex = _apex(Omega[[c - step, c, c + step]], columns[c - step][inner[0]][:2], columns[c][i][:2])
                elif not 0 <= c - step < len(columns):  # it comes in from beyond the window and ends before the next
                    apex = (Omega[[c, c + step]].mean(), sum(columns[c][i][:2]) / 2)
            if apex is None:
                join((c, i, "low", 0), (c, i, "high", 0))
            else:
                where[c, i, f"{side} tip", 0] = (*apex, columns[c][i].low_kind)
                join((c, i, "low", 0), (c, i, f"{side} tip", 0))
                join((c, i, f"{side} tip", 0), (c, i, "high", 0))
    walked = [_loop([where[corner] for corner in corners]) for corners in _walk(neighbours)]
    walked.sort(key=lambda loop: -abs(area(loop.Omega, loop.eps)))
    return [_turned(loop, 1 if number == 0 else -1) for number, loop in enumerate(walked)]


def area(Omega: FloatArray, eps: FloatArray) -> float:
    """Return the area inside a closed polyline, positive if it runs counterclockwise."""
    last = Omega[-1] * eps[0] - Omega[0] * eps[-1]
    return float(Omega[:-1] @ eps[1:] - Omega[1:] @ eps[:-1] + last) / 2


def crossings(outlines: Sequence[Loop], amplitude: float) -> list[float]:
    """Return where the outlines cross the row ``amplitude``, in increasing order."""
    return sorted(x for loop in outlines for x in _crossings(loop.Omega, loop.eps, amplitude).tolist())


def largest_width(outlines: Sequence[Loop], count: int) -> float:
    """Return the largest width in Omega, at one of ``count`` amplitudes, of what lies inside the outlines."""
    bottom, top = min(loop.eps.min() for loop in outlines), max(loop.eps.max() for loop in outlines)
    amplitudes = bottom + (top - bottom) * (np.arange(count) + 0.5) / count
    ends = [crossings(outlines, amplitude) for amplitude in amplitudes]
    return max((right - left for row in ends for left, right in zip(row[::2], row[1::2], strict=True)), default=0.0)


@njit(cache=True, nogil=True)
def _crossings(Omega, eps, amplitude):  # type: ignore[no-untyped-def]
    """Return where one closed polyline crosses the row ``amplitude``, along it."""
    found, count = np.empty(eps.size), 0
    for b in range(eps.size):
        a = b - 1
        if (eps[a] > amplitude) != (eps[b] > amplitude):
            found[count] = Omega[a] + (amplitude - eps[a]) / (eps[b] - eps[a]) * (Omega[b] - Omega[a])
            count += 1
    return found[:count]


def contained(outlines: Sequence[Loop], Omega: FloatArray, eps: FloatArray) -> NDArray[np.bool_]:
    """Return whether points, arrays of one shape, lie inside the outlines of a region, or on an edge.

    Islands run clockwise; outlines that run counterclockwise may overlap.
    """
    inside = np.zeros((2, *Omega.shape), dtype=int)
    for loop in outlines:
        box = (Omega >= loop.Omega.min()) & (Omega <= loop.Omega.max()) & (eps >= loop.eps.min())
        box &= eps <= loop.eps.max()
        if box.any():
            turn = -1 if area(loop.Omega, loop.eps) < 0 else 1
            inside[:, box] += turn * within(loop.Omega, loop.eps, Omega[box], eps[box])
    return np.asarray((inside > 0).any(axis=0))


@njit(cache=True, nogil=True)
def within(outline_Omega, outline_eps, Omega, eps):  # type: ignore[no-untyped-def]
    """Return whether points (k,) lie inside a closed polyline, shape (2, k).

    In the first row the left and lower edges belong to the inside, in the second row the right and upper ones. A point
    is inside if a line from it to the right crosses an odd number of sides.
    """
    inside = np.zeros((2, Omega.size), np.bool_)
    for b in range(outline_eps.size):
        x0, y0, x1, y1 = outline_Omega[b - 1], outline_eps[b - 1], outline_Omega[b], outline_eps[b]
        if y0 == y1:
            continue
        low, high, slope = min(y0, y1), max(y0, y1), (x1 - x0) / (y1 - y0)
        for i in range(Omega.size):
            if low <= eps[i] <= high:
                crossing = x0 + (eps[i] - y0) * slope
                inside[0, i] ^= eps[i] < high and Omega[i] < crossing
                inside[1, i] ^= eps[i] > low and Omega[i] <= crossing
    return inside


def _corners(pairs: list[tuple[int, int]], number: int, other: int, c: int, end: str) -> tuple[Corner, Corner]:
    """Return the left and right corner of the quadrilateral of a pair at its lower or upper end."""
    i, k = pairs[number]
    shared = pairs[other] if 0 <= other < len(pairs) else (-1, -1)
    gap = max(number, other)
    left = (c, i, "right", gap) if shared[0] == i else (c, i, end, 0)
    right = (c + 1, k, "left", gap) if shared[1] == k else (c + 1, k, end, 0)
    return left, right


def _place_gap_corner(
    where: dict[Corner, tuple[float, float, int]],
    Omega: FloatArray,
    columns: Sequence[Column],
    c: int,
    below: tuple[int, int],
    above: tuple[int, int],
    corners: tuple[Corner, Corner],
) -> None:
    """IntervalId the corner in which a stable gap between two pairs that share an interval begins."""
    if below[0] == above[0]:
        corner, a, b, at, step = corners[0], below[1], above[1], c + 1, 1
    elif below[1] == above[1]:
        corner, a, b, at, step = corners[1], below[0], above[0], c, -1
    else:
        return
    gap = (columns[at][a].high, columns[at][b].low)
    place = (Omega[at - step], (gap[0] + gap[1]) / 2)
    if 0 <= at + step < len(columns):
        further = [pair if step > 0 else pair[::-1] for pair in _linked(columns, at, step)]
        lower, upper = [k for i, k in further if i == a], [k for i, k in further if i == b]
        if lower and upper and lower[-1] + 1 == upper[0]:
            wider = (columns[at + step][lower[-1]].high, columns[at + step][upper[0]].low)
            place = _apex(Omega[[at + step, at, at - step]], wider, gap) or place
    where[corner] = (*place, columns[at][a].high_kind)


def _linked(columns: Sequence[Column], c: int, step: int) -> list[tuple[int, int]]:
    """Return the links between column c and its neighbour c + step. The left column comes first in each."""
    if not 0 <= c + step < len(columns):
        return []
    return links(columns[min(c, c + step)], columns[max(c, c + step)])


def _bend(
    Omega: FloatArray, columns: Sequence[Column], c: int, link: tuple[int, int], end: int
) -> tuple[float, float] | None:
    """Return the corner of an edge that jumps between columns c and c + 1; None if it does not jump.

    An edge jumps where another region meets this one. There the flatter of the two edges goes on to the steeper one.
    """
    i, k = link
    before = [columns[c - 1][a][end] for a, b in _linked(columns, c, -1) if b == i]
    after = [columns[c + 2][b][end] for a, b in _linked(columns, c + 1, 1) if a == k]
    if len(before) != 1 or len(after) != 1:
        return None
    eps = np.array([before[0], columns[c][i][end], columns[c + 1][k][end], after[0]])
    left, here, right = np.diff(eps) / np.diff(Omega[c - 1 : c + 3])
    if min(left, right) <= here <= max(left, right) or abs(here) < MIN_JUMP_STEEPNESS * min(abs(left), abs(right)):
        return None
    step = Omega[c + 1] - Omega[c]
    if abs(right) < abs(left):
        return float(Omega[c]), float(eps[2] - right * step)
    return float(Omega[c + 1]), float(eps[1] + left * step)


def _apex(Omega: FloatArray, wider: tuple[float, float], last: tuple[float, float]) -> tuple[float, float] | None:
    """Return where two edges meet that run straight through the columns ``wider`` and ``last``, before the third one.

    None if they do not converge, or converge outside the range of eps between them.
    """
    closing = (wider[1] - wider[0]) - (last[1] - last[0])
    if closing <= 0:
        return None
    part = min((last[1] - last[0]) / closing, abs((Omega[2] - Omega[1]) / (Omega[1] - Omega[0])))
    low, high = (b + part * (b - a) for a, b in zip(wider, last, strict=True))
    eps, least, most = (low + high) / 2, min(wider[0], last[0]), max(wider[1], last[1])
    rounding = MEETING_ROUNDING * (most - least)
    if not least - rounding <= eps <= most + rounding:
        return None
    return float(Omega[1] + part * (Omega[1] - Omega[0])), min(max(eps, least), most)


def _walk(neighbours: dict[Corner, list[Corner]]) -> list[list[Corner]]:
    """Return the closed walks of a graph in which every corner has two neighbours."""
    walks, left = [], set(neighbours)
    while left:
        corner = min(left)
        walk = [corner]
        left.discard(corner)
        while True:
            following = next((n for n in neighbours[corner] if n in left), None)
            if following is None:
                break
            corner = following
            left.discard(corner)
            walk.append(corner)
        walks.append(walk)
    return walks


def _turned(loop: Loop, sense: int) -> Loop:
    """Return a polyline that runs counterclockwise if ``sense`` is 1, clockwise if it is -1."""
    if area(loop.Omega, loop.eps) * sense >= 0:
        return loop
    return Loop(loop.Omega[::-1], loop.eps[::-1], loop.kind[::-1])


def _loop(corners: list[tuple[float, float, int]]) -> Loop:
    Omega, eps, kind = zip(*corners, strict=True)
    return closed(np.array(Omega), np.array(eps), np.array(kind))
