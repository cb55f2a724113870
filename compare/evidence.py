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

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import StrEnum
from functools import cached_property, lru_cache
from typing import Any, Literal, NamedTuple

import numpy as np

from floquet import BoundaryTrace, Kind, trace_boundary
from perturb import TransitionCurve, gyroscopic_modes, transition_curves
from plate import MovingPlate

# A width below this part of the frequency is no width: ten times what tracing resolves.
CLOSED = 1e-8


class Verdict(StrEnum):
    """What became of a claim."""

    HOLDS = "holds"
    LIMITS = "holds with limits"
    FAILS = "does not hold"


class Measured(NamedTuple):
    """A number and its error; NaN where integration cannot tell."""

    value: float
    error: float


@dataclass(frozen=True, eq=False)
class Region:
    """One region of one system, at one eps, by theory and by integration."""

    system: str
    plate: MovingPlate
    curve: TransitionCurve
    eps: float

    @property
    def name(self) -> str:
        return f"{self.curve.label} of {self.system}"

    @cached_property
    def predicted(self) -> tuple[float, float]:
        """Lower and upper edge by theory; NaN where closed."""
        lower, upper = self.curve.edges(self.eps)
        return float(lower), float(upper)

    @cached_property
    def trace(self) -> BoundaryTrace:
        """The edges by integration."""
        return trace_boundary(self.plate, self.curve.centre, np.array([self.eps]))

    @property
    def is_open(self) -> bool:
        """Whether theory finds the region wide enough to be one."""
        lower, upper = self.predicted
        return upper - lower > CLOSED * self.curve.centre


@dataclass(frozen=True, eq=False)
class Quantity:
    """A number that theory predicts and integration can measure.

    Attributes
    ----------
    name : str
        What it is, of which region and system.
    predicted : float
        Value by theory.
    measure : callable or None
        Returns the value by integration and its error; None for a plain number.
    eps : float
        Amplitude at which it is taken.
    """

    name: str
    predicted: float
    measure: Callable[[], Measured] | None = None
    eps: float = 0.0

    def measured(self) -> Measured:
        return Measured(self.predicted, 0.0) if self.measure is None else self.measure()


def width(region: Region) -> Quantity:
    """Return the width of a region in Omega, 0 where it is closed; NaN by integration where it cannot be told."""

    def measure() -> Measured:
        trace = region.trace
        if trace.kind[0] == Kind.STABLE:
            return Measured(0.0, CLOSED * region.curve.centre)
        return Measured(float(trace.upper[0] - trace.lower[0]), float(trace.lower_error[0] + trace.upper_error[0]))

    lower, upper = region.predicted
    return Quantity(f"width of {region.name}", upper - lower if region.is_open else 0.0, measure, region.eps)


def middle(region: Region) -> Quantity:
    """Return the middle of an open region; NaN by integration where it is closed."""

    def measure() -> Measured:
        trace = region.trace
        error = float(trace.lower_error[0] + trace.upper_error[0]) / 2
        return Measured(float(trace.lower[0] + trace.upper[0]) / 2, error)

    return Quantity(f"middle of {region.name}", sum(region.predicted) / 2, measure, region.eps)


def number(name: str, value: float) -> Quantity:
    """Return a plain number, the same by theory and by integration."""
    return Quantity(name, value)


def part_of(quantity: Quantity, factor: float, name: str) -> Quantity:
    """Return ``factor`` times a quantity."""

    def measure() -> Measured:
        value, error = quantity.measured()
        return Measured(factor * value, factor * error)

    return Quantity(name, factor * quantity.predicted, measure, quantity.eps)


def distance(left: Quantity, right: Quantity, name: str) -> Quantity:
    """Return |left - right|."""

    def measure() -> Measured:
        a, b = left.measured(), right.measured()
        return Measured(abs(a.value - b.value), a.error + b.error)

    return Quantity(name, abs(left.predicted - right.predicted), measure, max(left.eps, right.eps))


@dataclass(frozen=True, eq=False)
class Finding:
    """One instance of a claim: ``left`` is smaller than ``right``, or within ``tolerance`` of it.

    Attributes
    ----------
    group : str
        The part of the claim that it belongs to.
    left, right : Quantity
    tolerance : float or None
        None: the claim says left < right (or that left is 0, where right is). A number: the claim says that they are
        equal within this part of right.
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

    @cached_property
    def predicted_margin(self) -> float:
        return self.margin(self.left.predicted, self.right.predicted)

    @property
    def holds(self) -> bool:
        """Whether theory bears the claim out here."""
        return self.predicted_margin >= 0

    @property
    def is_measurable(self) -> bool:
        """Whether integration has something to say: not on plain numbers, such as stresses."""
        return self.left.measure is not None or self.right.measure is not None


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
                    "traced": [check.left.value, check.right.value],
                    "errors": [check.left.error, check.right.error],
                    "holds": check.holds,
                    "confirms_theory": check.confirms,
                }
                for check in self.traced
            ],
        }


def regions(
    system: str,
    plate: MovingPlate,
    eps: float,
    *,
    modes: int,
    kind: Literal["sum", "difference"] = "sum",
    order: Literal[1, 2] = 1,
    interaction: Literal[1, 2] = 1,
) -> dict[tuple[int, int], Region]:
    """Return the regions among the lowest modes of a plate by (p, q), p <= q.

    ``interaction`` 1 are those that a harmonic opens by itself, j = 1; 2 those at half their frequencies, which two
    interactions with the first harmonic open together.
    """
    return {
        (curve.q, curve.p): Region(system, plate, curve, eps)
        for curve in _curves(plate, modes, kind, order)
        if max(curve.p, curve.q) <= modes and (curve.j, curve.interaction) == (interaction, interaction)
    }


@lru_cache(maxsize=1024)
def _curves(plate: MovingPlate, modes: int, kind: str, order: Literal[1, 2]) -> list[TransitionCurve]:
    """Return the curves of a plate, kept since many claims look at the same plates."""
    highest = float(gyroscopic_modes(plate.at(0.0)).frequencies[modes - 1])
    return transition_curves(plate, (0.0, 2.001 * highest), order, (kind,))


def judged(
    name: str,
    statement: str,
    scope: str,
    findings: Sequence[Finding],
    *,
    also: Sequence[Finding] = (),
) -> ClaimVerdict:
    """Repeat the telling findings by integration, those in ``also`` too, and return the verdict."""
    traced = tuple(_trace(finding) for finding in [*_telling(findings), *also])
    return ClaimVerdict(name, statement, scope, tuple(findings), traced)


def _telling(findings: Sequence[Finding]) -> list[Finding]:
    """Return of each group the finding that misses the claim most, or else the one that holds most narrowly.

    "Smaller" must hold by more than eps to count as narrow: what first order leaves out is that large a part.
    """
    groups: dict[str, list[Finding]] = {}
    for finding in findings:
        if finding.is_measurable:
            groups.setdefault(finding.group, []).append(finding)
    return [min(group, key=_closeness) for group in groups.values()]


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
