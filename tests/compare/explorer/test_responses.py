"""The solution shown for one point, against the Floquet theorem and another way of integrating."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from compare.explorer.responses import SAMPLES_PER_PERIOD, clickable_points, clickable_responses, response
from floquet import Kind, monodromy, stability_chart
from periodic import PeriodicSystem
from periodic.examples import coupled_mathieu, gyroscopic_rotor, mathieu, meissner

SLANTED = PeriodicSystem([[1.0]], [[0.0]], [[0.02]], [[1.0]], [[[0.8]], [[0.3]]], [[[0.5]], [[-0.4]]])
SYSTEMS = {
    "cosines and sines": (SLANTED, 2.0, 0.6),
    "mathieu": (mathieu(1.0, 0.02), 2.0, 0.6),
    "coupled": (coupled_mathieu(damping=(0.02, 0.05)), 2.7, 0.8),
    "rotor": (gyroscopic_rotor(damping=0.01), 4.0, 0.9),
    "meissner": (meissner(), 2.0, 0.5),
}


def _real_motion(system: PeriodicSystem, Omega: float, eps: float, start: np.ndarray, periods: int) -> np.ndarray:
    """Integrate M W'' + (G + C) W' + K(t) W = 0 by another method; W as sampled in a Response, shape (n, samples)."""
    n = system.size

    def motion(t: float, q: np.ndarray) -> np.ndarray:
        K = system.stiffness.copy()
        for j in range(1, system.harmonics + 1):
            K += eps * (np.cos(j * Omega * t) * system.cosine[j - 1] + np.sin(j * Omega * t) * system.sine[j - 1])
        force = (system.gyroscopic + system.damping) @ q[:n] + K @ q[n:]
        return np.concatenate([-np.linalg.solve(system.mass, force), q[:n]])

    T = 2 * np.pi / Omega
    times = np.arange(periods * SAMPLES_PER_PERIOD) * T / SAMPLES_PER_PERIOD
    return solve_ivp(motion, (0, periods * T), start, "LSODA", times, rtol=1e-10, atol=1e-12).y[n:]


@pytest.mark.parametrize("name", SYSTEMS)
def test_the_wave_times_mu_is_a_solution(name: str) -> None:
    system, Omega, eps = SYSTEMS[name]
    found = response(system, Omega, eps)
    periods = 4
    wave = np.real(found.wave * found.mu ** np.arange(periods)[:, None]).ravel()

    # Every solution is a combination of the 2n that start from the unit vectors; the wave must be one of them.
    n = system.size
    basis = np.array([_real_motion(system, Omega, eps, e, periods)[found.coordinate] for e in np.eye(2 * n)])
    _, residual, *_ = np.linalg.lstsq(basis.T, wave, rcond=None)
    # DOP853 at relative tolerance 1e-6 leaves less than 1e-4 after four periods of growth
    assert np.sqrt(residual[0] / np.sum(wave**2)) < 1e-4
    assert np.abs(found.wave).max() == pytest.approx(1.0, rel=1e-12)


@pytest.mark.parametrize("name", SYSTEMS)
def test_it_agrees_with_the_monodromy_matrix(name: str) -> None:
    system, Omega, eps = SYSTEMS[name]
    found, expected = response(system, Omega, eps), monodromy(system, Omega, eps)
    np.testing.assert_array_equal(found.multipliers, expected.multipliers)
    assert found.kind == expected.kind > Kind.STABLE
    assert abs(found.mu) == pytest.approx(abs(expected.multipliers[0]), rel=1e-9)


def test_of_a_stable_elastic_system_the_slowest_motion_is_shown() -> None:
    system = coupled_mathieu(frequencies=(1.0, 7.3))
    found = response(system, 5.0, 0.05)
    # eps = 0.05 moves the frequency 1 by less than 1 %
    assert abs(found.mu) == pytest.approx(1.0, abs=1e-9)
    assert found.coordinate == 0
    turned = np.angle(found.mu) % (2 * np.pi)
    assert min(turned, 2 * np.pi - turned) == pytest.approx(2 * np.pi / 5.0, rel=0.01)


def test_no_region_of_a_chart_is_missed() -> None:
    growth = np.zeros((40, 60))
    growth[33, 17] = 0.1  # one cell that a grid of 8 x 4 points would pass by
    rows, columns = clickable_points(growth, 8, 4)
    assert len(rows) == 32
    assert (33, 17) in set(zip(rows.tolist(), columns.tolist(), strict=True))
    # a block that is all the same is represented by its middle
    assert (4, 3) in set(zip(rows.tolist(), columns.tolist(), strict=True))


def test_a_chart_smaller_than_the_blocks() -> None:
    rows, columns = clickable_points(np.zeros((3, 2)), 32, 16)
    assert sorted(zip(rows.tolist(), columns.tolist(), strict=True)) == [(i, j) for i in range(3) for j in range(2)]


def test_points_that_cannot_be_integrated_are_left_out() -> None:
    chart = stability_chart(mathieu(), [0.5, 0.6], [0.0, 1e4], n_jobs=1, progress=False, audit=0)
    found = clickable_responses(mathieu(), chart, n_jobs=1)
    # at eps = 1e4 the solution grows by exp(700) in a period
    assert {point.eps for point in found} == {0.0}
