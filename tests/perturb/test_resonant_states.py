"""Second order where further states are near resonance: they join the pair, and nothing is divided by little."""

from __future__ import annotations

import numpy as np
import pytest

from periodic import PeriodicSystem
from perturb import gyroscopic_modes
from perturb.effective_matrix import MAX_RESONANT_STATES, NEAR_RESONANCE
from perturb.expansion import modal_equations
from tests.perturb.perturb_oracles import (
    congruent,
    fitted_order,
    hill_edges,
    hill_growth,
    random_system,
)
from tests.perturb.second_order_oracles import curves, gaps, matrix_of


@pytest.mark.parametrize(
    ("detuning", "states"), [(0.0, 4), (1e-9, 4), (1e-5, 4), (1e-3, 4), (0.02, 4), (0.06, 4), (0.15, 2)]
)
def test_a_third_state_in_resonance_does_no_harm(detuning: float, states: int) -> None:
    """omega_2 = 3 omega_1 (1 + detuning): at Omega = 2 omega_1 also omega_2 - omega_1 is in resonance. The error keeps
    its size through exact resonance, where the plain second-order sum would divide by zero."""
    zero = np.zeros((2, 2))
    K = np.diag([1.0, 9.0 * (1 + detuning) ** 2])
    system = PeriodicSystem(np.eye(2), zero, zero, K, [[[1.0, 0.8], [0.8, 1.0]]])
    found = curves(system)["2ω₁"]
    assert len(matrix_of(found).states) == states
    eps = 0.08
    assert gaps(system, "2ω₁", np.array([eps]), cut=8)[0] < 0.1 * eps**3
    Omega = np.linspace(1.93, 2.07, 15)
    exact = [hill_growth(system, value, eps) for value in Omega]
    # Growth rates rise like the square root of the distance from an edge: of the order of eps^3 but next to one.
    np.testing.assert_allclose(found.growth_rate(Omega, eps), exact, atol=0.2 * eps**3)


def test_a_state_that_is_hardly_coupled_does_not_join() -> None:
    """Unless it is as much nearer: few states stay few, and the error does too."""
    zero, eps = np.zeros((2, 2)), 0.08
    for detuning, states in ((0.04, 2), (1e-4, 4)):
        K = np.diag([1.0, 9.0 * (1 + detuning) ** 2])
        system = PeriodicSystem(np.eye(2), zero, zero, K, [[[1.0, 0.02], [0.02, 1.0]]])
        assert len(matrix_of(curves(system)["2ω₁"]).states) == states
        assert gaps(system, "2ω₁", np.array([eps]), cut=8)[0] < 0.1 * eps**3


def test_gap_of_four_states_is_of_third_order() -> None:
    zero, eps = np.zeros((2, 2)), np.array([0.04, 0.02, 0.01])
    for detuning in (0.0, 0.02):
        K = np.diag([1.0, 9.0 * (1 + detuning) ** 2])
        system = PeriodicSystem(np.eye(2), zero, zero, K, [[[1.0, 0.8], [0.8, 1.0]]])
        assert 2.85 < fitted_order(eps, gaps(system, "2ω₁", eps, cut=7)) < 3.15


def test_states_of_a_wide_set_are_not_counted_twice() -> None:
    """Of the frequencies 1, 3.2, 1.45 the third joins through the second; it is further than `NEAR_RESONANCE` away."""
    zero, eps = np.zeros((3, 3)), np.array([0.04, 0.02, 0.01])
    F = np.ones((3, 3)) - 0.5 * np.eye(3)
    system = PeriodicSystem(np.eye(3), zero, zero, np.diag(np.array([1.0, 3.2, 1.45]) ** 2), [F])
    assert np.abs(matrix_of(curves(system)["2ω₁"]).detuning).max() > NEAR_RESONANCE * 2.0
    assert 2.85 < fitted_order(eps, gaps(system, "2ω₁", eps, cut=6)) < 3.15


def test_damping_that_couples_close_modes_is_treated_exactly() -> None:
    """Modes 1 and 1.01 coupled by damping alone, as strongly as their frequencies differ."""
    zero, C = np.zeros((2, 2)), [[0.02, 0.019], [0.019, 0.02]]
    system = PeriodicSystem(np.eye(2), zero, C, np.diag([1.0, 1.01**2]), [np.diag([1.0, 0.5])])
    found, eps = curves(system)["2ω₁"], 0.08
    Omega = np.array([1.98, 2.0, 2.02])
    exact = [hill_growth(system, value, eps, cut=6) for value in Omega]
    np.testing.assert_allclose(found.growth_rate(Omega, eps), exact, atol=0.02 * eps**3)


def test_a_narrow_region_among_resonant_states_is_not_overlooked() -> None:
    """Far narrower than the samples of the search, which spans what the strong coupling to the third state can move."""
    zero, eps = np.zeros((2, 2)), 0.03
    system = PeriodicSystem(np.eye(2), zero, zero, np.diag([1.0, 9.3]), [[[0.001, 0.8], [0.8, 1.0]]])
    found = curves(system)["2ω₁"]
    assert len(matrix_of(found).states) > 2
    lower, upper = found.edges(eps)
    assert 0 < upper - lower < 1e-4
    exact = hill_edges(system, 0.5 * (lower + upper), upper - lower, eps, cut=7)
    np.testing.assert_allclose((lower, upper), exact, atol=0.2 * eps**3)


def test_of_two_regions_among_resonant_states_the_pair_has_its_own() -> None:
    """(ω₁+ω₂)/2 beside 2ω₂/3, in whose faster growth its states take part as well: the width grows like eps."""
    found = curves(random_system(16, 2, harmonics=2))["(ω₁+ω₂)/2"]
    assert len(matrix_of(found).states) == 4
    eps = np.array([0.005, 0.01, 0.015])
    lower, upper = found.edges(eps)
    np.testing.assert_allclose((upper - lower) / eps, 0.217, atol=0.03)


def test_resonant_states_stay_few_and_divide_by_nothing_small() -> None:
    """A chain of resonances without end: frequencies 1, 3, 5, ... with a full excitation matrix."""
    n = 20
    K = np.diag((2.0 * np.arange(n) + 1) ** 2)
    zero = np.zeros((n, n))
    system = PeriodicSystem(np.eye(n), zero, zero, K, [np.ones((n, n))])
    matrix = matrix_of(curves(system, (1.9, 2.1))["2ω₁"])
    assert len(matrix.states) == MAX_RESONANT_STATES
    largest = modal_equations(gyroscopic_modes(system), system).excitation.max()
    assert np.abs(matrix.coefficients[2, 0]).max() <= 4 * n * largest**2 / (NEAR_RESONANCE * 2.0)
    assert all(np.isfinite(coefficient).all() for coefficient in matrix.coefficients.values())


def test_modes_of_one_frequency_are_exact_mathieu_equations() -> None:
    """F = [[1, b], [b, 1]] on two equal oscillators: Mathieu with eps (1 ± b), to second order as in the series."""
    b, eps, zero = 0.5, 0.1, np.zeros((2, 2))
    T = np.array([[1.0, 0.4], [-0.3, 1.2]])
    system = PeriodicSystem(np.eye(2), zero, zero, np.eye(2), [[[1.0, b], [b, 1.0]]])
    for case in (system, congruent(system, T)):
        found = curves(case, types=["sum"])
        for suffix, edges_of in (
            ("", lambda e: (2 - e / 2 - e**2 / 32, 2 + e / 2 - e**2 / 32)),
            ("/2 (2nd)", lambda e: (1 - 5 * e**2 / 24, 1 + e**2 / 24)),
        ):
            edges = sorted(tuple(map(float, found[f"{name}{suffix}"].edges(eps))) for name in ("2ω₁", "2ω₂"))
            exact = sorted(edges_of(eps * force) for force in (1 + b, 1 - b))
            np.testing.assert_allclose(edges, exact, rtol=1e-11)
        assert np.isnan(found["ω₁+ω₂"].edges(eps)).all()
