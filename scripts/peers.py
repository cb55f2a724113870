"""Other integrators at the task of the chart engine: log|mu| of single points, for `scripts/benchmark.py`.

Each peer is a function of a system that returns a list of (setting, function of (Omega, eps)), from cheap to accurate.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numba import carray, njit
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from periodic import PeriodicSystem

Array = NDArray[np.float64]
Point = Callable[[float, float], float]
Settings = list[tuple[str, Point]]


def log_modulus(Phi: Array) -> float:
    """Return log|mu| of the dominant multiplier of a monodromy matrix."""
    return float(np.log(np.abs(np.linalg.eigvals(Phi)).max()))


def matrices(system: PeriodicSystem) -> tuple[Array, Array]:
    """Return A and F of W'' = A (W, W') - eps cos(Omega t) F W; one cosine harmonic."""
    constant = np.hstack([system.stiffness, system.gyroscopic + system.damping])
    return -np.linalg.solve(system.mass, constant), np.linalg.solve(system.mass, system.cosine[0])


def scipy_dop853(system: PeriodicSystem) -> Settings:
    """SciPy's DOP853 on the matrix equation."""
    A, F = matrices(system)
    n = system.size

    def point(rtol: float) -> Point:
        def integrate(Omega: float, eps: float) -> float:
            def rate(t: float, y: Array) -> Array:
                Y = y.reshape(2 * n, 2 * n)
                acceleration = A @ Y - (eps * np.cos(Omega * t) * F) @ Y[:n]
                return np.concatenate([Y[n:].ravel(), acceleration.ravel()])

            start = np.eye(2 * n).ravel()
            end = solve_ivp(rate, (0, 2 * np.pi / Omega), start, method="DOP853", rtol=rtol, atol=rtol)
            return log_modulus(end.y[:, -1].reshape(2 * n, 2 * n))

        return integrate

    return [(f"rtol {10.0**-k:.0e}", point(10.0**-k)) for k in range(2, 12)]


@njit
def _rk4(A: Array, F: Array, Omega: float, eps: float, steps: int) -> Array:
    n = F.shape[0]
    h = 2 * np.pi / Omega / steps
    Y = np.eye(2 * n)
    rate = np.zeros((2 * n, 2 * n))
    for step in range(steps):
        total = np.zeros((2 * n, 2 * n))
        for stage, weight in ((0.0, 1.0), (0.5, 2.0), (0.5, 2.0), (1.0, 1.0)):
            Z = Y + (stage * h) * rate
            rate = np.empty((2 * n, 2 * n))
            rate[:n] = Z[n:]
            rate[n:] = np.dot(A, Z) - np.dot((eps * np.cos(Omega * h * (step + stage))) * F, Z[:n])
            total += weight * rate
        Y = Y + (h / 6) * total
    return Y


def numba_rk4(system: PeriodicSystem) -> Settings:
    """The classical Runge-Kutta method with a fixed step, compiled; the step follows the fastest mode."""
    A, F = matrices(system)
    fastest = np.abs(np.linalg.eigvals(np.vstack([np.eye(system.size, 2 * system.size, system.size), A]))).max()

    def point(steps_a_cycle: float) -> Point:
        def integrate(Omega: float, eps: float) -> float:
            return log_modulus(_rk4(A, F, Omega, eps, int(np.ceil(steps_a_cycle * fastest / Omega))))

        return integrate

    return [(f"{4 * 2 ** (k / 2):.0f} steps a cycle", point(4 * 2 ** (k / 2))) for k in range(14)]


def cyrk_dop853(system: PeriodicSystem) -> Settings:
    """CyRK's DOP853 in C++, with a compiled right-hand side."""
    from CyRK import nb_diffeq_addr, nbsolve2_ivp

    A, F = matrices(system)
    n = system.size
    N = 2 * n

    def rate(dy, t, y, data):  # type: ignore[no-untyped-def]
        Y, dY, numbers = carray(y, (N, N)), carray(dy, (N, N)), carray(data, (2 + 3 * n * n,))
        a, f = numbers[2 : 2 + 2 * n * n].reshape(n, N), numbers[2 + 2 * n * n :].reshape(n, n)
        dY[:n] = Y[n:]
        dY[n:] = np.dot(a, Y) - np.dot((numbers[1] * np.cos(numbers[0] * t)) * f, Y[:n])

    address = nb_diffeq_addr(rate)

    def point(rtol: float) -> Point:
        def integrate(Omega: float, eps: float) -> float:
            data = np.concatenate([[Omega, eps], A.ravel(), F.ravel()])
            period = (0.0, 2 * np.pi / Omega)
            found = nbsolve2_ivp(address, period, np.eye(N).ravel(), method="DOP853", args=data, rtol=rtol, atol=rtol)
            Phi = np.array(found.y)[:, -1].reshape(N, N)
            found.free()
            return log_modulus(Phi)

        return integrate

    return [(f"rtol {10.0**-k:.0e}", point(10.0**-k)) for k in range(2, 12)]


def heyoka_batch(system: PeriodicSystem) -> Settings:
    """heyoka's Taylor integrator, eight columns of the monodromy matrix at a time."""
    import heyoka as hy

    A, F = matrices(system)
    n, lanes = system.size, 8
    names = [f"{kind}{i}" for kind in "xv" for i in range(n)]
    state = hy.make_vars(*names)
    kick = hy.par[1] * hy.cos(hy.par[0] * hy.time)
    equations = [(state[i], state[n + i]) for i in range(n)]
    for i in range(n):
        free = hy.sum([A[i, j] * state[j] for j in range(2 * n)])
        driven = hy.sum([F[i, j] * state[j] for j in range(n)])
        equations.append((state[n + i], free - kick * driven))

    def point(tol: float) -> Point:
        start = np.zeros((2 * n, lanes))
        integrator = hy.taylor_adaptive_batch(equations, start, tol=tol, compact_mode=True, pars=np.zeros((2, lanes)))

        def integrate(Omega: float, eps: float) -> float:
            Phi = np.empty((2 * n, 2 * n))
            integrator.pars[0], integrator.pars[1] = Omega, eps
            for first in range(0, 2 * n, lanes):
                columns = np.arange(first, first + lanes) % (2 * n)
                integrator.set_time(0.0)
                integrator.state[:] = np.eye(2 * n)[:, columns]
                integrator.propagate_until(2 * np.pi / Omega)
                Phi[:, columns] = integrator.state
            return log_modulus(Phi)

        return integrate

    return [("tol 1e-09", point(1e-9))]  # looser ones save little: the order follows the tolerance


PEERS = {
    "SciPy DOP853": scipy_dop853,
    "Numba RK4": numba_rk4,
    "CyRK DOP853": cyrk_dop853,
    "heyoka, batch of 8": heyoka_batch,
}
