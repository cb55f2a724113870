"""Families whose modes depend on Omega: centres, slopes and edges against exact cases and integration."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pytest
from scipy.optimize import brentq

from periodic import PeriodicSystem
from perturb import TransitionCurve, transition_curves
from perturb.pair import Detuning
from tests.perturb.perturb_oracles import fitted_order, integrated_growth


@dataclass(frozen=True)
class Family:
    """A family from a function of Omega."""

    at: Callable[[float], PeriodicSystem]


def rotor(c: float = 0.0) -> Family:
    G, F = np.array([[0.0, -0.5], [0.5, 0.0]]), np.array([[1.0, 0.5], [0.5, 1.0]])
    return Family(lambda Omega: PeriodicSystem(np.eye(2), Omega * G, c * np.eye(2), np.diag([1.0, 1.3]), [F]))


def oscillator(stiffness: Callable[[float], float]) -> Family:
    """x'' + (stiffness(Omega) + eps cos Omega t) x = 0."""
    return Family(lambda Omega: PeriodicSystem([[1.0]], [[0.0]], [[0.0]], [[stiffness(Omega)]], [[[1.0]]]))


def labelled(family: Family, window: tuple[float, float], order: int = 1) -> dict[str, TransitionCurve]:
    return {c.label: c for c in transition_curves(family, window, order=order, types=["sum"])}


def rotor_frequency(Omega: float, n: int) -> float:
    """omega^4 - (k1 + k2 + g^2) omega^2 + k1 k2 = 0 with g = Omega / 2."""
    half = 0.5 * (2.3 + 0.25 * Omega**2)
    return float(np.sqrt(half + (-1 if n == 1 else 1) * np.sqrt(half**2 - 1.3)))


@pytest.mark.parametrize(
    ("label", "order", "equation"),
    [
        ("2ω₁", 1, lambda x: x - 2 * rotor_frequency(x, 1)),
        ("ω₁+ω₂", 1, lambda x: x - rotor_frequency(x, 1) - rotor_frequency(x, 2)),
        ("2ω₁/2 (2nd)", 2, lambda x: x - rotor_frequency(x, 1)),
        ("2ω₂/2 (2nd)", 2, lambda x: x - rotor_frequency(x, 2)),
    ],
)
def test_centres_solve_the_characteristic_equation(label: str, order: int, equation: Callable[[float], float]) -> None:
    centre = labelled(rotor(), (0.2, 6.0), order)[label].centre
    assert centre == pytest.approx(brentq(equation, 0.2, 6.0, xtol=1e-14), rel=1e-12)


def test_a_resonance_at_the_excitation_frequency_is_not_where_the_rotor_at_rest_has_it() -> None:
    assert labelled(rotor(), (0.2, 2.0), order=2)["2ω₁/2 (2nd)"].centre == pytest.approx(0.8645, abs=5e-5)


def edges_by_integration(family: Family, lower: float, upper: float, eps: float) -> tuple[float, float]:
    middle, width = 0.5 * (lower + upper), upper - lower
    found = []
    for stable in (lower - width, upper + width):
        a, b = middle, stable
        while abs(a - b) > 1e-8:
            c = 0.5 * (a + b)
            a, b = (c, b) if integrated_growth(family, c, eps) > 1e-6 else (a, c)
        found.append(0.5 * (a + b))
    return found[0], found[1]


@pytest.mark.parametrize("label", ["2ω₁", "ω₁+ω₂"])
@pytest.mark.parametrize("order", [1, 2])
def test_gap_of_a_rotor_is_of_the_order_that_follows(label: str, order: int) -> None:
    eps = np.array([0.05, 0.025])
    curve = labelled(rotor(), (0.2, 6.0), order)[label]
    gap = []
    for value in eps:
        lower, upper = map(float, curve.edges(value))
        exact = edges_by_integration(rotor(), lower, upper, value)
        gap.append(np.abs(np.array([lower, upper]) - exact).max())
    assert order + 0.8 < fitted_order(eps, np.array(gap)) < order + 1.2


def test_width_is_divided_by_the_rate_of_the_detuning() -> None:
    """omega = a + b Omega: Omega = 2 a / (1 - 2 b), half width eps / (2 omega) / (1 - 2 b)."""
    a, b = 1.0, 0.2
    curve = labelled(oscillator(lambda Omega: (a + b * Omega) ** 2), (1.0, 6.0))["2ω₁"]
    assert curve.centre == pytest.approx(2 * a / (1 - 2 * b), rel=1e-12)
    assert curve.slope == pytest.approx(0.5 / (a + b * curve.centre) / (1 - 2 * b), rel=1e-6)


def test_a_frequency_that_overtakes_the_line_has_its_edges_in_order() -> None:
    """The rate 1 - 2 b is negative."""
    b, centre = 0.8, 2.0
    curve = labelled(oscillator(lambda Omega: (1.0 + b * (Omega - centre)) ** 2), (1.5, 2.5))["2ω₁"]
    lower, upper = curve.edges(0.05)
    assert lower < curve.centre < upper
    assert upper - lower == pytest.approx(2 * 0.05 * 0.5 / 0.6, rel=0.01)


def test_no_solution_and_several() -> None:
    """2 omega = Omega + (Omega - 1) (Omega - 2) / 4 + shift."""

    def family(shift: float) -> Family:
        return oscillator(lambda x: (0.5 * x + 0.125 * (x - 1) * (x - 2) + 0.5 * shift) ** 2)

    centres = [[c.centre for c in transition_curves(family(s), (0.6, 3.0))] for s in (0.0, 0.2)]
    np.testing.assert_allclose(centres[0], [1.0, 2.0], rtol=1e-10)
    assert centres[1] == []


def test_a_touching_solution_has_a_region_as_wide_as_the_root_of_eps() -> None:
    """2 omega = Omega + k (Omega - 2)^2: |detuning| < eps / (2 omega) is |x| < sqrt(eps / (2 omega k))."""
    k, eps = 0.4, 0.004
    family = oscillator(lambda x: (0.5 * x + 0.5 * k * (x - 2) ** 2) ** 2)
    (curve,) = transition_curves(family, (1.5, 2.7))
    assert curve.centre == pytest.approx(2.0, abs=1e-6)
    lower, upper = map(float, curve.edges(eps))
    reach = np.sqrt(0.5 * eps / k)
    np.testing.assert_allclose((lower, upper), (2 - reach, 2 + reach), atol=0.1 * reach)
    for side in (-1, 1):
        assert integrated_growth(family, 2 + side * 0.8 * reach, eps) > 1e-5
        assert integrated_growth(family, 2 + side * 1.25 * reach, eps) < 1e-6


def test_damping_at_the_centre_decides_the_tip() -> None:
    c = 0.01
    curve = labelled(rotor(c), (0.2, 6.0))["2ω₁"]
    assert np.isnan(curve.edges(0.99 * curve.tip)).all()
    for part, sign in ((0.93, -1), (1.07, 1)):
        assert sign * integrated_growth(rotor(c), curve.centre, part * curve.tip) > 0


def test_a_turning_detuning_goes_on_to_where_it_comes_back() -> None:
    s = Detuning(1.0, -1.0)  # at most 0.25, at x = 0.5; back to -0.1 beyond x = 1
    lower, upper = s.between(np.array(-0.1), np.array(0.3))
    assert s(lower) == pytest.approx(-0.1)
    assert s(upper) == pytest.approx(-0.1)
    assert lower < 0 < 1 < upper
    mirrored = Detuning(-1.0, -1.0).between(np.array(-0.1), np.array(0.3))
    np.testing.assert_allclose(mirrored, (-upper, -lower))


def test_where_the_stiffness_turns_indefinite_resonances_end() -> None:
    (curve,) = transition_curves(oscillator(lambda x: 2.0 - x), (1.0, 3.0))
    assert curve.label == "2ω₁"
    assert curve.centre == pytest.approx(np.sqrt(12) - 2, abs=1e-12)  # Omega^2 = 4 (2 - Omega)


def test_frequencies_that_jump_are_refused() -> None:
    def noise(x: float) -> float:
        return 1.0 + 0.3 * float(np.sin(1e5 * x))

    with pytest.raises(ValueError, match="change too fast with Omega"):
        transition_curves(oscillator(noise), (1.0, 3.0))


def test_vanishing_damping_is_refused() -> None:
    with pytest.raises(ValueError, match=r"^vanishing_damping is for families whose modes do not depend on Omega"):
        transition_curves(rotor(), (0.2, 3.0), vanishing_damping=np.eye(2))
