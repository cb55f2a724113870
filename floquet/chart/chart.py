"""Stability charts: the growth rate of a periodic system over a grid of excitation frequency and amplitude."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from floquet.chart.audit import ChartAudit
from floquet.chart.axes import described, hold_cells, spread
from floquet.chart.checkpoint import TileStore
from floquet.chart.filling import CELL_ARRAYS, Batch, Task, audited, checked_options, filled, task_columns
from floquet.chart.saving import data_set, load_arrays, save_arrays
from floquet.engine import rigid_motions, steps_needed
from periodic import AnyFamily, AnySystem, any_member_at
from periodic.checks import ComplexArray, FloatArray, grid

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
        hold_cells(self, CELL_ARRAYS, (self.eps.size, self.Omega.size), "eps and Omega have")

    def __repr__(self) -> str:
        return f"StabilityChart({described(('Omega', 'eps'), (self.Omega, self.eps), self.kind)})"

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the chart to the .npz file ``path``, which is replaced only once the new file is complete.

        Raises
        ------
        ValueError
            If ``path`` is not a path.
        OSError
            If the file cannot be written.
        """
        arrays = {name: getattr(self, name) for name in ("Omega", "eps", *CELL_ARRAYS, "rigid")}
        save_arrays(path, arrays, self.audit)

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

        def made(arrays: Mapping[str, NDArray[Any]], audit: ChartAudit | None) -> StabilityChart:
            cells = {name: arrays[name] for name in ("Omega", "eps", *CELL_ARRAYS)}
            return cls(**cells, audit=audit, rigid=int(arrays["rigid"]))

        return load_arrays(path, made)

    def to_xarray(self) -> Any:
        """Return the chart as an `xarray.Dataset` with dimensions (eps, Omega).

        Raises
        ------
        ImportError
            If xarray is not installed.
        """
        cells = {name: getattr(self, name) for name in CELL_ARRAYS}
        return data_set(cells, ("eps", "Omega"), {"Omega": self.Omega, "eps": self.eps}, rigid=self.rigid)


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
    Omega = grid("Omega", spread("Omega", Omega, FREQUENCIES_IN_RANGE), positive=True)
    eps = grid("eps", spread("eps", eps, AMPLITUDES_IN_RANGE))
    any_member_at(family, float(Omega[0]), "family")
    options = checked_options(n_jobs, progress, audit, cache)

    few = Omega[np.unique([0, Omega.size // 2, Omega.size - 1])]
    members = [family.at(float(w)) for w in few]
    steps = steps_needed(members, few, eps)

    def tasks() -> Iterator[Task]:
        for columns in task_columns(Omega.size):
            batch = Batch([family.at(float(w)) for w in Omega[columns]], Omega[columns], eps)
            places = np.add.outer(np.arange(eps.size) * Omega.size, np.arange(Omega.size)[columns]).ravel()
            yield Task([batch], places, np.arange(places.size), columns.stop - columns.start)

    def point(i: int, j: int) -> tuple[AnySystem, float, float]:
        return family.at(float(Omega[j])), float(Omega[j]), float(eps[i])

    cells = filled((eps.size, Omega.size), tasks(), steps, options, lines=Omega.size, unit="column")
    rigid = max(rigid_motions(member, float(w)) for member, w in zip(members, few, strict=True))
    return StabilityChart(Omega, eps, *cells, audit=audited(cells, Omega, point, options), rigid=rigid)
