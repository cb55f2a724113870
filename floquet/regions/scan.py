"""Columns of the plane, placed where the regions of instability need them: intervals of eps unstable at each Omega."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

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
from floquet.regions.outlines import Column, Interval
from floquet.regions.refinement import Refinement
from floquet.regions.tracking import (
    UNIT_CIRCLE_TOLERANCE,
    LogMultipliers,
    edge_between,
    log_multipliers,
    strongest_pair,
)
from floquet.regions.window import Window
from floquet.running import as_completed
from periodic import PeriodicSystem
from periodic.checks import FloatArray

# Error of the multipliers, as `floquet.engine.stability` has it. What is wide enough for a scan is far more unstable.
SCAN_ERROR = 1e-7
# Steps of a scan as part of those that `steps_needed` finds for an error of 1e-10: the method is of fourth order.
SCAN_STEPS_RATIO = 0.25
# Marks of `strongest_pair` are in [0, 4 pi]. Those of two subsystems are further apart.
SUBSYSTEM_MARK = 100.0
# What is said of a family with other subsystems at one frequency than at others: there is nothing to follow.
OTHER_SUBSYSTEMS = (
    "at Omega = {:.6g} the matrices fall into other independent subsystems than elsewhere in the window; trace the "
    "frequencies below it and those above it apart"
)
# Enough columns to hide joblib's overhead, few enough to balance the load.
COLUMNS_PER_TASK = 8


class SubsystemColumn(NamedTuple):
    """A subsystem and log mu of its modes in a column, in no order."""

    subsystem: Subsystem
    found: LogMultipliers


class _Part(NamedTuple):
    """What a column says of one subsystem: its unstable intervals, its modes, and those of its strongest pair.

    ``strongest`` (2, k) has f and the mark of `strongest_pair`, NaN where the subsystem is stable.
    """

    intervals: Column
    modes: SubsystemColumn
    strongest: FloatArray


class Scan:
    """Columns of a window, computed when asked for and kept.

    Attributes
    ----------
    window : Window
    steps : float
        Steps in one cycle of the fastest motion.
    columns : dict
        The unstable intervals of the columns in the window, by Omega.
    subsystems : dict
        What was found for the subsystems of a column, by Omega and number, also beside the window.
    stable : dict
        Numbers of the subsystems of a column that are stable at all amplitudes, or were spared.
    strongest : dict
        f and the mark of the most unstable pair of all subsystems, (2, k), NaN where the column is stable.
    """

    def __init__(self, window: Window) -> None:
        self.window = window
        low, high = window.Omega_range
        few = np.array([low, (low + high) / 2, high])
        systems = [window.family.at(float(w)) for w in few]
        self.steps = max(SCAN_STEPS_RATIO * steps_needed(systems, few, window.amplitudes), MIN_STEPS_PER_CYCLE)
        self.sizes = [len(subsystem.K) for subsystem in subsystems(systems[0])]
        self.columns: dict[float, Column] = {}
        self.subsystems: dict[float, dict[int, SubsystemColumn]] = {}
        self.stable: dict[float, frozenset[int]] = {}
        self.strongest: dict[float, FloatArray] = {}

    def add(self, Omega: Iterable[float], spared: Mapping[float, frozenset[int]] | None = None) -> int:
        """Compute the columns at ``Omega`` that are new; return how many.

        Of those beside the window only the modes are kept. ``spared`` has the numbers of subsystems of a column that
        need not be looked at.
        """
        window, eps = self.window, self.window.amplitudes
        new = sorted({float(w) for w in Omega} - self.subsystems.keys())
        batches = [new[i : i + COLUMNS_PER_TASK] for i in range(0, len(new), COLUMNS_PER_TASK)]
        none: frozenset[int] = frozenset()
        tasks = (
            (
                [window.family.at(w) for w in batch],
                batch,
                eps,
                self.steps,
                self.sizes,
                [(spared or {}).get(w, none) for w in batch],
            )
            for batch in batches
        )
        for i, found in as_completed(_columns, tasks, window.n_jobs):
            for w, parts in zip(batches[i], found, strict=True):
                self.subsystems[w] = {number: part.modes for number, part in enumerate(parts) if part is not None}
                self.stable[w] = frozenset(n for n, part in enumerate(parts) if part is None or not part.intervals)
                if window.covers(w):
                    seen = [(part.intervals, part.strongest[0]) for part in parts if part is not None]
                    self.columns[w] = union(seen, eps)
                    self.strongest[w] = _strongest(parts, len(eps))
        return len(new)

    def ordered(self) -> tuple[FloatArray, list[Column]]:
        """Return the frequencies of all columns in the window, increasing, and the columns."""
        Omega = sorted(self.columns)
        return np.array(Omega), [self.columns[w] for w in Omega]

    def most_unstable(self, Omega: float, eps: float) -> int:
        """Return the number of modes of the subsystem that is most unstable at ``eps`` in the column at ``Omega``."""
        amplitude = int(np.abs(self.window.amplitudes - eps).argmin())
        parts = self.subsystems[Omega].values()
        return max(
            ((found.modulus + found.half_difference)[amplitude].max(), len(subsystem.K)) for subsystem, found in parts
        )[1]

    def refine(self) -> None:
        """Divide the spans between columns until straight lines describe the edges.

        In a span, subsystems that are stable on both sides are spared.
        """
        visible = self.window.amplitudes >= self.window.eps_range[0]
        settled: set[tuple[float, ...]] = set()
        while True:
            Omega, columns = self.ordered()
            strongest = np.array([self.strongest[w] for w in Omega.tolist()])[:, :, visible]
            refinement = Refinement(self.window, Omega, columns, strongest)
            new: dict[float, frozenset[int]] = {}
            for c in refinement.divisible:
                around = refinement.around(c)
                if around not in settled:  # a span is looked at again when a column near it is new
                    places = refinement.places(c)
                    stable = self.stable[float(Omega[c])] & self.stable[float(Omega[c + 1])]
                    new |= {float(place): stable for place in places}
                    if not places:
                        settled.add(around)
            if not self.add(new, new):
                return


def _columns(
    systems: Sequence[PeriodicSystem],
    Omega: Sequence[float],
    eps: FloatArray,
    steps: float,
    sizes: list[int],
    spared: Sequence[frozenset[int]],
) -> list[list[_Part | None]]:
    """Return what some columns say of their subsystems, None for those that are spared."""
    work = Workspace()
    columns = []
    for system, frequency, spare in zip(systems, Omega, spared, strict=True):
        parts = subsystems(system)
        if [len(subsystem.K) for subsystem in parts] != sizes:
            raise ValueError(OTHER_SUBSYSTEMS.format(frequency))
        columns.append(
            [
                None if number in spare else _part(subsystem, frequency, eps, steps, work)
                for number, subsystem in enumerate(parts)
            ]
        )
    return columns


def _part(subsystem: Subsystem, Omega: float, eps: FloatArray, steps: float, work: Workspace) -> _Part:
    """Return what a column says of one subsystem.

    The error is not measured, which would double the cost. The steps are short enough for it to be below SCAN_ERROR,
    and the integrator of `floquet.monodromy` verifies every region in the end.
    """
    sampler = Sampler.of(subsystem, Omega, work)
    found = spectra(sampler, eps, log2_steps(subsystem, Omega, eps, steps), SCAN_ERROR)
    conservative, modes = subsystem.reciprocal, log_multipliers(found)
    kind = judge(dominant(found, subsystem.reversible), ERROR_SAFETY * SCAN_ERROR * found.losses, conservative).kind
    unstable = kind > Kind.STABLE
    if conservative:  # next to an edge it is too weak to be judged, but seen
        off_circle = (np.abs(modes.modulus) + modes.half_difference).max(axis=1) > UNIT_CIRCLE_TOLERANCE
        unstable = _with_neighbours(unstable, off_circle)
    column = []
    for first, last in _runs(unstable):
        low, high = eps[first], eps[last]
        if first > 0:
            low = edge_between(modes, eps, first - 1, first, min(first + 1, last), conservative)
        if last < len(eps) - 1:
            high = edge_between(modes, eps, last + 1, last, max(last - 1, first), conservative)
        judged = kind[first : last + 1][kind[first : last + 1] > Kind.STABLE]
        column.append(Interval(float(low), float(high), int(judged[0]), int(judged[-1])))
    strongest = np.where(unstable, np.array(strongest_pair(modes)), np.nan)
    return _Part(column, SubsystemColumn(subsystem, modes), strongest)


def _strongest(parts: Sequence[_Part | None], count: int) -> FloatArray:
    """Return f and the mark, (2, count), of the most unstable pair of all subsystems, NaN where all are stable."""
    best = np.full((2, count), np.nan)
    for number, part in enumerate(parts):
        if part is not None:
            better = np.isfinite(part.strongest[0]) & ~(part.strongest[0] <= best[0])
            best[:, better] = part.strongest[:, better] + [[0.0], [SUBSYSTEM_MARK * number]]
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
        found += [
            (int(amplitude), -float(f), one) for amplitude, f, one in zip(amplitudes, strength, column, strict=True)
        ]
    joined: Column = []
    for _, _, one in sorted(found):
        if joined and one.low <= joined[-1].high:
            joined[-1] = joined[-1]._replace(low=min(one.low, joined[-1].low))
            if one.high > joined[-1].high:
                joined[-1] = joined[-1]._replace(high=one.high, high_kind=one.high_kind)
        else:
            joined.append(one)
    return joined
