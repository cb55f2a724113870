"""Resonances j Omega = omega_p ± omega_q of a set of modes, numbered from 1."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from periodic.checks import FloatArray
from perturb.modes import REPEATED_FREQUENCY, GyroscopicModes

TYPES = ("sum", "difference")

_SUBSCRIPTS = str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉")


class Resonance(NamedTuple):
    """j Omega = omega_p + omega_q ("sum") or omega_p - omega_q ("difference").

    Attributes
    ----------
    p, q : int
        Numbers of the modes by increasing frequency, from 1; p >= q.
    j : int
        Multiple of the excitation frequency.
    type : {"sum", "difference"}
    centre : float
        Frequency Omega of the resonance, in the units of the system.
    """

    p: int
    q: int
    j: int
    type: str
    centre: float

    @property
    def label(self) -> str:
        """Name of the resonance: 2ω₁, ω₁+ω₃, ω₃−ω₁, for j > 1 2ω₁/2, (ω₁+ω₃)/2."""
        p, q = (f"ω{n}".translate(_SUBSCRIPTS) for n in (self.p, self.q))
        if self.p == self.q:
            name = f"2{p}"
        else:
            total = f"{q}+{p}" if self.type == "sum" else f"{p}−{q}"
            name = total if self.j == 1 else f"({total})"
        return name if self.j == 1 else f"{name}/{self.j}"


class Resonances(NamedTuple):
    """Many resonances as arrays of equal length, for what is computed of all of them at once."""

    p: NDArray[np.intp]
    q: NDArray[np.intp]
    j: NDArray[np.intp]
    type: NDArray[np.str_]
    centre: FloatArray

    @classmethod
    def of(cls, resonances: Sequence[Resonance]) -> Resonances:
        """Return the arrays of a list of resonances."""
        p, q, j = (np.array([row[i] for row in resonances], dtype=np.intp) for i in range(3))
        types = np.array([row.type for row in resonances], dtype=np.str_)
        return cls(p, q, j, types, np.array([row.centre for row in resonances], dtype=float))

    def at(self, places: NDArray[np.intp]) -> Resonances:
        """Return some of the resonances."""
        return Resonances(self.p[places], self.q[places], self.j[places], self.type[places], self.centre[places])

    def rows(self) -> Iterator[Resonance]:
        """Return one resonance after the other."""
        return (Resonance(*row) for row in zip(*(column.tolist() for column in self), strict=True))


def find_resonances(
    modes: GyroscopicModes, multiples: Sequence[int], Omega_range: tuple[float, float], types: Sequence[str]
) -> Resonances:
    """Return all resonances of p >= q and j in ``multiples`` with centre in the range, by increasing centre.

    Two modes of one repeated frequency have no difference.
    """
    omega = modes.frequencies
    p, q = np.tril_indices(len(omega))
    sign = np.array([1 if type == "sum" else -1 for type in types])
    total = omega[p] + sign[:, None] * omega[q]
    centre = total[:, None] / np.array(multiples)[:, None]  # [type, j, pair]
    total = np.broadcast_to(total[:, None], centre.shape)
    wanted = (total > REPEATED_FREQUENCY * omega[-1]) & (centre >= Omega_range[0]) & (centre <= Omega_range[1])
    by_centre = np.argsort(centre[wanted], kind="stable")
    of_type, of_j, pair = (index[by_centre] for index in np.nonzero(wanted))
    return Resonances(
        p[pair] + 1, q[pair] + 1, np.array(multiples)[of_j], np.array(types)[of_type], centre[wanted][by_centre]
    )
