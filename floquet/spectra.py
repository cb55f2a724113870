"""Eigenvalues of eight real matrices at once: Householder reduction and Francis QR on lane arrays (floquet/lanes.py).

The textbook algorithms (Golub and Van Loan, Matrix Computations, 4th ed., sections 7.4 and 7.5), values only. All eight
matrices go through the same operations; where they differ - in the window of the matrix that has not converged yet -
the lanes that have nothing to do apply the identity. Entries are expected to be of order one at most.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from floquet.lanes import WIDTH, fma, load, magnitude, pick_le, root, spread, store
from periodic.checks import FloatArray

UNIT = float(np.finfo(float).eps)
TINY = 1e-280  # a vector whose squares sum to less is zero
SWEEPS_PER_EIGENVALUE = 30  # at most, as LAPACK; two or three is usual
EXCEPTIONAL = 10  # sweeps without success, after which an odd shift is tried

# rows of the lane array that holds the state of the QR iteration
LO, HI, X, Y, Z = range(5)


@njit(cache=True, nogil=True)
def reflector(head: FloatArray, tail: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return (beta, scale, image) of the reflection I - v v^T, v^T v = 2, that maps x to image e_1.

    ``head`` is x_1 and ``tail`` the sum of the other squares; v = scale (x_1 + beta, x_2, x_3, ...). For x = 0 it is
    the identity.
    """
    norm = root(fma(head, head, tail))
    beta = pick_le(spread(0.0), head, norm, -norm)
    square = beta * (head + beta)  # half of |(x_1 + beta, x_2, ...)|^2
    scale = spread(1.0) / root(pick_le(square, spread(TINY), spread(1.0), square))
    return (
        beta,
        pick_le(square, spread(TINY), spread(0.0), scale),
        pick_le(square, spread(TINY), head, -beta),
    )


@njit(cache=True, nogil=True)
def hessenberg(A: FloatArray, work: FloatArray) -> None:
    """Reduce the lane array A (n, n, 8) in place to upper Hessenberg form by orthogonal similarity.

    With a reflection P = I - v v^T, P A P = A - v w^T - u v^T, where w = A^T v - s v / 2, u = A v - s v / 2, s = v^T
    A v. One pass over A applies the last reflection and forms the products for the next, because memory is slower than
    arithmetic here. ``work`` has shape (6, n, 8).
    """
    n = A.shape[0]
    work[:] = 0.0
    for k in range(n - 2):
        v, w, u = (0, 1, 2) if k % 2 == 0 else (3, 4, 5)  # the last reflection
        new_v, new_w, new_u = (3, 4, 5) if k % 2 == 0 else (0, 1, 2)
        # column k with the last reflection applied gives the next one
        w_k, v_k, tail = load(work, w, k), load(work, v, k), spread(0.0)
        for i in range(n):
            a = load(A, i, k) - load(work, v, i) * w_k - load(work, u, i) * v_k
            store(A, i, k, a if i < k + 2 else spread(0.0))
            store(work, new_v, i, a)
            if i > k + 1:
                tail = fma(a, a, tail)
        head = load(work, new_v, k + 1)
        beta, scale, image = reflector(head, tail)
        store(A, k + 1, k, image)
        store(work, new_v, k + 1, head + beta)
        for i in range(n):
            store(work, new_v, i, load(work, new_v, i) * scale if i > k else spread(0.0))
            store(work, new_w, i, spread(0.0))
        # the other columns, and the products with the new v
        s = spread(0.0)
        for i in range(n):
            v_i, u_i, new_v_i, y = -load(work, v, i), -load(work, u, i), load(work, new_v, i), spread(0.0)
            for j in range(k + 1, n):
                a = fma(v_i, load(work, w, j), fma(u_i, load(work, v, j), load(A, i, j)))
                store(A, i, j, a)
                store(work, new_w, j, fma(new_v_i, a, load(work, new_w, j)))
                y = fma(a, load(work, new_v, j), y)
            store(work, new_u, i, y)
            s = fma(new_v_i, y, s)
        half = spread(0.5) * s
        for i in range(k + 1, n):
            v_i = load(work, new_v, i)
            store(work, new_w, i, load(work, new_w, i) - half * v_i)
            store(work, new_u, i, load(work, new_u, i) - half * v_i)
    v, w, u = (0, 1, 2) if n % 2 == 0 else (3, 4, 5)
    for i in range(n):
        for j in range(max(n - 2, 0), n):
            store(A, i, j, load(A, i, j) - load(work, v, i) * load(work, w, j) - load(work, u, i) * load(work, v, j))


@njit(cache=True, nogil=True)
def hessenberg_eigenvalues(H: FloatArray, real: FloatArray, imag: FloatArray, work: FloatArray) -> None:
    """Write the eigenvalues of the upper Hessenberg lane array H (n, n, 8) into ``real`` and ``imag`` (n, 8).

    Francis double-shift QR; H is destroyed. Each lane has its own window lo..hi, the lowest block that has not split
    off; a lane is finished at hi = -1. Eigenvalues that have not converged are NaN. ``work`` has shape (1, 5, 8).
    """
    n = H.shape[0]
    lo, hi = work[0, LO], work[0, HI]
    hi[:] = n - 1
    real[:], imag[:] = np.nan, np.nan
    idle = np.zeros(WIDTH, np.int64)  # sweeps since the lane last split
    for _ in range(SWEEPS_PER_EIGENVALUE * n):
        _find_windows(H, work)
        while _split_off(H, real, imag, lo, hi, idle):
            _find_windows(H, work)
        start, stop = int(lo.min()), int(hi.max())
        if stop < 0:
            return
        for lane in range(WIDTH):
            if hi[lane] >= 0:
                idle[lane] += 1
                _first_column(H, work, lane, int(lo[lane]), int(hi[lane]), idle[lane] % EXCEPTIONAL == 0)
        _sweep(H, work, start, stop)


@njit(cache=True, nogil=True)
def _find_windows(H: FloatArray, work: FloatArray) -> None:
    """Set lo of every lane: below it, up to hi, no subdiagonal entry is negligible."""
    hi = load(work, 0, HI)
    lo = spread(0.0)
    last = magnitude(load(H, 0, 0))
    for i in range(1, int(work[0, HI].max()) + 1):
        index, diagonal = spread(float(i)), magnitude(load(H, i, i))
        negligible = spread(UNIT) * (last + diagonal + spread(UNIT))
        split = pick_le(magnitude(load(H, i, i - 1)), negligible, index, lo)
        lo = pick_le(index, hi, split, lo)
        last = diagonal
    store(work, 0, LO, pick_le(spread(0.0), hi, lo, spread(float(H.shape[0]))))


@njit(cache=True, nogil=True)
def _split_off(
    H: FloatArray, real: FloatArray, imag: FloatArray, lo: FloatArray, hi: FloatArray, idle: NDArray[np.int64]
) -> bool:
    """Take the eigenvalues of windows of one or two rows; return whether there were any."""
    found = False
    for lane in range(WIDTH):
        i, k = int(lo[lane]), int(hi[lane])
        if k < 0 or k - i > 1:
            continue
        found = True
        hi[lane] = i - 1
        idle[lane] = 0
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
def _first_column(H: FloatArray, work: FloatArray, lane: int, lo: int, hi: int, exceptional: bool) -> None:
    """Write the first column of (H - a)(H - b), up to a factor, where a and b are the shifts."""
    x, y, ww = H[hi, hi, lane], H[hi - 1, hi - 1, lane], H[hi, hi - 1, lane] * H[hi - 1, hi, lane]
    if exceptional:
        size = abs(H[hi, hi - 1, lane]) + abs(H[hi - 1, hi - 2, lane])
        x = y = H[hi, hi, lane] + 0.75 * size
        ww = -0.4375 * size * size
    p = H[lo, lo, lane]
    r, s = x - p, y - p
    work[0, X, lane] = (r * s - ww) / H[lo + 1, lo, lane] + H[lo, lo + 1, lane]
    work[0, Y, lane] = H[lo + 1, lo + 1, lane] - p - r - s
    work[0, Z, lane] = H[lo + 2, lo + 1, lane]


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
    """Write the combinations of ``samples`` (m, n, n) with the lane weights (1, m, 8) into ``result`` (n, columns >=
    n, 8)."""
    m, n = samples.shape[0], samples.shape[1]
    for i in range(n):
        for j in range(n):
            total = spread(0.0)
            for a in range(m):
                total = fma(spread(samples[a, i, j]), load(weights, 0, a), total)
            store(result, i, j, total)


@njit(cache=True, nogil=True)
def lane_array(n: int) -> FloatArray:
    """Return a lane array of n rows, with an odd number of columns: rows a power of two apart share their place in
    the cache."""
    return np.zeros((n, n + 1 - n % 2, WIDTH))


@njit(cache=True, nogil=True)
def eigenvalues(samples: FloatArray, weights: FloatArray) -> NDArray[np.complex128]:
    """Return the eigenvalues (8 g, n) of 8 g combinations of ``samples`` (m, n, n), given lane weights (g, m, 8)."""
    groups, n = weights.shape[0], samples.shape[1]
    A, work, state = lane_array(n), np.empty((6, n, WIDTH)), np.empty((1, 5, WIDTH))
    real, imag = np.empty((n, WIDTH)), np.empty((n, WIDTH))
    result = np.empty((groups * WIDTH, n), np.complex128)
    for g in range(groups):
        interpolate(samples, weights[g : g + 1], A)
        hessenberg(A, work)
        hessenberg_eigenvalues(A, real, imag, state)
        for lane in range(WIDTH):
            for i in range(n):
                result[g * WIDTH + lane, i] = complex(real[i, lane], imag[i, lane])
    return result
