"""Multipliers of sixteen symplectic matrices at once, from n x n instead of 2n x 2n eigenvalue problems.

If Phi is symplectic, W = Phi + Phi^-1 is skew-Hamiltonian: W = [[A, G], [Q, A^T]] with skew G and Q, and each of its
eigenvalues s = mu + 1/mu is double. Van Loan's reduction (C. F. Van Loan, Linear Algebra Appl. 61 (1984) 233-251;
known as PVL after Paige and Van Loan) makes Q zero and A upper Hessenberg by orthogonal symplectic similarity. Then the
s are the eigenvalues of A. Reciprocal pairs are exact, and |mu| is exactly 1 where s is real and between -2 and 2.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from floquet.engine.eigen.hessenberg import STATE_ROWS, hessenberg_eigenvalues, interpolate
from floquet.engine.eigen.lanes import LANE_COUNT, broadcast, fma, load, pick_le, square_root, store
from floquet.engine.eigen.reflections import lane_array, lane_vectors, pass_general, pass_skew, reflect_column
from periodic.checks import ComplexArray, FloatArray


@njit(cache=True, nogil=True)
def reciprocal_sums(samples: FloatArray, weights: FloatArray) -> ComplexArray:
    """Return the sums mu + 1/mu, shape (16 g, n), of 16 g combinations of symplectic ``samples`` (m, 2n, 2n).

    ``weights`` (g, m, 16) are the lane weights of the combinations.
    """
    groups, n = weights.shape[0], samples.shape[1] // 2
    Phi, A, G, Q = lane_array(2 * n), lane_array(n), lane_array(n), lane_array(n)
    x, state = lane_vectors(PVL_VECTORS, n), np.empty((1, STATE_ROWS, LANE_COUNT))
    real, imag = np.empty((n, LANE_COUNT)), np.empty((n, LANE_COUNT))
    result = np.empty((groups * LANE_COUNT, n), np.complex128)
    for g in range(groups):
        interpolate(samples, weights[g : g + 1], Phi)
        skew_hamiltonian(Phi, A, G, Q, n)
        pvl(A, G, Q, n, x)
        hessenberg_eigenvalues(A, real, imag, state)
        for lane in range(LANE_COUNT):
            for i in range(n):
                result[g * LANE_COUNT + lane, i] = complex(real[i, lane], imag[i, lane])
    return result


@njit(cache=True, nogil=True)
def reciprocal_pairs(s: ComplexArray) -> ComplexArray:
    """Return the multipliers mu and 1/mu with mu + 1/mu = s, shape (k, 2n), from s of shape (k, n)."""
    k, n = s.shape
    mu = np.empty((k, 2 * n), np.complex128)
    for c in range(k):
        for i in range(n):
            half = 0.5 * s[c, i]
            offset = np.sqrt(half - 1.0) * np.sqrt(half + 1.0)
            larger = half + offset if (half.conjugate() * offset).real >= 0.0 else half - offset
            mu[c, i], mu[c, n + i] = larger, 1.0 / larger
    return mu


@njit(cache=True, nogil=True)
def skew_hamiltonian(Phi: FloatArray, A: FloatArray, G: FloatArray, Q: FloatArray, n: int) -> None:
    """Write A, G, Q of Phi + Phi^-1 = [[A, G], [Q, A^T]] for the symplectic lane array Phi = [[a, b], [c, d]], 2n x 2n.

    Phi^-1 = [[d^T, -b^T], [-c^T, a^T]], hence A = a + d^T, G = b - b^T, Q = c - c^T. Only the parts of G and Q
    below the diagonal are written.
    """
    for i in range(n):
        for j in range(n):
            store(A, i, j, load(Phi, i, j) + load(Phi, n + j, n + i))
        for j in range(i):
            store(G, i, j, load(Phi, i, n + j) - load(Phi, j, n + i))
            store(Q, i, j, load(Phi, n + i, j) - load(Phi, n + j, i))


# Rows of the lane vectors of `pvl` for the last and for the next reflection: v; u and w for A; u for G; u for Q.
LAST_ROWS, NEXT_ROWS = (0, 1, 2, 3, 4), (5, 6, 7, 8, 9)
PVL_VECTORS = 10


@njit(cache=True, nogil=True)
def pvl(A: FloatArray, G: FloatArray, Q: FloatArray, n: int, x: FloatArray) -> None:
    """Reduce A to the Hessenberg matrix whose eigenvalues are those of [[A, G], [Q, A^T]], all `lane_array` of n rows.

    G and Q are skew and given below the diagonal; they are destroyed. ``x`` is the work space
    ``lane_vectors(PVL_VECTORS, n)``.
    """
    x[:] = 0.0
    for k in range(n - 1):
        r = k + 1
        # diag(P, P) makes column k of Q zero below row r, where q is left
        v, u = LAST_ROWS[0], LAST_ROWS[4]
        for i in range(r, n):
            q = load(Q, i, k) + load(x, v, i) * load(x, u, k) - load(x, u, i) * load(x, v, k)
            store(x, NEXT_ROWS[0], i, q)
        q = reflect_column(x, NEXT_ROWS[0], r, n)
        _pass(A, G, Q, x, LAST_ROWS, NEXT_ROWS, k, n)
        # a rotation in the plane (r, n + r) makes q zero as well
        _settle(A, G, Q, x, NEXT_ROWS, r, k, n)
        _rotate(A, G, Q, q, r, k, n)
        # diag(P, P) makes column k of A zero below row r
        v, u, w = NEXT_ROWS[0], NEXT_ROWS[1], NEXT_ROWS[2]
        for i in range(n):
            a = load(A, i, k) - load(x, v, i) * load(x, w, k) - load(x, u, i) * load(x, v, k)
            store(x, LAST_ROWS[0], i, a)
            store(A, i, k, a if i <= k else broadcast(0.0))
        store(A, r, k, reflect_column(x, LAST_ROWS[0], r, n))
        _pass(A, G, Q, x, NEXT_ROWS, LAST_ROWS, r, n)
    v, u, w = LAST_ROWS[0], LAST_ROWS[1], LAST_ROWS[2]
    for i in range(n):
        store(A, i, n - 1, load(A, i, n - 1) - load(x, v, i) * load(x, w, n - 1) - load(x, u, i) * load(x, v, n - 1))


@njit(cache=True, nogil=True)
def _pass(
    A: FloatArray,
    G: FloatArray,
    Q: FloatArray,
    x: FloatArray,
    old: tuple[int, int, int, int, int],
    new: tuple[int, int, int, int, int],
    first: int,
    n: int,
) -> None:
    """Apply diag(P, P) and form the products for the next reflection.

    Columns of A and Q before ``first`` have their final values.
    """
    pass_general(A, x, (old[0], old[1], old[2]), (new[0], new[1], new[2]), first, n)
    pass_skew(G, x, (old[0], old[3]), (new[0], new[3]), 0, n)
    pass_skew(Q, x, (old[0], old[4]), (new[0], new[4]), first, n)


@njit(cache=True, nogil=True)
def _settle(
    A: FloatArray,
    G: FloatArray,
    Q: FloatArray,
    x: FloatArray,
    rows: tuple[int, int, int, int, int],
    r: int,
    k: int,
    n: int,
) -> None:
    """Apply the last reflection to row and column r now, and take r out of the later pass over the rest."""
    v, u, w, u_G, u_Q = rows
    v_r, u_r, w_r = load(x, v, r), load(x, u, r), load(x, w, r)
    for j in range(k, n):
        store(A, r, j, load(A, r, j) - v_r * load(x, w, j) - u_r * load(x, v, j))
    for i in range(n):
        if i != r:
            store(A, i, r, load(A, i, r) - load(x, v, i) * w_r - load(x, u, i) * v_r)
    g_r, q_r = load(x, u_G, r), load(x, u_Q, r)
    for j in range(r):
        store(G, r, j, load(G, r, j) + v_r * load(x, u_G, j) - g_r * load(x, v, j))
    for i in range(r + 1, n):
        store(G, i, r, load(G, i, r) + load(x, v, i) * g_r - load(x, u_G, i) * v_r)
        store(Q, i, r, load(Q, i, r) + load(x, v, i) * q_r - load(x, u_Q, i) * v_r)
    for row in rows:
        store(x, row, r, broadcast(0.0))


@njit(cache=True, nogil=True)
def _rotate(A: FloatArray, G: FloatArray, Q: FloatArray, q: FloatArray, r: int, k: int, n: int) -> None:
    """Rotate the plane (r, n + r) so that q, the entry of Q in row r of column k, becomes zero."""
    a = load(A, r, k)
    norm = square_root(fma(a, a, q * q))
    safe = pick_le(norm, broadcast(0.0), broadcast(1.0), norm)
    c, s = pick_le(norm, broadcast(0.0), broadcast(1.0), a / safe), q / safe
    store(A, r, k, norm)
    for j in range(r + 1, n):  # columns before k are zero in both rows
        a, q = load(A, r, j), -load(Q, j, r)
        store(A, r, j, fma(c, a, s * q))
        store(Q, j, r, fma(s, a, -c * q))
    for i in range(n):
        if i != r:
            a = load(A, i, r)
            g = load(G, i, r) if i > r else -load(G, r, i)
            store(A, i, r, fma(c, a, s * g))
            g = fma(c, g, -s * a)
            if i > r:
                store(G, i, r, g)
            else:
                store(G, r, i, -g)
