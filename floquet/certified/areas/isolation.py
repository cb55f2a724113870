"""One cluster of multipliers apart from all others, over a cell (docs/certify.md, section 8)."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from floquet.certified.areas.models import SAFE, TINY, Model, combined, constant, degree_norms, frobenius, gamma, norm
from periodic.checks import FloatArray

# Largest defect of an approximate inverse that is worth correcting.
MAX_DEFECT = 0.5


class Invariant(NamedTuple):
    """Columns of [I; X] span an invariant subspace at every point, on which the matrix acts as A.

    ``X`` has as its radius how far the true X may be from the polynomial.
    """

    X: Model
    A: Model


def defect(Y: FloatArray, B: FloatArray) -> float:
    """Bound of the Frobenius norm of Y B - I."""
    size = len(B)
    found = frobenius(Y @ B - np.eye(size))
    return (found + gamma(size + 2) * (frobenius(Y) * frobenius(B) + size)) * SAFE


def in_basis(P: Model, B: FloatArray, Y: FloatArray) -> Model | None:
    """Return the model of B^-1 P B, with Y about B^-1; None if Y is not near enough."""
    e = defect(Y, B)
    if not e < MAX_DEFECT:
        return None
    # B^-1 = (I + E)^-1 Y, Y B = I + E
    M = P.between(Y, B)
    return M.widened(e / (1 - e) * (M.frobenius() + M.radius))


def isolated(M: Model, m: int) -> Invariant | None:
    """Return what the first m coordinates become as an invariant subspace, if they are proved apart from the others."""
    first, rest = slice(None, m), slice(m, None)
    II, IK, KI, KK = (
        M.block(rows, columns)._replace(radius=0.0) for rows in (first, rest) for columns in (first, rest)
    )
    r, k = M.radius, M.shape[0] - m
    if k == 0:
        return Invariant(constant(np.zeros((0, m)), M.degree), M)
    L = np.kron(KK.coef[0], np.eye(m)) - np.kron(np.eye(k), II.coef[0].T)
    try:
        inverse = np.linalg.inv(L)
    except np.linalg.LinAlgError:
        return None
    # L itself is rounded once where two numbers are subtracted
    q = defect(inverse, L) + gamma(2) * frobenius(inverse) * frobenius(L)
    if not q < MAX_DEFECT:
        return None
    ell = norm(inverse) / (1 - q) * SAFE
    X = Model(_graph(KI.coef, KK.coef, II.coef, IK.coef, np.ascontiguousarray(inverse), M.degree), M.degree)
    reach = 1 + X.two()
    Z = IK @ X
    residual = combined([1, 1, -1, -1], [KI, KK @ X, X @ II, X @ Z])
    eta = ell * (residual.frobenius() + residual.radius + r * reach**2) * SAFE
    # the linearisation at X without its constant part
    outer, inner = combined([1, -1], [KK, X @ IK]), combined([1, 1], [II, Z])
    change = 2 * r * reach
    for one, middle in ((outer, KK.coef[0]), (inner, II.coef[0])):
        one.coef[0] -= middle
        change += one.two() + one.radius + gamma(2) * frobenius(middle)
    a = ell * change * SAFE
    b = ell * (IK.two() + r) * SAFE
    if not (a < 1 and (1 - a) ** 2 > 4 * b * eta * SAFE**3):
        return None
    left = (1 - a) / SAFE
    beta = 2 * eta / (left + math.sqrt(max(left * left - 4 * b * eta * SAFE, 0.0))) * SAFE + TINY
    A = combined([1, 1], [II, Z]).widened(r * reach + (IK.two() + r) * beta)
    return Invariant(X._replace(radius=beta), A)


@njit(cache=True, nogil=True)
def _add(out: FloatArray, X: FloatArray, Y: FloatArray, sign: float) -> None:
    """Add sign X Y to a matrix."""
    for i in range(X.shape[0]):
        for p in range(X.shape[1]):
            x = sign * X[i, p]
            for j in range(Y.shape[1]):
                out[i, j] += x * Y[p, j]


@njit(cache=True, nogil=True)
def _graph(
    KI: FloatArray, KK: FloatArray, II: FloatArray, IK: FloatArray, inverse: FloatArray, degree: int
) -> FloatArray:
    """Coefficients of X with M_KI + M_KK X - X M_II - X M_IK X = 0, X_0 = 0, degree by degree.

    In plain float64: how good it is, the residual tells.
    """
    coefs, k, m = KI.shape
    X, Z, rest = np.zeros((coefs, k, m)), np.zeros((coefs, m, m)), KI.copy()
    for s in range(1, degree + 1):
        first = s * (s + 1) // 2
        for a in range(first, first + s + 1):
            for i in range(k):
                for j in range(m):
                    total = 0.0
                    for p in range(k):
                        for q in range(m):
                            total += inverse[i * m + j, p * m + q] * rest[a, p, q]
                    X[a, i, j] = -total
        # Z = M_IK X to this degree
        for u in range(1, s + 1):
            for ku in range(u + 1):
                for kv in range(s - u + 1):
                    a, b = u * (u + 1) // 2 + ku, (s - u) * (s - u + 1) // 2 + kv
                    _add(Z[first + ku + kv], IK[b], X[a], 1.0)
        # what these coefficients do to those of higher degree
        for ka in range(s + 1):
            a = first + ka
            for tb in range(1, degree - s + 1):
                t = s + tb
                for kb in range(tb + 1):
                    b, c = tb * (tb + 1) // 2 + kb, t * (t + 1) // 2 + ka + kb
                    _add(rest[c], KK[b], X[a], 1.0)
                    _add(rest[c], X[a], II[b], -1.0)
                    if tb <= s:
                        _add(rest[c], X[a], Z[b], -1.0)
                    if tb < s:
                        _add(rest[c], X[b], Z[a], -1.0)
    return X


def form_on(J: FloatArray, error: float, X: Model) -> Model:
    """Return the model of W^T J W, W = [I; X], with J known to ``error`` in the Frobenius norm."""
    m = X.shape[1]
    first, rest = slice(None, m), slice(m, None)
    II, IK, KI, KK = (constant(J[rows, columns], X.degree) for rows in (first, rest) for columns in (first, rest))
    if X.shape[0] == 0:
        return II._replace(radius=error)
    whole = combined([1, 1, 1, 1], [II, IK @ X, X.T @ KI, X.T @ (KK @ X)])
    return whole.widened(error * (1 + X.two() + X.radius) ** 2)


def is_definite(S: Model) -> bool:
    """Return whether the symmetric matrix is definite at every point of the cell."""
    values, V = np.linalg.eigh(S.coef[0])
    if values[0] <= 0 <= values[-1]:
        return False
    # V^T S V by Gershgorin's theorem
    D = S.between(np.ascontiguousarray(V.T), V)
    diagonal = np.diag(D.coef[0]) * np.sign(values[0])
    others = np.abs(D.coef).sum(axis=(0, 2)) - np.abs(np.diag(D.coef[0]))
    rounding = gamma(len(V) * len(D.coef) + 4) * np.abs(D.coef).sum()
    # a row of a matrix adds at most sqrt(m) times its Frobenius norm
    slack = (math.sqrt(len(V)) * D.radius + rounding) * SAFE + TINY
    return bool((diagonal - others > slack).all())


def is_regular(Q: Model) -> bool:
    """Return whether the matrix is regular at every point of the cell."""
    try:
        inverse = np.linalg.inv(Q.coef[0])
    except np.linalg.LinAlgError:
        return False
    change = float(degree_norms(Q.coef, Q.degree)[1][1:].sum()) + Q.radius
    return (defect(inverse, Q.coef[0]) + norm(inverse) * change) * SAFE < 1
