"""Floquet doubling: the monodromy matrices of a whole column of a chart from a few hundred small matrix products.

P_l(theta, eps), the product of 2^l steps that begin at phase theta, obeys P_{l+1}(theta) = P_l(theta + 2 pi / B)
P_l(theta), where B = 2^(L - l) such products make one period; P_L is the monodromy matrix. All P_l are entire
functions of eps and of theta, and nearly constant while they span a small part of the period, so that a few phases
and a few amplitudes determine them (floquet/interpolation.py).
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from floquet.interpolation import chebyshev_points, chebyshev_weights, degree, trigonometric_weights
from periodic.checks import FloatArray

# Error of each interpolation if the bound on growth were attained. It never is: with this value the errors measured
# are a few 1e-13 of the norm, which is rounding.
TOLERANCE = 1e-10
# Samples at different phases may differ in size by the exponential of twice this; interpolating between more than that
# would lose the small ones to the rounding of the large.
MOST_GROWTH = 3.0
LARGE = 2.0**200


class Schedule(NamedTuple):
    """Samples and weights of all doublings.

    Attributes
    ----------
    phases, nodes : tuple of int
        P_l is sampled at ``phases[l]`` equispaced phases and ``nodes[l]`` amplitudes.
    weights : ndarray
        For each doubling the matrix (nodes[l + 1], nodes[l]) that interpolates in eps, and those (phases[l + 1],
        phases[l]) that interpolate to the phases theta of the first and theta + 2 pi / B of the second factor, one
        after the other.
    present : bool ndarray, shape (L, 3)
        Which of these matrices are there. Missing are those that would change nothing, and both of the last kind
        where all phases that occur have been sampled.
    """

    phases: NDArray[np.int64]
    nodes: NDArray[np.int64]
    weights: FloatArray
    present: NDArray[np.bool_]


class Scale(NamedTuple):
    """What belongs to samples besides their entries, one number for each amplitude or a common one.

    The samples are to be multiplied by 2^exponents; ``losses`` are the factors by which cancellation, of growth in
    one part of the period against decay in another, has magnified rounding errors.
    """

    exponents: FloatArray
    losses: FloatArray


def unit_scale(amplitudes: int) -> Scale:
    """Return the scale of samples as they are."""
    return Scale(np.zeros(amplitudes), np.ones(amplitudes))


def quantised(x: float) -> float:
    """Return the next fourth of a power of two above ``x``, so that neighbouring columns share their schedule."""
    return 2.0 ** (math.ceil(4 * math.log2(x)) / 4) if x > 0 else 0.0


@lru_cache(maxsize=1024)
def phase_counts(L: int, x_phase: tuple[float, ...], tolerance: float) -> tuple[int, ...]:
    """Return at how many phases P_0 ... P_L are sampled; arguments as for `schedule`."""
    return tuple(_phases(2 ** (L - level), x_phase, tolerance) for level in range(L + 1))


@lru_cache(maxsize=1024)
def schedule(L: int, x_phase: tuple[float, ...], x_eps: float, tolerance: float, levels: int) -> Schedule:
    """Plan the first ``levels`` doublings of 2^L steps.

    ``x_phase[j - 1]`` bounds the logarithm of the growth that harmonic j can bring about in one period at the largest
    amplitude, ``x_eps`` that of all harmonics together between the middle of the range of amplitudes and its ends
    (0: the amplitudes are those wanted, and stay).
    """
    steps = [2 ** (L - level) for level in range(levels + 1)]  # B
    phases = phase_counts(L, x_phase, tolerance)[: levels + 1]
    nodes = [degree((x_eps / B,), tolerance) + 1 if x_eps > 0 else 1 for B in steps]
    weights, present = [np.empty(0)], np.zeros((levels, 3), bool)
    for level in range(levels):
        B, p, q, m, k = steps[level], *phases[level : level + 2], *nodes[level : level + 2]
        present[level] = k != m, p not in (B, q), p != B
        if k != m:
            weights.append(_from_nodes_to_nodes(m, k))
        if p not in (B, q):
            weights.append(_to_phases(p, q, 0.0))
        if p != B:
            weights.append(_to_phases(p, q, 2 * math.pi / B))
    return Schedule(np.array(phases), np.array(nodes), np.concatenate(weights), present)


def _phases(B: int, x_phase: tuple[float, ...], tolerance: float) -> int:
    x = tuple(x / B for x in x_phase)
    return B if sum(x) > MOST_GROWTH else min(B, 2 * degree(x, tolerance) + 1)


@lru_cache(maxsize=1024)
def _from_nodes_to_nodes(m: int, k: int) -> FloatArray:
    return chebyshev_weights(m, chebyshev_points(k)).ravel()


@lru_cache(maxsize=1024)
def _to_phases(p: int, q: int, shift: float) -> FloatArray:
    return trigonometric_weights(p, 2 * np.pi * np.arange(q) / q + shift).ravel()


@njit(cache=True, nogil=True)
def doublings(
    P: FloatArray,
    phases: NDArray[np.int64],
    nodes: NDArray[np.int64],
    weights: FloatArray,
    present: NDArray[np.bool_],
    scale: Scale,
    work: tuple[FloatArray, FloatArray, FloatArray],
) -> FloatArray:
    """Return the samples of P_L, given those of P_0, shape (phases[0], m, N, N), and a `Schedule`.

    ``scale``, that of P_0, is changed to that of P_L. P_0 may be in ``work[0]``; each array of ``work`` has room for
    what is written to it.
    """
    N, used = P.shape[2], 0
    for level in range(present.shape[0]):
        p, q, m = phases[level], phases[level + 1], P.shape[1]
        k = nodes[level + 1] if present[level, 0] else m
        rows = np.array([k, q, q]) * present[level]
        columns = np.array([m, p, p])
        ends = used + (rows * columns).cumsum()
        to_nodes = weights[used : ends[0]].reshape(rows[0], m)
        first = weights[ends[0] : ends[1]].reshape(rows[1], p)
        second = weights[ends[1] : ends[2]].reshape(rows[2], p)
        used = ends[2]
        target = work[1] if level % 2 == 0 else work[0]
        result = target[: q * k * N * N].reshape(q, k, N, N)
        double(P, to_nodes, first, second, result, scale, work[2])
        P = result
        scale.exponents[:] *= 2.0
        rescale(P, scale)
    return P


@njit(cache=True, nogil=True)
def double(
    P: FloatArray,
    to_nodes: FloatArray,
    first: FloatArray,
    second: FloatArray,
    result: FloatArray,
    scale: Scale,
    scratch: FloatArray,
) -> None:
    """Write P_{l+1} (p', m', N, N) from P_l (p, m, N, N), by weights as in a `Schedule`, empty if missing there.

    ``scratch`` has room for (p + 2 p') m' matrices.
    """
    p, m, N = P.shape[0], P.shape[1], P.shape[2]
    used = 0
    if to_nodes.size > 0:
        m = to_nodes.shape[0]
        finer = scratch[: p * m * N * N].reshape(p, m, N * N)
        for i in range(p):
            np.dot(to_nodes, P[i].reshape(P.shape[1], N * N), finer[i])
        P, used = finer.reshape(p, m, N, N), finer.size
    begin, end, stride, offset = P, P, 2, 1
    if second.size > 0:
        q, stride, offset = second.shape[0], 1, 0
        flat = P.reshape(p, m * N * N)
        end = scratch[used : used + q * m * N * N].reshape(q, m, N, N)
        np.dot(second, flat, end.reshape(q, m * N * N))
        used += end.size
        if first.size > 0:
            begin = scratch[used : used + q * m * N * N].reshape(q, m, N, N)
            np.dot(first, flat, begin.reshape(q, m * N * N))
    for i in range(result.shape[0]):
        for a in range(m):
            np.dot(end[stride * i + offset, a], begin[stride * i, a], result[i, a])
            if second.size == 0:
                k = a * scale.losses.size // m
                loss = cancellation(end[stride * i + offset, a], begin[stride * i, a], result[i, a])
                scale.losses[k] = max(scale.losses[k], loss)


@njit(cache=True, nogil=True)
def rescale(P: FloatArray, scale: Scale) -> None:
    """Take powers of two out of P (p, m, N, N) where it is far from one, and add them to the exponents."""
    exponents = scale.exponents
    p, m = P.shape[0], exponents.size
    parts = P.reshape(p, m, P.size // (p * m))
    for a in range(m):
        square = 0.0
        for i in range(p):
            square += np.dot(parts[i, a], parts[i, a])
        if square > LARGE**2 or 0.0 < square < LARGE**-2:
            exponent = np.floor(0.5 * np.log2(square))
            parts[:, a] *= 2.0**-exponent
            exponents[a] += exponent


@njit(cache=True, nogil=True)
def cancellation(A: FloatArray, B: FloatArray, AB: FloatArray) -> float:
    """Return |A| |B| / |A B|, all (N, N); 1 for rotations."""
    N = A.shape[0]
    a, b, ab = A.reshape(N * N), B.reshape(N * N), AB.reshape(N * N)
    return np.sqrt(np.dot(a, a) * np.dot(b, b) / (N * max(np.dot(ab, ab), LARGE**-2)))
