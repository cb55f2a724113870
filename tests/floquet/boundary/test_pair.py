"""The test function of a pair of multipliers."""

from __future__ import annotations

import cmath

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from floquet.boundary.pair import instability

logs = st.complex_numbers(max_magnitude=1.0, allow_nan=False, allow_infinity=False)


@settings(max_examples=200, deadline=None)
@given(logs, logs)
def test_sign_is_that_of_the_larger_growth(a: complex, b: complex) -> None:
    growth = max(a.real, b.real)
    assume(abs(growth) > 1e-6)
    assume(abs(a.real + b.real) > 1e-6)  # f is divided by it: the sum of two logarithms must not be rounding
    mu = np.exp(np.array([a, b]))
    value, _ = instability(mu, None, False, 0.0)
    assert (value > 0) == (growth > 0)
    swapped, _ = instability(mu[::-1], None, False, 0.0)
    assert swapped == pytest.approx(value, rel=1e-6, abs=1e-9)


@settings(max_examples=200, deadline=None)
@given(logs, logs, st.floats(-1, 1), st.floats(-1, 1))
def test_error_bounds_the_change(a: complex, b: complex, first: float, second: float) -> None:
    # decay well above the error of the logarithms
    a, b = complex(a.real - 1.5, a.imag), complex(b.real - 1.5, b.imag)
    shift = 1e-7
    moved = np.exp(np.array([a + first * shift / 2, b + second * shift / 2 * 1j]))
    value, error = instability(np.exp(np.array([a, b])), None, False, shift)
    there, _ = instability(moved, None, False, 0.0)
    assert abs(there - value) <= 1.01 * error + 1e-12


def test_reciprocal_pairs() -> None:
    # growth squared inside, minus the square of half the angle outside
    inside = np.array([-np.exp(0.1), -np.exp(-0.1)])
    assert instability(inside, -1.0, True, 0.0)[0] == pytest.approx(0.01)
    outside = -np.exp(np.array([0.2j, -0.2j]))
    assert instability(outside, -1.0, True, 0.0)[0] == pytest.approx(-0.04)
    combination = np.exp(np.array([0.1 + 2.0j, -0.1 + 2.0j]))
    assert instability(combination, None, True, 0.0)[0] == pytest.approx(0.01)
    assert instability(outside, -1.0, True, 1e-6)[1] == pytest.approx(0.2e-6)


def test_analytic_where_the_two_meet() -> None:
    # mu = exp(-0.1 ± sqrt(x)): f = x - 0.01 through x = 0, where each multiplier has a root
    for x in (-1e-3, -1e-9, 0.0, 1e-9, 1e-3):
        mu = -np.exp(-0.1 + np.array([1, -1]) * cmath.sqrt(x))
        assert instability(mu, -1.0, False, 0.0)[0] == pytest.approx(x - 0.01, abs=1e-15)


@pytest.mark.parametrize(("lock", "reciprocal"), [(1.0, True), (-1.0, True), (-1.0, False)])
def test_a_pair_of_one_mode_at_the_opposite_point_is_outside(lock: float, reciprocal: bool) -> None:
    decay = 0.0 if reciprocal else 0.01
    values = [
        instability(-lock * np.exp(np.array([x - decay, -x - decay]).astype(complex)), lock, reciprocal, 0.0)[0]
        for x in (0.0, 0.1, 1.0, 10.0)
    ]
    beside = instability(-lock * np.exp(np.array([1e-4j - decay, -1e-4j - decay])), lock, reciprocal, 0.0)[0]
    assert values[0] == pytest.approx(beside, abs=1e-3)
    assert (np.diff(values) > 0).all()
    assert values[-1] < 0
