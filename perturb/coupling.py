"""How the excitation couples two modes at resonance: eqs. (26)-(28), in closed form.

With E_j = F_cj - i F_sj and the modes of `perturb.modes`, the pair (p, q) is coupled near j Omega = omega_p + omega_q
("sum") by

    Lambda_pq       = + i omega_p / 2  w_p^H E_j conj(w_q)
    conj(Lambda_qp) = - i omega_q / 2  w_q^T conj(E_j) w_p

and near j Omega = omega_p - omega_q ("difference") by

    Lambda_pq       = + i omega_p / 2  w_p^H E_j w_q
    Lambda_qp       = + i omega_q / 2  w_q^H conj(E_j) w_p

Their product L decides over stability. For symmetric matrices E_j it is real,
L = ± omega_p omega_q |w_p^H E_j (conj) w_q|^2 / 4: positive for sums, negative for differences.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from periodic import PeriodicSystem
from periodic.checks import ComplexArray
from periodic.system import SYMMETRY_TOLERANCE
from perturb.modes import MODAL_ZERO, GyroscopicModes

# L of unsymmetric matrices is real if its imaginary part is below this part of it: a few hundred times what two
# products of length n lose, and far below any effect on a growth rate.
IMAGINARY_PART = 1e-10


class Coupling(NamedTuple):
    """The two factors of L for every pair, each of shape (n, n) and indexed [p, q] from 0."""

    forward: ComplexArray  # Lambda_pq
    backward: ComplexArray  # conj(Lambda_qp) for sums, Lambda_qp for differences


def amplitude(system: PeriodicSystem, j: int) -> ComplexArray:
    """Return E_j = F_cj - i F_sj, so that harmonic j of the excitation is Re(E_j e^{i j Omega t})."""
    return system.cosine[j - 1] - 1j * system.sine[j - 1]


def closed_form(modes: GyroscopicModes, E: ComplexArray, type: str) -> Coupling:
    """Return the couplings in terms of the displacement vectors w_n."""
    sign = 1 if type == "sum" else -1
    w = modes.vectors
    partner = w.conj() if type == "sum" else w
    forward = 0.5j * modes.frequencies[:, None] * projection(w, E, partner)
    if is_symmetric(E):
        # w_q^T conj(E) w_p = conj(w_p^H E conj(w_q)): L comes out real without rounding
        back = forward.conj() / modes.frequencies[:, None]
    else:
        back = -0.5j * projection(partner, E.conj(), w).T
    return Coupling(forward, sign * modes.frequencies * back)


def products(modes: GyroscopicModes, E: ComplexArray, type: str) -> ComplexArray:
    """Return L for every pair, shape (n, n), with an imaginary part of exactly zero wherever L is real."""
    forward, backward = closed_form(modes, E, type)
    L = forward * backward
    return np.where(is_symmetric(E) | (np.abs(L.imag) <= IMAGINARY_PART * np.abs(L)), L.real, L)


def projection(left: ComplexArray, E: ComplexArray, right: ComplexArray) -> ComplexArray:
    """Return left^H E right, with exact zeros where modes of different symmetry leave rounding."""
    product = left.conj().T @ E @ right
    scale = np.abs(left).T @ np.abs(E) @ np.abs(right)
    largest = np.sqrt(np.outer(scale.max(axis=1), scale.max(axis=0)))
    return np.where(np.abs(product) <= MODAL_ZERO * largest, 0.0, product)


def is_symmetric(E: ComplexArray) -> bool:
    """Whether E is symmetric to rounding."""
    return bool(np.abs(E - E.T).max() <= SYMMETRY_TOLERANCE * np.abs(E).max())
