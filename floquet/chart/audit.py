"""A chart's check of itself: some of its cells are integrated again by `monodromy`, which shares no code with it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from floquet.kind import Kind
from floquet.oracle import monodromy
from periodic import AnySystem
from periodic.checks import FloatArray

AUDIT_SEED = 20250101  # of the random choice of cells
# An estimate is an order of magnitude. It holds if the difference is at most this many times the estimate, not counting
# the rounding of log|mu|.
MAX_ERROR_RATIO, LOG_MODULUS_ROUNDING = 3.0, 1e-13


@dataclass(frozen=True, eq=False)
class ChartAudit:
    """Cells of a chart that were integrated a second time, by another method.

    Attributes
    ----------
    cells : int ndarray, shape (a, 2)
        Indices (i, j) of the cells eps[i], Omega[j].
    differences : ndarray, shape (a,)
        |log|mu| of the chart - log|mu| of `monodromy`|, dimensionless; NaN where `monodromy` raises ValueError.
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
        """Largest difference of log|mu|; NaN if no cell was compared."""
        return float(np.nanmax(self.differences, initial=-np.inf)) if self.compared else float("nan")

    @property
    def largest_ratio(self) -> float:
        """Largest ratio of difference to estimate, with rounding added to the estimate; NaN if no cell was compared."""
        return (
            float(np.nanmax(self.differences / (self.estimates + LOG_MODULUS_ROUNDING)))
            if self.compared
            else float("nan")
        )

    @property
    def compared(self) -> int:
        """Number of cells that both methods have integrated."""
        return int(np.isfinite(self.differences).sum())

    @property
    def ok(self) -> bool:
        """Whether no verdict is contradicted, and no difference is more than three times its estimate."""
        return not self.contradictions.any() and not self.largest_ratio > MAX_ERROR_RATIO


def sample(error: FloatArray, size: int) -> NDArray[np.int64]:
    """Return ``size`` random cells of a chart, the same ones at every call, and the one with the largest error.

    Cells without an error are left out: there is no system.
    """
    present = np.flatnonzero(~np.isnan(error))
    drawn = np.random.default_rng(AUDIT_SEED).choice(present.size, min(size, present.size), replace=False)
    chosen = np.union1d(present[drawn], [np.nanargmax(error)])
    return np.stack(np.unravel_index(chosen, error.shape), axis=1)


def integrate_again(system: AnySystem, Omega: float, eps: float) -> tuple[float, float, int]:
    """Return log|mu| by `monodromy`, its error and the verdict; NaN and undecided if `monodromy` raises ValueError."""
    try:
        found = monodromy(system, Omega, eps)
    except ValueError:
        return float("nan"), float("nan"), int(Kind.UNDECIDED)
    return found.growth_rate * 2 * np.pi / Omega, found.log_modulus_error, int(found.kind)
