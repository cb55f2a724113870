"""One step of the chart integrator, for every phase and amplitude that the doubling starts from, and products of small
matrices."""

from __future__ import annotations

import numpy as np
from numba import njit

from floquet.lanes import WIDTH, fma, load_row, spread, store_row
from periodic.checks import FloatArray


@njit(cache=True, nogil=True)
def multiply(A: FloatArray, B: FloatArray, C: FloatArray) -> None:
    """Write A B into C, all C-contiguous and apart. Where a row fits into lanes, BLAS would take longer to begin."""
    rows, columns = C.shape
    if columns > WIDTH:
        np.dot(A, B, C)
        return
    last = rows - 1
    for i in range(0, rows, 4):
        i1, i2, i3 = min(i + 1, last), min(i + 2, last), min(i + 3, last)
        c0 = c1 = c2 = c3 = spread(0.0)
        for k in range(B.shape[0]):
            b = load_row(B, k)
            c0, c1 = fma(spread(A[i, k]), b, c0), fma(spread(A[i1, k]), b, c1)
            c2, c3 = fma(spread(A[i2, k]), b, c2), fma(spread(A[i3, k]), b, c3)
        store_row(C, i, c0)
        store_row(C, i1, c1)
        store_row(C, i2, c2)
        store_row(C, i3, c3)


@njit(cache=True, nogil=True)
def exponential(A: FloatArray) -> FloatArray:
    """Return exp(A) by its Taylor series, after halving A until its norm is at most 1/2, and squaring."""
    norm = 0.0
    for i in range(A.shape[0]):
        norm = max(norm, np.abs(A[i]).sum())
    squarings = 0
    while norm > 0.5:
        norm *= 0.5
        squarings += 1
    A = A * 0.5**squarings
    E = np.eye(A.shape[0])
    term, bound, k = E, 1.0, 0
    while bound > 1e-18:
        k += 1
        bound *= norm / k
        term = np.dot(A, term) / k
        E = E + term
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

    The kick changes the velocities by left [-h eps F + (h^3 eps^2 / 12) F^2] right times the displacements (``left``
    and ``right`` are the diagonals that the coordinates bring with them). The second term is half of h^3 / 12 times
    the double commutator of Takahashi and Imada (J. Phys. Soc. Japan 53 (1984) 3765): with it the step is similar to
    one of fourth order, by a transformation with the period of the excitation, which the multipliers do not see
    (processing; S. Blanes, F. Casas and A. Murua, Bol. Soc. Esp. Mat. Apl. 45 (2008) 89-145, section 3). Exact for
    eps = 0; symplectic if exp(h A) is.
    """
    N = A.shape[0]
    n = N // 2
    E = exponential(h * A)
    E2 = E[:, n:].copy()
    F, F2, moved = np.empty((n, n)), np.empty((n, n)), np.empty((N, n))
    for i in range(theta.size):
        forcing(Fc, Fs, theta[i], F)
        multiply(F, F, F2)
        linear, quadratic = -h * eps[i], h**3 * eps[i] ** 2 / 12.0
        for r in range(n):
            for c in range(n):
                F[r, c] = left[r] * (linear * F[r, c] + quadratic * F2[r, c]) * right[c]
        multiply(E2, F, moved)
        P[i] = E
        for r in range(N):
            for c in range(n):
                P[i, r, c] += moved[r, c]
