"""What others would use to find multipliers at a point: the methods that `benchmarks.methods` times."""

from __future__ import annotations

import importlib
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numba
import numpy as np
import scipy.integrate
import scipy.linalg

from periodic import PeriodicSystem
from periodic.checks import FloatArray

# Entries below this part of the largest are rounding left by the change of coordinates. Leaving them out helps heyoka.
NEGLIGIBLE_ENTRY = 1e-14
# Doubles in the widest SIMD register that heyoka may use.
MAX_HEYOKA_LANES = 8


class Equations(NamedTuple):
    """r'' + velocity r' + (stiffness + eps sum_j [cosine_j cos(j Omega t) + sine_j sin(j Omega t)]) r = 0."""

    velocity: FloatArray
    stiffness: FloatArray
    cosine: FloatArray
    sine: FloatArray


Solve = Callable[[float, float], FloatArray]


@dataclass(frozen=True)
class Peer:
    """A method: its name, the package it needs, how to set it up, and settings from cheap to accurate.

    ``prepare(equations, setting)`` returns a function of (Omega, eps) that gives the monodromy matrix in (r, r').
    What ``prepare`` does is not timed: it may compile. ``mixed``: its equations are those of a system of which nothing
    is known, see `mixed_equations`.
    """

    name: str
    package: str
    prepare: Callable[[Equations, float], Solve]
    settings: tuple[float, ...]
    mixed: bool = False

    @property
    def missing(self) -> str:
        """Why the method cannot be used; empty if it can."""
        try:
            importlib.import_module(self.package)
        except ImportError:
            return f"{self.package} is not installed; pip install 'floquet-charts[bench]'"
        return ""


def modal_equations(system: PeriodicSystem) -> Equations:
    """Return the system in coordinates in which its mass is 1 and its symmetric stiffness diagonal."""
    _, modes = scipy.linalg.eigh(0.5 * (system.stiffness + system.stiffness.T), system.mass)

    def transformed(matrix: FloatArray) -> FloatArray:
        found = np.asarray(modes.T @ matrix @ modes)
        found[np.abs(found) < NEGLIGIBLE_ENTRY * np.abs(found).max()] = 0.0
        return np.ascontiguousarray(found)

    return Equations(
        transformed(system.gyroscopic + system.damping),
        transformed(system.stiffness),
        transformed(system.cosine),
        transformed(system.sine),
    )


def mixed_equations(equations: Equations) -> Equations:
    """Return the same system in coordinates turned at random, in which no entry of a matrix is zero: as it comes from a
    program that knows nothing of its modes and of their symmetries. To a matrix product this is the same."""
    n = len(equations.velocity)
    turn = np.linalg.qr(np.random.default_rng(0).standard_normal((n, n)))[0]
    return Equations(*(np.ascontiguousarray(turn.T @ matrices @ turn) for matrices in equations))


def dop853(equations: Equations, rtol: float) -> Solve:
    """SciPy's DOP853 on all columns of the matrix at once."""
    constant = -np.hstack([equations.stiffness, equations.velocity])
    # zero matrices are left out: a plate has cosines alone
    waves = [
        (wave, j + 1, matrices[j])
        for wave, matrices in ((math.cos, equations.cosine), (math.sin, equations.sine))
        for j in range(len(matrices))
        if matrices[j].any()
    ]
    n = len(equations.velocity)

    def solve(Omega: float, eps: float) -> FloatArray:
        def derivative(t: float, y: FloatArray) -> FloatArray:
            Y = y.reshape(2 * n, 2 * n)
            acceleration = constant @ Y
            for wave, j, matrix in waves:
                acceleration -= (eps * wave(j * Omega * t) * matrix) @ Y[:n]
            return np.concatenate([Y[n:], acceleration]).ravel()

        period = (0.0, 2 * np.pi / Omega)
        found = scipy.integrate.solve_ivp(
            derivative, period, np.eye(2 * n).ravel(), method="DOP853", rtol=rtol, atol=rtol
        )
        return np.asarray(found.y[:, -1]).reshape(2 * n, 2 * n)

    return solve


def runge_kutta(equations: Equations, steps: float) -> Solve:
    """The classical Runge-Kutta method of fourth order with fixed steps, compiled."""
    return lambda Omega, eps: rk4(*equations, Omega, eps, int(steps))


# Each of these expressions takes a second or more to compile, and would again wherever it stood.
@numba.njit(cache=True, nogil=True)
def acceleration(stiffness: FloatArray, velocity: FloatArray, r: FloatArray, rate: FloatArray) -> FloatArray:
    return -(stiffness @ r + velocity @ rate)


@numba.njit(cache=True, nogil=True)
def moved(y: FloatArray, h: float, slope: FloatArray) -> FloatArray:
    return y + h * slope


@numba.njit(cache=True, nogil=True)
def weighted(y: FloatArray, h: float, a: FloatArray, b: FloatArray, c: FloatArray, d: FloatArray) -> FloatArray:
    return y + h / 6 * (a + 2 * b + 2 * c + d)


@numba.njit(cache=True, nogil=True)
def rk4(
    velocity: FloatArray,
    stiffness: FloatArray,
    cosine: FloatArray,
    sine: FloatArray,
    Omega: float,
    eps: float,
    steps: int,
) -> FloatArray:
    n = len(velocity)
    h = 2 * np.pi / Omega / steps
    r, rate = np.eye(n, 2 * n), np.eye(n, 2 * n, n)
    K = np.empty((3, n, n))  # at the beginning, the middle and the end of a step
    for step in range(steps):
        for stage in range(3):
            K[stage] = stiffness
            for j in range(len(cosine)):
                phase = (j + 1) * Omega * h * (step + 0.5 * stage)
                K[stage] += eps * (np.cos(phase) * cosine[j] + np.sin(phase) * sine[j])
        r1, v1 = rate, acceleration(K[0], velocity, r, rate)
        r2 = moved(rate, 0.5 * h, v1)
        v2 = acceleration(K[1], velocity, moved(r, 0.5 * h, r1), r2)
        r3 = moved(rate, 0.5 * h, v2)
        v3 = acceleration(K[1], velocity, moved(r, 0.5 * h, r2), r3)
        r4 = moved(rate, h, v3)
        v4 = acceleration(K[2], velocity, moved(r, h, r3), r4)
        r, rate = weighted(r, h, r1, r2, r3, r4), weighted(rate, h, v1, v2, v3, v4)
    return np.concatenate((r, rate))


def cyrk(equations: Equations, rtol: float) -> Solve:
    """CyRK's DOP853, in C++, on all columns of the matrix at once; the derivative is compiled by Numba."""
    CyRK: Any = importlib.import_module("CyRK")
    size = 2 * len(equations.velocity)

    def solve(Omega: float, eps: float) -> FloatArray:
        found = CyRK.pysolve_ivp(
            derivative,
            (0.0, 2 * np.pi / Omega),
            np.eye(size).ravel(),
            method="DOP853",
            args=(*equations, Omega, eps),
            rtol=rtol,
            atol=rtol,
            pass_dy_as_arg=True,
        )
        return np.array(found.y[:, -1]).reshape(size, size)

    return solve


@numba.njit(cache=True, nogil=True)
def derivative(
    out: FloatArray,
    t: float,
    y: FloatArray,
    velocity: FloatArray,
    stiffness: FloatArray,
    cosine: FloatArray,
    sine: FloatArray,
    Omega: float,
    eps: float,
) -> None:
    n = len(velocity)
    half = 2 * n * n
    K = stiffness.copy()
    for j in range(len(cosine)):
        phase = (j + 1) * Omega * t
        K += eps * (np.cos(phase) * cosine[j] + np.sin(phase) * sine[j])
    r, rate = y[:half].copy().reshape(n, 2 * n), y[half:].copy().reshape(n, 2 * n)
    out[:half] = y[half:]
    out[half:] = -(K @ r + velocity @ rate).ravel()


def heyoka_scalar(equations: Equations, tolerance: float) -> Solve:
    """heyoka's Taylor integrator, one column of the matrix after the other."""
    integrator = _taylor(equations, tolerance, 0)
    size = 2 * len(equations.velocity)

    def solve(Omega: float, eps: float) -> FloatArray:
        integrator.pars[:] = Omega, eps
        result = np.eye(size)
        for column in range(size):
            integrator.time = 0.0
            integrator.state[:] = result[:, column]
            integrator.propagate_until(2 * np.pi / Omega)
            result[:, column] = integrator.state
        return result

    return solve


def heyoka_batch(equations: Equations, tolerance: float) -> Solve:
    """heyoka's Taylor integrator in batch mode: as many columns of the matrix at once as SIMD has lanes."""
    heyoka: Any = importlib.import_module("heyoka")
    lanes = min(heyoka.recommended_simd_size(), MAX_HEYOKA_LANES)
    integrator = _taylor(equations, tolerance, lanes)
    size = 2 * len(equations.velocity)

    def solve(Omega: float, eps: float) -> FloatArray:
        integrator.pars[:] = np.array([[Omega], [eps]])
        result = np.eye(size)
        for column in range(0, size, lanes):
            columns = slice(column, min(column + lanes, size))
            integrator.set_time(0.0)
            integrator.state[:] = 0.0
            integrator.state[:, : columns.stop - column] = result[:, columns]
            integrator.propagate_until(2 * np.pi / Omega)
            result[:, columns] = integrator.state[:, : columns.stop - column]
        return result

    return solve


def _taylor(equations: Equations, tolerance: float, lanes: int) -> Any:
    """Return a compiled integrator with parameters (Omega, eps); scalar if there are no lanes."""
    heyoka: Any = importlib.import_module("heyoka")
    n = len(equations.velocity)
    r, rate = (heyoka.make_vars(*(f"{name}{i}" for i in range(n))) for name in "rv")

    def row(coefficients: FloatArray, variables: list[Any]) -> Any:
        return heyoka.sum([float(c) * x for c, x in zip(coefficients, variables, strict=True) if c != 0.0])

    Omega, eps = heyoka.par[0], heyoka.par[1]
    waves = [
        (eps * wave((j + 1.0) * Omega * heyoka.time), matrices[j])
        for wave, matrices in ((heyoka.cos, equations.cosine), (heyoka.sin, equations.sine))
        for j in range(len(matrices))
        if matrices[j].any()
    ]
    accelerations = [
        heyoka.sum(
            [row(-equations.stiffness[i], r), row(-equations.velocity[i], rate)]
            + [factor * row(-matrix[i], r) for factor, matrix in waves]
        )
        for i in range(n)
    ]
    system = [*zip(r, rate, strict=True), *zip(rate, accelerations, strict=True)]
    # compact_mode: without it, code for more than a few coordinates takes minutes to compile
    if lanes == 0:
        return heyoka.taylor_adaptive(system, np.zeros(2 * n), pars=np.zeros(2), tol=tolerance, compact_mode=True)
    return heyoka.taylor_adaptive_batch(
        system, np.zeros((2 * n, lanes)), pars=np.zeros((2, lanes)), tol=tolerance, compact_mode=True
    )


DOP853_TOLERANCES = tuple(10.0**-k for k in range(1, 14))
# Steps in a period. A factor of sqrt(2) between them is one of 4 in the error.
RUNGE_KUTTA_STEPS = tuple(float(round(2 ** (k / 2))) for k in range(10, 34))
# Bounds of the remainder of each Taylor series, from which heyoka finds the order of the series.
HEYOKA_TOLERANCES = tuple(10.0**-k for k in range(1, 16))
PEERS = (
    Peer("SciPy DOP853", "scipy", dop853, DOP853_TOLERANCES),
    Peer("Runge-Kutta 4, Numba", "numba", runge_kutta, RUNGE_KUTTA_STEPS),
    Peer("CyRK DOP853", "CyRK", cyrk, DOP853_TOLERANCES),
    Peer("heyoka, scalar", "heyoka", heyoka_scalar, HEYOKA_TOLERANCES),
    Peer("heyoka, batch", "heyoka", heyoka_batch, HEYOKA_TOLERANCES),
    Peer("heyoka, batch, no zeros", "heyoka", heyoka_batch, HEYOKA_TOLERANCES, mixed=True),
)
