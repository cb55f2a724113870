"""Multipliers of eight symplectic matrices at once, from n x n instead of 2n x 2n eigenvalue problems.

If Phi is symplectic, W = Phi + Phi^-1 is skew-Hamiltonian, W = [[A, G], [Q, A^T]] with G, Q skew, and each of its
eigenvalues s = mu + 1/mu is double. Van Loan's reduction (C. F. Van Loan, Linear Algebra Appl. 61 (1984) 233-251;
known as PVL after Paige and Van Loan) makes Q zero and A upper Hessenberg by orthogonal symplectic similarity: the s
are the eigenvalues of A. Reciprocal pairs are exact, and where s is real between -2 and 2, |mu| is 1 exactly.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from floquet.lanes import WIDTH, fma, load, pick_le, root, spread, store
from floquet.spectra import hessenberg_eigenvalues, interpolate, lane_array, reflector
from periodic.checks import FloatArray


@njit(cache=True, nogil=True)
def symplectic_eigenvalues(samples: FloatArray, weights: FloatArray) -> NDArray[np.complex128]:
    """Return mu + 1/mu, shape (8 g, n), of 8 g combinations of ``samples`` (m, 2n, 2n), given lane weights (g, m,
    8)."""
    groups, n = weights.shape[0], samples.shape[1] // 2
    Phi, A, G, Q = lane_array(2 * n), lane_array(n), lane_array(n), lane_array(n)
    work, state = np.empty((3, n, WIDTH)), np.empty((1, 5, WIDTH))
    real, imag = np.empty((n, WIDTH)), np.empty((n, WIDTH))
    result = np.empty((groups * WIDTH, n), np.complex128)
    for g in range(groups):
        interpolate(samples, weights[g : g + 1], Phi)
        skew_hamiltonian(Phi, A, G, Q)
        pvl(A, G, Q, work)
        hessenberg_eigenvalues(A, real, imag, state)
        for lane in range(WIDTH):
            for i in range(n):
                result[g * WIDTH + lane, i] = complex(real[i, lane], imag[i, lane])
    return result


@njit(cache=True, nogil=True)
def reciprocal_pairs(s: NDArray[np.complex128]) -> NDArray[np.complex128]:
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
def skew_hamiltonian(Phi: FloatArray, A: FloatArray, G: FloatArray, Q: FloatArray) -> None:
    """Write the blocks of Phi + Phi^-1 for the symplectic lane array Phi = [[a, b], [c, d]] (2n, 2n, 8).

    Phi^-1 = [[d^T, -b^T], [-c^T, a^T]], hence A = a + d^T, G = b - b^T, Q = c - c^T.
    """
    n = A.shape[0]
    for i in range(n):
        for j in range(n):
            store(A, i, j, load(Phi, i, j) + load(Phi, n + j, n + i))
            store(G, i, j, load(Phi, i, n + j) - load(Phi, j, n + i))
            store(Q, i, j, load(Phi, n + i, j) - load(Phi, n + j, i))


@njit(cache=True, nogil=True)
def pvl(A: FloatArray, G: FloatArray, Q: FloatArray, work: FloatArray) -> None:
    """Reduce A (n, n, 8) to the Hessenberg matrix whose eigenvalues are those of [[A, G], [Q, A^T]]; G and Q are
    destroyed.

    ``work`` has shape (3, n, 8).
    """
    n = A.shape[0]
    for k in range(n - 1):
        # diag(P, P) makes column k of Q zero below row k + 1
        _reflection_from(Q, k, k + 2, work)
        _apply_to_general(A, work, k)
        _apply_to_skew(Q, work, k)
        _apply_to_skew(G, work, 0)
        # a rotation in the plane (k + 1, n + k + 1) makes that entry zero, too
        _rotate(A, G, Q, k)
        # diag(P, P) makes column k of A zero below row k + 1
        _reflection_from(A, k, k + 2, work)
        _apply_to_general(A, work, k)
        _apply_to_skew(Q, work, k + 1)
        _apply_to_skew(G, work, 0)
        for i in range(k + 2, n):
            store(A, i, k, spread(0.0))


@njit(cache=True, nogil=True)
def _reflection_from(M: FloatArray, k: int, below: int, work: FloatArray) -> None:
    """Write v of the reflection I - v v^T that makes column k of M zero from row ``below`` on; v_i = 0 for i <= k."""
    n = M.shape[0]
    tail = spread(0.0)
    for i in range(below, n):
        x = load(M, i, k)
        store(work, 0, i, x)
        tail = fma(x, x, tail)
    head = load(M, k + 1, k)
    beta, scale, _ = reflector(head, tail)
    store(work, 0, k + 1, (head + beta) * scale)
    for i in range(below, n):
        store(work, 0, i, load(work, 0, i) * scale)
    for i in range(k + 1):
        store(work, 0, i, spread(0.0))


@njit(cache=True, nogil=True)
def _apply_to_general(M: FloatArray, work: FloatArray, first: int) -> None:
    """Replace M by P M P, where columns before ``first`` are known not to change."""
    n = M.shape[0]
    for j in range(first, n):
        store(work, 1, j, spread(0.0))
    s = spread(0.0)
    for i in range(n):
        v_i, y = load(work, 0, i), spread(0.0)
        for j in range(first, n):
            m = load(M, i, j)
            store(work, 1, j, fma(v_i, m, load(work, 1, j)))
            y = fma(m, load(work, 0, j), y)
        store(work, 2, i, y)
        s = fma(v_i, y, s)
    for i in range(n):
        v_i, u_i = -load(work, 0, i), fma(s, load(work, 0, i), -load(work, 2, i))
        for j in range(first, n):
            store(M, i, j, fma(v_i, load(work, 1, j), fma(u_i, load(work, 0, j), load(M, i, j))))


@njit(cache=True, nogil=True)
def _apply_to_skew(M: FloatArray, work: FloatArray, first: int) -> None:
    """Replace the skew M by P M P = M + v u^T - u v^T, u = M v, in rows and columns from ``first`` on."""
    n = M.shape[0]
    for i in range(first, n):
        y = spread(0.0)
        for j in range(first, n):
            y = fma(load(M, i, j), load(work, 0, j), y)
        store(work, 2, i, y)
    for i in range(first, n):
        v_i, u_i = load(work, 0, i), -load(work, 2, i)
        for j in range(first, n):
            store(M, i, j, fma(v_i, load(work, 2, j), fma(u_i, load(work, 0, j), load(M, i, j))))


@njit(cache=True, nogil=True)
def _rotate(A: FloatArray, G: FloatArray, Q: FloatArray, k: int) -> None:
    """Rotate the plane (r, n + r), r = k + 1, so that Q[r, k] becomes zero."""
    n, r = A.shape[0], k + 1
    x, y = load(A, r, k), load(Q, r, k)
    norm = root(fma(x, x, y * y))
    safe = pick_le(norm, spread(0.0), spread(1.0), norm)
    c, s = pick_le(norm, spread(0.0), spread(1.0), x / safe), y / safe
    for j in range(k, n):  # before column k, both rows are zero
        if j != r:
            a, q = load(A, r, j), load(Q, r, j)
            store(A, r, j, fma(c, a, s * q))
            q = fma(c, q, -s * a)
            store(Q, r, j, q)
            store(Q, j, r, -q)
    for i in range(n):
        if i != r:
            a, g = load(A, i, r), load(G, i, r)
            store(A, i, r, fma(c, a, s * g))
            g = fma(c, g, -s * a)
            store(G, i, r, g)
            store(G, r, i, -g)
