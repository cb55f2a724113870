"""Resonances of a system and the regions expected at them, as `trace_regions` hands them down."""

from __future__ import annotations

from floquet.boundary import Resonance, natural_modes, open_types, resonances
from floquet.regions.widths import Candidate, candidates
from periodic import PeriodicSystem


def resonances_of(system: PeriodicSystem, low: float, high: float) -> list[Resonance]:
    return resonances(natural_modes(system, (low + high) / 2), (low, high), open_types(system))


def candidates_of(
    system: PeriodicSystem, eps: float, low: float, high: float, some: list[Resonance] | None = None
) -> list[Candidate]:
    """Return the candidates of ``some`` resonances, by default of all between ``low`` and ``high``."""
    chosen = resonances_of(system, low, high) if some is None else some
    return candidates(system, natural_modes(system, (low + high) / 2), chosen, eps)
