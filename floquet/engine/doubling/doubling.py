"""Floquet doubling: the monodromy matrices of a whole column of a chart from one or two hundred small matrix products.

P_l(theta, eps), the product of 2^l steps that begin at phase theta, obeys P_{l+1}(theta) = P_l(theta + 2 pi / B)
P_l(theta), where B = 2^(L - l) such products make one period. P_L is the monodromy matrix. The `Schedule`
(floquet/engine/doubling/schedule.py) says which P_l are sampled, and how the others follow from these samples.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

from floquet.engine.doubling.schedule import Schedule
from floquet.engine.doubling.step import multiply
from periodic.checks import FloatArray

RESCALING_NORM = 2.0**200  # matrices with a norm above it, or below its inverse, are scaled by a power of two


class Scale(NamedTuple):
    """Scale and loss of accuracy of samples: one number for each amplitude, or one for all.

    The samples are to be multiplied by 2^exponents. ``losses`` are the factors by which cancellation has magnified
    rounding errors: growth in one part of the period is cancelled by decay in another.
    """

    exponents: FloatArray
    losses: FloatArray


def unit_scale(amplitudes: int) -> Scale:
    """Return the scale of samples that need no scaling and have lost no accuracy."""
    return Scale(np.zeros(amplitudes), np.ones(amplitudes))


@njit(cache=True, nogil=True)
def doublings(N: int, schedule: Schedule, scale: Scale, work: tuple[FloatArray, FloatArray]) -> FloatArray:
    """Return the samples (sizes[-1], N, N) at the end of a schedule, given those at its beginning in ``work[0]``.

    ``scale`` is changed from that of the beginning to that of the end. Each array of ``work`` has room for
    ``schedule.max_matrices`` matrices.
    """
    phases, amplitudes, weights, pairs = schedule.phases, schedule.amplitudes, schedule.weights, schedule.pairs
    losses = scale.losses
    here, done, used, size = 0, 0, 0, N * N
    for level in range(schedule.added_phases.size):
        p, e = phases[level], schedule.added_phases[level]
        m, k = amplitudes[level], schedule.needed_amplitudes[level]
        if m != k:
            across_amplitudes = weights[done : done + k * m].reshape(k, m)
            done += k * m
            for i in range(p):
                coarse = work[here][i * m * size : (i + 1) * m * size].reshape(m, size)
                np.dot(across_amplitudes, coarse, work[1 - here][i * k * size : (i + 1) * k * size].reshape(k, size))
            here = 1 - here
        if e > 0:
            across_phases = weights[done : done + e * p].reshape(e, p)
            done += e * p
            flat = work[here][: (p + e) * k * size].reshape(p + e, k * size)
            np.dot(across_phases, flat[:p], flat[p:])
        q = phases[level + 1] * amplitudes[level + 1] // k
        first, second = pairs[used : used + q], pairs[used + q : used + 2 * q]
        used += 2 * q
        P = work[here][: (p + e) * k * size].reshape((p + e) * k, N, N)
        result = work[1 - here][: q * k * size].reshape(q * k, N, N)
        for i in range(q * k):
            phase, a = i // k, i % k
            begin, end = first[phase] * k + a, second[phase] * k + a
            multiply(P, begin, end, result, i)
            if schedule.watched[level]:
                loss = cancellation(P[end], P[begin], result[i])
                # a sample that is not on a grid serves all amplitudes
                a, stop = (i % losses.size, i % losses.size + 1) if schedule.grid[level] else (0, losses.size)
                for c in range(a, stop):
                    losses[c] = max(losses[c], loss)
        here = 1 - here
        scale.exponents[:] *= 2.0
        rescale(result, scale, schedule.grid[level])
    count = phases[-1] * amplitudes[-1]
    return work[here][: count * size].reshape(count, N, N)


@njit(cache=True, nogil=True)
def rescale(P: FloatArray, scale: Scale, grid: bool) -> None:
    """Take powers of two out of P (s, N, N) where it is far from one, and add them to the exponents.

    On a ``grid`` the amplitudes follow each other at every phase, and each has its own power. Else there is one power
    for all.
    """
    amplitudes = scale.exponents.size if grid else 1
    parts = P.reshape(P.shape[0] // amplitudes, amplitudes, P.size // P.shape[0])
    for a in range(amplitudes):
        square = 0.0
        if amplitudes == 1:
            square = np.dot(P.reshape(P.size), P.reshape(P.size))
        else:
            for i in range(parts.shape[0]):
                square += np.dot(parts[i, a], parts[i, a])
        if square > RESCALING_NORM**2 or 0.0 < square < RESCALING_NORM**-2:
            exponent = np.floor(0.5 * np.log2(square))
            parts[:, a] *= 2.0**-exponent
            if grid:
                scale.exponents[a] += exponent
            else:
                scale.exponents[:] += exponent


@njit(cache=True, nogil=True)
def cancellation(A: FloatArray, B: FloatArray, AB: FloatArray) -> float:
    """Return |A| |B| / (|A B| sqrt(N)) in the Frobenius norm, all (N, N); it is 1 for rotations."""
    N = A.shape[0]
    a, b, ab = A.reshape(N * N), B.reshape(N * N), AB.reshape(N * N)
    return np.sqrt(np.dot(a, a) * np.dot(b, b) / (N * max(np.dot(ab, ab), RESCALING_NORM**-2)))
