"""Plates in SI units: keys with units, quantities with any unit, and errors that name both sides of a mixture."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

from compare.files import Case, load_case
from compare.files.quantities import _registry
from compare.pictures import overlay
from floquet import stability_chart
from periodic.examples import mathieu
from plate import MovingPlate, SoftMaterialWarning

WEB = """
title = "A paper web"
[plate]
length_m = 0.1
width_m = 1.0
thickness_m = 1e-4
areal_density_kg_per_m2 = 0.08
youngs_modulus_Pa = 1e9
tension_N_per_m = 500.0
speed_m_per_s = 60.0
axial_terms = 3
lateral_terms = 4
[chart]
Omega_Hz = [150.0, 1000.0]
"""


def case(tmp_path: Path, text: str) -> Case:
    (tmp_path / "web.toml").write_text(text, encoding="utf-8")
    return load_case(tmp_path / "web.toml")


def test_a_paper_web(tmp_path: Path) -> None:
    found = case(tmp_path, WEB.replace("axial_terms = 3\nlateral_terms = 4\n", ""))
    assert found.units is not None
    assert found.units.critical_speed() * found.units.speed_unit == pytest.approx(79.06404, abs=5e-6)
    assert np.array(found.window) * found.units.frequency_unit == pytest.approx([300 * np.pi, 2000 * np.pi])


def test_quantities_with_any_unit_are_the_same_plate(tmp_path: Path) -> None:
    pytest.importorskip("pint")
    text = (
        WEB.replace("length_m = 0.1", 'length = "10 cm"')
        .replace("areal_density_kg_per_m2 = 0.08", 'density = "0.8 g/cm^3"')
        .replace("youngs_modulus_Pa = 1e9", 'youngs_modulus = "1 GPa"')
        .replace("speed_m_per_s = 60.0", 'speed = "216 km/hour"')
    )
    a, b = case(tmp_path, WEB).units, case(tmp_path, text).units
    assert a is not None
    assert b is not None
    for name in ("aspect_ratio", "speed", "tension", "thickness_ratio", "time_unit"):
        assert getattr(a, name) == pytest.approx(getattr(b, name), rel=1e-12)


@pytest.mark.parametrize(
    ("old", "new", "wanted"),
    [
        ("length_m = 0.1", "aspect_ratio = 0.1", "aspect_ratio is dimensionless and width_m is in SI"),
        ("length_m = 0.1", "", "length_m is missing"),
        ("areal_density_kg_per_m2 = 0.08", "", "give one of density_kg_per_m3 and areal_density_kg_per_m2"),
        ("length_m = 0.1", 'length_m = 0.1\nlength = "10 cm"', "length_m and length say the same"),
        ("length_m = 0.1", 'length = "10 kg"', "length = '10 kg' is no quantity in m"),
        ("length_m = 0.1", 'length = "long"', "length = 'long' is no quantity in m"),
        ("speed_m_per_s = 60.0", "speed_m_per_s = 80.0", "divergence speed"),
        ("Omega_Hz = [150.0, 1000.0]", "Omega_Hz = [1000.0, 150.0]", "Omega_Hz = .* is no window"),
        ("Omega_Hz = [150.0, 1000.0]", "Omega_Hz = [1.0, 2.0]\nOmega = [1.0, 2.0]", "say the same"),
    ],
)
def test_mixtures_and_slips(tmp_path: Path, old: str, new: str, wanted: str) -> None:
    pytest.importorskip("pint")
    with pytest.raises(ValueError, match=wanted):
        case(tmp_path, WEB.replace(old, new))


def test_hertz_need_a_plate_in_si_units(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="Omega_Hz needs a plate in SI units"):
        case(tmp_path, 'title = "t"\n[chart]\nOmega_Hz = [1.0, 2.0]')


def test_without_pint_a_text_is_answered(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pint", None)
    _registry.cache_clear()
    with pytest.raises(ValueError, match=r"needs pint: .* or give length_m as a number"):
        case(tmp_path, WEB.replace("length_m = 0.1", 'length = "10 cm"'))


def test_a_modulus_in_gigapascals_is_noticed() -> None:
    with pytest.warns(SoftMaterialWarning, match="206"):
        MovingPlate.from_si(
            length=1.0,
            width=1.0,
            thickness=1e-3,
            density=7850.0,
            youngs_modulus=206,
            poisson_ratio=0.3,
            speed=0.0,
            tension=10.0,
        )


def test_a_picture_in_hertz() -> None:
    chart = stability_chart(mathieu(), np.linspace(1.0, 3.0, 16), np.linspace(0, 0.3, 8), n_jobs=1, progress=False)
    axes = overlay(chart, [], units="Hz").axes[0]
    assert axes.get_xlabel() == "excitation frequency (Hz)"
    for place, label in zip(axes.get_xticks(), axes.get_xticklabels(), strict=True):
        assert float(label.get_text()) == pytest.approx(place / (2 * np.pi), rel=1e-5)
    assert axes.get_xlim() == (1.0, 3.0)
