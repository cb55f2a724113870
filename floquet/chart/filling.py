"""How the cells of a chart are computed: in tasks of a few batches of columns, on all workers, kept on the way.

A chart says which columns there are (`Batch`, `Task`) and where its cells are in them; all else is the same for a chart
of one family over Omega and eps and for a plane of any two parameters.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from tqdm import tqdm

from floquet.chart.audit import ChartAudit, integrate_again, sample
from floquet.chart.checkpoint import TileStore
from floquet.engine import Tile, chart_batch
from floquet.kind import Kind
from floquet.running import as_completed
from periodic import AnySystem
from periodic.checks import FloatArray, one_of, whole_number, workers

# Columns of a task, or rows of a plane that shares more along them: enough to hide joblib's overhead and to share the
# measurement of the error, and few enough for this number of tasks, which balances the load.
MIN_TASK_COLUMNS, MAX_TASK_COLUMNS, TASKS_PER_CHART = 8, 16, 16
CELL_ARRAYS = Tile._fields


class Batch(NamedTuple):
    """Columns that the engine computes together: one system for each frequency, all at the same amplitudes."""

    systems: Sequence[AnySystem]
    Omega: FloatArray
    eps: FloatArray


class Task(NamedTuple):
    """What one call of a worker computes.

    Cell ``places[i]`` of the chart, counted row by row, is cell ``sources[i]`` of the batches, counted batch by batch
    and row by row. ``lines`` is how far the progress bar moves.
    """

    batches: list[Batch]
    places: NDArray[np.intp]
    sources: NDArray[np.intp]
    lines: int


class Options(NamedTuple):
    """The checked options of a chart."""

    n_jobs: int | None
    progress: bool | None
    audit: int
    store: TileStore | None


def checked_options(
    n_jobs: int | None, progress: bool | None, audit: int, cache: str | os.PathLike[str] | TileStore | None
) -> Options:
    """Return the options that all charts share.

    Raises
    ------
    ValueError
        If one has the wrong type or value, or ``cache`` cannot be written to.
    """
    return Options(
        workers("n_jobs", n_jobs),
        one_of("progress", progress, (True, False, None)),
        whole_number("audit", audit, least=0),
        cache if cache is None or isinstance(cache, TileStore) else TileStore(cache),
    )


def task_columns(columns: int) -> list[slice]:
    """Return the columns of each task of a chart; they depend on nothing else, for the error of a column depends on
    them.

    Parameters
    ----------
    columns : int
        Number of columns of the chart.
    """
    count = min(max(columns // TASKS_PER_CHART, MIN_TASK_COLUMNS), MAX_TASK_COLUMNS)
    return [slice(start, min(start + count, columns)) for start in range(0, columns, count)]


def filled(
    shape: tuple[int, int], tasks: Iterable[Task], steps: float, options: Options, *, lines: int, unit: str
) -> Tile:
    """Return all cells of a chart; those that are in no task are NaN and undecided.

    Parameters
    ----------
    shape : (int, int)
        Rows and columns of the chart.
    tasks : iterable of Task
        It is read while the work goes on.
    steps : float
        Steps in one cycle of the fastest motion, from `floquet.engine.steps_needed`.
    options : Options
    lines : int
        Number of lines in all tasks, for the progress bar, which counts them as ``unit``.
    """
    count = shape[0] * shape[1]
    cells = Tile(
        np.full(count, np.nan),
        np.full(count, complex(np.nan, np.nan)),
        np.full(count, Kind.UNDECIDED, np.int8),
        np.full(count, np.nan),
    )
    disable = None if options.progress is None else not options.progress
    with tqdm(total=lines, unit=unit, disable=disable) as bar:
        for task, tile in _computed(tasks, steps, options):
            for name in CELL_ARRAYS:
                getattr(cells, name)[task.places] = getattr(tile, name)[task.sources]
            bar.update(task.lines)
    rate, multiplier, kind, error = cells
    return Tile(rate.reshape(shape), multiplier.reshape(shape), kind.reshape(shape), error.reshape(shape))


def _computed(tasks: Iterable[Task], steps: float, options: Options) -> Iterator[tuple[Task, Tile]]:
    """Yield each task, without its batches, with its tile: from the store if it is there, else computed and stored.

    The store is read and written here, by one process. Workers on other machines need no access to the folder.
    """
    store = options.store
    pending: list[tuple[Task, Path | None]] = []
    ready: list[tuple[Task, Tile]] = []
    failures: list[Exception] = []

    def missing() -> Iterator[tuple[list[Batch], float]]:
        try:
            for task in tasks:
                path = None if store is None else store.path(task.batches, steps)
                kept = None if store is None or path is None else store.load(path)
                bare = task._replace(batches=[])
                if kept is not None:
                    ready.append((bare, kept))
                    continue
                pending.append((bare, path))
                yield task.batches, steps
        except Exception as error:  # joblib may ask for arguments in a thread that has nobody to tell
            failures.append(error)

    for i, tile in as_completed(compute_batches, missing(), options.n_jobs):
        task, path = pending[i]
        if store is not None and path is not None:
            store.save(path, tile)
        yield task, tile
        while ready:
            yield ready.pop()
    yield from ready
    if failures:
        raise failures[0]


def compute_batches(batches: Sequence[Batch], steps: float) -> Tile:
    """Return the cells of some batches one after the other, each array of one axis."""
    tiles = [chart_batch(*batch, steps) for batch in batches]
    return Tile(*(np.concatenate([part.ravel() for part in parts]) for parts in zip(*tiles, strict=True)))


def audited(
    cells: Tile, Omega: FloatArray, point: Callable[[int, int], tuple[AnySystem, float, float]], options: Options
) -> ChartAudit | None:
    """Return the audit of a chart; None if none is asked for.

    Parameters
    ----------
    cells : Tile
    Omega : ndarray
        Of every cell, of a shape that broadcasts to that of the cells.
    point : callable
        Returns system, frequency and amplitude of the cell (i, j).
    options : Options
    """
    if options.audit == 0:
        return None
    places = sample(cells.error, options.audit)
    tasks: list[tuple[Any, ...]] = [point(int(i), int(j)) for i, j in places]
    again = np.array([found for _, found in sorted(as_completed(integrate_again, tasks, options.n_jobs))])
    i, j = places.T
    log_modulus = cells.growth_rate[i, j] * 2 * np.pi / np.broadcast_to(Omega, cells.kind.shape)[i, j]
    kinds, others = cells.kind[i, j], again[:, 2]
    contradictions = (kinds >= 0) & (others >= 0) & ((kinds > Kind.STABLE) != (others > Kind.STABLE))
    return ChartAudit(places, np.abs(log_modulus - again[:, 0]), cells.error[i, j] + again[:, 1], contradictions)
