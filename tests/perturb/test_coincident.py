"""Resonances of one frequency, or nearly one: theory takes them together, to first order too."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.special import mathieu_a, mathieu_b

from periodic import PeriodicSystem
from periodic.checks import FloatArray
from periodic.examples import coupled_mathieu
from perturb import TransitionCurve, transition_curves
from tests.perturb.perturb_oracles import (
    congruent,
    fitted_order,
    hill_edges,
    integrated_growth,
    moving_string,
    random_system,
)

ZERO = np.zeros((2, 2))


def turned(angle: float, values: tuple[float, ...]) -> FloatArray:
    """A symmetric matrix with these eigenvalues, its axes turned."""
    c, s = np.cos(angle), np.sin(angle)
    R = np.array([[c, -s], [s, c]])
    return R @ np.diag(values) @ R.T


def two_oscillators(F: FloatArray, split: float = 0.0, damping: float = 0.0) -> PeriodicSystem:
    return PeriodicSystem(np.eye(2), ZERO, damping * np.eye(2), np.diag([1.0, (1 + split) ** 2]), [F])


def sums(system: PeriodicSystem, window: tuple[float, float] = (1.0, 3.0)) -> dict[str, TransitionCurve]:
    return {c.label: c for c in transition_curves(system, window, types=["sum"])}


@pytest.mark.parametrize("angle", [0.3, np.pi / 4, 1.2, 2.6])
@pytest.mark.parametrize("values", [(1.5, 0.5), (1.1, -0.9), (0.2, 1.9)])
@pytest.mark.parametrize("split", [0.0, 1e-10, 1e-4])
def test_slopes_of_one_frequency_are_half_the_eigenvalues(
    angle: float, values: tuple[float, float], split: float
) -> None:
    """K = I: with W = R V the equations are two of Mathieu's with eps times the eigenvalues of F."""
    found = sums(two_oscillators(turned(angle, values), split))
    slopes = sorted(c.slope for c in found.values())
    # the coupling itself changes with the frequency of the second oscillator, by no more than the split
    np.testing.assert_allclose(slopes, [0.0, *sorted(0.5 * np.abs(values))], rtol=max(1e-6, 2 * split), atol=1e-12)


def mathieu_edges(force: float) -> tuple[float, float]:
    """Exact edges of the first region of x'' + (1 + force cos Omega t) x = 0, from the characteristic values."""
    q = np.linspace(0.0, 0.2, 20001)
    edges = []
    for characteristic in (mathieu_b, mathieu_a):  # a = 4 / Omega^2, q = 2 force / Omega^2
        a = characteristic(1, q)
        Omega = 2 / np.sqrt(a)
        edges.append(float(np.interp(0.0, q - 2 * force / Omega**2, Omega)))
    return min(edges), max(edges)


@pytest.mark.parametrize("angle", [0.3, np.pi / 4])
def test_edges_of_one_frequency_are_those_of_two_exact_equations(angle: float) -> None:
    eps = 0.1
    found = sums(two_oscillators(turned(angle, (1.5, 0.5))))
    for curve in found.values():
        if curve.slope > 0:
            np.testing.assert_allclose(curve.edges(eps), mathieu_edges(2 * curve.slope * eps), atol=0.1 * eps**2)
        np.testing.assert_allclose(curve.merged_edges(eps), mathieu_edges(1.5 * eps), atol=0.1 * eps**2)


def test_damped_modes_of_one_frequency_have_the_tips_of_two_exact_equations() -> None:
    """With damping d: Mathieu's tips 2 omega d / force."""
    d = 0.02
    found = sums(two_oscillators(turned(0.3, (1.5, 0.5)), damping=d))
    np.testing.assert_allclose(sorted(c.tip for c in found.values()), [2 * d / 1.5, 2 * d / 0.5, np.inf], rtol=1e-8)
    for curve in found.values():
        assert np.isnan(curve.edges(0.99 * curve.tip if np.isfinite(curve.tip) else 0.3)).all()


def test_damping_that_couples_modes_of_one_frequency() -> None:
    """C and F diagonal along x1 ± x2: each is one of Mathieu's equations, with its own damping."""
    b, d = 0.5, 0.02
    C = d * np.array([[1.0, 0.1 * b], [0.1 * b, 1.0]])
    system = PeriodicSystem(np.eye(2), ZERO, C, np.eye(2), [[[1.0, b], [b, 1.0]]])
    strong = sums(system)["2ω₁"]
    decay, force = d * (1 + 0.1 * b), 1 + b
    assert strong.tip == pytest.approx(2 * decay / force, rel=1e-8)
    half = np.sqrt((0.1 * force / 2) ** 2 - decay**2)
    np.testing.assert_allclose(strong.edges(0.1), (2 - half, 2 + half), rtol=1e-9)
    assert strong.slope == pytest.approx(force / 2, rel=1e-6)


def test_coordinates_decide_nothing() -> None:
    system = two_oscillators(turned(0.3, (1.5, 0.5)))
    slopes = [
        sorted(c.slope for c in sums(s).values()) for s in (system, congruent(system, np.array([[1, 2], [0, 3]])))
    ]
    np.testing.assert_allclose(slopes[0], slopes[1], atol=1e-9)


def test_coincident_resonances_name_each_other() -> None:
    found = sums(two_oscillators(turned(0.3, (1.5, 0.5)), 1e-4))
    for label, curve in found.items():
        assert set(curve.coincident) == set(found) - {label}
        assert 0 < curve.isolated_up_to < 1e-2 * curve.eps_max


def test_uncoupled_modes_of_one_frequency_stay_by_themselves() -> None:
    found = sums(two_oscillators(np.diag([1.0, 3.0])))
    assert {label: c.slope for label, c in found.items()} == pytest.approx({"2ω₁": 0.5, "ω₁+ω₂": 0.0, "2ω₂": 1.5})
    assert all(c.coincident == () and np.isinf(c.isolated_up_to) for c in found.values())


def test_isolated_resonances_keep_the_closed_form() -> None:
    for seed in range(5):
        for curve in transition_curves(random_system(seed, 2), (0.0, 100.0)):
            if not curve.coincident:
                assert curve.first.isolated_up_to == np.inf
    one = transition_curves(coupled_mathieu(), (2.6, 2.8))[0]
    assert one.slope == pytest.approx(0.5 / np.sqrt(1.7), rel=1e-14)


@pytest.mark.parametrize("split", [0.0, 1e-5, 1e-3, 0.01, 0.05, 0.15])
def test_the_gap_is_of_second_order_whatever_the_split(split: float) -> None:
    """omega_2 = 3 omega_1 (1 + split): 2 omega_1 and omega_2 - omega_1 together, at all of these eps."""
    eps = np.array([0.08, 0.04, 0.02])
    system = PeriodicSystem(
        np.eye(2), ZERO, ZERO, np.diag([1.0, 9.0 * (1 + split) ** 2]), [np.array([[1.0, 0.8], [0.8, 1.0]])]
    )
    curve = sums(system)["2ω₁"]
    for value in eps:
        lower, upper = curve.edges(value)
        exact = hill_edges(system, 0.5 * (lower + upper), upper - lower, value, cut=7)
        assert np.abs(np.array([lower, upper]) - exact).max() < 0.6 * value**2


def test_moving_string_has_a_gap_of_second_order() -> None:
    """omega_n = n omega_1 up to the truncation: 2 omega_1, omega_3 - omega_1, omega_5 - omega_3 act together."""
    system, eps = moving_string(0.3, 8), np.array([0.08, 0.04, 0.02])
    curve = sums(system, (5.0, 6.5))["2ω₁"]
    assert {"ω₃−ω₁", "ω₅−ω₃"} <= set(curve.coincident)
    gap = []
    for value in eps:
        lower, upper = curve.edges(value)
        exact = hill_edges(system, 0.5 * (lower + upper), upper - lower, value, cut=4)
        gap.append(np.abs(np.array([lower, upper]) - exact).max())
    assert 1.8 < fitted_order(eps, np.array(gap)) < 2.2


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("split", [0.0, 1e-4])
def test_merged_edges_are_those_of_the_integrated_equations(seed: int, split: float) -> None:
    """Random F on two equal oscillators with gyroscopic coupling of a third: unstable inside, stable outside."""
    rng = np.random.default_rng(seed)
    F = rng.normal(size=(3, 3))
    K = np.diag([1.0, (1 + split) ** 2, 5.3])
    system = PeriodicSystem(np.eye(3), np.zeros((3, 3)), np.zeros((3, 3)), K, [F + F.T])
    eps = 0.02
    strongest = max(sums(system, (1.9, 2.1)).values(), key=lambda c: c.slope)
    lower, upper = map(float, strongest.merged_edges(eps))
    margin = 40 * eps**2 * 0.25
    assert upper - lower > 4 * margin or strongest.slope < 0.4
    for Omega, unstable in ((lower + margin, True), (upper - margin, True), (lower - margin, False)):
        if lower + margin < Omega < upper - margin or not unstable:
            assert (integrated_growth(system, Omega, eps) > 1e-6) == unstable
    assert integrated_growth(system, upper + margin, eps) < 1e-6


def test_coincident_resonances_may_have_three_intervals() -> None:
    """omega_2 = 3 omega_1: 2 omega_1 and (omega_1 + omega_2) / 2, with a third interval that is neither's between."""
    F = np.array([[-0.36305495, -0.73465801], [-0.73465801, 2.04628803]])
    system, eps = PeriodicSystem(np.eye(2), ZERO, ZERO, np.diag([1.0, 9.0]), [F]), 0.04
    found = {c.label: c for c in transition_curves(system, (1.8, 2.3), order=2, types=["sum"])}
    one, other = found["2ω₁"], found["(ω₁+ω₂)/2 (2nd)"]
    np.testing.assert_allclose(one.merged_edges(eps), (1.99025, 1.99750), atol=1e-5)
    np.testing.assert_allclose(other.merged_edges(eps), (2.00243, 2.00971), atol=1e-5)
    for Omega in (1.994, 1.998, 2.0, 2.002, 2.006):
        exact = integrated_growth(system, Omega, eps)
        assert one.growth_rate(Omega, eps) == pytest.approx(exact, abs=2e-6)
        assert (exact > 1e-4) == (Omega not in (1.998, 2.002))
