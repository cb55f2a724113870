"""Stability charts: the growth rate of a periodic system over a grid of excitation frequency and amplitude."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from joblib import Parallel, delayed
from numpy.typing import ArrayLike, NDArray
from threadpoolctl import threadpool_limits
from tqdm import tqdm

from floquet.column import column, needed_steps
from floquet.coordinates import blocks
from floquet.sampling import Workspace
from periodic import PeriodicSystem, SystemFamily
from periodic.checks import FloatArray, grid, one_of, workers

ARRAYS = ("Omega", "eps", "growth_rate", "multiplier", "kind", "error")
COLUMNS_A_TASK = 8  # enough work to hide joblib's overhead, few enough to balance the load and to keep when interrupted


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
        The Floquet multiplier mu of largest modulus, imaginary part >= 0 (infinite where it exceeds the largest float).
    kind : int8 ndarray, shape (k, m)
        Verdict, see `Kind`.
    error : ndarray, shape (k, m)
        Estimated error of log|mu|, dimensionless.
    """

    Omega: FloatArray
    eps: FloatArray
    growth_rate: FloatArray
    multiplier: NDArray[np.complex128]
    kind: NDArray[np.int8]
    error: FloatArray

    def __post_init__(self) -> None:
        shape = (self.eps.size, self.Omega.size)
        for name in ("growth_rate", "multiplier", "kind", "error"):
            if getattr(self, name).shape != shape:
                raise ValueError(f"{name} has shape {getattr(self, name).shape}; give {shape}, as eps and Omega have")
        for name in ARRAYS:
            getattr(self, name).setflags(write=False)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the chart to the .npz file ``path``, which is replaced only once the new file is complete.

        Raises
        ------
        OSError
            If the file cannot be written.
        """
        path = Path(path)
        handle, temporary = tempfile.mkstemp(dir=path.parent, prefix=path.name, suffix=".part")
        try:
            with os.fdopen(handle, "wb") as file:
                np.savez_compressed(file, **{name: getattr(self, name) for name in ARRAYS})
            os.replace(temporary, path)
        except BaseException:
            os.unlink(temporary)
            raise

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> StabilityChart:
        """Return the chart that `save` wrote to ``path``.

        Raises
        ------
        OSError
            If there is no such file.
        ValueError
            If the file is not a chart.
        """
        try:
            with np.load(path, allow_pickle=False) as file:
                return cls(**{name: file[name] for name in ARRAYS})
        except (KeyError, ValueError, EOFError) as error:
            raise ValueError(
                f"path = {str(path)!r} is not a saved chart ({error}); give a file that save wrote"
            ) from None

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
            raise ImportError("to_xarray needs the package xarray; install it with: pip install xarray") from None
        cells = {name: (("eps", "Omega"), getattr(self, name)) for name in ARRAYS[2:]}
        return xarray.Dataset(cells, coords={"Omega": self.Omega, "eps": self.eps})


def stability_chart(
    family: SystemFamily,
    Omega: ArrayLike,
    eps: ArrayLike,
    *,
    n_jobs: int | None = -1,
    progress: bool | None = None,
) -> StabilityChart:
    """Integrate the periodic system at every point of a grid and return its stability chart.

    Parameters
    ----------
    family : SystemFamily
        A `PeriodicSystem`, or anything whose ``at(Omega)`` returns one.
    Omega : array_like, shape (m,)
        Excitation frequencies, positive and strictly increasing, in the units of the system.
    eps : array_like, shape (k,)
        Relative excitation amplitudes, strictly increasing, dimensionless.
    n_jobs : int or None
        Workers, as in joblib: -1 for all cores, None for what `joblib.parallel_config` says. Threads, unless
        `joblib.parallel_config` names another backend. The result is the same to the last bit.
    progress : bool or None
        Whether to show a progress bar; None shows it on a terminal only.

    Returns
    -------
    StabilityChart

    Raises
    ------
    ValueError
        If an argument has the wrong type, shape, order or sign, or holds NaN or infinity.
    """
    if not callable(getattr(family, "at", None)):
        raise ValueError(f"family = {family!r} has no method at(Omega); give a PeriodicSystem or a family of them")
    Omega, eps = grid("Omega", Omega, positive=True), grid("eps", eps)
    n_jobs = workers("n_jobs", n_jobs)
    progress = one_of("progress", progress, (True, False, None))

    steps = _steps_a_cycle(family, Omega, eps)

    def tasks() -> Iterator[Any]:
        for start in range(0, Omega.size, COLUMNS_A_TASK):
            columns = Omega[start : start + COLUMNS_A_TASK]
            yield delayed(_numbered_block)(start, [family.at(float(w)) for w in columns], columns, eps, steps)

    parallel = Parallel(n_jobs=n_jobs, prefer="threads", batch_size=1, return_as="generator_unordered")
    shape = (eps.size, Omega.size)
    cells = Block(np.empty(shape), np.empty(shape, np.complex128), np.empty(shape, np.int8), np.empty(shape))
    with tqdm(total=Omega.size, unit="column", disable=None if progress is None else not progress) as bar:
        for start, part in parallel(tasks()):
            width = part.growth_rate.shape[1]
            for name in Block._fields:
                getattr(cells, name)[:, start : start + width] = getattr(part, name)
            bar.update(width)
    return StabilityChart(Omega, eps, *cells)


class Block(NamedTuple):
    """The cells of a few columns, each array of shape (k, columns)."""

    growth_rate: FloatArray
    multiplier: NDArray[np.complex128]
    kind: NDArray[np.int8]
    error: FloatArray


def chart_block(systems: Sequence[PeriodicSystem], Omega: FloatArray, eps: FloatArray, steps_a_cycle: float) -> Block:
    """Return a few columns of a chart, one for each system and frequency: a pure function, safe to keep its results."""
    work = Workspace()
    columns, last, parts = [], None, []
    with blas_threads():
        for system, frequency in zip(systems, Omega, strict=True):
            if system is not last:
                last, parts = system, blocks(system)
            columns.append(column(parts, float(frequency), eps, steps_a_cycle, work))
    log_modulus, angle, error, kind = (np.stack(part, axis=1) for part in zip(*columns, strict=True))
    with np.errstate(over="ignore"):
        modulus = np.exp(log_modulus)
    direction = np.cos(angle) + 1j * np.sin(angle)
    return Block(log_modulus * Omega / (2 * np.pi), modulus * direction, kind, error)


def _numbered_block(start: int, *arguments: Any) -> tuple[int, Block]:
    return start, chart_block(*arguments)


def _steps_a_cycle(family: SystemFamily, Omega: FloatArray, eps: FloatArray) -> float:
    """Return the steps in one cycle of the fastest motion that a few columns need; the others get as many."""
    work = Workspace()
    with blas_threads():
        return max(
            needed_steps(block, float(w), eps, work)
            for w in np.unique(Omega[[0, Omega.size // 2, -1]])
            for block in blocks(family.at(float(w)))
        )


def blas_threads() -> Any:
    """Return a context in which BLAS uses one thread: the workers are the threads, and results do not depend on their
    number."""
    return threadpool_limits(limits=1, user_api="blas")
