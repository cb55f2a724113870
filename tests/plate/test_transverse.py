"""Transverse matrices: energies of given shapes, and the stress term against membrane and quadrature."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.polynomial import Legendre
from numpy.typing import NDArray
from scipy.integrate import dblquad

from plate import EdgeLoad, MovingPlate, transverse
from plate.basis import gauss_legendre

K, LATERAL, R, NU = 4, 6, 1.5, 0.3


def bending_energy(w: NDArray[np.float64], nu: float) -> float:
    """Twice the bending energy of sum w[k, l] s_k q_l, from numpy's polynomials on a fine grid."""
    X, W_X = gauss_legendre(60, 0.0, R)
    Y, W_Y = gauss_legendre(30, 0.0, 1.0)
    q = [np.sqrt(2 * l + 1) * Legendre.basis(l, domain=[0, 1]) for l in range(LATERAL)]
    a = np.pi * np.arange(1, K + 1) / R
    s, c = np.sqrt(2 / R) * np.sin(np.outer(X, a)), np.sqrt(2 / R) * np.cos(np.outer(X, a))
    value, slope, curvature = (np.array([(p.deriv(m) if m else p)(Y) for p in q]) for m in (0, 1, 2))
    w_XX, w_YY, w_XY = -s * a**2 @ w @ value, s @ w @ curvature, c * a @ w @ slope
    return float(W_X @ (w_XX**2 + w_YY**2 + 2 * nu * w_XX * w_YY + 2 * (1 - nu) * w_XY**2) @ W_Y)


@pytest.mark.parametrize("nu", [-0.5, 0.0, 0.3, 0.5])
def test_elastic_stiffness_is_the_bending_energy(nu: float) -> None:
    K_oe = transverse.elastic_stiffness(K, LATERAL, R, nu)
    np.testing.assert_allclose(K_oe, K_oe.T, rtol=1e-14)
    for seed in range(3):
        w = np.random.default_rng(seed).normal(size=(K, LATERAL))
        assert w.ravel() @ K_oe @ w.ravel() == pytest.approx(bending_energy(w, nu), rel=1e-11)
    assert np.linalg.eigvalsh(K_oe)[0] > 0


def test_gyroscopic_matrix_is_skew_and_couples_odd_with_even() -> None:
    G = transverse.gyroscopic(K, LATERAL, R)
    np.testing.assert_array_equal(G, -G.T)
    # 2 (s_1', s_2) = 2 (2/R) (pi/R) int cos(pi X/R) sin(2 pi X/R) dX = 16 / (3 R)
    np.testing.assert_allclose(G[LATERAL : 2 * LATERAL, :LATERAL], 16 / (3 * R) * np.eye(LATERAL), rtol=1e-14)
    np.testing.assert_array_equal(G[2 * LATERAL : 3 * LATERAL, :LATERAL], 0.0)


def stresses_on(rules: tuple[transverse.Rule, transverse.Rule], *functions: object) -> NDArray[np.float64]:
    X, Y = np.meshgrid(rules[0][0], rules[1][0], indexing="ij")
    return np.array([np.broadcast_to(f(X, Y), X.shape) for f in functions])  # type: ignore[operator]


def zero(X: NDArray[np.float64], Y: NDArray[np.float64]) -> NDArray[np.float64]:
    return 0 * X


def test_uniform_tension_is_minus_the_transport_stiffness() -> None:
    F = transverse.membrane_stiffness(EdgeLoad.uniform().static, K, LATERAL, R)
    np.testing.assert_allclose(F, -transverse.transport_stiffness(K, LATERAL, R), atol=1e-12)


def test_membrane_stress_by_quadrature() -> None:
    rules = transverse.stress_quadrature(K, LATERAL, R, (9, 9))
    stresses = stresses_on(rules, lambda X, Y: 6 * Y * (1 - Y), zero, zero)
    F = transverse.stress_stiffness(stresses, *rules, K, LATERAL, R)
    np.testing.assert_allclose(
        F, transverse.membrane_stiffness(EdgeLoad.parabolic().static, K, LATERAL, R), rtol=1e-12, atol=1e-11
    )


def test_stress_stiffness_against_adaptive_quadrature() -> None:
    # An entry of each kind, for stresses that vary in both directions.
    functions = (lambda X, Y: X * Y, lambda X, Y: 1 + X**2, lambda X, Y: np.sin(np.pi * X / R) * Y)
    rules = transverse.stress_quadrature(K, LATERAL, R, (9, 9))
    F = transverse.stress_stiffness(stresses_on(rules, *functions), *rules, K, LATERAL, R)
    q = [np.sqrt(2 * l + 1) * Legendre.basis(l, domain=[0, 1]) for l in range(LATERAL)]

    def gradient(X: float, Y: float, k: int, l: int) -> tuple[float, float]:
        a = k * np.pi / R
        return np.sqrt(2 / R) * a * np.cos(a * X) * q[l](Y), np.sqrt(2 / R) * np.sin(a * X) * q[l].deriv()(Y)

    for (i, j), (k, l) in (((1, 2), (1, 2)), ((1, 1), (2, 3)), ((3, 0), (2, 5))):

        def integrand(Y: float, X: float, i: int = i, j: int = j, k: int = k, l: int = l) -> float:
            (f_X, f_Y), (w_X, w_Y) = gradient(X, Y, i, j), gradient(X, Y, k, l)
            N_xx, N_yy, N_xy = (f(X, Y) for f in functions)
            return N_xx * w_X * f_X + N_yy * w_Y * f_Y + N_xy * (w_Y * f_X + w_X * f_Y)

        exact = dblquad(integrand, 0, R, 0, 1, epsabs=1e-9)[0]
        entry = F[(i - 1) * LATERAL + j, (k - 1) * LATERAL + l]
        assert entry == pytest.approx(exact, rel=1e-9, abs=1e-8)
    np.testing.assert_array_equal(F, F.T)


@pytest.mark.parametrize(("axial", "inplane"), [(1, 2), (4, 9), (10, 15), (30, 40)])
def test_quadrature_is_exact_to_rounding(axial: int, inplane: int) -> None:
    rules = transverse.stress_quadrature(axial, 3, 1.0, (inplane, 4))
    finer = gauss_legendre(2 * rules[0][0].size, 0.0, 1.0), gauss_legendre(2 * rules[1][0].size, 0.0, 1.0)
    # the highest functions of the in-plane trial space: u_X, v_Y, v_X
    highest = (
        lambda X, Y: Legendre.basis(inplane - 1, domain=[0, 1]).deriv()(X) / inplane**2 * Y**3,
        lambda X, Y: np.sin(inplane * np.pi * X) * Y**2,
        lambda X, Y: np.cos(inplane * np.pi * X) * Y**3,
    )
    F, exact = (
        transverse.stress_stiffness(stresses_on(pair, *highest), *pair, axial, 3, 1.0) for pair in (rules, finer)
    )
    np.testing.assert_allclose(F, exact, atol=1e-12 * np.abs(exact).max())


@pytest.mark.parametrize("inplane", ["membrane", "static", "dynamic"])
@pytest.mark.parametrize(
    ("load", "uncoupled"),
    [
        (EdgeLoad.uniform(), True),
        (EdgeLoad.partial(0.5, 0.5), True),
        (EdgeLoad.parabolic(0.5), True),
        (EdgeLoad.linear(0.5, 1.5), False),
        (EdgeLoad.partial(0.5, 0.5 + 1e-9), False),
    ],
)
def test_a_symmetric_load_couples_even_with_odd_exactly_nowhere(load: EdgeLoad, uncoupled: bool, inplane: str) -> None:
    plate = MovingPlate(load=load, inplane=inplane, axial_terms=2, lateral_terms=4)
    system = plate.at(20.0)
    parity = np.arange(system.size) % 4 % 2
    between = parity[:, None] != parity
    for matrices in (system.stiffness, system.cosine):
        assert matrices[..., between].any() != uncoupled
