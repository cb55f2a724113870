"""Eigenvalues of A_0 with right and left eigenvectors: the states that multiple scales expands in.

No symmetry is needed. Right and left eigenvectors obey l_a r_b = delta_ab, and the right ones have the energy norm 1.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import solve_triangular

from periodic import AnySystem, FirstOrderSystem, PeriodicSystem
from periodic.checks import ComplexArray, FloatArray, is_positive_definite
from periodic.terms import SYMMETRY_TOLERANCE
from perturb.general.blocks import Blocks
from perturb.modes import gyroscopic_modes

# Eigenvalues closer than this part of the largest one are one repeated eigenvalue.
REPEATED_EIGENVALUE = 1e-9

# Vectors of a repeated eigenvalue that are wrong by more than this part of A_0 are not as many as it is repeated.
REPEATED_RESIDUAL = 1e-7

# Where l_a and r_a, made for l_a r_a = 1, are longer than this, the eigenvalue is defective to rounding: one that is
# split by rounding (its square root, 1e-8) has them as long as 1e8.
MAX_STATE_CONDITION = 1e6

# Rounding of an eigenvalue, as a part of the largest one times the condition of its states.
EIGENVALUE_ROUNDING = 1e-13

# Least stiffness, as a part of the largest one, in the energy that scales the states.
SOFTEST_PART = 1e-4


@dataclass(frozen=True, eq=False)
class Eigenstates:
    """The states of A_0: n modes, their n conjugates, and what does not oscillate.

    Attributes
    ----------
    eigenvalues : ndarray, shape (N,), complex
        First those with a positive imaginary part by increasing frequency, then their conjugates, then the real ones.
    right : ndarray, shape (N, N)
        Columns r_a.
    left : ndarray, shape (N, N)
        Rows l_a.
    modes : int
        n.
    """

    eigenvalues: ComplexArray
    right: ComplexArray
    left: ComplexArray
    modes: int

    @property
    def frequencies(self) -> FloatArray:
        """Of the modes, shape (n,)."""
        return np.asarray(self.eigenvalues[: self.modes].imag)

    @property
    def decay(self) -> FloatArray:
        """Twice the rate at which each mode decays, exactly, shape (n,): C_n of eq. (26a) for small damping."""
        return np.asarray(-2 * self.eigenvalues[: self.modes].real)


def eigenstates(system: AnySystem, blocks: Blocks) -> Eigenstates:
    """Return the states of A_0 of ``system``.

    Raises
    ------
    ValueError
        If an eigenvalue is defective.
    """
    if isinstance(system, PeriodicSystem) and _is_gyroscopic(system):
        modes = gyroscopic_modes(PeriodicSystem(system.mass, system.gyroscopic, None, system.stiffness))
        n = system.size
        right = np.concatenate([modes.states, modes.states.conj()], axis=1) / np.sqrt(2)
        left = np.concatenate([right[:n].conj().T @ system.mass, right[n:].conj().T @ system.stiffness], axis=1)
        T = blocks.velocity
        lam = 1j * np.concatenate([modes.frequencies, -modes.frequencies])
        return Eigenstates(lam, np.linalg.solve(T, right), np.asarray(left @ T), n)
    A = blocks.constant
    S = _scale(system, blocks)
    scaled: FloatArray = np.asarray(np.linalg.solve(S.T, (S @ A).T).T, dtype=float)  # S A S^-1
    values, vectors = np.linalg.eig(scaled)
    size = max(float(np.abs(scaled).max()), float(np.abs(values).max()))
    upper, real = np.flatnonzero(values.imag > 0), np.flatnonzero(values.imag == 0)
    upper = upper[np.argsort(values[upper].imag, kind="stable")]
    real = real[np.argsort(-values[real].real, kind="stable")]
    V_up = _independent(values[upper], vectors[:, upper], scaled, size)
    V_real = _independent(values[real], vectors[:, real], scaled, size)
    V = np.concatenate([V_up, V_up.conj(), V_real], axis=1).astype(complex)
    lam = np.concatenate([values[upper], values[upper].conj(), values[real]]).astype(complex)
    try:
        inverse: ComplexArray = np.asarray(np.linalg.inv(V), dtype=complex)
    except np.linalg.LinAlgError:
        raise _defective(complex(lam[0])) from None
    condition = np.linalg.norm(inverse, axis=1) * np.linalg.norm(V, axis=0)
    if condition.max(initial=0.0) > MAX_STATE_CONDITION:
        raise _defective(complex(lam[int(condition.argmax())]))
    undamped = np.abs(lam.real) <= EIGENVALUE_ROUNDING * size * condition
    lam = np.where(undamped, 1j * lam.imag, lam)
    return Eigenstates(lam, np.linalg.solve(S, V), np.asarray(inverse @ S, dtype=complex), len(upper))


def _is_gyroscopic(system: PeriodicSystem) -> bool:
    """Whether the modes of eqs. (14)-(16) exist and are the states."""
    K = system.stiffness
    symmetric = np.abs(K - K.T).max() <= SYMMETRY_TOLERANCE * np.abs(K).max()
    return bool(symmetric) and not system.damping.any() and is_positive_definite(0.5 * (K + K.T))


def _scale(system: AnySystem, blocks: Blocks) -> FloatArray:
    """Return S with |S x|^2 the energy of the state x, for what has one: W'^T M W' + W^T K W."""
    if isinstance(system, FirstOrderSystem):
        return np.eye(system.size)
    n = system.size
    L = np.linalg.cholesky(system.mass)
    K = 0.5 * (system.stiffness + system.stiffness.T)
    values, vectors = np.linalg.eigh(solve_triangular(L, solve_triangular(L, K, lower=True).T, lower=True))
    largest = float(np.abs(values).max()) or float(np.abs(blocks.constant[:n, :n]).max()) ** 2 or 1.0
    roots = np.sqrt(np.maximum(np.abs(values), SOFTEST_PART * largest))
    zero = np.zeros((n, n))
    return np.asarray(np.block([[L.T, zero], [zero, (vectors * roots).T @ L.T]]) @ blocks.velocity)


def _independent(values: ComplexArray, vectors: ComplexArray, A: FloatArray, size: float) -> ComplexArray:
    """Return the eigenvectors with those of each repeated eigenvalue made orthonormal."""
    vectors = vectors.copy()
    left = list(range(len(values)))
    while left:
        group = [a for a in left if abs(values[a] - values[left[0]]) <= REPEATED_EIGENVALUE * size]
        left = [a for a in left if a not in group]
        if len(group) > 1:
            basis = np.linalg.qr(vectors[:, group])[0]
            if np.abs(A @ basis - values[group[0]] * basis).max() > REPEATED_RESIDUAL * size:
                raise _defective(complex(values[group[0]]))
            vectors[:, group] = basis
    return vectors


def _defective(value: complex) -> ValueError:
    return ValueError(
        f"family has, without excitation, an eigenvalue {value:.6g} that is defective: repeated, with fewer "
        "independent motions. Regions next to it are no power series in eps, which this theory needs; "
        "give a system away from it (floquet/ takes any)"
    )
