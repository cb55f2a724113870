"""Unstable intervals of neighbouring columns joined into regions with closed outlines."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from periodic.checks import FloatArray


class Interval(NamedTuple):
    """One unstable interval of a column: ends in eps, `Kind` just inside them, and where it grows fastest."""

    low: float
    high: float
    low_kind: int
    high_kind: int
    peak: float


class Loop(NamedTuple):
    """A closed polyline: its corners, the first not repeated at the end, and the `Kind` of each, arrays (k,)."""

    Omega: FloatArray
    eps: FloatArray
    kind: NDArray[np.int8]


# A column is the list of its intervals from below; a slab lies between two neighbouring columns.
Column = list[Interval]
Place = tuple[int, int]  # column, number of the interval in it
Corner = tuple[int, int, str, int]  # column, interval, "low" | "high" | "left" | "right", number of the split


def links(left: Column, right: Column) -> list[tuple[int, int]]:
    """Return the pairs of intervals of two columns that overlap, from below."""
    return [(i, k) for i, a in enumerate(left) for k, b in enumerate(right) if max(a.low, b.low) < min(a.high, b.high)]


def components(columns: Sequence[Column]) -> list[set[Place]]:
    """Return the sets of connected intervals, from the left."""
    parent = {(c, i): (c, i) for c, column in enumerate(columns) for i in range(len(column))}

    def root(place: Place) -> Place:
        while parent[place] != place:
            place = parent[place] = parent[parent[place]]
        return place

    for c in range(len(columns) - 1):
        for i, k in links(columns[c], columns[c + 1]):
            one, two = sorted((root((c, i)), root((c + 1, k))))
            parent[two] = one
    found: dict[Place, set[Place]] = {}
    for place in parent:
        found.setdefault(root(place), set()).add(place)
    return list(found.values())


def loops(Omega: FloatArray, columns: Sequence[Column], places: set[Place]) -> list[Loop]:
    """Return the closed polylines round the connected intervals ``places``, the longest first.

    Each pair of linked intervals spans a quadrilateral. An interval linked to several on one side is split between
    them, in the middle of the stable gaps that begin there. What remains of the sides of all quadrilaterals after those
    between two of them cancel is a set of closed polylines.
    """
    where: dict[Corner, tuple[float, float, int]] = {}
    neighbours: dict[Corner, list[Corner]] = {}

    def join(a: Corner, b: Corner) -> None:
        neighbours.setdefault(a, []).append(b)
        neighbours.setdefault(b, []).append(a)

    for c, i in places:
        interval = columns[c][i]
        where[c, i, "low", 0] = (Omega[c], interval.low, interval.low_kind)
        where[c, i, "high", 0] = (Omega[c], interval.high, interval.high_kind)
    first, last = min(c for c, _ in places), max(c for c, _ in places)
    linked: set[tuple[int, int, str]] = set()
    for c in range(first, last):
        pairs = [(i, k) for i, k in links(columns[c], columns[c + 1]) if (c, i) in places]
        for number, (i, k) in enumerate(pairs):
            linked |= {(c, i, "right"), (c + 1, k, "left")}
            lower = _corners(pairs, number, number - 1, c, "low")
            upper = _corners(pairs, number, number + 1, c, "high")
            join(*lower)
            join(*upper)
            if number + 1 < len(pairs):
                _split(where, columns, c, pairs[number], pairs[number + 1], upper)
    for c, i in places:
        for side in ("left", "right"):
            if (c, i, side) not in linked:
                join((c, i, "low", 0), (c, i, "high", 0))
    walked = [_loop([where[corner] for corner in corners]) for corners in _walk(neighbours)]
    return sorted(walked, key=lambda loop: -abs(area(loop.Omega, loop.eps)))


def area(Omega: FloatArray, eps: FloatArray) -> float:
    """Return the area inside a closed polyline, positive if it runs counterclockwise."""
    return float(np.sum(Omega * np.roll(eps, -1) - np.roll(Omega, -1) * eps) / 2)


def _corners(pairs: list[tuple[int, int]], number: int, other: int, c: int, end: str) -> tuple[Corner, Corner]:
    """Return the left and right corner of the quadrilateral of a pair at its lower or upper end."""
    i, k = pairs[number]
    shares = pairs[other] if 0 <= other < len(pairs) else (-1, -1)
    split = max(number, other)
    left = (c, i, "right", split) if shares[0] == i else (c, i, end, 0)
    right = (c + 1, k, "left", split) if shares[1] == k else (c + 1, k, end, 0)
    return left, right


def _split(
    where: dict[Corner, tuple[float, float, int]],
    columns: Sequence[Column],
    c: int,
    below: tuple[int, int],
    above: tuple[int, int],
    corners: tuple[Corner, Corner],
) -> None:
    """Place the corner in which a stable gap between two pairs that share an interval begins."""
    left, right = corners
    if below[0] == above[0]:
        gap = (columns[c + 1][below[1]], columns[c + 1][above[1]])
        Omega = where[c, below[0], "low", 0][0]
        where[left] = (Omega, (gap[0].high + gap[1].low) / 2, gap[0].high_kind)
    elif below[1] == above[1]:
        gap = (columns[c][below[0]], columns[c][above[0]])
        Omega = where[c + 1, below[1], "low", 0][0]
        where[right] = (Omega, (gap[0].high + gap[1].low) / 2, gap[0].high_kind)


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


def _loop(corners: list[tuple[float, float, int]]) -> Loop:
    Omega, eps, kind = zip(*corners, strict=True)
    loop = Loop(np.array(Omega), np.array(eps), np.array(kind, dtype=np.int8))
    for array in loop:
        array.setflags(write=False)
    return loop
