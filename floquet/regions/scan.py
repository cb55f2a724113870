"""Columns of the plane, placed where the regions of instability need them: intervals of eps unstable at each Omega."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from floquet.engine import (
    ERROR_SAFETY,
    MIN_STEPS_PER_CYCLE,
    Sampler,
    Subsystem,
    Workspace,
    dominant,
    judge,
    log2_steps,
    spectra,
    steps_needed,
    subsystems,
)
from floquet.kind import Kind
from floquet.regions.exponents import ROUNDING, Exponents, edge, leading, modes_of
from floquet.regions.outlines import Column, Interval
from floquet.regions.refinement import Slabs
from floquet.running import as_completed
from periodic import PeriodicSystem, SystemFamily
from periodic.checks import FloatArray

# Amplitudes in the window; an end of an interval is interpolated between two of them.
AMPLITUDES = 80
# Error of the multipliers, as `floquet.engine.stability` has it, and the steps that it takes as a part of those that
# `steps_needed` finds for an error of 1e-10: of fourth order. What is wide enough for a scan is far more unstable.
ERROR = 1e-7
FEWER = 0.25
# Slabs are halved down to this part of the tolerance.
FINEST = 0.5
# Marks of `leading` are in [0, 4 pi]; those of two subsystems are further apart.
APART = 100.0
# What is said of a family whose subsystems at one frequency are not those at others: there is nothing to follow.
OTHER_PARTS = (
    "at Omega = {:.6g} the matrices fall into other independent subsystems than elsewhere in the window; trace the "
    "frequencies below it and those above it apart"
)
# Columns on each side of a slab that decide, beyond its own two, whether it needs another one.
SEEN = 2
# Enough columns to hide joblib's overhead, few enough to balance the load.
COLUMNS_A_TASK = 8


class Modes(NamedTuple):
    """A subsystem and the exponents of its modes in a column, in no order."""

    subsystem: Subsystem
    found: Exponents


class Scan:
    """Columns of a family over a range of eps, computed when asked for and kept.

    ``modes`` has those of the subsystems of a column by their numbers, ``quiet`` the numbers of its subsystems that are
    stable at all amplitudes, or are not looked at; ``leading`` (2, k) has f and the mark of the most unstable pair of
    all subsystems, as `floquet.regions.exponents.leading` has them, NaN where the column is stable.
    """

    def __init__(self, family: SystemFamily, Omega_range: tuple[float, float], eps: FloatArray, n_jobs: Any) -> None:
        self.family, self.window, self.eps = family, Omega_range, eps
        few = np.array([Omega_range[0], sum(Omega_range) / 2, Omega_range[1]])
        systems = [family.at(float(w)) for w in few]
        self.steps = max(FEWER * steps_needed(systems, few, eps), MIN_STEPS_PER_CYCLE)
        self.sizes = [len(subsystem.K) for subsystem in subsystems(systems[0])]
        self.n_jobs = n_jobs
        self.columns: dict[float, Column] = {}
        self.modes: dict[float, dict[int, Modes]] = {}
        self.quiet: dict[float, frozenset[int]] = {}
        self.leading: dict[float, FloatArray] = {}

    def add(self, Omega: Iterable[float], spared: Mapping[float, frozenset[int]] | None = None) -> int:
        """Compute the columns at ``Omega`` that are new; return how many.

        Of those outside the window only the modes are kept. ``spared`` has the numbers of subsystems of a column that
        need not be looked at.
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
                self.sizes,
                [(spared or {}).get(w, none) for w in batch],
            )
            for batch in batches
        )
        for i, found in as_completed(_intervals, tasks, self.n_jobs):
            for w, parts in zip(batches[i], found, strict=True):
                self.modes[w] = {number: part[1] for number, part in enumerate(parts) if part is not None}
                self.quiet[w] = frozenset(n for n, part in enumerate(parts) if part is None or not part[0])
                if self.window[0] <= w <= self.window[1]:
                    self.columns[w] = union([(part[0], part[2][0]) for part in parts if part is not None], self.eps)
                    self.leading[w] = _strongest([None if part is None else part[2] for part in parts], len(self.eps))
        return len(new)

    def ordered(self) -> tuple[FloatArray, list[Column]]:
        """Return the frequencies of all columns, increasing, and the columns."""
        Omega = sorted(self.columns)
        return np.array(Omega), [self.columns[w] for w in Omega]

    def most_unstable(self, Omega: float, eps: float) -> int:
        """Return the number of modes of the subsystem that is most unstable at ``eps`` in the column at ``Omega``."""
        level = int(np.abs(self.eps - eps).argmin())
        modes = self.modes[Omega].values()
        return max(((found.modulus + found.split)[level].max(), len(subsystem.K)) for subsystem, found in modes)[1]

    def refine(self, units: tuple[float, float], bottom: float, tolerance: float) -> None:
        """Halve the slabs between columns until straight lines describe the edges.

        In a slab, subsystems that are stable on both sides are spared.

        ``units`` are the ranges of Omega and eps that count alike; ``tolerance`` is the largest distance of an edge
        from the straight line, as part of them. Above eps = ``bottom`` is what will be seen.
        """
        finest = FINEST * tolerance * units[0]
        settled: set[tuple[float, ...]] = set()
        while True:
            Omega, columns = self.ordered()
            leading = np.array([self.leading[w] for w in Omega.tolist()])[:, :, self.eps >= bottom]
            slabs = Slabs(Omega, columns, leading, units, bottom, tolerance, finest)
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


def _intervals(
    systems: Sequence[PeriodicSystem],
    Omega: Sequence[float],
    eps: FloatArray,
    steps: float,
    sizes: list[int],
    spared: Sequence[frozenset[int]],
) -> list[list[tuple[Column, Modes, FloatArray] | None]]:
    """Return what `_of_subsystem` says of the subsystems of some columns, None for those that are spared."""
    work = Workspace()
    columns = []
    for system, frequency, spare in zip(systems, Omega, spared, strict=True):
        parts = subsystems(system)
        if [len(subsystem.K) for subsystem in parts] != sizes:
            raise ValueError(OTHER_PARTS.format(frequency))
        columns.append(
            [
                None if number in spare else _of_subsystem(subsystem, frequency, eps, steps, work)
                for number, subsystem in enumerate(parts)
            ]
        )
    return columns


def _of_subsystem(
    subsystem: Subsystem, Omega: float, eps: FloatArray, steps: float, work: Workspace
) -> tuple[Column, Modes, FloatArray]:
    """Return a column of a subsystem, its modes and, (2, k), f and the mark of the most unstable pair, NaN where
    stable.

    The error is not measured, which would double the cost.

    The steps are short enough for it to be below ERROR; every region is verified by `floquet.monodromy` in the end.
    """
    sampler = Sampler.of(subsystem, Omega, work)
    found = spectra(sampler, eps, log2_steps(subsystem, Omega, eps, steps), ERROR)
    conservative = subsystem.reciprocal
    modes = modes_of(found)
    kind = judge(dominant(found, subsystem.reversible), ERROR_SAFETY * ERROR * found.losses, conservative).kind
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
    return column, Modes(subsystem, modes), np.where(unstable, np.array(leading(modes)), np.nan)


def _strongest(parts: Sequence[FloatArray | None], count: int) -> FloatArray:
    """Return f and the mark, (2, count), of the most unstable pair of all subsystems, NaN where all are stable."""
    best = np.full((2, count), np.nan)
    for number, part in enumerate(parts):
        if part is not None:
            better = np.isfinite(part[0]) & ~(part[0] <= best[0])
            best[:, better] = part[:, better] + [[0.0], [APART * number]]
    return best


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


def union(parts: Sequence[tuple[Column, FloatArray]], eps: FloatArray) -> Column:
    """Return the unstable intervals of a system from those of its subsystems and f at all amplitudes.

    Of two that begin between the same amplitudes, the more unstable one says of which kind they are there.
    """
    found = []
    for column, rates in parts:
        levels = np.searchsorted(eps, [interval.low for interval in column], side="right")
        strength = np.nan_to_num(rates[np.minimum(levels, len(eps) - 1)])
        found += [(int(level), -float(f), one) for level, f, one in zip(levels, strength, column, strict=True)]
    joined: Column = []
    for _, _, one in sorted(found):
        if joined and one.low <= joined[-1].high:
            joined[-1] = joined[-1]._replace(low=min(one.low, joined[-1].low))
            if one.high > joined[-1].high:
                joined[-1] = joined[-1]._replace(high=one.high, high_kind=one.high_kind)
        else:
            joined.append(one)
    return joined
