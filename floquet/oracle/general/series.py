"""Kernel for any linear system, E(t) y' = A(t) y: the Taylor series of the solution over one step.

    E(t) = I + sum_r f_r(t) E_r,      A(t) = A_0 + sum_r f_r(t) A_r

As in `floquet.oracle.taylor`, the coefficients of the solution follow from one another by Cauchy products; those of
E(t) y' are moved to the right-hand side but for the leading one. The series converges up to the nearest time, real or
complex, at which E(t) is singular. Source: Jorba and Zou, as there.
"""

from __future__ import annotations

import numpy as np
from numba import njit


@njit(cache=True, nogil=True)
def series_step(S, mass, f, tolerance, start):  # type: ignore[no-untyped-def]
    """Advance ``start`` (N, columns) by one step.

    Parameters
    ----------
    S : ndarray, shape (N, N + R N) or, with ``mass``, (N, N + 2 R N)
        h E^-1 A_0, then h E^-1 A_r side by side, then - E^-1 E_r, with E at the beginning of the step.
    mass : bool
        Whether E depends on time.
    f : ndarray, shape (R, order)
        Taylor coefficients h^i f_r^(i) / i! at the beginning of the step, in reversed order.
    tolerance : float
        The series ends when two successive terms are below it, relative to ``start``, or at ``order``.

    Returns
    -------
    values : ndarray, shape (N, columns)
    relative : float
        Size of the last term, relative to ``start``.
    size : float
        Root of the sum of squares of all terms: the rounding of their sum is in proportion to it.
    """
    N, columns = start.shape
    R, order = f.shape
    count = S.shape[1] // N
    history = np.zeros((order + 1, N * columns))
    slopes = np.zeros((order + 1 if mass else 1, N * columns))
    stacked = np.zeros((count, N * columns))
    term = np.empty((N, columns))
    values = start.copy().ravel()
    history[0] = values
    size = np.dot(values, values)
    squares = size
    previous = relative = np.inf
    for q in range(order):
        stacked[0] = history[q]
        for r in range(R):
            # Cauchy products: Taylor coefficient q of f_r y, and of f_r y' without its leading part
            np.dot(f[r, order - 1 - q :], history[: q + 1], stacked[1 + r])
            if mass and q > 0:
                np.dot(f[r, order - 1 - q : order - 1], slopes[1 : q + 1], stacked[1 + R + r])
        np.dot(S, stacked.reshape(count * N, columns), term)
        flat = term.ravel()
        if mass:
            slopes[q + 1] = flat
        history[q + 1] = flat / (q + 1)
        following = history[q + 1]
        values += following
        square = np.dot(following, following)
        squares += square
        relative = np.sqrt(square / size)
        if not relative < np.inf:
            break
        if relative <= tolerance and previous <= tolerance:
            break
        previous = relative
    return values.reshape(N, columns), max(relative, previous), np.sqrt(squares)
