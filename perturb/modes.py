"""Gyroscopic modes of the undamped, unexcited system: eqs. (13)-(18)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import qr, solve_triangular

from periodic import PeriodicSystem
from periodic.checks import ComplexArray, FloatArray, is_positive_definite
from periodic.system import SYMMETRY_TOLERANCE

# Frequencies closer than this part of the highest one are one repeated frequency. The Hermitian eigenproblem loses a
# hundredth of it at the sizes in use, so the vectors within such a group are arbitrary.
REPEATED_FREQUENCY = 1e-11

# A coupling or damping of a mode below this part of what the same matrix does to other modes is zero by symmetry. Modes
# of plates with 200 coordinates leave 2e-13 in place of such a zero.
MODAL_ZERO = 1e-11


@dataclass(frozen=True, eq=False)
class GyroscopicModes:
    """Modes of M W'' + G W' + K W = 0, solutions W = Re(w_n e^{i omega_n t}).

    Attributes
    ----------
    frequencies : ndarray, shape (n,)
        omega_n > 0, ascending, in the units of the system.
    vectors : ndarray, shape (n, n), complex
        Column n - 1 is w_n, normalised to w_n^H (omega_n^2 M + K) w_n = 2, which is X^T A X = Y^T A Y = 1 for
        Z = X + i Y = (i omega_n w_n, w_n) and A = diag(M, K), eq. (15). Its largest component is real and positive;
        vectors of a repeated frequency are made unique by the same rule, largest component after largest component.
    decay : ndarray, shape (n,)
        C_n = omega_n^2 w_n^H C w_n, eq. (26a) for the damping matrix C of the system: c c_n of the paper. The free
        vibration of mode n decays, to first order in C, at the rate C_n / 2.
    """

    frequencies: FloatArray
    vectors: ComplexArray
    decay: FloatArray

    def __post_init__(self) -> None:
        for array in (self.frequencies, self.vectors, self.decay):
            array.setflags(write=False)

    @property
    def repeated(self) -> NDArray[np.bool_]:
        """Modes that share their frequency with another one, shape (n,)."""
        equal = np.diff(self.frequencies) <= REPEATED_FREQUENCY * self.frequencies[-1]
        return np.concatenate([[False], equal]) | np.concatenate([equal, [False]])

    @property
    def states(self) -> ComplexArray:
        """Eigenvectors Z_n of eq. (14) at s = + i omega_n in the state q = (W', W), shape (2n, n)."""
        return np.concatenate([1j * self.frequencies * self.vectors, self.vectors])

    @property
    def modal_matrix(self) -> FloatArray:
        """P = [X_1, Y_1, X_2, Y_2, ...] of eq. (15), shape (2n, 2n)."""
        Z = self.states
        return np.stack([Z.real, Z.imag], axis=2).reshape(len(Z), -1)

    def decay_coefficients(self, damping: FloatArray) -> FloatArray:
        """Return c_n of eq. (26a), omega_n^2 w_n^H D w_n, for a symmetric matrix D, shape (n,)."""
        product = self.frequencies**2 * _forms(self.vectors, damping)
        size = np.abs(self.vectors)
        scale = self.frequencies**2 * _forms(size, np.abs(damping))
        # Terms that cancel leave rounding in proportion to their size. A mode at rest where the damper sits leaves
        # the square of its rounding there.
        rounding = MODAL_ZERO * scale + MODAL_ZERO**2 * scale.max()
        return np.where(np.abs(product) <= rounding, 0.0, product)


def gyroscopic_modes(system: PeriodicSystem) -> GyroscopicModes:
    """Return the modes of a system without its damping and excitation, eqs. (14)-(16).

    The skew problem s A Z + B Z = 0, A = diag(M, K), B = [[G, K], [-K, 0]], becomes Hermitian by the Cholesky
    factors of A: frequencies come out real and eigenvalues in exact pairs.

    Parameters
    ----------
    system : PeriodicSystem
        With symmetric positive definite stiffness.

    Returns
    -------
    GyroscopicModes

    Raises
    ------
    ValueError
        If ``system`` is no PeriodicSystem, or its stiffness is not symmetric or not positive definite.
    """
    if not isinstance(system, PeriodicSystem):
        given = type(system).__name__
        raise ValueError(f"system is of type {given}; give a PeriodicSystem (of a family, family.at(Omega))")
    M, G, K = system.mass, system.gyroscopic, _checked_stiffness(system.stiffness)
    n = system.size
    L_M, L_K = np.linalg.cholesky(M), np.linalg.cholesky(K)
    gyroscopic = solve_triangular(L_M, solve_triangular(L_M, G, lower=True).T, lower=True).T
    elastic = solve_triangular(L_M, L_K, lower=True)
    # eq. (14) for y = (L_M^T W', L_K^T W): y' = - skew y, so i skew is Hermitian with eigenvalues ± omega
    skew = np.block([[gyroscopic, elastic], [-elastic.T, np.zeros((n, n))]])
    values, y = np.linalg.eigh(0.5j * (skew - skew.T))
    omega = values[n:]
    if omega[0] <= 0:
        raise ValueError(
            "stiffness is singular to rounding; give a positive definite one (floquet/ takes any stiffness)"
        )
    w = solve_triangular(L_K.T, y[n:, n:], lower=False)
    largest = np.take_along_axis(w, np.abs(w).argmax(axis=0)[None], axis=0)
    w *= largest.conj() / np.abs(largest)
    for group in _repeated(omega):
        if group.stop - group.start > 1:
            w[:, group] = w[:, group] @ _canonical_turn(w[:, group])
    norm = _forms(w, M) * omega**2 + _forms(w, K)
    w *= np.sqrt(2.0 / norm)  # eq. (15)
    modes = GyroscopicModes(omega, w, np.zeros(n))
    return GyroscopicModes(omega, w, modes.decay_coefficients(system.damping))


def _checked_stiffness(K: FloatArray) -> FloatArray:
    """Return K made exactly symmetric; refuse what the modes of eq. (14) do not exist for."""
    defect = float(np.abs(K - K.T).max())
    if defect > SYMMETRY_TOLERANCE * np.abs(K).max():
        raise ValueError(
            f"stiffness is not symmetric (largest defect {defect:.3g}); the perturbation theory needs a symmetric "
            "positive definite stiffness (floquet/ takes any)"
        )
    K = 0.5 * (K + K.T)
    if not is_positive_definite(K):
        raise ValueError(
            f"stiffness has the lowest eigenvalue {np.linalg.eigvalsh(K)[0]:.6g}; the perturbation theory needs a "
            "positive definite stiffness: no rigid motion, and speed and load below divergence (floquet/ takes any)"
        )
    return K


def _forms(w: NDArray[Any], A: FloatArray) -> FloatArray:
    """Return w_n^H A w_n of every column, real, shape (n,)."""
    return np.asarray((w.conj() * (A @ w)).sum(axis=0).real)


def _repeated(omega: FloatArray) -> list[slice]:
    """Return the groups of equal frequencies, single ones included."""
    starts = [0, *(np.flatnonzero(np.diff(omega) > REPEATED_FREQUENCY * omega[-1]) + 1).tolist()]
    return [slice(a, b) for a, b in zip(starts, [*starts[1:], len(omega)], strict=True)]


def _canonical_turn(w: ComplexArray) -> ComplexArray:
    """Return the unitary matrix that makes ``w`` lower trapezoidal, with positive diagonal, in its pivot rows.

    Depends on the span of ``w`` alone; where the span is real (no gyroscopic forces) the turned vectors are real.
    """
    Q, R, _ = qr(w.conj().T, mode="economic", pivoting=True)
    diagonal = np.diagonal(R)
    return Q * (diagonal / np.abs(diagonal))
