"""`trace_boundary` where regions come near each other, merge, overlap, or resonate together."""

from __future__ import annotations

import math

import numpy as np
import pytest

from floquet import BoundaryTrace, Kind, monodromy, trace_boundary
from floquet.boundary import natural_modes
from periodic import PeriodicSystem
from plate import EdgeLoad, MovingPlate
from tests.floquet.oracle_systems import dop853
from tests.hunt.statements.magnus import Flows
from tests.hunt.statements.parts import parts_of
from tests.hunt.statements.systems import repeated

NONE = np.zeros((2, 2))
NEAR_EDGE = 1e-6


def close_pair(damping: float) -> PeriodicSystem:
    """2 omega_1 = 2, omega_1 + omega_2 = 2.2247 and 2 omega_2 = 2.4495, all strongly excited."""
    return PeriodicSystem(np.eye(2), NONE, damping * np.eye(2), np.diag([1.0, 1.5]), [[[1.0, 0.5], [0.5, 1.0]]])


def grows(system: PeriodicSystem, Omega: float, eps: float) -> bool:
    """Whether DOP853 finds growth; next to an edge the largest multiplier of an undamped system is off by 1e-6."""
    return bool(np.abs(np.linalg.eigvals(dop853(system, Omega, eps))).max() > 1 + 3e-6)


def check(system: PeriodicSystem, trace: BoundaryTrace, k: int = 0) -> None:
    """Hold both sides of every edge, and the inside, against DOP853."""
    eps = float(trace.eps[k])
    assert len(trace.intervals[k]) > 0
    for low, high in trace.intervals[k]:
        step = min(NEAR_EDGE * low, (high - low) / 10)
        for Omega in (low + step, *np.linspace(low, high, 7)[1:-1], high - step):
            assert grows(system, float(Omega), eps)
        assert not grows(system, low - NEAR_EDGE * low, eps)
        assert not grows(system, high + NEAR_EDGE * high, eps)


@pytest.mark.parametrize(
    ("near", "eps", "lower", "upper"),
    [
        # scans of the multipliers by DOP853 for stable gaps, to four digits
        (1 + math.sqrt(1.5), 0.35, 2.1788, 2.2870),
        (1 + math.sqrt(1.5), 0.4, 2.1833, 2.2880),
        (2.0, 0.4, 1.7802, 2.1760),
        (2 * math.sqrt(1.5), 0.4, 2.3007, 2.6247),
    ],
)
def test_a_narrow_stable_gap_is_an_edge(near: float, eps: float, lower: float, upper: float) -> None:
    system = close_pair(0.02)
    trace = trace_boundary(system, near, [eps])
    assert trace.lower[0] == pytest.approx(lower, abs=1e-4)
    assert trace.upper[0] == pytest.approx(upper, abs=1e-4)
    check(system, trace)


def test_merged_regions_have_the_edges_of_both_and_say_where_they_meet() -> None:
    system = close_pair(0.0)
    # at eps = 0.45 omega_1 + omega_2 has merged with 2 omega_1; at 0.5 with 2 omega_2, too
    nears = (2.0, 1 + math.sqrt(1.5), 2 * math.sqrt(1.5))
    first, second, third = (trace_boundary(system, near, [0.4, 0.45, 0.5]) for near in nears)
    assert first.upper[0] < second.lower[0] < second.upper[0] < third.lower[0]
    assert first.lower[1:] == pytest.approx(second.lower[1:], rel=1e-9)
    assert first.upper[1] == pytest.approx(second.upper[1], rel=1e-9)
    assert second.upper[1] < third.lower[1]
    assert first.upper[2] == pytest.approx(third.upper[2], rel=1e-9)
    assert 2.176 < first.upper_meeting[1] < 2.2247
    assert 2.176 < second.lower_meeting[1] < 2.2247
    assert np.isnan(first.upper_meeting[0])
    for trace in (first, second, third):
        for k in range(3):
            check(system, trace, k)


def test_an_edge_beyond_a_narrow_crossing_region_is_found() -> None:
    # (ω₁+ω₅)/2 = 12.83 crosses the upper edge of ω₁+ω₃ at eps = 0.2: a step too long from below loses the pair
    plate = MovingPlate(aspect_ratio=2.0, inplane="static", load=EdgeLoad.partial(0.5))
    trace = trace_boundary(plate, 12.4134, [0.18])
    assert monodromy(plate, trace.upper[0] - 1e-4, 0.18).kind == Kind.COMPLEX
    assert monodromy(plate, trace.upper[0] + 1e-4, 0.18).kind == Kind.STABLE


def test_square_plate_with_coincident_resonances() -> None:
    """omega_1 + omega_4 = 2 omega_2 = 2 omega_3, each coordinate an equation of Mathieu: the union of two regions."""
    omega = np.pi**2 * np.array([2.0, 5.0, 5.0, 8.0])
    load = 0.3 * 4 * np.pi**4 * np.diag([1.0, 1.0, 4.0, 4.0])
    for split in (0.0, 1e-4):
        K = np.diag((omega * [1, 1, 1 + split, 1]) ** 2)
        system = PeriodicSystem(np.eye(4), np.zeros((4, 4)), np.zeros((4, 4)), K, [-load])
        trace = trace_boundary(system, 98.696, [0.4])
        assert trace.lower[0] == pytest.approx(96.792 * (1 + split), abs=0.002)
        assert trace.upper[0] == pytest.approx(100.582 * (1 + split), abs=0.002)
        assert len(trace.resonances) >= 2
        chosen = trace_boundary(system, 98.696, [0.4], p=2, q=2)
        assert chosen.resonance[:2] == (2, 2)
        assert chosen.upper[0] == pytest.approx(trace.upper[0], rel=1e-8)


@pytest.mark.parametrize("split", [0.0, 1e-8, 1e-4])
@pytest.mark.parametrize("damping", [0.0, 0.02])
def test_repeated_frequencies(split: float, damping: float) -> None:
    """K = I and a load with eigenvalues 1.5 and 0.5 in turned axes: the wider of two equations of Mathieu."""
    turn = np.array([[math.cos(0.3), -math.sin(0.3)], [math.sin(0.3), math.cos(0.3)]])
    load = turn @ np.diag([1.5, 0.5]) @ turn.T
    system = PeriodicSystem(np.eye(2), NONE, damping * np.eye(2), np.diag([1.0, 1.0 + split]), [load])
    trace = trace_boundary(system, 2.0, [0.1])
    if damping == 0:
        assert trace.lower[0] == pytest.approx(1.92434, abs=1e-4)
        assert trace.upper[0] == pytest.approx(2.07427, abs=1e-4)
    check(system, trace)


def test_nearly_repeated_frequencies_are_apart_at_small_amplitudes() -> None:
    turn = np.array([[math.cos(0.3), -math.sin(0.3)], [math.sin(0.3), math.cos(0.3)]])
    load = turn @ np.diag([1.5, 0.5]) @ turn.T
    system = PeriodicSystem(np.eye(2), NONE, NONE, np.diag([1.0, 1.0 + 2e-4]), [load])
    trace = trace_boundary(system, 2.0, [1e-6])
    assert trace.upper[0] - trace.lower[0] == pytest.approx(1e-6 * load[0, 0], rel=1e-3)  # first order, one mode alone
    assert len(trace.resonances) == 1


def test_unsymmetric_load_on_repeated_frequencies() -> None:
    loads = np.random.default_rng(3).normal(size=(2, 2, 2))
    for split in (0.0, 1e-4):
        system = PeriodicSystem(np.eye(2), NONE, 0.01 * np.eye(2), np.diag([1.0, 1.0 + split]), loads)
        check(system, trace_boundary(system, 2.0, [0.1]))


def test_two_resonances_of_one_frequency() -> None:
    # omega_2 = 3 omega_1: Omega = 2 is 2 omega_1 and omega_2 - omega_1
    system = PeriodicSystem(np.eye(2), NONE, NONE, np.diag([1.0, 9.0]), [[[0.2, 2.0], [2.0, -3.0]]])
    trace = trace_boundary(system, 2.0, [0.01, 0.1])
    assert {one.label for one in trace.resonances} >= {"2ω₁", "ω₂−ω₁"}
    for k in range(2):
        check(system, trace, k)


def test_a_string_whose_frequencies_are_multiples_of_the_first() -> None:
    """Moving string, four sines: every sum and difference with the same p ± q coincides."""
    size, speed = 4, 0.3
    i = np.arange(1, size + 1)
    with np.errstate(divide="ignore", invalid="ignore"):
        B = np.where((i[:, None] + i) % 2 == 1, 4.0 * i[:, None] * i / (i[:, None] ** 2 - i**2), 0.0)
    S = np.diag((i * np.pi) ** 2)
    system = PeriodicSystem(np.eye(size), 2 * speed * B, np.zeros((size, size)), (1 - speed**2) * S, [S])
    check(system, trace_boundary(system, 2 * np.pi * (1 - speed**2), [0.1]))


def test_two_modes_that_nothing_tells_apart() -> None:
    """A ring of three equal oscillators: two of its modes are one and the same oscillator twice."""
    shift = np.roll(np.eye(3), 1, axis=0)
    ring = 2 * np.eye(3) - shift - shift.T  # 3 for both modes
    system = PeriodicSystem(
        np.eye(3), np.zeros((3, 3)), 0.02 * np.eye(3), 1.3 * np.eye(3) + 0.7 * ring, [0.9 * np.eye(3) + 0.4 * ring]
    )
    alone = PeriodicSystem([[1.0]], [[0.0]], [[0.02]], [[1.3 + 3 * 0.7]], [[[0.9 + 3 * 0.4]]])
    near, eps = 2 * math.sqrt(1.3 + 3 * 0.7), [0.1, 0.4, 0.7]
    twice = trace_boundary(system, near, eps, p=3, q=2)
    once = trace_boundary(alone, near, eps)
    assert twice.kind.tolist() == [Kind.MINUS_ONE] * 3
    assert twice.lower == pytest.approx(once.lower, rel=1e-8)
    assert twice.upper == pytest.approx(once.upper, rel=1e-8)


@pytest.mark.parametrize("seed", [1, 14, 23])
def test_equal_frequencies_that_only_two_interactions_mix(seed: int) -> None:
    """(omega_1 + omega_2) / 2 of two equal frequencies: the modes turn as eps grows, too fast to follow."""
    system = repeated(np.random.default_rng(seed))
    trace = trace_boundary(system, float(natural_modes(system, 1.0).exponents[0].imag), [0.2], j=2, p=2, q=1)
    inside = np.linspace(trace.lower[0], trace.upper[0], 21)[1:-1]
    assert trace.kind[0] in {monodromy(system, Omega, 0.2).kind for Omega in inside.tolist()} - {Kind.STABLE}
    assert {one.label for one in trace.resonances} == {"(ω₁+ω₂)/2", "2ω₁/2", "2ω₂/2"}
    check(system, trace)


@pytest.mark.parametrize("seed", [2, 3, 8])
def test_each_of_the_regions_of_equal_frequencies_is_found(seed: int) -> None:
    """2 omega_1/3 of two equal frequencies: the three regions that nothing but third-order interactions open."""
    system, eps = repeated(np.random.default_rng(seed)), 0.08
    near = float(2 * natural_modes(system, 1.0).exponents[0].imag / 3)
    trace = trace_boundary(system, near, [eps], j=3, p=1, q=1)
    assert len(trace.intervals[0]) == 3
    grid = np.linspace(trace.lower[0] - 2e-4 * near, trace.upper[0] + 2e-4 * near, 401)
    unstable = Flows(parts_of(system)).state(grid, eps) == 1
    inside = np.any([(low < grid) & (grid < high) for low, high in trace.intervals[0]], axis=0)
    assert (unstable == inside).mean() > 0.98  # all but the points nearest to the edges
    assert not (unstable & ~inside).any()
