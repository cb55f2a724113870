"""Perturbation theory of Floquet exponents in the modal basis: the effective matrix of a resonance.

In the complex modal basis (nu = 1..n for Z_nu, n+1..2n for the conjugates, Z^H A Z = 1, omega of a conjugate negative)
and with q = e^{lambda t} sum_h sum_nu a_nu^h Z_nu e^{i h Omega t}, the equations of motion are

    lambda a_nu^h = i (omega_nu - h Omega) a_nu^h - sum_mu Gamma_numu a_mu^h
                    - eps sum_j (E^{(j)} a^{h-j} + E^{(-j)} a^{h+j})_nu.

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

from periodic import PeriodicSystem
from periodic.checks import ComplexArray, FloatArray
from perturb.coupling import amplitude, is_symmetric, projection
from perturb.modes import GyroscopicModes

# Two states resonate together if their frequencies differ by less than this part of Omega, a fifth of the distance
# between neighbouring harmonics of one mode. For a state that the excitation couples less than others the limit is
# lower in proportion, so that no term of the second-order sum exceeds V^2 / (NEAR_RESONANCE Omega), V the strongest.
NEAR_RESONANCE = 0.2

# To first order only states of one frequency resonate together: equal to rounding of the modes, as a part of Omega.
EQUAL_FREQUENCY = 1e-9

# At most so many states are treated as resonant together. Chains of resonances are longer (the frequencies of a string
# are all multiples of the first); what is cut off lies several interactions away from the pair that names the region.
MAX_RESONANT_STATES = 8

# Least divisor of a quotient that has to stay finite.
SMALLEST_NORMAL = float(np.finfo(float).tiny)


@dataclass(frozen=True, eq=False)
class ModalCouplings:
    """Gamma and E^{(±j)} for all modes and their conjugates.

    Attributes
    ----------
    omega : ndarray, shape (2n,)
        Signed frequencies.
    E : ndarray, shape (2J + 1, 2n, 2n), complex
        E[J + j] is E^{(j)} for j = -J..J; the entry in the middle, j = 0, is Gamma.
    conservative : bool
        No damping and symmetric excitation matrices.
    """

    omega: FloatArray
    E: ComplexArray
    conservative: bool

    @property
    def harmonics(self) -> int:
        """J."""
        return len(self.E) // 2

    @cached_property
    def strongest(self) -> FloatArray:
        """Largest modulus among all couplings of a mode by the excitation, shape (2n,)."""
        size = np.abs(np.delete(self.E, self.harmonics, axis=0)).max(axis=0)
        return np.maximum(size.max(axis=0), size.max(axis=1))


def modal_couplings(modes: GyroscopicModes, system: PeriodicSystem) -> ModalCouplings:
    """Return the couplings of all states of ``system`` in the basis ``modes``."""
    J = system.harmonics
    omega = np.concatenate([modes.frequencies, -modes.frequencies])
    w = np.concatenate([modes.vectors, modes.vectors.conj()], axis=1) / np.sqrt(2)
    E = np.zeros((2 * J + 1, len(omega), len(omega)), dtype=complex)
    E[J] = omega[:, None] * projection(w, system.damping.astype(complex), w) * omega
    symmetric = True
    for j in range(1, J + 1):
        E_j = amplitude(system, j)
        upward = projection(w, E_j, w)
        downward = upward.conj().T if is_symmetric(E_j) else projection(w, E_j.conj(), w)
        E[J + j] = -0.5j * omega[:, None] * upward
        E[J - j] = -0.5j * omega[:, None] * downward
        symmetric = symmetric and is_symmetric(E_j)
    return ModalCouplings(omega, E, conservative=symmetric and not system.damping.any())


@dataclass(frozen=True, eq=False)
class EffectiveMatrix:
    """Matrix H(x, eps) of the m states in resonance, in axes that rotate with e^{i omega_p t}; x = Omega - centre.

    Attributes
    ----------
    states : ndarray, shape (m, 2)
        nu (from 0) and h; the first two are the pair that names the resonance.
    detuning : ndarray, shape (m,)
        omega_nu - h centre - omega_p.
    powers : ndarray, shape (3, m, m), complex
        Coefficients of 1, eps and eps^2.
    sizes : ndarray, shape (3, m, m)
        The same sums with every term replaced by its modulus, which rounding is measured against.
    drift : ndarray, shape (m, m), complex
        Coefficient of eps x, where the excitation depends on Omega.
    same : ndarray of bool, shape (m, m)
        Pairs of states of one repeated frequency and one harmonic. Their basis is arbitrary, so they count together.
    conservative : bool
    """

    states: NDArray[np.intp]
    detuning: FloatArray
    powers: ComplexArray
    sizes: FloatArray
    drift: ComplexArray
    same: NDArray[np.bool_]
    conservative: bool

    def at(self, x: FloatArray, eps: FloatArray) -> ComplexArray:
        """Return H for arrays x and eps that broadcast, shape (..., m, m)."""
        x, eps = np.asarray(x)[..., None, None], np.asarray(eps)[..., None, None]
        H = self.powers[0] + eps * self.powers[1] + eps**2 * self.powers[2] + eps * x * self.drift
        return H + 1j * (np.diag(self.detuning) - x * np.diag(self.states[:, 1]))


def effective_matrix(
    couplings: ModalCouplings,
    pair: list[tuple[int, int]],
    centre: float,
    order: int,
    slope: ModalCouplings | None = None,
) -> EffectiveMatrix:
    """Return the effective matrix of the resonance of ``pair``, its near-resonant states included.

    A pair that nothing links with each other is left alone: what happens to either state is another resonance.

    Parameters
    ----------
    couplings : ModalCouplings
        At Omega = ``centre``.
    pair : list of two (nu, h)
        States with equal omega_nu - h centre.
    centre : float
    order : {1, 2}
        First order keeps the interactions of the resonant states among themselves only.
    slope : ModalCouplings, optional
        Derivative of the couplings with respect to Omega.
    """
    matrix = _among(couplings, resonant_states(couplings, pair, centre, order), centre, order, slope)
    _, component = connected_components(matrix.sizes.sum(axis=0) > 0, directed=False)
    return matrix if component[0] == component[1] else _among(couplings, pair, centre, order, slope)


def _among(
    couplings: ModalCouplings,
    states: list[tuple[int, int]],
    centre: float,
    order: int,
    slope: ModalCouplings | None,
) -> EffectiveMatrix:
    nu, h = np.array(states).T
    d = couplings.omega[nu] - h * centre
    powers, sizes = np.zeros((3, len(nu), len(nu)), dtype=complex), np.zeros((3, len(nu), len(nu)))
    direct = _interaction(couplings, nu, h, nu, h)
    _add(powers, sizes, (h[:, None] != h).astype(int), direct, np.eye(len(nu), dtype=complex))
    J = couplings.harmonics
    outside = range(min(h) - J, max(h) + J + 1) if order == 2 else ()
    for k in outside:  # all states c = (mu, k)
        mu, harmonic = np.arange(len(couplings.omega)), np.full(len(couplings.omega), k)
        V_ac, V_cb = _interaction(couplings, nu, h, mu, harmonic), _interaction(couplings, mu, harmonic, nu, h)
        gap = d[:, None] - (couplings.omega - k * centre)
        far = np.abs(gap) > [_near(couplings, (a, h_a), k, centre) for a, h_a in states]
        far[:, nu[h == k]] = False  # resonant states
        weight = np.divide(-0.5j, gap, out=np.zeros(gap.shape, dtype=complex), where=far)  # 1/2 / (D_a - D_c)
        power = (h != k).astype(int)
        _add(powers, sizes, power[:, None] + power, V_ac * weight, V_cb)
        _add(powers, sizes, power[:, None] + power, V_ac, V_cb * weight.T)
    drift = np.zeros_like(powers[0]) if slope is None else _interaction(slope, nu, h, nu, h) * (h[:, None] != h)
    same = (h[:, None] == h) & (np.abs(d[:, None] - d) <= EQUAL_FREQUENCY * centre)
    return EffectiveMatrix(np.array(states), d - d[0], powers, sizes, drift, same, couplings.conservative)


def resonant_states(
    couplings: ModalCouplings, pair: list[tuple[int, int]], centre: float, order: int
) -> list[tuple[int, int]]:
    """Return ``pair`` and the states that are in resonance with it and coupled to it, nearest interactions first.

    To first order a state joins if its frequency is that of a member it interacts with. To second order it joins if its
    frequency is within `NEAR_RESONANCE` of that. Where only damping or two interactions together link it to a member,
    the limit is the square of `NEAR_RESONANCE`.
    """
    states = list(pair)
    J = couplings.harmonics
    for nu, h in states:  # the list grows while it is read
        for k in range(h - 2 * J, h + 2 * J + 1):
            gap = np.abs(couplings.omega - k * centre - (couplings.omega[nu] - h * centre))
            near = _near(couplings, (nu, h), k, centre)
            joins = (near > 0) & (gap <= EQUAL_FREQUENCY * centre) if order == 1 else gap < near
            linked = (gap < NEAR_RESONANCE**2 * centre) & (order == 2)
            for mu in np.flatnonzero(joins | linked).tolist():
                if (mu, k) not in states and (joins[mu] or _linked_twice(couplings, (nu, h), (mu, k))):
                    states.append((mu, k))
                if len(states) == MAX_RESONANT_STATES:
                    return states
    return states


def _near(couplings: ModalCouplings, state: tuple[int, int], k: int, centre: float) -> FloatArray:
    """Return the differences in frequency below which states (mu, k), mu = 1..2n, resonate with ``state``; 0: never."""
    (nu, h), J, E = state, couplings.harmonics, couplings.E
    if abs(h - k) > J:
        return np.zeros(len(couplings.omega))
    strength = np.maximum(np.abs(E[J + h - k, nu]), np.abs(E[J + k - h, :, nu]))
    if h == k:
        return NEAR_RESONANCE**2 * centre * (strength > 0)
    return NEAR_RESONANCE * centre * strength / max(couplings.strongest[nu], SMALLEST_NORMAL)


def _interaction(
    couplings: ModalCouplings,
    to: NDArray[np.intp],
    h_to: NDArray[np.intp],
    of: NDArray[np.intp],
    h_of: NDArray[np.intp],
) -> ComplexArray:
    """Return - Gamma or - E^{(h_to - h_of)} from the states (of, h_of) to the states (to, h_to), eps left out."""
    J = couplings.harmonics
    step = h_to[:, None] - h_of
    within = np.abs(step) <= J
    return np.where(within, -couplings.E[np.where(within, J + step, J), to[:, None], of], 0)


def _linked_twice(couplings: ModalCouplings, a: tuple[int, int], b: tuple[int, int]) -> bool:
    """Whether states a and b interact through a third one."""
    (nu, h), (mu, k) = a, b
    J, E = couplings.harmonics, couplings.E
    return any(
        ((E[J + h - c, nu] != 0) & (E[J + c - k, :, mu] != 0)).any()
        or ((E[J + k - c, mu] != 0) & (E[J + c - h, :, nu] != 0)).any()
        for c in range(max(h, k) - J, min(h, k) + J + 1)
    )


def _add(
    powers: ComplexArray, sizes: FloatArray, power: NDArray[np.intp], left: ComplexArray, right: ComplexArray
) -> None:
    """Add left @ right to the coefficients of eps^power, element by element, and its terms' moduli to sizes."""
    for k in range(3):
        powers[k] += np.where(power == k, left @ right, 0)
        sizes[k] += np.where(power == k, np.abs(left) @ np.abs(right), 0)
