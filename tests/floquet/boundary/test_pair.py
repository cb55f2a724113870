"""The test function of a pair of multipliers, and what the search does when it jumps."""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from floquet import Kind, monodromy, trace_boundary
from floquet.boundary import natural_modes, nearest_resonance
from floquet.boundary.boundary import _Route
from floquet.boundary.pair import LostError, Point, instability
from periodic import PeriodicSystem
from periodic.checks import ComplexArray
from periodic.examples import mathieu
from plate import EdgeLoad, MovingPlate


def _route(system: PeriodicSystem, near: float) -> _Route:
    modes = natural_modes(system, near)
    return _Route(system, nearest_resonance(modes, near), modes)


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


class Steps:
    """Stands in for a pair whose test function is ``f``."""

    def __init__(self, f: Callable[[float], float]) -> None:
        self.f = f

    def at(self, Omega: float, eps: float, reference: ComplexArray) -> Point:
        return point(Omega, self.f)


def point(Omega: float, f: Callable[[float], float]) -> Point:
    return Point(Omega, f(Omega), np.nan, np.ones(2, complex), np.ones((2, 2), complex))


def test_jumps_are_not_edges(monkeypatch: pytest.MonkeyPatch) -> None:
    route = _route(mathieu(), 2.0)
    for f, zero in (
        (lambda x: 2.1 - x, 2.1),
        (lambda x: (2.1 - x) * 1e-12, 2.1),
        (lambda x: 1.0 if x < 2.1 else -1e-6, None),
        (lambda x: 2.2 - x if x < 2.1 else -1.0, None),
        (lambda x: 2.1001 - x if x < 2.1 else -1.0, None),
    ):
        monkeypatch.setattr(route, "pair", Steps(f))
        inside, outside = point(2.0, f), point(2.3, f)
        if zero is None:
            with pytest.raises(LostError):
                route._zero(0.1, inside, outside)
        else:
            assert route._zero(0.1, inside, outside) == pytest.approx(zero, rel=1e-9)


def test_a_region_that_has_merged_says_so() -> None:
    zero = np.zeros((2, 2))
    pair = PeriodicSystem(np.eye(2), zero, zero, np.diag([1.0, 1.5]), cosine=[[[1.0, 0.5], [0.5, 1.0]]])
    trace = trace_boundary(pair, 2.0, [0.4, 0.5])
    assert np.isfinite(trace.upper).tolist() == [True, False]
    assert np.isfinite(trace.upper_meeting).tolist() == [False, True]
    assert np.isnan(trace.lower_meeting).all()
    assert 2.2 < trace.upper_meeting[1] < 2.5  # between the resonances 2 omega_1 and 2 omega_2
    # apart, there is a stable gap up to the next region; merged, there is none
    following = trace_boundary(pair, math.sqrt(1.0) + math.sqrt(1.5), [0.4])
    assert monodromy(pair, (trace.upper[0] + following.lower[0]) / 2, 0.4).kind == Kind.STABLE
    for Omega in np.linspace(trace.lower[1] + 1e-3, 2.6, 40):
        assert monodromy(pair, float(Omega), 0.5).kind > Kind.STABLE


def test_an_edge_beyond_a_narrow_crossing_region_is_found() -> None:
    # (ω₁+ω₅)/2 = 12.83 crosses the upper edge of ω₁+ω₃ at eps = 0.2: a step too long from below loses the pair
    plate = MovingPlate(aspect_ratio=2.0, inplane="static", load=EdgeLoad.partial(0.5))
    trace = trace_boundary(plate, 12.4134, [0.18])
    assert monodromy(plate, trace.upper[0] - 1e-4, 0.18).kind == Kind.COMPLEX
    assert monodromy(plate, trace.upper[0] + 1e-4, 0.18).kind == Kind.STABLE


def test_there_is_no_pair_at_no_frequency() -> None:
    pair = PeriodicSystem(
        np.eye(2), np.zeros((2, 2)), np.zeros((2, 2)), np.diag([1.0, 4.0]), [[[1.0, 0.5], [0.5, 1.0]]]
    )
    route = _route(pair, 4.0)
    with pytest.raises(LostError):
        route.pair.at(0.0, 1.0, route.pair.solutions)
    # followed so far that the way leads below Omega = 0, the region is lost
    assert trace_boundary(pair, 4.0, 5.0).kind[0] == Kind.UNDECIDED


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
