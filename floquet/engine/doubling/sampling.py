"""Monodromy matrices of one subsystem for a range of amplitudes, as samples to interpolate between.

Where one set of samples is not enough for the whole range, the range is cut into pieces.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numba import njit

from floquet.engine.coordinates import Equations, Subsystem, equations, least_frequency
from floquet.engine.doubling.doubling import Scale, cancellation, doublings, rescale, unit_scale
from floquet.engine.doubling.interpolation import chebyshev_points, chebyshev_weights, degree, trigonometric_weights
from floquet.engine.doubling.memo import memoized
from floquet.engine.doubling.schedule import (
    INTERPOLATION_TOLERANCE,
    MAX_PHASE_GROWTH,
    Schedule,
    growth_bounds,
    phase_count,
    quantised,
    schedule,
)
from floquet.engine.doubling.step import forcing_on_grid, grid_steps, single_steps
from floquet.engine.eigen import LANE_COUNT, broadcast, fma, load, pick_le, square_root, store
from periodic.checks import FloatArray

MAX_SAMPLE_ENTRIES = 2**23  # of one array of samples (64 MB); two such arrays are in use at a time
MAX_SAMPLE_MATRICES = 2**14  # of one array; others are interpolated between them, with a weight for each
# Ratio of the largest to the smallest sample of a piece: the smallest loses as many digits to rounding.
MAX_SAMPLE_CONTRAST = 30.0
# Logarithm of the growth by which the factors of one product may differ; the smallest must not underflow.
MAX_FACTOR_GROWTH = 100.0
MAX_DIRECT_AMPLITUDES = 8  # that are integrated themselves; interpolation would take as many samples
MAX_WHOLE_STATES = 16  # with which it may be cheaper to take all steps of a period than to interpolate between phases
PAIRWISE_FACTORS = 64  # of a long product that are multiplied pairwise; the rest is multiplied one after the other


class Piece(NamedTuple):
    """Monodromy matrices at the amplitudes eps[cells]: combinations of ``samples`` (m, N, N) at the given scale.

    ``weights`` (groups, m, 16) are those of sixteen cells at a time; the last cell is repeated to fill the last group.
    ``norms`` (k,) are the Frobenius norms of the matrices divided by sqrt(N), which makes 1 of a rotation.
    """

    cells: slice
    samples: FloatArray
    weights: FloatArray
    scale: Scale
    norms: FloatArray


class Workspace:
    """Arrays that are used again and again: fresh memory costs more than the arithmetic on it."""

    def __init__(self) -> None:
        self._buffers = [np.empty(0), np.empty(0)]

    def arrays(self, size: int) -> tuple[FloatArray, FloatArray]:
        """Return two arrays with at least ``size`` entries, of any content."""
        if self._buffers[0].size < size:
            self._buffers = [np.empty(size), np.empty(size)]
        return self._buffers[0], self._buffers[1]


class Sampler:
    """Samples the monodromy matrix of one subsystem at one frequency."""

    graded = False  # see `schedule`: with one harmonic and one power of eps it need not be said

    def __init__(self, subsystem: Subsystem, equations: Equations, Omega: float, work: Workspace) -> None:
        self.subsystem, self.equations, self.work = subsystem, equations, work
        self.size = len(equations.A)
        self.period = 2 * math.pi / Omega
        self.several = np.count_nonzero(equations.strength) > 1  # harmonics

    @classmethod
    def of(cls, subsystem: Subsystem, Omega: float, work: Workspace) -> Sampler:
        """Return the sampler of a subsystem in the coordinates that suit ``Omega``."""
        return cls(subsystem, equations(subsystem, least_frequency(Omega)), Omega, work)

    def pieces(self, eps: FloatArray, L: int, tolerance: float) -> Iterator[Piece]:
        """Yield pieces that together cover ``eps``, from 2^L steps a period.

        The arrays of a piece are overwritten when the next piece is asked for.
        """
        stack = [slice(0, len(eps))]
        while stack:
            cells = stack.pop()
            count = cells.stop - cells.start
            sample = self._interpolated if count > MAX_DIRECT_AMPLITUDES else self._direct
            piece = sample(eps[cells], L, tolerance)
            if piece is not None:
                yield piece._replace(cells=cells)
            else:
                middle = cells.start + count // 2
                stack += [slice(middle, cells.stop), slice(cells.start, middle)]

    def matrices(self, eps: FloatArray, L: int, tolerance: float) -> FloatArray:
        """Return the monodromy matrices at a few amplitudes, (k, N, N), whose growth is within the range of floats."""
        found = []
        for piece in self.pieces(eps, L, tolerance):
            weights = piece.weights.transpose(0, 2, 1).reshape(-1, len(piece.samples))[: piece.norms.size]
            found.append(np.tensordot(weights, piece.samples, 1) * np.exp2(piece.scale.exponents)[:, None, None])
        return np.concatenate(found)

    def plan(self, eps: FloatArray, L: int, tolerance: float) -> Interpolation | None:
        """Return how the monodromy matrices at ``eps`` are interpolated, from 2^L steps a period.

        None if that takes too many samples.
        """
        x, across = self.growth(largest_amplitude(eps)), self.growth_across(float(eps[0]), float(eps[-1]))
        most = MAX_SAMPLE_ENTRIES // self.size**2
        return _interpolation(x, across, eps.tobytes(), L, tolerance, most, self.graded, self._few_states)

    def growth(self, largest: float) -> tuple[float, ...]:
        """Return bounds on the logarithm of the growth in one period by each harmonic, at the amplitude ``largest``."""
        return growth_bounds(self.equations.strength, self.period * largest)

    def growth_across(self, low: float, high: float) -> tuple[float, ...]:
        """Return the growth in one period between the middle and the ends of some amplitudes, by powers of eps."""
        return (quantised(sum(self.equations.strength) * self.period * (high - low) / 2),)

    def _interpolated(self, eps: FloatArray, L: int, tolerance: float) -> Piece | None:
        """Return a piece with samples at Chebyshev points; None if they would be too many, or are too unequal."""
        plan = self.plan(eps, L, tolerance)
        if plan is None:
            return None
        scale = unit_scale(1)
        samples = self._sample(plan.schedule, largest_amplitude(eps), L, scale)
        norms, alike = combination_norms(samples, plan.weights)
        if not alike:
            return None
        scale = Scale(*(part.repeat(len(eps)) for part in scale))
        return Piece(slice(0), samples, plan.weights, scale, norms[: len(eps)])

    def _direct(self, eps: FloatArray, L: int, tolerance: float) -> Piece | None:
        """Return a piece with samples at the amplitudes themselves.

        None if there are several amplitudes, and their samples need too much memory.
        """
        largest = largest_amplitude(eps)
        x = self.growth(largest)
        stop, B, phases = 0, 2**L, phase_count(2**L, x, tolerance)
        while stop < L:
            fewer = phase_count(B // 2, x, tolerance)
            if not self._fits(fewer * len(eps), 2 * sum(x) / B):
                break
            stop, B, phases = stop + 1, B // 2, fewer
        if stop < L and len(eps) > 1:
            return None
        amplitudes, scale = eps / (largest or 1.0), unit_scale(len(eps))
        across = self.growth_across(largest, largest)  # none: all doublings are done for these amplitudes
        plan = schedule(x, across, amplitudes.tobytes(), phases, B, stop, tolerance, self.graded, self._few_states)
        P = self._sample(plan, largest, L, scale)
        if stop < L:
            P, scale = self._ordered_product(P, B, sum(x), scale)
        weights = in_lanes(np.eye(len(eps)))
        return Piece(slice(0), P, weights, scale, combination_norms(P, weights)[0][: len(eps)])

    @property
    def _few_states(self) -> int:
        """The number of states, if there are few; else 0. See `schedule`."""
        return self.size if self.size <= MAX_WHOLE_STATES else 0

    def _fits(self, matrices: int, growth: float) -> bool:
        """Return whether so many matrices fit into one array, and their growth into the range of floats."""
        entries = matrices * self.size**2
        return matrices <= MAX_SAMPLE_MATRICES and entries <= MAX_SAMPLE_ENTRIES // 2 and growth <= MAX_FACTOR_GROWTH

    def _sample(self, plan: Schedule, largest: float, L: int, scale: Scale) -> FloatArray:
        """Return the samples at the end of a schedule; ``largest`` is the largest amplitude."""
        work = self.work.arrays(plan.max_matrices * self.size**2)
        A, left, right, _ = self.equations
        h, Fc, Fs = self.period / 2**L, self.subsystem.Fc, self.subsystem.Fs
        if self.several:  # samples begin on a grid
            F = forcing_on_grid(Fc, Fs, int(plan.phases[0]))
            return _samples_on_grid(A, F, left, right, h, largest, plan, scale, work)
        return _samples(A, Fc, Fs, left, right, h, largest, plan, scale, work)

    def _ordered_product(self, P: FloatArray, B: int, growth: float, scale: Scale) -> tuple[FloatArray, Scale]:
        """Return the product of the B factors P(2 pi b / B), b = 0 ... B - 1, of one amplitude, some at a time.

        ``P`` (p, N, N) has the factors at p equispaced phases; the others are interpolated.
        """
        N, p, halvings = self.size, len(P), 0
        while 2**halvings < min(B, PAIRWISE_FACTORS):
            if not self._fits(2 ** (halvings + 1), 2 ** (halvings + 1) * growth / B):
                break
            halvings += 1
        count = 2**halvings
        # growth without bound: all of the factors are kept, and none is interpolated
        plan = schedule((np.inf,), (0.0,), np.ones(1).tobytes(), 1, 1, halvings, INTERPOLATION_TOLERANCE)
        work = Workspace().arrays(count * N * N)
        product, total = np.eye(N)[None], unit_scale(1)
        for start in range(0, B, count):
            factors = work[0][: count * N * N].reshape(count, N, N)
            phases = np.arange(start, start + count)
            if p < B:
                weights = trigonometric_weights(p, 2 * np.pi * phases / B)
                np.dot(weights, P.reshape(p, N * N), out=factors.reshape(count, N * N))
            else:
                factors[:] = P[phases]
            part = Scale(scale.exponents.copy(), scale.losses)
            part_product = doublings(N, plan, part, work)
            before, product = product, part_product @ product
            loss = cancellation(part_product[0], before[0], product[0])
            total.losses[0] = max(total.losses[0], part.losses[0], loss)
            total.exponents[:] += part.exponents
            rescale(product, total, grid=True)
        return product, total


class Interpolation(NamedTuple):
    """How the matrices of a piece follow from samples at Chebyshev points: by ``weights`` as in `Piece`."""

    schedule: Schedule
    weights: FloatArray


@memoized
def _interpolation(
    x: tuple[float, ...],
    across: tuple[float, ...],
    cells: bytes,
    L: int,
    tolerance: float,
    max_matrices: int,
    graded: bool,
    states: int,
) -> Interpolation | None:
    """Return the interpolation at the amplitudes ``cells`` (an array of floats as bytes).

    None if it takes as many samples as there are amplitudes, or more than ``max_matrices`` at a time. ``x`` is that of
    `growth_bounds`; ``across`` is the growth between the middle of the amplitudes and their ends, by powers of eps.
    """
    eps = np.frombuffer(cells)
    middle, radius = (eps[-1] + eps[0]) / 2, (eps[-1] - eps[0]) / 2
    count = degree(across, tolerance) + 1
    # the second bound holds at the level where phases are not interpolated any more
    if count >= len(eps) or count * sum(x) / MAX_PHASE_GROWTH > max_matrices:
        return None
    points = (middle + radius * chebyshev_points(count)) / largest_amplitude(eps)
    plan = schedule(x, across, points.tobytes(), 1, 1, L, tolerance, graded, states)
    if plan.max_matrices > max_matrices:
        return None
    return Interpolation(plan, in_lanes(chebyshev_weights(count, (eps - middle) / radius)))


def largest_amplitude(eps: FloatArray) -> float:
    """Return the largest modulus of increasing amplitudes."""
    return max(abs(float(eps[0])), abs(float(eps[-1])))


@njit(cache=True, nogil=True)
def _samples(
    A: FloatArray,
    Fc: FloatArray,
    Fs: FloatArray,
    left: FloatArray,
    right: FloatArray,
    h: float,
    largest: float,
    plan: Schedule,
    scale: Scale,
    work: tuple[FloatArray, FloatArray],
) -> FloatArray:
    """Return what `doublings` makes of `single_steps`, in one call: for small N a call takes as long as the work."""
    N, s = A.shape[0], plan.theta.size
    single_steps(A, Fc, Fs, left, right, h, plan.theta, largest * plan.eps, work[0][: s * N * N].reshape(s, N, N))
    return doublings(N, plan, scale, work)


@njit(cache=True, nogil=True)
def _samples_on_grid(A, F, left, right, h, largest, plan, scale, work):  # type: ignore[no-untyped-def]
    """Return what `doublings` makes of `grid_steps`."""
    N, m = A.shape[0], plan.amplitudes[0]
    P = work[0][: plan.theta.size * N * N].reshape(plan.theta.size, N, N)
    grid_steps(A, F, left, right, h, largest * plan.eps[:m], P)
    return doublings(N, plan, scale, work)


@njit(cache=True, nogil=True)
def combination_norms(samples: FloatArray, weights: FloatArray) -> tuple[FloatArray, bool]:
    """Return the norms of combinations of ``samples``, and whether the samples are alike in size.

    Weights and norms are those of `Piece`.
    """
    groups, m, N = weights.shape[0], samples.shape[0], samples.shape[1]
    flat, zero = samples.reshape(m, N * N), broadcast(0.0)
    squares = np.dot(flat, flat.T) / N
    norms = np.empty((1, groups, LANE_COUNT))
    for g in range(groups):
        square = zero
        for a in range(m):
            part = zero
            for b in range(m):
                part = fma(broadcast(squares[a, b]), load(weights, g, b), part)
            square = fma(part, load(weights, g, a), square)
        store(norms, 0, g, square_root(pick_le(zero, square, square, zero)))
    sizes = np.diag(squares)
    return norms.reshape(groups * LANE_COUNT), sizes.max() <= MAX_SAMPLE_CONTRAST**2 * sizes.min()


def in_lanes(weights: FloatArray) -> FloatArray:
    """Return ``weights`` (cells, m) of sixteen cells at a time, (groups, m, 16); the last cell fills the last group."""
    padded = np.concatenate([weights, np.repeat(weights[-1:], -len(weights) % LANE_COUNT, axis=0)])
    return np.ascontiguousarray(padded.reshape(-1, LANE_COUNT, weights.shape[1]).transpose(0, 2, 1))
