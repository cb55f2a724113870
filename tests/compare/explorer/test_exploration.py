"""The window of an exploration, what is said about it, and what is written."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from compare.explorer.exploration import explore
from compare.window import default_window
from floquet import StabilityChart
from periodic import PeriodicSystem, Term, waveforms
from periodic.examples import coupled_mathieu, gyroscopic_rotor, mathieu


def test_without_positive_stiffness_one_sentence_replaces_the_curves() -> None:
    trap = mathieu(-0.3)
    (low, high), eps = default_window(trap)
    result = explore(trap, (low, high), eps, points=(32, 16), n_jobs=1)
    assert result.curves == []
    assert result.remark == "There are no analytic curves: no resonance starts in the window or beside it."
    assert (result.chart.kind == 0).any()  # the trap holds somewhere
    assert (result.chart.kind[0] > 0).all()  # and nowhere without a field


def test_motion_without_stiffness_is_told() -> None:
    # Two masses and a spring, free to drift together: no resonance explains where they drift apart from that.
    zero = np.zeros((2, 2))
    free = PeriodicSystem(np.diag([1.0, 1e4]), zero, zero, [[1, -1], [-1, 1]], [np.diag([1.0, 0.0])])
    assert "1 motion has no stiffness" in explore(free, (0.5, 3.0), 0.5, points=(8, 4), trace=False, n_jobs=1).remark
    adrift = PeriodicSystem(np.eye(2), zero, zero, zero, [np.eye(2)])
    assert "2 motions have no stiffness" in explore(adrift, (0.5, 3), 0.5, points=(8, 4), trace=False, n_jobs=1).remark
    for trap in (mathieu(-0.3), gyroscopic_rotor()):
        assert "no stiffness" not in explore(trap, (0.5, 3.0), 0.5, points=(8, 4), trace=False, n_jobs=1).remark


def test_curves_that_never_open_are_not_drawn() -> None:
    result = explore(coupled_mathieu("sum"), (0.3, 4.0), 0.5, points=(8, 4), n_jobs=1)
    assert [curve.label for curve in result.curves] == ["ω₁+ω₂"]
    result = explore(coupled_mathieu("difference"), (0.3, 4.0), 0.5, points=(8, 4), n_jobs=1)
    assert [curve.label for curve in result.curves] == ["ω₂−ω₁"]


@pytest.mark.parametrize(
    ("arguments", "wanted"),
    [
        ({"Omega_range": (2.0, 1.0)}, "Omega_range"),
        ({"Omega_range": (0.0, 1.0)}, "Omega_range"),
        ({"Omega_range": (1.0, np.nan)}, "Omega_range"),
        ({"eps_max": 0.0}, "eps_max = 0.0"),
        ({"eps_max": np.inf}, "eps_max = inf"),
        ({"points": (1, 5)}, "points = 1"),
        ({"points": (5, 10**9)}, "points = 1000000000"),
        ({"order": 3}, "order = 3"),
    ],
)
def test_a_wrong_argument_is_named(arguments: dict[str, object], wanted: str) -> None:
    with pytest.raises(ValueError, match=wanted):
        explore(mathieu(), **{"Omega_range": (1.0, 3.0), "eps_max": 0.5} | arguments)


def test_what_is_written_can_be_read_again(tmp_path: Path) -> None:
    xarray = pytest.importorskip("xarray")
    result = explore(mathieu(1.0, 0.05), (1.0, 3.0), 0.5, points=(16, 8), title="Mathieu", n_jobs=1)
    result.write(tmp_path, "mathieu", netcdf=True)
    pictures = ["mathieu-chart.png", "mathieu-overlay.pdf", "mathieu-overlay.png"]
    others = ["mathieu-regions.json", "mathieu.nc", "mathieu.npz"]
    assert sorted(path.name for path in tmp_path.iterdir()) == [*pictures, *others]
    regions = json.loads((tmp_path / "mathieu-regions.json").read_text(encoding="utf-8"))
    assert [region["label"] for region in regions] == ["2ω₁"]
    assert regions[0]["tip"] == pytest.approx([2.0, 2 * 0.05], rel=0.02)  # closed below 2 omega damping
    assert regions[0]["width"] == pytest.approx(np.sqrt(0.5**2 - 0.1**2), rel=0.03)  # first order, at the top
    np.testing.assert_array_equal(StabilityChart.load(tmp_path / "mathieu.npz").kind, result.chart.kind)
    with xarray.open_dataset(tmp_path / "mathieu.nc", engine="scipy") as data:
        np.testing.assert_array_equal(data.growth_rate, result.chart.growth_rate)
        np.testing.assert_array_equal(data.multiplier_real + 1j * data.multiplier_imag, result.chart.multiplier)
        assert data.growth_rate.dims == ("eps", "Omega")


def test_regions_that_were_not_traced_are_not_written_as_none_found(tmp_path: Path) -> None:
    for trace, wanted in ((True, []), (False, None)):
        result = explore(mathieu(), (1.2, 1.3), 0.1, points=(4, 3), trace=trace, n_jobs=1)
        result.write(tmp_path, "quiet")
        assert json.loads((tmp_path / "quiet-regions.json").read_text(encoding="utf-8")) == wanted


def test_the_audit_is_told() -> None:
    result = explore(mathieu(), (1.0, 3.0), 0.5, points=(16, 8), n_jobs=1)
    assert "integrated again by another method" in result.audit
    assert "within the estimated error" in result.audit


def test_any_linear_periodic_system_has_its_chart(tmp_path: Path) -> None:
    damping = Term("damping", [[1.0]], waveforms.cosine(1))
    system = PeriodicSystem([[1.0]], damping=[[0.1]], stiffness=[[1.0]], terms=[damping])
    result = explore(system, (1.5, 2.5), 0.8, points=(8, 4), n_jobs=1)
    assert "The analytic curves are left out" in result.remark or result.curves
    assert "The regions are not traced: that takes systems of which the stiffness alone" in result.remark
    assert not result.traced
    assert (result.chart.kind > 0).any()
    result.write(tmp_path, "damped")
    assert json.loads((tmp_path / "damped-regions.json").read_text(encoding="utf-8")) is None
