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

from floquet.interpolation import chebyshev_points, chebyshev_weights, degree, trigonometric_weights
from periodic.checks import FloatArray

# Error of the interpolation over the whole period, if the bound on growth were attained. It never is: with this value
# the errors measured are below 1e-12 of the norm, which is rounding.
TOLERANCE = 1e-10
# Samples at different phases may differ in size by the exponential of twice this; interpolating between more than that
# would lose the small ones to the rounding of the large.
MOST_GROWTH = 3.0
LARGE = 2.0**200


class Level(NamedTuple):
    """Weights of one doubling, from the samples of P_l to those of its two factors.

    ``nodes`` (m', m) for the amplitudes; ``first`` and ``second`` (p', p) for the phases theta and theta + 2 pi / B.
    Empty where the samples are those needed: all B phases that occur are there, or the phases or nodes stay.
    """

    nodes: FloatArray
    first: FloatArray
    second: FloatArray


class Schedule(NamedTuple):
    """``phases[l]`` and ``nodes[l]``: samples of P_l; ``levels[l]``: from P_l to P_{l+1}."""

    phases: tuple[int, ...]
    nodes: tuple[int, ...]
    levels: tuple[Level, ...]


EMPTY = np.empty((0, 0))


def quantised(x: float) -> float:
    """Return the next fourth of a power of two above ``x``, so that neighbouring columns share their schedule."""
    return 2.0 ** (math.ceil(4 * math.log2(x)) / 4) if x > 0 else 0.0


@lru_cache(maxsize=1024)
def schedule(L: int, x_phase: tuple[float, ...], x_eps: float, tolerance: float) -> Schedule:
    """Plan the doublings of 2^L steps.

    ``x_phase[j - 1]`` bounds the logarithm of the growth that harmonic j can bring about in one period at the largest
    amplitude, ``x_eps`` that of all harmonics together between the middle of the range of amplitudes and its ends
    (0: the amplitudes are those wanted, and stay).
    """
    steps = [2 ** (L - level) for level in range(L + 1)]  # B
    phases = [_phases(B, x_phase, tolerance) for B in steps]
    nodes = [degree((x_eps / B,), tolerance / B) + 1 if x_eps > 0 else 1 for B in steps]
    levels = []
    for B, p, q, m, k in zip(steps, phases, phases[1:], nodes, nodes[1:], strict=False):
        theta = 2 * np.pi * np.arange(q) / q
        levels.append(
            Level(
                nodes=EMPTY if k == m else chebyshev_weights(m, chebyshev_points(k)),
                first=EMPTY if p in (B, q) else trigonometric_weights(p, theta),
                second=EMPTY if p == B else trigonometric_weights(p, theta + 2 * np.pi / B),
            )
        )
    return Schedule(tuple(phases), tuple(nodes), tuple(levels))


def _phases(B: int, x_phase: tuple[float, ...], tolerance: float) -> int:
    if sum(x_phase) > MOST_GROWTH * B:
        return B
    return min(B, 2 * degree(tuple(x / B for x in x_phase), tolerance / B) + 1)


@njit(cache=True, nogil=True)
def double(
    P: FloatArray, nodes: FloatArray, first: FloatArray, second: FloatArray, result: FloatArray, scratch: FloatArray
) -> None:
    """Write P_{l+1} (p', m', N, N) from P_l (p, m, N, N) by the weights of a `Level`; ``scratch`` has (p + 2 p') m'
    N^2 entries."""
    p, m, N = P.shape[0], P.shape[1], P.shape[2]
    used = 0
    if nodes.size > 0:
        finer = scratch[: p * nodes.shape[0] * N * N].reshape(p, nodes.shape[0], N * N)
        for i in range(p):
            np.dot(nodes, P[i].reshape(m, N * N), finer[i])
        used, m = finer.size, nodes.shape[0]
        P = finer.reshape(p, m, N, N)
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


@njit(cache=True, nogil=True)
def rescale(P: FloatArray, exponents: FloatArray) -> None:
    """Take powers of two out of P (p, m, N, N) where it is far from one, and add them to ``exponents``.

    One exponent for every amplitude, (m,), or a common one, (1,), for those that will be interpolated between.
    """
    share = P.shape[1] // exponents.size
    for i in range(exponents.size):
        size = 0.0
        for phase in P[:, i * share : (i + 1) * share]:
            for entry in phase.flat:
                size = max(size, abs(entry))
        if size > LARGE or 0.0 < size < 1.0 / LARGE:
            exponent = np.floor(np.log2(size))
            P[:, i * share : (i + 1) * share] *= 2.0**-exponent
            exponents[i] += exponent
