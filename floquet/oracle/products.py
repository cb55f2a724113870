"""Eigenvalues of a product of matrices that is never formed: small ones as good as large ones.

Formed, the product F_p ... F_2 F_1 is right to rounding of its norm, and every eigenvalue below that is noise. The
factors, each of moderate condition, hold them all. Orthonormal bases are carried round the cycle,

    F_k Q_{k-1} = Q_k R_k,    k = 1 ... p,    then again from Q_0 = Q_p,

until their leading columns span the fastest-growing solutions (simultaneous iteration; a periodic QR algorithm without
shifts). The R_k are then block upper triangular, and each product of diagonal blocks holds eigenvalues of similar size.

Sources: A. W. Bojanczyk, G. H. Golub and P. Van Dooren, "The periodic Schur decomposition", Proc. SPIE 1770 (1992)
31-42; D. S. Watkins, "Product eigenvalue problems", SIAM Review 47 (2005) 3-40.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise, takewhile
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse.csgraph import connected_components

from floquet.oracle.multipliers import ISOLATED_SHIFT, QR_ROUNDINGS, perturbed_eigenvalues
from floquet.oracle.taylor import MACHINE_EPSILON
from periodic.checks import ComplexArray, FloatArray

# A block is left whole if the moduli of its eigenvalues differ by less than this factor: its product may be formed.
MAX_BLOCK_SPREAD = 100.0
# A block is cut only between eigenvalues whose moduli differ by at least this factor.
MIN_CUT_RATIO = 2.0
# Rounds of the cycle after which a block that could not be cut is left whole.
MAX_ROUNDS = 80
# Relative accuracy of the solutions of each block where they serve the error estimate alone, and where they are what is
# wanted; and the rounds that it may take.
ESTIMATE_TOLERANCE, SOLUTION_TOLERANCE, MAX_SOLUTION_ROUNDS = 1e-2, 1e-14, 60
# Binary exponent of the smallest number that float64 holds.
MIN_EXPONENT = -1074

Slices = list[slice]


class ProductEigenvalues(NamedTuple):
    """Eigenvalues of a product (N,), and their estimated errors relative to their moduli (N,)."""

    values: ComplexArray
    errors: FloatArray


def product_eigenvalues(factors: FloatArray, rounding: FloatArray, systematic: FloatArray) -> ProductEigenvalues:
    """Return the eigenvalues of factors[-1] @ ... @ factors[0].

    Parameters
    ----------
    factors : ndarray, shape (p, N, N)
        Each of moderate condition: nothing is left of a solution that a factor shrinks to less than the factor's error.
    rounding, systematic : ndarray, shape (p,)
        Estimated spectral norms of the errors of the factors: those that know nothing of each other, and those that may
        be the same in all.

    Returns
    -------
    ProductEigenvalues
        An eigenvalue too small for float64 is 0, with the error 1.

    Notes
    -----
    Let the columns of Z_k span the solutions that belong to a block, and those of W_k the same of the transposed
    factors, W_k^T Z_k = I. An error E_k of F_k reaches the block as W_k^T E_k Z_{k-1}, so the product of the blocks
    B_k is off by |B_p ... B_{k+1}| |W_k| |E_k| |Z_{k-1}| |B_{k-1} ... B_1| at most, to first order in E. Of rounding
    the squares of these contributions are added, of systematic errors the contributions.
    """
    N = factors.shape[1]
    scaled, exponents, rounding, systematic = scaled_factors(factors, rounding, systematic)
    values, relative = np.zeros(N, complex), np.ones(N)
    total = int(exponents.sum())
    R, blocks, _ = block_triangular(scaled, MIN_EXPONENT - total)
    T = block_solutions(R, blocks, ESTIMATE_TOLERANCE)
    for block, found in judged_blocks(R, T, blocks, rounding, systematic):
        values[block] = _ldexp(found.mu, found.exponent + total)
        relative[block] = np.where(values[block] == 0, 1.0, found.shift / np.abs(found.mu))
    return ProductEigenvalues(values, relative)


class JudgedBlock(NamedTuple):
    """The product of a diagonal block, divided by 2^exponent: eigenvalues, shifts by the error, and which are crowded
    with which: the number of the cluster of each."""

    product: FloatArray
    exponent: int
    mu: ComplexArray
    shift: FloatArray
    cluster: NDArray[np.intp]


def scaled_factors(
    factors: FloatArray, rounding: FloatArray, systematic: FloatArray
) -> tuple[FloatArray, NDArray[np.intp], FloatArray, FloatArray]:
    """Return the factors divided by powers of two, the exponents of these, and the errors of what is left."""
    exponents = np.frexp(np.linalg.norm(factors, axis=(1, 2)))[1]
    # the orthogonal transformations round, too
    rounding = np.ldexp(rounding, -exponents) + QR_ROUNDINGS * np.sqrt(factors.shape[1]) * MACHINE_EPSILON
    return np.ldexp(factors, -exponents[:, None, None]), exponents, rounding, np.ldexp(systematic, -exponents)


def judged_blocks(
    R: FloatArray, T: FloatArray, blocks: Slices, rounding: FloatArray, systematic: FloatArray
) -> Iterator[tuple[slice, JudgedBlock]]:
    """Yield each block and what is known of its eigenvalues."""
    first, second = _solution_norms(T, blocks)
    reach = np.roll(second, -1, axis=0) * first
    for number, block in enumerate(blocks):
        product, exponent, amplification = _chain(R[:, block, block])
        amplification *= reach[:, number]
        error = np.linalg.norm(amplification * rounding) + amplification @ systematic
        found = perturbed_eigenvalues(product, float(error))
        shift = found.shifts(product, np.arange(len(product)))
        near = found.distance <= np.maximum.outer(found.first_order, found.first_order) / ISOLATED_SHIFT
        _, cluster = connected_components(near, directed=False)
        yield block, JudgedBlock(product, exponent, found.mu, shift, np.asarray(cluster, dtype=np.intp))


def block_triangular(factors: FloatArray, least: float) -> tuple[FloatArray, Slices, FloatArray]:
    """Return R (p, m, m), block upper triangular and similar to the factors as a cycle, its diagonal blocks, and the
    bases Q (p, N, m) before each factor in which it is so.

    Left out are the last N - m solutions, if their multipliers are below 2 to the power of ``least``.
    """
    p, N, _ = factors.shape
    # generic: no eigenvector is at right angles to it
    start = np.linalg.qr(np.random.default_rng(0).standard_normal((N, N)))[0]
    bases = np.broadcast_to(start, (p, N, N)).copy()
    found: list[tuple[slice, float]] = []
    pending = [(slice(0, N), start.T @ factors @ start)]
    while pending:
        whole, parts = pending.pop()
        local, R, log_moduli, cuts = _cut(parts)
        bases[:, :, whole] = bases[:, :, whole] @ local
        ends = [0, *cuts, len(log_moduli)]
        for a, b in pairwise(ends):
            inside, block = slice(a, b), slice(whole.start + a, whole.start + b)
            if cuts and b - a > 1:
                pending.append((block, R[:, inside, inside]))
            else:
                found.append((block, float(log_moduli[inside].max())))
    found.sort(key=lambda one: one[0].start)
    blocks = [block for block, _ in takewhile(lambda one: one[1] / np.log(2) > least, found)]
    size = blocks[-1].stop if blocks else 0
    kept = bases[:, :, :size]
    R = np.roll(kept, -1, axis=0).transpose(0, 2, 1) @ factors @ kept
    for block in blocks:
        R[:, block.stop :, block] = 0.0
    return R, blocks, kept


def _cut(factors: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray, list[int]]:
    """Carry bases round the cycle until a block can be cut.

    Returns
    -------
    bases : ndarray, shape (p, s, s)
        Before each factor.
    R : ndarray, shape (p, s, s)
        The factors in these bases.
    log_moduli : ndarray, shape (s,)
        Logarithms of the diagonal entries of the product, approximate moduli of its eigenvalues, decreasing.
    cuts : list of int
        Where it can be cut; empty if it need not or could not be.
    """
    p, s, _ = factors.shape
    basis = np.eye(s)
    bases, R = np.empty((p, s, s)), np.empty((p, s, s))
    for _ in range(MAX_ROUNDS):
        start = basis
        for k, factor in enumerate(factors):
            bases[k] = basis
            basis, R[k] = np.linalg.qr(factor @ basis)
        closing = start.T @ basis
        log_moduli = np.log(np.maximum(np.abs(np.diagonal(R, axis1=1, axis2=2)), np.finfo(float).tiny)).sum(axis=0)
        if log_moduli.max() - log_moduli.min() <= np.log(MAX_BLOCK_SPREAD):
            cuts: list[int] = []
            break
        # what the leading j columns leave their span by in a round
        left = np.sqrt(np.cumsum(np.cumsum(closing[::-1] ** 2, axis=0)[::-1], axis=1).diagonal(-1))
        closed = left <= QR_ROUNDINGS * s * MACHINE_EPSILON
        cuts = (np.flatnonzero(closed & (-np.diff(log_moduli) >= np.log(MIN_CUT_RATIO))) + 1).tolist()
        if cuts:
            break
    R[-1] = closing @ R[-1]
    return bases, R, log_moduli, cuts


def block_solutions(R: FloatArray, blocks: Slices, tolerance: float) -> FloatArray:
    """Return T (p, m, m), unit block upper triangular: its columns are the solutions of each block before each factor.

    R_k T_{k-1} = T_k B_k, where B_k are the diagonal blocks. From T_p = I and backwards round the cycle,
    T_{k-1} = R_k^{-1} T_k B_k, a block's error decreases by the ratio of its multipliers to those of the blocks before
    it.
    """
    p, size, _ = R.shape
    diagonal, above = np.zeros((size, size)), np.zeros((size, size))
    for block in blocks:
        diagonal[block, block] = 1.0
        above[block, block.stop :] = 1.0
    T = np.broadcast_to(np.eye(size), (p, size, size)).copy()
    if len(blocks) > 1:
        B, inverse = R * diagonal, np.linalg.inv(R)
        for _ in range(MAX_SOLUTION_ROUNDS):
            before = T[0].copy()
            for k in range(p - 1, -1, -1):
                T[k] = np.eye(size) + above * (inverse[k] @ (T[(k + 1) % p] @ B[k]))
            if np.linalg.norm(T[0] - before) <= tolerance * np.linalg.norm(before):
                break
    return T


def _solution_norms(T: FloatArray, blocks: Slices) -> tuple[FloatArray, FloatArray]:
    """Return |Z_k| and |W_k| (p, blocks), Frobenius norms of the solutions of each block before each factor.

    Z_k are the columns of T_k that belong to the block; W_k^T are the rows of its inverse.
    """
    starts = [block.start for block in blocks]
    if not starts:
        return np.zeros((len(T), 0)), np.zeros((len(T), 0))
    columns = np.add.reduceat((T**2).sum(axis=1), starts, axis=1)
    rows = np.add.reduceat((np.linalg.inv(T) ** 2).sum(axis=2), starts, axis=1)
    return np.sqrt(columns), np.sqrt(rows)


def _chain(factors: FloatArray) -> tuple[FloatArray, int, FloatArray]:
    """Return the product divided by a power of two, its exponent, and |after_k| |before_k| (p,), divided by it, too.

    Here before_k and after_k are the products of the factors before and after factor k.
    """
    before, before_exponents = _partial_products(factors)
    after, after_exponents = _partial_products(factors[::-1].transpose(0, 2, 1))
    exponent = int(before_exponents[-1])
    sizes = np.linalg.norm(before, 2, axis=(1, 2))[:-1] * np.linalg.norm(after, 2, axis=(1, 2))[-2::-1]
    return before[-1], exponent, np.ldexp(sizes, before_exponents[:-1] + after_exponents[-2::-1] - exponent)


def _partial_products(factors: FloatArray) -> tuple[FloatArray, NDArray[np.intp]]:
    """Return I, F_1, F_2 F_1, ... (p + 1, s, s), each divided by a power of two, and the exponents (p + 1,)."""
    p, s, _ = factors.shape
    products, exponents = np.empty((p + 1, s, s)), np.zeros(p + 1, dtype=np.intp)
    products[0] = np.eye(s)
    for k, factor in enumerate(factors):
        product = factor @ products[k]
        shift = int(np.frexp(np.abs(product).max())[1])
        products[k + 1], exponents[k + 1] = np.ldexp(product, -shift), exponents[k] + shift
    return products, exponents


def _ldexp(mu: ComplexArray, exponent: int) -> ComplexArray:
    return np.ldexp(mu.real, exponent) + 1j * np.ldexp(mu.imag, exponent)
