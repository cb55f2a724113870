"""The solutions that go with the eigenvalues of a product: right and left eigenvectors before every factor.

The product is never formed (`floquet.oracle.products`), so the vectors of small eigenvalues are as good as those of
large ones. Where eigenvalues are so close that the errors of the factors let them meet, no vector of one of them means
anything, but the space of all of them does: such a cluster has a basis of that space.
"""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np
import scipy.linalg as sla
from numpy.typing import NDArray

from floquet.oracle.multipliers import eigensystem
from floquet.oracle.products import (
    SOLUTION_TOLERANCE,
    JudgedBlock,
    block_solutions,
    block_triangular,
    judged_blocks,
    scaled_factors,
)
from periodic.checks import ComplexArray, FloatArray


# Factors are multiplied together up to this condition of their product: no solution is then known worse than to this
# many roundings.
MAX_GROUP_CONDITION = 1e3


class ProductSolutions(NamedTuple):
    """Solutions of x_{k+1} = F_k x_k, k = 0 ... p - 1, that are multiplied round the cycle.

    Attributes
    ----------
    log_values : ndarray of complex, shape (N,)
        Logarithms of the eigenvalues; their moduli need not be floats.
    errors : ndarray, shape (N,)
        Estimated errors of the eigenvalues relative to their moduli.
    right : ndarray of complex, shape (p, N, N)
        Before each factor, in columns, of norm one (a cluster: on average). Of a cluster it is a basis of its space, of
        which the first is an eigenvector.
    left : ndarray of complex, shape (p, N, N)
        left[k] @ right[k] = 1; rows.
    logs : ndarray, shape (p, N)
        F_k right[k] = right[k + 1] * exp(logs[k]), of a cluster as well.
    closing : ndarray of complex, shape (N, N)
        right[p] = right[0] @ closing: of modulus one for a single eigenvalue, a matrix for a cluster.
    clusters : tuple of tuple of int
        Columns that belong together; most alone.
    """

    log_values: ComplexArray
    errors: FloatArray
    right: ComplexArray
    left: ComplexArray
    logs: FloatArray
    closing: ComplexArray
    clusters: tuple[tuple[int, ...], ...]


def product_solutions(factors: FloatArray, rounding: FloatArray, systematic: FloatArray) -> ProductSolutions:
    """Return eigenvalues and solutions of factors[-1] @ ... @ factors[0]; arguments as `product_eigenvalues`."""
    p, N, _ = factors.shape
    starts, groups, rounding, systematic = _grouped(factors, rounding, systematic)
    scaled, exponents, rounding, systematic = scaled_factors(groups, rounding, systematic)
    R, blocks, bases = block_triangular(scaled, -np.inf)
    T = block_solutions(R, blocks, SOLUTION_TOLERANCE)
    log_values, errors = np.empty(N, complex), np.empty(N)
    right, logs = np.empty((p, N, N), complex), np.empty((p, N))
    averages, closing = np.zeros((N, N)), np.zeros((N, N), complex)
    clusters: list[tuple[int, ...]] = []
    factor_logs = exponents * np.log(2.0)
    for block, judged in judged_blocks(R, T, blocks, rounding, systematic):
        V, order, members = _invariant(judged)
        mu = judged.mu[order]
        with np.errstate(divide="ignore"):
            log_values[block] = np.log(mu) + judged.exponent * np.log(2.0) + factor_logs.sum()
            errors[block] = judged.shift[order] / np.abs(mu)
        clusters += [tuple(block.start + i for i in group) for group in members]
        averages[block, block] = _averages(members, len(mu))
        for group, start in enumerate(starts):
            right[start][:, block] = bases[group] @ T[group][:, block] @ V
            V = R[group, block, block] @ V
            V /= _sizes(V, averages[block, block])
    for start, end in pairwise([*starts, p]):
        right[start] /= _sizes(right[start], averages)
        x = right[start]
        for k in range(start, end):
            x = factors[k] @ x
            size = _sizes(x, averages)
            x = x / size
            logs[k] = np.log(size)
            if k + 1 < end:
                right[k + 1] = x
        # what the group ends with is what the next begins with, up to a factor that is one for all but the last
        turned = np.linalg.solve(right[end % p], x)
        if end < p:
            right[end] @= np.where(averages > 0, turned, 0.0)
        else:
            closing = np.where(averages > 0, turned, 0.0)
    return ProductSolutions(log_values, errors, right, np.linalg.inv(right), logs, closing, tuple(clusters))


def _grouped(
    factors: FloatArray, rounding: FloatArray, systematic: FloatArray
) -> tuple[list[int], FloatArray, FloatArray, FloatArray]:
    """Return where groups of factors begin, their products, and the errors of these.

    A group is as long as the condition of its product allows: the fewer, the sooner blocks are told apart.
    """
    starts, products, errors = [], [], []
    for k, factor in enumerate(factors):
        longer = factor @ products[-1] if products else factor
        if k and np.linalg.cond(longer) <= MAX_GROUP_CONDITION:
            products[-1] = longer
            growth = max(1.0, float(np.linalg.norm(longer, 2)))
            errors[-1] = (max(growth, errors[-1][0]), errors[-1][1] + rounding[k], errors[-1][2] + systematic[k])
        else:
            starts.append(k)
            products.append(factor)
            errors.append((1.0, rounding[k], systematic[k]))
    growth, random, same = np.array(errors).T
    return starts, np.array(products), growth * random, growth * same


def _sizes(x: ComplexArray, averages: FloatArray) -> FloatArray:
    """Return the norms of the columns of ``x``, those of a cluster averaged."""
    return np.asarray(np.sqrt((np.abs(x) ** 2).sum(axis=0) @ averages))


def _invariant(judged: JudgedBlock) -> tuple[ComplexArray, NDArray[np.intp], list[list[int]]]:
    """Return eigenvectors of a block, or bases of clusters, in columns (s, s); the eigenvalues in their order; and the
    columns of each cluster, which stand side by side."""
    values, _, vectors = eigensystem(judged.product)
    columns, order, groups = [], [], []
    for members in _clusters(judged):
        place = len(order)
        if len(members) == 1:
            columns.append(vectors[:, [int(np.abs(values - judged.mu[members[0]]).argmin())]])
            order += members
        else:
            basis, diagonal = _invariant_space(judged, members)
            columns.append(basis)
            order += [min(members, key=lambda i: abs(judged.mu[i] - z)) for z in diagonal]
        groups.append(list(range(place, place + len(members))))
    return np.hstack(columns).astype(complex), np.array(order, dtype=np.intp), groups


def _clusters(judged: JudgedBlock) -> list[list[int]]:
    """Return the members of each cluster."""
    return [np.flatnonzero(judged.cluster == c).tolist() for c in np.unique(judged.cluster)]


def _invariant_space(judged: JudgedBlock, members: list[int]) -> tuple[ComplexArray, ComplexArray]:
    """Return an orthonormal basis of the space of a cluster, the first vector an eigenvector, and its eigenvalues."""
    inside, outside = judged.mu[members], np.delete(judged.mu, members)

    def selected(z: complex) -> bool:
        return len(outside) == 0 or np.abs(inside - z).min() < np.abs(outside - z).min()

    triangle, basis, _ = sla.schur(judged.product.astype(complex), "complex", sort=selected)  # type: ignore[call-overload]
    count = len(members)
    return basis[:, :count], np.diagonal(triangle)[:count]


def _averages(groups: list[list[int]], s: int) -> FloatArray:
    """Return the matrix (s, s) that takes the mean over each cluster."""
    found = np.zeros((s, s))
    for group in groups:
        found[np.ix_(group, group)] = 1 / len(group)
    return found
