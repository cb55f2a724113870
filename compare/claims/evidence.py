"""What a verdict on a claim rests on: comparisons of widths and places of regions, by theory and by integration.

A claim is broken down into findings. Each compares two quantities of named systems ("the width of ω₁+ω₃ on the middle
half" with "the width of ω₁+ω₃ under uniform load") by theory, and can be repeated by integration. Repeated are the
telling ones (`telling`): the clearest contradiction, and what holds most narrowly.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

from tqdm import tqdm

from compare.claims.quantities import Measured, Quantity, Region
from floquet.running import gather

# So many findings of a kind are tried until integration is decisive; regions that merge with others cannot be told.
MAX_TRACING_ATTEMPTS = 3


@dataclass(frozen=True, eq=False)
class Finding:
    """One instance of a claim: ``left`` is no larger than ``right``, or within ``tolerance`` of it.

    Attributes
    ----------
    part : str
        The part of the claim that it belongs to. Parts are for the reader; no verdict depends on them.
    left, right : Quantity
    tolerance : float or None
        None: the claim says left <= right. A number: the claim says that they are equal within this part of the larger.
    """

    part: str
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
    def regions(self) -> tuple[Region, ...]:
        """What integration has to trace to repeat it; none for plain numbers, such as stresses."""
        return (*self.left.regions, *self.right.regions)

    @property
    def is_measurable(self) -> bool:
        """Whether integration has something to say: not on plain numbers, nor on merged regions."""
        has_regions = self.left.measure is not None or self.right.measure is not None
        return has_regions and self.left.is_clear and self.right.is_clear

    def traced(self) -> Traced:
        """Return the finding repeated by integration."""
        left, right = self.left.measured(), self.right.measured()
        margin = self.margin(left.value, right.value)
        scale = max(abs(left.value), abs(right.value))
        error = (left.error + right.error) / scale if scale > 0 else 0.0
        both_closed = self.tolerance is None and self.right.predicted == 0 and left.value <= left.error
        return Traced(self, left, right, both_closed or margin >= 0, both_closed or abs(margin) > 2 * error)


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


def telling(findings: Sequence[Finding]) -> list[list[Finding]]:
    """Return which findings to repeat: those that contradict, clearest first, and those that hold, closest first.

    Of each list the first is repeated, the next only where integration cannot tell. The order of the findings and their
    parts do not matter.
    """
    measurable = [finding for finding in findings if finding.is_measurable]
    against = sorted((finding for finding in measurable if not finding.holds), key=_clearest_first)
    narrow = sorted((finding for finding in measurable if finding.holds), key=_closest_first)
    return [kind[:MAX_TRACING_ATTEMPTS] for kind in (against, narrow) if kind]


def trace_telling(all_findings: Sequence[Sequence[Finding]], n_jobs: int | None, progress: bool) -> list[list[Traced]]:
    """Return the telling ones of each sequence of findings, repeated by integration.

    Regions that several ask for are traced once, on all workers.
    """
    kinds = [telling(findings) for findings in all_findings]
    found: dict[tuple[int, int], Traced] = {}
    with tqdm(desc="claims: traces", unit="region", disable=not progress) as bar:
        for attempt in range(MAX_TRACING_ATTEMPTS):
            open_ones = {
                (i, k): kind[attempt]
                for i, of_one in enumerate(kinds)
                for k, kind in enumerate(of_one)
                if attempt < len(kind) and not ((i, k) in found and found[i, k].decisive)
            }
            wanted = {region.question: region for finding in open_ones.values() for region in finding.regions}
            gather(_trace, [(region,) for region in wanted.values()], n_jobs, bar)
            found |= {place: finding.traced() for place, finding in open_ones.items()}
    return [[found[i, k] for k in range(len(of_one))] for i, of_one in enumerate(kinds)]


def _trace(region: Region) -> None:
    """Trace a region, which keeps the result for all that ask for it."""
    _ = region.trace


def _clearest_first(finding: Finding) -> tuple[float, str, str]:
    return finding.predicted_margin, finding.left.name, finding.right.name


def _closest_first(finding: Finding) -> tuple[int, float, str, str]:
    """Sort what holds narrowly, but by more than first order leaves out, before what is too narrow to tell."""
    margin, names = finding.predicted_margin, (finding.left.name, finding.right.name)
    if finding.tolerance is not None or finding.right.predicted == 0:
        return (0, margin, *names)
    return (1, margin, *names) if margin > finding.left.eps else (2, -margin, *names)
