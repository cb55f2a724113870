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
# And while its norm and the inverse of its norm are below this.
MAX_GROUP_SIZE = 1e50


class ProductSolutions(NamedTuple):
    """Solutions of x_{k+1} = F_k x_k, k = 0 ... p - 1, that are multiplied round the cycle.

    Attributes
    ----------
    log_values : ndarray of complex, shape (N,)
        Logarithms of the eigenvalues, whose moduli need not be floats; of those of a cluster, that of their mean.
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
        V, mu, shifts, members = _invariant(judged)
        log_values[block] = np.log(mu) + judged.exponent * np.log(2.0) + factor_logs.sum()
        errors[block] = shifts / np.abs(mu)
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
    left = np.asarray(np.linalg.inv(right), dtype=complex)
    return ProductSolutions(log_values, errors, right, left, logs, closing, tuple(clusters))


def _grouped(
    factors: FloatArray, rounding: FloatArray, systematic: FloatArray
) -> tuple[list[int], FloatArray, FloatArray, FloatArray]:
    """Return where groups of factors begin, their products, and the errors of these.

    A group is as long as the condition of its product allows: the fewer, the sooner blocks are told apart.
    """
    norms = np.linalg.norm(factors, 2, axis=(1, 2))
    starts: list[int] = []
    products: list[FloatArray] = []
    sums: list[FloatArray] = []
    growth: list[float] = []
    for k, factor in enumerate(factors):
        longer = factor @ products[-1] if products else factor
        sizes = np.linalg.svd(longer, compute_uv=False)
        relative = np.array([rounding[k], systematic[k]]) / norms[k]
        if k and sizes[0] <= MAX_GROUP_CONDITION * sizes[-1] and 1 / MAX_GROUP_SIZE < sizes[0] < MAX_GROUP_SIZE:
            products[-1] = longer
            sums[-1] = sums[-1] + relative
            growth[-1] = np.sqrt(sizes[0] / sizes[-1]) * sizes[0]  # an error within is turned, and at worst stretched
        else:
            starts.append(k)
            products.append(factor)
            sums.append(relative)
            growth.append(norms[k])
    random, same = np.array(sums).T * growth
    return starts, np.array(products), random, same


def _sizes(x: ComplexArray, averages: FloatArray) -> FloatArray:
    """Return the norms of the columns of ``x``, those of a cluster averaged."""
    return np.asarray(np.sqrt((np.abs(x) ** 2).sum(axis=0) @ averages))


def _invariant(judged: JudgedBlock) -> tuple[ComplexArray, ComplexArray, FloatArray, list[list[int]]]:
    """Return eigenvectors of a block, or bases of clusters, in columns (s, s); their eigenvalues, or the means of
    clusters, and the shifts; and the columns of each cluster, which stand side by side."""
    values, _, vectors = eigensystem(judged.product)
    columns: list[ComplexArray] = []
    mu: list[complex] = []
    shifts: list[float] = []
    groups: list[list[int]] = []
    for c in np.unique(judged.cluster):
        members = np.flatnonzero(judged.cluster == c).tolist()
        groups.append(list(range(len(mu), len(mu) + len(members))))
        if len(members) == 1:
            columns.append(vectors[:, [int(np.abs(values - judged.mu[members[0]]).argmin())]])
        else:
            columns.append(_invariant_space(judged, members))
        mu += [judged.mu[members].mean()] * len(members)
        shifts += judged.shift[members].tolist()
    return np.hstack(columns).astype(complex), np.array(mu), np.array(shifts), groups


def _invariant_space(judged: JudgedBlock, members: list[int]) -> ComplexArray:
    """Return an orthonormal basis of the space of a cluster, in the order in which the block, less the mean of the
    cluster, stretches its vectors: the first is an eigenvector, even where the block has no other."""
    inside, outside = judged.mu[members], np.delete(judged.mu, members)

    def selected(z: complex) -> bool:
        return len(outside) == 0 or np.abs(inside - z).min() < np.abs(outside - z).min()

    triangle, basis, _ = sla.schur(judged.product.astype(complex), "complex", sort=selected)  # type: ignore[call-overload]
    count = len(members)
    inner = triangle[:count, :count]
    directions = np.linalg.svd(inner - np.trace(inner) / count * np.eye(count))[2]
    return np.asarray(basis[:, :count] @ directions.conj().T[:, ::-1])


def _averages(groups: list[list[int]], s: int) -> FloatArray:
    """Return the matrix (s, s) that takes the mean over each cluster."""
    found = np.zeros((s, s))
    for group in groups:
        found[np.ix_(group, group)] = 1 / len(group)
    return found
