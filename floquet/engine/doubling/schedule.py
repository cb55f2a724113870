"""Where to sample the products of steps that a column of a chart is made of, and how to get from samples to the rest.

The product P of some steps is an entire function of the amplitude eps and the phase theta at which it begins. It is
nearly constant while the steps span little of the period, so that a few equispaced phases and a few Chebyshev points
in eps determine it: a grid.

Where a single harmonic excites the system still fewer do. The part of P of order eps^a then has the waves exp(i q
theta) with q = a, a - 2, ..., -a alone: P is a function of eps cos theta and eps sin theta, with coefficients that fall
like those of an exponential, and 15 samples, say, determine what takes 45 on a grid. Which ones is found by
interpolative decomposition (H. Cheng, Z. Gimbutas, P.-G. Martinsson and V. Rokhlin, SIAM J. Sci. Comput. 26 (2005)
1389-1404): where values are wanted, take those of some functions that are as general as P may be, and let a QR
factorisation with column pivoting choose the points from which the others follow. The weights stay of order one, and
rounding errors do not grow by them from doubling to doubling. With several harmonics the gain is small, and the choice
takes long.
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
from floquet.engine.doubling.memo import kept
from periodic.checks import ComplexArray, FloatArray

# Error of interpolation on a grid, if the bound on growth were attained. It never is: with this value the errors
# measured are a few 1e-13 of the norm, which is rounding.
TOLERANCE = 1e-10
# Error of interpolation between chosen samples, relative to the largest value, as part of the tolerance, and at least:
# these functions do attain the bound, and an error in one of B parts of a period counts B times.
CHOSEN, LEAST_CHOSEN = 1e-4, 1e-14
# Samples at different phases may differ in size by the exponential of twice this; interpolating between more than that
# would lose the small ones to the rounding of the large.
MOST_GROWTH = 3.0
# Cancellation is looked for between factors that are so many or fewer in a period; shorter ones have little of it.
FEW_FACTORS = 8
# Points, at most, among which samples are chosen; of more than that, and where there are several harmonics, a grid.
MOST_WANTED = 512
# Functions to choose samples by, at first, and how many more of them than samples there must be.
FUNCTIONS, SURPLUS = 64, 1.5
PARTS = 256  # of the whole growth, to which the shares of the harmonics are rounded up


class Schedule(NamedTuple):
    """Samples and weights of all doublings, the first one first.

    Products are kept phase by phase, all amplitudes of a phase together. Samples that are no grid count as phases with
    one amplitude each.

    Attributes
    ----------
    theta, eps : ndarray, shape (phases[0] nodes[0],)
        Phases and amplitudes of the single steps to begin with, the largest amplitude being 1.
    phases, nodes : int ndarray, shape (levels + 1,)
        At how many phases and amplitudes products are sampled before the first doubling and after each.
    groups, others : int ndarray, shape (levels,)
        How many amplitudes each doubling is done for, and how many other phases it needs, which are interpolated.
    weights : ndarray
        For each doubling the matrix (groups, nodes) that interpolates in eps, if they differ, and the one (others,
        phases) that interpolates in theta, one after the other.
    pairs : int ndarray
        For each doubling the first and then the second factors, as places among the phases that were sampled and,
        after them, the others.
    grid : bool ndarray, shape (levels,)
        Whether the products after the doubling are a grid.
    watched : bool ndarray, shape (levels,)
        Whether to look for cancellation.
    most : int
        The largest number of matrices in one array.
    """

    theta: FloatArray
    eps: FloatArray
    phases: NDArray[np.int64]
    nodes: NDArray[np.int64]
    groups: NDArray[np.int64]
    others: NDArray[np.int64]
    weights: FloatArray
    pairs: NDArray[np.int64]
    grid: NDArray[np.bool_]
    watched: NDArray[np.bool_]
    most: int

    @property
    def sizes(self) -> NDArray[np.int64]:
        """How many products are sampled before the first doubling and after each, (levels + 1,)."""
        return self.phases * self.nodes


class _Doubling(NamedTuple):
    """One doubling of a `Schedule`, and the samples that it begins with."""

    theta: FloatArray
    eps: FloatArray
    phases: int
    nodes: int
    groups: int
    to_groups: FloatArray
    to_others: FloatArray
    pairs: NDArray[np.int64]
    watched: bool

    @property
    def matrices(self) -> int:
        """How many are in use at a time."""
        return (self.phases + len(self.to_others)) * self.groups


def quantised(x: float) -> float:
    """Return the next fourth of a power of two above ``x``, so that neighbouring columns share their schedule."""
    return 2.0 ** (math.ceil(4 * math.log2(x)) / 4) if x > 0 else 0.0


def growth(strength: tuple[float, ...], size: float) -> tuple[float, ...]:
    """Return bounds, rounded up, on the logarithm of the growth that each harmonic brings about in one period, from its
    rate and the product of period and largest amplitude."""
    total = sum(strength)
    whole = quantised(total * size)
    return tuple(whole * math.ceil(PARTS * rate / total) / PARTS if whole > 0 else 0.0 for rate in strength)


@lru_cache(maxsize=1024)
def phase_count(B: int, x: tuple[float, ...], tolerance: float) -> int:
    """Return at how many equispaced phases the products that are one of B parts of a period are determined; all B
    where they grow too much to be interpolated. ``x`` as from `growth`."""
    part = tuple(each / B for each in x)
    return B if sum(part) > MOST_GROWTH else min(B, 2 * degree(part, tolerance) + 1)


@kept
def schedule(
    x: tuple[float, ...], across: float, amplitudes: bytes, phases: int, B: int, levels: int, tolerance: float
) -> Schedule:
    """Plan the last ``levels`` doublings, from the last one back.

    Wanted are the products over a B-th part of a period that begin at so many equispaced ``phases``, with amplitudes
    (an array of floats as bytes) relative to the largest. These are the Chebyshev points of their range, and ``across``
    is the growth in one period between its middle and its ends; or, if that is zero, they are given and stay. ``x`` as
    from `growth`.
    """
    eps, theta = np.frombuffer(amplitudes), 2 * np.pi * np.arange(phases) / phases
    end, steps, grid = (phases, len(eps)), [], [True]
    theta, eps, nodes = np.repeat(theta, len(eps)), np.tile(eps, phases), eps
    for _ in range(levels):
        B *= 2
        if grid[-1] and (sum(x) / B > MOST_GROWTH or np.count_nonzero(x) > 1 or 2 * len(theta) > MOST_WANTED):
            step = _grid(phases, nodes, x, across, B, tolerance)
            phases, nodes = step.phases, step.eps[: step.nodes]
            grid.append(True)
        else:
            step = _scattered(theta, eps, np.array(x) / B, B, tolerance)
            grid.append(False)
        theta, eps = step.theta, step.eps
        steps.append(step)
    steps.reverse()
    return Schedule(
        theta,
        eps,
        np.array([*(step.phases for step in steps), end[0]]),
        np.array([*(step.nodes for step in steps), end[1]]),
        np.array([step.groups for step in steps], np.int64),
        np.array([len(step.to_others) for step in steps], np.int64),
        np.concatenate([np.empty(0), *(part.ravel() for step in steps for part in (step.to_groups, step.to_others))]),
        np.concatenate([np.empty(0, np.int64), *(step.pairs for step in steps)]),
        np.array(grid[:-1][::-1], bool),
        np.array([step.watched for step in steps], bool),
        max([end[0] * end[1], *(len(step.eps) for step in steps), *(step.matrices for step in steps)]),
    )


def _grid(phases: int, nodes: FloatArray, x: tuple[float, ...], across: float, B: int, tolerance: float) -> _Doubling:
    """Return the doubling that ends with the amplitudes ``nodes`` at ``phases`` and begins with a grid."""
    k, p = len(nodes), phase_count(B, x, tolerance)
    m, to_groups = k, np.empty((0, 0))
    if across > 0:
        m = min(degree((across / B,), tolerance) + 1, k)
    if m != k:
        points = chebyshev_points(k)
        to_groups = exact_for_constants(chebyshev_weights(m, points))
        radius = (nodes[0] - nodes[-1]) / (points[0] - points[-1])
        nodes = (nodes[0] + nodes[-1]) / 2 + radius * chebyshev_points(m)
    first = 2 * np.pi * np.arange(phases) / phases
    wanted = np.concatenate([first, first + 2 * np.pi / B]) * (p / (2 * np.pi))
    known = np.abs(wanted - np.rint(wanted)) < 1e-9
    pairs = np.where(known, np.rint(wanted).astype(int), p + np.cumsum(~known) - 1)
    others = wanted[~known] * (2 * np.pi / p)
    to_others = exact_for_constants(trigonometric_weights(p, others)) if p != B else np.empty((0, p))
    theta = np.repeat(2 * np.pi * np.arange(p) / p, m)
    return _Doubling(theta, np.tile(nodes, p), p, m, k, to_groups, to_others, pairs, watched=p == B)


def _scattered(theta: FloatArray, eps: FloatArray, x: FloatArray, B: int, tolerance: float) -> _Doubling:
    """Return the doubling that ends with products at the points (theta, eps), and begins with the fewest samples."""
    theta, eps = np.concatenate([theta, theta + 2 * np.pi / B]), np.tile(eps, 2)
    order, weights = _skeleton(theta, eps, x, max(CHOSEN * tolerance, LEAST_CHOSEN))
    chosen = order[: weights.shape[1]]
    return _Doubling(
        theta[chosen],
        eps[chosen],
        phases=len(chosen),
        nodes=1,
        groups=1,
        to_groups=np.empty((0, 0)),
        to_others=weights,
        pairs=np.argsort(order),
        watched=B <= FEW_FACTORS,
    )


def _skeleton(theta: FloatArray, eps: FloatArray, x: FloatArray, error: float) -> tuple[NDArray[Any], FloatArray]:
    """Return an order of the points (theta, eps), first those to be sampled, and the weights (others, sampled) by which
    the others follow, relative to the largest value up to ``error``."""
    count = min(FUNCTIONS, 2 * len(theta) + 8)
    while True:
        values = _functions(theta, eps, x, count // 2)
        R, order = sla.qr(values.T, mode="r", pivoting=True, check_finite=False)
        sizes = np.abs(np.diag(R))
        k = max(int((sizes > error * sizes[0]).sum()), 1)
        if count >= SURPLUS * k or count >= SURPLUS * len(theta):
            break
        count *= 2
    return order, exact_for_constants(sla.solve_triangular(R[:k, :k], R[:k, k:], check_finite=False).T)


def _functions(theta: FloatArray, eps: FloatArray, x: FloatArray, count: int) -> FloatArray:
    """Return real and imaginary parts, (points, 2 count), of exp(eps sum_j (x_j / 2) [u_j exp(i j theta) + v_j exp(-i j
    theta)]) for random u and v on the unit circle: their coefficients are as large as those of P can be."""
    u, v = _unit_circle(count, len(x))
    waves = np.exp(1j * np.outer(theta, np.arange(1, len(x) + 1))) * (x / 2)
    values = np.exp(eps[:, None] * (waves @ u + waves.conj() @ v))
    return np.hstack([values.real, values.imag])


@lru_cache(maxsize=16)
def _unit_circle(count: int, harmonics: int) -> ComplexArray:
    """Return random numbers, always the same, (2, harmonics, count)."""
    return np.exp(2j * np.pi * np.random.default_rng(0).random((2, harmonics, count)))
