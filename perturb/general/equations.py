"""The equations of motion in the states of A_0, near a frequency Omega_0: what multiple scales expands.

With x = e^{lambda t} sum_h sum_a c_a^h r_a e^{i h Omega t} the equations are

    lambda c_a^h = (lam_a - i h Omega) c_a^h + sum of terms eps^m x^k V^{(l)} c^{h-l},     x = Omega - Omega_0,

with V^{(l)} = l_a A_ml r_b: Hill's infinite matrix. Damping is part of lam_a and need not be small.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from periodic import AnyFamily, AnySystem, PeriodicSystem, any_member_at
from periodic.checks import ComplexArray, FloatArray, is_positive_definite
from perturb.coupling import projection
from perturb.expansion import DERIVATIVE_STEP, DIFFERENCE_ROUNDING, ModalEquations, Term
from perturb.general.blocks import Blocks, Series, first_order_blocks, has_pulses
from perturb.general.eigenstates import Eigenstates, eigenstates
from perturb.resonance import Resonance


@dataclass(frozen=True, eq=False)
class GeneralEquations(ModalEquations):
    """`perturb.expansion.ModalEquations` for states that decay or grow, and for states that do not oscillate.

    Attributes
    ----------
    eigenvalues : ndarray, shape (N,)
        lam_a; ``omega`` are their imaginary parts.
    modes : int
        n: states a < n are the modes, n <= a < 2n their conjugates, the others do not oscillate.
    definite : bool
        The stiffness is positive definite: all modes have positive energy.
    """

    eigenvalues: ComplexArray
    modes: int
    definite: bool

    def states(self, resonance: Resonance) -> list[tuple[int, int]]:
        """Return the two states (a, h), a from 0, that make a resonance."""
        partner = resonance.q - 1 + (self.modes if resonance.type == "sum" else 0)
        return [(resonance.p - 1, 0), (partner, -resonance.j)]

    @cached_property
    def softness(self) -> FloatArray:
        """Part of its energy that the excitation moves in a state, per eps: largest 2 sum_j |V^{(j)}| / |lam|, (N,)."""
        size = 2 * self.excitation.sum(axis=0).max(axis=1, initial=0.0)
        rate = np.abs(self.eigenvalues)
        return np.divide(size, rate, out=np.full(len(rate), np.inf), where=rate > 0)


class GeneralExpansion:
    """The equations of a family at any frequency, computed when a resonance asks for them."""

    def __init__(self, family: AnyFamily) -> None:
        self._family = family
        self._latest: tuple[float, int, GeneralEquations] | None = None
        self._known: tuple[AnySystem, float, Blocks] | None = None
        self._shared: tuple[Blocks, Eigenstates] | None = None

    def blocks(self, Omega: float) -> Blocks:
        """Return the coefficients of the first-order form at Omega."""
        system = any_member_at(self._family, Omega, "family")
        if self._known is None or self._known[0] is not system or (self._known[1] != Omega and has_pulses(system)):
            self._known = system, Omega, first_order_blocks(system, Omega)
        return self._known[2]

    def modes_at(self, Omega: float) -> Eigenstates:
        """Return the states of the member at Omega."""
        blocks = self.blocks(Omega)
        if self._shared is None or not np.array_equal(self._shared[0].constant, blocks.constant):
            self._shared = blocks, eigenstates(any_member_at(self._family, Omega, "family"), blocks)
        return self._shared[1]

    def equations(self, centre: float, order: int) -> GeneralEquations:
        """Return the equations near ``centre``, with all terms of orders up to ``order``."""
        if self._latest is None or self._latest[:2] != (centre, order):
            self._latest = centre, order, self._equations(centre, order)
        return self._latest[2]

    def _equations(self, centre: float, order: int) -> GeneralEquations:
        states, here = self.modes_at(centre), self.blocks(centre)
        lam = states.eigenvalues
        # a diagonal term: damping acts within each state, exactly
        terms = [Term(1, 0, 0, 0, np.diag(lam.real).astype(complex))] if lam.real.any() else []
        for power, series in ((1, here.first), (2, here.second))[:order]:
            terms += [Term(power, power, 0, j, _couplings(states, A)) for j, A in series.items()]
        step = DERIVATIVE_STEP * centre
        below, above = (self.blocks(centre + side * step) for side in (-1, 1))
        if not below.equals(above):
            terms += _drift(states, below, here, above, step, order)
        harmonics = max([1, *(abs(term.harmonic) for term in terms)])
        kept = tuple(term for term in terms if term.V.any())
        system = any_member_at(self._family, centre, "family")
        conservative = here.conservative and not lam[: 2 * states.modes].real.any()
        definite = isinstance(system, PeriodicSystem) and is_positive_definite(system.stiffness)
        return GeneralEquations(lam.imag.copy(), kept, harmonics, conservative, lam, states.modes, definite)


def _couplings(states: Eigenstates, A: ComplexArray) -> ComplexArray:
    """Return l_a A r_b of all states, with exact zeros where symmetry leaves rounding."""
    return projection(states.left.conj().T, A, states.right)


def _drift(states: Eigenstates, below: Blocks, here: Blocks, above: Blocks, step: float, order: int) -> list[Term]:
    """Return the terms by which the equations change with x."""

    def term(order: int, power: int, drift: int, harmonic: int, change: ComplexArray, whole: ComplexArray) -> Term:
        V = states.left @ change @ states.right
        size = np.abs(states.left @ whole @ states.right).max()
        kept = np.where(np.abs(V) > DIFFERENCE_ROUNDING * size, V, 0)
        return Term(order, power, drift, harmonic, np.asarray(kept / step**drift, dtype=complex))

    def change(a: Series, b: Series, j: int) -> ComplexArray:
        zero = np.zeros(here.constant.shape, complex)
        return np.asarray(0.5 * (b.get(j, zero) - a.get(j, zero)))

    A, A_below, A_above = (blocks.constant.astype(complex) for blocks in (here, below, above))
    terms = [term(1, 0, 1, 0, 0.5 * (A_above - A_below), A)]
    if order == 2:
        terms.append(term(2, 0, 2, 0, 0.5 * (A_above + A_below) - A, A))
        terms += [term(2, 1, 1, j, change(below.first, above.first, j), here.first[j]) for j in here.first]
    return terms
