"""One column of a scan: in which intervals of eps each subsystem is unstable, as exactly as its edges need.

The amplitudes of a window are the same in all columns, so that modes can be followed from one column to the next. They
are too few to see a narrow stable gap, or an edge that bends. There a column has more of its own: where the most
unstable pair of multipliers is another one at the next amplitude, or where its f falls towards a gap from both sides.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from floquet.engine import ERROR_SAFETY, Sampler, Subsystem, Workspace, dominant, judge, log2_steps, spectra
from floquet.kind import Kind
from floquet.regions.outlines import Column, Interval
from floquet.regions.tracking import (
    UNIT_CIRCLE_TOLERANCE,
    LogMultipliers,
    edge_between,
    log_multipliers,
    may_have_gap,
    strongest_pair,
)
from periodic.checks import FloatArray

# Error of the multipliers, as `floquet.engine.stability` has it. What is wide enough for a scan is far more unstable.
SCAN_ERROR = 1e-7
# Edges in eps are found, and stable gaps looked for, to this part of the tolerance.
COLUMN_RESOLUTION = 0.25
# Rounds of additional amplitudes: each halves what is unknown.
MAX_COLUMN_ROUNDS = 12
# An additional amplitude is no nearer to its neighbours than this part of their distance.
MIN_AMPLITUDE_DISTANCE = 0.1


class Grid(NamedTuple):
    """The amplitudes ``eps`` (k,) of all columns of a scan, and how finely each column looks between them.

    From ``bottom`` upwards, edges and gaps are found to ``resolution``. ``steps`` are those in one cycle of the fastest
    motion.
    """

    eps: FloatArray
    bottom: float
    resolution: float
    steps: float


class SubsystemColumn(NamedTuple):
    """A subsystem and log mu of its modes in a column, in no order."""

    subsystem: Subsystem
    found: LogMultipliers


class ScannedSubsystem(NamedTuple):
    """What a scanned column says of one subsystem: log mu of its modes, and its unstable intervals.

    ``strongest`` (2, k) has f and the mark of `strongest_pair`, NaN where the subsystem is stable.
    """

    column: SubsystemColumn
    intervals: Column
    strongest: FloatArray


class _Cells(NamedTuple):
    """Multipliers of a subsystem at increasing amplitudes, arrays (k,), their kind, and which have left the circle."""

    eps: FloatArray
    modes: LogMultipliers
    kind: NDArray[np.int8]
    off_circle: NDArray[np.bool_]

    def unstable(self, conservative: bool) -> NDArray[np.bool_]:
        """Return where the subsystem is unstable; next to an edge that may be too weak to be judged, but seen."""
        judged = self.kind > Kind.STABLE
        return _with_neighbours(judged, self.off_circle) if conservative else judged

    def with_more(self, others: Sequence[_Cells]) -> _Cells:
        """Return these cells and some others, by increasing amplitude."""
        eps = np.concatenate([self.eps, *(one.eps for one in others)])
        order = np.argsort(eps)
        modes = (np.concatenate(parts)[order] for parts in zip(self.modes, *(one.modes for one in others), strict=True))
        kind = np.concatenate([self.kind, *(one.kind for one in others)])[order]
        off_circle = np.concatenate([self.off_circle, *(one.off_circle for one in others)])[order]
        return _Cells(eps[order], LogMultipliers(*modes), kind, off_circle)


def scan_subsystem(subsystem: Subsystem, Omega: float, grid: Grid, work: Workspace) -> ScannedSubsystem:
    """Return what a column says of one subsystem.

    The error is not measured, which would double the cost. The steps are short enough for it to be below SCAN_ERROR,
    and the integrator of `floquet.monodromy` verifies every region in the end.
    """
    sampler, L = Sampler.of(subsystem, Omega, work), log2_steps(subsystem, Omega, grid.eps, grid.steps)
    cells, conservative = _cells(sampler, grid.eps, L), subsystem.reciprocal
    unstable = cells.unstable(conservative)
    strongest = np.where(unstable, np.array(strongest_pair(cells.modes)), np.nan)
    column = SubsystemColumn(subsystem, cells.modes)
    for _ in range(MAX_COLUMN_ROUNDS):
        intervals, wanted = _intervals(cells, grid, conservative)
        if not wanted:
            break
        cells = cells.with_more([_cells(sampler, np.array([eps]), L) for eps in wanted])
    return ScannedSubsystem(column, intervals, strongest)


def _cells(sampler: Sampler, eps: FloatArray, L: int) -> _Cells:
    found = spectra(sampler, eps, L, SCAN_ERROR)
    modes, subsystem = log_multipliers(found), sampler.subsystem
    error = ERROR_SAFETY * SCAN_ERROR * found.losses
    kind = judge(dominant(found, subsystem.reversible), error, subsystem.reciprocal).kind
    off_circle = (np.abs(modes.modulus) + modes.half_difference).max(axis=1) > UNIT_CIRCLE_TOLERANCE
    return _Cells(eps, modes, kind, off_circle)


def _intervals(cells: _Cells, grid: Grid, conservative: bool) -> tuple[Column, list[float]]:
    """Return the unstable intervals, and at which amplitudes the column should be looked at to know them better."""
    eps, modes, kind = cells.eps, cells.modes, cells.kind
    column, wanted = [], []
    for first, last in _runs(cells.unstable(conservative)):
        ends = [eps[first], eps[last]]
        for end, inside, outside, further in (
            (0, first, first - 1, min(first + 1, last)),
            (1, last, last + 1, max(last - 1, first)),
        ):
            if not 0 <= outside < len(eps):
                continue
            ends[end], uncertainty = edge_between(modes, eps, outside, inside, further, conservative)
            if uncertainty > grid.resolution and max(eps[inside], eps[outside]) > grid.bottom:
                nearest = MIN_AMPLITUDE_DISTANCE * (eps[inside] - eps[outside])
                bounds = sorted((eps[outside] + nearest, eps[inside] - nearest))
                wanted.append(float(np.clip(ends[end], *bounds)))
        for c in range(first, last):
            is_wide = eps[c + 1] - eps[c] > grid.resolution and eps[c + 1] > grid.bottom
            if is_wide and may_have_gap(modes, eps, c, first, last, conservative):
                wanted.append(float(eps[c] + eps[c + 1]) / 2)
        judged = kind[first : last + 1][kind[first : last + 1] > Kind.STABLE]
        column.append(Interval(float(ends[0]), float(ends[1]), int(judged[0]), int(judged[-1])))
    return column, sorted(set(wanted))


def _runs(true: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """Return the first and the last place of each run of true ones."""
    changes = np.flatnonzero(np.diff(np.concatenate([[False], true, [False]]).astype(np.int8)))
    return list(zip(changes[::2].tolist(), (changes[1::2] - 1).tolist(), strict=True))


def _with_neighbours(sure: NDArray[np.bool_], likely: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return the runs of likely amplitudes that touch a sure one, and the sure ones."""
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
        amplitudes = np.searchsorted(eps, [interval.low for interval in column], side="right")
        strength = np.nan_to_num(rates[np.minimum(amplitudes, len(eps) - 1)])
        found += [(int(place), -float(f), one) for place, f, one in zip(amplitudes, strength, column, strict=True)]
    joined: Column = []
    for _, _, one in sorted(found):
        if joined and one.low <= joined[-1].high:
            joined[-1] = joined[-1]._replace(low=min(one.low, joined[-1].low))
            if one.high > joined[-1].high:
                joined[-1] = joined[-1]._replace(high=one.high, high_kind=one.high_kind)
        else:
            joined.append(one)
    return joined
