"""Which products of steps to sample for a column of a chart, and how the others follow from the samples.

The product P of some steps is an entire function of the amplitude eps and of the phase theta at which it begins. While
the steps span little of the period, P is nearly constant, and a grid determines it: a few equispaced phases and a few
Chebyshev points in eps.

With a single harmonic fewer samples are enough. The part of P of order eps^a then has only the waves exp(i q theta)
with q = a, a - 2, ..., -a. So P is a function of eps cos theta and eps sin theta, with coefficients that fall like
those of an exponential: where a grid takes 45 samples, 15 determine P. They are found by interpolative decomposition
(H. Cheng, Z. Gimbutas, P.-G. Martinsson and V. Rokhlin, SIAM J. Sci. Comput. 26 (2005) 1389-1404). Take some functions
that are as general as P may be, at all points where values of P are needed. A QR factorisation with column pivoting
then chooses the points from which the values at all others follow. The weights stay of order one, so that rounding
errors do not grow from doubling to doubling. With several harmonics the gain is small, and the choice takes long: there
a grid is used. With other powers of eps than the first, P is such a function if eps^p comes with the harmonics p,
p - 2, ... alone, as for a speed that pulsates: then P is graded.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
import scipy.linalg as sla
from numpy.typing import NDArray

from floquet.engine.doubling.interpolation import (
    chebyshev_points,
    chebyshev_weights,
    degree,
    exact_for_constants,
    trigonometric_weights,
)
from floquet.engine.doubling.memo import memoized
from periodic.checks import ComplexArray, FloatArray

# Error of interpolation on a grid, relative to the norm, if the bound on growth were attained. It never is: measured
# errors are a few 1e-13 of the norm, which is rounding.
INTERPOLATION_TOLERANCE = 1e-10
# Error of interpolation between chosen samples, relative to the largest value: this part of the tolerance, but at least
# this much. These functions do attain the bound, and an error in one of B parts of a period counts B times.
CHOSEN_TOLERANCE_PART, MIN_CHOSEN_TOLERANCE = 1e-4, 1e-14
# Largest growth, as a logarithm, within the products that are interpolated between phases. Samples may then differ in
# size by the exponential of twice this; with more, the small ones would be lost to the rounding of the large ones.
MAX_PHASE_GROWTH = 3.0
# Largest number of factors in a period whose products are examined for cancellation; shorter ones have little of it.
MAX_WATCHED_FACTORS = 8
# Largest number of points among which samples are chosen; with more of them a grid is used.
MAX_WANTED_POINTS = 512
# Number of functions to begin to choose samples by, and how many functions there must be for each sample.
MIN_TRIAL_FUNCTIONS, TRIAL_FUNCTION_SURPLUS = 64, 1.5
# Largest number of samples at a time for which all steps of a period may be taken.
MAX_WHOLE_SAMPLES = 2**15
# Multiplications that take as long as the call of a product, as the rest of a step, and as a weight.
CALL_COST, STEP_COST, WEIGHT_COST = 200, 400, 20
# Parts of the whole growth to which the shares of the harmonics are rounded up, so that columns share their schedules.
GROWTH_SHARES = 256
# Distance of a phase from a sampled one, in units of their spacing, that is rounding.
PHASE_ROUNDING = 1e-9


class Schedule(NamedTuple):
    """Samples and weights of all doublings, in their order.

    Products are stored phase by phase, with all amplitudes of a phase together. Samples that are not on a grid count as
    phases with one amplitude each.

    Attributes
    ----------
    theta, eps : ndarray, shape (phases[0] amplitudes[0],)
        Phases and amplitudes of the single steps to begin with; the largest amplitude is 1.
    phases, amplitudes : int ndarray, shape (levels + 1,)
        Number of phases and amplitudes at which products are sampled, before the first doubling and after each.
    needed_amplitudes, added_phases : int ndarray, shape (levels,)
        Number of amplitudes for which each doubling is done, and number of phases that it needs besides the sampled
        ones; both are interpolated.
    weights : ndarray
        For each doubling the matrix (needed_amplitudes, amplitudes) that interpolates in eps, if the two differ, and
        the matrix (added_phases, phases) that interpolates in theta, one after the other.
    pairs : int ndarray
        For each doubling the first and then the second factors, as places among the sampled phases followed by the
        added ones.
    grid : bool ndarray, shape (levels,)
        Whether the products after the doubling are on a grid.
    watched : bool ndarray, shape (levels,)
        Whether to examine the doubling for cancellation.
    max_matrices : int
        Largest number of matrices in one array.
    """

    theta: FloatArray
    eps: FloatArray
    phases: NDArray[np.int64]
    amplitudes: NDArray[np.int64]
    needed_amplitudes: NDArray[np.int64]
    added_phases: NDArray[np.int64]
    weights: FloatArray
    pairs: NDArray[np.int64]
    grid: NDArray[np.bool_]
    watched: NDArray[np.bool_]
    max_matrices: int

    @property
    def sizes(self) -> NDArray[np.int64]:
        """Number of products that are sampled before the first doubling and after each, (levels + 1,)."""
        return self.phases * self.amplitudes


class _Doubling(NamedTuple):
    """One doubling of a `Schedule`, and the samples before it."""

    theta: FloatArray
    eps: FloatArray
    phases: int
    amplitudes: int
    needed_amplitudes: int
    across_amplitudes: FloatArray
    across_phases: FloatArray
    pairs: NDArray[np.int64]
    watched: bool

    @property
    def matrices(self) -> int:
        """Number of matrices in use during the doubling."""
        return (self.phases + len(self.across_phases)) * self.needed_amplitudes


def quantised(x: float) -> float:
    """Return ``x`` rounded up to a power of 2^(1/4), so that neighbouring columns share their schedule."""
    return 2.0 ** (math.ceil(4 * math.log2(x)) / 4) if x > 0 else 0.0


def growth_bounds(strength: tuple[float, ...], size: float) -> tuple[float, ...]:
    """Return bounds, rounded up, on the logarithm of the growth that each harmonic brings about in one period.

    ``strength`` are the rates of growth for eps = 1, and ``size`` is the product of period and largest amplitude.
    """
    total = sum(strength)
    whole = quantised(total * size)
    if whole == 0.0:
        return (0.0,) * len(strength)
    return tuple(whole * math.ceil(GROWTH_SHARES * rate / total) / GROWTH_SHARES for rate in strength)


@lru_cache(maxsize=1024)
def phase_count(B: int, x: tuple[float, ...], tolerance: float) -> int:
    """Return the number of equispaced phases that determine the products over a B-th part of a period.

    It is B, all of them, where the products grow too much to be interpolated. ``x`` is that of `growth_bounds`.
    """
    part = tuple(each / B for each in x)
    return B if sum(part) > MAX_PHASE_GROWTH else min(B, 2 * degree(part, tolerance) + 1)


@memoized
def schedule(
    x: tuple[float, ...],
    across: tuple[float, ...],
    amplitudes: bytes,
    phases: int,
    B: int,
    levels: int,
    tolerance: float,
    graded: bool = False,
    states: int = 0,
) -> Schedule:
    """Plan the last ``levels`` doublings, from the last one back.

    They are to end with the products over a B-th part of a period that begin at so many equispaced ``phases``.
    ``amplitudes`` (an array of floats as bytes) are relative to the largest. If ``across`` is not zero, they are the
    Chebyshev points of their range, and ``across`` is the growth in one period between the middle and the ends of the
    range, one number for each power of eps. If it is zero, all doublings are done for these amplitudes. ``x`` is that
    of `growth_bounds`. ``graded`` says that the power eps^a has the harmonics a, a - 2, ... alone. With several
    harmonics the number of ``states`` tells what is cheaper: to interpolate between phases, or to take all of them.
    """
    eps, theta = np.frombuffer(amplitudes), 2 * np.pi * np.arange(phases) / phases
    end, plans, grid = (phases, len(eps)), [], [True]
    theta, eps, points = np.repeat(theta, len(eps)), np.tile(eps, phases), eps
    several = (np.count_nonzero(x) > 1 or len(across) > 1) and not graded
    whole = several and states > 0 and phases == B
    whole = whole and _whole_is_cheaper(x, across, len(eps), B, levels, tolerance, states)
    for _ in range(levels):
        B *= 2
        if grid[-1] and (sum(x) / B > MAX_PHASE_GROWTH or several or 2 * len(theta) > MAX_WANTED_POINTS):
            plan = _grid(phases, points, x, across, B, tolerance, whole=whole)
            phases, points = plan.phases, plan.eps[: plan.amplitudes]
            grid.append(True)
        else:
            plan = _scattered(theta, eps, np.array(x) / B, B, tolerance, graded)
            grid.append(False)
        theta, eps = plan.theta, plan.eps
        plans.append(plan)
    plans.reverse()
    weights = [part.ravel() for plan in plans for part in (plan.across_amplitudes, plan.across_phases)]
    return Schedule(
        theta,
        eps,
        np.array([*(plan.phases for plan in plans), end[0]]),
        np.array([*(plan.amplitudes for plan in plans), end[1]]),
        np.array([plan.needed_amplitudes for plan in plans], np.int64),
        np.array([len(plan.across_phases) for plan in plans], np.int64),
        np.concatenate([np.empty(0), *weights]),
        np.concatenate([np.empty(0, np.int64), *(plan.pairs for plan in plans)]),
        np.array(grid[:-1][::-1], bool),
        np.array([plan.watched for plan in plans], bool),
        max([end[0] * end[1], *(len(plan.eps) for plan in plans), *(plan.matrices for plan in plans)]),
    )


def _amplitude_count(k: int, across: tuple[float, ...], B: int, tolerance: float) -> int:
    """Return how many of ``k`` amplitudes determine the products over a B-th part of a period."""
    return min(degree(tuple(each / B for each in across), tolerance) + 1, k) if any(across) else k


def _whole_is_cheaper(
    x: tuple[float, ...],
    across: tuple[float, ...],
    amplitudes: int,
    B: int,
    levels: int,
    tolerance: float,
    states: int,
) -> bool:
    """Return whether all steps of a period and all of their products cost less than interpolation between phases.

    Many harmonics need many phases, and interpolation between p phases costs their square: with a few states that is
    more than all products from the single steps on. What is counted are multiplications.
    """
    product, step = states**3 + CALL_COST, states**3 + STEP_COST
    whole = interpolated = 0.0
    phases, k = B, amplitudes
    for _ in range(levels):
        B *= 2
        p, m = phase_count(B, x, tolerance), _amplitude_count(k, across, B, tolerance)
        whole += B / 2 * k * product
        if B * k > MAX_WHOLE_SAMPLES:
            return False
        interpolated += phases * k * product
        if p < B:
            interpolated += 2 * phases * p * (k * states**2 + WEIGHT_COST)
        phases, k = p, m
    return whole + B * k * step < interpolated + phases * k * step


def _grid(
    phases: int,
    points: FloatArray,
    x: tuple[float, ...],
    across: tuple[float, ...],
    B: int,
    tolerance: float,
    *,
    whole: bool,
) -> _Doubling:
    """Return the doubling that ends with the amplitudes ``points`` at ``phases`` and begins with a grid.

    ``whole``: with as many phases as there are parts of the period, so that none is interpolated.
    """
    k, needed = len(points), phase_count(B, x, tolerance)
    p, m, across_amplitudes = (
        B if whole else needed,
        _amplitude_count(len(points), across, B, tolerance),
        np.empty((0, 0)),
    )
    if m != k:
        relative = chebyshev_points(k)
        across_amplitudes = exact_for_constants(chebyshev_weights(m, relative))
        radius = (points[0] - points[-1]) / (relative[0] - relative[-1])
        points = (points[0] + points[-1]) / 2 + radius * chebyshev_points(m)
    first = 2 * np.pi * np.arange(phases) / phases
    wanted = np.concatenate([first, first + 2 * np.pi / B]) * (p / (2 * np.pi))
    sampled = np.abs(wanted - np.rint(wanted)) < PHASE_ROUNDING
    pairs = np.where(sampled, np.rint(wanted).astype(int), p + np.cumsum(~sampled) - 1)
    added = wanted[~sampled] * (2 * np.pi / p)
    across_phases = exact_for_constants(trigonometric_weights(p, added)) if p != B else np.empty((0, p))
    theta = np.repeat(2 * np.pi * np.arange(p) / p, m)
    return _Doubling(theta, np.tile(points, p), p, m, k, across_amplitudes, across_phases, pairs, watched=needed == B)


def _scattered(theta: FloatArray, eps: FloatArray, x: FloatArray, B: int, tolerance: float, graded: bool) -> _Doubling:
    """Return the doubling that ends with products at the points (theta, eps) and begins with the fewest samples."""
    theta, eps = np.concatenate([theta, theta + 2 * np.pi / B]), np.tile(eps, 2)
    order, weights = _skeleton(theta, eps, x, max(CHOSEN_TOLERANCE_PART * tolerance, MIN_CHOSEN_TOLERANCE), graded)
    chosen = order[: weights.shape[1]]
    return _Doubling(
        theta[chosen],
        eps[chosen],
        phases=len(chosen),
        amplitudes=1,
        needed_amplitudes=1,
        across_amplitudes=np.empty((0, 0)),
        across_phases=weights,
        pairs=np.argsort(order),
        watched=B <= MAX_WATCHED_FACTORS,
    )


def _skeleton(
    theta: FloatArray, eps: FloatArray, x: FloatArray, error: float, graded: bool
) -> tuple[NDArray[Any], FloatArray]:
    """Return an order of the points (theta, eps), with those to be sampled first, and weights (others, sampled).

    The weights give the values at the other points, up to ``error`` relative to the largest value.
    """
    count = min(MIN_TRIAL_FUNCTIONS, 2 * len(theta) + 8)
    while True:
        values = _functions(theta, eps, x, count // 2, graded)
        R, order = sla.qr(values.T, mode="r", pivoting=True, check_finite=False)
        sizes = np.abs(np.diag(R))
        k = max(int((sizes > error * sizes[0]).sum()), 1)
        if count >= TRIAL_FUNCTION_SURPLUS * k or count >= TRIAL_FUNCTION_SURPLUS * len(theta):
            break
        count *= 2
    return order, exact_for_constants(sla.solve_triangular(R[:k, :k], R[:k, k:], check_finite=False).T)


def _functions(theta: FloatArray, eps: FloatArray, x: FloatArray, count: int, graded: bool) -> FloatArray:
    """Return functions with coefficients as large as those of P can be, at the points (theta, eps): (points, 2 count).

    They are the real and imaginary parts of exp(eps sum_j (x_j / 2) [u_j exp(i j theta) + v_j exp(-i j theta)]) for
    random u and v on the unit circle. If they are ``graded``, eps^j stands at x_j, and the harmonics j - 2, j - 4, ...
    come with it.
    """
    if graded:
        pairs = [(power, q) for power in range(1, len(x) + 1) for q in range(power, -1, -2)]
        u, v = _unit_circle(count, len(pairs))
        powers, harmonics = np.array(pairs).T
        waves = np.exp(1j * np.outer(theta, harmonics)) * (x[powers - 1] / 2) * eps[:, None] ** powers
        values = np.exp(waves @ u + waves.conj() @ v)
        return np.hstack([values.real, values.imag])
    u, v = _unit_circle(count, len(x))
    waves = np.exp(1j * np.outer(theta, np.arange(1, len(x) + 1))) * (x / 2)
    values = np.exp(eps[:, None] * (waves @ u + waves.conj() @ v))
    return np.hstack([values.real, values.imag])


@lru_cache(maxsize=16)
def _unit_circle(count: int, harmonics: int) -> ComplexArray:
    """Return random numbers on the unit circle, the same at every call, (2, harmonics, count)."""
    return np.exp(2j * np.pi * np.random.default_rng(0).random((2, harmonics, count)))
