"""One step of the chart integrator, for every phase and amplitude that the doubling starts from; products."""

from __future__ import annotations

import numpy as np
from numba import njit

from floquet.engine.eigen import MAX_LANE_ROW, broadcast, fma, load_row, store_row
from periodic.checks import FloatArray

MAX_SERIES_NORM = 0.5  # of the matrix whose exponential is summed as a Taylor series
MAX_LOOP_ENTRIES = 32  # of a matrix that is multiplied without BLAS
SERIES_TOLERANCE = 1e-18  # bound on the first term of the series that is left out


@njit(cache=True, nogil=True)
def multiply(P: FloatArray, first: int, second: int, Q: FloatArray, i: int) -> None:
    """Write P[second] P[first] into Q[i]; P and Q are C-contiguous, (matrices, N, N), and do not overlap.

    Where a row fits into lanes, BLAS would take longer to begin than to multiply.
    """
    N = P.shape[1]
    if N > MAX_LANE_ROW:
        np.dot(P[second], P[first], Q[i])
        return
    last = N - 1
    for r in range(0, N, 4):
        r1, r2, r3 = min(r + 1, last), min(r + 2, last), min(r + 3, last)
        q0 = q1 = q2 = q3 = broadcast(0.0)
        for k in range(N):
            row = load_row(P, first, k)
            q0, q1 = fma(broadcast(P[second, r, k]), row, q0), fma(broadcast(P[second, r1, k]), row, q1)
            q2, q3 = fma(broadcast(P[second, r2, k]), row, q2), fma(broadcast(P[second, r3, k]), row, q3)
        store_row(Q, i, r, q0)
        store_row(Q, i, r1, q1)
        store_row(Q, i, r2, q2)
        store_row(Q, i, r3, q3)


@njit(cache=True, nogil=True)
def exponential(A: FloatArray) -> FloatArray:
    """Return exp(A) by its Taylor series: A is halved until its norm is small, and the result is squared as often."""
    norm = 0.0
    for i in range(A.shape[0]):
        norm = max(norm, np.abs(A[i]).sum())
    squarings = 0
    while norm > MAX_SERIES_NORM:
        norm *= 0.5
        squarings += 1
    terms, bound = 0, 1.0
    while bound > SERIES_TOLERANCE:
        terms += 1
        bound *= norm / terms
    N, here = A.shape[0], 1
    P = np.zeros((3, N, N))  # A, and two places that hold the sum in turn
    P[0] = A * 0.5**squarings
    np.fill_diagonal(P[1], 1.0)
    for k in range(terms, 0, -1):  # I + A (I + A/2 (I + A/3 (...)))
        multiply(P, here, 0, P, 3 - here)
        here = 3 - here
        for i in range(N):
            for j in range(N):
                P[here, i, j] /= k
            P[here, i, i] += 1.0
    E = P[here].copy()
    for _ in range(squarings):
        E = np.dot(E, E)
    return E


@njit(cache=True, nogil=True)
def forcing(Fc: FloatArray, Fs: FloatArray, theta: float, F: FloatArray) -> None:
    """Write sum_j [F_cj cos j theta + F_sj sin j theta] into F."""
    F[:] = 0.0
    for j in range(Fc.shape[0]):
        cosine, sine = np.cos((j + 1) * theta), np.sin((j + 1) * theta)
        for r in range(F.shape[0]):
            for c in range(F.shape[1]):
                F[r, c] += cosine * Fc[j, r, c] + sine * Fs[j, r, c]


@njit(cache=True, nogil=True)
def single_steps(
    A: FloatArray,
    Fc: FloatArray,
    Fs: FloatArray,
    left: FloatArray,
    right: FloatArray,
    h: float,
    theta: FloatArray,
    eps: FloatArray,
    P: FloatArray,
) -> None:
    """Write the steps exp(h A) (I + kick) at the phases ``theta`` and amplitudes ``eps`` (s,) into P (s, N, N).

    The kick changes the velocities by left [-h eps F + (h^3 eps^2 / 12) F^2] right times the displacements, where
    ``left`` and ``right`` are diagonals that belong to the coordinates. The second term is half of h^3 / 12 times the
    double commutator of Takahashi and Imada (J. Phys. Soc. Japan 53 (1984) 3765). With it the step is conjugate to one
    of fourth order. The transformation between the two has the period of the excitation, and so the multipliers are
    those of the fourth-order step (processing; S. Blanes, F. Casas and A. Murua, Bol. Soc. Esp. Mat. Apl. 45 (2008)
    89-145, section 3). The step is exact for eps = 0, and symplectic if exp(h A) is.
    """
    N = A.shape[0]
    n = N // 2
    E = exponential(h * A)
    E2 = E[:, n:].copy()
    F, F2, moved = np.empty((n, n)), np.empty((n, n)), np.empty((N, n))
    for i in range(theta.size):
        forcing(Fc, Fs, theta[i], F)
        np.dot(F, F, F2)
        linear, quadratic = -h * eps[i], h**3 * eps[i] ** 2 / 12.0
        for r in range(n):
            for c in range(n):
                F[r, c] = left[r] * (linear * F[r, c] + quadratic * F2[r, c]) * right[c]
        np.dot(E2, F, moved)
        P[i] = E
        for r in range(N):
            for c in range(n):
                P[i, r, c] += moved[r, c]


def forcing_on_grid(Fc: FloatArray, Fs: FloatArray, phases: int) -> FloatArray:
    """Return sum_j [F_cj cos j theta + F_sj sin j theta] at so many equispaced phases from 0 on, (phases, n, n)."""
    J, n = len(Fc), Fc.shape[1]
    coefficients = np.zeros((phases, n, n), complex)
    np.add.at(coefficients, np.arange(1, J + 1) % phases, Fc - 1j * Fs)  # equal where the grid tells no difference
    return np.ascontiguousarray(np.fft.ifft(coefficients, axis=0, norm="forward").real)


@njit(cache=True, nogil=True)
def grid_steps(
    A: FloatArray, F: FloatArray, left: FloatArray, right: FloatArray, h: float, eps: FloatArray, P: FloatArray
) -> None:
    """Write the steps of `single_steps` at equispaced phases and the amplitudes ``eps`` (m,) into P (p m, N, N).

    ``F`` (p, n, n) is the forcing. The products with it are shared by all amplitudes of a phase.
    """
    N, m = A.shape[0], eps.size
    n = N // 2
    E = exponential(h * A)
    E2 = E[:, n:].copy()
    once, twice = np.empty((n, n)), np.empty((n, n))
    linear, quadratic = np.empty((N, n)), np.empty((N, n))
    for i in range(F.shape[0]):
        small_product(F[i], F[i], twice)
        for r in range(n):
            for c in range(n):
                once[r, c] = -h * left[r] * F[i, r, c] * right[c]
                twice[r, c] *= h**3 / 12.0 * left[r] * right[c]
        small_product(E2, once, linear)
        small_product(E2, twice, quadratic)
        for a in range(m):
            P[i * m + a] = E
            for r in range(N):
                for c in range(n):
                    P[i * m + a, r, c] += eps[a] * (linear[r, c] + eps[a] * quadratic[r, c])


@njit(cache=True, nogil=True)
def small_product(X: FloatArray, Y: FloatArray, out: FloatArray) -> None:
    """Write X Y into ``out``; BLAS would take longer to begin than to multiply a few numbers."""
    if X.size > MAX_LOOP_ENTRIES:
        np.dot(X, Y, out)
        return
    for r in range(X.shape[0]):
        for c in range(Y.shape[1]):
            total = 0.0
            for k in range(X.shape[1]):
                total += X[r, k] * Y[k, c]
            out[r, c] = total
