"""The columns behind the explorer's page: cells where they belong, curves without false joints, labels apart."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from compare.explorer.page_data import LABEL_LINES, cell_data, curve_data, label_data, point_data
from compare.explorer.responses import response
from floquet import Kind, StabilityChart, stability_chart
from periodic.examples import coupled_mathieu, mathieu, meissner
from perturb import transition_curves
from plate import MovingPlate


def _chart(kinds: list[list[int]]) -> StabilityChart:
    kind = np.array(kinds, np.int8)
    rows, columns = kind.shape
    cells = np.arange(kind.size, dtype=float).reshape(kind.shape)
    return StabilityChart(
        Omega=np.linspace(1.0, 2.0, columns),
        eps=np.linspace(0.0, 0.5, rows),
        growth_rate=cells,
        multiplier=cells + 0j,
        kind=kind,
        error=cells,
    )


def test_cells_are_centred_on_their_points_and_stable_ones_transparent() -> None:
    data = cell_data(_chart([[0, 0, 0], [0, 2, 3], [-1, 1, 2]]))
    assert (data["x"], data["dw"]) == ([0.75], [1.5])
    assert data["y"][0] == pytest.approx(-0.125)
    assert data["dh"][0] == pytest.approx(0.75)
    np.testing.assert_array_equal(data["growth"][0], [[np.nan] * 3, [np.nan, 4, 5], [-1, 7, 8]])
    np.testing.assert_array_equal(data["kind"][0], [[np.nan] * 3, [np.nan, 2, 3], [-1, 1, 2]])
    np.testing.assert_array_equal(data["rate"][0], np.arange(9).reshape(3, 3))


def test_a_damped_curve_starts_at_its_tip() -> None:
    system = coupled_mathieu(damping=(0.02, 0.05))
    (curve,) = [curve for curve in transition_curves(system, (2.5, 3.0)) if curve.label == "ω₁+ω₂"]
    chart = stability_chart(system, [2.5, 3.0], [0.0, 1.0], n_jobs=1, progress=False, audit=0)
    data = curve_data([curve], chart)
    assert data["label"] == ["ω₁+ω₂", "ω₁+ω₂"]
    for eps, edge, wanted in zip(data["ys"], data["xs"], curve.edges(data["ys"][0]), strict=True):
        assert (eps[0], eps[-1]) == (curve.tip, 1.0)
        np.testing.assert_array_equal(edge, wanted)


def test_labels_never_overlap_and_the_widest_regions_come_first() -> None:
    plate = MovingPlate(axial_terms=3, lateral_terms=3, load=MovingPlate().load.with_waveform("sawtooth", harmonics=3))
    chart = replace(_chart([[Kind.STABLE] * 4] * 3), Omega=np.linspace(5.0, 80.0, 4))
    curves = transition_curves(plate, (5.0, 80.0))
    data = label_data(curves, chart)
    lines = sorted(set(data["y"]))
    assert 2 <= len(lines) <= LABEL_LINES
    for line in lines:
        places = sorted(x for x, y in zip(data["x"], data["y"], strict=True) if y == line)
        assert np.diff(places).min(initial=np.inf) > 0.05 * 75.0
    low, high = chart.Omega[0], chart.Omega[-1]
    assert min(data["x"]) >= low + 0.02 * (high - low)  # half a label
    assert max(data["x"]) <= high - 0.02 * (high - low)
    widths = {curve.label: float(np.nan_to_num(np.subtract(*curve.edges(0.5)[::-1]))) for curve in curves}
    assert max(widths, key=widths.__getitem__) in data["text"]
    assert all(0.0 < y < 0.5 for y in lines)


def test_huge_multipliers_keep_their_size() -> None:
    found = response(mathieu(), 0.5, 600.0)
    assert 1e40 < abs(found.mu) < np.inf
    data = point_data([found, response(mathieu(), 2.0, 0.5)])
    np.testing.assert_array_equal(data["re"][0], found.multipliers.real)
    assert data["wave_re"].shape == (2, found.wave.size)
    assert point_data([])["re"].shape == (0, 0)


def test_theory_without_an_end_is_a_gap_not_a_line() -> None:
    chart = _chart([[0, 0], [0, 0]])
    for curve in transition_curves(meissner(), (0.4, 2.5)):
        for edge in curve_data([curve], chart)["xs"]:
            assert not np.isinf(edge).any()
