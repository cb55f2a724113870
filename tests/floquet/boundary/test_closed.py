"""`trace_boundary` where there is no region, or where only a window of stability is one."""

from __future__ import annotations

import numpy as np
import pytest

from floquet import Kind, monodromy, trace_boundary
from floquet.boundary import natural_modes
from floquet.boundary.solutions import Integrator, OutOfReachError
from periodic import PeriodicSystem
from periodic.examples import mathieu
from plate import MovingPlate
from tests.floquet.oracle_systems import dop853

NONE = np.zeros((2, 2))


def test_no_excitation() -> None:
    system = PeriodicSystem(np.eye(2), NONE, NONE, np.diag([1.0, 2.0]), [NONE])
    trace = trace_boundary(system, 2 * np.sqrt(2), [0.1, 1.0])
    assert (trace.kind == Kind.STABLE).all()
    assert [len(one) for one in trace.intervals] == [0, 0]


@pytest.mark.parametrize("tension", [0.0, 1e-10])
def test_no_tension_to_pulsate(tension: float) -> None:
    plate = MovingPlate(tension=tension, speed=3.0, axial_terms=3, lateral_terms=4)
    omega = natural_modes(plate.at(10.0), 10.0).exponents.imag[:3]
    for near in (2 * omega[0], 2 * omega[1], omega[0] + omega[2]):
        assert trace_boundary(plate, float(near), [0.1]).kind[0] == Kind.STABLE


@pytest.mark.parametrize("j", [6, 7, 8])
def test_narrower_than_can_be_resolved(j: int) -> None:
    trace = trace_boundary(mathieu(), 2 / j, [0.02], j=j)
    assert trace.kind[0] == Kind.STABLE
    assert np.isnan(trace.lower[0])


def test_modes_that_symmetry_keeps_apart() -> None:
    system = PeriodicSystem(np.eye(2), NONE, NONE, np.diag([1.0, 2.0]), [np.diag([1.0, 1.0])])
    trace = trace_boundary(system, 1 + np.sqrt(2), [0.1])
    assert not trace.coupled
    assert trace.kind[0] == Kind.STABLE
    assert not trace.covered[0]
    # each by itself is unstable at that place
    wide = PeriodicSystem(np.eye(2), NONE, NONE, np.diag([1.0, 1.02]), [np.diag([1.0, 1.0])])
    trace = trace_boundary(wide, 1 + np.sqrt(1.02), [0.3], p=1, q=2)
    assert trace.kind[0] == Kind.STABLE
    assert trace.covered[0]


def test_growth_rate_says_how_much_damping_is_left() -> None:
    c = 0.02  # the tip is at eps = 2 c to first order
    trace = trace_boundary(mathieu(1.0, c), 2.0, [0.5 * c, c, 1.5 * c, 3 * c])
    assert trace.growth_rate == pytest.approx(trace.eps / 4 - c / 2, abs=2e-3 * c)
    assert trace.is_open.tolist() == [False, False, False, True]


def test_where_nothing_is_stable_no_window_is_found_far_away() -> None:
    # a period short enough makes any growth in it small, but not the rate
    damping, excitation = np.diag([-0.0585, 0.0791]), [[-1.07, -0.777], [-0.777, 0.499]]
    system = PeriodicSystem(np.eye(2), NONE, damping, np.diag([1.0055, 2.2485]), [excitation])
    trace = trace_boundary(system, 0.6683, [0.2346], j=3, p=1, q=1)
    assert trace.kind[0] == monodromy(system, trace.resonance.centre, 0.2346).kind > Kind.STABLE
    assert len(trace.intervals[0]) == 0


def test_window_of_stability() -> None:
    """Negative damping of one mode, which the excitation lets the other make up for (A. Tondl's anti-resonance)."""
    mass, damping = np.diag([1.0, 0.5]), np.array([[0.0, -0.06], [-0.06, 0.06]])
    stiffness, excitation = np.array([[1.6, -0.6], [-0.6, 0.6]]), np.diag([1.0, 0.0])
    system = PeriodicSystem(mass, NONE, damping, stiffness, [excitation])
    trace = trace_boundary(system, 0.7752, [0.1, 0.3], type="difference")
    assert trace.window == "stable"
    assert trace.is_open.tolist() == [False, True]
    assert trace.kind.tolist() == [Kind.COMPLEX, Kind.STABLE]
    for edge, side in ((trace.lower[1], 1), (trace.upper[1], -1)):
        for step, stable in ((1e-6, True), (-1e-6, False)):
            largest = np.abs(np.linalg.eigvals(dop853(system, float(edge + side * step * edge), 0.3))).max()
            assert (largest < 1) == stable


def test_nothing_can_be_integrated_without_a_frequency() -> None:
    solution = natural_modes(mathieu(), 2.0).vectors[:, 0]
    with pytest.raises(OutOfReachError):
        Integrator(mathieu(), solution, 0.3).at(0.0, 0.1)
    # beyond all bounds is no error, either
    with pytest.raises(OutOfReachError):
        Integrator(mathieu(), solution, 0.3).at(1e-3, 5.0)


def test_closed_at_a_place_where_others_grow() -> None:
    """Damping closes 2 omega_2, while what 2 omega_1 and omega_1 + omega_2 open reaches beyond its centre."""
    stiffness, damping = np.diag([1.147, 1.2237]), np.diag([0.0104, 0.005])
    system = PeriodicSystem(np.eye(2), NONE, damping, stiffness, [[[1.2, 0.9], [0.9, 0.1]]])
    for eps in (0.05, 0.06, 0.07, 0.08):
        trace = trace_boundary(system, 2 * np.sqrt(1.2237), [eps], p=2, q=2)
        largest = np.abs(np.linalg.eigvals(dop853(system, float(trace.resonance.centre), eps))).max()
        assert trace.covered[0] or trace.is_open[0] or largest < 1


def test_where_two_modes_cannot_be_told_apart_windows_are_looked_for_all_the_same() -> None:
    system = PeriodicSystem(
        np.eye(2), NONE, np.diag([-0.04, 0.06]), np.diag([0.893, 1.6]), [[[0.9, -1.1], [-1.1, 0.5]]]
    )
    for eps in (0.15, 0.3, 0.6):
        trace = trace_boundary(system, 2 * np.sqrt(0.893) / 3, [eps], j=3, p=1, q=1)
        growth = np.log(np.abs(np.linalg.eigvals(dop853(system, float(trace.resonance.centre), eps))).max())
        inside = any(low <= trace.resonance.centre <= high for low, high in trace.intervals[0])
        assert trace.kind[0] != Kind.UNDECIDED
        assert inside == (growth < 0)
