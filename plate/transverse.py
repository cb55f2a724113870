"""Transverse problem: the matrices of eq. (11), from the weak form (10) in the trial space (9).

The factor of s_k(X) q_l(Y), k = 1..K and l = 0..L, is coordinate (k - 1) (L + 1) + l: every matrix is a sum of Kronecker
products of an axial and a lateral matrix. Since the basis is orthonormal, M is the identity.
"""

from __future__ import annotations

import numpy as np

from periodic.checks import FloatArray
from plate.basis import legendre_derivative, sine_derivative, sine_wavenumbers
from plate.distribution import Distribution


def gyroscopic(K: int, lateral: int, r: float) -> FloatArray:
    """Return G_o of eq. (11), 2 (w_X, phi): skew-symmetric, shape (K lateral, K lateral)."""
    return np.kron(2 * sine_derivative(K, r), np.eye(lateral))


def elastic_stiffness(K: int, lateral: int, r: float, nu: float) -> FloatArray:
    """Return K_oe of eq. (11): bending stiffness of the plate, simply supported at x = 0, a and free at y = 0, b."""
    one_x, one_y = np.eye(K), np.eye(lateral)
    alpha2 = np.diag(sine_wavenumbers(K, r) ** 2)  # s_k'' = -alpha_k^2 s_k
    D = legendre_derivative(lateral)
    D2 = D @ D
    return (
        np.kron(alpha2 @ alpha2, one_y)  # (w_XX, phi_XX)
        + np.kron(one_x, D2.T @ D2)  # (w_YY, phi_YY)
        - nu * np.kron(alpha2, D2 + D2.T)  # nu (w_XX, phi_YY) + nu (w_YY, phi_XX)
        + 2 * (1 - nu) * np.kron(alpha2, D.T @ D)  # 2 (1 - nu) (w_XY, phi_XY)
    )


def transport_stiffness(K: int, lateral: int, r: float) -> FloatArray:
    """Return K_og of eq. (11), -(w_X, phi_X): negative definite."""
    return -np.kron(np.diag(sine_wavenumbers(K, r) ** 2), np.eye(lateral))


def membrane_stiffness(load: Distribution, K: int, lateral: int, r: float) -> FloatArray:
    """Return F of eq. (11) for the stresses N_xx = f(y), N_yy = N_xy = 0: (f w_X, phi_X)."""
    return np.kron(np.diag(sine_wavenumbers(K, r) ** 2), load.moments(lateral))
