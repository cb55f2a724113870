"""Eigenvalues of sixteen real matrices at once: Householder reduction and Francis QR on lane arrays (`lanes`).

The textbook algorithms (Golub and Van Loan, Matrix Computations, 4th ed., sections 7.4 and 7.5), values only. All
matrices go through the same operations; where they differ - in the window of the matrix that has not converged yet -
the lanes that have nothing to do apply the identity. Entries are expected to be of order one at most.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from floquet.engine.eigen.lanes import WIDTH, fma, highest, load, magnitude, pick_le, root, spread, store
from floquet.engine.eigen.reflections import TINY, lane_array, lane_vectors, pass_general, reflect_column
from periodic.checks import ComplexArray, FloatArray

UNIT = float(np.finfo(float).eps)
SWEEPS_PER_EIGENVALUE = 30  # at most, as LAPACK; two or three is usual
EXCEPTIONAL = 10  # sweeps without success, after which an odd shift is tried

# rows of the lane array that holds the state of the QR iteration
LO, HI, IDLE, X, Y, Z, STATE = range(7)


@njit(cache=True, nogil=True)
def hessenberg(A: FloatArray, n: int, x: FloatArray) -> None:
    """Reduce the n x n `lane_array` A in place to upper Hessenberg form by orthogonal similarity; ``x`` is
    ``lane_vectors(6, n)``."""
    x[:] = 0.0
    for k in range(n - 2):
        (v, u, w), new = ((0, 1, 2), (3, 4, 5)) if k % 2 == 0 else ((3, 4, 5), (0, 1, 2))
        # column k with the last reflection applied gives the next one
        w_k, v_k = load(x, w, k), load(x, v, k)
        for i in range(n):
            a = load(A, i, k) - load(x, v, i) * w_k - load(x, u, i) * v_k
            store(x, new[0], i, a)
            store(A, i, k, a if i <= k else spread(0.0))
        store(A, k + 1, k, reflect_column(x, new[0], k + 1, n))
        pass_general(A, x, (v, u, w), new, k + 1, n)
    v, u, w = (0, 1, 2) if n % 2 == 0 else (3, 4, 5)
    for i in range(n):
        for j in range(max(n - 2, 0), n):
            store(A, i, j, load(A, i, j) - load(x, v, i) * load(x, w, j) - load(x, u, i) * load(x, v, j))


@njit(cache=True, nogil=True)
def hessenberg_eigenvalues(H: FloatArray, real: FloatArray, imag: FloatArray, work: FloatArray) -> None:
    """Write the eigenvalues of the upper Hessenberg `lane_array` H into ``real`` and ``imag`` (n, 16).

    Francis double-shift QR; H is destroyed. Each lane has its own window lo..hi, the lowest subsystem that has not
    split off; a lane is finished at hi = -1. Eigenvalues that have not converged are NaN. ``work`` has shape (1, STATE,
    16).
    """
    n = real.shape[0]
    work[0, HI], work[0, IDLE] = n - 1, 0.0
    real[:], imag[:] = np.nan, np.nan
    for _ in range(SWEEPS_PER_EIGENVALUE * n):
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
    """Set lo of every lane: below it, up to hi, no subdiagonal entry is negligible."""
    hi = load(work, 0, HI)
    lo = spread(0.0)
    last = magnitude(load(H, 0, 0))
    for i in range(1, int(highest(hi)) + 1):
        index, diagonal = spread(float(i)), magnitude(load(H, i, i))
        negligible = spread(UNIT) * (last + diagonal + spread(UNIT))
        split = pick_le(magnitude(load(H, i, i - 1)), negligible, index, lo)
        lo = pick_le(index, hi, split, lo)
        last = diagonal
    store(work, 0, LO, pick_le(spread(0.0), hi, lo, spread(float(H.shape[0]))))


@njit(cache=True, nogil=True)
def _split_off(H: FloatArray, real: FloatArray, imag: FloatArray, work: FloatArray) -> bool:
    """Take the eigenvalues of windows of one or two rows; return whether there were any."""
    lo, hi, idle = work[0, LO], work[0, HI], work[0, IDLE]
    found = False
    for lane in range(WIDTH):
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

    The shifts a and b are the eigenvalues of the last two rows. Entries pass by, and every lane keeps its own: most
    windows begin in the same row, and most end in one of a few.
    """
    lo, hi, zero, one = load(work, 0, LO), load(work, 0, HI), spread(0.0), spread(1.0)
    a, b, ab, size = zero, zero, zero, zero
    for k in range(int(-highest(-pick_le(zero, hi, hi, spread(float(stop))))), stop + 1):
        here = spread(float(k))
        a, b = pick_le(here, hi, load(H, k, k), a), pick_le(here, hi, load(H, k - 1, k - 1), b)
        ab = pick_le(here, hi, load(H, k, k - 1) * load(H, k - 1, k), ab)
        size = pick_le(here, hi, magnitude(load(H, k, k - 1)) + magnitude(load(H, k - 1, k - 2)), size)
    h11, h12, h21, h22, h32 = zero, zero, one, zero, zero
    for k in range(start, int(highest(pick_le(zero, hi, lo, zero))) + 1):
        here = spread(float(k))
        h11, h12 = pick_le(here, lo, load(H, k, k), h11), pick_le(here, lo, load(H, k, k + 1), h12)
        h21, h22 = pick_le(here, lo, load(H, k + 1, k), h21), pick_le(here, lo, load(H, k + 1, k + 1), h22)
        h32 = pick_le(here, lo, load(H, k + 2, k + 1), h32)
    # LAPACK's exceptional shift from the last rows, where sweeps are in vain
    idle, most = load(work, 0, IDLE), spread(float(EXCEPTIONAL))
    odd = a + spread(0.75) * size
    a, b = pick_le(most, idle, odd, a) - h11, pick_le(most, idle, odd, b) - h11
    ab = pick_le(most, idle, spread(-0.4375) * size * size, ab)
    store(work, 0, X, (a * b - ab) / pick_le(zero, hi, h21, one) + h12)
    store(work, 0, Y, h22 - h11 - a - b)
    store(work, 0, Z, h32)
    store(work, 0, IDLE, pick_le(most, idle, zero, idle) + one)


@njit(cache=True, nogil=True)
def _sweep(H: FloatArray, work: FloatArray, start: int, stop: int) -> None:
    """Chase the bulge down the window of every lane, all windows within start..stop."""
    lo, hi, zero = load(work, 0, LO), load(work, 0, HI), spread(0.0)
    for k in range(start, stop):
        here, third = spread(float(k)), min(k + 2, stop)
        a, b, c = load(work, 0, X), load(work, 0, Y), load(work, 0, Z)
        if k > start:
            a = pick_le(here, lo, a, load(H, k, k - 1))
            b = pick_le(here, lo, b, load(H, k + 1, k - 1))
            c = pick_le(here, lo, c, load(H, third, k - 1))
        c = pick_le(spread(k + 2.0), hi, c, zero)
        norm = root(fma(a, a, fma(b, b, c * c)))
        beta = pick_le(zero, a, norm, -norm)
        # (I - tau v v^T) (a, b, c) = -beta e_1 with v = (1, b, c) / (a + beta), tau = (a + beta) / beta
        product = beta * (a + beta)
        inverse = pick_le(
            product, spread(TINY), zero, spread(1.0) / pick_le(product, spread(TINY), spread(1.0), product)
        )
        inverse = pick_le(lo, here, pick_le(spread(k + 1.0), hi, inverse, zero), zero)  # identity outside the window
        v1, v2 = b * beta * inverse, c * beta * inverse
        t0 = -(a + beta) * (a + beta) * inverse
        t1, t2 = t0 * v1, t0 * v2
        if k > start:
            inside = pick_le(spread(k + 1.0), hi, spread(float(k - 1)), spread(-1.0))
            store(H, third, k - 1, pick_le(lo, inside, zero, load(H, third, k - 1)))
            store(H, k + 1, k - 1, pick_le(lo, inside, zero, load(H, k + 1, k - 1)))
            store(H, k, k - 1, pick_le(lo, inside, -beta, load(H, k, k - 1)))
        # where the third row is the second (end of the window), v2 = 0 and its result is overwritten by the second's
        for j in range(k, stop + 1):
            h0, h1, h2 = load(H, k, j), load(H, k + 1, j), load(H, third, j)
            s = fma(v1, h1, fma(v2, h2, h0))
            store(H, third, j, fma(t2, s, h2))
            store(H, k + 1, j, fma(t1, s, h1))
            store(H, k, j, fma(t0, s, h0))
        # the last rows first: the next reflection waits for them
        for i in range(min(k + 3, stop), start - 1, -1):
            h0, h1, h2 = load(H, i, k), load(H, i, k + 1), load(H, i, third)
            s = fma(v1, h1, fma(v2, h2, h0))
            store(H, i, third, fma(t2, s, h2))
            store(H, i, k + 1, fma(t1, s, h1))
            store(H, i, k, fma(t0, s, h0))


@njit(cache=True, nogil=True)
def interpolate(samples: FloatArray, weights: FloatArray, result: FloatArray) -> None:
    """Write combinations of ``samples`` (m, n, n) with the lane weights (1, m, 16) into the `lane_array` ``result``.

    Entries are taken four at a time, so that one does not wait for the other.
    """
    m, n = samples.shape[0], samples.shape[1]
    last = n - 1
    for i in range(n):
        for j in range(0, n, 4):
            j1, j2, j3 = min(j + 1, last), min(j + 2, last), min(j + 3, last)
            r0 = r1 = r2 = r3 = spread(0.0)
            for a in range(m):
                weight = load(weights, 0, a)
                r0 = fma(spread(samples[a, i, j]), weight, r0)
                r1 = fma(spread(samples[a, i, j1]), weight, r1)
                r2 = fma(spread(samples[a, i, j2]), weight, r2)
                r3 = fma(spread(samples[a, i, j3]), weight, r3)
            store(result, i, j, r0)
            store(result, i, j1, r1)
            store(result, i, j2, r2)
            store(result, i, j3, r3)


@njit(cache=True, nogil=True)
def eigenvalues(samples: FloatArray, weights: FloatArray) -> ComplexArray:
    """Return the eigenvalues (16 g, n) of 16 g combinations of ``samples`` (m, n, n), given lane weights (g, m, 16)."""
    groups, n = weights.shape[0], samples.shape[1]
    A, x, state = lane_array(n), lane_vectors(6, n), np.empty((1, STATE, WIDTH))
    real, imag = np.empty((n, WIDTH)), np.empty((n, WIDTH))
    result = np.empty((groups * WIDTH, n), np.complex128)
    for g in range(groups):
        interpolate(samples, weights[g : g + 1], A)
        hessenberg(A, n, x)
        hessenberg_eigenvalues(A, real, imag, state)
        for lane in range(WIDTH):
            for i in range(n):
                result[g * WIDTH + lane, i] = complex(real[i, lane], imag[i, lane])
    return result
