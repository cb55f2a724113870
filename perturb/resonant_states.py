"""The theory of a resonance by its effective matrix: second order, and first order where several resonate together.

Second order adds frequency shift, curvature and the regions of j = j1 + j2. Its edges and growth rates have errors of
third order in eps and damping. The theory is in `perturb.effective_matrix`.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from periodic.checks import ComplexArray, FloatArray
from perturb.curve import Prediction
from perturb.effective_matrix import EffectiveMatrix, effective_matrix, expansion_range
from perturb.expansion import Expansion
from perturb.intervals import Pair, Search
from perturb.pair import pair_edges, pair_growth
from perturb.resonance import Resonance

# A sum whose terms cancel to this part of their moduli is zero.
CANCELLED_PART = 1e-10

# The tip of a damped region is sought up to so many octaves above and below the eps at which excitation and damping
# balance, and there to half a unit in the tenth decimal.
TIP_OCTAVES = 6
TIP_BISECTIONS = 33

# At so many times its tip, or the eps at which it merges with others, a region has the width of its asymptotes, to half
# the square of the inverse.
ASYMPTOTIC_RATIO = 1e4

# Resonances are looked upon as one from the start if they merge below this part of the range of the expansion.
MERGING_PART = 0.1

# To see whether a region of an undamped system opens, the excitation moves its exponents by this part of Omega.
PROBE_RATE = 1e-3

# Where the equations depend on Omega, every repetition of the solution for an edge gains one order in eps.
DRIFT_REPETITIONS = 3


@dataclass(frozen=True, eq=False)
class ResonantStates:
    """A resonance together with all states that resonate with it (`perturb.curve.Prediction`).

    Attributes
    ----------
    expansion : Expansion
    resonance : Resonance
    order : {1, 2}
    multiples : collection of int
        The j of all resonances that have a name of their own.
    first : Prediction
        The less complete theory: for order 2 that of first order, for order 1 that of the resonance by itself.
    """

    expansion: Expansion
    resonance: Resonance
    order: int
    multiples: Collection[int]
    first: Prediction

    @cached_property
    def matrix(self) -> EffectiveMatrix:
        """The effective matrix of the resonant states."""
        equations = self.expansion.equations(self.resonance.centre, self.order)
        return effective_matrix(equations, self.resonance, self.order)

    @cached_property
    def eps_max(self) -> float:
        equations = self.expansion.equations(self.resonance.centre, 1)
        return float(expansion_range(equations, self.resonance.p, self.resonance.q))

    @cached_property
    def resonances(self) -> dict[Resonance, Pair]:
        """All resonances that the states make, this one first, and the states that make them."""
        found = {self.resonance: Pair(0, 1, self.resonance.p, self.resonance.q)}
        names = {self.resonance[:4]}
        for a in range(len(self.matrix.states)):
            for b in range(len(self.matrix.states)):
                other = self._resonance_of(a, b)
                if other is not None and other[:4] not in names:
                    names.add(other[:4])
                    found[other] = Pair(a, b, other.p, other.q)
        return found

    @cached_property
    def slope(self) -> float:
        if self.order == 2 or not self._is_merged:
            return self.first.slope
        if np.isinf(self.tip):
            return 0.0
        start = max(self.tip, self.isolated_up_to)
        eps = np.array(ASYMPTOTIC_RATIO * start if start > 0 else 1.0)
        low, high = self.edges(eps)
        return 0.0 if np.isnan(low) else float((high - low) / (2 * eps))

    @property
    def coincident(self) -> tuple[str, ...]:
        return tuple(resonance.label for resonance in self.resonances if resonance != self.resonance)

    @cached_property
    def isolated_up_to(self) -> float:
        if len(self.matrix.states) == 2:
            return np.inf
        apart = np.abs(self.matrix.detuning[2:])
        damping, excitation = (self._links(monomial) for monomial in ((0, 0), (1, 0)))
        with np.errstate(divide="ignore", invalid="ignore"):
            alone = np.where(excitation > 0, apart / (2 * excitation), np.inf)
        return float(np.where(damping > 0, 0.0, alone).min())

    @cached_property
    def tip(self) -> float:
        if self.order == 1 and len(self.matrix.states) == 2:
            return self.first.tip
        p, q = self.resonance.p - 1, self.resonance.q - 1
        C_p, C_q = self.expansion.modes_at(self.resonance.centre).decay[[p, q]]
        once, twice = (self._largest(power) for power in (1, 2))
        if once == twice == 0:
            return np.inf
        # at this eps the excitation moves the exponents by as much as damping, or by little against the frequencies
        rate = 0.5 * float(max(C_p, C_q)) if C_p * C_q > 0 else PROBE_RATE * self.resonance.centre
        eps = 2 * rate / (once + np.sqrt(once**2 + 4 * rate * twice))
        if C_p * C_q == 0:
            probes = eps, 0.01 * min(eps, self.isolated_up_to)
            return 0.0 if any(self._is_open(probe) for probe in probes if probe > 0) else np.inf
        ladder = eps * 2.0 ** np.arange(-TIP_OCTAVES, TIP_OCTAVES + 1)
        opened = next((value for value in ladder.tolist() if self._is_open(value)), np.inf)
        closed = 0.5 * opened
        for _ in range(TIP_BISECTIONS if np.isfinite(opened) else 0):
            middle = 0.5 * (closed + opened)
            closed, opened = (closed, middle) if self._is_open(middle) else (middle, opened)
        return opened

    def edges(self, eps: FloatArray) -> tuple[FloatArray, FloatArray]:
        return self._edges(eps, whole=False)

    def merged_edges(self, eps: FloatArray) -> tuple[FloatArray, FloatArray]:
        return self._edges(eps, whole=True)

    def _edges(self, eps: FloatArray, whole: bool) -> tuple[FloatArray, FloatArray]:
        if len(self.matrix.states) > 2 and (whole or not self._never_open):
            lower, upper = self._search(eps.ravel()).intervals(whole)
            return lower.reshape(eps.shape), upper.reshape(eps.shape)
        if self._never_open:
            return np.full(eps.shape, np.nan), np.full(eps.shape, np.nan)
        if self.order == 1:
            return self.first.edges(eps)
        return self._edges_of_pair(eps)

    def _edges_of_pair(self, eps: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the edges of two states, whose equations may change with Omega."""
        low, high = np.zeros(eps.shape), np.zeros(eps.shape)
        drifts = any(drift for _, drift in self.matrix.coefficients)
        for _ in range(DRIFT_REPETITIONS if drifts else 1):
            low, high = self._edges_at(low, eps)[0], self._edges_at(high, eps)[1]
        return low, high

    def growth(self, x: FloatArray, eps: FloatArray) -> FloatArray:
        if len(self.matrix.states) > 2:
            return np.linalg.eigvals(self.matrix.at(x, eps)).real.max(axis=-1)
        if self.order == 1:
            return self.first.growth(x, eps)
        return self._growth_of_pair(x, eps)

    def _growth_of_pair(self, x: FloatArray, eps: FloatArray) -> FloatArray:
        C_p, C_q, L, shift = self._alone(x, eps)
        return pair_growth(C_p, C_q, L, self.matrix.detuning_of_pair(x) - shift)

    def _edges_at(self, x: FloatArray, eps: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the edges for the equations as they are at ``x``."""
        C_p, C_q, L, shift = self._alone(np.where(np.isfinite(x), x, 0), eps)
        low, high = pair_edges(C_p, C_q, L)
        uncoupled = (L == 0) & (self.resonance.type == "difference")
        low, high = np.where(uncoupled, np.nan, low + shift), np.where(uncoupled, np.nan, high + shift)
        return self.matrix.detuning_of_pair.between(low, high)

    @property
    def _is_merged(self) -> bool:
        """Whether other resonances have to be looked upon as one with this."""
        return self.isolated_up_to < MERGING_PART * self.eps_max

    @property
    def _never_open(self) -> bool:
        """Modes of equal energy sign cannot destabilise each other in a conservative system."""
        return self.resonance.type == "difference" and self.matrix.conservative

    def _search(self, eps: FloatArray) -> Search:
        own, *others = self.resonances.items()
        opening = [pair for resonance, pair in others if resonance.type == "sum" or not self.matrix.conservative]
        return Search(self.matrix, [own[1], *opening], eps)

    def _is_open(self, eps: float) -> bool:
        if self._never_open:
            return False
        if len(self.matrix.states) > 2:
            return not np.isnan(self._search(np.array([eps])).intervals(whole=False)[0][0])
        C_p, C_q, L, _ = self._alone(np.array(0.0), np.array(eps))
        return bool(np.abs(L) + L.real > 2 * C_p * C_q)

    def _links(self, monomial: tuple[int, int]) -> FloatArray:
        """Return how strongly each further state is coupled to the first two, shape (m - 2,)."""
        V = np.abs(self.matrix.coefficients.get(monomial, np.zeros(2 * (len(self.matrix.states),))))
        return np.asarray(np.maximum(V[:2, 2:], V[2:, :2].T).max(axis=0))

    def _largest(self, power: int) -> float:
        """Return the largest coefficient of a power of eps."""
        return float(np.abs(self.matrix.coefficients.get((power, 0), np.zeros(1))).max())

    def _alone(self, x: FloatArray, eps: FloatArray) -> tuple[FloatArray, FloatArray, ComplexArray, FloatArray]:
        """Return C_p, C_q, L and the shift of the detuning that a 2 x 2 matrix amounts to."""
        matrix = self.matrix
        x, eps = np.broadcast_arrays(x, eps)
        H, size = np.zeros((*x.shape, 2, 2), dtype=complex), np.zeros((*x.shape, 2, 2))
        for (power, drift), coefficient in matrix.coefficients.items():
            factor = (eps**power * x**drift)[..., None, None]
            # what moves the frequencies alone is part of the detuning
            H += factor * (coefficient.real if power == 0 and drift > 0 else coefficient)
            size += np.abs(factor) * matrix.sizes[power, drift]
        decay = -2 * np.diagonal(H, axis1=-2, axis2=-1).real
        decay = np.where(np.abs(decay) <= CANCELLED_PART * np.diagonal(size, axis1=-2, axis2=-1), 0, decay)
        L = 4 * H[..., 0, 1] * H[..., 1, 0]
        is_real = np.abs(L.imag) <= 4 * CANCELLED_PART * size[..., 0, 1] * size[..., 1, 0]
        if matrix.conservative:
            decay, is_real = np.zeros_like(decay), True
        shift = (H[..., 0, 0] - H[..., 1, 1]).imag
        return decay[..., 0], decay[..., 1], np.where(is_real, L.real, L), shift

    def _resonance_of(self, a: int, b: int) -> Resonance | None:
        """Return the resonance that states a and b make, if it is one of those that have a name."""
        n = self.matrix.modes
        (nu_a, h_a), (nu_b, h_b) = self.matrix.states[[a, b]].tolist()
        j, (p, q) = h_a - h_b, (nu_a % n + 1, nu_b % n + 1)
        type = "sum" if (nu_a < n) != (nu_b < n) else "difference"
        higher_first = p >= q if nu_a < n else p < q
        if j not in self.multiples or (type == "difference" and (p == q or not higher_first)):
            return None
        detuning, rate = self.matrix.detuning[[a, b]], self.matrix.rate[[a, b]]
        centre = self.resonance.centre - float((detuning[0] - detuning[1]) / (rate[0] - rate[1]))
        return Resonance(max(p, q), min(p, q), j, type, centre)
