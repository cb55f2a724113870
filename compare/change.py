"""What changes from one stability chart to another on the same grid."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from floquet import Kind, StabilityChart
from periodic.checks import FloatArray


@dataclass(frozen=True, eq=False, repr=False)
class ChartDifference:
    """The second of two charts against the first.

    Attributes
    ----------
    Omega : ndarray, shape (m,)
    eps : ndarray, shape (k,)
        The grid of both.
    growth_rate : ndarray, shape (k, m)
        That of the second less that of the first, in the units of Omega.
    became_unstable, became_stable : ndarray of bool, shape (k, m)
        Cells that are stable in one and unstable in the other.
    unknown : ndarray of bool, shape (k, m)
        Cells that are undecided in one of the two.
    """

    Omega: FloatArray
    eps: FloatArray
    growth_rate: FloatArray
    became_unstable: NDArray[np.bool_]
    became_stable: NDArray[np.bool_]
    unknown: NDArray[np.bool_]

    def __repr__(self) -> str:
        k, m = self.growth_rate.shape
        unknown = f", {self.unknown.mean():.1%} unknown" if self.unknown.any() else ""
        return (
            f"ChartDifference({m} × {k} cells: {self.became_unstable.mean():.1%} became unstable, "
            f"{self.became_stable.mean():.1%} stable{unknown}; growth rate changes by {self.growth_rate.min():.4g} to "
            f"{self.growth_rate.max():.4g})"
        )


def difference(first: StabilityChart, second: StabilityChart) -> ChartDifference:
    """Return what changes from the first chart to the second.

    Parameters
    ----------
    first, second : StabilityChart
        On the same grid.

    Raises
    ------
    ValueError
        If one is no chart, or their grids differ.
    """
    for name, chart in (("first", first), ("second", second)):
        if not isinstance(chart, StabilityChart):
            raise ValueError(f"{name} = {chart!r} is not a chart; give one of stability_chart")
    for name in ("Omega", "eps"):
        one, other = getattr(first, name), getattr(second, name)
        if not np.array_equal(one, other):
            shown = [f"{grid.size} from {grid[0]:.6g} to {grid[-1]:.6g}" for grid in (one, other)]
            raise ValueError(f"{name} differs: {shown[0]} in the first chart, {shown[1]} in the second; give one grid")
    was, now = first.kind > Kind.STABLE, second.kind > Kind.STABLE
    unknown = (first.kind == Kind.UNDECIDED) | (second.kind == Kind.UNDECIDED)
    return ChartDifference(
        first.Omega,
        first.eps,
        second.growth_rate - first.growth_rate,
        now & ~was & ~unknown,
        was & ~now & ~unknown,
        unknown,
    )
