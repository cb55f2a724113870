"""Theory against integration on quick cases: the CI check that analytic and Floquet boundaries agree."""

from __future__ import annotations

import json
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from compare import Basis, Outcome, Tally, agreement
from compare import comparison as module
from floquet import BoundaryTrace, Kind, trace_boundary
from periodic import PeriodicSystem
from periodic.examples import coupled_mathieu, gyroscopic_rotor, mathieu
from perturb import TransitionCurve
from plate import EdgeLoad, MovingPlate

SMALL = {"axial_terms": 2, "lateral_terms": 3}


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
    assert [(verdict.label, verdict.reason) for verdict in verdicts if verdict.outcome is Outcome.DISAGREES] == []
    compared = [verdict for verdict in verdicts if verdict.agrees]
    assert compared
    assert all(verdict.compared for verdict in compared)


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
    (verdict,) = agreement(weak, (1.5, 2.5), (0.025, 0.05, 0.1), n_jobs=1)
    assert (verdict.agrees, verdict.reason) == (True, "no gap at all that tracing could resolve")


@pytest.mark.parametrize("stretch", [0.9, 1.002, 1.1])
def test_a_theory_that_is_wrong_is_found_out(stretch: float, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = TransitionCurve.merged_edges

    def stretched(self: TransitionCurve, eps: object) -> tuple[object, ...]:
        return tuple(self.centre + stretch * (edge - self.centre) for edge in whole(self, eps))

    monkeypatch.setattr(TransitionCurve, "merged_edges", stretched)
    (verdict,) = agreement(mathieu(), (1.5, 2.5), n_jobs=1)
    assert verdict.outcome is Outcome.DISAGREES
    assert not verdict.agrees


def test_stiffness_that_depends_on_the_frequency_is_no_obstacle() -> None:
    class Stiffening:
        def at(self, Omega: float) -> PeriodicSystem:
            return PeriodicSystem([[1.0]], [[0.0]], [[0.0]], [[1 + 1e-4 * Omega]], [[[1.0]]])

    (verdict,) = agreement(Stiffening(), (1.5, 2.5), n_jobs=1)
    assert verdict.agrees, verdict.reason


def test_resonances_that_coincide_are_one_region_and_not_blamed_on_theory() -> None:
    one, c, s = np.eye(2), np.cos(0.3), np.sin(0.3)
    turned = np.array([[c, -s], [s, c]])
    system = PeriodicSystem(one, 0 * one, 0 * one, one, [turned @ np.diag([1.5, 0.5]) @ turned.T])
    verdicts = agreement(system, (1.9, 2.1))
    assert all(verdict.coincident for verdict in verdicts)
    assert [one.reason for one in verdicts if one.outcome is Outcome.DISAGREES] == []
    tally = Tally.of([(system, verdicts)])
    assert (tally.compared, tally.integrated, tally.left) == (1, 0, {})


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
    (verdict,) = agreement(mathieu(), (1.5, 2.5))
    assert verdict.label == "2ω₁"
    assert verdict.outcome is Outcome.NOT_COMPARED
    assert "cannot tell" in verdict.reason


def test_strong_damping_is_no_crash_but_no_agreement() -> None:
    # decay at 0.45 of a circle's frequency lowers that by a tenth: what is there is no 2 omega_1 of the undamped system
    zero = np.zeros((2, 2))
    system = PeriodicSystem(np.eye(2), zero, 0.9 * np.eye(2), np.diag([1.0, 6.0]), [np.eye(2)])
    verdicts = {verdict.label: verdict for verdict in agreement(system, (1.5, 6.0), (0.01, 0.02, 0.04))}
    assert verdicts["2ω₁"].outcome is Outcome.NOT_COMPARED
    assert "damping moves the natural frequencies" in verdicts["2ω₁"].reason


@pytest.mark.slow
def test_instability_without_edges_is_not_called_closed() -> None:
    # undamped under an unsymmetric load, solutions grow between the resonances, too
    gyroscopic, F = [[0.0, 0.3], [-0.3, 0.0]], [[[1.0, 2.0], [-1.0, 0.5]], [[0.2, 0.7], [-0.4, 0.1]]]
    system = PeriodicSystem(np.eye(2), gyroscopic, np.zeros((2, 2)), np.diag([1.0, 3.0]), F)
    verdicts = {verdict.label: verdict for verdict in agreement(system, (1.8, 2.2), (0.02, 0.04, 0.08))}
    assert verdicts["2ω₁"].outcome is Outcome.NOT_COMPARED
    assert verdicts["2ω₁"].reason.startswith("integration finds no edge where instability ends at eps = ")


def test_a_verdict_can_be_written_as_json() -> None:
    text = json.dumps([verdict.to_dict() for verdict in agreement(MovingPlate(**SMALL), (20.0, 30.0), modes=3)])
    assert "NaN" not in text
    first = json.loads(text)[0]
    assert (first["outcome"], first["agrees"], first["eps"]) == ("not compared", False, [])


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


def test_a_difference_is_not_taken_for_a_sum_close_by() -> None:
    """High modes of a damped plate: their differences lie among wide regions of low ones, and are closed."""
    plate = MovingPlate(aspect_ratio=2.5, speed=1.6, tension=11.0, damping=1e-4, axial_terms=8, lateral_terms=3)
    found = agreement(plate, (12.5, 14.0), types=("difference",))
    assert sum(region.eps.size > 0 for region in found) >= 2
    assert not any(region.outcome is Outcome.DISAGREES for region in found), [
        (region.label, region.reason) for region in found
    ]


@pytest.mark.parametrize(
    ("damping", "outcome"), [(0.004, "agrees"), (0.04, "agrees"), (0.08, "agrees"), (0.2, "not compared")]
)
def test_the_ladder_reaches_beyond_the_tip_or_says_so(damping: float, outcome: str) -> None:
    (verdict,) = agreement(mathieu(damping=damping), (1.5, 2.5))
    assert verdict.outcome.value == outcome, verdict.reason
    tip = 2 * damping  # of x'' + c x' + (1 + eps cos Omega t) x
    if verdict.agrees:
        assert verdict.eps[-1] > tip
        assert np.isfinite(verdict.traced).all()
    else:
        assert verdict.reason.startswith(f"opens at eps = {tip:g}, beyond the range")


def test_a_ladder_that_is_given_ends_below_the_tip() -> None:
    (verdict,) = agreement(mathieu(damping=0.2), (1.5, 2.5), (0.1, 0.2, 0.3))
    assert (verdict.outcome, verdict.basis) == (Outcome.NOT_COMPARED, Basis.DAMPED)
    assert "closed by damping on the rungs up to eps = 0.3" in verdict.reason


def test_close_to_a_tip_theory_is_not_blamed() -> None:
    plate = MovingPlate(axial_terms=3, lateral_terms=4, damping=1e-4)
    (verdict,) = agreement(plate, (48.8, 48.9), modes=3)
    assert verdict.label == "ω₁+ω₃"
    assert verdict.agrees, verdict.reason
    assert verdict.eps[-1] > 0.1013  # the tip


@pytest.mark.parametrize("fraction", [0.99, 0.9999])
def test_near_divergence_the_ladder_follows_the_soft_mode(fraction: float) -> None:
    still = MovingPlate(**SMALL, speed=0.0)
    plate = replace(still, speed=fraction * still.critical_speed())
    frequency = np.sqrt(np.min(np.linalg.eigvals(np.linalg.solve(plate.at(0.0).mass, plate.at(0.0).stiffness)).real))
    verdicts = agreement(plate, (0.2 * frequency, 30.0), modes=2)
    agreeing = {verdict.label: verdict for verdict in verdicts if verdict.agrees}
    assert {"2ω₁", "2ω₂"} <= agreeing.keys()
    assert agreeing["2ω₁"].eps[-1] < 0.005 < agreeing["2ω₂"].eps[-1]  # eps = 0.1 changes omega_1^2 several times over
    assert [(one.label, one.reason) for one in verdicts if one.outcome is Outcome.DISAGREES] == []


def test_the_edges_of_second_order_regions_are_looked_at() -> None:
    plate = MovingPlate(**SMALL, damping=1e-6)
    verdicts = {verdict.label: verdict for verdict in agreement(plate, (9.0, 10.0), order=2, modes=1)}
    half = verdicts["2ω₁/2 (2nd)"]
    assert (half.outcome, half.basis) == (Outcome.AGREES, Basis.EDGES), half.reason
    assert np.isfinite(half.gap).all()


def test_an_error_of_one_region_leaves_the_others(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuses(family: object, near: float, *arguments: object, **meant: object) -> object:
        if near < 5.0:
            raise ValueError("beyond floating point")
        return trace_boundary(family, near, *arguments, **meant)

    monkeypatch.setattr(module, "trace_boundary", refuses)
    one = np.eye(2)
    system = PeriodicSystem(one, 0 * one, 0 * one, np.diag([1.0, 9.5]), [[[1.0, 0.5], [0.5, 1.0]]])
    verdicts = {verdict.label: verdict for verdict in agreement(system, (1.9, 6.5), types=("sum",))}
    assert verdicts["2ω₁"].outcome is Outcome.NOT_COMPARED
    assert "beyond floating point" in verdicts["2ω₁"].reason
    assert verdicts["2ω₂"].agrees


@pytest.mark.parametrize("joined", [True, False])
def test_the_edge_of_another_region_is_no_disagreement(monkeypatch: pytest.MonkeyPatch, joined: bool) -> None:
    """One rung on which a narrow region lies at the lower edge."""

    def spoiled(*arguments: Any, **options: Any) -> BoundaryTrace:
        trace = trace_boundary(*arguments, **options)
        if trace.eps[0] > 0.001:
            other = {"lower_meeting": trace.lower} if joined else {}
            trace = replace(trace, lower=trace.lower - 3e-6, **other)
        return trace

    monkeypatch.setattr(module, "trace_boundary", spoiled)
    (verdict,) = agreement(mathieu(delta=1.0), (1.5, 2.5), [0.0002, 0.0004, 0.0008, 0.0016])
    assert verdict.outcome is (Outcome.AGREES if joined else Outcome.NOT_COMPARED)
    assert joined or "it still falls" in verdict.reason


def test_a_series_that_starts_far_down_is_followed_there() -> None:
    """Three modes 0.15 apart, coupled by as much at the top of the ladder: the gap comes to its order below it only."""
    cosine = [[0.304, -1.065, 0.034], [-1.065, 0.773, -0.652], [0.034, -0.652, 0.262]]
    sine = [[-0.095, -0.871, 0.219], [-0.871, 0.891, -0.577], [0.219, -0.577, 1.093]]
    damping, stiffness = np.diag([0.102, 0.072, 0.087]), np.diag([1.603, 2.064, 2.516])
    system = PeriodicSystem(np.eye(3), np.zeros((3, 3)), damping, stiffness, [cosine], [sine])
    (verdict,) = (v for v in agreement(system, (3.15, 3.19), order=2, n_jobs=1, types=("sum",)) if v.label == "2ω₃")
    assert verdict.agrees, verdict.reason
    third = verdict.gap[:, :2] / verdict.eps[:2] ** 3
    np.testing.assert_allclose(third[:, 0], third[:, 1], rtol=0.3)  # at the top it is 40 % from rung to rung
