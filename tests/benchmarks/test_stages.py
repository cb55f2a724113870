"""The stages of a chart are those of a chart."""

from __future__ import annotations

import numpy as np

from benchmarks import grids, plate
from benchmarks.methods import error
from benchmarks.stages import chart_multipliers, stages
from benchmarks.subjects import BENCHMARK_DAMPING
from benchmarks.tables import stages_table
from floquet import monodromy


def test_stages_add_up_to_a_chart() -> None:
    family = plate(12, BENCHMARK_DAMPING)
    found = stages(family, *grids(2, 16), rounds=1)
    assert min(found.sampling, found.operations, found.peak) > 0
    # one column of 16 amplitudes is at least a hundred products of two blocks with 12 rows
    assert found.operations > 2 * 2 * 100 * 2 * 12**3
    table = stages_table({(12, 0.0): found})
    assert table.count("%") == 4


def test_multipliers_of_the_chart_are_those_of_the_reference() -> None:
    family = plate(12, 0.0)
    eps = np.linspace(0, 1, 24)
    found = chart_multipliers(family, 36.0, eps)
    assert error(found[-1], monodromy(family, 36.0, 1.0).multipliers, "all") < 1e-8
