"""One subsystem over one period: its monodromy matrix, what has become of given initial values, and the errors."""

from __future__ import annotations

from itertools import accumulate, pairwise
from typing import NamedTuple

import numpy as np
import scipy.linalg as sla

from floquet.oracle.reduction import Subsystem
from floquet.oracle.taylor import MACHINE_EPSILON, MAX_SOLUTION, OVERFLOWN, integrate
from periodic.checks import FloatArray

# Wanted error of the matrix, relative to max(1, its norm), where the caller asks for nothing else.
MATRIX_TOLERANCE = 1e-11
# Length of a step times the rate of the fastest motion. Longer steps need fewer terms in all (8.0 per radian at 4,
# 6.4 at 6, 5.6 at 8), but cancellation between terms as large as exp(6) costs digits.
RADIANS_PER_STEP = 6.0
# Terms of the series that a step of this length needs, about; and a number that is never reached, unless the rate were
# wrong.
TERMS_PER_STEP, MAX_TAYLOR_TERMS = 40, 80
# The step is halved at most so many times, while that helps.
MAX_STEP_HALVINGS = 3
# Growth is measured at the ends of so many segments of a period, and within each of them to this relative error.
SEGMENTS_PER_PERIOD, SEGMENT_TOLERANCE = 32, 1e-2
# So many solutions are integrated again with half the step and with series as long as float64 can use: the relative
# size of the last term.
PROBE_SOLUTIONS, FINEST_SERIES_TOLERANCE = 8, MACHINE_EPSILON / 16
# What a term costs, in seconds: a call, and each of the 2 floating-point operations an entry at a moderate speed. An
# integration longer than the last number is refused.
SECONDS_PER_TERM, SECONDS_PER_FLOP, MAX_SECONDS = 2e-6, 1e-10, 300.0
# Part of the wanted error that ending the series may use up; the rest is left to rounding.
TRUNCATION_SHARE = 0.1
# A shorter step has helped if it leaves less than this part of the error.
WORTHWHILE_REDUCTION = 0.5


class PeriodMap(NamedTuple):
    """Monodromy matrix of one subsystem, with its error.

    Attributes
    ----------
    matrix : ndarray, shape (2m, 2m)
        In energy coordinates, y = (y1, y2).
    error : float
        Estimated Frobenius norm of the error of ``matrix``.
    error_in_q : float
        The same for the matrix in (W', W).
    """

    matrix: FloatArray
    error: float
    error_in_q: float


def period_map(
    subsystem: Subsystem, Omega: float, eps: float, tolerance: float, halvings: int = MAX_STEP_HALVINGS
) -> PeriodMap:
    """Integrate one subsystem over one period and estimate the error.

    The step is halved as long as that helps, ``halvings`` times at most; never for 0, so that the matrix and its error
    are those of `propagate` with `steps_of_period`.

    Raises
    ------
    ValueError
        If the solution overflows or the integration would take too long; the message names ``Omega`` and ``eps``.
    """
    m = len(subsystem.equations.w)
    start, share = probe_solutions(m)
    # norms of the two halves of from_q: how much of a disturbance of q each half of y receives
    receives = np.linalg.norm(np.stack(np.split(subsystem.from_q, 2)), 2, axis=(1, 2))
    steps = steps_of_period(subsystem, Omega)
    best = PeriodMap(np.eye(2 * m), np.inf, np.inf)
    for _ in range(halvings + 1):
        period = _integrate_period(subsystem, Omega, eps, steps, tolerance)
        defect = period.matrix @ start - propagate(subsystem, Omega, eps, 2 * steps, FINEST_SERIES_TOLERANCE, start)
        halves = np.stack(np.split(defect, 2, axis=1)) / np.sqrt(share)
        reducible = float(np.linalg.norm(halves)) + _at_the_end(period, period.rounding)
        # shorter steps do not help against rounding of the coefficients and what the reduction dropped
        fixed = (MACHINE_EPSILON * subsystem.rate + subsystem.neglected) * period.durations
        error = reducible + _at_the_end(period, fixed)
        in_q = np.linalg.norm(subsystem.to_q @ halves, axis=(1, 2)) @ receives
        in_q += _at_the_end(period, period.rounding + fixed, subsystem.to_q, subsystem.from_q)
        if error > WORTHWHILE_REDUCTION * best.error:  # rounding is what is left
            break
        best = PeriodMap(period.matrix, float(error), float(in_q))
        if reducible <= max(tolerance * max(1.0, float(np.linalg.norm(period.matrix, 2))), error - reducible):
            break
        steps *= 2
    return best


class _Period(NamedTuple):
    """One period in S segments.

    Attributes
    ----------
    matrix : ndarray, shape (2m, 2m)
        From 0 to T.
    before : ndarray, shape (S, 2m, 2m)
        From 0 to the beginning of each segment.
    after : ndarray, shape (S, 2m, 2m)
        From the end of each segment to T, good to a few per cent.
    rounding : ndarray, shape (S,)
        Rounding errors made in each segment, relative to its initial values, times the growth within it.
    durations : ndarray, shape (S,)
        Length of each segment in time, times the growth within it.
    """

    matrix: FloatArray
    before: FloatArray
    after: FloatArray
    rounding: FloatArray
    durations: FloatArray


def _integrate_period(subsystem: Subsystem, Omega: float, eps: float, steps: int, tolerance: float) -> _Period:
    unit = np.eye(2 * len(subsystem.equations.w))
    ends = np.unique(np.linspace(0, steps, SEGMENTS_PER_PERIOD + 1).astype(int)).tolist()
    values, rounding, maps = [unit], [], []
    for segment in pairwise(ends):
        found, error = integrate_steps(subsystem, Omega, eps, steps, tolerance, values[-1], *segment)
        rounding.append(error / np.linalg.norm(values[-1]))
        values.append(found)
        maps.append(integrate_steps(subsystem, Omega, eps, steps, SEGMENT_TOLERANCE, unit, *segment)[0])
    after = list(accumulate(maps[::-1], np.matmul, initial=unit))
    if not np.abs(after).max() <= MAX_SOLUTION:
        raise overflow(Omega, eps)
    growth = np.maximum(1.0, np.linalg.norm(maps, 2, axis=(1, 2)))
    durations = 2 * np.pi / Omega * np.diff(ends) / steps
    return _Period(values[-1], np.array(values[:-1]), np.array(after[-2::-1]), growth * rounding, growth * durations)


def _at_the_end(
    period: _Period, errors: FloatArray, to: FloatArray | None = None, start: FloatArray | None = None
) -> float:
    """Return what relative errors (S,) made in the segments amount to at the end, as a bound of the Frobenius norm.

    A relative error E made at time t arrives as Phi(T, t) E Phi(t, 0). If growth in one part of a period is undone in
    another, the product of the two norms exceeds that of Phi(T, 0) by orders of magnitude. The difference of two
    integrations would show that only by chance.
    """
    after = period.after if to is None else to @ period.after
    before = period.before if start is None else period.before @ start
    return float(np.sum(np.linalg.norm(after, 2, axis=(1, 2)) * errors * np.linalg.norm(before, axis=(1, 2))))


def steps_of_period(subsystem: Subsystem, Omega: float) -> int:
    """Return the number of equal steps of one period, before any halving.

    Raises
    ------
    ValueError
        If they would take too long.
    """
    m, harmonics = len(subsystem.equations.w), subsystem.equations.alpha.shape[1] - 1
    steps = np.ceil(2 * np.pi * (subsystem.rate / Omega + harmonics) / RADIANS_PER_STEP)
    seconds = steps * TERMS_PER_STEP * (SECONDS_PER_TERM + 4 * m * subsystem.equations.S.size * SECONDS_PER_FLOP)
    if not seconds <= MAX_SECONDS:
        raise ValueError(
            f"Omega = {Omega!r} means {steps:.2g} steps in one period, about {seconds:.2g} s; "
            "give a larger Omega or a smaller eps"
        )
    return int(steps)


def probe_solutions(m: int) -> tuple[FloatArray, int]:
    """Return initial values (2m, columns), half of them in y1 and half in y2, and the number of columns in each half.

    The squared norm of a matrix times a normally distributed vector is on average the matrix's squared Frobenius norm.
    The seed is fixed, so a point has the same error estimate in every run.
    """
    if 2 * m <= PROBE_SOLUTIONS:
        return np.eye(2 * m), 1
    share = PROBE_SOLUTIONS // 2
    values = np.random.default_rng(0).standard_normal((2, m, share))
    return np.asarray(sla.block_diag(*values)), share


def propagate(
    subsystem: Subsystem, Omega: float, eps: float, steps: int, tolerance: float, start: FloatArray
) -> FloatArray:
    """Return the values after one period of the solutions that begin with the columns of ``start`` (2m, columns)."""
    return integrate_steps(subsystem, Omega, eps, steps, tolerance, start, 0, steps)[0]


def integrate_steps(
    subsystem: Subsystem,
    Omega: float,
    eps: float,
    steps: int,
    tolerance: float,
    start: FloatArray,
    first: int,
    last: int,
) -> tuple[FloatArray, float]:
    """Return what the values ``start`` at step ``first`` have become at step ``last``, and the rounding errors made."""
    m = len(subsystem.equations.w)
    y1, y2 = start[:m].copy(), start[m:].copy()
    local = max(TRUNCATION_SHARE * tolerance / steps, FINEST_SERIES_TOLERANCE)
    status, rounding = integrate(subsystem.equations, Omega, steps, first, last, MAX_TAYLOR_TERMS, local, y1, y2)
    if status == OVERFLOWN:
        raise overflow(Omega, eps)
    return np.concatenate([y1, y2]), rounding


def overflow(Omega: float, eps: float) -> ValueError:
    """Return the refusal of a solution that leaves the range of floats."""
    return ValueError(
        f"eps = {eps!r} at Omega = {Omega!r}: the solution grows by more than {MAX_SOLUTION:.0e} in one period; "
        "give a smaller eps or a larger Omega"
    )
