"""The effective matrix of a resonance: the few states that resonate together, to first or second order.

A state is a pair (nu, h). The states in resonance have almost equal omega_nu - h Omega and are treated exactly. All
other states act on them through the second-order sum of quasi-degenerate perturbation theory, in Van Vleck's form,
which is symmetric in the two resonant states:

    H_ab = D_a delta_ab + V_ab + 1/2 sum_c V_ac V_cb [1 / (D_a - D_c) + 1 / (D_b - D_c)],   D = i (omega_nu - h Omega).

The eigenvalues of H are the exponents lambda, with an error of third order in eps and damping. Without the sum they are
the first-order result; for a pair of states alone that is eqs. (25) and (27).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.sparse.csgraph import connected_components

from periodic.checks import ComplexArray, FloatArray
from perturb.expansion import ModalEquations, Term
from perturb.pair import Detuning
from perturb.resonance import Resonance, Resonances

# To second order two states resonate together if their frequencies differ by less than this part of Omega, a fifth of
# the distance between neighbouring harmonics of one mode. For a state that the excitation couples less than others the
# limit is lower in proportion, so that no term of the second-order sum exceeds V^2 / (NEAR_RESONANCE Omega), V the
# strongest.
NEAR_RESONANCE = 0.2

# Part of the energy of a mode that the excitation may move (the relative change of the square of its frequency), up to
# which the expansion in eps is meant.
EXPANSION_RANGE = 0.3

# To first order damping makes two modes act together if it splits them, by twice its coupling, by this part of what
# they are apart.
DAMPING_SPLIT = 0.1

# Modes that change with Omega act together if over this part of Omega, a wide region, they change by their difference.
REACH_OF_DETUNING = 0.05

# Frequencies of states that differ by less than this part of Omega are equal, to rounding of the modes.
EQUAL_FREQUENCY = 1e-9

# At most so many states are treated as resonant together. Chains of resonances are longer (the frequencies of a string
# are all multiples of the first); what is cut off lies several interactions away from the pair that names the region.
MAX_RESONANT_STATES = 12

# Least divisor of a quotient that has to stay finite.
SMALLEST_NORMAL = float(np.finfo(float).tiny)

State = tuple[int, int]
Monomial = tuple[int, int]  # powers of eps and of x


@dataclass(frozen=True, eq=False)
class EffectiveMatrix:
    """Matrix H(x, eps) of the m states in resonance, in axes that rotate with e^{i omega_p t}; x = Omega - centre.

    Attributes
    ----------
    states : ndarray, shape (m, 2)
        nu (from 0) and h; the first two are the pair that names the resonance.
    detuning : ndarray, shape (m,)
        omega_nu - h centre - omega_p.
    coefficients : dict
        Coefficient of eps^k x^l for each (k, l), shape (m, m), complex; without detuning and - i h x.
    sizes : dict
        The same sums with every term replaced by its modulus, which rounding is measured against.
    centre : float
    modes : int
        n; states nu < n are those of positive frequency.
    conservative : bool
    """

    states: NDArray[np.intp]
    detuning: FloatArray
    coefficients: dict[Monomial, ComplexArray]
    sizes: dict[Monomial, FloatArray]
    centre: float
    modes: int
    conservative: bool

    @cached_property
    def rate(self) -> FloatArray:
        """d(detuning) / dx of each state, shape (m,)."""
        moved = self.coefficients.get((0, 1))
        turning: FloatArray = -self.states[:, 1].astype(float)
        return turning if moved is None else turning + np.diagonal(moved).imag

    @cached_property
    def bend(self) -> FloatArray:
        """Half of the second derivative of the detuning, shape (m,)."""
        moved = self.coefficients.get((0, 2))
        return np.zeros(len(self.states)) if moved is None else np.diagonal(moved).imag

    @property
    def detuning_of_pair(self) -> Detuning:
        """The detuning of the resonance that the first two states make."""
        return Detuning(float(self.rate[1] - self.rate[0]), float(self.bend[1] - self.bend[0]))

    @property
    def same(self) -> NDArray[np.bool_]:
        """Pairs of states of one frequency and one harmonic, (m, m): their basis is arbitrary, they count together."""
        h, d = self.states[:, 1], self.detuning
        return (h[:, None] == h) & (np.abs(d[:, None] - d) <= EQUAL_FREQUENCY * self.centre)

    def at(self, x: FloatArray, eps: FloatArray) -> ComplexArray:
        """Return H for arrays x and eps that broadcast, shape (..., m, m)."""
        x, eps = np.asarray(x)[..., None, None], np.asarray(eps)[..., None, None]
        turning = np.diag(self.detuning) - x * np.diag(self.states[:, 1])
        H = np.asarray(1j * turning, dtype=np.complex128)
        for (power, drift), coefficient in self.coefficients.items():
            H = H + eps**power * x**drift * coefficient
        return H

    def strength(self, eps: FloatArray) -> FloatArray:
        """Return a bound on the moduli of H without detuning and drift, shape (..., m, m)."""
        eps = np.abs(np.asarray(eps))[..., None, None]
        total: FloatArray = np.zeros((1, 1))
        for (power, drift), coefficient in self.coefficients.items():
            total = total + (eps**power * np.abs(coefficient) if drift == 0 else 0.0)
        return total


def effective_matrix(equations: ModalEquations, resonance: Resonance, order: int) -> EffectiveMatrix:
    """Return the effective matrix of a resonance, near-resonant states included.

    A pair that nothing links with each other is left alone: what happens to either state is another resonance.

    Parameters
    ----------
    equations : ModalEquations
        Near the centre of the resonance.
    resonance : Resonance
    order : {1, 2}
        First order keeps the interactions of the resonant states among themselves only.
    """
    matrix = _among(equations, resonant_states(equations, resonance, order), resonance.centre, order)
    linked = np.sum(list(matrix.sizes.values()), axis=0) > 0 if matrix.sizes else np.zeros((2, 2))
    _, component = connected_components(linked, directed=False)
    if component[0] == component[1]:
        return matrix
    return alone(equations, resonance, order)


def alone(equations: ModalEquations, resonance: Resonance, order: int) -> EffectiveMatrix:
    """Return the effective matrix of the two states of a resonance, whatever else resonates with them."""
    return _among(equations, equations.states(resonance), resonance.centre, order)


def expansion_range(equations: ModalEquations, p: NDArray[np.intp] | int, q: NDArray[np.intp] | int) -> FloatArray:
    """Return the eps up to which the excitation moves at most `EXPANSION_RANGE` of the energy of modes p and q."""
    softest = np.maximum(equations.softness[np.asarray(p) - 1], equations.softness[np.asarray(q) - 1])
    return np.divide(EXPANSION_RANGE, softest, out=np.full(softest.shape, np.inf), where=softest > 0)


def resonant_states(equations: ModalEquations, resonance: Resonance, order: int) -> list[State]:
    """Return the two states of a resonance and those in resonance with them and coupled to them, nearest links first.

    To first order a state joins a member that it interacts with if within the range of the expansion the excitation
    splits the two by as much as they are apart. To second order it joins if its frequency is within `NEAR_RESONANCE` of
    the member's. Where only damping or two interactions together link it to a member, the limit is the square of that.
    """
    states = equations.states(resonance)
    centre, J = resonance.centre, order * equations.harmonics
    reach = expansion_range(equations, resonance.p, resonance.q)
    for nu, h in states:  # the list grows while it is read
        for step in range(J, -J - 1, -1):
            gap = _gap(equations, centre, nu, step)
            joins = gap <= _limit(equations, order, centre, reach, nu, step)
            linked = (gap < NEAR_RESONANCE**2 * centre) & (order == 2)
            for mu in np.flatnonzero(joins | linked).tolist():
                state = (mu, h - step)
                if state not in states and (joins[mu] or _linked_twice(equations, nu, mu, step)):
                    states.append(state)
                if len(states) == MAX_RESONANT_STATES:
                    return states
    return states


def in_company(equations: ModalEquations, resonances: Resonances) -> NDArray[np.bool_]:
    """Return whether to first order `resonant_states` of each resonance are more than two."""
    n = len(equations.omega) // 2
    first, sums = resonances.p - 1, resonances.type == "sum"
    second = resonances.q - 1 + n * sums
    centre = resonances.centre[:, None]
    reach = expansion_range(equations, resonances.p, resonances.q)[:, None]
    rows = np.arange(len(first))
    company = np.zeros(len(first), dtype=bool)
    for nu, other, towards in ((first, second, 1), (second, first, -1)):
        for step in range(-equations.harmonics, equations.harmonics + 1):
            joins = _gap(equations, centre, nu, step) <= _limit(equations, 1, centre, reach, nu, step)
            partner = step == towards * resonances.j
            joins[rows[partner], other[partner]] = False
            if step == 0:
                joins[rows, nu] = False
            company |= joins.any(axis=1)
    return company


def _gap(equations: ModalEquations, centre: FloatArray | float, nu: NDArray[np.intp] | int, step: int) -> FloatArray:
    """Return how far the frequencies of states (mu, h - step), mu = 1..2n, are from that of (nu, h)."""
    return np.abs(equations.omega + step * centre - equations.omega[nu, None])


def _limit(
    equations: ModalEquations,
    order: int,
    centre: FloatArray | float,
    reach: FloatArray | float,
    nu: NDArray[np.intp] | int,
    step: int,
) -> FloatArray:
    """Return the differences in frequency up to which states (mu, h - step) resonate with (nu, h); -1: never."""
    J = equations.harmonics
    coupled = steady = np.zeros_like(equations.strongest[nu, None] * equations.omega)
    if abs(step) <= J:
        coupled = np.maximum(equations.excitation[J + step][nu], equations.excitation[J - step][:, nu].T)
    if step == 0:
        steady = np.maximum(equations.steady[nu], equations.steady[:, nu].T) / DAMPING_SPLIT
        moving = np.maximum(equations.moving[nu], equations.moving[:, nu].T)
        steady = steady + moving * REACH_OF_DETUNING * centre
    if order == 2:
        strongest = np.maximum(equations.strongest[nu, None], SMALLEST_NORMAL)
        limit = NEAR_RESONANCE * centre * coupled / strongest
        limit = np.maximum(limit, NEAR_RESONANCE**2 * centre * (steady > 0))
    else:
        limit = 2 * np.where(np.isfinite(reach), reach, 0.0) * coupled + 2 * steady
        limit = np.maximum(limit, EQUAL_FREQUENCY * centre)
    return np.where((coupled > 0) | (steady > 0), limit, -1.0)


def _linked_twice(equations: ModalEquations, nu: int, mu: int, step: int) -> bool:
    """Whether the excitation couples states (nu, h) and (mu, h - step) through a third one."""
    J, V = equations.harmonics, equations.excitation
    return any(
        ((V[J + step - c, nu] != 0) & (V[J + c, :, mu] != 0)).any()
        or ((V[J - c, mu] != 0) & (V[J + c - step, :, nu] != 0)).any()
        for c in range(max(-J, step - J), min(J, step + J) + 1)
    )


def _among(equations: ModalEquations, states: list[State], centre: float, order: int) -> EffectiveMatrix:
    """Return the effective matrix of ``states``."""
    nu, h = np.array(states).T
    d = equations.omega[nu] - h * centre
    sums = _Sums(len(nu))
    for term in equations.terms:
        if term.order <= order:
            sums.add((term.power, term.drift), _interaction(term, nu, h, nu, h), np.eye(len(nu), dtype=complex))
    first = [term for term in equations.terms if term.order == 1]
    J = equations.harmonics
    outside = range(min(h) - J, max(h) + J + 1) if order == 2 else ()
    mu = np.arange(len(equations.omega))
    for k in outside:  # all states c = (mu, k)
        harmonic = np.full(len(mu), k)
        gap = d[:, None] - (equations.omega - k * centre)
        limits = [_limit(equations, 2, centre, np.inf, a, h_a - k) for a, h_a in states]
        far = np.abs(gap) > np.maximum(np.array(limits), 0.0)
        far[:, nu[h == k]] = False  # resonant states
        weight = np.divide(-0.5j, gap, out=np.zeros(gap.shape, dtype=complex), where=far)  # 1/2 / (D_a - D_c)
        to, back = _by_monomial(first, nu, h, mu, harmonic), _by_monomial(first, mu, harmonic, nu, h)
        for (power, drift), V_ac in to.items():
            for (power_2, drift_2), V_cb in back.items():
                monomial = (power + power_2, drift + drift_2)
                sums.add(monomial, V_ac * weight, V_cb)
                sums.add(monomial, V_ac, V_cb * weight.T)
    return EffectiveMatrix(
        np.array(states), d - d[0], sums.values, sums.sizes, centre, len(mu) // 2, equations.conservative
    )


class _Sums:
    """Coefficients of eps^k x^l, and the sums of the moduli of their terms."""

    def __init__(self, size: int) -> None:
        self._size = size
        self.values: dict[Monomial, ComplexArray] = {}
        self.sizes: dict[Monomial, FloatArray] = {}

    def add(self, monomial: Monomial, left: ComplexArray, right: ComplexArray) -> None:
        """Add left @ right to a coefficient, and its terms' moduli to the size."""
        shape = (self._size, self._size)
        self.values[monomial] = self.values.get(monomial, np.zeros(shape, dtype=complex)) + left @ right
        self.sizes[monomial] = self.sizes.get(monomial, np.zeros(shape)) + np.abs(left) @ np.abs(right)


def _by_monomial(
    terms: list[Term], to: NDArray[np.intp], h_to: NDArray[np.intp], of: NDArray[np.intp], h_of: NDArray[np.intp]
) -> dict[Monomial, ComplexArray]:
    """Return the interactions by each monomial that has any."""
    found: dict[Monomial, ComplexArray] = {}
    for term in terms:
        V, monomial = _interaction(term, to, h_to, of, h_of), (term.power, term.drift)
        if V.any():
            found[monomial] = found.get(monomial, 0) + V
    return found


def _interaction(
    term: Term, to: NDArray[np.intp], h_to: NDArray[np.intp], of: NDArray[np.intp], h_of: NDArray[np.intp]
) -> ComplexArray:
    """Return the matrix of a term from the states (of, h_of) to the states (to, h_to)."""
    return np.where(h_to[:, None] - h_of == term.harmonic, term.V[to[:, None], of], 0)
