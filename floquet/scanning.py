"""Columns of the plane, placed where the regions of instability need them: intervals of eps unstable at each Omega."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from joblib import Parallel, delayed

from floquet.column import Columns, chart_block, steps_needed
from floquet.multipliers import Kind
from floquet.outline import Column, Interval, links
from periodic import SystemFamily
from periodic.checks import FloatArray

# Amplitudes of a column are this part of their range apart; an end of an interval is interpolated between two.
AMPLITUDES = 128
# Enough columns to hide joblib's overhead, few enough to balance the load.
COLUMNS_A_TASK = 8


class Scan:
    """Columns of a family over a range of eps, computed when asked for and kept."""

    def __init__(self, family: SystemFamily, Omega_range: tuple[float, float], eps: FloatArray, n_jobs: Any) -> None:
        self.family, self.eps = family, eps
        few = np.array([Omega_range[0], sum(Omega_range) / 2, Omega_range[1]])
        self.steps = steps_needed([family.at(float(w)) for w in few], few, eps)
        self.parallel = Parallel(n_jobs=n_jobs, prefer="threads", batch_size=1)
        self.columns: dict[float, Column] = {}

    def add(self, Omega: Iterable[float]) -> int:
        """Compute the columns at ``Omega`` that are new; return how many."""
        new = sorted({float(w) for w in Omega} - self.columns.keys())
        batches = [new[i : i + COLUMNS_A_TASK] for i in range(0, len(new), COLUMNS_A_TASK)]
        tasks = (
            delayed(chart_block)([self.family.at(w) for w in batch], np.array(batch), self.eps, self.steps)
            for batch in batches
        )
        for batch, cells in zip(batches, self.parallel(tasks), strict=True):
            for c, w in enumerate(batch):
                self.columns[w] = intervals(self.eps, *(cells_of(cells, c)))
        return len(new)

    def ordered(self) -> tuple[FloatArray, list[Column]]:
        """Return the frequencies of all columns, increasing, and the columns."""
        Omega = sorted(self.columns)
        return np.array(Omega), [self.columns[w] for w in Omega]

    def refine(self, low: float, high: float, unit: float, tolerance: float, finest: float) -> None:
        """Halve the slabs between low and high until straight lines between columns describe the edges.

        ``unit`` is the range of Omega that counts like the whole range of eps; ``tolerance`` the largest distance of an
        edge from the straight line, as part of the ranges; ``finest`` the narrowest slab that is halved.
        """
        while True:
            Omega, columns = self.ordered()
            inside = (Omega[:-1] >= low) & (Omega[1:] <= high) & (np.diff(Omega) > finest)
            coarse = [c for c in np.flatnonzero(inside) if self._is_coarse(Omega, columns, int(c), unit, tolerance)]
            if not self.add((Omega[c] + Omega[c + 1]) / 2 for c in coarse):
                return

    def _is_coarse(self, Omega: FloatArray, columns: list[Column], c: int, unit: float, tolerance: float) -> bool:
        left, right = columns[c], columns[c + 1]
        pairs = links(left, right)
        if len({i for i, _ in pairs}) < len(left) or len({k for _, k in pairs}) < len(right):
            return True
        if len(pairs) > len(left) or len(pairs) > len(right):
            return True
        height = self.eps[-1] - self.eps[0]
        for i, k in pairs:
            for end in (0, 1):
                slope = (right[k][end] - left[i][end]) / (Omega[c + 1] - Omega[c]) * unit / height
                sag = 0.0
                if c > 0:
                    before = [a for a, b in links(columns[c - 1], left) if b == i]
                    if len(before) == 1:
                        sag = _sag(Omega[c - 1 : c + 2], [columns[c - 1][before[0]][end], left[i][end], right[k][end]])
                if c + 2 < len(columns):
                    after = [b for a, b in links(right, columns[c + 2]) if a == k]
                    if len(after) == 1:
                        points = [left[i][end], right[k][end], columns[c + 2][after[0]][end]]
                        width = Omega[c + 1] - Omega[c]
                        sag = max(sag, _sag(Omega[c : c + 3], points) * 1.0) if width > 0 else sag
                step = Omega[c + 1] - Omega[c]
                if sag * step**2 / height > tolerance * np.hypot(1, slope):
                    return True
        return False


def _sag(Omega: FloatArray, eps: list[float]) -> float:
    """Return |second derivative| / 8 through three points: times the square of a step, how far a chord is off."""
    first, second = (eps[1] - eps[0]) / (Omega[1] - Omega[0]), (eps[2] - eps[1]) / (Omega[2] - Omega[1])
    return abs(second - first) / (Omega[2] - Omega[0]) / 4


def cells_of(cells: Columns, c: int) -> tuple[FloatArray, Any]:
    """Return growth rates and kinds of one column."""
    return cells.growth_rate[:, c], cells.kind[:, c]


def intervals(eps: FloatArray, growth: FloatArray, kind: Any) -> Column:
    """Return the unstable intervals of a column from its growth rates and kinds (k,)."""
    unstable = np.concatenate([[False], kind > Kind.STABLE, [False]])
    starts = np.flatnonzero(~unstable[:-1] & unstable[1:]).tolist()
    stops = (np.flatnonzero(unstable[:-1] & ~unstable[1:]) - 1).tolist()
    column = []
    for first, last in zip(starts, stops, strict=True):
        low = eps[0] if first == 0 else _end(eps, growth, first - 1, first, min(first + 1, last))
        high = eps[-1] if last == len(eps) - 1 else _end(eps, growth, last + 1, last, max(last - 1, first))
        peak = first + int(np.argmax(growth[first : last + 1]))
        column.append(Interval(float(low), float(high), int(kind[first]), int(kind[last]), float(eps[peak])))
    return column


def _end(eps: FloatArray, growth: FloatArray, outside: int, inside: int, further: int) -> float:
    """Return where the growth rate is zero between two neighbouring amplitudes.

    Where two multipliers coalesce, the growth above the common decay outside rises like a square root, so that
    its square is a straight line through the two points inside.
    """
    decay = min(growth[outside], 0.0)
    near, far = (growth[inside] - decay) ** 2, (growth[further] - decay) ** 2
    a, b = eps[outside], eps[inside]
    if far > near:
        end = b - (near - decay**2) * (eps[further] - b) / (far - near)
        if min(a, b) <= end <= max(a, b):
            return float(end)
    return float((a + b) / 2)
