"""One step of the chart integrator, for every phase and amplitude that the doubling starts from."""

from __future__ import annotations

import numpy as np
from numba import njit

from periodic.checks import FloatArray


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
