"""The plate at a pulsating speed: its matrices, growth rates and Hamiltonian structure."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.polynomial import Legendre

from beam import MovingBeam
from floquet import monodromy
from periodic import PeriodicSystem
from periodic.checks import FloatArray
from plate import EdgeLoad, MovingPlate, transverse
from tests.beam.beam_oracles import fundamental, symplectic_defect
from tests.general_systems import Reference, growth_rates

STEADY = MovingPlate(speed=3.0, tension=10.0, axial_terms=3, lateral_terms=4)
PULSATING = replace(STEADY, speed_amplitude=1.0, load_amplitude=0.0)
REFERENCES = {
    "plate_V3.0_f10.0_r1.0_c0.0": PULSATING,
    "plate_V3.0_f10.0_r1.0_c0.001": replace(PULSATING, damping=0.001),
    "plate_V3.0_f10.0_r1.0_c0.001_tension3.0": replace(PULSATING, damping=0.001, load_amplitude=0.3),
    "plate_V3.0_f10.0_r1.0_c0.001_tension0.0_material": replace(PULSATING, damping=0.001, derivative="material"),
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
            np.testing.assert_allclose(found, matrix, atol=1e-13 * max(1.0, np.abs(matrix).max()), rtol=0)


def test_growth_rates_of_the_references() -> None:
    assert len(RATES) == 24
    for entry in RATES:
        found = monodromy(REFERENCES[entry["system"]], entry["Omega"], entry["eps"])
        assert found.growth_rate == pytest.approx(entry["value"], abs=1e-11), entry["id"]


@pytest.mark.parametrize("r", [1.0, 0.7])
def test_carried_bending_is_its_integral(r: float) -> None:
    K, lateral, nu = 3, 4, 0.3
    nodes, weights = np.polynomial.legendre.leggauss(30)
    X, Y = r * (nodes + 1) / 2, (nodes + 1) / 2
    area = np.multiply.outer(r * weights / 2, weights / 2).ravel()
    k = np.arange(1, K + 1) * np.pi / r

    def function(in_x: int, in_y: int) -> FloatArray:
        """Return the derivative of s_k(X) q_l(Y) at all nodes, shape (nodes, K lateral)."""
        s = np.sqrt(2 / r) * k**in_x * np.sin(np.outer(X, k) + in_x * np.pi / 2)
        q = [np.sqrt(2 * l + 1) * Legendre.basis(l, domain=[0, 1]).deriv(in_y)(Y) for l in range(lateral)]
        return np.einsum("xk,ly->xykl", s, np.array(q)).reshape(area.size, -1)

    def integral(phi: FloatArray, w: FloatArray) -> FloatArray:
        return (phi * area[:, None]).T @ w

    W = (
        integral(function(2, 0), function(3, 0))
        + integral(function(0, 2), function(1, 2))
        + nu * (integral(function(0, 2), function(3, 0)) + integral(function(2, 0), function(1, 2)))
        + 2 * (1 - nu) * integral(function(1, 1), function(2, 1))
    )
    found = transverse.carried_bending(K, lateral, r, nu)
    np.testing.assert_allclose(found, W, atol=1e-13 * np.abs(W).max(), rtol=0)


@pytest.mark.parametrize("derivative", ["partial", "material"])
@pytest.mark.parametrize("held_at", [None, 0.4])
def test_without_poissons_ratio_it_is_the_beam(derivative: str, held_at: float | None) -> None:
    # one coordinate across; the beam measures time and speed by the tension
    f0, Omega, eps = 7.0, 20.0, 0.3
    common: dict[str, Any] = {"derivative": derivative, "tension_held_at": held_at, "speed_amplitude": 0.8}
    plate = MovingPlate(
        poisson_ratio=0,
        speed=3.0,
        tension=f0,
        damping=0.01,
        axial_terms=4,
        lateral_terms=1,
        load_amplitude=0.6,
        **common,
    )
    unit = np.sqrt(f0)
    beam = MovingBeam(3.0 / unit, 1 / f0, 0.01 * unit, tension_amplitude=0.6, **common)
    assert plate.critical_speed() == pytest.approx(unit * beam.critical_speed(), rel=1e-12)
    theta = np.linspace(0, 6, 7)
    scales = (1.0, unit, unit, f0)
    of_beam = beam.at(Omega / unit).matrices(theta, eps)
    for scale, one, other in zip(scales, plate.at(Omega).matrices(theta, eps), of_beam, strict=True):
        np.testing.assert_allclose(one, scale * other, atol=1e-12 * np.abs(one).max(), rtol=0)


@pytest.mark.parametrize("inplane", ["membrane", "static", "dynamic"])
def test_undamped_plate_is_hamiltonian(inplane: str) -> None:
    plate = MovingPlate(
        axial_terms=2, lateral_terms=2, speed_amplitude=0.5, inplane=inplane, load=EdgeLoad.partial(0.5)
    )
    system = plate.at(25.0)
    Phi = fundamental(system, 25.0, 0.4, 2 * np.pi / 25.0)
    B = system.gyroscopic / (2 * plate.speed)
    assert symplectic_defect(Phi, B, plate.speed * (1 + 0.4 * 0.5)) < 1e-10
    assert symplectic_defect(Phi, B, plate.speed) > 1e-3


@pytest.mark.parametrize("inplane", ["membrane", "static", "dynamic"])
def test_a_steady_speed_is_as_it_was(inplane: str) -> None:
    # to the last bit, in the short form
    load = EdgeLoad.partial(0.5).with_waveform({1: (1.0, 0.3), 2: (0.2, 0.0)})
    plate = MovingPlate(inplane=inplane, load=load, damping=1e-3, inplane_terms=(5, 5))
    system = plate.at(30.0)
    assert system.terms == ()
    bare = replace(plate, load_amplitude=0.0, speed_amplitude=0.0).at(30.0)
    assert not bare.cosine.any()
    assert not bare.sine.any()
    tension = plate.tension
    F = [tension * plate._stress.stiffness(j, 30.0) for j in (1, 2)]
    np.testing.assert_array_equal(system.cosine, np.real(F))
    np.testing.assert_array_equal(system.sine, -np.imag(F))
    np.testing.assert_array_equal(system.stiffness, bare.stiffness)


def test_speed_and_load_pulsate_together() -> None:
    # each term is of first order in what pulsates
    both = replace(PULSATING, load_amplitude=0.7, tension_held_at=0.3).at(12.0)
    speed = replace(PULSATING, tension_held_at=0.3).at(12.0)
    load = replace(STEADY, load_amplitude=0.7).at(12.0)
    np.testing.assert_allclose(both.cosine, speed.cosine + load.cosine, atol=1e-12)
    np.testing.assert_array_equal(both.sine, speed.sine)
    twice = replace(PULSATING, tension_held_at=0.3).at(24.0)
    np.testing.assert_allclose(twice.sine, 2 * speed.sine, rtol=1e-14)


def test_stress_of_the_accelerating_web() -> None:
    # dN_xx / dX = V': the tension accelerates the web
    plate = replace(PULSATING, load_amplitude=0.5, tension_held_at=0.25)
    field = plate.stress(8.0, 1, x=[0.0, 0.25, 1.0], y=[0.2])
    acceleration = 3.0 * 8.0 * np.array([-0.25, 0.0, 0.75])  # the amplitude of V' = - V_1 Omega sin is that of - i (-)
    np.testing.assert_allclose(field.N_xx[0], 5.0 + 1j * acceleration, rtol=1e-14)
    np.testing.assert_allclose(plate.stress(8.0, 0, x=[1.0], y=[0.2]).N_xx, 10.0)


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"speed_amplitude": float("inf")}, "speed_amplitude = inf is out of range"),
        ({"speed_amplitude": 1e200}, r"\(speed \* speed_amplitude\)\^2 = inf is out of range"),
        ({"load_amplitude": 1e308}, r"tension \* load_amplitude = inf is out of range"),
        ({"load_amplitude": None}, "load_amplitude = None is not a number"),
        ({"derivative": "strong"}, "derivative = 'strong' is not known; give one of 'partial', 'material'"),
        ({"tension_held_at": 1.1}, "tension_held_at = 1.1 is out of range; give a place from 0 to 1, or None"),
        ({"tension_held_at": 0.5, "inplane": "static"}, "tension_held_at = 0.5 is for inplane='membrane'"),
    ],
)
def test_refusals(changed: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        replace(STEADY, **changed)
