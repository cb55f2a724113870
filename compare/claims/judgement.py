"""From instances to a verdict, and from verdicts to what a reader may conclude.

A verdict follows from how many of the instances hold, of how many, and from nothing else:

- holds: all of them;
- mostly holds: at least nine of ten;
- holds in part: fewer, but more than one of ten;
- does not hold: at most one of ten.

Every claim is judged in three scopes (`compare.claims.scopes.Scope`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

from compare.claims.evidence import Finding, Traced
from compare.claims.scopes import Scope

# Part of the instances from which on a claim mostly holds, and down to which it holds in part.
MOSTLY_SHARE = 0.9
PARTLY_SHARE = 0.1


class Verdict(StrEnum):
    """What became of a claim in one scope."""

    HOLDS = "holds"
    MOSTLY = "mostly holds"
    PARTLY = "holds in part"
    FAILS = "does not hold"


# What a reader may do with a claim, by its verdict over the wider range.
ADVICE = {
    Verdict.HOLDS: "a reader may rely on it",
    Verdict.MOSTLY: "a rule with exceptions",
    Verdict.PARTLY: "not a rule to rely on",
    Verdict.FAILS: "a reader should not believe it",
}


def verdict_of(held: int, total: int) -> Verdict:
    """Return the verdict if ``held`` of ``total`` instances hold."""
    if held == total:
        return Verdict.HOLDS
    if held >= MOSTLY_SHARE * total:
        return Verdict.MOSTLY
    return Verdict.PARTLY if held > PARTLY_SHARE * total else Verdict.FAILS


@dataclass(frozen=True)
class Instances:
    """A claim broken down over one scope.

    Attributes
    ----------
    where : str
        The plates, amplitudes and models, in words.
    findings : tuple of Finding
        Every instance, by theory.
    by_construction : str
        Why theory cannot but bear the claim out here; there are no findings then.
    """

    where: str
    findings: tuple[Finding, ...]
    by_construction: str = ""


@dataclass(frozen=True, eq=False)
class Judgement:
    """A claim in one scope.

    Attributes
    ----------
    scope : Scope
    instances : Instances
    traced : tuple of Traced
        The telling instances repeated by integration.
    """

    scope: Scope
    instances: Instances
    traced: tuple[Traced, ...]

    @property
    def findings(self) -> tuple[Finding, ...]:
        return self.instances.findings

    @property
    def held(self) -> int:
        """How many instances hold, by theory."""
        return sum(finding.holds for finding in self.findings)

    @property
    def total(self) -> int:
        return len(self.findings)

    @property
    def verdict(self) -> Verdict:
        """The rule of this module."""
        return Verdict.HOLDS if self.instances.by_construction else verdict_of(self.held, self.total)

    @property
    def percentage(self) -> str:
        """The part of the instances that hold; 0 % and 100 % only if it is none and all."""
        if self.instances.by_construction:
            return "by construction"
        share = 100 * self.held / self.total
        rounded = share if share in (0, 100) else min(max(round(share), 1), 99)
        return f"{rounded:.0f} %"

    @property
    def sentence(self) -> str:
        """Verdict and numbers, as a table shows them."""
        if self.instances.by_construction:
            return f"{self.verdict} by construction"
        return f"{self.verdict}, {self.held} of {self.total} ({self.percentage})"

    @property
    def parts(self) -> dict[str, tuple[int, int]]:
        """How many instances of each part of the claim hold, of how many."""
        counts: dict[str, tuple[int, int]] = {}
        for finding in self.findings:
            held, total = counts.get(finding.part, (0, 0))
            counts[finding.part] = (held + finding.holds, total + 1)
        return counts

    @property
    def counter_examples(self) -> tuple[Traced, ...]:
        """Instances that contradict the claim by theory and, decisively, by integration."""
        return tuple(check for check in self.traced if check.confirms and not check.holds)

    @property
    def is_decided(self) -> bool:
        """Whether integration confirms theory wherever it was asked, and a contradiction if there is one."""
        if self.instances.by_construction:
            return True
        confirmed = bool(self.traced) and all(check.confirms for check in self.traced)
        return confirmed and (self.held == self.total or bool(self.counter_examples))

    def to_dict(self) -> dict[str, Any]:
        """Return plain numbers and strings, fit for JSON."""
        return {
            "scope": self.scope.value,
            "where": self.instances.where,
            "verdict": self.verdict.value,
            "by_construction": self.instances.by_construction,
            "hold": self.held,
            "of": self.total,
            "decided": self.is_decided,
            "parts": {part: {"hold": held, "of": total} for part, (held, total) in self.parts.items()},
            "findings": [_finding(finding) for finding in self.findings],
            "traced": [
                _finding(check.finding)
                | {
                    "traced": [_finite(check.left.value), _finite(check.right.value)],
                    "errors": [_finite(check.left.error), _finite(check.right.error)],
                    "holds": check.holds,
                    "confirms_theory": check.confirms,
                }
                for check in self.traced
            ],
        }


@dataclass(frozen=True, eq=False)
class ClaimVerdict:
    """A claim of the paper and what computation says about it.

    Attributes
    ----------
    name : str
        Short name.
    statement : str
        What the paper says, in our words, and where.
    judgements : tuple of Judgement
        One for each `Scope`, in its order.
    """

    name: str
    statement: str
    judgements: tuple[Judgement, ...]

    def of(self, scope: Scope) -> Judgement:
        """Return the judgement in a scope."""
        [found] = [judgement for judgement in self.judgements if judgement.scope is scope]
        return found

    @property
    def is_decided(self) -> bool:
        """Whether integration confirms the verdict in every scope."""
        return all(judgement.is_decided for judgement in self.judgements)

    @property
    def counter_examples(self) -> tuple[Traced, ...]:
        """Those of every scope."""
        return tuple(check for judgement in self.judgements for check in judgement.counter_examples)

    @property
    def conclusion(self) -> str:
        """What a reader may conclude, in one sentence."""
        paper, literal, wider = (self.of(scope) for scope in Scope)
        parts = [f"in the paper's figures it {_said(paper)}"]
        if _said(literal) != _said(paper):
            parts.append(f"by (25) as printed, which its authors can have plotted, it {_said(literal)}")
        parts.append(f"over the wider range it {_said(wider)}")
        said = "; ".join(parts)
        advice = ADVICE[wider.verdict]
        if wider.verdict is Verdict.HOLDS and paper.verdict is not Verdict.HOLDS:
            advice += ", but not in these figures"
        return f"{said[0].upper()}{said[1:]}: {advice}."

    def to_dict(self) -> dict[str, Any]:
        """Return plain numbers and strings, fit for JSON."""
        return {
            "name": self.name,
            "statement": self.statement,
            "conclusion": self.conclusion,
            "decided": self.is_decided,
            "judgements": [judgement.to_dict() for judgement in self.judgements],
        }


def _said(judgement: Judgement) -> str:
    if judgement.instances.by_construction:
        return "holds by construction"
    return str(judgement.verdict) + ("" if judgement.held == judgement.total else f" ({judgement.percentage})")


def _finding(finding: Finding) -> dict[str, Any]:
    return {
        "part": finding.part,
        "left": finding.left.name,
        "right": finding.right.name,
        "predicted": [finding.left.predicted, finding.right.predicted],
        "tolerance": finding.tolerance,
        "holds": finding.holds,
    }


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None
