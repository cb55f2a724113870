"""Theory against integration on quick cases: the CI check that analytic and Floquet boundaries agree."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

from compare import agreement
from compare import verdicts as module
from compare.verdicts import DEFAULT_LADDER, fitted_order, vanishes
from floquet import Kind, trace_boundary
from periodic import PeriodicSystem
from periodic.examples import coupled_mathieu, gyroscopic_rotor, mathieu
from perturb import TransitionCurve
from plate import EdgeLoad, MovingPlate

SMALL = {"axial_terms": 2, "lateral_terms": 3}


class Stiffening:
    """A family whose stiffness grows with Omega."""

    def __init__(self, system: PeriodicSystem) -> None:
        self.system = system

    def at(self, Omega: float) -> PeriodicSystem:
        s = self.system
        return PeriodicSystem(s.mass, s.gyroscopic, s.damping, s.stiffness * (1 + 1e-4 * Omega), s.cosine, s.sine)


@pytest.mark.parametrize(
    ("system", "window"),
    [
        (mathieu(delta=1.0), (1.5, 2.5)),
        (mathieu(delta=1.0, damping=0.02), (1.5, 2.5)),
        (coupled_mathieu(type="sum"), (0.1, 8.0)),
        (coupled_mathieu(type="difference"), (0.1, 8.0)),
        (gyroscopic_rotor(), (0.1, 8.0)),
        (MovingPlate(**SMALL), (10.0, 80.0)),
        (MovingPlate(**SMALL, aspect_ratio=2.0, speed=2.0, damping=1e-4), (5.0, 30.0)),
        (MovingPlate(**SMALL, load=EdgeLoad.linear(0.5, 1.5)), (10.0, 80.0)),
    ],
    ids=["mathieu", "damped mathieu", "sum", "difference", "rotor", "plate", "long damped plate", "skewed load"],
)
def test_first_order_theory_and_integration_agree(system: PeriodicSystem | MovingPlate, window: tuple) -> None:
    verdicts = agreement(system, window, modes=3)
    assert verdicts
    assert [verdict.label for verdict in verdicts if not verdict.agrees] == []


def test_the_gap_of_first_order_theory_is_of_second_order() -> None:
    # The main resonance of Mathieu's equation is off by q^2/8 on both sides, with nothing of a lower order.
    (verdict,) = agreement(mathieu(delta=1.0), (1.5, 2.5))
    assert verdict.label == "2ω₁"
    np.testing.assert_allclose(verdict.order, 2, atol=0.1)
    np.testing.assert_allclose(verdict.width_ratio[0], 1, atol=1e-3)


def test_second_order_theory_leaves_a_gap_of_third_order() -> None:
    verdicts = [v for v in agreement(MovingPlate(**SMALL), (10.0, 80.0), order=2, modes=3) if v.label == "2ω₁"]
    assert verdicts[0].agrees
    np.testing.assert_allclose(verdicts[0].order, 3, atol=0.15)


def test_a_gap_that_tracing_cannot_resolve_has_no_order() -> None:
    weak = PeriodicSystem([[1.0]], [[0.0]], [[0.0]], [[1.0]], [[[1e-4]]])  # the gap is 1e-12 and less
    (verdict,) = agreement(weak, (1.5, 2.5), n_jobs=1)
    assert (verdict.agrees, verdict.reason) == (True, "no gap at all that tracing could resolve")


def test_a_theory_that_is_wrong_is_found_out(monkeypatch: pytest.MonkeyPatch) -> None:
    right = TransitionCurve.edges
    monkeypatch.setattr(TransitionCurve, "edges", lambda self, eps: tuple(1.0002 * edge for edge in right(self, eps)))
    verdicts = agreement(mathieu(delta=1.0), (1.5, 2.5), n_jobs=1)
    assert not any(verdict.agrees for verdict in verdicts)


def test_a_family_whose_modes_depend_on_the_frequency_agrees() -> None:
    verdicts = agreement(Stiffening(mathieu(delta=1.0)), (1.5, 2.5))
    assert [verdict.agrees for verdict in verdicts] == [True]


def test_theory_takes_resonances_that_coincide_together() -> None:
    # omega_2 = 3 omega_1: 2 omega_1 and omega_2 - omega_1 are one frequency, which a pair of modes alone does not see.
    one = np.eye(2)
    system = PeriodicSystem(one, 0 * one, 0 * one, np.diag([1.0, 9.0]), [[[1.0, 0.5], [0.5, 1.0]]])
    verdicts = {verdict.label: verdict for verdict in agreement(system, (1.9, 2.1))}
    assert verdicts["2ω₁"].agrees


def test_what_integration_cannot_tell_is_no_agreement(monkeypatch: pytest.MonkeyPatch) -> None:
    def undecided(*arguments: object, **meant: object) -> object:
        nan = np.array([np.nan])
        return replace(trace_boundary(*arguments, **meant), kind=np.array([Kind.UNDECIDED]), lower=nan, upper=nan)

    monkeypatch.setattr(module, "trace_boundary", undecided)
    (verdict,) = agreement(MovingPlate(**SMALL), (24.0, 25.0), modes=2)
    assert verdict.label == "ω₁+ω₂"
    assert not verdict.agrees
    assert "cannot tell" in verdict.reason


def test_strong_damping_is_no_crash_but_no_agreement() -> None:
    # decay at 0.45 of a circle's frequency lowers that by a tenth: what is there is no 2 omega_1 of the undamped system
    zero = np.zeros((2, 2))
    system = PeriodicSystem(np.eye(2), zero, 0.9 * np.eye(2), np.diag([1.0, 6.0]), [np.eye(2)])
    verdicts = {verdict.label: verdict for verdict in agreement(system, (1.5, 6.0), (0.01, 0.02, 0.04))}
    assert not verdicts["2ω₁"].agrees
    assert "damping moves the natural frequencies" in verdicts["2ω₁"].reason


def test_instability_without_edges_is_not_called_closed() -> None:
    # undamped under an unsymmetric load, solutions grow between the resonances, too
    gyroscopic, F = [[0.0, 0.3], [-0.3, 0.0]], [[[1.0, 2.0], [-1.0, 0.5]], [[0.2, 0.7], [-0.4, 0.1]]]
    system = PeriodicSystem(np.eye(2), gyroscopic, np.zeros((2, 2)), np.diag([1.0, 3.0]), F)
    verdicts = {verdict.label: verdict for verdict in agreement(system, (0.5, 6.0), (0.02, 0.04, 0.08))}
    assert not verdicts["2ω₁"].agrees
    assert verdicts["2ω₁"].reason == "integration finds no edge where instability ends at eps = 0.02, 0.04, 0.08"


def test_a_verdict_can_be_written_as_json() -> None:
    text = json.dumps([verdict.to_dict() for verdict in agreement(MovingPlate(**SMALL), (20.0, 30.0), modes=3)])
    assert "NaN" not in text
    closed = json.loads(text)[0]
    assert closed["traced"][0] == [None] * 4
    assert closed["agrees"] is True


@pytest.mark.parametrize("order", [1, 2, 3])
def test_fitted_order_is_that_of_the_leading_term(order: int) -> None:
    eps = np.array([0.01, 0.02, 0.04, 0.08])
    gap = 0.7 * eps**order * (1 + 2 * eps)
    assert fitted_order(eps, gap) == pytest.approx(order, abs=5e-3)
    assert np.isnan(fitted_order(eps, np.zeros(4)))


@pytest.mark.parametrize(
    ("arguments", "wanted"),
    [
        ({"eps": [0.1, 0.2]}, "eps has 2 values"),
        ({"eps": [0.0, 0.1, 0.2]}, "eps starts at"),
        ({"eps": [0.1, 0.1, 0.2]}, "eps is not strictly increasing"),
        ({"order": 3}, "order = 3"),
        ({"modes": 0}, "modes = 0"),
        ({"types": ("product",)}, "types"),
        ({"Omega_range": (3.0, 1.0)}, "Omega_range"),
        ({"Omega_range": 3.0}, "Omega_range"),
        ({"n_jobs": 0}, "n_jobs = 0"),
    ],
)
def test_bad_input_is_refused(arguments: dict, wanted: str) -> None:
    with pytest.raises(ValueError, match=wanted):
        agreement(mathieu(), **({"Omega_range": (1.0, 3.0)} | arguments))


@pytest.mark.parametrize("family", [None, 3.0, np.eye(2), PeriodicSystem])
def test_what_is_no_system_is_refused(family: object) -> None:
    with pytest.raises(ValueError, match=r"(?s)family = .* is no system"):
        agreement(family, (1.0, 3.0))


@pytest.mark.parametrize(
    ("a", "agrees"),
    [
        ((0.0, 0.0, 1e-3, -0.1), True),  # the leading part is small: the gap changes sign on the ladder
        ((0.0, 0.0, 1.0, 1.0), True),
        ((0.0, 1e-2, 0.1, 0.0), False),  # a slope that is wrong
        ((0.0, 1e-4, 1e-3, -0.1), False),
        ((1e-3, 0.0, 1.0, 0.0), False),  # a centre that is wrong
        ((0.0, 0.0, 0.0, np.nan), False),
    ],
)
def test_a_signed_gap_has_no_first_order_left(a: tuple[float, ...], agrees: bool) -> None:
    eps = np.array(DEFAULT_LADDER)
    assert vanishes(eps, np.polynomial.Polynomial(a)(eps), 1, 1e-12) is agrees


def test_a_difference_is_not_taken_for_a_sum_close_by() -> None:
    """High modes of a damped plate: their differences lie among wide regions of low ones, and are closed."""
    plate = MovingPlate(aspect_ratio=2.5, speed=1.6, tension=11.0, damping=1e-4)
    found = agreement(plate, (12.5, 14.0))
    assert sum(region.type == "difference" for region in found) >= 5
    assert all(region.agrees for region in found), [(region.label, region.reason) for region in found]
