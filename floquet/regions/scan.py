"""Columns of the plane, placed where the regions of instability need them: intervals of eps unstable at each Omega."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from floquet.engine import MIN_STEPS_PER_CYCLE, Workspace, steps_needed, subsystems
from floquet.regions.column import COLUMN_RESOLUTION, Grid, ScannedSubsystem, SubsystemColumn, scan_subsystem, union
from floquet.regions.outlines import Column
from floquet.regions.refinement import Refinement
from floquet.regions.window import Window
from floquet.running import as_completed
from periodic import PeriodicSystem
from periodic.checks import FloatArray

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


class Scan:
    """Columns of a window, computed when asked for and kept.

    Attributes
    ----------
    window : Window
    grid : Grid
        The amplitudes of the columns, and how finely each looks between them.
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
        steps = max(SCAN_STEPS_RATIO * steps_needed(systems, few, window.amplitudes), MIN_STEPS_PER_CYCLE)
        resolution = COLUMN_RESOLUTION * window.tolerance * window.height
        self.grid = Grid(window.amplitudes, window.eps_range[0], resolution, steps)
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
        window = self.window
        new = sorted({float(w) for w in Omega} - self.subsystems.keys())
        batches = [new[i : i + COLUMNS_PER_TASK] for i in range(0, len(new), COLUMNS_PER_TASK)]
        none: frozenset[int] = frozenset()
        tasks = (
            (
                [window.family.at(w) for w in batch],
                batch,
                self.grid,
                self.sizes,
                [(spared or {}).get(w, none) for w in batch],
            )
            for batch in batches
        )
        for i, found in as_completed(_columns, tasks, window.n_jobs):
            for w, parts in zip(batches[i], found, strict=True):
                self.subsystems[w] = {number: part.column for number, part in enumerate(parts) if part is not None}
                self.stable[w] = frozenset(n for n, part in enumerate(parts) if part is None or not part.intervals)
                if window.covers(w):
                    seen = [(part.intervals, part.strongest[0]) for part in parts if part is not None]
                    self.columns[w] = union(seen, self.grid.eps)
                    self.strongest[w] = _strongest(parts, len(self.grid.eps))
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
    grid: Grid,
    sizes: list[int],
    spared: Sequence[frozenset[int]],
) -> list[list[ScannedSubsystem | None]]:
    """Return what some columns say of their subsystems, None for those that are spared."""
    work = Workspace()
    columns = []
    for system, frequency, spare in zip(systems, Omega, spared, strict=True):
        parts = subsystems(system)
        if [len(subsystem.K) for subsystem in parts] != sizes:
            raise ValueError(OTHER_SUBSYSTEMS.format(frequency))
        columns.append(
            [
                None if number in spare else scan_subsystem(subsystem, frequency, grid, work)
                for number, subsystem in enumerate(parts)
            ]
        )
    return columns


def _strongest(parts: Sequence[ScannedSubsystem | None], count: int) -> FloatArray:
    """Return f and the mark, (2, count), of the most unstable pair of all subsystems, NaN where all are stable."""
    best = np.full((2, count), np.nan)
    for number, part in enumerate(parts):
        if part is not None:
            better = np.isfinite(part.strongest[0]) & ~(part.strongest[0] <= best[0])
            best[:, better] = part.strongest[:, better] + [[0.0], [SUBSYSTEM_MARK * number]]
    return best
