"""Eigenvalues of sixteen real matrices at once: Householder reduction and Francis QR on lane arrays (`lanes`).

The algorithms are those of the textbook (Golub and Van Loan, Matrix Computations, 4th ed., sections 7.4 and 7.5),
without eigenvectors. All matrices go through the same operations. They differ in the window of the matrix that has not
converged yet: there, lanes that have nothing to do apply the identity. Entries are expected to be of order one at most.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from floquet.engine.eigen.lanes import LANE_COUNT, broadcast, fma, highest, load, magnitude, pick_le, square_root, store
from floquet.engine.eigen.reflections import NEGLIGIBLE_SQUARE, lane_array, lane_vectors, pass_general, reflect_column
from periodic.checks import ComplexArray, FloatArray

UNIT_ROUNDOFF = float(np.finfo(float).eps)
MAX_SWEEPS_PER_EIGENVALUE = 30  # as in LAPACK; two or three are usual
HESSENBERG_VECTORS = 6  # v, u and w of the last and of the next reflection
SWEEPS_BEFORE_EXCEPTIONAL = 10  # sweeps without success, after which the exceptional shifts are tried
# Exceptional shifts are the eigenvalues of another pair of last rows, as in LAPACK's dlahqr: what is added to the last
# diagonal entry, and the product of the off-diagonal entries, in units of the last two subdiagonal entries.
EXCEPTIONAL_DIAGONAL, EXCEPTIONAL_PRODUCT = 0.75, -0.4375

# Rows of the lane array that holds the state of the QR iteration: first and last row of the window, sweeps since the
# last success, and the vector that the next reflection maps to a multiple of e_1.
LO, HI, IDLE, X, Y, Z, STATE_ROWS = range(7)


@njit(cache=True, nogil=True)
def hessenberg(A: FloatArray, n: int, x: FloatArray) -> None:
    """Reduce the n x n `lane_array` A in place to upper Hessenberg form by orthogonal similarity.

    ``x`` is the work space ``lane_vectors(HESSENBERG_VECTORS, n)``.
    """
    x[:] = 0.0
    for k in range(n - 2):
        (v, u, w), new = ((0, 1, 2), (3, 4, 5)) if k % 2 == 0 else ((3, 4, 5), (0, 1, 2))
        # column k, with the last reflection applied, gives the next reflection
        w_k, v_k = load(x, w, k), load(x, v, k)
        for i in range(n):
            a = load(A, i, k) - load(x, v, i) * w_k - load(x, u, i) * v_k
            store(x, new[0], i, a)
            store(A, i, k, a if i <= k else broadcast(0.0))
        store(A, k + 1, k, reflect_column(x, new[0], k + 1, n))
        pass_general(A, x, (v, u, w), new, k + 1, n)
    v, u, w = (0, 1, 2) if n % 2 == 0 else (3, 4, 5)
    for i in range(n):
        for j in range(max(n - 2, 0), n):
            store(A, i, j, load(A, i, j) - load(x, v, i) * load(x, w, j) - load(x, u, i) * load(x, v, j))


@njit(cache=True, nogil=True)
def hessenberg_eigenvalues(H: FloatArray, real: FloatArray, imag: FloatArray, work: FloatArray) -> None:
    """Write the eigenvalues of the upper Hessenberg `lane_array` H into ``real`` and ``imag`` (n, 16).

    The method is Francis double-shift QR; H is destroyed. Each lane has its own window lo..hi: the lowest diagonal
    block that has not split off. A lane is finished at hi = -1. Eigenvalues that have not converged are NaN. ``work``
    has shape (1, STATE_ROWS, 16).
    """
    n = real.shape[0]
    work[0, HI], work[0, IDLE] = n - 1, 0.0
    real[:], imag[:] = np.nan, np.nan
    for _ in range(MAX_SWEEPS_PER_EIGENVALUE * n):
        _find_windows(H, work)
        while _split_off(H, real, imag, work):
            _find_windows(H, work)
        start, stop = int(-highest(-load(work, 0, LO))), int(highest(load(work, 0, HI)))
        if stop < 0:
            return
        _first_columns(H, work, start, stop)
        _sweep(H, work, start, stop)


@njit(cache=True, nogil=True)
def _find_windows(H: FloatArray, work: FloatArray) -> None:
    """Set lo of every lane: between lo and hi no subdiagonal entry is negligible."""
    hi = load(work, 0, HI)
    lo = broadcast(0.0)
    last = magnitude(load(H, 0, 0))
    for i in range(1, int(highest(hi)) + 1):
        index, diagonal = broadcast(float(i)), magnitude(load(H, i, i))
        negligible = broadcast(UNIT_ROUNDOFF) * (last + diagonal + broadcast(UNIT_ROUNDOFF))
        split = pick_le(magnitude(load(H, i, i - 1)), negligible, index, lo)
        lo = pick_le(index, hi, split, lo)
        last = diagonal
    store(work, 0, LO, pick_le(broadcast(0.0), hi, lo, broadcast(float(H.shape[0]))))


@njit(cache=True, nogil=True)
def _split_off(H: FloatArray, real: FloatArray, imag: FloatArray, work: FloatArray) -> bool:
    """Take the eigenvalues of all windows of one or two rows; return whether there were any."""
    lo, hi, idle = work[0, LO], work[0, HI], work[0, IDLE]
    found = False
    for lane in range(LANE_COUNT):
        i, k = int(lo[lane]), int(hi[lane])
        if k < 0 or k - i > 1:
            continue
        found = True
        hi[lane] = i - 1
        idle[lane] = 0.0
        d = H[k, k, lane]
        real[i, lane], real[k, lane], imag[i, lane], imag[k, lane] = d, d, 0.0, 0.0
        if i < k:
            p, bc = 0.5 * (H[i, i, lane] - d), H[i, k, lane] * H[k, i, lane]
            square = p * p + bc
            if square >= 0.0:
                z = p + np.copysign(np.sqrt(square), p)
                real[i, lane] = d + z
                real[k, lane] = d - (bc / z if z != 0.0 else 0.0)
            else:
                real[i, lane], real[k, lane] = d + p, d + p
                imag[i, lane], imag[k, lane] = np.sqrt(-square), -np.sqrt(-square)
    return found


@njit(cache=True, nogil=True)
def _first_columns(H: FloatArray, work: FloatArray, start: int, stop: int) -> None:
    """Write the first column of (H - a)(H - b), up to a factor, in the window of every lane, all within start..stop.

    The shifts a and b are the eigenvalues of the last two rows of the window. The loops go through all rows in which a
    window begins or ends, and every lane keeps its own entries: most windows begin in the same row, and most end in one
    of a few.
    """
    lo, hi, zero, one = load(work, 0, LO), load(work, 0, HI), broadcast(0.0), broadcast(1.0)
    a, b, ab, size = zero, zero, zero, zero
    for k in range(int(-highest(-pick_le(zero, hi, hi, broadcast(float(stop))))), stop + 1):
        here = broadcast(float(k))
        a, b = pick_le(here, hi, load(H, k, k), a), pick_le(here, hi, load(H, k - 1, k - 1), b)
        ab = pick_le(here, hi, load(H, k, k - 1) * load(H, k - 1, k), ab)
        size = pick_le(here, hi, magnitude(load(H, k, k - 1)) + magnitude(load(H, k - 1, k - 2)), size)
    h11, h12, h21, h22, h32 = zero, zero, one, zero, zero
    for k in range(start, int(highest(pick_le(zero, hi, lo, zero))) + 1):
        here = broadcast(float(k))
        h11, h12 = pick_le(here, lo, load(H, k, k), h11), pick_le(here, lo, load(H, k, k + 1), h12)
        h21, h22 = pick_le(here, lo, load(H, k + 1, k), h21), pick_le(here, lo, load(H, k + 1, k + 1), h22)
        h32 = pick_le(here, lo, load(H, k + 2, k + 1), h32)
    # exceptional shifts where sweeps have been in vain
    idle, most = load(work, 0, IDLE), broadcast(float(SWEEPS_BEFORE_EXCEPTIONAL))
    exceptional = a + broadcast(EXCEPTIONAL_DIAGONAL) * size
    a, b = pick_le(most, idle, exceptional, a) - h11, pick_le(most, idle, exceptional, b) - h11
    ab = pick_le(most, idle, broadcast(EXCEPTIONAL_PRODUCT) * size * size, ab)
    store(work, 0, X, (a * b - ab) / pick_le(zero, hi, h21, one) + h12)
    store(work, 0, Y, h22 - h11 - a - b)
    store(work, 0, Z, h32)
    store(work, 0, IDLE, pick_le(most, idle, zero, idle) + one)


@njit(cache=True, nogil=True)
def _sweep(H: FloatArray, work: FloatArray, start: int, stop: int) -> None:
    """Chase the bulge down the window of every lane, all windows within start..stop."""
    lo, hi, zero = load(work, 0, LO), load(work, 0, HI), broadcast(0.0)
    for k in range(start, stop):
        here, third = broadcast(float(k)), min(k + 2, stop)
        a, b, c = load(work, 0, X), load(work, 0, Y), load(work, 0, Z)
        if k > start:
            a = pick_le(here, lo, a, load(H, k, k - 1))
            b = pick_le(here, lo, b, load(H, k + 1, k - 1))
            c = pick_le(here, lo, c, load(H, third, k - 1))
        c = pick_le(broadcast(k + 2.0), hi, c, zero)
        norm = square_root(fma(a, a, fma(b, b, c * c)))
        beta = pick_le(zero, a, norm, -norm)
        # (I - tau v v^T) (a, b, c) = -beta e_1 with v = (1, b, c) / (a + beta), tau = (a + beta) / beta
        product = beta * (a + beta)
        inverse = pick_le(
            product,
            broadcast(NEGLIGIBLE_SQUARE),
            zero,
            broadcast(1.0) / pick_le(product, broadcast(NEGLIGIBLE_SQUARE), broadcast(1.0), product),
        )
        inverse = pick_le(lo, here, pick_le(broadcast(k + 1.0), hi, inverse, zero), zero)  # identity outside the window
        v1, v2 = b * beta * inverse, c * beta * inverse
        t0 = -(a + beta) * (a + beta) * inverse
        t1, t2 = t0 * v1, t0 * v2
        if k > start:
            inside = pick_le(broadcast(k + 1.0), hi, broadcast(float(k - 1)), broadcast(-1.0))
            store(H, third, k - 1, pick_le(lo, inside, zero, load(H, third, k - 1)))
            store(H, k + 1, k - 1, pick_le(lo, inside, zero, load(H, k + 1, k - 1)))
            store(H, k, k - 1, pick_le(lo, inside, -beta, load(H, k, k - 1)))
        # at the end of the window the third row is the second: v2 = 0, and the second result overwrites the third
        for j in range(k, stop + 1):
            h0, h1, h2 = load(H, k, j), load(H, k + 1, j), load(H, third, j)
            s = fma(v1, h1, fma(v2, h2, h0))
            store(H, third, j, fma(t2, s, h2))
            store(H, k + 1, j, fma(t1, s, h1))
            store(H, k, j, fma(t0, s, h0))
        # the last rows come first: the next reflection waits for them
        for i in range(min(k + 3, stop), start - 1, -1):
            h0, h1, h2 = load(H, i, k), load(H, i, k + 1), load(H, i, third)
            s = fma(v1, h1, fma(v2, h2, h0))
            store(H, i, third, fma(t2, s, h2))
            store(H, i, k + 1, fma(t1, s, h1))
            store(H, i, k, fma(t0, s, h0))


@njit(cache=True, nogil=True)
def interpolate(samples: FloatArray, weights: FloatArray, result: FloatArray) -> None:
    """Write combinations of ``samples`` (m, n, n) with the lane weights (1, m, 16) into the `lane_array` ``result``.

    Four entries are formed at a time, so that none waits for another.
    """
    m, n = samples.shape[0], samples.shape[1]
    last = n - 1
    for i in range(n):
        for j in range(0, n, 4):
            j1, j2, j3 = min(j + 1, last), min(j + 2, last), min(j + 3, last)
            r0 = r1 = r2 = r3 = broadcast(0.0)
            for a in range(m):
                weight = load(weights, 0, a)
                r0 = fma(broadcast(samples[a, i, j]), weight, r0)
                r1 = fma(broadcast(samples[a, i, j1]), weight, r1)
                r2 = fma(broadcast(samples[a, i, j2]), weight, r2)
                r3 = fma(broadcast(samples[a, i, j3]), weight, r3)
            store(result, i, j, r0)
            store(result, i, j1, r1)
            store(result, i, j2, r2)
            store(result, i, j3, r3)


@njit(cache=True, nogil=True)
def eigenvalues(samples: FloatArray, weights: FloatArray) -> ComplexArray:
    """Return the eigenvalues (16 g, n) of 16 g combinations of ``samples`` (m, n, n), given lane weights (g, m, 16)."""
    groups, n = weights.shape[0], samples.shape[1]
    A, x, state = lane_array(n), lane_vectors(HESSENBERG_VECTORS, n), np.empty((1, STATE_ROWS, LANE_COUNT))
    real, imag = np.empty((n, LANE_COUNT)), np.empty((n, LANE_COUNT))
    result = np.empty((groups * LANE_COUNT, n), np.complex128)
    for g in range(groups):
        interpolate(samples, weights[g : g + 1], A)
        hessenberg(A, n, x)
        hessenberg_eigenvalues(A, real, imag, state)
        for lane in range(LANE_COUNT):
            for i in range(n):
                result[g * LANE_COUNT + lane, i] = complex(real[i, lane], imag[i, lane])
    return result
