"""What the tests of the plate need from the theory around it, kept apart from the packages under test."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from hypothesis import strategies as st
from numpy.typing import NDArray

from periodic import PeriodicSystem
from periodic.checks import ComplexArray
from plate import Distribution

numbers = st.floats(-10, 10)


@st.composite
def distributions(draw: st.DrawFn) -> Distribution:
    """Up to four pieces, of degree up to three, with ends at whole hundredths."""
    inner = draw(st.lists(st.integers(1, 99), max_size=3, unique=True))
    breaks = (0.0, *(i / 100 for i in sorted(inner)), 1.0)
    rows = [tuple(draw(st.lists(numbers, min_size=1, max_size=4))) for _ in breaks[1:]]
    return Distribution(breaks, tuple(rows))


class Modes(NamedTuple):
    """Gyroscopic modes of the undamped system and first-order slopes of its resonances."""

    omega: NDArray[np.float64]
    w: ComplexArray
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


def _form(w: ComplexArray, A: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.einsum("ia,ij,ja->a", w.conj(), A, w).real
