"""Modes followed along lines, against eigenvalues whose order is known."""

from __future__ import annotations

import numpy as np
import pytest

from floquet.modes import floquet_modes, follow_modes
from periodic import PeriodicSystem
from periodic.examples import mathieu
from plate import EdgeLoad, MovingPlate


def free_frequencies(system: PeriodicSystem) -> np.ndarray:
    """Ascending, by numpy from the state matrix."""
    n = system.size
    inverse = np.linalg.inv(system.mass)
    A = np.block([[-inverse @ system.gyroscopic, -inverse @ system.stiffness], [np.eye(n), np.zeros((n, n))]])
    omega = np.linalg.eigvals(A).imag
    return np.sort(omega[omega > 0])


def test_no_mode_swaps_through_veerings_of_a_plate() -> None:
    """An uneven load couples all modes: frequencies veer and never cross, so each keeps its place in the order. There
    are three veerings at speeds 3.18, 4.09 and 4.70, 0.3 % to 0.6 % wide."""

    def plate(speed: float) -> MovingPlate:
        load = EdgeLoad.linear(0.8, 1.2)
        return MovingPlate(aspect_ratio=3.0, tension=100.0, speed=speed, load=load, axial_terms=5, lateral_terms=3)

    speeds = np.linspace(2.9, 5.0, 15)
    line = follow_modes(plate, speeds, Omega=90.0, eps=0.0, progress=False)
    expected = np.array([free_frequencies(plate(speed).at(90.0)) for speed in speeds])
    gaps = np.diff(expected, axis=1) / expected[:, 1:]
    inner = (gaps.argmin(axis=0) % 14 > 0) & (gaps.min(axis=0) < 0.01)
    assert inner.sum() >= 3
    upper = line.frequencies[:, line.frequencies[0] > 0]
    np.testing.assert_allclose(upper[:, np.argsort(upper[0])], expected, rtol=1e-11)
    assert not line.unclear.any()
    assert line.participation.shape == (15, 30, 25)
    np.testing.assert_allclose(
        line.participation.sum(axis=2), 1.0, atol=1e-12
    )  # all in one harmonic, without excitation


@pytest.mark.parametrize("coupling", [0.0, 1e-4])
def test_modes_cross_if_uncoupled_and_veer_if_coupled(coupling: float) -> None:
    def make(k: float) -> PeriodicSystem:
        return PeriodicSystem(np.eye(2), stiffness=[[k, coupling], [coupling, 4.0]])

    line = follow_modes(make, [3.0, 5.0], Omega=9.0, eps=0.0, progress=False)
    upper = np.sort(line.frequencies[:, line.frequencies[0] > 0], axis=1)
    start, end = (line.frequencies[k, line.frequencies[0] > 0] for k in (0, 1))
    straight = end[np.argsort(start)]
    np.testing.assert_allclose(straight, upper[1][::-1] if coupling == 0 else upper[1])
    assert not line.unclear.any()


def test_a_branch_goes_on_where_the_strongest_harmonic_changes() -> None:
    """lambda of one oscillator follows its frequency sqrt(k), past Omega / 2 and Omega."""
    k = np.linspace(1.0, 30.0, 12)
    line = follow_modes(lambda k: PeriodicSystem([[1.0]], damping=[[0.1]], stiffness=[[k]]), k, Omega=1.7, eps=0.3)
    i = int(line.frequencies[0].argmax())
    np.testing.assert_allclose(line.frequencies[:, i], np.sqrt(k - 0.0025), rtol=1e-10)
    np.testing.assert_allclose(line.growth_rates, -0.05, rtol=1e-9)
    np.testing.assert_allclose(line.damping_ratios[:, i], 0.05 / np.sqrt(k), rtol=1e-9)


def test_repeated_frequencies_cost_no_clarity() -> None:
    line = follow_modes(
        lambda k: PeriodicSystem(np.eye(2), damping=0.1 * np.eye(2), stiffness=k * np.eye(2)),
        [1.0, 1.5, 2.0],
        Omega=5.0,
        eps=0.0,
    )
    assert not line.unclear.any()


def test_the_point_may_move_along_the_line() -> None:
    line = follow_modes(lambda Omega: (mathieu(damping=0.1), Omega, 0.2), [1.5, 1.6, 1.7])
    np.testing.assert_array_equal(line.Omega, [1.5, 1.6, 1.7])
    for k, Omega in enumerate(line.Omega):
        expected = floquet_modes(mathieu(damping=0.1), Omega, 0.2).multipliers
        np.testing.assert_allclose(np.sort_complex(line.multipliers[k]), np.sort_complex(expected), rtol=1e-10)


def test_modes_that_meet_and_part_are_unclear() -> None:
    """Into a region of instability two modes meet on the unit circle and leave it: neither goes on as either."""
    line = follow_modes(lambda Omega: (mathieu(), Omega, 0.3), [1.7, 2.0])
    assert line.unclear[1].any()
    assert line.growth_rates[1].max() > 0.05


def test_values_have_to_increase() -> None:
    with pytest.raises(ValueError, match="values is not strictly increasing"):
        follow_modes(lambda k: mathieu(), [2.0, 1.0], Omega=1.0, eps=0.0)
