"""Shear and rotary inertia against closed formulas and against collocation of the differential equations."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import scipy.linalg as sla

from beam import MovingBeam
from floquet import monodromy
from periodic import without_massless
from periodic.checks import FloatArray
from tests.beam.beam_oracles import fundamental

THICK = MovingBeam(0.7, 0.64, terms=6, shear_rigidity=20.0, rotary_inertia=0.01)


def frequencies(beam: MovingBeam) -> FloatArray:
    """Return the frequencies without excitation, from the whole matrices."""
    system = beam.at(1.0)
    n = system.size
    A = np.block([[-(system.gyroscopic + system.damping), -system.stiffness], [np.eye(n), np.zeros((n, n))]])
    values = np.asarray(sla.eigvals(A, sla.block_diag(system.mass, np.eye(n))), complex)
    return np.sort(values.imag[values.imag > 0])


def collocated(beam: MovingBeam, count: int = 40) -> FloatArray:
    """Return the frequencies of w, psi by Chebyshev collocation, in first-order form with w_t and psi_t.

    At the supports w = 0 and vf^2 psi_x = r^2 v (psi_t + v psi_x).
    """
    j = np.arange(count + 1)
    x = np.cos(np.pi * j / count)
    c = np.where((j == 0) | (j == count), 2.0, 1.0) * (-1.0) ** j
    D = np.outer(c, 1 / c) / (np.subtract.outer(x, x) + np.eye(count + 1))
    D = 2 * (D - np.diag(D.sum(axis=1)))  # on 0 <= x <= 1
    one, zero = np.eye(count + 1), np.zeros((count + 1, count + 1))
    assert beam.shear_rigidity is not None
    v, s, e, r = beam.speed, beam.shear_rigidity, beam.flexural_rigidity, beam.rotary_inertia
    place = np.block([[(v**2 - 1 - s) * D @ D, s * D], [-s * D, (r * v**2 - e) * D @ D + s * one]])
    speed = sla.block_diag(2 * v * D, 2 * r * v * D)
    mass = sla.block_diag(one, r * one)
    N = 2 * (count + 1)
    A = np.block([[np.zeros((N, N)), np.eye(N)], [-place, -speed]])
    E = sla.block_diag(np.eye(N), mass)
    for end in (0, count):
        w, psi = N + end, N + count + 1 + end
        A[w], E[w], E[psi] = 0.0, 0.0, 0.0
        A[w, end] = 1.0
        A[psi] = np.concatenate([zero[0], (e - r * v**2) * D[end], zero[0], -r * v * one[end]])
    values = np.asarray(sla.eigvals(A, E), complex)
    kept = values[np.isfinite(values) & (values.imag > 0) & (abs(values.imag) < 1e4)]
    return np.sort(kept.imag)


def test_frequencies_at_rest() -> None:
    # each sine alone: two waves, of bending and of shear; and the angle that is the same everywhere
    beam = replace(THICK, speed=0.0)
    found = [np.sqrt(20.0 / 0.01)]
    for k in np.arange(1, 7) * np.pi:
        stiffness = np.array([[k**2 * 21.0, -20.0 * k], [-20.0 * k, 20.0 + 0.64 * k**2]])
        found += np.sqrt(sla.eigvalsh(stiffness, np.diag([1.0, 0.01]))).tolist()
    np.testing.assert_allclose(frequencies(beam), np.sort(found), rtol=1e-12)


@pytest.mark.parametrize(("speed", "inertia"), [(0.7, 0.01), (1.8, 0.01), (1.0, 0.05)])
def test_frequencies_of_a_moving_beam(speed: float, inertia: float) -> None:
    beam = replace(THICK, speed=speed, rotary_inertia=inertia)
    exact = collocated(beam)[:2]
    errors = [np.abs(frequencies(replace(beam, terms=terms))[:2] / exact - 1).max() for terms in (12, 24)]
    assert errors[1] < 1e-3
    assert errors[1] < 0.6 * errors[0]  # cosines meet the condition at the supports in the mean: first order


def test_limits() -> None:
    slender = replace(THICK, shear_rigidity=None, rotary_inertia=0.0)
    for rigid, inertia in ((1e9, 0.0), (None, 1e-12), (1e9, 1e-12)):
        beam = replace(THICK, shear_rigidity=rigid, rotary_inertia=inertia)
        np.testing.assert_allclose(frequencies(beam)[:6], frequencies(slender), rtol=1e-6)
    light = replace(THICK, rotary_inertia=1e-9, speed=1.2)
    shearing = replace(light, rotary_inertia=0.0)
    np.testing.assert_allclose(frequencies(light)[:6], frequencies(shearing), rtol=1e-6)


def test_angle_without_inertia_is_in_equilibrium() -> None:
    # an angle without mass that `periodic` condenses: at rest, where nothing but elasticity acts on it
    bare = replace(THICK, speed=0.0, terms=4, speed_amplitude=0.0, tension_amplitude=0.5, rotary_inertia=0.0)
    full = replace(bare, rotary_inertia=1.0).at(15.0)
    condensed = without_massless(np.diag(np.repeat([1.0, 0.0], [4, 5])), None, None, full.stiffness, full.cosine).system
    found, expected = (monodromy(system, 15.0, 0.9) for system in (condensed, bare))
    assert expected.growth_rate > 0.1
    assert found.growth_rate == pytest.approx(expected.growth_rate, abs=1e-11)


def test_undamped_thick_beam_is_hamiltonian() -> None:
    # for p = M W' + v B W with the speed at t = 0, v0 (1 + eps a): the matrix of W' without mass is 2 v B
    beam = replace(THICK, terms=3, speed_amplitude=1.2, tension_amplitude=0.3, tension_held_at=0.5)
    system, Omega, eps = beam.at(7.0), 7.0, 0.3
    Phi = fundamental(system, Omega, eps, 2 * np.pi / Omega)
    M, G, _, _ = (matrix[0] for matrix in system.matrices(np.zeros(1), eps))
    form = np.block([[np.zeros_like(M), -M], [M, G]])
    assert np.abs(Phi.T @ form @ Phi - form).max() < 1e-9 * np.abs(Phi).max() ** 2
    assert monodromy(beam, Omega, eps).error < 1e-9


@pytest.mark.parametrize("shear", [None, 20.0])
@pytest.mark.parametrize("inertia", [0.0, 0.01, 0.3])
def test_divergence_speed(shear: float | None, inertia: float) -> None:
    beam = replace(THICK, shear_rigidity=shear, rotary_inertia=inertia, speed=0.0)
    speed = beam.critical_speed()
    lowest = [np.linalg.eigvalsh(replace(beam, speed=part * speed).at(1.0).stiffness)[0] for part in (0.0, 1 - 1e-10)]
    assert 0 < lowest[1] < 1e-8 * lowest[0]
    with pytest.raises(ValueError, match="divergence speed"):
        replace(beam, speed=speed)


def test_sections_with_more_inertia_than_stiffness() -> None:
    # the shortest waves diverge first, at the speed of waves of bending
    beam = replace(THICK, rotary_inertia=2.0, speed=0.0)
    assert beam.critical_speed() == pytest.approx(np.sqrt(0.64 / 2.0), rel=1e-14)


def test_strain_that_is_carried_along_is_that_of_the_particle() -> None:
    # the material rate of strain of bending and shear, by its definition: at a common factor exp(v t) shifted along x
    beam = replace(THICK, damping=1e-3, derivative="material")
    added = beam.at(1.0).stiffness - replace(beam, derivative="partial").at(1.0).stiffness
    n, nodes, weights = 6, *np.polynomial.legendre.leggauss(60)
    x, weights = (nodes + 1) / 2, weights / 2
    k = np.arange(1, n + 1) * np.pi
    sines, cosines = (np.sqrt(2) * f(np.outer(x, k)) for f in (np.sin, np.cos))
    none = np.zeros((len(x), n))
    constant = np.ones((len(x), 1))
    shear = np.hstack([k * cosines, -constant, -cosines])
    shear_x = np.hstack([-(k**2) * sines, 0 * constant, k * sines])
    bend = np.hstack([none, 0 * constant, -k * sines])
    bend_x = np.hstack([none, 0 * constant, -(k**2) * cosines])
    expected = 0.64 * bend.T @ (weights[:, None] * bend_x) + 20.0 * shear.T @ (weights[:, None] * shear_x)
    np.testing.assert_allclose(added, 1e-3 * 0.7 * expected, atol=1e-13 * np.abs(expected).max())


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"shear_rigidity": 0.0}, "shear_rigidity"),
        ({"shear_rigidity": -1.0}, "shear_rigidity"),
        ({"rotary_inertia": -1e-3}, "rotary_inertia"),
        ({"flexural_rigidity": 0.0, "shear_rigidity": 20.0, "speed": 0.5}, "shear_rigidity.*string"),
        ({"flexural_rigidity": 0.0, "shear_rigidity": None, "speed": 0.5}, "rotary_inertia.*string"),
    ],
)
def test_refusals(arguments: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        replace(THICK, **arguments)
