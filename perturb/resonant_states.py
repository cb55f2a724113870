"""The theory of a resonance by its effective matrix: second order in eps, and first order for repeated frequencies.

Second order adds frequency shift, curvature and the regions of j = j1 + j2. Its edges and growth rates have errors of
third order in eps and damping. The theory is in `perturb.expansion`.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from periodic import PeriodicSystem, SystemFamily
from periodic.checks import ComplexArray, FloatArray
from perturb.curve import Prediction
from perturb.expansion import EffectiveMatrix, ModalCouplings, effective_matrix, modal_couplings
from perturb.intervals import unstable_intervals
from perturb.modes import GyroscopicModes
from perturb.pair import pair_edges, pair_growth
from perturb.resonance import Resonance

# Step, as a part of Omega, for the derivative of an excitation that depends on Omega: its square, and rounding divided
# by it, stay far below the third-order terms left out.
DERIVATIVE_STEP = 1e-4

# A sum whose terms cancel to this part of their moduli is zero.
CANCELLED_PART = 1e-10

# The tip of a damped region is sought up to so many octaves above and below the eps at which excitation and damping
# balance, and there to half a unit in the tenth decimal.
TIP_OCTAVES = 6
TIP_BISECTIONS = 33

# At so many times its tip a damped region has the width of its asymptotes, to half the square of the inverse.
ASYMPTOTIC_TIPS = 1e4

# To see whether a region of an undamped system opens, the excitation moves its exponents by this part of Omega.
PROBE_RATE = 1e-3

# Where the excitation depends on Omega, every repetition of the solution for an edge gains one order in eps.
DRIFT_REPETITIONS = 3


class Expansion:
    """The modal couplings of a family, computed when a resonance asks for them."""

    def __init__(self, family: SystemFamily, modes: GyroscopicModes) -> None:
        self.family = family
        self.modes = modes
        self._latest: tuple[PeriodicSystem, ModalCouplings] | None = None

    def effective_matrix(self, resonance: Resonance, order: int) -> EffectiveMatrix:
        """Return the effective matrix of a resonance and of all that resonates with it."""
        centre = resonance.centre
        partner = resonance.q - 1 + (len(self.modes.frequencies) if resonance.type == "sum" else 0)
        pair = [(resonance.p - 1, 0), (partner, -resonance.j)]
        couplings = self._couplings(self.family.at(centre))
        if order == 1:
            return effective_matrix(couplings, pair, centre, order)
        step = DERIVATIVE_STEP * centre
        around = [self.family.at(centre + side * step) for side in (-1, 1)]
        slope = None
        if not same_excitation(*around):
            below, above = (modal_couplings(self.modes, system) for system in around)
            slope = ModalCouplings(above.omega, (above.E - below.E) / (2 * step), above.conservative)
        return effective_matrix(couplings, pair, centre, order, slope)

    def _couplings(self, system: PeriodicSystem) -> ModalCouplings:
        if self._latest is None or self._latest[0] is not system:
            self._latest = system, modal_couplings(self.modes, system)
        return self._latest[1]


def same_excitation(a: PeriodicSystem, b: PeriodicSystem) -> bool:
    """Whether two members of a family have equal excitation matrices."""
    return a is b or (np.array_equal(a.cosine, b.cosine) and np.array_equal(a.sine, b.sine))


@dataclass(frozen=True, eq=False)
class ResonantStates:
    """A resonance together with all states that resonate with it (`perturb.curve.Prediction`).

    Attributes
    ----------
    expansion : Expansion
    resonance : Resonance
    order : {1, 2}
    first : Prediction
        The less complete theory: for order 2 that of first order, for order 1 that of the pair alone.
    """

    expansion: Expansion
    resonance: Resonance
    order: int
    first: Prediction

    @cached_property
    def matrix(self) -> EffectiveMatrix:
        """The effective matrix of the resonant states."""
        return self.expansion.effective_matrix(self.resonance, self.order)

    @property
    def slope(self) -> float:
        if self.order == 2 or len(self.matrix.states) == 2 or np.isinf(self.tip):
            return self.first.slope
        eps = np.array(ASYMPTOTIC_TIPS * self.tip if self.tip > 0 else 1.0)
        low, high = self.edges(eps)
        return float((high - low) / (2 * eps))

    @cached_property
    def tip(self) -> float:
        C_p, C_q = self.expansion.modes.decay[[self.resonance.p - 1, self.resonance.q - 1]]
        once, twice = (float(np.abs(self.matrix.powers[k]).max()) for k in (1, 2))
        if once == twice == 0:
            return np.inf
        # at this eps the excitation moves the exponents by as much as damping, or by little against the frequencies
        rate = 0.5 * float(max(C_p, C_q)) if C_p * C_q > 0 else PROBE_RATE * self.resonance.centre
        eps = 2 * rate / (once + np.sqrt(once**2 + 4 * rate * twice))
        if C_p * C_q == 0:
            return 0.0 if self._is_open(eps) else np.inf
        ladder = eps * 2.0 ** np.arange(-TIP_OCTAVES, TIP_OCTAVES + 1)
        opened = next((value for value in ladder.tolist() if self._is_open(value)), np.inf)
        closed = 0.5 * opened
        for _ in range(TIP_BISECTIONS if np.isfinite(opened) else 0):
            middle = 0.5 * (closed + opened)
            closed, opened = (closed, middle) if self._is_open(middle) else (middle, opened)
        return opened

    def edges(self, eps: FloatArray) -> tuple[FloatArray, FloatArray]:
        if self._never_open:
            return np.full(eps.shape, np.nan), np.full(eps.shape, np.nan)
        if len(self.matrix.states) > 2:
            lower, upper = unstable_intervals(self.matrix, eps.ravel())
            return self.resonance.j * lower.reshape(eps.shape), self.resonance.j * upper.reshape(eps.shape)
        low, high = np.zeros(eps.shape), np.zeros(eps.shape)
        for _ in range(DRIFT_REPETITIONS if self.matrix.drift.any() else 1):
            low, high = self._edges_at(low, eps)[0], self._edges_at(high, eps)[1]
        return low, high

    def growth(self, s: FloatArray, eps: FloatArray) -> FloatArray:
        if len(self.matrix.states) > 2:
            return np.linalg.eigvals(self.matrix.at(s / self.resonance.j, eps)).real.max(axis=-1)
        C_p, C_q, L, shift = self._pair(s, eps)
        return pair_growth(C_p, C_q, L, s - shift)

    def _edges_at(self, s: FloatArray, eps: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the edges for the excitation as it is at the detunings ``s``."""
        C_p, C_q, L, shift = self._pair(np.where(np.isfinite(s), s, 0), eps)
        low, high = pair_edges(C_p, C_q, L)
        uncoupled = (L == 0) & (self.resonance.type == "difference")
        return np.where(uncoupled, np.nan, low + shift), np.where(uncoupled, np.nan, high + shift)

    @property
    def _never_open(self) -> bool:
        """Modes of equal energy sign cannot destabilise each other in a conservative system."""
        return self.resonance.type == "difference" and self.matrix.conservative

    def _is_open(self, eps: float) -> bool:
        if self._never_open:
            return False
        if len(self.matrix.states) > 2:
            return not np.isnan(unstable_intervals(self.matrix, np.array([eps]))[0][0])
        C_p, C_q, L, _ = self._pair(np.array(0.0), np.array(eps))
        return bool(np.abs(L) + L.real > 2 * C_p * C_q)

    def _pair(self, s: FloatArray, eps: FloatArray) -> tuple[FloatArray, FloatArray, ComplexArray, FloatArray]:
        """Return C_p, C_q, L and the shift of the centre in s that the 2 x 2 matrix amounts to."""
        matrix = self.matrix
        H = matrix.at(np.zeros_like(s), eps) + (eps * s / self.resonance.j)[..., None, None] * matrix.drift
        amplitude = np.abs(eps)[..., None, None]
        size = matrix.sizes[0] + amplitude * matrix.sizes[1] + amplitude**2 * matrix.sizes[2]
        decay = -2 * np.diagonal(H, axis1=-2, axis2=-1).real
        decay = np.where(np.abs(decay) <= CANCELLED_PART * np.diagonal(size, axis1=-2, axis2=-1), 0, decay)
        L = 4 * H[..., 0, 1] * H[..., 1, 0]
        is_real = np.abs(L.imag) <= 4 * CANCELLED_PART * size[..., 0, 1] * size[..., 1, 0]
        if matrix.conservative:
            decay, is_real = np.zeros_like(decay), True
        return decay[..., 0], decay[..., 1], np.where(is_real, L.real, L), (H[..., 0, 0] - H[..., 1, 1]).imag
