"""All resonances of one place together: their regions in each subsystem, and the union of these."""

from __future__ import annotations

import numpy as np

from floquet.boundary.crowd import COINCIDENCE
from floquet.boundary.forcing import highest_harmonic
from floquet.boundary.region import Found, Region
from floquet.boundary.resonance import MAX_GUESS_DISTANCE, MAX_ORDER, Modes, Resonance, resonances
from floquet.boundary.solutions import Integrator, OutOfReachError
from floquet.boundary.walk import Edge
from floquet.kind import Kind
from periodic import AnyFamily

# Centres of different subsystems that differ by more than this part are never taken for coincident.
MAX_SPLIT = 1e-3
# Frequencies at which a place is looked at, as parts of its centre away from it.
LOOKS = (0.0, -1e-3, 1e-3)


class Place:
    """The place of a resonance: the region of its own subsystem, and those of coincident resonances of others.

    Parameters
    ----------
    family : AnyFamily
    resonance : Resonance
        The one asked for.
    modes : Modes
    """

    def __init__(self, family: AnyFamily, resonance: Resonance, modes: Modes) -> None:
        self.family, self.resonance, self.modes = family, resonance, modes
        centre, subsystem = resonance.centre, modes.subsystem
        self.coupled = bool(subsystem[resonance.p - 1] == subsystem[resonance.q - 1])
        harmonics = max(highest_harmonic(family.at(centre), MAX_ORDER), resonance.j)
        around = (1 - MAX_SPLIT) * centre, (1 + MAX_SPLIT) * centre
        self.orders = range(1, harmonics + 1)
        names = resonances(modes, around, orders=self.orders)
        own = int(subsystem[resonance.p - 1]) if self.coupled else -1
        self.own = Region(family, resonance, modes) if self.coupled else None
        self.others = [Region(family, name, modes) for name in names if subsystem[name.p - 1] != own]
        self.resonances = [resonance]

    def at(self, eps: float) -> Found:
        """Return what there is at an amplitude, and note which resonances it belongs to."""
        found = self._uncoupled(eps) if self.own is None else self.own.at(eps)
        joined = []
        if eps > 0:
            for region in self.others:
                other = region.at(eps)
                if self._joins(region.resonance.centre, other, found):
                    joined.append(other)
                    self._note([region.resonance])
        if self.own is not None:
            self._note(self._crowd(self.own, eps))
        return _union([found, *joined])

    def _joins(self, centre: float, other: Found, found: Found) -> bool:
        """Whether the region of another subsystem is one with that asked for: same centre, or nearer than wide."""
        here = self.resonance.centre
        if abs(centre - here) <= COINCIDENCE * here:
            return True
        return any(_covers(one, here) for one in other.intervals) or (
            bool(other.intervals) and any(_covers(one, centre) for one in found.intervals)
        )

    def _crowd(self, region: Region, eps: float) -> list[Resonance]:
        """Return the other resonances between the states of a crowd."""
        members, reach, _ = region.crowd(eps)
        if len(members) == 2:
            return []
        centre, exponents = self.resonance.centre, region.states.exponents[members]
        reach = max(min(reach, MAX_GUESS_DISTANCE * centre), COINCIDENCE * centre)
        inside = {
            number
            for number, exponent in enumerate(self.modes.exponents, 1)
            if np.abs(exponents - exponent).min() <= COINCIDENCE * centre
        }
        names = resonances(self.modes, (centre - reach, centre + reach), orders=self.orders)
        subsystem = self.modes.subsystem[self.resonance.p - 1]
        return [n for n in names if {n.p, n.q} <= inside and self.modes.subsystem[n.p - 1] == subsystem]

    def _note(self, names: list[Resonance]) -> None:
        self.resonances += [name for name in names if name not in self.resonances]

    def _uncoupled(self, eps: float) -> Found:
        """Return that two modes of different subsystems open nothing, having looked at both in their neighbourhood."""
        solutions = self.modes.solutions(self.resonance)
        exponents = self.modes.exponents[[self.resonance.p - 1, self.resonance.q - 1]]
        covered, centre = False, self.resonance.centre
        for solution in solutions.T:
            integrator = Integrator(self.family, solution, centre / (2 * np.pi))
            try:
                covered |= any(integrator.at((1 + part) * centre, eps).growth.max() > 0 for part in LOOKS)
            except OutOfReachError:
                covered = True
        return Found(Kind.STABLE, [], float(exponents.real.max()) if eps == 0 else np.nan, covered)


def _covers(interval: tuple[Edge, Edge], Omega: float) -> bool:
    return not (interval[0].Omega > Omega or interval[1].Omega < Omega)  # NaN: no edge on that side


def _union(parts: list[Found]) -> Found:
    """Return the union of what has been found in several subsystems."""
    kinds = [part for part in parts if part.kind > Kind.STABLE]
    most = max(kinds or parts, key=lambda part: np.nan_to_num(part.growth_rate, nan=-np.inf))
    kind = most.kind if kinds else min(part.kind for part in parts)
    ends = sorted((one for part in parts for one in part.intervals), key=lambda one: np.nan_to_num(one[0].Omega, nan=0))
    joined: list[tuple[Edge, Edge]] = []
    for lower, upper in ends:
        if joined and not lower.Omega > joined[-1][1].Omega:
            if not upper.Omega <= joined[-1][1].Omega:
                joined[-1] = joined[-1][0], upper
        else:
            joined.append((lower, upper))
    return Found(kind, joined, most.growth_rate, not joined and any(part.covered for part in parts))
