"""The spans between the columns of a scan: which need another column, since edges are not straight in them."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from floquet.regions.outlines import Column, IntervalId, links
from floquet.regions.window import Window
from periodic.checks import FloatArray

# Spans are divided down to this part of the tolerance.
FINEST_SPAN = 0.5
# A span is divided if it is wider than this many times the finest one.
DIVISIBLE = 1.5
# Columns on each side of a span that decide, beyond its own two, whether it needs another one.
COLUMNS_SEEN = 2
# Where an edge is known on one side only, it may be off by this part of the tolerance: there edges bend most.
ONE_SIDED_TOLERANCE = 0.25
# On one side only, curvature is not trusted in a span this many times as wide as those it was measured over.
MAX_EXTRAPOLATED_SPAN = 2.0
# A column is placed no nearer to another one than this part of the span.
MIN_COLUMN_DISTANCE = 0.05
# Marks of `strongest_pair` that differ by more, in rad, are those of two regions.
MAX_MARK_DIFFERENCE = 0.1


class Refinement:
    """Columns of a ``window`` at ``Omega`` (columns,), increasing, and where another one is needed between them.

    ``strongest`` (columns, 2, k) has f and the mark of the most unstable pair at the amplitudes in the window, as
    `strongest_pair` has them, NaN where a column is stable.
    """

    def __init__(self, window: Window, Omega: FloatArray, columns: Sequence[Column], strongest: FloatArray) -> None:
        self.Omega, self.columns, self.strongest = Omega, columns, strongest
        self.units, self.bottom, self.tolerance = (window.width, window.height), window.eps_range[0], window.tolerance
        self.finest = FINEST_SPAN * window.tolerance * window.width
        self.links = [links(left, right) for left, right in pairwise(columns)]

    @property
    def divisible(self) -> list[int]:
        """The spans that are wide enough to be divided; span ``c`` is between columns c and c + 1."""
        return np.flatnonzero(np.diff(self.Omega) > DIVISIBLE * self.finest).tolist()

    def around(self, c: int) -> tuple[float, ...]:
        """Return the frequencies of the columns that decide about span ``c``."""
        return tuple(self.Omega[max(c - COLUMNS_SEEN, 0) : c + COLUMNS_SEEN + 2].tolist())

    def places(self, c: int) -> list[float]:
        """Return where span ``c`` needs a column."""
        pairs = self.links[c]
        left, right = [i for i, _ in pairs], [k for _, k in pairs]
        # an interval without neighbours may be a region too narrow to be followed: one column close by decides
        ends = [i for i in range(len(self.columns[c])) if i not in left and not self._is_settled(c, i, 1)]
        begins = [k for k in range(len(self.columns[c + 1])) if k not in right and not self._is_settled(c + 1, k, -1)]
        alone = all(self._is_alone(c + 1, k) for k in begins)
        if ends and all(self._is_alone(c, i) for i in ends) and not begins:
            return [self.Omega[c] + self.finest]
        if ends or (begins and not alone):
            return [(self.Omega[c] + self.Omega[c + 1]) / 2]
        if begins and c + 2 == len(self.Omega):
            return [self.Omega[c + 1] - self.finest]
        if len(set(left)) < len(left) or len(set(right)) < len(right) or self._bends(c):
            return [(self.Omega[c] + self.Omega[c + 1]) / 2]
        return self._gaps(c) or self._appearances(c)

    def _gaps(self, c: int) -> list[float]:
        """Return where the span may be stable between two regions that meet its two columns: in the widest gap."""
        end, begin = self._ends(c, -1), self._ends(c + 1, 1)
        mark, other = self.strongest[c : c + 2, 1]
        differ = np.abs(mark - other) > MAX_MARK_DIFFERENCE
        # a region that meets one column only may end at once
        end = np.where(differ & np.isnan(end), self.Omega[c], end)
        begin = np.where(differ & np.isnan(begin), self.Omega[c + 1], begin)
        gap = np.where(np.isfinite(mark) & np.isfinite(other) & (begin > end), begin - end, 0.0)
        widest = int(gap.argmax())
        if gap[widest] == 0:
            return []
        near = MIN_COLUMN_DISTANCE * (self.Omega[c + 1] - self.Omega[c])
        centre = (end[widest] + begin[widest]) / 2
        return [float(np.clip(centre, self.Omega[c] + near, self.Omega[c + 1] - near))]

    def _ends(self, c: int, step: int) -> FloatArray:
        """Return where the region that meets column c ends, coming from column c + step, at all amplitudes (k,).

        f falls to an edge like a parabola, so its zero is not further away than that of the straight line through the
        two columns. That is infinitely far if f does not fall. It is NaN if column c + step meets no region, or another
        one.
        """
        if not 0 <= c + step < len(self.columns):
            return np.full(self.strongest.shape[2], np.nan)
        (f, mark), (before, other) = self.strongest[[c, c + step]]
        falls = before > f
        way = (self.Omega[c] - self.Omega[c + step]) * f / np.where(falls, before - f, 1.0)
        end = np.where(falls, self.Omega[c] + way, -step * np.inf)
        return np.where(np.abs(mark - other) <= MAX_MARK_DIFFERENCE, end, np.nan)

    def _appearances(self, c: int) -> list[float]:
        """Return where edges go through the bottom of the window, far from both columns."""
        places = []
        for i, k in self.links[c]:
            for a, b in zip(self.columns[c][i][:2], self.columns[c + 1][k][:2], strict=True):
                if min(a, b) < self.bottom < max(a, b):
                    part = min(max((self.bottom - a) / (b - a), MIN_COLUMN_DISTANCE), 1 - MIN_COLUMN_DISTANCE)
                    if abs(b - a) * min(part, 1 - part) > self.tolerance * self.units[1]:
                        places.append(self.Omega[c] + part * (self.Omega[c + 1] - self.Omega[c]))
        return places

    def _is_alone(self, c: int, i: int) -> bool:
        before = c > 0 and any(k == i for _, k in self.links[c - 1])
        after = c + 1 < len(self.columns) and any(k == i for k, _ in self.links[c])
        return not before and not after

    def _is_thin(self, c: int, i: int) -> bool:
        """Whether an interval overlaps with none, although a column is close by."""
        widths = np.diff(self.Omega[max(c - 1, 0) : c + 2])
        return self._is_alone(c, i) and bool(widths.min() <= DIVISIBLE * self.finest)

    def _is_settled(self, c: int, i: int, step: int) -> bool:
        """Whether it is known well enough where an interval ends on its way to column c + step."""
        return self._is_thin(c, i) or self._is_foreseen(c, i, step)

    def _is_foreseen(self, c: int, i: int, step: int) -> bool:
        """Whether the edges of an interval surely meet before column c + step, most often at an edge of the window.

        They go on straight from the last columns, which are of one kind, and their curvature hardly moves the place.
        """
        chain = self._chain(c, i, step, 3)
        if len(chain) < 3 or len({self.columns[a][b].low_kind for a, b in chain}) > 1:
            return False
        x, y = self._sides(chain)
        way = _distance_to_tip(x, y)
        if way > abs(self.Omega[c + step] - self.Omega[c]) / self.units[0]:
            return False
        slope = np.diff(y, axis=0) / np.diff(x)[:, None]
        off = np.abs(slope[1] - slope[0]) / x[2] * way * (way + x[1])
        return bool((off <= ONE_SIDED_TOLERANCE * self.tolerance * np.hypot(1, slope[0])).all())

    def _chain(self, c: int, i: int, step: int, count: int) -> list[IntervalId]:
        """Return an interval and those before it on the way to column c + step.

        There are ``count``, or fewer if one of them is linked to none or to several.
        """
        chain = [(c, i)]
        while len(chain) < count and 0 <= chain[-1][0] - step < len(self.columns):
            last, number = chain[-1]
            pairs = self.links[min(last - step, last)]
            inner = [k if step < 0 else j for j, k in pairs if (j if step < 0 else k) == number]
            if len(inner) != 1:
                break
            chain.append((last - step, inner[0]))
        return chain

    def _sides(self, chain: Sequence[IntervalId]) -> tuple[FloatArray, FloatArray]:
        """Return how far the intervals of a chain are from its first one, (k,), and both ends of each, (k, 2)."""
        x = np.abs(self.Omega[[c for c, _ in chain]] - self.Omega[chain[0][0]]) / self.units[0]
        return x, np.array([self.columns[c][i][:2] for c, i in chain]) / self.units[1]

    def _bends(self, c: int) -> bool:
        """Whether an edge in span ``c`` is further from a straight line than the tolerance."""
        for i, k in self.links[c]:
            before = [a for a, b in self.links[c - 1] if b == i] if c > 0 else []
            after = [b for a, b in self.links[c + 1] if a == k] if c + 2 < len(self.columns) else []
            chain = [(c, i), (c + 1, k)]
            if len(before) == 1:
                chain.insert(0, (c - 1, before[0]))
            if len(after) == 1:
                chain.append((c + 2, after[0]))
            x = self.Omega[[a for a, _ in chain]] / self.units[0]
            h = np.diff(x)
            here = int(len(before) == 1)  # the number of this span in the chain
            one_sided = len(chain) < 4
            if one_sided and h[here] > MAX_EXTRAPOLATED_SPAN * np.delete(h, here).max(initial=0.0):
                return True  # a curvature measured over so short a way says little
            for end in (0, 1):
                if self._turns((c, i), (c + 1, k), end):
                    return True
                y = np.array([self.columns[a][b][end] for a, b in chain]) / self.units[1]
                slope = np.diff(y) / h
                curvature = 2 * np.abs(np.diff(slope)) / (h[1:] + h[:-1])
                sag = curvature.max(initial=0.0) * h[here] ** 2 / 8
                steep = abs(slope[here])
                if here == 1 and len(slope) == 3 and not slope.min() < slope[1] < slope.max():
                    steep = np.abs(slope).min()  # where an edge jumps, it is off the chord along its flat part
                if sag > self.tolerance * np.hypot(1, steep) * (ONE_SIDED_TOLERANCE if one_sided else 1.0):
                    return True
        return False

    def _turns(self, left: IntervalId, right: IntervalId, end: int) -> bool:
        """Whether an end of two linked intervals is that of two regions, at least one of them in the window."""
        a, b = (self.columns[c][i] for c, i in (left, right))
        return a[2 + end] != b[2 + end] and a[end] != b[end]


def _distance_to_tip(x: FloatArray, y: FloatArray) -> float:
    """Return how far from the first interval of a chain its edges meet if they go on straight; infinite if nowhere."""
    width = y[:, 1] - y[:, 0]
    return float(width[0] * x[1] / (width[1] - width[0])) if width[1] > width[0] else np.inf
