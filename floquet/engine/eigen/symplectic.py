"""Multipliers of sixteen symplectic matrices at once, from n x n instead of 2n x 2n eigenvalue problems.

If Phi is symplectic, W = Phi + Phi^-1 is skew-Hamiltonian, W = [[A, G], [Q, A^T]] with G, Q skew, and each of its
eigenvalues s = mu + 1/mu is double. Van Loan's reduction (C. F. Van Loan, Linear Algebra Appl. 61 (1984) 233-251;
known as PVL after Paige and Van Loan) makes Q zero and A upper Hessenberg by orthogonal symplectic similarity: the s
are the eigenvalues of A. Reciprocal pairs are exact, and where s is real between -2 and 2, |mu| is 1 exactly.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from floquet.engine.eigen.hessenberg import STATE, hessenberg_eigenvalues, interpolate
from floquet.engine.eigen.lanes import WIDTH, fma, load, pick_le, root, spread, store
from floquet.engine.eigen.reflections import lane_array, lane_vectors, pass_general, pass_skew, reflect_column
from periodic.checks import ComplexArray, FloatArray


@njit(cache=True, nogil=True)
def symplectic_eigenvalues(samples: FloatArray, weights: FloatArray) -> ComplexArray:
    """Return mu + 1/mu, shape (16 g, n), of 16 g combinations of ``samples`` (m, 2n, 2n), given lane weights (g,
    m, 16)."""
    groups, n = weights.shape[0], samples.shape[1] // 2
    Phi, A, G, Q = lane_array(2 * n), lane_array(n), lane_array(n), lane_array(n)
    x, state = lane_vectors(VECTORS, n), np.empty((1, STATE, WIDTH))
    real, imag = np.empty((n, WIDTH)), np.empty((n, WIDTH))
    result = np.empty((groups * WIDTH, n), np.complex128)
    for g in range(groups):
        interpolate(samples, weights[g : g + 1], Phi)
        skew_hamiltonian(Phi, A, G, Q, n)
        pvl(A, G, Q, n, x)
        hessenberg_eigenvalues(A, real, imag, state)
        for lane in range(WIDTH):
            for i in range(n):
                result[g * WIDTH + lane, i] = complex(real[i, lane], imag[i, lane])
    return result


@njit(cache=True, nogil=True)
def reciprocal_pairs(s: ComplexArray) -> ComplexArray:
    """Return the multipliers mu, 1/mu with mu + 1/mu = s, from shape (k, n) to (k, 2n)."""
    k, n = s.shape
    mu = np.empty((k, 2 * n), np.complex128)
    for c in range(k):
        for i in range(n):
            half = 0.5 * s[c, i]
            root = np.sqrt(half - 1.0) * np.sqrt(half + 1.0)
            larger = half + root if (half.conjugate() * root).real >= 0.0 else half - root
            mu[c, i], mu[c, n + i] = larger, 1.0 / larger
    return mu


@njit(cache=True, nogil=True)
def skew_hamiltonian(Phi: FloatArray, A: FloatArray, G: FloatArray, Q: FloatArray, n: int) -> None:
    """Write the subsystems of Phi + Phi^-1 for the symplectic lane array Phi = [[a, b], [c, d]], 2n x 2n.

    Phi^-1 = [[d^T, -b^T], [-c^T, a^T]], hence A = a + d^T, G = b - b^T, Q = c - c^T. Of G and Q only the part below
    the diagonal is written.
    """
    for i in range(n):
        for j in range(n):
            store(A, i, j, load(Phi, i, j) + load(Phi, n + j, n + i))
        for j in range(i):
            store(G, i, j, load(Phi, i, n + j) - load(Phi, j, n + i))
            store(Q, i, j, load(Phi, n + i, j) - load(Phi, n + j, i))


# rows of the lane vectors of `pvl`: v, u and w for A, u for G, u for Q, of the last and of the next reflection
LAST, NEXT = (0, 1, 2, 3, 4), (5, 6, 7, 8, 9)
VECTORS = 10


@njit(cache=True, nogil=True)
def pvl(A: FloatArray, G: FloatArray, Q: FloatArray, n: int, x: FloatArray) -> None:
    """Reduce A to the Hessenberg matrix whose eigenvalues are those of [[A, G], [Q, A^T]], all `lane_array` of n rows.

    G and Q, skew and given below the diagonal, are destroyed; ``x`` is ``lane_vectors(VECTORS, n)``.
    """
    x[:] = 0.0
    for k in range(n - 1):
        r = k + 1
        # diag(P, P) makes column k of Q zero below row r; what stays there is q
        v, u = LAST[0], LAST[4]
        for i in range(r, n):
            q = load(Q, i, k) + load(x, v, i) * load(x, u, k) - load(x, u, i) * load(x, v, k)
            store(x, NEXT[0], i, q)
        q = reflect_column(x, NEXT[0], r, n)
        _pass(A, G, Q, x, LAST, NEXT, k, n)
        # a rotation in the plane (r, n + r) makes q zero, too
        _settle(A, G, Q, x, NEXT, r, k, n)
        _rotate(A, G, Q, q, r, k, n)
        # diag(P, P) makes column k of A zero below row r
        v, u, w = NEXT[0], NEXT[1], NEXT[2]
        for i in range(n):
            a = load(A, i, k) - load(x, v, i) * load(x, w, k) - load(x, u, i) * load(x, v, k)
            store(x, LAST[0], i, a)
            store(A, i, k, a if i <= k else spread(0.0))
        store(A, r, k, reflect_column(x, LAST[0], r, n))
        _pass(A, G, Q, x, NEXT, LAST, r, n)
    v, u, w = LAST[0], LAST[1], LAST[2]
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
    """Apply diag(P, P), and prepare for the next; columns of A and Q before ``first`` have settled."""
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
    """Apply the last reflection to row and column r now, and leave them out when it is applied to the rest."""
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
        store(x, row, r, spread(0.0))


@njit(cache=True, nogil=True)
def _rotate(A: FloatArray, G: FloatArray, Q: FloatArray, q: FloatArray, r: int, k: int, n: int) -> None:
    """Rotate the plane (r, n + r) so that q, the entry of Q in row r of column k, becomes zero."""
    a = load(A, r, k)
    norm = root(fma(a, a, q * q))
    safe = pick_le(norm, spread(0.0), spread(1.0), norm)
    c, s = pick_le(norm, spread(0.0), spread(1.0), a / safe), q / safe
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
