"""Random systems, the moving string, and growth rates by Hill's determinant for the tests of perturb/."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from periodic import PeriodicSystem, SystemFamily
from periodic.checks import FloatArray

Real = float | FloatArray  # one number
MATRICES = ("mass", "gyroscopic", "damping", "stiffness", "cosine", "sine")


def random_system(
    seed: int, n: int = 3, harmonics: int = 1, damping: float = 0.0, symmetric: bool = True, gyroscopic: float = 1.0
) -> PeriodicSystem:
    """A well-conditioned system with full matrices; ``damping`` scales a random positive definite C."""
    rng = np.random.default_rng(seed)
    A, B, D, S = rng.normal(size=(4, n, n))
    F = rng.normal(size=(2, harmonics, n, n))
    if symmetric:
        F = F + np.swapaxes(F, -1, -2)
    return PeriodicSystem(
        mass=A @ A.T + n * np.eye(n),
        gyroscopic=gyroscopic * (S - S.T),
        damping=damping * (D @ D.T + 0.2 * np.eye(n)),
        stiffness=3 * B @ B.T + n * np.eye(n),
        cosine=F[0],
        sine=F[1],
    )


def changed(system: PeriodicSystem, **matrices: Any) -> PeriodicSystem:
    """The same system with some matrices replaced."""
    return PeriodicSystem(**({name: getattr(system, name) for name in MATRICES} | matrices))


def congruent(system: PeriodicSystem, T: np.ndarray) -> PeriodicSystem:
    """The system in coordinates V, W = T V."""
    return PeriodicSystem(**{name: T.T @ getattr(system, name) @ T for name in MATRICES})


def copies(system: PeriodicSystem, count: int) -> PeriodicSystem:
    """``count`` copies of a system side by side, so that every frequency is repeated."""
    return PeriodicSystem(**{name: np.kron(np.eye(count), getattr(system, name)) for name in MATRICES})


def moving_string(v: float, n: int) -> PeriodicSystem:
    """String of unit length, tension and density moving at speed v, n sine functions; tension pulsates: 1 + eps cos.

    w'' + 2 v w'_x + (v^2 - 1 - eps cos Omega t) w_xx = 0. Exact frequencies k pi (1 - v^2).
    """
    k = np.arange(1, n + 1)
    row, column = np.meshgrid(k, k, indexing="ij")
    odd = (row + column) % 2 == 1
    slope = np.divide(2.0 * row * column, row**2 - column**2, out=np.zeros((n, n)), where=odd)  # (phi_k, d phi_l / dx)
    bending = np.diag((k * np.pi) ** 2 / 2)
    return PeriodicSystem(np.eye(n) / 2, 2 * v * slope, np.zeros((n, n)), (1 - v**2) * bending, [bending])


def hill_exponents(system: PeriodicSystem, Omega: float, eps: float, cut: int = 9) -> np.ndarray:
    """Floquet exponents lambda + i k Omega by Hill's method: the Fourier-transformed first-order equations.

    In physical coordinates and harmonics -cut..cut; those in the middle strips are hardly touched by the cut.
    """
    n, J, count = system.size, system.harmonics, 2 * cut + 1
    inverse = np.linalg.inv(system.mass)
    free = np.block(
        [
            [np.zeros((n, n)), np.eye(n)],
            [-inverse @ system.stiffness, -inverse @ (system.gyroscopic + system.damping)],
        ]
    )
    shift = np.diag(np.arange(-cut, cut + 1))
    hill = np.kron(np.eye(count), free) - 1j * Omega * np.kron(shift, np.eye(2 * n))
    for j in range(1, J + 1):
        push = np.zeros((2 * n, 2 * n), dtype=complex)
        push[n:, :n] = -0.5 * eps * inverse @ (system.cosine[j - 1] - 1j * system.sine[j - 1])
        hill = hill + np.kron(np.eye(count, k=-j), push) + np.kron(np.eye(count, k=j), push.conj())
    return np.linalg.eigvals(hill)


def hill_growth(system: PeriodicSystem, Omega: float, eps: float, cut: int = 9) -> float:
    """Largest growth rate by `hill_exponents`, from the middle strip."""
    values = hill_exponents(system, Omega, eps, cut)
    return float(values[np.abs(values.imag) <= 0.51 * Omega].real.max())


def hill_edges(
    system: PeriodicSystem, inside: Real, reach: Real, eps: float, threshold: float = 1e-7, cut: int = 9
) -> tuple[float, float]:
    """Edges of the unstable interval around ``inside`` by bisection on `hill_growth`; stable at inside ± reach.

    Undamped exponents that coalesce are exact to the square root of rounding, 1e-8, which is why ``threshold`` is
    above that; next to an edge the growth rate rises like a square root, so the edges are exact to its square.
    """
    edges = []
    for side in (-1, 1):
        unstable, stable = float(inside), float(inside + side * reach)
        assert hill_growth(system, unstable, eps, cut) > threshold >= hill_growth(system, stable, eps, cut)
        while abs(stable - unstable) > 1e-11:
            middle = 0.5 * (stable + unstable)
            if hill_growth(system, middle, eps, cut) > threshold:
                unstable = middle
            else:
                stable = middle
        edges.append(0.5 * (stable + unstable))
    return edges[0], edges[1]


def fitted_order(eps: np.ndarray, gap: np.ndarray) -> float:
    """Slope of log gap over log eps."""
    return float(np.polyfit(np.log(eps), np.log(gap), 1)[0])


def integrated_growth(family: SystemFamily, Omega: float, eps: float) -> float:
    """Largest growth rate from the Floquet multipliers of the equations integrated over one period by DOP853."""
    system, period = family.at(Omega), 2 * np.pi / Omega
    n, inverse = system.size, np.linalg.inv(system.mass)

    def rate(time: float, state: FloatArray) -> FloatArray:
        W, velocity = state.reshape(2, n, 2 * n)
        K = system.stiffness.copy()
        for j, (F_c, F_s) in enumerate(zip(system.cosine, system.sine, strict=True), start=1):
            K += eps * (np.cos(j * Omega * time) * F_c + np.sin(j * Omega * time) * F_s)
        push = -inverse @ (K @ W + (system.gyroscopic + system.damping) @ velocity)
        return np.concatenate([velocity.ravel(), push.ravel()])

    start = np.eye(2 * n).ravel()
    solution = solve_ivp(rate, (0.0, period), start, method="DOP853", rtol=1e-12, atol=1e-12)
    multipliers = np.linalg.eigvals(solution.y[:, -1].reshape(2 * n, 2 * n))
    return float(np.log(np.abs(multipliers).max()) / period)
