"""From instances to a verdict: a rule that no grouping changes, and what integration has to confirm."""

from __future__ import annotations

import json
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from compare.claims import Scope, Verdict, verdict_of
from compare.claims.evidence import Finding, telling, trace_telling
from compare.claims.judgement import ClaimVerdict, Instances, Judgement
from compare.claims.quantities import Measured, Quantity, number


def _quantity(predicted: float, measured: float | None = None, error: float = 1e-9) -> Quantity:
    value = Measured(predicted if measured is None else measured, error)
    return Quantity(f"q = {predicted}", predicted, lambda: value, eps=0.05)


def _finding(
    part: str, left: float, right: float, tolerance: float | None = None, measured: float | None = None
) -> Finding:
    """Return a finding whose left side integration finds to be ``measured``, and everything else as predicted."""
    return Finding(part, _quantity(left, measured), _quantity(right), tolerance)


def _judged(*findings: Finding, scope: Scope = Scope.WIDER) -> Judgement:
    [traced] = trace_telling([findings], 1, False)
    return Judgement(scope, Instances("somewhere", findings), tuple(traced))


def _claim(paper: Judgement, literal: Judgement, wider: Judgement) -> ClaimVerdict:
    return ClaimVerdict("name", "statement", (paper, literal, wider))


def _counted(scope: Scope, held: int, total: int) -> Judgement:
    findings = [_finding("a", 1 if k < held else 3, 2) for k in range(total)]
    return _judged(*findings, scope=scope)


@pytest.mark.parametrize(
    ("held", "total", "expected"),
    [
        (7, 7, Verdict.HOLDS),
        (999, 1000, Verdict.MOSTLY),
        (9, 10, Verdict.MOSTLY),
        (89, 100, Verdict.PARTLY),
        (11, 100, Verdict.PARTLY),
        (1, 10, Verdict.FAILS),
        (0, 3, Verdict.FAILS),
    ],
)
def test_a_verdict_follows_from_how_many_instances_hold(held: int, total: int, expected: Verdict) -> None:
    assert verdict_of(held, total) is expected


# Margins between -1 and 1 that first order tells, and the part of the claim that each belongs to.
INSTANCES = st.lists(
    st.tuples(st.floats(-0.9, 0.9).filter(lambda margin: abs(margin) > 0.06), st.sampled_from("abcd")),
    min_size=1,
    max_size=20,
    unique_by=lambda instance: instance[0],
)


@given(instances=INSTANCES, seed=st.randoms(use_true_random=False))
def test_no_order_or_grouping_changes_a_verdict(instances: list[tuple[float, str]], seed: object) -> None:
    """Permuted, split into parts of one, merged into one part: the same verdict, evidence and conclusion."""

    def judgement(grouped: list[tuple[float, str]]) -> Judgement:
        return _judged(*(_finding(part, 1 - max(m, 0), 1 + min(m, 0)) for m, part in grouped))

    def said(one: Judgement) -> object:
        told = [(check.finding.left.name, check.finding.right.name, check.holds) for check in one.traced]
        claim = _claim(*(Judgement(scope, one.instances, one.traced) for scope in Scope))
        return one.verdict, one.sentence, one.is_decided, told, claim.conclusion

    whole = judgement(instances)
    shuffled = list(instances)
    seed.shuffle(shuffled)  # type: ignore[attr-defined]
    assert whole.held == sum(margin > 0 for margin, _ in instances)
    assert said(judgement(shuffled)) == said(whole)
    assert said(judgement([(margin, str(k)) for k, (margin, _) in enumerate(instances)])) == said(whole)
    assert said(judgement([(margin, "all") for margin, _ in instances])) == said(whole)


def test_a_percentage_is_0_or_100_only_if_none_or_all_hold() -> None:
    assert _counted(Scope.WIDER, 299, 300).percentage == "99 %"
    assert _counted(Scope.WIDER, 1, 300).percentage == "1 %"
    assert _counted(Scope.WIDER, 3, 3).percentage == "100 %"
    assert _counted(Scope.WIDER, 0, 3).sentence == "does not hold, 0 of 3 (0 %)"


def test_parts_are_counted_for_the_reader() -> None:
    judgement = _judged(_finding("a", 1, 2), _finding("a", 3, 2), _finding("b", 1.0, 1.01, tolerance=0.02))
    assert judgement.parts == {"a": (1, 2), "b": (1, 1)}
    assert (judgement.held, judgement.total) == (2, 3)


def test_the_clearest_contradiction_and_the_closest_call_are_traced() -> None:
    judgement = _judged(
        *[_finding("contradicted", left, 2) for left in (1, 2.5, 5, 3)],
        # 1.99 against 2 is closer than what first order leaves out at eps = 0.05, so that 1.5 is the closest to be told
        *[_finding("holds", left, 2) for left in (1, 1.99, 1.5)],
    )
    assert [check.finding.left.predicted for check in judgement.traced] == [5, 1.5]
    assert judgement.is_decided
    assert [check.finding.left.predicted for check in judgement.counter_examples] == [5]


def test_where_integration_cannot_tell_the_next_finding_is_tried() -> None:
    judgement = _judged(_finding("a", 5, 2, measured=math.nan), _finding("a", 3, 2))
    assert [check.finding.left.predicted for check in judgement.traced] == [3]
    assert judgement.is_decided


@pytest.mark.parametrize("measured", [1.0, math.nan])
def test_a_contradiction_that_integration_does_not_confirm_decides_nothing(measured: float) -> None:
    judgement = _judged(_finding("a", 3, 2, measured=measured), _finding("b", 1, 2))
    assert judgement.verdict is Verdict.PARTLY
    assert not judgement.counter_examples
    assert not judgement.is_decided


def test_integration_that_contradicts_theory_decides_nothing() -> None:
    judgement = _judged(_finding("a", 1, 2, measured=3))
    assert judgement.verdict is Verdict.HOLDS
    assert not judgement.is_decided


def test_a_difference_within_the_errors_is_not_decisive() -> None:
    assert not _judged(Finding("a", _quantity(2.1, error=0.2), _quantity(2.0))).is_decided


def test_plain_numbers_need_an_instance_that_can_be_traced() -> None:
    stresses = Finding("stresses", number("error", 0.3), number("allowed", 0.01))
    assert not telling([stresses])
    assert not _judged(stresses).is_decided
    assert not _judged(stresses, _finding("b", 1, 2)).is_decided
    assert _judged(stresses, _finding("b", 3, 2)).is_decided


def test_what_cannot_fail_is_said_to_hold_by_construction() -> None:
    judgement = Judgement(Scope.LITERAL, Instances("somewhere", (), "first order knows nothing else"), ())
    assert judgement.verdict is Verdict.HOLDS
    assert judgement.is_decided
    assert judgement.sentence == "holds by construction"


def test_a_conclusion_names_what_differs_and_what_a_reader_may_do() -> None:
    holds = [_counted(scope, 4, 4) for scope in Scope]
    conclusion = _claim(*holds).conclusion
    assert conclusion == ("In the paper's figures it holds; over the wider range it holds: a reader may rely on it.")
    paper, literal, wider = _counted(Scope.PAPER, 2, 4), holds[1], _counted(Scope.WIDER, 19, 20)
    assert _claim(paper, literal, wider).conclusion == (
        "In the paper's figures it holds in part (50 %); by (25) as printed, which its authors can have plotted, it "
        "holds; over the wider range it mostly holds (95 %): a rule with exceptions."
    )
    assert "but not in these figures" in _claim(paper, literal, holds[2]).conclusion
    undecided = _judged(_finding("a", 1, 2, measured=3))
    assert not _claim(paper, literal, undecided).is_decided


def test_plain_data_is_fit_for_json() -> None:
    wider = _judged(_finding("a", 3, 2, measured=math.nan), _finding("b", 1, 2))
    paper, literal = (_counted(scope, 1, 1) for scope in (Scope.PAPER, Scope.LITERAL))
    data = json.loads(json.dumps(_claim(paper, literal, wider).to_dict(), allow_nan=False))
    judged = data["judgements"][2]
    assert judged["verdict"] == "holds in part"
    assert judged["traced"][0]["traced"] == [None, 2]
    assert judged["parts"]["b"] == {"hold": 1, "of": 1}
    assert (judged["hold"], judged["of"]) == (1, 2)
