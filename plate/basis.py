"""Trial functions of eqs. (6) and (9) and their exact integrals.

The paper's spaces, in bases that keep the matrices well conditioned: along x sines (and, for u, Legendre polynomials),
across y Legendre polynomials instead of the monomials (y/b)^l, whose Gram matrix has condition 5e11 at degree 8.
All functions are orthonormal on their interval, so every mass matrix is the identity. With t = X/r in [0, 1],

    s_k(X) = sqrt(2/r) sin(k pi t), k = 1, 2, ...      p_m(X) = q_m(t) / sqrt(r)
    q_l(Y) = sqrt(2 l + 1) P_l(2 Y - 1), l = 0, 1, ...

A matrix of integrals has the test function as its row and the trial function as its column.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from scipy.special import spherical_jn

from periodic.checks import FloatArray


def sine_wavenumbers(terms: int, length: float) -> FloatArray:
    """Return k pi / r for k = 1..terms, shape (terms,)."""
    return np.arange(1.0, terms + 1.0) * (np.pi / length)


def sines(X: FloatArray, terms: int, length: float) -> FloatArray:
    """Return s_k(X), shape (X.size, terms)."""
    return np.sqrt(2 / length) * np.sin(np.outer(X, sine_wavenumbers(terms, length)))


def sine_slopes(X: FloatArray, terms: int, length: float) -> FloatArray:
    """Return s_k'(X), shape (X.size, terms)."""
    wavenumbers = sine_wavenumbers(terms, length)
    return np.sqrt(2 / length) * wavenumbers * np.cos(np.outer(X, wavenumbers))


def legendre(t: FloatArray, terms: int) -> FloatArray:
    """Return q_l(t), shape (t.size, terms)."""
    return np.polynomial.legendre.legvander(2 * t - 1, terms - 1) * np.sqrt(np.arange(1.0, 2.0 * terms, 2.0))


def legendre_derivative(terms: int) -> FloatArray:
    """Return D with q_j' = sum_i D[i, j] q_i, shape (terms, terms).

    Since the q are orthonormal, D[i, j] = (q_j', q_i), and D.T @ D holds (q_j', q_i').
    """
    i, j = np.indices((terms, terms))
    return np.where((j > i) & ((i + j) % 2 == 1), 2 * np.sqrt((2 * i + 1) * (2 * j + 1)), 0.0)


def sine_derivative(terms: int, length: float) -> FloatArray:
    """Return (s_k', s_i), skew, shape (terms, terms)."""
    i, k = np.indices((terms, terms)) + 1
    with np.errstate(divide="ignore"):
        return np.where((i + k) % 2 == 1, 4 * i * k / (length * (i**2 - k**2)), 0.0)


def sine_legendre(sine_terms: int, legendre_terms: int) -> FloatArray:
    """Return (s_k, p_m), shape (legendre_terms, sine_terms); the same on every interval.

    The integral of e^{i w xi} P_m(xi) over [-1, 1] is 2 i^m j_m(w) (Rayleigh's plane-wave expansion; DLMF 10.60.7).
    """
    m, k = np.indices((legendre_terms, sine_terms))
    k += 1
    # Im i^(k + m), from a table so that the zeros are exact
    phase = np.array([0.0, 1.0, 0.0, -1.0])[(k + m) % 4]
    return np.sqrt(2 * (2 * m + 1)) * phase * spherical_jn(m, k * np.pi / 2)


def kronecker(axial: FloatArray, lateral: FloatArray) -> FloatArray:
    """Return the matrix on products of an axial and a lateral function, the lateral index running fastest."""
    rows, columns = axial.shape[0] * lateral.shape[0], axial.shape[1] * lateral.shape[1]
    return (axial[:, None, :, None] * lateral[None, :, None, :]).reshape(rows, columns)


@cache
def _reference_rule(points: int) -> tuple[FloatArray, FloatArray]:
    return np.polynomial.legendre.leggauss(points)


def gauss_legendre(points: int, start: float, end: float) -> tuple[FloatArray, FloatArray]:
    """Return nodes and weights of Gauss's rule on [start, end]: exact to degree 2 points - 1."""
    nodes, weights = _reference_rule(points)
    return start + (end - start) * (nodes + 1) / 2, (end - start) / 2 * weights
