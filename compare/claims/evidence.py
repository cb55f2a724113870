"""What a verdict on a claim rests on: comparisons of widths and places of regions, by theory and by integration.

A claim is broken down into findings. Each compares two quantities of named systems ("the width of ω₁+ω₃ on the middle
half" with "the width of ω₁+ω₃ under uniform load") by theory, and can be repeated by integration. Findings are gathered
into groups, the parts of the claim ("main regions shrink", "combination regions shrink"), and the verdict follows from
the groups by one rule for every claim:

- holds: every finding of every group holds;
- holds with limits: every finding of at least one group holds, but not of all groups;
- does not hold: no group holds throughout.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from functools import cached_property
from typing import Any

from compare.claims.quantities import Measured, Quantity

# So many findings of a group are tried until integration is decisive; regions that merge with others cannot be told.
MAX_TRACING_ATTEMPTS = 3


class Verdict(StrEnum):
    """What became of a claim."""

    HOLDS = "holds"
    LIMITS = "holds with limits"
    FAILS = "does not hold"


@dataclass(frozen=True, eq=False)
class Finding:
    """One instance of a claim: ``left`` is no larger than ``right``, or within ``tolerance`` of it.

    Attributes
    ----------
    group : str
        The part of the claim that it belongs to.
    left, right : Quantity
    tolerance : float or None
        None: the claim says left <= right. A number: the claim says that they are equal within this part of the larger.
    """

    group: str
    left: Quantity
    right: Quantity
    tolerance: float | None = None

    def margin(self, left: float, right: float) -> float:
        """Return by which part of the larger number the claim holds (> 0) or is missed (< 0)."""
        scale = max(abs(left), abs(right))
        if scale == 0:
            return 0.0
        if self.tolerance is None:
            return (right - left) / scale
        return self.tolerance - abs(right - left) / scale

    @property
    def relation(self) -> str:
        """What the claim says of left and right."""
        return "≤" if self.tolerance is None else f"within {100 * self.tolerance:g} % of"

    @cached_property
    def predicted_margin(self) -> float:
        return self.margin(self.left.predicted, self.right.predicted)

    @property
    def holds(self) -> bool:
        """Whether theory bears the claim out here."""
        return self.predicted_margin >= 0

    @property
    def is_measurable(self) -> bool:
        """Whether integration has something to say: not on plain numbers, such as stresses, nor on merged regions."""
        has_regions = self.left.measure is not None or self.right.measure is not None
        return has_regions and self.left.is_clear and self.right.is_clear


@dataclass(frozen=True, eq=False)
class Traced:
    """A finding repeated by integration.

    Attributes
    ----------
    finding : Finding
    left, right : Measured
        The two quantities by integration.
    holds : bool
        Whether integration bears the claim out here.
    decisive : bool
        Whether it says so by more than its errors.
    """

    finding: Finding
    left: Measured
    right: Measured
    holds: bool
    decisive: bool

    @property
    def confirms(self) -> bool:
        """Whether integration decides as theory does."""
        return self.decisive and self.holds == self.finding.holds


@dataclass(frozen=True, eq=False)
class ClaimVerdict:
    """A claim of the paper and what computation says about it.

    Attributes
    ----------
    name : str
        Short name.
    statement : str
        What the paper says, in our words, and where.
    scope : str
        The range of parameters over which it was judged.
    findings : tuple of Finding
        Every instance, by theory.
    traced : tuple of Traced
        The instances repeated by integration: of each group the clearest contradiction, or else the closest call.
    """

    name: str
    statement: str
    scope: str
    findings: tuple[Finding, ...]
    traced: tuple[Traced, ...]

    @property
    def groups(self) -> dict[str, tuple[int, int]]:
        """How many findings of each group hold, of how many."""
        counts: dict[str, tuple[int, int]] = {}
        for finding in self.findings:
            held, total = counts.get(finding.group, (0, 0))
            counts[finding.group] = (held + finding.holds, total + 1)
        return counts

    @property
    def held(self) -> int:
        """How many findings hold, by theory."""
        return sum(finding.holds for finding in self.findings)

    @property
    def verdict(self) -> Verdict:
        """The rule of this module."""
        throughout = [held == total for held, total in self.groups.values()]
        return Verdict.HOLDS if all(throughout) else Verdict.LIMITS if any(throughout) else Verdict.FAILS

    @property
    def counter_examples(self) -> tuple[Traced, ...]:
        """Findings that contradict the claim by theory and, decisively, by integration."""
        return tuple(check for check in self.traced if check.confirms and not check.holds)

    @property
    def is_decided(self) -> bool:
        """Whether integration confirms the verdict: every traced finding, and each contradiction by at least one."""
        confirmed = all(check.confirms for check in self.traced)
        return confirmed and (self.verdict is Verdict.HOLDS or bool(self.counter_examples))

    def to_dict(self) -> dict[str, Any]:
        """Return plain numbers and strings, fit for JSON."""
        return {
            "name": self.name,
            "statement": self.statement,
            "scope": self.scope,
            "verdict": self.verdict.value,
            "decided": self.is_decided,
            "groups": {group: {"hold": held, "of": total} for group, (held, total) in self.groups.items()},
            "findings": [
                {
                    "group": finding.group,
                    "left": finding.left.name,
                    "right": finding.right.name,
                    "predicted": [finding.left.predicted, finding.right.predicted],
                    "tolerance": finding.tolerance,
                    "holds": finding.holds,
                }
                for finding in self.findings
            ],
            "traced": [
                {
                    "left": check.finding.left.name,
                    "right": check.finding.right.name,
                    "predicted": [check.finding.left.predicted, check.finding.right.predicted],
                    "traced": [_finite(check.left.value), _finite(check.right.value)],
                    "errors": [_finite(check.left.error), _finite(check.right.error)],
                    "holds": check.holds,
                    "confirms_theory": check.confirms,
                }
                for check in self.traced
            ],
        }


def judged(
    name: str,
    statement: str,
    scope: str,
    findings: Sequence[Finding],
    *,
    also: Sequence[Finding] = (),
) -> ClaimVerdict:
    """Repeat the telling findings by integration, those in ``also`` too, and return the verdict."""
    groups: dict[str, list[Finding]] = {}
    for finding in findings:
        if finding.is_measurable:
            groups.setdefault(finding.group, []).append(finding)
    traced = [_tell(group) for group in groups.values()] + [_trace(finding) for finding in also]
    return ClaimVerdict(name, statement, scope, tuple(findings), tuple(traced))


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _tell(group: Sequence[Finding]) -> Traced:
    """Trace the finding that misses the claim most, or else the one that holds most narrowly; the next if undecided."""
    first, *others = sorted(group, key=_closeness)[:MAX_TRACING_ATTEMPTS]
    check = _trace(first)
    for finding in others:
        if check.decisive:
            break
        check = _trace(finding)
    return check


def _closeness(finding: Finding) -> tuple[int, float]:
    """Sort contradictions first, the clearest leading; then what holds narrowly; last what is too narrow to tell."""
    margin = finding.predicted_margin
    if margin < 0 or finding.tolerance is not None or finding.right.predicted == 0:
        return 0, margin
    return (1, margin) if margin > finding.left.eps else (2, -margin)


def _trace(finding: Finding) -> Traced:
    left, right = finding.left.measured(), finding.right.measured()
    margin = finding.margin(left.value, right.value)
    scale = max(abs(left.value), abs(right.value))
    error = (left.error + right.error) / scale if scale > 0 else 0.0
    both_closed = finding.tolerance is None and finding.right.predicted == 0 and left.value <= left.error
    return Traced(finding, left, right, both_closed or margin >= 0, both_closed or abs(margin) > 2 * error)
