"""Stability charts: the growth rate of a periodic system over a grid of excitation frequency and amplitude."""

from __future__ import annotations

import io
import os
import zipfile
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from tqdm import tqdm

from floquet.chart.audit import ChartAudit, integrate_again, sample
from floquet.chart.checkpoint import TileStore
from floquet.engine import Tile, chart_batch, rigid_motions, steps_needed
from floquet.kind import Kind
from floquet.running import as_completed, replace_file
from periodic import AnyFamily, any_member_at
from periodic.checks import ComplexArray, FloatArray, grid, interval, one_of, whole_number, workers

# Columns of a task: enough to hide joblib's overhead and to share the measurement of the error, and few enough for this
# number of tasks, which balances the load.
MIN_TASK_COLUMNS, MAX_TASK_COLUMNS, TASKS_PER_CHART = 8, 16, 16
CELL_ARRAYS = Tile._fields
AUDIT_ARRAYS = ("cells", "differences", "estimates", "contradictions")
# Frequencies and amplitudes of a chart that is asked for by ranges.
FREQUENCIES_IN_RANGE, AMPLITUDES_IN_RANGE = 256, 128


@dataclass(frozen=True, eq=False)
class StabilityChart:
    """Growth rate, dominant multiplier and verdict on a grid; made by `stability_chart`.

    Attributes
    ----------
    Omega : ndarray, shape (m,)
        Excitation frequencies, in the units of the system.
    eps : ndarray, shape (k,)
        Relative excitation amplitudes, dimensionless.
    growth_rate : ndarray, shape (k, m)
        log|mu| / T with T = 2 pi / Omega, in the units of Omega.
    multiplier : complex ndarray, shape (k, m)
        The Floquet multiplier mu of largest modulus, imaginary part >= 0; infinite where it exceeds the largest float.
        It is one of them where all multipliers are on the unit circle.
    kind : int8 ndarray, shape (k, m)
        Verdict, see `Kind`.
    error : ndarray, shape (k, m)
        Estimated error of log|mu|, dimensionless.
    audit : ChartAudit or None
        Some of the cells, integrated again by `monodromy`.
    rigid : int
        Number of rigid motions, on which no stiffness, damping or gyroscopic matrix acts and no excitation: the common
        rotation of a drivetrain with free ends, for example. Such a motion drifts linearly, with a double multiplier 1.
        That is no instability of the excitation, so the cells are about all other motions. Of a family whose excitation
        leaves a motion alone at some frequencies only, it is the largest number at the ends and the middle of the grid.

    Raises
    ------
    ValueError
        If the shapes do not fit, or a grid is not strictly increasing.
    """

    Omega: FloatArray
    eps: FloatArray
    growth_rate: FloatArray
    multiplier: ComplexArray
    kind: NDArray[np.int8]
    error: FloatArray
    audit: ChartAudit | None = None
    rigid: int = 0

    def __post_init__(self) -> None:
        object.__setattr__(self, "Omega", grid("Omega", self.Omega, positive=True))
        object.__setattr__(self, "eps", grid("eps", self.eps))
        shape = (self.eps.size, self.Omega.size)
        for name in CELL_ARRAYS:
            array = np.asarray(getattr(self, name))
            if array.shape != shape:
                raise ValueError(f"{name} has shape {array.shape}; give {shape}, as eps and Omega have")
            object.__setattr__(self, name, array)
            array.setflags(write=False)

    def __repr__(self) -> str:
        ends = ", ".join(
            f"{name} {values[0]:.6g} to {values[-1]:.6g} ({values.size})"
            for name, values in (("Omega", self.Omega), ("eps", self.eps))
        )
        unstable, undecided = (self.kind > Kind.STABLE).mean(), (self.kind == Kind.UNDECIDED).mean()
        doubt = f", {undecided:.1%} undecided" if undecided else ""
        return f"StabilityChart({ends}: {unstable:.1%} of the cells unstable{doubt})"

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the chart to the .npz file ``path``, which is replaced only once the new file is complete.

        Raises
        ------
        ValueError
            If ``path`` is not a path.
        OSError
            If the file cannot be written.
        """
        target = _path(path)
        arrays = {name: getattr(self, name) for name in ("Omega", "eps", *CELL_ARRAYS, "rigid")}
        if self.audit is not None:
            arrays |= {f"audit_{name}": getattr(self.audit, name) for name in AUDIT_ARRAYS}
        buffer = io.BytesIO()
        np.savez_compressed(buffer, **arrays)
        replace_file(target, buffer.getvalue())

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> StabilityChart:
        """Return the chart that `save` wrote to ``path``.

        Raises
        ------
        OSError
            If there is no such file.
        ValueError
            If ``path`` is not a path, or the file is not a chart.
        """
        source = _path(path)
        try:
            with source.open("rb") as file, np.load(file, allow_pickle=False) as arrays:
                found = (arrays[f"audit_{name}"] for name in AUDIT_ARRAYS)
                audit = ChartAudit(*found) if "audit_cells" in arrays else None
                cells = {name: arrays[name] for name in ("Omega", "eps", *CELL_ARRAYS)}
                return cls(**cells, audit=audit, rigid=int(arrays["rigid"]))
        except (KeyError, ValueError, TypeError, AttributeError, EOFError, zipfile.BadZipFile) as error:
            message = f"path = {str(path)!r} is not a saved chart ({error}); give a file that save wrote"
            raise ValueError(message) from None

    def to_xarray(self) -> Any:
        """Return the chart as an `xarray.Dataset` with dimensions (eps, Omega).

        Raises
        ------
        ImportError
            If xarray is not installed.
        """
        try:
            import xarray
        except ImportError:
            message = "to_xarray needs the package xarray; install it with: pip install 'floquet-charts[xarray]'"
            raise ImportError(message) from None
        cells = {name: (("eps", "Omega"), getattr(self, name)) for name in CELL_ARRAYS}
        return xarray.Dataset(cells, coords={"Omega": self.Omega, "eps": self.eps}, attrs={"rigid": self.rigid})


def stability_chart(
    family: AnyFamily,
    Omega: ArrayLike,
    eps: ArrayLike,
    *,
    n_jobs: int | None = -1,
    progress: bool | None = None,
    audit: int = 16,
    cache: str | os.PathLike[str] | TileStore | None = None,
) -> StabilityChart:
    """Integrate the periodic system at every point of a grid and return its stability chart.

    Parameters
    ----------
    family : SystemFamily
        A `PeriodicSystem` or a `FirstOrderSystem`, or anything whose ``at(Omega)`` returns one.
    Omega : array_like, shape (m,), or (float, float)
        Excitation frequencies, positive and strictly increasing, in the units of the system. A tuple of two is a range,
        as for `trace_regions`: 256 frequencies from the first to the second. A list of two is two frequencies.
    eps : array_like, shape (k,), or (float, float)
        Relative excitation amplitudes, strictly increasing, of any sign, dimensionless. A tuple of two is a range: 128
        amplitudes.
    n_jobs : int or None
        Workers, as in joblib: -1 for all cores, None for what `joblib.parallel_config` says. Threads, unless
        `joblib.parallel_config` names another backend. The result is the same to the last bit.
    progress : bool or None
        Whether to show a progress bar; None shows it on a terminal only.
    audit : int
        Number of random cells that `monodromy` integrates again for comparison, besides the cell with the largest
        error; they are the same at every call. 0 for no audit.
    cache : path or TileStore, optional
        A folder that keeps finished tiles of columns. If a chart was stopped, for whatever reason, the same call with
        the same folder continues it and ends with the same bits. Several processes may share a folder. Its files stay
        until somebody removes them; `TileStore.clear` does.

    Returns
    -------
    StabilityChart

    Raises
    ------
    ValueError
        If an argument has the wrong type, shape, order or sign, or holds NaN or infinity; if a period needs too many
        steps; if ``cache`` cannot be written to.

    Notes
    -----
    docs/engine.md explains the method. Besides its results a worker needs at most about 0.2 GB, and all workers of a
    process 0.2 GB more for the plans that they share; most charts need a hundredth of that. The chart itself takes 33
    bytes a cell. docs/scale.md says what large charts cost.
    """
    Omega = grid("Omega", _spread("Omega", Omega, FREQUENCIES_IN_RANGE), positive=True)
    eps = grid("eps", _spread("eps", eps, AMPLITUDES_IN_RANGE))
    any_member_at(family, float(Omega[0]), "family")
    n_jobs = workers("n_jobs", n_jobs)
    progress = one_of("progress", progress, (True, False, None))
    audit = whole_number("audit", audit, least=0)
    store = cache if cache is None or isinstance(cache, TileStore) else TileStore(cache)

    few = Omega[np.unique([0, Omega.size // 2, Omega.size - 1])]
    members = [family.at(float(w)) for w in few]
    steps = steps_needed(members, few, eps)

    def inputs(columns: slice) -> tuple[Any, ...]:
        return [family.at(float(w)) for w in Omega[columns]], Omega[columns], eps, steps

    slices = task_columns(Omega.size)
    shape = (eps.size, Omega.size)
    cells = Tile(np.empty(shape), np.empty(shape, np.complex128), np.empty(shape, np.int8), np.empty(shape))
    with tqdm(total=Omega.size, unit="column", disable=None if progress is None else not progress) as bar:
        for columns, tile in _tiles(slices, inputs, store, n_jobs):
            for name in CELL_ARRAYS:
                getattr(cells, name)[:, columns] = getattr(tile, name)
            bar.update(columns.stop - columns.start)
    chart = StabilityChart(
        Omega, eps, *cells, rigid=max(rigid_motions(member, float(w)) for member, w in zip(members, few, strict=True))
    )
    return chart if audit == 0 else replace(chart, audit=_audited(family, chart, audit, n_jobs))


def _spread(name: str, values: ArrayLike, count: int) -> ArrayLike:
    """Return ``count`` values from the first to the second of a tuple of two; all else as it is."""
    if isinstance(values, tuple) and len(values) == 2:
        return np.linspace(*interval(name, values), count)
    return values


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


def _tiles(
    slices: Sequence[slice], inputs: Callable[[slice], tuple[Any, ...]], store: TileStore | None, n_jobs: int | None
) -> Iterator[tuple[slice, Tile]]:
    """Yield the columns and the content of each tile: first those in ``store``, then the others, which are stored.

    The store is read and written here, by one process. Workers on other machines need no access to the folder.
    """
    missing, paths = [], {}
    for columns in slices:
        tile = None
        if store is not None:
            paths[columns.start] = store.path(*inputs(columns))
            tile = store.load(paths[columns.start])
        if tile is None:
            missing.append(columns)
        else:
            yield columns, tile
    for i, tile in as_completed(chart_batch, map(inputs, missing), n_jobs):
        if store is not None:
            store.save(paths[missing[i].start], tile)
        yield missing[i], tile


def _audited(family: AnyFamily, chart: StabilityChart, size: int, n_jobs: int | None) -> ChartAudit:
    """Return the audit of a chart with ``size`` random cells."""
    cells = sample(chart.error, size)
    points = [(float(chart.Omega[j]), float(chart.eps[i])) for i, j in cells]
    tasks = ((family.at(w), w, e) for w, e in points)
    again = np.array([found for _, found in sorted(as_completed(integrate_again, tasks, n_jobs))])
    i, j = cells.T
    log_modulus = chart.growth_rate[i, j] * 2 * np.pi / chart.Omega[j]
    kinds, others = chart.kind[i, j], again[:, 2]
    contradictions = (kinds >= 0) & (others >= 0) & ((kinds > Kind.STABLE) != (others > Kind.STABLE))
    return ChartAudit(cells, np.abs(log_modulus - again[:, 0]), chart.error[i, j] + again[:, 1], contradictions)


def _path(path: Any) -> Path:
    if not isinstance(path, str | os.PathLike):
        raise ValueError(f"path = {path!r} is not a path; give a file name")
    return Path(path)
