"""Resonances of a system and the regions expected at them, as `trace_regions` hands them down."""

from __future__ import annotations

from floquet.boundary import Resonance, natural_modes, open_types, resonances
from floquet.regions.widths import ExpectedTongue, expected_tongues
from periodic import PeriodicSystem


def resonances_of(system: PeriodicSystem, low: float, high: float) -> list[Resonance]:
    return resonances(natural_modes(system, (low + high) / 2), (low, high), open_types(system))


def tongues_expected(
    system: PeriodicSystem, eps: float, low: float, high: float, some: list[Resonance] | None = None
) -> list[ExpectedTongue]:
    """Return the tongues expected at ``some`` resonances, by default of all between ``low`` and ``high``."""
    chosen = resonances_of(system, low, high) if some is None else some
    return expected_tongues(system, natural_modes(system, (low + high) / 2), chosen, eps)
