"""Resonances j Omega = omega_p ± omega_q of any linear periodic system; omega_p and omega_q may depend on Omega."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from scipy.optimize import brentq

from periodic.checks import FloatArray
from perturb.general.equations import GeneralExpansion
from perturb.modes import REPEATED_FREQUENCY
from perturb.resonance import Resonance

# The range is divided into so many parts, in each of which a resonance has at most one centre; and a centre is exact to
# this part of it.
RANGE_PARTS = 96
CENTRE_ROUNDING = 1e-14

# Frequencies of a family at Omega = 0 are those at this part of the upper end: pulses have none at zero.
LOWEST_PART = 1e-6


def general_resonances(
    expansion: GeneralExpansion, multiples: Sequence[int], Omega_range: tuple[float, float], types: Sequence[str]
) -> list[Resonance]:
    """Return all resonances with centre in the range, by increasing centre; one for each solution.

    Parameters
    ----------
    expansion : GeneralExpansion
    multiples : sequence of int
        The j.
    Omega_range : (low, high)
    types : sequence of {"sum", "difference"}
    """
    low, high = max(Omega_range[0], LOWEST_PART * Omega_range[1]), Omega_range[1]
    fixed = all(
        np.array_equal(expansion.blocks(Omega).constant, expansion.blocks(high).constant)
        for Omega in (low, 0.5 * (low + high))
    )
    signs = [(type, 1 if type == "sum" else -1) for type in types]
    found = _of_fixed_modes if fixed else _of_moving_modes
    resonances = found(expansion, multiples, (low, high), signs)
    return sorted(resonances, key=lambda resonance: resonance.centre)


def _of_fixed_modes(
    expansion: GeneralExpansion, multiples: Sequence[int], window: tuple[float, float], signs: list[tuple[str, int]]
) -> list[Resonance]:
    omega = expansion.modes_at(window[1]).frequencies
    found = []
    for type, sign in signs:
        for p, q in zip(*np.tril_indices(len(omega), 0 if sign > 0 else -1), strict=True):
            total = float(omega[p] + sign * omega[q])
            if total > REPEATED_FREQUENCY * omega[-1]:
                centres = [(j, total / j) for j in multiples if window[0] <= total / j <= window[1]]
                found += [Resonance(int(p) + 1, int(q) + 1, j, type, centre) for j, centre in centres]
    return found


def _of_moving_modes(
    expansion: GeneralExpansion, multiples: Sequence[int], window: tuple[float, float], signs: list[tuple[str, int]]
) -> list[Resonance]:
    Omega = np.linspace(*window, RANGE_PARTS + 1)
    omega = np.array([_falling(expansion, one) for one in Omega.tolist()])
    found = []
    for type, sign in signs:
        rows = np.tril_indices(omega.shape[1], 0 if sign > 0 else -1)
        for q, p in zip(*(index.tolist() for index in rows), strict=True):  # p: the higher one
            total = omega[:, p] + sign * omega[:, q]
            for j in multiples:
                gap = j * Omega - total

                def value(at: float, j: int = j, p: int = p, q: int = q, sign: int = sign) -> float:
                    frequencies = _falling(expansion, at)
                    return float(j * at - frequencies[p] - sign * frequencies[q])

                for k, (before, after) in enumerate(pairwise(gap.tolist())):
                    if before * after > 0 or after == 0 or (before == 0 and k > 0 and gap[k - 1] == 0):
                        continue
                    centre = float(brentq(value, Omega[k], Omega[k + 1], rtol=CENTRE_ROUNDING))
                    modes = expansion.modes_at(centre).modes
                    if max(p, q) < modes:  # both oscillate
                        found.append(Resonance(modes - p, modes - q, j, type, centre))
    return found


def _falling(expansion: GeneralExpansion, Omega: float) -> FloatArray:
    """Return the frequencies by decreasing size, zero for what does not oscillate: continuous in Omega."""
    values = np.sort(np.linalg.eigvals(expansion.blocks(Omega).constant).imag)[::-1]
    return np.asarray(np.maximum(values[: len(values) // 2], 0.0))
