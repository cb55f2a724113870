"""Systems with exact solutions, random ones, and what tests of balls ask."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest

from periodic import PeriodicSystem
from periodic.checks import FloatArray

flint = pytest.importorskip("flint", reason="python-flint, the extra certify, is not installed")
from flint import arb, arb_mat  # noqa: E402

OMEGA = 0.75


def whittaker_hill(kappa: float, spin: float = 0.0, decay: float = 0.0, phase: str = "cosine") -> PeriodicSystem:
    """Two oscillators with a motion in closed form; exact in float64 if the parameters are short binary numbers.

    u = exp(-kappa cos Omega t) solves u'' + (a + b cos Omega t + c cos 2 Omega t) u = 0, Whittaker and Hill's equation,
    with a = -c = -kappa^2 Omega^2 / 2, b = -kappa Omega^2; and x + i y = u exp(-(decay + i spin) t) solves the system
    returned, which has gyroscopic, damping and circulatory terms. "sine" has sin Omega t in the place of cos Omega t.
    """
    k2 = (kappa * OMEGA) ** 2 / 2
    swap = np.array([[0.0, -1.0], [1.0, 0.0]])
    one = np.eye(2)
    zero = np.zeros((2, 2))
    first = -kappa * OMEGA**2 * one
    cosine, sine = ([first, k2 * one], None) if phase == "cosine" else ([zero, -k2 * one], [first, zero])
    return PeriodicSystem(
        mass=one,
        gyroscopic=2 * spin * swap,
        damping=2 * decay * one,
        stiffness=(decay**2 - spin**2 - k2) * one + 2 * decay * spin * swap,
        cosine=cosine,
        sine=sine,
    )


def exact_whittaker_hill(kappa: float, spin: float, decay: float, phase: str) -> arb_mat:
    """Monodromy matrix of `whittaker_hill` in (x', y', x, y), at the working precision.

    With v(t) = u(t) int_0^t ds / u(s)^2, the second solution, int_0^T ds / u^2 = T I_0(2 kappa).
    """
    T = 2 * arb.pi() / arb(OMEGA)
    integral = T * (2 * arb(kappa)).bessel_i(0)
    if phase == "cosine":  # u(0) = e^-kappa, u'(0) = 0
        fixed = [[arb(1), arb(0)], [(-2 * arb(kappa)).exp() * integral, arb(1)]]  # of (u', u)
    else:  # u(0) = 1, u'(0) = -kappa Omega
        slope = arb(kappa) * arb(OMEGA)
        fixed = [[1 - slope * integral, -slope * slope * integral], [integral, 1 + slope * integral]]
    c, s = (arb(spin) * T).cos(), (arb(spin) * T).sin()
    turn = [[c, s], [-s, c]]  # multiplication by exp(-i spin T)
    pairs = list(product(range(2), repeat=2))
    Phi = arb_mat([[fixed[i][j] * turn[k][m] for j, m in pairs] for i, k in pairs])
    # (x + i y)' = (u' - (decay + i spin) u) exp(...)
    d, s = arb(decay), arb(spin)
    to_moving = arb_mat([[1, 0, -d, s], [0, 1, -s, -d], [0, 0, 1, 0], [0, 0, 0, 1]])
    return to_moving * Phi * to_moving.inv() * (-d * T).exp()


def random_system(seed: int, n: int, *, conservative: bool = False, harmonics: int = 2) -> PeriodicSystem:
    rng = np.random.default_rng(seed)

    def symmetric(shift: float = 0.0) -> FloatArray:
        a = rng.normal(size=(n, n))
        return a + a.T + shift * np.eye(n)

    a, g = rng.normal(size=(2, n, n))
    b = rng.normal(size=(n, n))
    F = [symmetric() if conservative else rng.normal(size=(n, n)) for _ in range(2 * harmonics)]
    return PeriodicSystem(
        mass=a @ a.T + n * np.eye(n),
        gyroscopic=0.5 * (g - g.T),
        damping=np.zeros((n, n)) if conservative else 0.05 * symmetric(),
        stiffness=(b @ b.T + n * np.eye(n)) if conservative else symmetric(3.0 * n),
        cosine=F[:harmonics],
        sine=F[harmonics:],
    )


def contains(ball: arb_mat, exact: arb_mat) -> bool:
    return all(x.contains(y) for x, y in zip(ball.entries(), exact.entries(), strict=True))


def largest_radius(matrix: arb_mat) -> float:
    return max(float(entry.rad()) for entry in matrix.entries())


def middle(matrix: arb_mat) -> FloatArray:
    return np.array([[float(x) for x in row] for row in matrix.tolist()])
