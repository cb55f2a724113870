"""A chart's own check: some of its cells, integrated again by `monodromy`, with which the chart shares no code."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from floquet.kind import Kind
from floquet.oracle import monodromy
from periodic import PeriodicSystem
from periodic.checks import FloatArray

SEED = 20250101
# An estimate is an order of magnitude. It holds if the difference is within this multiple, plus rounding of log|mu|.
FACTOR, ROUNDING = 3.0, 1e-13


@dataclass(frozen=True, eq=False)
class ChartAudit:
    """Cells of a chart that were integrated a second time, by another method.

    Attributes
    ----------
    cells : int ndarray, shape (a, 2)
        Indices (i, j) of the cells eps[i], Omega[j].
    differences : ndarray, shape (a,)
        |log|mu| of the chart - log|mu| of `monodromy`|, dimensionless; NaN where `monodromy` refused (it says why).
    estimates : ndarray, shape (a,)
        The sum of both estimated errors.
    contradictions : bool ndarray, shape (a,)
        Where one says stable and the other unstable.
    """

    cells: NDArray[np.int64]
    differences: FloatArray
    estimates: FloatArray
    contradictions: NDArray[np.bool_]

    def __post_init__(self) -> None:
        for array in (self.cells, self.differences, self.estimates, self.contradictions):
            array.setflags(write=False)

    @property
    def largest_difference(self) -> float:
        """Largest difference of log|mu|; NaN if no cell could be compared."""
        return float(np.nanmax(self.differences, initial=-np.inf)) if self.compared else float("nan")

    @property
    def largest_ratio(self) -> float:
        """Largest difference in units of its estimate (rounding allowed for); NaN if no cell could be compared."""
        return float(np.nanmax(self.differences / (self.estimates + ROUNDING))) if self.compared else float("nan")

    @property
    def compared(self) -> int:
        """Number of cells that both methods could integrate."""
        return int(np.isfinite(self.differences).sum())

    @property
    def ok(self) -> bool:
        """Whether no verdict is contradicted and every estimate holds within a factor of three."""
        return not self.contradictions.any() and not self.largest_ratio > FACTOR


def sample(error: FloatArray, size: int) -> NDArray[np.int64]:
    """Return ``size`` cells of a chart at random, always the same ones, and the one with the largest error."""
    drawn = np.random.default_rng(SEED).choice(error.size, min(size, error.size), replace=False)
    chosen = np.union1d(drawn, [error.argmax()])
    return np.stack(np.unravel_index(chosen, error.shape), axis=1)


def integrate_again(system: PeriodicSystem, Omega: float, eps: float) -> tuple[float, float, int]:
    """Return log|mu| by `monodromy`, its estimated error and the verdict; NaN and undecided if `monodromy` refuses."""
    try:
        found = monodromy(system, Omega, eps)
    except ValueError:
        return float("nan"), float("nan"), int(Kind.UNDECIDED)
    return found.growth_rate * 2 * np.pi / Omega, found.log_modulus_error, int(found.kind)
