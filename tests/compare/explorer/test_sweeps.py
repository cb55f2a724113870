"""Sweeps: exact dependences on a parameter, and what is left out."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest

from compare.explorer.sweep_panels import sweep_picture
from compare.explorer.sweeps import sweep
from compare.explorer.variation import SWEEPABLE, current, plate_table, varied
from compare.files import Load, Plate, load_case
from floquet import monodromy
from tests.paths import ROOT

SMALL = Plate(axial_terms=2, lateral_terms=2)


def test_tension_of_a_plate_at_rest_moves_regions_as_mathieu_says() -> None:
    # Uniform tension at V = 0: every mode is Mathieu's equation with omega^2 = omega_0^2 + f0 m^2 (pi/r)^2, excited by
    # f0 m^2 (pi/r)^2, so the region 2 omega_1 has the slope f0 pi^2 / (2 omega_1) for m = r = 1.
    values = np.linspace(1, 20, 7)
    result = sweep(SMALL.model_copy(update={"speed": 0.0}), "tension", values, [(1, 1)], eps=0.01, n_jobs=1)
    region = result.regions[0]
    omega_1 = region.centre / 2
    np.testing.assert_allclose(np.diff(omega_1**2), np.diff(values) * np.pi**2, rtol=1e-9)
    np.testing.assert_allclose(region.slope, values * np.pi**2 / (2 * omega_1), rtol=1e-9)
    np.testing.assert_allclose(region.width, 2 * 0.01 * region.slope, rtol=1e-9)
    # the next term of Mathieu's edges is eps^2 / (16 omega^3) of each edge, here less than 1e-4 of the width
    kept = np.isin(result.values, result.traced_values)
    np.testing.assert_allclose(region.traced_width, region.width[kept], rtol=1e-3)
    np.testing.assert_allclose(region.traced_centre, region.centre[kept], rtol=1e-3)


def test_thresholds_grow_with_damping_and_are_where_the_multipliers_leave_the_circle() -> None:
    values = [1e-4, 2e-4, 4e-4]
    result = sweep(SMALL, "damping", values, [(1, 1), (2, 2)], eps=0.2, n_jobs=1)
    for region in result.regions:
        np.testing.assert_allclose(region.tip / region.tip[0], [1, 2, 4], rtol=1e-9)  # theory is linear in c
        np.testing.assert_allclose(region.traced_tip, region.tip, rtol=2e-2)  # O(eps^2) of the threshold
    plate, tip = varied(SMALL, "damping", 4e-4).build(), result.regions[0].traced_tip[2]
    Omega = result.regions[0].centre[2]
    assert monodromy(plate, Omega, 0.97 * tip).growth_rate < 0 < monodromy(plate, Omega, 1.03 * tip).growth_rate


def test_damping_that_moves_the_frequencies_leaves_no_traced_points() -> None:
    (region,) = sweep(SMALL, "damping", [0.0, 1e-4, 0.1], [(2, 2)], eps=0.1, n_jobs=1).regions
    assert np.isfinite(region.traced_width[:2]).all()
    assert np.isnan([region.traced_centre[2], region.traced_width[2], region.traced_tip[2]]).all()


def test_speeds_above_divergence_are_left_out_and_said_so() -> None:
    V_cr = SMALL.build().critical_speed()
    values = np.array([0.0, 0.5, 1.1, 1.3]) * V_cr
    result = sweep(SMALL, "speed", values, [(1, 1)], n_jobs=1)
    np.testing.assert_array_equal(result.values, values[:2])
    assert [value for value, _ in result.left_out] == values[2:].tolist()
    assert "divergence speed" in result.remark
    assert f"from {values[2]:.6g} to {values[3]:.6g}" in result.remark
    with pytest.raises(ValueError, match=r"speed gives no plate at any of the values.*divergence"):
        sweep(SMALL, "speed", values[2:], [(1, 1)], n_jobs=1)


def test_the_order_of_a_pair_does_not_matter_and_the_eps_of_a_closed_region_gives_no_width() -> None:
    one = sweep(SMALL, "speed", [1.0, 2.0], [(1, 3)], n_jobs=1)
    other = sweep(SMALL, "speed", [1.0, 2.0], [(3, 1)], n_jobs=1)
    np.testing.assert_array_equal(one.regions[0].width, other.regions[0].width)
    damped = sweep(SMALL, "damping", [1e-2, 2e-2], [(2, 2)], eps=0.01, n_jobs=1).regions[0]
    assert not damped.width.any()
    assert not damped.traced_width.any()
    assert np.isnan(damped.traced_centre).all()


def test_data_and_picture_are_written(tmp_path: Path) -> None:
    result = sweep(SMALL, "width", [0.5, 0.75, 1.0], [(1, 1), (2, 1)], n_jobs=1)
    result.write(tmp_path, "w")
    sweep_picture(result, title="t").savefig(tmp_path / "w.png")
    with (tmp_path / "w.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 6
    assert [float(row["centre"]) for row in rows if row["region"] == "2ω₁"] == result.regions[0].centre.tolist()
    with np.load(tmp_path / "w.npz") as data:
        np.testing.assert_array_equal(data["traced_width"], [region.traced_width for region in result.regions])
        assert data["labels"].tolist() == ["2ω₁", "ω₁+ω₂"]


@pytest.mark.parametrize(
    ("arguments", "wanted"),
    [
        ({"name": "sped"}, "name = 'sped'"),
        ({"values": [2.0, 1.0]}, "values is not strictly increasing"),
        ({"values": [1.0, np.nan]}, "values has the entry nan"),
        ({"values": []}, "values is empty"),
        ({"name": "thickness_ratio", "values": [0.01, 0.02]}, "thickness_ratio has no effect without"),
        ({"eps": 0.0}, "eps = 0.0"),
        ({"regions": [(1, 5)]}, "mode 5; the plate has 4 modes"),
        ({"regions": [(1, 0)]}, "regions = 0 is out of range"),
    ],
)
def test_a_wrong_argument_is_named(arguments: dict[str, object], wanted: str) -> None:
    with pytest.raises(ValueError, match=wanted):
        sweep(SMALL, **{"name": "speed", "values": [1.0, 2.0], "regions": [(1, 1)]} | arguments)


@pytest.mark.parametrize("name", SWEEPABLE)
def test_a_variation_changes_its_entry_alone(name: str) -> None:
    value = {"aspect_ratio": 2.0, "poisson_ratio": 0.2, "thickness_ratio": 0.02, "damping": 1e-4}.get(name, 0.5)
    before, after = current(SMALL), current(varied(SMALL, name, value))
    assert after == before | {name: value}


def test_a_load_keeps_what_is_not_varied() -> None:
    load = Load(shape="partial", parameters={"width": 0.4, "centre": 0.3}, waveform="square", harmonics=3)
    plate = SMALL.model_copy(update={"load": load})
    wider = varied(plate, "width", 0.5)
    assert wider.load == load.model_copy(update={"parameters": {"width": 0.5, "centre": 0.3}})
    assert varied(plate, "harmonics", 5).build().load.harmonics == 5
    with pytest.raises(ValueError, match="width"):
        varied(plate, "width", 0.9).build()


def test_the_table_of_a_variant_builds_its_plate() -> None:
    case = load_case(ROOT / "cases" / "fig4.toml")
    for label, plate in case.systems().items():
        found, table = plate_table(case, label)
        assert (found, table.build()) == (label, plate)
    assert plate_table(case)[0] == case.variants[0].label
    with pytest.raises(ValueError, match="variant = 'none' is not known; give one of"):
        plate_table(case, "none")
