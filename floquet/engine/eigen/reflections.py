"""Householder reflections of sixteen matrices at once (`lanes`), applied late.

One pass over a matrix applies the last reflection and forms the products that the next one needs. Memory is slower than
arithmetic here, and so each entry is loaded once for both.

For P = I - v v^T with v^T v = 2, P A P = A - v w^T - u v^T, where u = A v - s v / 2, w = A^T v - s v / 2, s = v^T A v.
If A is skew, P A P = A + v u^T - u v^T with u = A v. Rows are taken two at a time: the products of a single row would
wait for each other.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from floquet.engine.eigen.lanes import LANE_COUNT, broadcast, fma, load, pick_le, square_root, store
from periodic.checks import FloatArray

ROWS_AT_A_TIME = 2
CACHE_LINE_BYTES = 64
NEGLIGIBLE_SQUARE = 1e-280  # a vector whose squares sum to less counts as zero


@njit(cache=True, nogil=True)
def lane_array(n: int) -> FloatArray:
    """Return zeros for an n x n lane array.

    Rows are added up to a multiple of `ROWS_AT_A_TIME`, and columns up to an odd number: rows a power of two apart
    would compete for one place in the cache.
    """
    return _aligned(n + -n % ROWS_AT_A_TIME, n + 1 - n % 2)


@njit(cache=True, nogil=True)
def lane_vectors(count: int, n: int) -> FloatArray:
    """Return zeros for ``count`` lane vectors of n rows, filled up like the rows of `lane_array`."""
    return _aligned(count, n + -n % ROWS_AT_A_TIME)


@njit(cache=True, nogil=True)
def _aligned(rows: int, columns: int) -> FloatArray:
    """Return zeros (rows, columns, LANE_COUNT) that begin at a line of the cache.

    A register that lies across two lines takes twice as long to load.
    """
    size = rows * columns * LANE_COUNT
    room = np.zeros(size + CACHE_LINE_BYTES // 8)
    start = (-room.ctypes.data % CACHE_LINE_BYTES) // 8
    return room[start : start + size].reshape(rows, columns, LANE_COUNT)


@njit(cache=True, nogil=True)
def reflector(head: FloatArray, tail: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return (beta, scale, image) of the reflection I - v v^T, v^T v = 2, that maps x to image e_1.

    ``head`` is x_1, and ``tail`` is the sum of the squares of the other entries. v = scale (x_1 + beta, x_2, x_3, ...).
    For x = 0 the reflection is the identity.
    """
    norm = square_root(fma(head, head, tail))
    beta = pick_le(broadcast(0.0), head, norm, -norm)
    square = beta * (head + beta)  # half of |(x_1 + beta, x_2, ...)|^2
    scale = broadcast(1.0) / square_root(pick_le(square, broadcast(NEGLIGIBLE_SQUARE), broadcast(1.0), square))
    return (
        beta,
        pick_le(square, broadcast(NEGLIGIBLE_SQUARE), broadcast(0.0), scale),
        pick_le(square, broadcast(NEGLIGIBLE_SQUARE), head, -beta),
    )


@njit(cache=True, nogil=True)
def reflect_column(x: FloatArray, v: int, r: int, n: int) -> FloatArray:
    """Turn row ``v`` of the lane vectors ``x`` into the v of a reflection, in place.

    The reflection maps the entries of the row from r on to a multiple of e_r and leaves those before r alone. Return
    that multiple.
    """
    tail = broadcast(0.0)
    for i in range(r + 1, n):
        tail = fma(load(x, v, i), load(x, v, i), tail)
    beta, scale, image = reflector(load(x, v, r), tail)
    store(x, v, r, load(x, v, r) + beta)
    for i in range(n):
        store(x, v, i, load(x, v, i) * scale if i >= r else broadcast(0.0))
    return image


@njit(cache=True, nogil=True)
def pass_general(
    A: FloatArray, x: FloatArray, old: tuple[int, int, int], new: tuple[int, int, int], first: int, n: int
) -> None:
    """Replace A by P A P, and form u and w of the next reflection, in the columns from ``first`` on.

    ``old`` are the rows of ``x`` that hold v, u, w of P; ``new`` are those of the next reflection. Columns before
    ``first`` have their final values; v is zero there.
    """
    v, u, w = old
    next_v, next_u, next_w = new
    for j in range(n):
        store(x, next_w, j, broadcast(0.0))
    s = broadcast(0.0)
    for i in range(0, n, ROWS_AT_A_TIME):
        v0, u0, p0, y0 = load(x, v, i), load(x, u, i), load(x, next_v, i), broadcast(0.0)
        v1, u1, p1, y1 = load(x, v, i + 1), load(x, u, i + 1), load(x, next_v, i + 1), broadcast(0.0)
        for j in range(first, n):
            w_j, v_j, p_j = -load(x, w, j), -load(x, v, j), load(x, next_v, j)
            a0 = fma(v0, w_j, fma(u0, v_j, load(A, i, j)))
            a1 = fma(v1, w_j, fma(u1, v_j, load(A, i + 1, j)))
            store(A, i, j, a0)
            store(A, i + 1, j, a1)
            store(x, next_w, j, fma(p1, a1, fma(p0, a0, load(x, next_w, j))))
            y0, y1 = fma(a0, p_j, y0), fma(a1, p_j, y1)
        store(x, next_u, i, y0)
        store(x, next_u, i + 1, y1)
        s = fma(p0, y0, fma(p1, y1, s))
    half = broadcast(-0.5) * s
    for i in range(first, n):
        p_i = load(x, next_v, i)
        store(x, next_w, i, fma(half, p_i, load(x, next_w, i)))
        store(x, next_u, i, fma(half, p_i, load(x, next_u, i)))


@njit(cache=True, nogil=True)
def pass_skew(M: FloatArray, x: FloatArray, old: tuple[int, int], new: tuple[int, int], first: int, n: int) -> None:
    """Do for a skew matrix what `pass_general` does for a general one.

    Only the part below the diagonal is used. ``old`` and ``new`` are the rows of v and u.
    """
    v, u = old
    next_v, next_u = new
    for j in range(n):
        store(x, next_u, j, broadcast(0.0))
    for i in range(first - first % ROWS_AT_A_TIME, n, ROWS_AT_A_TIME):
        v0, u0, p0, y0 = load(x, v, i), load(x, u, i), load(x, next_v, i), broadcast(0.0)
        v1, u1, p1, y1 = load(x, v, i + 1), load(x, u, i + 1), load(x, next_v, i + 1), broadcast(0.0)
        for j in range(first, i):
            u_j, v_j, p_j = load(x, u, j), -load(x, v, j), load(x, next_v, j)
            m0 = fma(v0, u_j, fma(u0, v_j, load(M, i, j)))
            m1 = fma(v1, u_j, fma(u1, v_j, load(M, i + 1, j)))
            store(M, i, j, m0)
            store(M, i + 1, j, m1)
            store(x, next_u, j, load(x, next_u, j) - fma(p1, m1, p0 * m0))
            y0, y1 = fma(m0, p_j, y0), fma(m1, p_j, y1)
        store(x, next_u, i, y0)
        store(x, next_u, i + 1, y1)
        for a in range(i + 1, min(i + ROWS_AT_A_TIME, n)):  # the rest of the two rows, next to the diagonal
            for j in range(max(i, first), a):
                m = fma(load(x, v, a), load(x, u, j), fma(load(x, u, a), -load(x, v, j), load(M, a, j)))
                store(M, a, j, m)
                store(x, next_u, a, fma(m, load(x, next_v, j), load(x, next_u, a)))
                store(x, next_u, j, fma(-m, load(x, next_v, a), load(x, next_u, j)))
