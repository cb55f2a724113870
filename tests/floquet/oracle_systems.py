"""Random systems, and monodromy matrices by another method, for the tests of the single-point integrator."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from periodic import PeriodicSystem
from tests.strategies import random_system

__all__ = ["dop853", "first_order", "random_system"]


def first_order(system: PeriodicSystem, Omega: float, eps: float, t: float) -> NDArray[np.float64]:
    """The matrix of q' = A(t) q, q = (W', W), straight from the definition of the system."""
    n = system.size
    S = system.stiffness.copy()
    for j in range(system.harmonics):
        phase = (j + 1) * Omega * t
        S += eps * (np.cos(phase) * system.cosine[j] + np.sin(phase) * system.sine[j])
    upper = -np.linalg.solve(system.mass, np.hstack([system.gyroscopic + system.damping, S]))
    return np.vstack([upper, np.eye(n, 2 * n)])


def dop853(system: PeriodicSystem, Omega: float, eps: float) -> NDArray[np.float64]:
    """Monodromy matrix by SciPy's Dormand-Prince method of order 8; its own error is 1e-13 to 1e-11."""
    N = 2 * system.size

    def rate(t: float, q: NDArray[np.float64]) -> NDArray[np.float64]:
        return (first_order(system, Omega, eps, t) @ q.reshape(N, N)).ravel()

    found = solve_ivp(rate, (0.0, 2 * np.pi / Omega), np.eye(N).ravel(), method="DOP853", rtol=1e-13, atol=1e-13)
    return found.y[:, -1].reshape(N, N)
