"""Charts of systems at the edges: no or negative stiffness, many coordinates and harmonics, growth beyond floats."""

from __future__ import annotations

import numpy as np
import pytest

from floquet import Kind
from periodic import PeriodicSystem
from periodic.examples import mathieu
from tests.floquet.chart.chart_oracles import agrees, chart
from tests.floquet.oracle_systems import random_system


def test_negative_stiffness() -> None:
    # a saddle that the excitation holds (Paul trap): no energy coordinates in the strict sense
    system = mathieu(-0.05)
    found = chart(system, [1.5, 2.0], [0.0, 0.4, 1.0])
    assert found.kind[:, 1].tolist() == [Kind.PLUS_ONE, Kind.PLUS_ONE, Kind.STABLE]
    assert agrees(system, found)


def test_no_stiffness() -> None:
    system = mathieu(0.0)
    assert agrees(system, chart(system, [0.8, 3.0], [0.0, 0.5, 3.0]))


@pytest.mark.parametrize("seed", range(3))
def test_unsymmetric_stiffness(seed: int) -> None:
    system = random_system(seed, 3, 2, symmetric=False, damping=0.1 * seed)
    assert agrees(system, chart(system, [0.7, 2.0], np.linspace(0, 1, 9)))


def test_strong_damping() -> None:
    system = PeriodicSystem(
        np.eye(2), np.zeros((2, 2)), [[1e3, 10], [10, 2.0]], np.diag([1e3, 2.0]), [[[0, 1], [1, 0]]]
    )
    assert agrees(system, chart(system, [0.5, 3.0], [0.0, 1.0]))


def test_sixteen_harmonics() -> None:
    system = random_system(31, 2, 16, damping=0.05)
    assert agrees(system, chart(system, [0.8, 2.5], np.linspace(0, 0.5, 10)))


def test_a_hundred_coordinates() -> None:
    system = random_system(32, 100, 1, damping=0.05)
    found = chart(system, [4.0], [0.0, 0.1])
    assert agrees(system, found)


def test_large_amplitudes() -> None:
    system = random_system(33, 3, 2)
    found = chart(system, [0.7, 2.0], np.linspace(0, 10, 9))
    assert (found.growth_rate * 2 * np.pi / found.Omega).max() > 20
    assert agrees(system, found)


def test_growth_beyond_the_largest_float() -> None:
    found = chart(mathieu(-1.0), [1e-2], [0.0])
    # exactly: the multiplier exp(2 pi / Omega) of a saddle, 10^272, and 10^2728 ten times slower
    assert found.growth_rate[0, 0] == pytest.approx(1.0, rel=1e-12)
    assert np.isfinite(found.multiplier[0, 0])
    slower = chart(mathieu(-1.0), [1e-3], [0.0])
    assert slower.growth_rate[0, 0] == pytest.approx(1.0, rel=1e-12)
    assert slower.multiplier[0, 0] == np.inf
    assert slower.kind[0, 0] == Kind.PLUS_ONE


def test_decay_below_the_smallest_float() -> None:
    found = chart(mathieu(1.0, 4.0), [1e-3], [0.0])
    # overdamped: the slower root of s^2 + 4 s + 1
    assert found.growth_rate[0, 0] == pytest.approx(-2 + np.sqrt(3), rel=1e-9)
    assert found.kind[0, 0] == Kind.STABLE


def test_low_frequency() -> None:
    # slow modulation of a stable oscillator: nothing happens, and 2^17 steps must not say otherwise
    found = chart(mathieu(1.0), [1e-3, 1.1e-3], [0.3])
    assert (found.growth_rate == 0).all()
    assert (found.kind != Kind.PLUS_ONE).all()
