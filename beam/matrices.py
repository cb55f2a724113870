"""Integrals of the trial functions s_k(x) = sqrt(2) sin(k pi x), k = 1..n, on 0 <= x <= 1.

They vanish at both supports and are orthonormal. A matrix of integrals has the test function phi as its row and the
trial function w as its column.
"""

from __future__ import annotations

import numpy as np

from periodic.checks import FloatArray


def wavenumbers(n: int) -> FloatArray:
    """Return k pi for k = 1..n, shape (n,)."""
    return np.arange(1.0, n + 1.0) * np.pi


def transport(n: int) -> FloatArray:
    """Return B = (w_x, phi), skew, shape (n, n)."""
    i, j = np.indices((n, n)) + 1
    with np.errstate(divide="ignore"):
        return np.where((i + j) % 2 == 1, 4 * i * j / (i**2 - j**2), 0.0)


def tension(n: int) -> FloatArray:
    """Return S = (w_x, phi_x), diagonal, shape (n, n)."""
    return np.diag(wavenumbers(n) ** 2)


def inertial_tension(n: int, held_at: float) -> FloatArray:
    """Return S_x = ((x - x0) w_x, phi_x) with x0 = ``held_at``, symmetric, shape (n, n)."""
    i, j = np.indices((n, n)) + 1

    def moment(m: np.ndarray) -> FloatArray:
        """Return the integral of (x - x0) cos(m pi x)."""
        with np.errstate(divide="ignore"):
            return np.where(m == 0, 0.5 - held_at, np.where(m % 2 == 1, -2 / (m * np.pi) ** 2, 0.0))

    return i * j * np.pi**2 * (moment(i - j) + moment(i + j))


def bending(n: int) -> FloatArray:
    """Return (w_xx, phi_xx), diagonal, shape (n, n)."""
    return np.diag(wavenumbers(n) ** 4)


def carried_bending(n: int) -> FloatArray:
    """Return (w_xxx, phi_xx), skew, shape (n, n): bending at the rate of change of the curvature carried past."""
    k2 = wavenumbers(n) ** 2
    return np.multiply.outer(k2, k2) * transport(n)


def carried_bending_strong(n: int) -> FloatArray:
    """Return (w_xxxxx, phi), not skew, shape (n, n): the same from the strong form."""
    return transport(n) * wavenumbers(n) ** 4
