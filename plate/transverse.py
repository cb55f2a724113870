"""Transverse problem: the matrices of eq. (11), from the weak form (10) in the trial space (9).

The factor of s_k(X) q_l(Y), k = 1..K and l = 0..L, is coordinate (k - 1) (L + 1) + l: every matrix is a sum of
Kronecker products of an axial and a lateral matrix. Since the basis is orthonormal, M is the identity.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from periodic import Term, waveforms
from periodic.checks import FloatArray
from plate.basis import (
    gauss_legendre,
    kronecker,
    legendre,
    legendre_derivative,
    sine_derivative,
    sine_slopes,
    sine_wavenumbers,
    sines,
)
from plate.distribution import Distribution

# Couplings of even with odd lateral functions below this part of the largest entry are rounding of the quadrature.
PARITY_ROUNDING = 1e-14

# Whose rate of strain the damping opposes.
PLATE_DERIVATIVES = ("partial", "material")

Rule = tuple[FloatArray, FloatArray]
NumericArray = NDArray[Any]

# Gauss nodes beyond the pi m / 4 that resolve m half waves: the error is then below rounding (tested by doubling).
SPARE_QUADRATURE_NODES = 16


def gyroscopic(K: int, lateral: int, r: float) -> FloatArray:
    """Return G_o of eq. (11), 2 (w_X, phi): skew-symmetric, shape (K lateral, K lateral)."""
    return kronecker(2 * sine_derivative(K, r), np.eye(lateral))


def elastic_stiffness(K: int, lateral: int, r: float, nu: float) -> FloatArray:
    """Return K_oe of eq. (11): bending stiffness of the plate, simply supported at x = 0, a and free at y = 0, b."""
    one_x, one_y = np.eye(K), np.eye(lateral)
    alpha2 = np.diag(sine_wavenumbers(K, r) ** 2)  # s_k'' = -alpha_k^2 s_k
    D = legendre_derivative(lateral)
    D2 = D @ D
    return (
        kronecker(alpha2 @ alpha2, one_y)  # (w_XX, phi_XX)
        + kronecker(one_x, D2.T @ D2)  # (w_YY, phi_YY)
        - nu * kronecker(alpha2, D2 + D2.T)  # nu (w_XX, phi_YY) + nu (w_YY, phi_XX)
        + 2 * (1 - nu) * kronecker(alpha2, D.T @ D)  # 2 (1 - nu) (w_XY, phi_XY)
    )


def transport_stiffness(K: int, lateral: int, r: float) -> FloatArray:
    """Return K_og of eq. (11), -(w_X, phi_X): negative definite."""
    return -kronecker(np.diag(sine_wavenumbers(K, r) ** 2), np.eye(lateral))


def carried_bending(K: int, lateral: int, r: float, nu: float) -> FloatArray:
    """Return W_m = a(w_X, phi), a(w, phi) being the form of `elastic_stiffness`: the rate of change of the strain
    that the plate carries past a place. Only its part without twist is skew."""
    one_y = np.eye(lateral)
    alpha2 = np.diag(sine_wavenumbers(K, r) ** 2)
    B = sine_derivative(K, r)
    D = legendre_derivative(lateral)
    D2 = D @ D
    return (
        kronecker(alpha2 @ B @ alpha2, one_y)  # (w_XXX, phi_XX)
        + kronecker(B, D2.T @ D2)  # (w_XYY, phi_YY)
        - nu * (kronecker(B @ alpha2, D2.T) + kronecker(alpha2 @ B, D2))  # nu (w_XXX, phi_YY) + nu (w_XYY, phi_XX)
        + 2 * (1 - nu) * kronecker(B @ alpha2, D.T @ D)  # 2 (1 - nu) (w_XXY, phi_XY)
    )


def acceleration_stiffness(K: int, lateral: int, r: float, held_at: float | None) -> FloatArray:
    """Return the stiffness for each acceleration V': (w_X, phi), skew, and, where the tension N_xx = V' (X - X_0)
    accelerates the web along x, ((X - X_0) w_X, phi_X), symmetric, with X_0 = ``held_at``."""
    A = sine_derivative(K, r)
    if held_at is not None:
        X, weights = gauss_legendre(math.ceil(math.pi * 2 * K / 4) + SPARE_QUADRATURE_NODES, 0.0, r)
        s_X = sine_slopes(X, K, r)
        A = A + (s_X * (weights * (X - held_at))[:, None]).T @ s_X
    return kronecker(A, np.eye(lateral))


def speed_terms(
    Omega: float,
    speed: float,
    change: float,
    gyroscopic: FloatArray,
    transport: FloatArray,
    acceleration: FloatArray,
    carried: FloatArray,
) -> list[Term]:
    """Return the terms that eps V_1 cos Omega t adds to the system at the speed V_0.

    The equations at a speed V(t) are W'' + [V G_o + c K_oe] W' + [K + V^2 K_og + V' A + V c W_m] W = 0.

    Parameters
    ----------
    Omega : float
        Excitation frequency.
    speed, change : float
        V_0 and V_1.
    gyroscopic, transport : ndarray, shape (n, n)
        G_o and K_og.
    acceleration : ndarray, shape (n, n)
        A = (w_X, phi), and ((X - X_0) w_X, phi_X) if the tension accelerates the web along x.
    carried : ndarray, shape (n, n)
        c W_m, zero for the partial derivative.
    """
    return [
        Term("gyroscopic", change * gyroscopic, waveforms.cosine()),
        Term("stiffness", 2 * speed * change * transport + change * carried, waveforms.cosine()),
        Term("stiffness", -Omega * change * acceleration, waveforms.sine()),  # V' = - eps V_1 Omega sin Omega t
        # V^2 has eps^2 V_1^2 cos^2 Omega t
        Term("stiffness", change**2 / 2 * transport, waveforms.constant(), power=2),
        Term("stiffness", change**2 / 2 * transport, waveforms.cosine(2), power=2),
    ]


def membrane_stiffness(load: Distribution, K: int, lateral: int, r: float) -> FloatArray:
    """Return F of eq. (11) for the stresses N_xx = f(y), N_yy = N_xy = 0: (f w_X, phi_X)."""
    return uncoupled_parities(kronecker(np.diag(sine_wavenumbers(K, r) ** 2), load.moments(lateral)), lateral)


def stress_quadrature(K: int, lateral: int, r: float, inplane_terms: tuple[int, int]) -> tuple[Rule, Rule]:
    """Return Gauss rules along x and across y that integrate `stress_stiffness` to rounding.

    Across y the integrand is a polynomial and its rule exact. Along x it is a polynomial, or sines of at most
    ``inplane_terms[0]`` half waves, times sines of at most 2 K half waves together; Gauss's rule resolves m half waves
    with pi m / 4 nodes and converges faster than exponentially beyond.
    """
    axial, across = inplane_terms
    phase = math.pi * (axial + 2 * K)
    X_rule = gauss_legendre(math.ceil(axial / 2 + phase / 4) + SPARE_QUADRATURE_NODES, 0.0, r)
    Y_rule = gauss_legendre((across - 1 + 2 * (lateral - 1)) // 2 + 1, 0.0, 1.0)
    return X_rule, Y_rule


def stress_stiffness(
    stresses: NumericArray, X_rule: Rule, Y_rule: Rule, K: int, lateral: int, r: float
) -> NumericArray:
    """Return F of eq. (11) for N_xx, N_yy, N_xy given on the nodes of two rules.

    Parameters
    ----------
    stresses : ndarray, shape (..., 3, p, q)
        Values on the p nodes of ``X_rule`` and the q nodes of ``Y_rule``.

    Returns
    -------
    ndarray, shape (..., K lateral, K lateral)
        Symmetric, real or complex as the stresses are.
    """
    (X, X_weights), (Y, Y_weights) = X_rule, Y_rule
    s, s_X = sines(X, K, r), sine_slopes(X, K, r)
    q = legendre(Y, lateral)
    q_Y = q @ legendre_derivative(lateral)
    N_xx, N_yy, N_xy = np.moveaxis(stresses, -3, 0)

    def integral(N: NumericArray, axial: tuple[FloatArray, FloatArray], across: tuple[FloatArray, FloatArray]) -> Any:
        return _products(*axial, X_weights).T @ N @ _products(*across, Y_weights)

    # each with the test function first, the trial function second
    F = (
        integral(N_xx, (s_X, s_X), (q, q))  # (N_xx w_X, phi_X)
        + integral(N_yy, (s, s), (q_Y, q_Y))  # (N_yy w_Y, phi_Y)
        + integral(N_xy, (s_X, s), (q, q_Y))  # (N_xy w_Y, phi_X)
        + integral(N_xy, (s, s_X), (q_Y, q))  # (N_xy w_X, phi_Y)
    )
    F = F.reshape(*F.shape[:-2], K, K, lateral, lateral).swapaxes(-3, -2)
    F = F.reshape(*F.shape[:-4], K * lateral, K * lateral)
    return uncoupled_parities((F + F.swapaxes(-1, -2)) / 2, lateral)


def uncoupled_parities(F: NumericArray, lateral: int) -> NumericArray:
    """Return F with exact zeros where a load symmetric about the mid-line couples nothing.

    Stresses even about the mid-line couple no even with odd lateral functions. Quadrature leaves rounding there; if
    that is all, it becomes the zero that it stands for. Other loads keep their couplings.
    """
    parity = np.arange(F.shape[-1]) % lateral % 2
    between = parity[:, None] != parity
    largest = np.abs(F).max(axis=(-2, -1))
    uncoupled = np.abs(F[..., between]).max(axis=-1, initial=0.0) <= PARITY_ROUNDING * largest
    return np.where(between & uncoupled[..., None, None], 0.0, F)


def _products(test: FloatArray, trial: FloatArray, weights: FloatArray) -> FloatArray:
    """Return test_i trial_k at each node times its weight, shape (nodes, test functions * trial functions)."""
    return (weights[:, None, None] * test[:, :, None] * trial[:, None, :]).reshape(weights.size, -1)


def deflection(W: NumericArray, axial: int, lateral: int, r: float, X: FloatArray, Y: FloatArray) -> NumericArray:
    """Return the deflection w of coordinates W at places, eq. (9).

    Parameters
    ----------
    W : ndarray, shape (..., axial * lateral)
        Coordinates of the plate's system.
    axial, lateral : int
        ``plate.terms.axial`` and ``plate.terms.lateral``.
    r : float
        ``plate.aspect_ratio``.
    X : ndarray, shape (p,)
        x/b from 0 to r.
    Y : ndarray, shape (q,)
        y/b from 0 to 1.

    Returns
    -------
    ndarray, shape (..., q, p)
        Rows follow y.
    """
    coordinates = np.asarray(W).reshape(*np.shape(W)[:-1], axial, lateral)
    return np.einsum("...kl,pk,ql->...qp", coordinates, sines(X, axial, r), legendre(Y, lateral))
