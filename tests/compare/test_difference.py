"""The difference of two charts, cell by cell."""

from __future__ import annotations

import numpy as np
import pytest

from compare import difference
from floquet import Kind, StabilityChart, stability_chart
from periodic.examples import mathieu

GRID = (np.linspace(1.7, 2.3, 13), np.linspace(0.0, 0.5, 6))


def chart(damping: float) -> StabilityChart:
    return stability_chart(mathieu(damping=damping), *GRID, audit=0, n_jobs=1, progress=False)


def test_damping_of_mathieus_equation_takes_its_half_from_every_growth_rate() -> None:
    """x = y e^{-c t / 2} makes it Mathieu's again with 1 - c^2/4 for 1: where c is small, the rate falls by c / 2."""
    changed = difference(chart(0.0), chart(0.1))
    inside = chart(0.0).growth_rate > 0.06
    assert inside.sum() > 10
    assert changed.growth_rate[inside] == pytest.approx(-0.05, abs=2e-3)
    assert not changed.became_unstable.any()
    was, now = chart(0.0).kind, chart(0.1).kind
    clear = (was >= 0) & (now >= 0)
    assert np.array_equal(changed.became_stable, (was > 0) & (now == 0))
    assert changed.became_stable.any()
    assert np.array_equal(changed.unknown, ~clear)
    back = difference(chart(0.1), chart(0.0))
    assert np.array_equal(back.became_unstable, changed.became_stable)
    assert np.array_equal(back.growth_rate, -changed.growth_rate)


def test_undecided_cells_are_neither() -> None:
    one = chart(0.0)
    kind = one.kind.copy()
    kind[-1, 6] = Kind.UNDECIDED
    doubtful = StabilityChart(one.Omega, one.eps, one.growth_rate, one.multiplier, kind, one.error)
    changed = difference(doubtful, chart(0.5))
    assert changed.unknown[-1, 6]
    assert not changed.became_stable[-1, 6]
    assert "% unknown; growth rate changes by -" in repr(changed)
    assert repr(changed).startswith("ChartDifference(13 × 6 cells: 0.0% became unstable, ")


def test_other_grids_are_refused() -> None:
    other = stability_chart(mathieu(), [1.7, 2.0], GRID[1], audit=0, n_jobs=1, progress=False)
    with pytest.raises(
        ValueError, match=r"^Omega differs: 13 from 1\.7 to 2\.3 in the first chart, 2 from 1\.7 to 2 in"
    ):
        difference(chart(0.0), other)
    with pytest.raises(ValueError, match=r"^second = None is not a chart"):
        difference(other, None)
