"""Columns of the plane, placed where the regions of instability need them: intervals of eps unstable at each Omega."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from floquet.column import LEAST_STEPS, SAFETY, least_frequency, log2_steps, multipliers, steps_needed
from floquet.coordinates import Block, blocks, equations
from floquet.exponents import ROUNDING, Exponents, edge, modes_symplectic
from floquet.exponents import modes as modes_general
from floquet.multipliers import Kind
from floquet.outline import Column, Interval, Place, links
from floquet.parallel import spread
from floquet.sampling import Sampler, Workspace
from floquet.verdict import dominant, dominant_symplectic, judge
from periodic import PeriodicSystem, SystemFamily
from periodic.checks import FloatArray

# Amplitudes in the window; an end of an interval is interpolated between two of them.
AMPLITUDES = 80
# Error of the multipliers, as `floquet.column` has it, and the steps that it takes as a part of those that
# `steps_needed` finds for an error of 1e-10: of fourth order. What is wide enough for a scan is far more unstable.
ERROR = 1e-7
FEWER = 0.25
# Slabs are halved down to this part of the tolerance.
FINEST = 0.5
# Next to where a region ends its edges bend most: there, they may be off by this part of the tolerance.
ONE_SIDED = 0.25
# A column is placed no nearer to another one than this part of the slab.
NOT_NEARER = 0.05
# Columns on each side of a slab that decide, beyond its own two, whether it needs another one.
SEEN = 2
# Enough columns to hide joblib's overhead, few enough to balance the load.
COLUMNS_A_TASK = 8


class Modes(NamedTuple):
    """A block and the exponents of its modes in a column, in no order."""

    block: Block
    found: Exponents


class Scan:
    """Columns of a family over a range of eps, computed when asked for and kept.

    ``modes`` has those of the blocks of a column by their numbers, ``quiet`` the numbers of its blocks that are stable
    at all amplitudes, or are not looked at.
    """

    def __init__(self, family: SystemFamily, Omega_range: tuple[float, float], eps: FloatArray, n_jobs: Any) -> None:
        self.family, self.window, self.eps = family, Omega_range, eps
        few = np.array([Omega_range[0], sum(Omega_range) / 2, Omega_range[1]])
        self.steps = max(FEWER * steps_needed([family.at(float(w)) for w in few], few, eps), LEAST_STEPS)
        self.n_jobs = n_jobs
        self.columns: dict[float, Column] = {}
        self.modes: dict[float, dict[int, Modes]] = {}
        self.quiet: dict[float, frozenset[int]] = {}

    def add(self, Omega: Iterable[float], spared: Mapping[float, frozenset[int]] | None = None) -> int:
        """Compute the columns at ``Omega`` that are new; return how many.

        Of those outside the window only the modes are kept. ``spared`` has the numbers of blocks of a column that need
        not be looked at.
        """
        new = sorted({float(w) for w in Omega} - self.modes.keys())
        batches = [new[i : i + COLUMNS_A_TASK] for i in range(0, len(new), COLUMNS_A_TASK)]
        none: frozenset[int] = frozenset()
        tasks = (
            (
                [self.family.at(w) for w in batch],
                batch,
                self.eps,
                self.steps,
                [(spared or {}).get(w, none) for w in batch],
            )
            for batch in batches
        )
        for i, found in spread(_intervals, tasks, self.n_jobs):
            for w, parts in zip(batches[i], found, strict=True):
                self.modes[w] = {number: part[1] for number, part in enumerate(parts) if part is not None}
                self.quiet[w] = frozenset(n for n, part in enumerate(parts) if part is None or not part[0])
                if self.window[0] <= w <= self.window[1]:
                    self.columns[w] = union([part[0] for part in parts if part is not None])
        return len(new)

    def ordered(self) -> tuple[FloatArray, list[Column]]:
        """Return the frequencies of all columns, increasing, and the columns."""
        Omega = sorted(self.columns)
        return np.array(Omega), [self.columns[w] for w in Omega]

    def most_unstable(self, Omega: float, eps: float) -> int:
        """Return the number of modes of the block that is most unstable at ``eps`` in the column at ``Omega``."""
        level = int(np.abs(self.eps - eps).argmin())
        modes = self.modes[Omega].values()
        return max(((found.modulus + found.split)[level].max(), len(block.K)) for block, found in modes)[1]

    def refine(self, units: tuple[float, float], bottom: float, tolerance: float) -> None:
        """Halve the slabs between columns until straight lines describe the edges.

        In a slab, blocks that are stable on both sides are spared.

        ``units`` are the ranges of Omega and eps that count alike; ``tolerance`` is the largest distance of an edge
        from the straight line, as part of them. Above eps = ``bottom`` is what will be seen.
        """
        finest = FINEST * tolerance * units[0]
        settled: set[tuple[float, ...]] = set()
        while True:
            Omega, columns = self.ordered()
            slabs = _Slabs(Omega, columns, units, bottom, tolerance, finest)
            new: dict[float, frozenset[int]] = {}
            for c in np.flatnonzero(np.diff(Omega) > 1.5 * finest).tolist():
                around = tuple(Omega[max(c - SEEN, 0) : c + SEEN + 2].tolist())
                if around not in settled:  # a slab is looked at again when a column near it is new
                    places = slabs.place(c)
                    quiet = self.quiet[float(Omega[c])] & self.quiet[float(Omega[c + 1])]
                    new |= {float(place): quiet for place in places}
                    if not places:
                        settled.add(around)
            if not self.add(new, new):
                return


class _Slabs:
    """What is between the columns: where one more column is needed."""

    def __init__(
        self,
        Omega: FloatArray,
        columns: Sequence[Column],
        units: tuple[float, float],
        bottom: float,
        tolerance: float,
        finest: float,
    ) -> None:
        self.Omega, self.columns, self.units = Omega, columns, units
        self.bottom, self.tolerance, self.finest = bottom, tolerance, finest
        self.links = [links(left, right) for left, right in pairwise(columns)]

    def place(self, c: int) -> list[float]:
        """Return where slab ``c``, between columns c and c + 1, needs a column."""
        pairs = self.links[c]
        left, right = [i for i, _ in pairs], [k for _, k in pairs]
        # an interval without neighbours may be a region too narrow to be followed: one column close by decides
        ends = [i for i in range(len(self.columns[c])) if i not in left and not self._is_settled(c, i, 1)]
        begins = [k for k in range(len(self.columns[c + 1])) if k not in right and not self._is_settled(c + 1, k, -1)]
        if ends and all(self._is_alone(c, i) for i in ends) and not begins:
            return [self.Omega[c] + self.finest]
        if ends or (begins and not all(self._is_alone(c + 1, k) for k in begins)):
            return [(self.Omega[c] + self.Omega[c + 1]) / 2]
        if len(set(left)) < len(left) or len(set(right)) < len(right) or self._bends(c):
            return [(self.Omega[c] + self.Omega[c + 1]) / 2]
        return self._appearances(c)

    def _appearances(self, c: int) -> list[float]:
        """Return where edges go through the bottom of the window, far from both columns."""
        places = []
        for i, k in self.links[c]:
            for a, b in zip(self.columns[c][i][:2], self.columns[c + 1][k][:2], strict=True):
                if min(a, b) < self.bottom < max(a, b):
                    part = min(max((self.bottom - a) / (b - a), NOT_NEARER), 1 - NOT_NEARER)
                    if abs(b - a) * min(part, 1 - part) > self.tolerance * self.units[1]:
                        places.append(self.Omega[c] + part * (self.Omega[c + 1] - self.Omega[c]))
        return places

    def _is_alone(self, c: int, i: int) -> bool:
        before = c > 0 and any(k == i for _, k in self.links[c - 1])
        after = c + 1 < len(self.columns) and any(k == i for k, _ in self.links[c])
        return not before and not after

    def _is_thin(self, c: int, i: int) -> bool:
        """Whether an interval is alone although a column is close by."""
        widths = np.diff(self.Omega[max(c - 1, 0) : c + 2])
        return self._is_alone(c, i) and bool(widths.min() <= 1.5 * self.finest)

    def _is_settled(self, c: int, i: int, step: int) -> bool:
        """Whether it is known well enough where an interval ends on its way to column c + step."""
        return self._is_thin(c, i) or self._is_foreseen(c, i, step)

    def _is_foreseen(self, c: int, i: int, step: int) -> bool:
        """Whether the edges of an interval meet before column c + step if they go on from the last columns, with a
        curvature that moves the place by less than the tolerance: most of all, an edge meets that of the window."""
        chain = self._chain(c, i, step, 3)
        if len(chain) < 3:
            return False
        x, y = self._sides(chain)
        way = _way(x, y)
        if way > abs(self.Omega[c + step] - self.Omega[c]) / self.units[0]:
            return False
        slope = np.diff(y, axis=0) / np.diff(x)[:, None]
        off = np.abs(slope[1] - slope[0]) / x[2] * way * (way + x[1])
        return bool((off <= self.tolerance * np.hypot(1, slope[0])).all())

    def _chain(self, c: int, i: int, step: int, count: int) -> list[Place]:
        """Return an interval and those before it, on the way to column c + step: ``count`` of them, or fewer if one is
        linked to none or several."""
        chain = [(c, i)]
        while len(chain) < count and 0 <= chain[-1][0] - step < len(self.columns):
            last, number = chain[-1]
            pairs = self.links[min(last - step, last)]
            inner = [k if step < 0 else j for j, k in pairs if (j if step < 0 else k) == number]
            if len(inner) != 1:
                break
            chain.append((last - step, inner[0]))
        return chain

    def _sides(self, chain: Sequence[Place]) -> tuple[FloatArray, FloatArray]:
        """Return how far the intervals of a chain are from its first one, (k,), and both ends of each, (k, 2)."""
        x = np.abs(self.Omega[[c for c, _ in chain]] - self.Omega[chain[0][0]]) / self.units[0]
        return x, np.array([self.columns[c][i][:2] for c, i in chain]) / self.units[1]

    def _bends(self, c: int) -> bool:
        """Whether an edge that goes through slab ``c`` is further from a straight line than the tolerance."""
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
            here = int(len(before) == 1)  # the number of this slab in the chain
            one_sided = len(chain) < 4
            if one_sided and h[here] > 2 * np.delete(h, here).max(initial=0.0):
                return True  # a curvature measured over so short a way says little
            for end in (0, 1):
                y = np.array([self.columns[a][b][end] for a, b in chain]) / self.units[1]
                slope = np.diff(y) / h
                curvature = 2 * np.abs(np.diff(slope)) / (h[1:] + h[:-1])
                sag = curvature.max(initial=0.0) * h[here] ** 2 / 8
                steep = abs(slope[here])
                if here == 1 and len(slope) == 3 and not slope.min() < slope[1] < slope.max():
                    steep = np.abs(slope).min()  # where an edge jumps, it is off the chord along its flat part
                if sag > self.tolerance * np.hypot(1, steep) * (ONE_SIDED if one_sided else 1.0):
                    return True
        return False


def _way(x: FloatArray, y: FloatArray) -> float:
    """Return how far from the first interval of a chain its edges meet, if they go on straight; infinite if nowhere."""
    width = y[:, 1] - y[:, 0]
    return float(width[0] * x[1] / (width[1] - width[0])) if width[1] > width[0] else np.inf


def _intervals(
    systems: Sequence[PeriodicSystem],
    Omega: Sequence[float],
    eps: FloatArray,
    steps: float,
    spared: Sequence[frozenset[int]],
) -> list[list[tuple[Column, Modes] | None]]:
    """Return the unstable intervals and the modes of the blocks of some columns, None for those that are spared."""
    work = Workspace()
    return [
        [
            None if number in spare else _of_block(block, frequency, eps, steps, work)
            for number, block in enumerate(blocks(system))
        ]
        for system, frequency, spare in zip(systems, Omega, spared, strict=True)
    ]


def _of_block(block: Block, Omega: float, eps: FloatArray, steps: float, work: Workspace) -> tuple[Column, Modes]:
    """Return a column of a block without measuring its error, which would double the cost.

    The steps are short enough for it to be below ERROR; every region is verified by `floquet.monodromy` in the end.
    """
    sampler = Sampler(block, equations(block, least_frequency(Omega)), Omega, work)
    mu, exponents, losses, norms = multipliers(sampler, eps, log2_steps(block, Omega, eps, steps), ERROR)
    conservative = block.symplectic or block.reversible
    if block.symplectic:
        found, modes = dominant_symplectic(mu, exponents, norms), modes_symplectic(mu, exponents)
    else:
        found, modes = dominant(mu, exponents, norms, block.reversible), modes_general(mu, exponents)
    kind = judge(found, SAFETY * ERROR * losses, conservative).kind
    unstable = kind > Kind.STABLE
    if conservative:  # next to an edge it is too weak to be judged, but seen
        unstable = _with_neighbours(unstable, (np.abs(modes.modulus) + modes.split).max(axis=1) > ROUNDING)
    column = []
    for first, last in _runs(unstable):
        low, high = eps[first], eps[last]
        if first > 0:
            low = edge(modes, eps, first - 1, first, min(first + 1, last), conservative)
        if last < len(eps) - 1:
            high = edge(modes, eps, last + 1, last, max(last - 1, first), conservative)
        judged = kind[first : last + 1][kind[first : last + 1] > Kind.STABLE]
        column.append(Interval(float(low), float(high), int(judged[0]), int(judged[-1])))
    return column, Modes(block, modes)


def _runs(true: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """Return the first and the last place of each run of true ones."""
    found, start = [], -1
    for i, one in enumerate([*true.tolist(), False]):
        if one and start < 0:
            start = i
        elif start >= 0 and not one:
            found.append((start, i - 1))
            start = -1
    return found


def _with_neighbours(sure: NDArray[np.bool_], likely: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return the runs of likely cells that touch a sure one, and the sure ones."""
    either = sure | likely
    for first, last in _runs(either):
        if not sure[first : last + 1].any():
            either[first : last + 1] = False
    return either


def union(columns: Sequence[Column]) -> Column:
    """Return the unstable intervals of a system from those of its blocks."""
    joined: Column = []
    for one in sorted(interval for column in columns for interval in column):
        if joined and one.low <= joined[-1].high:
            if one.high > joined[-1].high:
                joined[-1] = joined[-1]._replace(high=one.high, high_kind=one.high_kind)
        else:
            joined.append(one)
    return joined
