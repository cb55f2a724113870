"""Which resonance a frequency means, of a system whose modes may depend on the frequency of the excitation."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

from floquet.boundary.resonance import (
    MAX_GUESS_DISTANCE,
    SIGNS,
    Modes,
    NoResonanceError,
    Resonance,
    natural_modes,
    nearest_resonance,
)
from periodic import AnyFamily, AnySystem, FirstOrderSystem, any_member_at
from periodic.checks import FloatArray

# Parts into which the neighbourhood of a question is divided; in each a resonance of moving modes has one centre.
NEIGHBOURHOOD_PARTS = 10
# A centre is exact to this part of it.
CENTRE_ROUNDING = 1e-14


class Question(NamedTuple):
    """A resonance, and the modes at its centre."""

    resonance: Resonance
    modes: Modes


def asked(
    family: AnyFamily, near: float, types: Collection[str], orders: Sequence[int], numbers: Collection[int]
) -> Question:
    """Return the resonance that ``near`` means; the other arguments are those of `nearest_resonance`.

    Where the system without excitation depends on Omega, as that of a rotor does, the centre solves
    j Omega = omega_p(Omega) ± omega_q(Omega), and the modes are those at the centre.

    Raises
    ------
    NoResonanceError
        If there is none within 5 % of ``near``.
    """
    member = any_member_at(family, near, "family")
    modes = natural_modes(member, near)
    low, high = ((1 + side * MAX_GUESS_DISTANCE) * near for side in (-1, 1))
    if member is family or _same(member, any_member_at(family, high, "family")):
        return Question(nearest_resonance(modes, near, types, orders, numbers), modes)
    count = len(modes.exponents)
    grid = np.linspace(low, high, NEIGHBOURHOOD_PARTS + 1)
    omega = np.array([_frequencies(family, Omega, count) for Omega in grid.tolist()])
    found = []
    for type in (type for type in SIGNS if type in types):
        for p in range(count):
            for q in range(p + (type == "sum")):
                total = omega[:, p] + SIGNS[type] * omega[:, q]
                for j in orders:
                    gap = j * grid - total
                    for k, (before, after) in enumerate(pairwise(gap.tolist())):
                        if before * after <= 0 and before != after and after:
                            centre = float(grid[k] + (grid[k + 1] - grid[k]) * before / (before - after))
                            found.append(Resonance(p + 1, q + 1, j, type, centre))
    resonance = nearest_resonance(modes, near, types, orders, numbers, found)
    p, q, j, type, guess = resonance

    def value(Omega: float) -> float:
        frequencies = _frequencies(family, Omega, count)
        return float(j * Omega - frequencies[p - 1] - SIGNS[type] * frequencies[q - 1])

    k = min(int((guess - low) / (high - low) * NEIGHBOURHOOD_PARTS), NEIGHBOURHOOD_PARTS - 1)
    centre = float(brentq(value, grid[k], grid[k + 1], rtol=CENTRE_ROUNDING))
    modes = natural_modes(any_member_at(family, centre, "family"), centre)
    if len(modes.exponents) != count:
        raise NoResonanceError(
            f"near = {near!r}: the number of modes that oscillate changes within {MAX_GUESS_DISTANCE:.0%} of it, from "
            f"{count} to {len(modes.exponents)} at the resonance; give {centre:.9g}"
        )
    return Question(resonance._replace(centre=centre), modes)


def _same(one: AnySystem, other: AnySystem) -> bool:
    """Return whether two members are the same without excitation."""
    return all(np.array_equal(a, b) for a, b in zip(_constant(one), _constant(other), strict=True))


def _constant(system: AnySystem) -> list[FloatArray]:
    if isinstance(system, FirstOrderSystem):
        return [system.constant]
    return [system.mass, system.gyroscopic, system.damping, system.stiffness]


def _frequencies(family: AnyFamily, Omega: float, count: int) -> FloatArray:
    """Return the frequencies at Omega in increasing order, ``count`` of them: those that vanish are zero."""
    found = np.sort(natural_modes(any_member_at(family, Omega, "family"), Omega).exponents.imag)[-count:]
    return np.concatenate([np.zeros(count - len(found)), found])
