"""A resonance by itself, to first order in eps: eqs. (24)-(27)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from periodic.checks import ComplexArray, FloatArray
from perturb.pair import Detuning, pair_edges, pair_edges_vanishing, pair_growth, pair_slope, pair_tip


@dataclass(frozen=True, eq=False)
class ResonantPair:
    """A resonance to first order, nothing else being in resonance with it (`perturb.curve.Prediction`).

    Attributes
    ----------
    type : {"sum", "difference"}
    L : ndarray, shape (), complex
        Lambda_pq conj(Lambda_qp).
    C_p, C_q : ndarray, shape ()
        Decay coefficients of the two modes.
    detuning : Detuning
    eps_max : float
    vanishing : (c_p, c_q) or None
        Proportion in which the damping has vanished, for the literal eq. (25) at c = 0.
    """

    type: str
    L: ComplexArray
    C_p: FloatArray
    C_q: FloatArray
    detuning: Detuning
    eps_max: float
    vanishing: tuple[FloatArray, FloatArray] | None = None

    coincident: ClassVar[tuple[str, ...]] = ()
    isolated_up_to: ClassVar[float] = np.inf

    @property
    def slope(self) -> float:
        half = float(pair_slope(*(self.vanishing or (self.C_p, self.C_q)), self.L))
        if self.detuning.rate == 0:
            return np.inf if half else 0.0
        return half / abs(self.detuning.rate)

    @property
    def tip(self) -> float:
        return float(pair_tip(self.C_p, self.C_q, self.L))

    def edges(self, eps: FloatArray) -> tuple[FloatArray, FloatArray]:
        L = eps**2 * self.L
        if self.vanishing:
            low, high = pair_edges_vanishing(*self.vanishing, L)
        else:
            low, high = pair_edges(self.C_p, self.C_q, L)
        uncoupled = (L == 0) & (self.type == "difference")
        return self.detuning.between(np.where(uncoupled, np.nan, low), np.where(uncoupled, np.nan, high))

    def merged_edges(self, eps: FloatArray) -> tuple[FloatArray, FloatArray]:
        return self.edges(eps)

    def growth(self, x: FloatArray, eps: FloatArray) -> FloatArray:
        return pair_growth(self.C_p, self.C_q, eps**2 * self.L, self.detuning(x))
