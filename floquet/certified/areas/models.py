"""Taylor models of matrices over a rectangle: polynomials in (xi, eta) with one radius (docs/certify.md, section 6).

A `Model` is a polynomial and a radius. Coefficients of xi^j eta^k are ordered by degree j + k and then by k, so that
the first ``size(d)`` are those of degree at most d. The model stands for all functions that differ from the polynomial,
at every point |xi|, |eta| <= 1, by no more than ``radius`` in the Frobenius norm.

Every bound here is a sum of products of non-negative floats: its own rounding is a part of less than 1e-10 of it, and
`SAFE` covers that. What the rounding of the coefficients does is bounded beforehand: a sum of m products, in any order,
has an error of at most gamma(m) times the same sum of absolute values.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numba import njit

from periodic.checks import FloatArray

# Unit of rounding of float64.
ROUNDING = 2.0**-53
# Makes up for the rounding of a bound: a part of less than 1e-10 with up to 10^5 operations one after the other.
SAFE = 1.0 + 1e-9
# What numbers too small for float64 to hold could add.
TINY = 1e-200
# How often a matrix is squared for a bound of its 2-norm, which then is too large by N^(1/16) at most.
SQUARINGS = 3


@njit(cache=True, nogil=True)
def size(degree: int) -> int:
    """Number of coefficients up to a degree."""
    return (degree + 1) * (degree + 2) // 2


@njit(cache=True, nogil=True)
def gamma(terms: float) -> float:
    """Relative error of a sum of so many products."""
    return 1.01 * terms * ROUNDING


@njit(cache=True, nogil=True)
def _frobenius(A: FloatArray) -> float:
    """Bound of the Frobenius norm."""
    total = 0.0
    for i in range(A.shape[0]):
        for j in range(A.shape[1]):
            total += A[i, j] * A[i, j]
    return np.sqrt(total) * SAFE


@njit(cache=True, nogil=True)
def _norm(A: FloatArray) -> float:
    """Bound of the 2-norm: of B = A^T A it is the root, and so on; rounding of each square is added."""
    largest = _frobenius(A)
    if min(A.shape) == 1 or largest == 0.0:
        return largest
    slack = np.empty(SQUARINGS)
    X = A
    scale = largest
    for level in range(SQUARINGS):
        p, q = X.shape
        Y = np.zeros((q, q))
        for i in range(p):
            for j in range(q):
                x = X[i, j]
                for k in range(q):
                    Y[j, k] += x * X[i, k]
        slack[level] = gamma(p + 2) * scale * scale + TINY
        scale = _frobenius(Y)
        X = Y
    for level in range(SQUARINGS - 1, -1, -1):
        scale = np.sqrt((scale + slack[level]) * SAFE) * SAFE
    return min(scale, largest)


@njit(cache=True, nogil=True)
def degree_norms(coef: FloatArray, degree: int) -> tuple[FloatArray, FloatArray]:
    """Bounds of the sums of 2-norms and of Frobenius norms of the coefficients of each degree."""
    two, frob = np.zeros(degree + 1), np.zeros(degree + 1)
    at = 0
    for t in range(degree + 1):
        for _ in range(t + 1):
            f = _frobenius(coef[at])
            frob[t] += f
            # a sharper bound pays where it is large
            two[t] += _norm(coef[at]) if t <= 2 else f
            at += 1
    return two, frob


@njit(cache=True, nogil=True)
def _product(
    A: FloatArray, da: int, ra: float, B: FloatArray, db: int, rb: float, degree: int
) -> tuple[FloatArray, float]:
    """Product of two models, cut at a degree, with its radius."""
    p, q, s = A.shape[1], A.shape[2], B.shape[2]
    C = np.zeros((size(degree), p, s))
    for ta in range(min(da, degree) + 1):
        for ka in range(ta + 1):
            X = A[ta * (ta + 1) // 2 + ka]
            for tb in range(min(db, degree - ta) + 1):
                t = ta + tb
                for kb in range(tb + 1):
                    Y = B[tb * (tb + 1) // 2 + kb]
                    Z = C[t * (t + 1) // 2 + ka + kb]
                    for i in range(p):
                        for k in range(q):
                            x = X[i, k]
                            for j in range(s):
                                Z[i, j] += x * Y[k, j]
    two_a, frob_a = degree_norms(A, da)
    two_b, frob_b = degree_norms(B, db)
    radius = ra * two_b.sum() + two_a.sum() * rb + ra * rb
    for i in range(da + 1):
        for j in range(db + 1):
            if i + j > degree:
                radius += two_a[i] * frob_b[j]
            else:
                pairs = (1 + (i + j) / 2) ** 2
                radius += gamma(q * pairs + 2) * frob_a[i] * frob_b[j]
    return C, radius * SAFE + TINY


@njit(cache=True, nogil=True)
def moved_coefficients(coef: FloatArray, degree: int, x0: float, hx: float, y0: float, hy: float) -> FloatArray:
    """Coefficients in the variables of a part of the rectangle, xi = x0 + hx xi', eta = y0 + hy eta'."""
    out = coef.copy()
    rows, columns = out.shape[1], out.shape[2]
    for k in range(degree + 1):
        for i in range(degree - k):
            for j in range(degree - k - 1, i - 1, -1):
                t = j + k
                here, up = t * (t + 1) // 2 + k, (t + 1) * (t + 2) // 2 + k
                for row in range(rows):
                    for column in range(columns):
                        out[here, row, column] += x0 * out[up, row, column]
    for j in range(degree + 1):
        for i in range(degree - j):
            for k in range(degree - j - 1, i - 1, -1):
                t = j + k
                here, up = t * (t + 1) // 2 + k, (t + 1) * (t + 2) // 2 + k + 1
                for row in range(rows):
                    for column in range(columns):
                        out[here, row, column] += y0 * out[up, row, column]
    at = 0
    for t in range(degree + 1):
        for k in range(t + 1):
            factor = hx ** (t - k) * hy**k
            for row in range(rows):
                for column in range(columns):
                    out[at, row, column] *= factor
            at += 1
    return out


def frobenius(A: FloatArray) -> float:
    """Bound of the Frobenius norm."""
    return float(_frobenius(np.ascontiguousarray(A)))


def norm(A: FloatArray) -> float:
    """Bound of the 2-norm."""
    return float(_norm(np.ascontiguousarray(A)))


class Model(NamedTuple):
    """All matrix functions that differ from a polynomial by no more than ``radius``.

    Attributes
    ----------
    coef : ndarray, shape (size(degree), rows, columns)
    degree : int
    radius : float
    """

    coef: FloatArray
    degree: int
    radius: float = 0.0

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""
        return self.coef.shape[1], self.coef.shape[2]

    @property
    def T(self) -> Model:
        """The transposed model."""
        return self._replace(coef=np.ascontiguousarray(self.coef.transpose(0, 2, 1)))

    def two(self) -> float:
        """Bound of the polynomial's 2-norm at every point, without the radius."""
        return float(degree_norms(self.coef, self.degree)[0].sum()) * SAFE

    def frobenius(self) -> float:
        """Bound of the polynomial's Frobenius norm at every point, without the radius."""
        return float(degree_norms(self.coef, self.degree)[1].sum()) * SAFE

    def block(self, rows: slice, columns: slice) -> Model:
        """Return a part of the matrix."""
        return self._replace(coef=np.ascontiguousarray(self.coef[:, rows, columns]))

    def __matmul__(self, other: Model) -> Model:
        """Return the product, cut at the higher of the two degrees."""
        degree = max(self.degree, other.degree)
        found = _product(self.coef, self.degree, self.radius, other.coef, other.degree, other.radius, degree)
        return Model(found[0], degree, found[1])

    def widened(self, radius: float) -> Model:
        """Return the model with so much more radius."""
        return self._replace(radius=(self.radius + radius) * SAFE)

    def moved(self, x0: float, hx: float, y0: float, hy: float) -> Model:
        """Return the model on the part xi = x0 + hx xi', eta = y0 + hy eta', |x0| + hx <= 1, |y0| + hy <= 1.

        A coefficient is a sum of products of at most 6 degree + 4 factors 1 + delta; the sums of absolute values are at
        most those of the model on the whole.
        """
        coef = moved_coefficients(self.coef, self.degree, x0, hx, y0, hy)
        return Model(coef, self.degree, (self.radius + gamma(6 * self.degree + 4) * self.frobenius()) * SAFE + TINY)

    def lowered(self, allowed: float) -> Model:
        """Return the model of the least degree, at least 1, for which what is dropped is below ``allowed``."""
        frob = degree_norms(self.coef, self.degree)[1]
        degree, dropped = self.degree, 0.0
        while degree > 1 and dropped + frob[degree] < allowed:
            dropped += frob[degree]
            degree -= 1
        return Model(self.coef[: size(degree)].copy(), degree, (self.radius + dropped) * SAFE)

    def between(self, Y: FloatArray, B: FloatArray) -> Model:
        """Return Y X B with matrices of floats."""
        coef = np.ascontiguousarray(Y @ self.coef @ B)
        fy, fb = frobenius(Y), frobenius(B)
        rounding = gamma(len(B) + Y.shape[1] + 4) * fy * fb * self.frobenius()
        return Model(coef, self.degree, (norm(Y) * self.radius * norm(B) + rounding) * SAFE + TINY)


def combined(weights: Sequence[float], models: Sequence[Model]) -> Model:
    """Return sum_i weights_i models_i, of models of one degree."""
    coef = sum(w * one.coef for w, one in zip(weights, models, strict=True))
    radius = sum(abs(w) * one.radius for w, one in zip(weights, models, strict=True))
    rounding = sum(abs(w) * one.frobenius() for w, one in zip(weights, models, strict=True))
    return Model(np.asarray(coef), models[0].degree, (radius + gamma(len(models) + 4) * rounding) * SAFE + TINY)


def constant(X: Any, degree: int, radius: float = 0.0) -> Model:
    """Return the model of a matrix that does not depend on the point."""
    coef = np.zeros((size(degree), *np.shape(X)))
    coef[0] = X
    return Model(coef, degree, radius)
