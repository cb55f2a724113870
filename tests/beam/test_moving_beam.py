"""The beam against exact speeds, published frequencies and independent growth rates; its Hamiltonian structure."""

from __future__ import annotations

import pickle
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from beam import MovingBeam
from beam.matrices import transport
from floquet import monodromy
from periodic import PeriodicSystem
from tests.beam.beam_oracles import free_modes, fundamental, symplectic_defect
from tests.general_systems import Reference, growth_rates

STRING = MovingBeam(0.3, 0.0)
BEAM = MovingBeam(2.0, 0.64)
REFERENCES = {
    "string_v0.3_N4": STRING,
    "string_v0.3_N4_C0.02": replace(STRING, viscous_damping=0.02),
    "string_tension_v0.3_N8": MovingBeam(
        0.3, 0.0, terms=8, speed_amplitude=0.0, tension_amplitude=1.0, viscous_damping=0.02
    ),
    "beam_v0.6_vf0.8_N4_a0": replace(BEAM, speed=0.6),
    "beam_v2.0_vf0.8_N2_a0": replace(BEAM, terms=2),
    "beam_v2.0_vf0.8_N4_a0": BEAM,
    "beam_v2.0_vf0.8_N4_a0.001": replace(BEAM, damping=0.001),
    "beam_full_v2.0_vf0.8_a0.001": replace(BEAM, damping=0.001),
    "beam_material_weak_v1.0": MovingBeam(1.0, 0.64, 0.001, derivative="material"),
    "beam_material_strong_v1.0": MovingBeam(1.0, 0.64, 0.001, derivative="strong"),
}
RATES = growth_rates(REFERENCES)


@pytest.mark.parametrize("name", REFERENCES)
def test_matrices_of_the_references(name: str) -> None:
    theta = np.linspace(0, 6, 7)
    for Omega in (0.0, 17.0):
        reference = Reference(name, 0.37).at(Omega)
        assert isinstance(reference, PeriodicSystem)
        expected = reference.matrices(theta, 0.37)
        for found, matrix in zip(REFERENCES[name].at(Omega).matrices(theta, 0.37), expected, strict=True):
            np.testing.assert_allclose(found, matrix, atol=1e-14 * np.abs(matrix).max(), rtol=0)


def test_growth_rates_of_the_references() -> None:
    assert len(RATES) == 49
    for entry in RATES:
        found = monodromy(REFERENCES[entry["system"]], entry["Omega"], entry["eps"])
        assert found.growth_rate == pytest.approx(entry["value"], abs=1e-11), entry["id"]


def test_frequencies_of_chen_and_yang() -> None:
    # vf = 0.8, c0 = 2: 5.3692 and 30.1200, J. Sound Vib. 284 (2005) 879
    omega, _ = free_modes(replace(BEAM, terms=12).at(1.0))
    np.testing.assert_allclose(omega[:2], [5.3692, 30.1200], atol=1e-4)


def test_frequencies_of_a_string() -> None:
    omega, _ = free_modes(replace(STRING, terms=24).at(1.0))
    np.testing.assert_allclose(omega[:4], np.arange(1, 5) * np.pi * (1 - 0.3**2), rtol=1e-4)


@pytest.mark.parametrize("rigidity", [0.0, 0.64])
@pytest.mark.parametrize("terms", [1, 6])
def test_divergence_speed(rigidity: float, terms: int) -> None:
    # without rigidity v = 1; with it the beam buckles as sin pi x: v^2 = 1 + pi^2 vf^2
    beam = MovingBeam(0.0, rigidity, terms=terms)
    speed = beam.critical_speed()
    assert speed == pytest.approx(np.sqrt(1 + np.pi**2 * rigidity), rel=1e-15)
    lowest = [np.linalg.eigvalsh(replace(beam, speed=part * speed).at(1.0).stiffness)[0] for part in (0.0, 1 - 1e-10)]
    assert lowest[1] == pytest.approx(2e-10 * lowest[0], rel=1e-4)


@pytest.mark.parametrize("held_at", [None, 0.0, 0.5])
def test_undamped_beam_is_hamiltonian(held_at: float | None) -> None:
    # for the momentum at the speed at t = 0, v0 (1 + eps a), whatever speed and tension do
    beam = replace(BEAM, terms=3, speed_amplitude=1.2, tension_amplitude=0.7, tension_held_at=held_at)
    Phi = fundamental(beam.at(7.0), 7.0, 0.3, 2 * np.pi / 7.0)
    assert symplectic_defect(Phi, transport(3), 2.0 * (1 + 0.3 * 1.2)) < 1e-10
    assert symplectic_defect(Phi, transport(3), 2.0) > 1e-3


def test_without_the_acceleration_it_is_not() -> None:
    Omega, eps = 35.5, 0.1  # w_1 + w_2
    system = BEAM.at(Omega)
    parts = (system.mass, system.gyroscopic, system.damping, system.stiffness, system.cosine)
    lame = PeriodicSystem(*parts, 0 * system.sine, terms=system.terms)
    defects = [
        symplectic_defect(fundamental(one, Omega, eps, 2 * np.pi / Omega), transport(4), 2.0 * (1 + eps))
        for one in (system, lame)
    ]
    assert defects[0] < 1e-10
    assert defects[1] > 1e-4
    rates = [monodromy(one, Omega, eps).growth_rate for one in (system, lame)]
    assert abs(rates[0] - rates[1]) > 0.05


@pytest.mark.parametrize(
    ("speed", "damping", "rates"),
    [(1.0, 1e-3, (0.0311, 0.0350, 0.0401)), (1.4, 2e-3, (0.0617, 0.0768, 0.0968))],
)
def test_the_derivative_decides_the_decay(speed: float, damping: float, rates: tuple[float, ...]) -> None:
    # decay of mode 1, theory-general.md section 1
    for derivative, rate in zip(("partial", "material", "strong"), rates, strict=True):
        system = MovingBeam(speed, 0.64, damping, derivative=derivative).at(1.0)
        velocity = system.gyroscopic + system.damping
        exponents = np.linalg.eigvals(np.block([[-velocity, -system.stiffness], [np.eye(4), np.zeros((4, 4))]]))
        lowest = exponents[np.argsort(abs(exponents.imag))[:2]]
        np.testing.assert_allclose(-lowest.real, rate, atol=5e-5)


def test_mirror_in_x_reverses_the_speed() -> None:
    mirror = (-1.0) ** np.arange(4)
    beam = replace(BEAM, damping=0.01, tension_amplitude=0.2, derivative="material", tension_held_at=0.2)
    there, back = beam.at(5.0), replace(beam, speed=-2.0, tension_held_at=0.8).at(5.0)
    for one, other in zip(there.matrices(1.3, 0.2), back.matrices(1.3, 0.2), strict=True):
        np.testing.assert_allclose(mirror[:, None] * one * mirror, other, atol=1e-11)


def test_a_steady_speed_has_the_short_form() -> None:
    beam = replace(BEAM, speed_amplitude=0.0, tension_amplitude=0.5)
    assert beam.at(3.0) is beam.at(4.0)
    assert beam.at(3.0).terms == ()
    np.testing.assert_array_equal(beam.at(3.0).cosine[0], 0.5 * np.diag((np.arange(1, 5) * np.pi) ** 2))


def test_it_pickles_and_repeats_itself() -> None:
    beam = replace(BEAM, damping=0.01)
    again = pickle.loads(pickle.dumps(beam))
    assert again == beam
    for one, other in zip(beam.at(5.0).matrices(0.3, 0.2), again.at(5.0).matrices(0.3, 0.2), strict=True):
        np.testing.assert_array_equal(one, other)


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"speed": 2.8}, "speed = 2.8 is not below the divergence speed 2.70491"),
        ({"speed": -2.8}, "speed = -2.8 is not below"),
        ({"speed": float("nan")}, "speed = nan is out of range"),
        ({"speed_amplitude": 1e40}, "speed_amplitude = 1e.40 is no beam's"),
        ({"flexural_rigidity": -0.1}, "flexural_rigidity = -0.1 is out of range; give a number >= 0"),
        ({"damping": -1}, "damping = -1.0 is out of range"),
        ({"viscous_damping": "much"}, "viscous_damping = 'much' is not a number"),
        ({"terms": 0}, "terms = 0 is out of range"),
        ({"derivative": "total"}, "derivative = 'total' is not known; give one of 'partial', 'material', 'strong'"),
        ({"tension_held_at": 1.5}, "tension_held_at = 1.5 is out of range; give a place from 0 to 1"),
        ({"speed": 0.5, "flexural_rigidity": 0.0, "damping": 0.1}, "damping = 0.1 acts through bending"),
    ],
)
def test_refusals(changed: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        replace(BEAM, **changed)


@pytest.mark.parametrize("Omega", [-1.0, float("inf"), 1e101, None])
def test_refused_frequencies(Omega: Any) -> None:
    with pytest.raises(ValueError, match="Omega = "):
        BEAM.at(Omega)
