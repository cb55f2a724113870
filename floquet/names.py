"""Which resonance a region of instability starts from: its kind and its place as eps -> 0 against all resonances."""

from __future__ import annotations

from itertools import combinations, combinations_with_replacement
from typing import NamedTuple

import numpy as np
import scipy.linalg as sla

from floquet.multipliers import Kind
from floquet.reduction import constant_matrix, reduce_system
from floquet.resonance import HIGHEST_ORDER, SLOWEST
from periodic import PeriodicSystem

SUBSCRIPTS = str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉")


class Name(NamedTuple):
    """A resonance j Omega = omega_p ± omega_q of two modes that the excitation couples, p >= q.

    ``sign`` is +1 for a sum and -1 for a difference; ``centre`` is Omega.
    """

    p: int
    q: int
    j: int
    sign: int
    centre: float

    @property
    def kind(self) -> Kind:
        """How a region that starts from this resonance is unstable."""
        if self.p != self.q:
            return Kind.COMPLEX
        return Kind.PLUS_ONE if self.j % 2 == 0 else Kind.MINUS_ONE

    @property
    def label(self) -> str:
        """Name of the resonance: 2ω₁, ω₁+ω₃, ω₃−ω₁, for j > 1 2ω₁/2, (ω₁+ω₃)/2."""
        p, q = (f"ω{n}".translate(SUBSCRIPTS) for n in (self.p, self.q))
        if self.p == self.q:
            name = f"2{p}"
        else:
            total = f"{q}+{p}" if self.sign > 0 else f"{p}−{q}"
            name = total if self.j == 1 else f"({total})"
        return name if self.j == 1 else f"{name}/{self.j}"


def resonances(system: PeriodicSystem, low: float, high: float) -> list[Name]:
    """Return the resonances with low <= Omega <= high, by increasing order and frequency.

    Modes are numbered by increasing frequency; two modes of different blocks are not coupled and have no resonance.
    """
    found, homes = [], []
    for number, block in enumerate(reduce_system(system, 1.0, (low + high) / (4 * np.pi))):
        values = sla.eigvals(constant_matrix(block.equations))
        oscillating = values.imag[values.imag > SLOWEST * np.abs(values).max()]
        found += oscillating.tolist()
        homes += [number] * len(oscillating)
    order = np.argsort(found)
    omega, home = np.array(found)[order], np.array(homes)[order]
    modes = range(len(omega))
    pairs = [(p, q, 1) for q, p in combinations_with_replacement(modes, 2)]
    pairs += [(p, q, -1) for q, p in combinations(modes, 2)]
    names = [
        Name(p + 1, q + 1, j, sign, float(omega[p] + sign * omega[q]) / j)
        for p, q, sign in pairs
        for j in range(1, HIGHEST_ORDER + 1)
        if home[p] == home[q] and low <= (omega[p] + sign * omega[q]) / j <= high
    ]
    return sorted(names, key=lambda name: (name.j, name.centre))
