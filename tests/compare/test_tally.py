"""The tally: each region once, what was not compared apart, in one sentence."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from compare import Basis, Outcome, RegionAgreement, Tally, agreement
from periodic import PeriodicSystem
from periodic.examples import mathieu
from plate import MovingPlate

NONE, EDGES = np.empty(0), np.empty((2, 0))
ONE = RegionAgreement(
    label="2ω₁", type="sum", p=1, q=1, j=1, centre=2.0, eps=NONE, analytic=EDGES, traced=EDGES, traced_error=EDGES,
    gap=EDGES, order=NONE, width_ratio=NONE, outcome=Outcome.AGREES, basis=Basis.EDGES, reason="", compared="",
)  # fmt: skip


def _left(basis: Basis, q: int) -> RegionAgreement:
    return replace(ONE, outcome=Outcome.NOT_COMPARED, basis=basis, label=f"ω{q}", p=9, q=q)


def test_equal_systems_and_their_regions_count_once() -> None:
    plates = [MovingPlate(axial_terms=2, lateral_terms=2) for _ in range(3)]
    tally = Tally.of([(plate, [ONE, replace(ONE, label="2ω₂", p=2)]) for plate in plates])
    assert (tally.systems, tally.compared) == (1, 2)
    assert str(tally) == "2 regions compared, all agree"


def test_what_was_not_compared_is_counted_by_reason() -> None:
    closed = replace(ONE, label="ω₂−ω₁", type="difference", p=2, basis=Basis.CLOSED)
    left = [_left(Basis.UNCOUPLED, 1), _left(Basis.UNCOUPLED, 2), _left(Basis.DAMPED, 3)]
    tally = Tally.of([(mathieu(), [ONE, closed, *left])])
    assert str(tally) == (
        "1 region compared, all agree; 1 region closed by theory and integrated, none open; 3 not compared: "
        "2 uncoupled by symmetry or not excited, 1 closed by damping wherever the theory is meant"
    )
    assert tally.agrees
    assert tally.to_dict()["left"] == {Basis.UNCOUPLED.value: 2, Basis.DAMPED.value: 1}


@pytest.mark.parametrize("basis", [Basis.EDGES, Basis.CLOSED])
def test_one_disagreement_is_enough(basis: Basis) -> None:
    wrong = replace(ONE, outcome=Outcome.DISAGREES, basis=basis, label="2ω₂", p=2)
    tally = Tally.of([(mathieu(), [ONE, wrong])])
    assert (tally.wrong, tally.agrees) == (1, False)
    assert "1 DISAGREE" in str(tally) or "1 OPEN" in str(tally)


def test_nothing_compared_is_no_agreement() -> None:
    tally = Tally.of([(mathieu(), [_left(Basis.COINCIDENT, 1)])])
    assert not tally.agrees
    assert str(tally).startswith("NOTHING WAS COMPARED; 1 not compared")


def test_a_region_with_several_names_counts_once_and_its_worst_outcome_counts() -> None:
    shared = replace(ONE, coincident=("ω₂−ω₁",))
    other = replace(ONE, label="ω₂−ω₁", type="difference", coincident=("2ω₁",), outcome=Outcome.DISAGREES)
    tally = Tally.of([(mathieu(), [shared, other, replace(shared, outcome=Outcome.NOT_COMPARED)])])
    assert (tally.compared, tally.disagreeing, tally.left) == (1, 1, {})


def test_a_plate_that_spells_out_the_terms_it_would_choose_is_the_same_plate() -> None:
    chosen = MovingPlate()
    terms = chosen.terms
    spelled = MovingPlate(axial_terms=terms.axial, lateral_terms=terms.lateral, inplane_terms=terms.inplane)
    tally = Tally.of([(chosen, [ONE]), (spelled, [ONE])])
    assert (tally.systems, tally.compared) == (1, 1)


def test_agreement_lists_a_region_of_several_names_once() -> None:
    # two equal frequencies: 2 omega_1, omega_1 + omega_2 and 2 omega_2 are one region
    zero = np.zeros((2, 2))
    system = PeriodicSystem(np.eye(2), zero, zero, np.eye(2), [[[1.4, 0.3], [0.3, 0.6]]])
    (one,) = agreement(system, (1.9, 2.1), n_jobs=1)
    assert one.names == {"2ω₁", "ω₁+ω₂", "2ω₂"}
    assert one.agrees
