"""Exponentials of many small matrices, by few products."""

from __future__ import annotations

import numpy as np
from numba import njit

from floquet.engine.doubling import multiply
from periodic.checks import FloatArray

MAX_SERIES_NORM = 0.5  # of the matrix whose exponential is summed as a Taylor series
SERIES_TOLERANCE = 1e-18  # bound on the first term of the series that is left out
WORK_MATRICES = 5  # that `exponential_into` needs besides its result


@njit(cache=True, nogil=True)
def exponential_into(work, Q, i):  # type: ignore[no-untyped-def]
    """Write exp(work[0]) into Q[i]; ``work`` (5, N, N) is overwritten.

    The Taylor series is summed three terms at a time, with powers of the cube (M. S. Paterson and L. J. Stockmeyer,
    SIAM J. Comput. 2 (1973) 60-66), which takes a third of the products. A matrix that is large is halved before, and
    the result is squared as often.
    """
    N = work.shape[1]
    A, square = work[0], work[1]
    norm = 0.0
    for r in range(N):
        norm = max(norm, np.abs(A[r]).sum())
    squarings = 0
    while norm > MAX_SERIES_NORM:
        norm *= 0.5
        squarings += 1
    if squarings:
        A *= 0.5**squarings
    terms, bound = 0, 1.0
    while bound > SERIES_TOLERANCE:
        terms += 1
        bound *= norm / terms
    groups = terms // 3
    multiply(work, 0, 0, work, 1)
    if groups:
        multiply(work, 1, 0, work, 2)  # the cube
    here = 3
    factor = 1.0
    for k in range(1, 3 * groups + 1):
        factor /= k
    _add_terms(A, square, factor, 3 * groups, work[here], False)
    for group in range(groups - 1, -1, -1):
        for k in range(3 * group + 1, 3 * group + 4):
            factor *= k
        multiply(work, here, 2, work, 7 - here)
        here = 7 - here
        _add_terms(A, square, factor, 3 * group, work[here], True)
    for _ in range(squarings):
        multiply(work, here, here, work, 7 - here)
        here = 7 - here
    Q[i] = work[here]


@njit(cache=True, nogil=True)
def _add_terms(A: FloatArray, square: FloatArray, factor: float, k: int, out: FloatArray, add: bool) -> None:
    """Write, or add to ``out``, ``factor`` [I + A / (k + 1) + A^2 / ((k + 1) (k + 2))]."""
    N = A.shape[0]
    first = factor / (k + 1)
    second = first / (k + 2)
    for r in range(N):
        for c in range(N):
            value = first * A[r, c] + second * square[r, c]
            out[r, c] = out[r, c] + value if add else value
        out[r, r] += factor
