"""Where theory's own assumptions end: the range of eps, and tips that second order moves."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from periodic import PeriodicSystem
from periodic.examples import coupled_mathieu, mathieu
from perturb import TransitionCurve, transition_curves
from plate import Distribution, EdgeLoad, MovingPlate
from tests.perturb.perturb_oracles import integrated_growth


@pytest.mark.parametrize("delta", [1.0, 0.04, 25.0])
def test_eps_max_is_where_the_stiffness_changes_by_a_third(delta: float) -> None:
    """Of Mathieu's equation: eps = 0.3 delta."""
    (curve,) = transition_curves(mathieu(delta), (0.0, 100.0))
    assert curve.eps_max == pytest.approx(0.3 * delta, rel=1e-12)


def test_the_softer_mode_decides_and_coupling_counts() -> None:
    """w1 = 1 and w2 = 1.7, coupled by b = 1: |w_p^H E w_q| = 1 / (1 * 1.7)."""
    for curve in transition_curves(coupled_mathieu(), (0.0, 10.0), types=["sum"]):
        assert curve.eps_max == pytest.approx(0.3 * 1.7, rel=1e-12)
    apart = PeriodicSystem(np.eye(2), np.zeros((2, 2)), np.zeros((2, 2)), np.diag([0.01, 4.0]), [np.eye(2)])
    found = {c.label: c.eps_max for c in transition_curves(apart, (0.0, 10.0), types=["sum"])}
    assert found == pytest.approx({"2ω₁": 0.003, "ω₁+ω₂": 0.003, "2ω₂": 1.2})


def test_without_excitation_there_is_no_limit() -> None:
    one, zero = np.eye(1), np.zeros((1, 1))
    (curve,) = transition_curves(PeriodicSystem(one, zero, zero, one, [zero]), (0.0, 10.0))
    assert curve.eps_max == np.inf


def test_near_divergence_the_range_is_short() -> None:
    plate = MovingPlate(axial_terms=3, lateral_terms=3)
    slow, fast = (
        {c.label: c for c in transition_curves(replace(plate, speed=part * plate.critical_speed()), (0.1, 90.0))}
        for part in (0.7, 0.99)
    )
    assert fast["2ω₁"].eps_max < 0.05 * slow["2ω₁"].eps_max
    assert fast["2ω₃"].eps_max > 10 * fast["2ω₁"].eps_max  # mode 3 is not soft, but the load couples it to mode 1


def two_harmonics() -> MovingPlate:
    """A uniform load whose second harmonic works against two interactions of the first."""
    load = EdgeLoad.uniform().with_waveform({1: (1, 0), 2: (0.3, Distribution.from_samples([0, 1], [-1, 1]))})
    plate = MovingPlate(
        aspect_ratio=3.0, tension=10.0, poisson_ratio=0.49, inplane="static", axial_terms=3, lateral_terms=2, load=load
    )
    return replace(plate, speed=0.7 * plate.critical_speed(), damping=1e-3)


def named(plate: MovingPlate, label: str, order: int) -> TransitionCurve:
    return next(c for c in transition_curves(plate, (5.8, 6.6), order=order) if c.label == label)


def test_second_order_moves_a_tip_far_from_where_first_order_has_it() -> None:
    plate = two_harmonics()
    for order in (1, 2):
        curve = named(plate, "2ω₃/2", order)
        assert curve.tips == pytest.approx((0.0962, 0.4955), abs=5e-4)
        assert curve.tip == curve.tips[order - 1]
    # first order has it open at eps = 0.3; the integrated equations are stable all around
    lower, upper = named(plate, "2ω₃/2", 1).edges(0.3)
    assert lower < upper
    growth = [integrated_growth(plate, Omega, 0.3) for Omega in np.linspace(lower, upper, 4).tolist()]
    assert max(growth) < 0


def test_tips_of_both_orders_agree_where_first_order_is_enough() -> None:
    (curve,) = [c for c in transition_curves(mathieu(1.0, 0.01), (1.5, 2.5)) if c.label == "2ω₁"]
    first, second = curve.tips
    assert second == pytest.approx(first, rel=1e-3)


def test_vanished_damping_has_no_second_tip() -> None:
    curves = transition_curves(coupled_mathieu(), (2.6, 2.8), vanishing_damping=np.eye(2))
    assert curves[0].tips[0] == 0
    assert np.isnan(curves[0].tips[1])
