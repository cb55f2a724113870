"""The theory of a resonance of any linear periodic system by its effective matrix, to first or second order.

    H_ab = D_a delta_ab + V_ab + 1/2 sum_c V_ac V_cb [1 / (D_a - D_c) + 1 / (D_b - D_c)],   D = lam_a - i h Omega,

is that of `perturb.effective_matrix`; here D has a real part as well, and V contains the direct terms of second order.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.sparse.csgraph import connected_components

from periodic.checks import ComplexArray, FloatArray
from perturb.coupling import IMAGINARY_PART
from perturb.effective_matrix import (
    EQUAL_FREQUENCY,
    MAX_RESONANT_STATES,
    NEAR_RESONANCE,
    EffectiveMatrix,
    State,
    expansion_range,
    resonant_states,
)
from perturb.general.equations import GeneralEquations, GeneralExpansion
from perturb.intervals import Search
from perturb.pair import Detuning, pair_slope
from perturb.resonance import Resonance
from perturb.resonant_pair import ResonantPair
from perturb.resonant_states import ResonantStates

Monomial = tuple[int, int]
Couplings = dict[Monomial, dict[int, ComplexArray]]  # by monomial and harmonic


@dataclass(frozen=True, eq=False)
class GeneralStates(ResonantStates):
    """A resonance of any linear periodic system with all states that resonate with it (`perturb.curve.Prediction`)."""

    expansion: GeneralExpansion  # type: ignore[assignment]

    @cached_property
    def matrix(self) -> EffectiveMatrix:
        equations = self.expansion.equations(self.resonance.centre, self.order)
        return general_matrix(equations, self.resonance, self.order)

    @cached_property
    def slope(self) -> float:
        """As `TransitionCurve.slope`; for a damped pair with complex L the real part of sqrt(L) counts."""
        if self.order == 2:
            return self.first.slope
        if len(self.matrix.states) > 2 and self._is_merged:
            return super().slope
        return first_order_slope(*first_order_pair(self.matrix), self.matrix.detuning_of_pair)

    @cached_property
    def tip(self) -> float:
        """As `TransitionCurve.tip`; 0 where a mode grows without excitation."""
        decay = -2 * np.diagonal(self.matrix.coefficients.get((0, 0), np.zeros((2, 2)))).real[:2]
        if (decay < 0).any():
            return 0.0
        return super().tip

    @cached_property
    def isolated_up_to(self) -> float:
        if len(self.matrix.states) == 2:
            return np.inf
        decay = np.diagonal(self.matrix.coefficients.get((0, 0), np.zeros(2 * (len(self.matrix.states),)))).real
        D = decay + 1j * self.matrix.detuning
        excitation = self._links((1, 0))
        with np.errstate(divide="ignore", invalid="ignore"):
            alone = np.abs(D[2:] - 0.5 * (D[0] + D[1])) / (2 * excitation)
        return float(np.where(excitation > 0, alone, np.inf).min())

    def growth(self, x: FloatArray, eps: FloatArray) -> FloatArray:
        if len(self.matrix.states) > 2:
            return super().growth(x, eps)
        return self._growth_of_pair(x, eps)

    def _edges(self, eps: FloatArray, whole: bool) -> tuple[FloatArray, FloatArray]:
        if len(self.matrix.states) > 2 or self._never_open:
            return super()._edges(eps, whole)
        return self._edges_of_pair(eps)

    @property
    def _never_open(self) -> bool:
        """Modes of equal energy sign cannot destabilise each other in a conservative system."""
        return super()._never_open and self._is_definite

    @property
    def _is_definite(self) -> bool:
        return self.expansion.equations(self.resonance.centre, self.order).definite

    def _search(self, eps: FloatArray) -> Search:
        if self._is_definite or not self.matrix.conservative:
            return super()._search(eps)
        return Search(self.matrix, list(self.resonances.values()), eps)

    def _resonance_of(self, a: int, b: int) -> Resonance | None:
        n = self.matrix.modes
        if (self.matrix.states[[a, b], 0] >= 2 * n).any():  # a state that does not oscillate has no number
            return None
        return super()._resonance_of(a, b)


def first_order_theory(expansion: GeneralExpansion, resonance: Resonance, multiples: set[int]) -> GeneralStates:
    """Return the theory of one resonance to first order."""
    equations = expansion.equations(resonance.centre, 1)
    matrix = effective_matrix_of(equations, equations.states(resonance), resonance.centre, 1)
    C_p, C_q, L = first_order_pair(matrix)
    eps_max = float(expansion_range(equations, resonance.p, resonance.q))
    pair = ResonantPair(resonance.type, L, C_p, C_q, matrix.detuning_of_pair, eps_max)
    return GeneralStates(expansion, resonance, 1, multiples, pair)


def first_order_pair(matrix: EffectiveMatrix) -> tuple[FloatArray, FloatArray, ComplexArray]:
    """Return C_p, C_q and L / eps^2 of the first two states."""
    zero = np.zeros(2 * (len(matrix.states),), dtype=complex)
    decay = -2 * np.diagonal(matrix.coefficients.get((0, 0), zero)).real
    V = matrix.coefficients.get((1, 0), zero)
    L = 4 * V[0, 1] * V[1, 0]
    return (
        decay[0],
        decay[1],
        np.asarray(L.real if matrix.conservative or abs(L.imag) <= IMAGINARY_PART * abs(L) else L),
    )


def first_order_slope(C_p: FloatArray, C_q: FloatArray, L: ComplexArray, detuning: Detuning) -> float:
    """Return d(half width) / d eps as eps grows, shape ()."""
    if C_p > 0 and C_q > 0:
        L = np.asarray(np.sqrt(complex(L)).real ** 2)
    half = float(pair_slope(C_p, C_q, L))
    if detuning.rate == 0:
        return np.inf if half else 0.0
    return half / abs(detuning.rate)


def general_matrix(equations: GeneralEquations, resonance: Resonance, order: int) -> EffectiveMatrix:
    """Return the effective matrix of a resonance, with all states that resonate with it.

    They are those of `perturb.effective_matrix.resonant_states` whose decay is near that of the pair, too: what decays
    much faster only acts on the pair.
    """
    pair = equations.states(resonance)
    reach = float(expansion_range(equations, resonance.p, resonance.q))
    rate = equations.eigenvalues.real
    states = list(pair)
    for nu, h in resonant_states(equations, resonance, order)[2:]:
        apart = min(abs(rate[nu] - rate[mu]) for mu, _ in pair)
        bridged = NEAR_RESONANCE * resonance.centre
        if order == 1:
            bridged = 2 * (reach if np.isfinite(reach) else 0.0) * float(equations.strongest[nu])
        if apart <= max(bridged, EQUAL_FREQUENCY * resonance.centre):
            states.append((nu, h))
    matrix = effective_matrix_of(equations, states, resonance.centre, order)
    linked = np.sum(list(matrix.sizes.values()), axis=0) > 0 if matrix.sizes else np.zeros((2, 2))
    _, component = connected_components(linked, directed=False)
    # a pair that nothing links with each other is left alone
    return matrix if component[0] == component[1] else effective_matrix_of(equations, pair, resonance.centre, order)


def effective_matrix_of(equations: GeneralEquations, states: list[State], centre: float, order: int) -> EffectiveMatrix:
    """Return the effective matrix of ``states``."""
    nu, h = np.array(states).T
    D = equations.eigenvalues[nu] - 1j * h * centre
    m, N = len(nu), len(equations.eigenvalues)
    values: dict[Monomial, ComplexArray] = {}
    sizes: dict[Monomial, FloatArray] = {}

    def add(monomial: Monomial, left: ComplexArray, right: ComplexArray) -> None:
        values[monomial] = values.get(monomial, np.zeros((m, m), dtype=complex)) + left @ right
        sizes[monomial] = sizes.get(monomial, np.zeros((m, m))) + np.abs(left) @ np.abs(right)

    for term in equations.terms:
        if term.order <= order:
            V = np.where(h[:, None] - h == term.harmonic, term.V[nu[:, None], nu], 0)
            add((term.power, term.drift), V, np.eye(m, dtype=complex))
    couplings = _first_order_couplings(equations) if order == 2 else {}
    # of a chain that was cut off the next link is near; it is left out
    nearest = (NEAR_RESONANCE**2 if m >= MAX_RESONANT_STATES else EQUAL_FREQUENCY) * centre
    reached = sorted({int(h_a) - j for h_a in h for series in couplings.values() for j in series})
    for k in reached:  # all states c = (mu, k)
        gap = D[:, None] - (equations.eigenvalues - 1j * k * centre)
        far = np.abs(gap) > nearest
        far[:, nu[h == k]] = False  # resonant states
        weight = np.divide(0.5, gap, out=np.zeros(gap.shape, dtype=complex), where=far)
        to, back = ({name: _rows(series, nu, h, k, side, N) for name, series in couplings.items()} for side in (1, -1))
        for (power, drift), V_ac in to.items():
            for (power_2, drift_2), V_cb in back.items():
                add((power + power_2, drift + drift_2), V_ac * weight, V_cb)
                add((power + power_2, drift + drift_2), V_ac, V_cb * weight.T)
    detuning = equations.omega[nu] - h * centre
    return EffectiveMatrix(
        np.array(states), detuning - detuning[0], values, sizes, centre, equations.modes, equations.conservative
    )


def _first_order_couplings(equations: GeneralEquations) -> Couplings:
    """Return the couplings of first order between different states, by monomial and harmonic."""
    found: Couplings = {}
    for term in equations.terms:
        if term.order == 1 and (term.power, term.drift) != (0, 0):  # damping couples no two states
            series = found.setdefault((term.power, term.drift), {})
            series[term.harmonic] = series.get(term.harmonic, 0) + term.V
    return found


def _rows(
    series: dict[int, ComplexArray], nu: ComplexArray, h: ComplexArray, k: int, side: int, N: int
) -> ComplexArray:
    """Return V from all states (mu, k) to the states (nu, h), shape (m, N); side -1: the other way, shape (N, m)."""
    zero = np.zeros((N, N), dtype=complex)
    blocks = [series.get(side * (int(h_a) - k), zero) for h_a in h]
    if side > 0:
        return np.array([block[a] for block, a in zip(blocks, nu, strict=True)])
    return np.array([block[:, a] for block, a in zip(blocks, nu, strict=True)]).T
