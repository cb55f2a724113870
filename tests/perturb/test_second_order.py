"""Second-order transition curves: exact series, order of the error, second-order regions, invariances."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import mathieu_a, mathieu_b

from floquet import trace_boundary
from periodic import PeriodicSystem
from periodic.examples import coupled_mathieu, gyroscopic_rotor, mathieu, meissner
from perturb import gyroscopic_modes, transition_curves
from perturb.effective_matrix import alone
from perturb.expansion import modal_equations
from plate import MovingPlate
from tests.perturb.perturb_oracles import (
    changed,
    congruent,
    fitted_order,
    hill_edges,
    hill_exponents,
    hill_growth,
    random_system,
)
from tests.perturb.second_order_oracles import EVERYTHING, curves, gaps, matrix_of

# --- Mathieu ---------------------------------------------------------------------------------------------------------


def test_mathieu_edges_are_the_series_to_second_order() -> None:
    """n = 1: a = 1 ± q - q^2/8 is Omega = 2 ± eps/2 - eps^2/32; n = 2: delta = 1 + 5 e^2/12, 1 - e^2/12 at Omega = 1 is
    Omega = 1 - 5 eps^2/24, 1 + eps^2/24 at delta = 1 (DLMF 28.6.2, 28.6.5, 28.6.6; Abramowitz and Stegun 20.2.25)."""
    eps = np.array([0.01, 0.1, 0.3])
    found = curves(mathieu(1.0))
    np.testing.assert_allclose(
        found["2ω₁"].edges(eps), (2 - eps / 2 - eps**2 / 32, 2 + eps / 2 - eps**2 / 32), rtol=1e-14
    )
    tongue = found["2ω₁/2 (2nd)"]
    assert (tongue.j, tongue.interaction, tongue.slope, tongue.tip) == (2, 2, 0.0, 0.0)
    np.testing.assert_allclose(tongue.edges(eps), (1 - 5 * eps**2 / 24, 1 + eps**2 / 24), rtol=1e-14)


def mathieu_edges(n: int, eps: float) -> tuple[float, float]:
    """Exact edges in Omega of the n-th region at delta = 1: a = 4 / Omega^2, q = 2 eps / Omega^2."""

    def edge(characteristic: Any) -> float:
        return brentq(lambda Omega: characteristic(n, 2 * eps / Omega**2) - 4 / Omega**2, 1.6 / n, 2.4 / n, xtol=1e-14)

    a, b = edge(mathieu_a), edge(mathieu_b)
    return min(a, b), max(a, b)


@pytest.mark.parametrize(("label", "n", "order"), [("2ω₁", 1, 3), ("2ω₁/2 (2nd)", 2, 4)])
def test_mathieu_gap(label: str, n: int, order: int) -> None:
    """Third order; for n = 2 fourth, as eps -> -eps is a shift of time that leaves each edge of even n where it is."""
    eps = np.array([0.1, 0.05, 0.025])
    found = curves(mathieu(1.0))[label]
    exact = np.array([mathieu_edges(n, value) for value in eps]).T
    gap = np.abs(np.array(found.edges(eps)) - exact)
    for edge in gap:
        assert order - 0.15 < fitted_order(eps, edge) < order + 0.15


def test_damped_second_order_region_of_mathieu_opens_at_its_tip() -> None:
    damping = 0.005
    system = mathieu(1.0, damping)
    tongue = curves(system)["2ω₁/2 (2nd)"]
    # width of the undamped region eps^2 / 4 in 2 Omega: growth eps^2 / 8 against damping / 2
    assert tongue.tip == pytest.approx(2 * np.sqrt(damping), rel=0.01)
    assert np.isnan(tongue.edges(0.999 * tongue.tip)).all()
    lower, upper = tongue.edges(1.02 * tongue.tip)
    for part, sign in ((0.98, -1), (1.02, 1)):
        assert sign * hill_growth(system, float(0.5 * (lower + upper)), part * tongue.tip) > 0


# Unsymmetric, but without gyroscopic forces and with one cosine only: every L is real but for rounding.
REAL_UNSYMMETRIC = changed(random_system(15, 2, symmetric=False, gyroscopic=0.0), sine=np.zeros((1, 2, 2)))


# --- the order of the error ------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("system", "label", "order"),
    [
        (coupled_mathieu("sum"), "ω₁+ω₂", 3),
        (coupled_mathieu("sum"), "2ω₁/2 (2nd)", 4),
        (coupled_mathieu("difference"), "ω₂−ω₁", 3),
        (REAL_UNSYMMETRIC, "2ω₁", 3),
        (REAL_UNSYMMETRIC, "ω₁+ω₂", 3),
        (gyroscopic_rotor((4.0, 9.0), 0.8), "2ω₁", 3),
        (gyroscopic_rotor((4.0, 9.0), 0.8), "ω₁+ω₂", 3),
        (gyroscopic_rotor((4.0, 4.0), 0.5), "ω₁+ω₂", 3),
        (random_system(15, 2, harmonics=2), "2ω₁", 3),
        (random_system(15, 2, harmonics=2), "(ω₁+ω₂)/2", 3),
        (random_system(15, 2, harmonics=2), "2ω₂/3 (2nd)", 3),
    ],
)
def test_gap_is_of_third_order(system: PeriodicSystem, label: str, order: int) -> None:
    """Of fourth order where a single cosine makes the edges even in eps."""
    eps = np.array([0.16, 0.08, 0.04]) if system.harmonics == 1 else np.array([0.08, 0.04, 0.02])
    measured = fitted_order(eps, gaps(system, label, eps, cut=6))
    assert order - 0.15 < measured < order + 0.15


@pytest.mark.parametrize("seed", range(4))
def test_real_unsymmetric_systems_have_finite_edges(seed: int) -> None:
    """An imaginary part of L or a decay left by rounding would make every detuning unstable."""
    system = changed(random_system(seed, 3, symmetric=False, gyroscopic=0.0), sine=np.zeros((1, 3, 3)))
    for found in curves(system).values():
        assert not np.isinf(found.edges([0.02, 0.05])).any(), found.label


def test_uncoupled_modes_have_no_difference_region() -> None:
    zero, F = np.zeros((3, 3)), [[1.0, 0.5, 0.0], [-0.2, 1.0, 0.0], [0.0, 0.0, 1.0]]
    found = curves(PeriodicSystem(np.eye(3), zero, zero, np.diag([1.0, 2.9, 5.3]), [F]))
    assert np.isfinite(found["ω₂−ω₁"].edges(0.1)).all()
    assert np.isnan(found["ω₃−ω₁"].edges(0.1)).all()


@pytest.mark.parametrize("label", ["2ω₁", "ω₁+ω₂", "2ω₂"])
def test_gap_with_damping_is_of_third_order(label: str) -> None:
    """Full damping matrix, c = eps alpha: the cross terms of damping and excitation count."""
    eps = np.array([0.16, 0.08, 0.04])
    gap = []
    for value in eps:
        system = random_system(12, 2, damping=0.15 * value)
        gap += gaps(system, label, np.array([value]), cut=6, threshold=0.0).tolist()
    assert 2.85 < fitted_order(eps, np.array(gap)) < 3.15


class Drifting:
    """A family whose excitation depends on Omega."""

    def __init__(self, base: PeriodicSystem) -> None:
        self.base = base

    def at(self, Omega: float) -> PeriodicSystem:
        return changed(self.base, cosine=(1 + 0.3 * Omega**2) * self.base.cosine, sine=self.base.sine / (1 + Omega))


@pytest.mark.parametrize("label", ["2ω₁", "ω₁+ω₂"])
def test_gap_of_a_family_is_of_third_order(label: str) -> None:
    """The shift of the excitation from the centre to the edge is of second order and must be in."""
    family = Drifting(random_system(13, 2))
    eps = np.array([0.08, 0.04, 0.02])
    found = curves(family)[label]
    gap = []
    for value in eps:
        for edge in found.edges(value):
            system = family.at(float(edge))
            exact = hill_edges(system, found.centre + 0.5 * (edge - found.centre), 2 * value, value, cut=6)
            gap.append(abs(edge - exact[int(edge > found.centre)]))
    # The edge of the system frozen at our edge differs from the edge of the family in proportion to the gap itself.
    for side in (0, 1):
        assert 2.85 < fitted_order(eps, np.array(gap[side::2])) < 3.15


@pytest.mark.parametrize(
    ("seed", "symmetric", "damping"), [(0, True, 0.0), (1, True, 0.3), (2, False, 0.0), (3, False, 0.3)]
)
def test_exponents_of_the_effective_matrix_are_of_third_order(seed: int, symmetric: bool, damping: float) -> None:
    """All resonances of a random system that involve two states, against the exponents of Hill's determinant."""
    eps = np.array([0.02, 0.01])
    system = random_system(seed, 2, harmonics=2, symmetric=symmetric)
    modes = gyroscopic_modes(system)
    for found in transition_curves(system, EVERYTHING, order=2):
        if len(matrix_of(found).states) > 2:
            continue
        worst = []
        for value in eps:
            damped = changed(system, damping=damping * value * random_system(seed, 2, damping=1.0).damping)
            matrix = alone(modal_equations(modes, damped), found.resonance, order=2)
            x = 0.2 * value
            ours = np.linalg.eigvals(matrix.at(np.array(x), np.array(value))) + 1j * modes.frequencies[found.p - 1]
            exact = hill_exponents(damped, found.centre + x, value, cut=12)
            nearest = [exact[np.argmin(np.abs(exact - exponent))] for exponent in ours]
            worst.append(max(np.abs(np.prod(exponent - ours)) for exponent in nearest))
        # The characteristic polynomial at the exact exponents, which unlike its roots does not mind coalescence: an
        # error of third order times a distance between exponents of first order. Half of eps: a sixteenth.
        assert worst[1] < worst[0] / 11 + 1e-14


@pytest.mark.parametrize(("label", "order"), [("2ω₁", 3), ("2ω₂", 3), ("(ω₁+ω₃)/2 (2nd)", 4)])
def test_gap_on_the_plate(label: str, order: int) -> None:
    """A moving plate with uniform pulsating tension, against its traced boundaries."""
    plate = MovingPlate(axial_terms=3, lateral_terms=3)
    eps = np.array([0.1, 0.05, 0.025])
    found = curves(plate, (5.0, 40.0))[label]
    traced = trace_boundary(plate, found.centre, eps)
    gap = np.abs(np.array(found.edges(eps)) - [traced.lower, traced.upper]).max(axis=0)
    assert order - 0.15 < fitted_order(eps, gap) < order + 0.15


# --- the list --------------------------------------------------------------------------------------------------------


def test_second_order_adds_the_sums_of_two_harmonics() -> None:
    """Meissner with harmonics 1, 3 (and an empty 2): regions 1, 3 directly, 2, 4, 6 by two interactions; no 5."""
    found = curves(meissner(1.0, harmonics=3))
    assert {c.j: c.interaction for c in found.values()} == {1: 1, 2: 2, 3: 1, 4: 2, 6: 2}
    assert {c.label for c in found.values() if c.interaction == 2} == {"2ω₁/2 (2nd)", "2ω₁/4 (2nd)", "2ω₁/6 (2nd)"}
    for region in found.values():
        assert region.tip == 0
        assert (region.slope > 0) == (region.interaction == 1)


def test_first_and_second_order_part_with_eps_squared() -> None:
    system = random_system(14, 3, damping=0.0)
    first = {c.label: c for c in transition_curves(system, EVERYTHING, types=["sum"])}
    eps = np.array([0.02, 0.01, 0.005])
    for label, second in curves(system, types=["sum"]).items():
        if second.interaction == 1:
            apart = np.abs(np.array(second.edges(eps)) - first[label].edges(eps)).max(axis=0)
            assert 1.8 < fitted_order(eps, apart) < 2.2
            assert second.slope == first[label].slope


def test_no_difference_type_for_conservative_systems() -> None:
    for seed in (3, 4):
        for found in curves(random_system(seed, 3, harmonics=2), types=["difference"]).values():
            assert np.isnan(found.edges([0.05, 0.1])).all(), found.label
            assert found.tip == np.inf


def test_edges_keep_the_shape_of_eps_among_more_states_too() -> None:
    zero = np.zeros((2, 2))
    system = PeriodicSystem(np.eye(2), zero, zero, np.diag([1.0, 9.0]), [[[1.0, 0.8], [0.8, 1.0]]])
    crowded = curves(system)["2ω₁"]
    for found in (crowded, curves(mathieu())["2ω₁"]):
        for eps in (0.1, [0.1], [[0.05, 0.1], [0.15, 0.2]], np.zeros((2, 0))):
            lower, upper = found.edges(eps)
            assert np.shape(lower) == np.shape(upper) == np.shape(eps)
        assert found.growth_rate([[1.9], [2.0]], [0.1, 0.2, 0.3]).shape == (2, 3)
    np.testing.assert_array_equal(crowded.edges([0.05, 0.1]), np.transpose([crowded.edges(0.05), crowded.edges(0.1)]))


# --- invariances -----------------------------------------------------------------------------------------------------


def assert_same_edges(one: PeriodicSystem, other: PeriodicSystem, eps: float, rtol: float, eps_other: float) -> None:
    for here, there in zip(
        transition_curves(one, EVERYTHING, order=2), transition_curves(other, EVERYTHING, order=2), strict=True
    ):
        assert here.label == there.label
        width = 1e-3 * here.centre
        np.testing.assert_allclose(there.edges(eps_other), here.edges(eps), atol=rtol * width, err_msg=here.label)


@pytest.mark.parametrize("seed", range(5))
def test_sign_of_eps_decides_nothing_for_one_cosine(seed: int) -> None:
    system = changed(random_system(seed, 2), sine=np.zeros((1, 2, 2)))
    assert_same_edges(system, system, 0.05, 1e-5, -0.05)


@pytest.mark.parametrize(("seed", "phase"), [(0, 0.3), (1, 1.7), (2, 3.0), (3, 4.4)])
def test_origin_of_time_decides_nothing(seed: int, phase: float) -> None:
    """Harmonic j is shifted by j times the phase; second-order sums mix harmonics and must know."""
    system = random_system(seed, 2, harmonics=2)
    c, s = (f(phase * np.array([1, 2]))[:, None, None] for f in (np.cos, np.sin))
    shifted = changed(system, cosine=c * system.cosine + s * system.sine, sine=c * system.sine - s * system.cosine)
    assert_same_edges(system, shifted, 0.05, 1e-5, 0.05)


@pytest.mark.parametrize("seed", range(5))
def test_coordinates_decide_nothing(seed: int) -> None:
    system = random_system(seed, 2, harmonics=2)
    T = np.random.default_rng(seed).normal(size=(2, 2)) + 3 * np.eye(2)
    assert_same_edges(system, congruent(system, T), 0.05, 1e-5, 0.05)
