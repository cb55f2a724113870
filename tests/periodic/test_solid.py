"""The standard linear solid against its characteristic equations, with and without excitation."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from beam import MovingBeam
from floquet import monodromy
from periodic import FirstOrderSystem, PeriodicSystem, StandardLinearSolid, Term, waveforms
from periodic.checks import ComplexArray
from periodic.examples import mathieu
from plate import MovingPlate

BEAM = MovingBeam(1.5, 0.64, damping=0.01, terms=2)


def dynamic_stiffness(system: PeriodicSystem, time: float, s: complex) -> ComplexArray:
    """Return what W e^(s t) meets without excitation: the force of the damping is C s / (1 + time s) W."""
    return s**2 * system.mass + s * system.gyroscopic + system.stiffness + s / (1 + time * s) * system.damping


def hill(system: PeriodicSystem, time: float, s: complex, Omega: float, eps: float, H: int) -> ComplexArray:
    """Return Hill's matrix of the exponent s, in harmonics -H to H."""
    n, samples = system.size, 16
    _, G, _, K = system.matrices(2 * np.pi * np.arange(samples) / samples, eps)
    velocity, place = (np.fft.fft(X, axis=0) / samples for X in (G, K))
    rows = np.zeros((2 * H + 1, n, 2 * H + 1, n), dtype=complex)
    for h in range(-H, H + 1):
        for m in range(max(-H, h - 4), min(H, h + 4) + 1):
            rate = s + 1j * m * Omega
            rows[h + H, :, m + H] = velocity[(h - m) % samples] * rate + place[(h - m) % samples]
        rate = s + 1j * h * Omega
        rows[h + H, :, h + H] += rate**2 * system.mass + rate / (1 + time * rate) * system.damping
    return rows.reshape((2 * H + 1) * n, -1)


def smallness(matrix: ComplexArray) -> float:
    """Return how singular a matrix is, its rows scaled to one size."""
    scaled = matrix / np.linalg.norm(matrix, axis=1)[:, None]
    return float(np.linalg.svd(scaled, compute_uv=False)[-1])


def test_one_coordinate() -> None:
    # (1 + t s) (s^2 + 1) + c s = 0
    system = StandardLinearSolid(PeriodicSystem([[1.0]], damping=[[0.3]], stiffness=[[1.0]]), time=0.7).at(1.0)
    found = np.sort_complex(np.linalg.eigvals(system.constant))
    np.testing.assert_allclose(found, np.sort_complex(np.roots([0.7, 1.0, 0.7 + 0.3, 1.0])), rtol=1e-13)


@pytest.mark.parametrize("family", [BEAM, MovingPlate(axial_terms=2, lateral_terms=3, damping=0.01)])
def test_exponents_without_excitation(family: Any) -> None:
    time = 0.05
    member = family.at(3.0)
    exponents = np.linalg.eigvals(StandardLinearSolid(family, time).at(3.0).constant)
    rank = np.linalg.matrix_rank(member.damping)
    assert len(exponents) == 2 * member.size + rank
    for s in exponents:
        assert smallness(dynamic_stiffness(member, time, s)) < 1e-11
        assert smallness(dynamic_stiffness(member, time, s + 0.01)) > 1e-8


@pytest.mark.parametrize("Omega", [8.0, 30.0])
def test_exponents_with_excitation(Omega: float) -> None:
    # speed and tension pulsate; Hill's determinant knows no memory variable, only the force's dependence on s
    time, eps = 0.05, 0.2
    beam = MovingBeam(1.5, 0.64, damping=0.01, terms=2, tension_amplitude=0.5)
    found = monodromy(StandardLinearSolid(beam, time), Omega, eps)
    exponent = np.log(complex(found.multipliers[0])) * Omega / (2 * np.pi)
    assert exponent.real == pytest.approx(found.growth_rate, abs=1e-12)
    assert smallness(hill(beam.at(Omega), time, exponent, Omega, eps, H=12)) < 1e-10
    assert smallness(hill(beam.at(Omega), time, exponent + 1e-3, Omega, eps, H=12)) > 1e-7


def test_kelvin_voigt_is_the_limit() -> None:
    times = np.array([1e-3, 1e-4])
    limit = monodromy(BEAM, 30.0, 0.1).growth_rate
    gaps = [monodromy(StandardLinearSolid(BEAM, time), 30.0, 0.1).growth_rate - limit for time in times]
    assert gaps[0] / gaps[1] == pytest.approx(10, rel=0.1)
    assert abs(gaps[1]) < 1e-2 * abs(limit)


def test_a_memory_for_each_dashpot_alone() -> None:
    # one dashpot of two coordinates: one memory; none: none
    one = PeriodicSystem(np.eye(2), damping=[[1.0, -1.0], [-1.0, 1.0]], stiffness=np.diag([1.0, 2.0]))
    assert StandardLinearSolid(one, 1.0).at(1.0).size == 5
    assert StandardLinearSolid(mathieu(), 1.0).at(1.0).size == 2


@pytest.mark.parametrize(
    ("family", "time", "message"),
    [
        (BEAM, 0.0, "time = 0.0 is out of range; give a positive number"),
        (MovingBeam(1.5, 0.64, damping=0.01, derivative="material"), 1.0, "family has derivative = 'material'"),
        (PeriodicSystem([[1.0]], damping=[[-0.1]]), 1.0, "damping of the family has the eigenvalue -0.1"),
        (PeriodicSystem([[1.0]], terms=[Term("damping", [[1.0]])]), 1.0, "family has a damping that depends on time"),
        (PeriodicSystem([[1.0]], terms=[Term("mass", [[0.1]])]), 1.0, "family has a mass that depends on time"),
        (FirstOrderSystem([[-1.0]]), 1.0, "family is of first order"),
        ("solid", 1.0, "family = 'solid' is no system"),
    ],
)
def test_refusals(family: Any, time: float, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        StandardLinearSolid(family, time).at(1.0)


def test_pulses_act_on_the_velocity() -> None:
    pulses = waveforms.impulses([0.25], [1.0])
    system = PeriodicSystem([[2.0]], damping=[[0.3]], terms=[Term("stiffness", [[4.0]], pulses)])
    (term,) = StandardLinearSolid(system, 1.0).at(1.0).terms
    np.testing.assert_array_equal(term.matrix, [[0.0, -2.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
    assert term.waveform is pulses
