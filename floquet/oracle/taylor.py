"""Kernels of the single-point integrator: Taylor series of the solution, step after step.

The equations are those of one decoupled subsystem in energy coordinates (`floquet.oracle.reduction`),

    y1' = w y2,      y2' = -k y1 - D y2 - sum_r f_r(t) B_r y1,
    f_r(t) = sum_j alpha[r, j] cos(j Omega t) + beta[r, j] sin(j Omega t),    j = 0..J,

with w and k diagonal. The Taylor coefficients of a solution follow from one another by Cauchy products (Leibniz'
rule), so a step of any order costs one matrix product a term. The method needs no stage coefficients and has no order
barrier. It is unrelated to splitting and to doubling, as an oracle for the chart engine has to be.

Source: A. Jorba and M. Zou, "A software package for the numerical integration of ODEs by means of high-order Taylor
methods", Experimental Mathematics 14 (2005) 99-117.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

from periodic.checks import FloatArray

# Solutions are followed up to this size, in energy coordinates: the squares of larger ones, which norms need, would
# overflow.
MAX_SOLUTION = 1e150
# Taylor coefficients of f_r below this part of the largest do not change a float64 sum.
NEGLIGIBLE_FORCING = 1e-18
MACHINE_EPSILON = np.finfo(np.float64).eps

CONVERGED, UNCONVERGED, OVERFLOWN = 0, 1, 2


class Equations(NamedTuple):
    """Coefficients of the equations of motion of one subsystem of m coordinates.

    Attributes
    ----------
    w, k : ndarray, shape (m,)
        Per unit of time.
    S : ndarray, shape (m, R m) or (m, (R + 1) m)
        B_1 ... B_R side by side and, if ``damped``, D behind them; per unit of time.
    damped : bool
        Whether ``S`` holds D, the damping and gyroscopic matrix.
    alpha, beta : ndarray, shape (R, J + 1)
        Fourier coefficients of f_1 ... f_R, dimensionless.
    """

    w: FloatArray
    k: FloatArray
    S: FloatArray
    damped: bool
    alpha: FloatArray
    beta: FloatArray


@njit(cache=True, nogil=True)
def forcing_coefficients(alpha, beta, step, steps, order):  # type: ignore[no-untyped-def]
    """Taylor coefficients h^i f_r^(i) / i! at the beginning of a step, one of ``steps`` in a period, shape (R, order).

    They are in reversed order: the last column is f_r itself.
    """
    coefficients = np.zeros((alpha.shape[0], order))
    for j in range(alpha.shape[1]):
        # whole turns are taken off before they can cost digits
        phase = 2.0 * np.pi * ((j * step) % steps) / steps
        c, s = np.cos(phase), np.sin(phase)
        power = 1.0
        for i in range(order):
            for r in range(alpha.shape[0]):
                coefficients[r, order - 1 - i] += power * (alpha[r, j] * c + beta[r, j] * s)
            c, s = -s, c  # differentiation turns the phase by a quarter
            power *= 2.0 * np.pi * j / steps / (i + 1)
    return coefficients


@njit(cache=True, nogil=True)
def significant(coefficients):  # type: ignore[no-untyped-def]
    """Number of trailing columns (lowest derivatives) that matter in float64."""
    order = coefficients.shape[1]
    floor = NEGLIGIBLE_FORCING * np.abs(coefficients).max()
    for i in range(order):
        if np.abs(coefficients[:, i]).max() > floor:
            return order - i
    return 1


@njit(cache=True, nogil=True)
def taylor_step(equations, coefficients, h, tolerance, y1, y2, history, stacked):  # type: ignore[no-untyped-def]
    """Advance (y1, y2), each (m, columns), in place by h.

    The series ends when two successive terms are below ``tolerance`` relative to the initial values, or at the order
    that ``coefficients`` (R, order) and ``history`` (order + 1, m * columns) allow. ``history`` receives the terms of
    y1. ``stacked`` (R + 1, m * columns) is work space for what S multiplies; the current term of y2 comes last.

    Returns
    -------
    terms : int
    relative : float
        Size of the last term relative to the initial values.
    size : float
        Root of the sum of squares of all terms: the rounding of their sum is in proportion to it.
    """
    m, columns = y1.shape
    functions, order = coefficients.shape
    memory = significant(coefficients)
    sum1, sum2, term2 = y1.ravel(), y2.ravel(), stacked[functions]
    history[0] = sum1
    term2[:] = sum2
    multiplied = stacked.reshape((functions + 1) * m, columns)[: equations.S.shape[1]]
    force = np.empty((m, columns))
    size = np.dot(sum1, sum1) + np.dot(sum2, sum2)
    squares = size
    previous = relative = np.inf
    for q in range(order):
        present, following = history[q], history[q + 1]
        span = min(q + 1, memory)
        for r in range(functions):
            # Cauchy product: Taylor coefficient q of f_r y1
            np.dot(coefficients[r, order - span :], history[q + 1 - span : q + 1], stacked[r])
        np.dot(equations.S, multiplied, force)
        scale = h / (q + 1)
        for i in range(m):
            ahead, back, row = scale * equations.w[i], scale * equations.k[i], i * columns
            for c in range(columns):
                first = ahead * term2[row + c]
                second = -back * present[row + c] - scale * force[i, c]
                following[row + c] = first
                term2[row + c] = second
                sum1[row + c] += first
                sum2[row + c] += second
        square = np.dot(following, following) + np.dot(term2, term2)
        squares += square
        relative = np.sqrt(square / size)
        if relative <= tolerance and previous <= tolerance:
            return q + 1, relative, np.sqrt(squares)
        previous = relative
    return order, relative, np.sqrt(squares)


@njit(cache=True, nogil=True)
def integrate(equations, Omega, steps, first, last, order, tolerance, y1, y2):  # type: ignore[no-untyped-def]
    """Advance (y1, y2), each (m, columns), in place from step ``first`` to ``last`` of ``steps`` in a period.

    Returns
    -------
    status : int
        CONVERGED, UNCONVERGED (a series did not end below ``tolerance``) or OVERFLOWN.
    rounding : float
        Estimated Frobenius norm of the rounding errors made in these steps.
    """
    m, columns = y1.shape
    history = np.empty((order + 1, m * columns))
    stacked = np.empty((equations.alpha.shape[0] + 1, m * columns))
    h = 2.0 * np.pi / Omega / steps
    status, rounding = CONVERGED, 0.0
    for step in range(first, last):
        coefficients = forcing_coefficients(equations.alpha, equations.beta, step, steps, order)
        _, relative, terms = taylor_step(equations, coefficients, h, tolerance, y1, y2, history, stacked)
        rounding += MACHINE_EPSILON * terms
        if not relative <= tolerance:
            status = UNCONVERGED
        if not max(np.abs(y1).max(), np.abs(y2).max()) <= MAX_SOLUTION:
            return OVERFLOWN, rounding
    return status, rounding
