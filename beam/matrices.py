"""Integrals of the trial functions on 0 <= x <= 1.

The deflection w has sines sqrt(2) sin(k pi x), k = 1..n, which vanish at both supports; the rotation psi of the cross
sections has 1 and sqrt(2) cos(k pi x). Both are orthonormal. A matrix of integrals has the test function (phi for w,
theta for psi) as its row and the trial function as its column.
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


def slope(n: int) -> FloatArray:
    """Return w_x in the functions of the rotation, shape (n + 1, n)."""
    return np.vstack([np.zeros(n), np.diag(wavenumbers(n))])


def rotation_transport(n: int) -> FloatArray:
    """Return R = (psi_x, theta), shape (n + 1, n + 1). It is not skew: cosines do not vanish at the supports."""
    i, j = np.indices((n + 1, n + 1))
    with np.errstate(divide="ignore", invalid="ignore"):
        R = np.where((i + j) % 2 == 1, 4 * j**2 / (i**2 - j**2), 0.0)
    R[0] /= np.sqrt(2)
    return R


def curvature(n: int) -> FloatArray:
    """Return (psi_x, theta_x), diagonal, shape (n + 1, n + 1)."""
    return np.diag(np.concatenate([[0.0], wavenumbers(n) ** 2]))


def carried_curvature(n: int) -> FloatArray:
    """Return (psi_xx, theta_x), skew, shape (n + 1, n + 1): the curvature that is carried past a place."""
    k = wavenumbers(n)
    return np.pad(np.multiply.outer(k, k) * transport(n), ((1, 0), (1, 0)))


def carried_curvature_strong(n: int) -> FloatArray:
    """Return -(psi_xxx, theta), not skew, shape (n + 1, n + 1): the same from the strong form."""
    return rotation_transport(n) * np.concatenate([[0.0], wavenumbers(n) ** 2])
