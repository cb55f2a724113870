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
from floquet.engine.column import Columns, chart_batch, steps_needed
from floquet.kind import Kind
from floquet.running.files import replace_file
from floquet.running.parallel import spread
from periodic import SystemFamily, member_at
from periodic.checks import ComplexArray, FloatArray, grid, one_of, whole_number, workers

# Columns a task: enough to hide joblib's overhead, and, in charts of many, to share the measurement of the error among
# more; few enough for so many tasks to balance the load.
LEAST_COLUMNS, MOST_COLUMNS, TASKS = 8, 16, 16
CELLS = ("growth_rate", "multiplier", "kind", "error")
AUDIT = ("cells", "differences", "estimates", "contradictions")


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
        Where all multipliers are on the unit circle, one of them.
    kind : int8 ndarray, shape (k, m)
        Verdict, see `Kind`.
    error : ndarray, shape (k, m)
        Estimated error of log|mu|, dimensionless.
    audit : ChartAudit or None
        Some of the cells, integrated again by `monodromy`.

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

    def __post_init__(self) -> None:
        object.__setattr__(self, "Omega", grid("Omega", self.Omega, positive=True))
        object.__setattr__(self, "eps", grid("eps", self.eps))
        shape = (self.eps.size, self.Omega.size)
        for name in CELLS:
            array = np.asarray(getattr(self, name))
            if array.shape != shape:
                raise ValueError(f"{name} has shape {array.shape}; give {shape}, as eps and Omega have")
            object.__setattr__(self, name, array)
            array.setflags(write=False)

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
        arrays = {name: getattr(self, name) for name in ("Omega", "eps", *CELLS)}
        if self.audit is not None:
            arrays |= {f"audit_{name}": getattr(self.audit, name) for name in AUDIT}
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
                audit = ChartAudit(*(arrays[f"audit_{name}"] for name in AUDIT)) if "audit_cells" in arrays else None
                return cls(**{name: arrays[name] for name in ("Omega", "eps", *CELLS)}, audit=audit)
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
        cells = {name: (("eps", "Omega"), getattr(self, name)) for name in CELLS}
        return xarray.Dataset(cells, coords={"Omega": self.Omega, "eps": self.eps})


def stability_chart(
    family: SystemFamily,
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
        A `PeriodicSystem`, or anything whose ``at(Omega)`` returns one; only its excitation may depend on the
        frequency.
    Omega : array_like, shape (m,)
        Excitation frequencies, positive and strictly increasing, in the units of the system.
    eps : array_like, shape (k,)
        Relative excitation amplitudes, strictly increasing, of any sign, dimensionless.
    n_jobs : int or None
        Workers, as in joblib: -1 for all cores, None for what `joblib.parallel_config` says. Threads, unless
        `joblib.parallel_config` names another backend. The result is the same to the last bit.
    progress : bool or None
        Whether to show a progress bar; None shows it on a terminal only.
    audit : int
        How many cells, drawn at random (always the same ones), to integrate again with `monodromy` for comparison,
        besides the one with the largest error; 0 for none.
    cache : path or TileStore, optional
        A folder that keeps finished tiles of columns. A chart that was stopped, in whatever way, goes on where it was
        when the same call names the same folder, and ends with the same bits; several processes may share a folder.
        Nobody else clears it; `floquet.chart.checkpoint.TileStore` can.

    Returns
    -------
    StabilityChart

    Raises
    ------
    ValueError
        If an argument has the wrong type, shape, order or sign, or holds NaN or infinity; if a period has more steps
        than can be taken; if ``cache`` cannot be written to.

    Notes
    -----
    docs/engine.md explains the method. A worker needs about 0.2 GB at most besides its results, and all of them 0.2 GB
    more for what they share, most charts a hundredth of that; the chart itself 33 bytes a cell. docs/scale.md says what
    large charts cost.
    """
    Omega, eps = grid("Omega", Omega, positive=True), grid("eps", eps)
    member_at(family, float(Omega[0]), "family")
    n_jobs = workers("n_jobs", n_jobs)
    progress = one_of("progress", progress, (True, False, None))
    audit = whole_number("audit", audit, least=0)
    store = cache if cache is None or isinstance(cache, TileStore) else TileStore(cache)

    few = Omega[np.unique([0, Omega.size // 2, Omega.size - 1])]
    steps = steps_needed([family.at(float(w)) for w in few], few, eps)

    def inputs(columns: slice) -> tuple[Any, ...]:
        return [family.at(float(w)) for w in Omega[columns]], Omega[columns], eps, steps

    slices = tasks(Omega.size)
    shape = (eps.size, Omega.size)
    cells = Columns(np.empty(shape), np.empty(shape, np.complex128), np.empty(shape, np.int8), np.empty(shape))
    with tqdm(total=Omega.size, unit="column", disable=None if progress is None else not progress) as bar:
        for columns, tile in _tiles(slices, inputs, store, n_jobs):
            for name in Columns._fields:
                getattr(cells, name)[:, columns] = getattr(tile, name)
            bar.update(columns.stop - columns.start)
    chart = StabilityChart(Omega, eps, *cells)
    return chart if audit == 0 else replace(chart, audit=_audited(family, chart, audit, n_jobs))


def tasks(columns: int) -> list[slice]:
    """Return the columns of each task of a chart, whoever does them: the error of a column depends on its task."""
    count = min(max(columns // TASKS, LEAST_COLUMNS), MOST_COLUMNS)
    return [slice(start, min(start + count, columns)) for start in range(0, columns, count)]


def _tiles(
    slices: Sequence[slice], inputs: Callable[[slice], tuple[Any, ...]], store: TileStore | None, n_jobs: int | None
) -> Iterator[tuple[slice, Columns]]:
    """Yield each tile of columns, first those in ``store``, then the others as they are computed, and keep these.

    The store is read and written here, by one process: workers on other machines need not see the folder.
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
    for i, tile in spread(chart_batch, map(inputs, missing), n_jobs):
        if store is not None:
            store.save(paths[missing[i].start], tile)
        yield missing[i], tile


def _audited(family: SystemFamily, chart: StabilityChart, size: int, n_jobs: int | None) -> ChartAudit:
    cells = sample(chart.error, size)
    points = [(float(chart.Omega[j]), float(chart.eps[i])) for i, j in cells]
    tasks = ((family.at(w), w, e) for w, e in points)
    again = np.array([found for _, found in sorted(spread(integrate_again, tasks, n_jobs))])
    i, j = cells.T
    log_modulus = chart.growth_rate[i, j] * 2 * np.pi / chart.Omega[j]
    kinds, others = chart.kind[i, j], again[:, 2]
    contradictions = (kinds >= 0) & (others >= 0) & ((kinds > Kind.STABLE) != (others > Kind.STABLE))
    return ChartAudit(cells, np.abs(log_modulus - again[:, 0]), chart.error[i, j] + again[:, 1], contradictions)


def _path(path: Any) -> Path:
    if not isinstance(path, str | os.PathLike):
        raise ValueError(f"path = {path!r} is not a path; give a file name")
    return Path(path)
