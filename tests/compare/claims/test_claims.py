"""The paper's claims: the rule of the verdict, what is traced, and that computation decides, not the program text."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from compare.claims import CLAIMS
from compare.claims.evidence import ClaimVerdict, Finding, Verdict, judged
from compare.claims.inplane import stress_equals_linear_load
from compare.claims.quantities import Measured, Quantity, number, regions, width
from compare.claims.regions import first_and_third_combine_most, higher_regions_smaller, no_difference_regions
from compare.claims.survey import ClaimRange, middle_part
from compare.claims.trends import damping_shrinks, narrower_load_shrinks
from plate import MovingPlate

# A plate of 3 x 5 coordinates and few variations: what a claim says of it is computed in a second or two.
SMALL = ClaimRange(
    plate=MovingPlate(inplane="static", axial_terms=3, lateral_terms=5, inplane_terms=(6, 6)),
    aspect_ratios=(1.0, 2.0),
    widths=(1.0, 0.5),
    speed_fractions=(0.7,),
    speeds=(3.0,),
    tensions=(10.0,),
    thickness_ratios=(0.01,),
    dampings=(1e-5,),
    amplitudes=(0.0025, 0.4),
)


def _quantity(predicted: float, measured: float | None = None, error: float = 1e-9) -> Quantity:
    value = Measured(predicted if measured is None else measured, error)
    return Quantity(f"q = {predicted}", predicted, lambda: value, eps=0.05)


def _finding(
    group: str, left: float, right: float, tolerance: float | None = None, measured: float | None = None
) -> Finding:
    """Return a finding whose left side integration finds to be ``measured``, and everything else as predicted."""
    return Finding(group, _quantity(left, measured), _quantity(right), tolerance)


def _judged(*findings: Finding) -> ClaimVerdict:
    return judged("name", "statement", "scope", findings)


def test_a_claim_holds_if_every_part_holds() -> None:
    verdict = _judged(_finding("a", 1, 2), _finding("a", 1, 3), _finding("b", 1.0, 1.01, tolerance=0.02))
    assert verdict.verdict is Verdict.HOLDS
    assert verdict.groups == {"a": (2, 2), "b": (1, 1)}
    assert verdict.is_decided
    assert not verdict.counter_examples


def test_a_claim_holds_with_limits_if_some_part_holds_throughout() -> None:
    verdict = _judged(_finding("a", 1, 2), _finding("b", 1, 2), _finding("b", 3, 2))
    assert verdict.verdict is Verdict.LIMITS
    assert verdict.is_decided
    assert [check.finding.left.predicted for check in verdict.counter_examples] == [3]


def test_a_claim_does_not_hold_if_every_part_has_a_contradiction() -> None:
    verdict = _judged(_finding("a", 1, 2), _finding("a", 3, 2), _finding("b", 1.0, 1.1, tolerance=0.02))
    assert verdict.verdict is Verdict.FAILS
    assert len(verdict.counter_examples) == 2


def test_the_clearest_contradiction_is_traced_or_else_the_closest_call() -> None:
    verdict = _judged(
        *[_finding("contradicted", left, 2) for left in (1, 2.5, 5, 3)],
        # 1.99 against 2 is closer than what first order leaves out at eps = 0.05, so that 1.5 is the closest to be told
        *[_finding("holds", left, 2) for left in (1, 1.99, 1.5)],
    )
    assert [check.finding.left.predicted for check in verdict.traced] == [5, 1.5]


def test_where_integration_cannot_tell_the_next_finding_is_tried() -> None:
    verdict = _judged(_finding("a", 5, 2, measured=math.nan), _finding("a", 3, 2))
    assert [check.finding.left.predicted for check in verdict.traced] == [3]
    assert verdict.is_decided


@pytest.mark.parametrize("measured", [1.0, math.nan])
def test_a_contradiction_that_integration_does_not_confirm_decides_nothing(measured: float) -> None:
    verdict = _judged(_finding("a", 3, 2, measured=measured), _finding("b", 1, 2))
    assert verdict.verdict is Verdict.LIMITS
    assert not verdict.counter_examples
    assert not verdict.is_decided


def test_a_difference_within_the_errors_is_not_decisive() -> None:
    finding = Finding("a", _quantity(2.1, error=0.2), _quantity(2.0))
    assert not _judged(finding).is_decided


def test_a_contradiction_in_plain_numbers_needs_one_that_can_be_traced() -> None:
    stresses = Finding("stresses", number("error", 0.3), number("allowed", 0.01))
    assert not _judged(stresses, _finding("b", 1, 2)).is_decided
    assert _judged(stresses, _finding("b", 3, 2)).is_decided


def test_plain_data_is_fit_for_json() -> None:
    verdict = _judged(_finding("a", 3, 2, measured=math.nan), _finding("b", 1, 2))
    data = json.loads(json.dumps(verdict.to_dict(), allow_nan=False))
    assert data["verdict"] == "holds with limits"
    assert data["traced"][0]["traced"] == [None, 2]
    assert data["groups"]["b"] == {"hold": 1, "of": 1}


def test_widths_are_twice_eps_times_the_reference_slopes(references: dict[str, Any]) -> None:
    # The slopes of the references have all digits; four sines leave about 1 % in those of modes 1 + 3 and 3 + 3.
    for part, name in ((1.0, "B uniform edge load, in-plane v=0"), (0.5, "C middle-half edge load 2f0, in-plane v=0")):
        slopes = references[f"static: {name}"]["a/b=1 V=3 f0=10"]["sqrtL"]
        found = regions("", MovingPlate(inplane="static", load=middle_part(part)), 0.05, modes=3)
        for (p, q), region in found.items():
            expected = 2 * 0.05 * float(slopes[f"{p}+{q}"])
            assert width(region).predicted == pytest.approx(expected, rel=0.015, abs=1e-9)


def test_regions_that_overlap_do_not_stand_alone() -> None:
    plate = MovingPlate(inplane="static")
    assert regions("", plate, 0.05, modes=3)[1, 1].stands_alone
    assert not regions("", plate, 3.0, modes=3)[1, 1].stands_alone


@pytest.mark.filterwarnings("ignore::plate.InPlaneGrowthWarning")  # known of the small plate
@pytest.mark.parametrize("claim", CLAIMS, ids=lambda claim: claim.__name__)
def test_every_claim_is_decided_on_a_small_plate(claim: Callable[[ClaimRange], ClaimVerdict]) -> None:
    verdict = claim(SMALL)
    assert verdict.is_decided
    assert verdict.findings
    assert verdict.traced
    assert "section" in verdict.statement
    json.dumps(verdict.to_dict(), allow_nan=False)


def test_the_verdict_on_higher_regions_depends_on_the_plate() -> None:
    assert higher_regions_smaller(replace(SMALL, aspect_ratios=(1.0,))).verdict is Verdict.HOLDS
    assert higher_regions_smaller(SMALL).verdict is Verdict.LIMITS


def test_the_verdict_on_linear_loads_depends_on_poissons_ratio() -> None:
    assert stress_equals_linear_load(replace(SMALL, poisson_ratios=(0.0,))).verdict is Verdict.HOLDS
    assert stress_equals_linear_load(replace(SMALL, poisson_ratios=(0.3,))).verdict is Verdict.FAILS


def test_the_verdict_on_damping_depends_on_its_size() -> None:
    # c = 1e-5 leaves eps = 0.05 well above the tip of 1 + 3, where damping widens it; c = 1e-3 closes 1 + 3.
    square = replace(SMALL, aspect_ratios=(1.0,))
    widened = damping_shrinks(square)
    assert widened.verdict is Verdict.LIMITS
    assert widened.groups["combination regions shrink"] == (0, 1)
    assert damping_shrinks(replace(square, dampings=(1e-3,))).verdict is Verdict.HOLDS


def test_the_counter_example_of_narrower_loads_is_the_known_one(references: dict[str, Any]) -> None:
    verdict = narrower_load_shrinks(replace(SMALL, aspect_ratios=(1.0,)))
    [check] = verdict.counter_examples
    slopes = [
        float(references[f"static: {name}"]["a/b=1 V=3 f0=10"]["sqrtL"]["1+3"])
        for name in ("C middle-half edge load 2f0, in-plane v=0", "B uniform edge load, in-plane v=0")
    ]
    # Three sines and five polynomials: a few per cent; the two differ by a factor of five.
    np.testing.assert_allclose([check.left.value, check.right.value], 2 * SMALL.eps * np.array(slopes), rtol=0.1)


def test_a_skew_load_opens_what_symmetry_closes() -> None:
    groups = first_and_third_combine_most(replace(SMALL, aspect_ratios=(1.0,))).groups
    assert groups["symmetric load; modes 1, 3 symmetric, mode 2 antisymmetric"] == (4, 4)
    held, total = groups["load not symmetric about the mid-line"]
    assert held < total


def test_difference_regions_would_be_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    # A theory that mistakes sums for differences must not pass as "no difference-type regions".
    from perturb import TransitionCurve

    def opened(self: TransitionCurve, eps: float) -> tuple[float, float]:
        return self.centre - eps, self.centre + eps

    monkeypatch.setattr(TransitionCurve, "edges", opened)
    verdict = no_difference_regions(replace(SMALL, aspect_ratios=(1.0,), eps=0.0625))  # an eps of its own: no cache
    assert verdict.verdict is Verdict.FAILS
    assert not verdict.is_decided


def test_integration_that_contradicts_theory_decides_nothing() -> None:
    verdict = _judged(_finding("a", 1, 2, measured=3))
    assert verdict.verdict is Verdict.HOLDS
    assert not verdict.is_decided
