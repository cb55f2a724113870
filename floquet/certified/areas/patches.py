"""The monodromy matrix over a rectangle of (1 / Omega, eps): one Taylor model (docs/certify.md, section 7)."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numba import njit

from floquet.certified.areas.coefficients import Coefficients
from floquet.certified.areas.models import ROUNDING, SAFE, TINY, Model, constant, size
from periodic.checks import FloatArray

# Length of a step times the norm of the equation's matrix, and the part of the tolerance that the remainders of all
# steps together may take.
STEP_NORM, REMAINDER_PART = 1.2, 1e-4
# Radii of the majorant's disc that are tried, in steps.
DISC_RADII = np.geomspace(1.5, 200.0, 60)
# Highest order of a step.
MAX_STEP_ORDER = 60


class Patch(NamedTuple):
    """Phi over 1 / Omega = l0 + h1 xi, eps = e0 + h2 eta, |xi|, |eta| <= 1, in the coordinates of `Coefficients`."""

    l0: float
    h1: float
    e0: float
    h2: float
    model: Model


class Steps(NamedTuple):
    """How the period is cut, and what bounds the error of each step."""

    number: int
    order: int
    radius: float


def patch_of(
    equation: Coefficients, l0: float, h1: float, e0: float, h2: float, degree: int, tolerance: float
) -> Patch:
    """Return the model of the monodromy matrix; its radius may be anything, also infinite."""
    steps = _steps(equation, l0, h1, e0, h2, degree, tolerance)
    if not math.isfinite(steps.radius):
        return Patch(l0, h1, e0, h2, constant(np.eye(len(equation.A)), degree, math.inf))
    return Patch(l0, h1, e0, h2, _period(equation, steps, (l0, h1, e0, h2), degree))


def _steps(equation: Coefficients, l0: float, h1: float, e0: float, h2: float, degree: int, tolerance: float) -> Steps:
    """Return a plan for little work; the radius holds for whatever plan it is."""
    largest, amplitude = l0 + h1, abs(e0) + h2
    rate = equation.norm + amplitude * equation.norms.sum()
    harmonics = equation.harmonics
    highest = int(harmonics.max(initial=1))
    count = max(2, math.ceil(2 * math.pi * max(largest * rate / STEP_NORM, highest / 2)))
    k = 2 * math.pi / count
    rho = DISC_RADII
    N = len(equation.A)

    def integral(rho: Any) -> Any:
        waves = sum(f * np.expm1(j * k * rho) / (j * k) for j, f in zip(harmonics, equation.norms, strict=True))
        return k * largest * (equation.norm * rho + amplitude * waves)

    with np.errstate(over="ignore", invalid="ignore"):
        exponent = integral(rho)
        for order in range(8, MAX_STEP_ORDER + 1):
            remainder = float(np.min(np.exp(exponent - order * np.log(rho)) / (rho - 1)))
            if remainder * count < REMAINDER_PART * tolerance:
                break
        whole = float(integral(1.0))
        g = (6 * order + N + 2 * len(harmonics) + 40) * 1.01 * ROUNDING
        rounding = math.exp(whole) * (math.expm1(g * whole) + 1.01 * order * ROUNDING * math.exp(g * whole))
        # the parameters' tail: exp(a t + b t^2) from degree + 1 on, times the growth along the middle of the rectangle
        f = equation.norms.sum()
        a, b = k * (h1 * (equation.norm + abs(e0) * f) + l0 * h2 * f), k * h1 * h2 * f
        growth = k * l0 * (equation.growth + abs(e0) * equation.symmetric_norms.sum())
        tail = math.exp(growth) * _tail(a, b, degree)
    bound = math.sqrt(N) * (2 * remainder + rounding + tail)
    return Steps(count, order, bound * SAFE + TINY)


def _tail(a: float, b: float, degree: int) -> float:
    """Bound of the sum of the coefficients of exp(a t + b t^2) beyond a degree.

    c_k k = a c_{k-1} + 2 b c_{k-2}; from where a + 2 b <= k / 4 on, max(c_k, c_{k-1}) at least halves in two steps.
    """
    older, newer = 0.0, 1.0
    total = 0.0
    k = 1
    while k <= degree + 1 or a + 2 * b > k / 4 or k < degree + 20:
        older, newer = newer, (a * newer + 2 * b * older) / k
        if k > degree:
            total += newer
        k += 1
        if not math.isfinite(total) or k > 100_000:
            return math.inf
    # what follows: c_{k+1} <= (a + 2 b) / k max(c_k, c_{k-1}) <= max(...) / 4, in pairs a geometric series
    return total + max(older, newer)


def _period(equation: Coefficients, steps: Steps, rectangle: tuple[float, float, float, float], degree: int) -> Model:
    """Return the product of all steps, by halves."""
    waves = equation.waves(steps.number, steps.order)
    factors: list[tuple[int, Model]] = []
    for m in range(steps.number):
        coef = _step(equation.A, equation.F, waves[m], steps.number, *rectangle, degree)
        factors.append((1, Model(coef, degree, steps.radius)))
        while len(factors) > 1 and (factors[-1][0] == factors[-2][0] or m == steps.number - 1):
            (a, later), (b, earlier) = factors.pop(), factors.pop()
            factors.append((a + b, later @ earlier))
    return factors[0][1]


@njit(cache=True, nogil=True)
def _step(
    A: FloatArray,
    F: FloatArray,
    waves: FloatArray,
    count: int,
    l0: float,
    h1: float,
    e0: float,
    h2: float,
    degree: int,
) -> FloatArray:
    """The Taylor polynomial of a step's flow at its end.

    (m + 1) X_{m+1} = k (l0 + h1 xi) [A X_m + (e0 + h2 eta) sum_w F_w sum_i c_{w,i} X_{m-i}]; F_w is the block of the
    matrix that takes the second half of z to the first, the only one that is not zero.
    """
    N = A.shape[0]
    n = F.shape[1]
    order = waves.shape[1] - 1
    coefs = size(degree)
    X = np.zeros((order + 1, coefs, N, N))
    total = np.zeros((coefs, N, N))
    for i in range(N):
        X[0, 0, i, i] = 1.0
        total[0, i, i] = 1.0
    S = np.empty((n, N))
    V = np.zeros((coefs, n, N))
    Y = np.zeros((coefs, N, N))
    k = 2 * np.pi / count
    for m in range(order):
        reach = size(min(degree, 2 * m))  # coefficients of X_m that are not zero
        for c in range(reach):
            for row in range(n):
                for column in range(N):
                    V[c, row, column] = 0.0
        for w in range(F.shape[0]):
            for c in range(reach):
                for row in range(n):
                    for column in range(N):
                        S[row, column] = waves[w, 0] * X[m, c, n + row, column]
                for i in range(1, m + 1):
                    factor = waves[w, i]
                    if factor != 0.0 and c < size(min(degree, 2 * (m - i))):
                        for row in range(n):
                            for column in range(N):
                                S[row, column] += factor * X[m - i, c, n + row, column]
                for row in range(n):
                    for inner in range(n):
                        x = F[w, row, inner]
                        if x != 0.0:
                            for column in range(N):
                                V[c, row, column] += x * S[inner, column]
        for c in range(coefs):
            for row in range(N):
                for column in range(N):
                    Y[c, row, column] = e0 * V[c, row, column] if row < n and c < reach else 0.0
                if c < reach:
                    for inner in range(N):
                        x = A[row, inner]
                        if x != 0.0:
                            for column in range(N):
                                Y[c, row, column] += x * X[m, c, inner, column]
        for t in range(degree):
            for power in range(t + 1):
                c, up = t * (t + 1) // 2 + power, (t + 1) * (t + 2) // 2 + power + 1
                if c < reach:
                    for row in range(n):
                        for column in range(N):
                            Y[up, row, column] += h2 * V[c, row, column]
        middle, slope = k / (m + 1) * l0, k / (m + 1) * h1
        for c in range(coefs):
            for row in range(N):
                for column in range(N):
                    X[m + 1, c, row, column] = middle * Y[c, row, column]
        for t in range(degree):
            for power in range(t + 1):
                c, up = t * (t + 1) // 2 + power, (t + 1) * (t + 2) // 2 + power
                for row in range(N):
                    for column in range(N):
                        X[m + 1, up, row, column] += slope * Y[c, row, column]
        for c in range(coefs):
            for row in range(N):
                for column in range(N):
                    total[c, row, column] += X[m + 1, c, row, column]
    return total
