"""Monodromy matrices of one subsystem for a range of amplitudes: as samples to interpolate between, in as many panels
as it takes."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numba import njit

from floquet.engine.coordinates import Equations, Subsystem, equations, least_frequency
from floquet.engine.doubling.doubling import Scale, cancellation, doublings, rescale, unit_scale
from floquet.engine.doubling.interpolation import chebyshev_points, chebyshev_weights, degree, trigonometric_weights
from floquet.engine.doubling.memo import kept
from floquet.engine.doubling.schedule import MOST_GROWTH, TOLERANCE, Schedule, growth, phase_count, quantised, schedule
from floquet.engine.doubling.step import single_steps
from floquet.engine.eigen.lanes import WIDTH, fma, load, pick_le, root, spread, store
from periodic.checks import FloatArray

MOST_ENTRIES = 2**23  # of one array of samples (64 MB); two such arrays are in use at a time
MOST_MATRICES = 2**14  # of one array, since others are interpolated between them, with a weight for each
# Samples to be interpolated between may differ in size by this much; the smallest lose as many digits to rounding.
MOST_CONTRAST = 30.0
# Logarithm of the growth that the factors of one product may differ by; the small ones must not underflow.
MOST_FACTOR = 100.0
FEW = 8  # amplitudes that are integrated one by one: interpolation would take as many
FACTORS = 64  # of a long product that are multiplied pairwise, the others one after the other


class Panel(NamedTuple):
    """Monodromy matrices at the amplitudes eps[cells]: combinations of ``samples`` (m, N, N) at the given scale.

    ``weights`` (groups, m, 16) are those of sixteen cells at a time; the last cell is repeated to fill the last group.
    ``norms`` (k,) are those of the matrices, 1 for a rotation.
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
        """Return two arrays with at least ``size`` entries, contents void."""
        if self._buffers[0].size < size:
            self._buffers = [np.empty(size), np.empty(size)]
        return self._buffers[0], self._buffers[1]


class Sampler:
    """Samples the monodromy matrix of one subsystem at one frequency."""

    def __init__(self, subsystem: Subsystem, equations: Equations, Omega: float, work: Workspace) -> None:
        self.subsystem, self.equations, self.work = subsystem, equations, work
        self.size = len(equations.A)
        self.period = 2 * math.pi / Omega

    @classmethod
    def of(cls, subsystem: Subsystem, Omega: float, work: Workspace) -> Sampler:
        """Return the sampler of a subsystem in the coordinates that suit ``Omega``."""
        return cls(subsystem, equations(subsystem, least_frequency(Omega)), Omega, work)

    def panels(self, eps: FloatArray, L: int, tolerance: float) -> Iterator[Panel]:
        """Yield panels that together cover ``eps``, from 2^L steps a period; each is void once the next is asked
        for."""
        stack = [slice(0, len(eps))]
        while stack:
            cells = stack.pop()
            count = cells.stop - cells.start
            sample = self._interpolated if count > FEW else self._direct
            panel = sample(eps[cells], L, tolerance)
            if panel is not None:
                yield panel._replace(cells=cells)
            else:
                middle = cells.start + count // 2
                stack += [slice(middle, cells.stop), slice(cells.start, middle)]

    def matrices(self, eps: FloatArray, L: int, tolerance: float) -> FloatArray:
        """Return the monodromy matrices at a few amplitudes, (k, N, N), whose growth is within the range of floats."""
        found = []
        for panel in self.panels(eps, L, tolerance):
            weights = panel.weights.transpose(0, 2, 1).reshape(-1, len(panel.samples))[: panel.norms.size]
            found.append(np.tensordot(weights, panel.samples, 1) * np.exp2(panel.scale.exponents)[:, None, None])
        return np.concatenate(found)

    def _interpolated(self, eps: FloatArray, L: int, tolerance: float) -> Panel | None:
        """Return a panel with samples at Chebyshev points; None if they would be too many, or are too unequal."""
        plan = self.plan(eps, L, tolerance)
        if plan is None:
            return None
        scale = unit_scale(1)
        samples = self._sample(plan.schedule, largest_amplitude(eps), L, scale)
        norms, alike = _norms(samples, plan.weights)
        if not alike:
            return None
        scale = Scale(*(part.repeat(len(eps)) for part in scale))
        return Panel(slice(0), samples, plan.weights, scale, norms[: len(eps)])

    def plan(self, eps: FloatArray, L: int, tolerance: float) -> Interpolation | None:
        """Return how the monodromy matrices at ``eps`` are interpolated, from 2^L steps a period; None if that takes
        too many samples."""
        rate = sum(self.equations.strength) * self.period
        x = growth(self.equations.strength, self.period * largest_amplitude(eps))
        across = quantised(rate * (float(eps[-1]) - float(eps[0])) / 2)
        return _interpolation(x, across, eps.tobytes(), L, tolerance, MOST_ENTRIES // self.size**2)

    def _direct(self, eps: FloatArray, L: int, tolerance: float) -> Panel | None:
        """Return a panel with samples at the amplitudes themselves; None if they are several and need too much
        memory."""
        largest = largest_amplitude(eps)
        x = growth(self.equations.strength, self.period * largest)
        stop, B, phases = 0, 2**L, phase_count(2**L, x, tolerance)
        while stop < L:
            fewer = phase_count(B // 2, x, tolerance)
            if not self._fits(fewer * len(eps), 2 * sum(x) / B):
                break
            stop, B, phases = stop + 1, B // 2, fewer
        if stop < L and len(eps) > 1:
            return None
        amplitudes, scale = eps / (largest or 1.0), unit_scale(len(eps))
        P = self._sample(schedule(x, 0.0, amplitudes.tobytes(), phases, B, stop, tolerance), largest, L, scale)
        if stop < L:
            P, scale = self._ordered_product(P, B, sum(x), scale)
        weights = in_lanes(np.eye(len(eps)))
        return Panel(slice(0), P, weights, scale, _norms(P, weights)[0][: len(eps)])

    def _fits(self, matrices: int, growth: float) -> bool:
        return matrices <= MOST_MATRICES and matrices * self.size**2 <= MOST_ENTRIES // 2 and growth <= MOST_FACTOR

    def _sample(self, plan: Schedule, largest: float, L: int, scale: Scale) -> FloatArray:
        """Return the samples at the end of a schedule, given the largest amplitude."""
        work = self.work.arrays(plan.most * self.size**2)
        A, left, right, _ = self.equations
        h = self.period / 2**L
        return _samples(A, self.subsystem.Fc, self.subsystem.Fs, left, right, h, largest, plan, scale, work)

    def _ordered_product(self, P: FloatArray, B: int, growth: float, scale: Scale) -> tuple[FloatArray, Scale]:
        """Return the product of the B factors P(2 pi b / B), b = 0 ... B - 1, of one amplitude, a part at a time, given
        ``P`` (p, N, N) at p equispaced phases."""
        N, p, halvings = self.size, len(P), 0
        while 2**halvings < min(B, FACTORS) and self._fits(2 ** (halvings + 1), 2 ** (halvings + 1) * growth / B):
            halvings += 1
        count = 2**halvings
        plan = schedule((np.inf,), 0.0, np.ones(1).tobytes(), 1, 1, halvings, TOLERANCE)  # of these factors
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
    """How the matrices of a panel follow from samples at Chebyshev points: by ``weights`` as in `Panel`."""

    schedule: Schedule
    weights: FloatArray


@kept
def _interpolation(
    x: tuple[float, ...], across: float, cells: bytes, L: int, tolerance: float, most: int
) -> Interpolation | None:
    """Return the interpolation at the amplitudes ``cells``, or None if it takes as many samples, or more than ``most``
    matrices at a time; ``x`` as from `growth`, ``across`` that between the middle of the amplitudes and their ends."""
    eps = np.frombuffer(cells)
    middle, radius = (eps[-1] + eps[0]) / 2, (eps[-1] - eps[0]) / 2
    nodes = degree((across,), tolerance) + 1
    if nodes >= len(eps) or nodes * sum(x) / MOST_GROWTH > most:  # the latter where no phases are interpolated
        return None
    points = (middle + radius * chebyshev_points(nodes)) / largest_amplitude(eps)
    plan = schedule(x, across, points.tobytes(), 1, 1, L, tolerance)
    if plan.most > most:
        return None
    return Interpolation(plan, in_lanes(chebyshev_weights(nodes, (eps - middle) / radius)))


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
    """Return what `doublings` makes of `single_steps`: one call, since calls take as long as the work for small N."""
    N, s = A.shape[0], plan.theta.size
    single_steps(A, Fc, Fs, left, right, h, plan.theta, largest * plan.eps, work[0][: s * N * N].reshape(s, N, N))
    return doublings(N, plan, scale, work)


@njit(cache=True, nogil=True)
def _norms(samples: FloatArray, weights: FloatArray) -> tuple[FloatArray, bool]:
    """Return the norms of combinations of ``samples`` with weights as in `Panel`, 1 for a rotation, and whether the
    samples themselves are of about the same size."""
    groups, m, N = weights.shape[0], samples.shape[0], samples.shape[1]
    flat, zero = samples.reshape(m, N * N), spread(0.0)
    squares = np.dot(flat, flat.T) / N
    norms = np.empty((1, groups, WIDTH))
    for g in range(groups):
        square = zero
        for a in range(m):
            part = zero
            for b in range(m):
                part = fma(spread(squares[a, b]), load(weights, g, b), part)
            square = fma(part, load(weights, g, a), square)
        store(norms, 0, g, root(pick_le(zero, square, square, zero)))
    sizes = np.diag(squares)
    return norms.reshape(groups * WIDTH), sizes.max() <= MOST_CONTRAST**2 * sizes.min()


def in_lanes(weights: FloatArray) -> FloatArray:
    """Return ``weights`` (cells, m) of sixteen cells at a time, (groups, m, 16); the last cell fills the last group."""
    padded = np.concatenate([weights, np.repeat(weights[-1:], -len(weights) % WIDTH, axis=0)])
    return np.ascontiguousarray(padded.reshape(-1, WIDTH, weights.shape[1]).transpose(0, 2, 1))
