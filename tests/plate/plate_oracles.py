"""What the tests of the plate need from the theory around it, kept apart from the packages under test."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from periodic import PeriodicSystem


class Modes(NamedTuple):
    """Gyroscopic modes of the undamped system and first-order slopes of its resonances."""

    omega: NDArray[np.float64]
    w: NDArray[np.complex128]
    decay: NDArray[np.float64]

    def slope(self, system: PeriodicSystem, p: int, q: int, j: int = 1) -> float:
        """sqrt(L) of j Omega = omega_p + omega_q (1-based), from the closed form."""
        E = system.cosine[j - 1] - 1j * system.sine[j - 1]
        product = self.w[:, p - 1].conj() @ E @ self.w[:, q - 1].conj()
        return 0.5 * float(np.sqrt(self.omega[p - 1] * self.omega[q - 1]) * abs(product))


def modes(system: PeriodicSystem, K_oe: NDArray[np.float64]) -> Modes:
    """By the plain unsymmetric eigenproblem of the first-order form; w^H (omega^2 M + K) w = 2."""
    n, inverse = system.size, np.linalg.inv(system.mass)
    first_order = np.block([[-inverse @ system.gyroscopic, -inverse @ system.stiffness], [np.eye(n), np.zeros((n, n))]])
    values, vectors = np.linalg.eig(first_order)
    kept = np.flatnonzero(values.imag > 0)
    kept = kept[np.argsort(values.imag[kept])]
    omega, w = values.imag[kept], vectors[n:, kept]
    norm = omega**2 * _form(w, system.mass) + _form(w, system.stiffness)
    w = w * np.sqrt(2 / norm)
    return Modes(omega, w, omega**2 * _form(w, K_oe))


def _form(w: NDArray[np.complex128], A: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.einsum("ia,ij,ja->a", w.conj(), A, w).real
