"""Regions counted once each: how many agree, how many do not, and how many were not compared, by reason."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any

from compare.outcome import Basis, Outcome, RegionAgreement, each_once
from periodic import AnyFamily
from plate import MovingPlate

# How a sentence names what was not compared, in this order.
REASONS = {
    Basis.UNCOUPLED: "uncoupled by symmetry or not excited",
    Basis.DAMPED: "closed by damping wherever the theory is meant",
    Basis.COINCIDENT: "in resonance together with others",
    Basis.UNSETTLED: "without a limit on the smallest eps",
    Basis.UNTRACED: "not to be traced",
}


@dataclass(frozen=True)
class Tally:
    """Different regions of different systems, counted by outcome.

    Attributes
    ----------
    systems : int
        Different systems.
    compared, disagreeing : int
        Regions whose edges were compared, and those of them that disagree.
    integrated, opened : int
        Regions that theory closes and integration looked for, and those of them that it finds open against theory.
    left : dict of Basis to int
        Regions that were not compared, by reason.
    """

    systems: int
    compared: int
    disagreeing: int
    integrated: int
    opened: int
    left: dict[Basis, int]

    @classmethod
    def of(cls, judged: Iterable[tuple[AnyFamily, Iterable[RegionAgreement]]]) -> Tally:
        """Count the regions of several systems.

        A system or a region that comes twice counts once. So does a region that several resonances share: it disagrees
        if it does so under one of its names.
        """
        regions: dict[AnyFamily, list[RegionAgreement]] = {}
        for family, verdicts in judged:
            regions.setdefault(identity(family), []).extend(verdicts)
        count = Counter((one.basis, one.outcome) for found in regions.values() for one in each_once(found))
        settled = (Outcome.AGREES, Outcome.DISAGREES)
        return cls(
            systems=len(regions),
            compared=sum(count[Basis.EDGES, outcome] for outcome in settled),
            disagreeing=count[Basis.EDGES, Outcome.DISAGREES],
            integrated=sum(count[Basis.CLOSED, outcome] for outcome in settled),
            opened=count[Basis.CLOSED, Outcome.DISAGREES],
            left={basis: count[basis, Outcome.NOT_COMPARED] for basis in REASONS if count[basis, Outcome.NOT_COMPARED]},
        )

    @property
    def agrees(self) -> bool:
        """Whether nothing disagrees and something was compared."""
        return not self.wrong and self.compared + self.integrated > 0

    @property
    def wrong(self) -> int:
        """Regions that disagree."""
        return self.disagreeing + self.opened

    def __str__(self) -> str:
        parts = []
        if self.compared:
            became = "all agree" if not self.disagreeing else f"{self.disagreeing} DISAGREE"
            parts.append(f"{_regions(self.compared)} compared, {became}")
        if self.integrated:
            became = "none open" if not self.opened else f"{self.opened} OPEN"
            parts.append(f"{_regions(self.integrated)} closed by theory and integrated, {became}")
        if self.left:
            reasons = ", ".join(f"{number} {REASONS[basis]}" for basis, number in self.left.items())
            parts.append(f"{sum(self.left.values())} not compared: {reasons}")
        if not self.compared + self.integrated:
            parts.insert(0, "NOTHING WAS COMPARED")
        return "; ".join(parts)

    def to_dict(self) -> dict[str, Any]:
        """Return plain numbers and strings, fit for JSON."""
        left = {basis.value: number for basis, number in self.left.items()}
        return {**vars(self), "left": left, "sentence": str(self)}


def identity(family: AnyFamily) -> AnyFamily:
    """Return what is equal for two descriptions of one system: a plate with the numbers of terms that it chose."""
    if not isinstance(family, MovingPlate):
        return family
    terms = family.terms
    return replace(family, axial_terms=terms.axial, lateral_terms=terms.lateral, inplane_terms=terms.inplane)


def _regions(number: int) -> str:
    return "1 region" if number == 1 else f"{number} regions"
