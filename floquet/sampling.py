"""Monodromy matrices of one block for a range of amplitudes: as samples to interpolate between, in as many panels as
it takes."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from floquet.coordinates import Block, Equations
from floquet.doubling import Scale, Schedule, cancellation, doublings, quantised, rescale, schedule, unit_scale
from floquet.interpolation import chebyshev_points, chebyshev_weights, trigonometric_weights
from floquet.kernels import single_steps
from floquet.lanes import WIDTH
from periodic.checks import FloatArray

MOST_ENTRIES = 2**22  # of one array of samples (32 MB); five such arrays are in use at a time
# Samples to be interpolated between may differ in size by this much; the smallest lose as many digits to rounding.
MOST_CONTRAST = 30.0
# Logarithm of the growth that the factors of one product may differ by; the small ones must not underflow.
MOST_FACTOR = 100.0
FEW = 8  # amplitudes that are integrated one by one: interpolation would take as many
FACTORS = 64  # of a long product that are multiplied pairwise, the others one after the other


class Panel(NamedTuple):
    """Monodromy matrices at the amplitudes eps[cells]: combinations of ``samples`` (m, N, N) at the given scale.

    ``weights`` (groups, m, 16) are those of sixteen cells at a time; the last cell is repeated to fill the last group.
    """

    cells: slice
    samples: FloatArray
    weights: FloatArray
    scale: Scale


class Workspace:
    """Arrays that are used again and again: fresh memory costs more than the arithmetic on it."""

    def __init__(self) -> None:
        self._buffers = [np.empty(0), np.empty(0), np.empty(0)]

    def arrays(self, *sizes: int) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return three arrays with at least ``sizes`` entries, contents void."""
        for i, size in enumerate(sizes):
            if self._buffers[i].size < size:
                self._buffers[i] = np.empty(size)
        return self._buffers[0], self._buffers[1], self._buffers[2]


class Sampler:
    """Samples the monodromy matrix of one block at one frequency."""

    def __init__(self, block: Block, equations: Equations, Omega: float, work: Workspace) -> None:
        self.block, self.equations, self.work = block, equations, work
        self.size = len(equations.A)
        self.period = 2 * math.pi / Omega

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

    def _interpolated(self, eps: FloatArray, L: int, tolerance: float) -> Panel | None:
        """Return a panel with samples at Chebyshev points; None if they would be too many, or are too unequal."""
        middle, radius = (eps[-1] + eps[0]) / 2, (eps[-1] - eps[0]) / 2
        plan = self._plan(eps, radius, L, tolerance)
        if plan.nodes[-1] >= len(eps) or (plan.phases * plan.nodes).max() * self.size**2 > MOST_ENTRIES:
            return None
        scale = unit_scale(1)
        samples = self._sample(plan, middle + radius * chebyshev_points(plan.nodes[0]), L, L, scale)[0]
        sizes = np.linalg.norm(samples, axis=(1, 2))
        if not sizes.max() <= MOST_CONTRAST * sizes.min():
            return None
        weights = _interpolation(len(samples), ((eps - middle) / radius).tobytes())
        return Panel(slice(0), samples, weights, Scale(*(np.repeat(part, len(eps)) for part in scale)))

    def _direct(self, eps: FloatArray, L: int, tolerance: float) -> Panel | None:
        """Return a panel with samples at the amplitudes themselves; None if they are several and need too much
        memory."""
        plan = self._plan(eps, 0.0, L, tolerance)
        growth = np.abs(eps).max() * self.period * self.equations.strength.sum()
        stop = 0
        while stop < L and self._fits(plan.phases[stop + 1] * len(eps), growth / 2 ** (L - stop - 1)):
            stop += 1
        if stop < L and len(eps) > 1:
            return None
        scale = unit_scale(len(eps))
        P = self._sample(plan, eps, L, stop, scale)
        if stop < L:
            P, scale = self._ordered_product(P, 2 ** (L - stop), growth, scale)
        return Panel(slice(0), P[0], in_lanes(np.eye(len(eps))), scale)

    def _fits(self, matrices: int, growth: float) -> bool:
        return matrices * self.size**2 <= MOST_ENTRIES and growth <= MOST_FACTOR

    def _plan(self, eps: FloatArray, radius: float, L: int, tolerance: float) -> Schedule:
        growth = self.period * self.equations.strength
        x_phase = tuple(quantised(x) for x in np.abs(eps).max() * growth)
        return schedule(L, x_phase, quantised(radius * growth.sum()), tolerance)

    def _sample(self, plan: Schedule, eps: FloatArray, L: int, levels: int, scale: Scale) -> FloatArray:
        """Return the samples of P_levels for a schedule that begins at the amplitudes ``eps``."""
        phases, m, size = plan.phases[: levels + 1], len(eps) // plan.nodes[0] * plan.nodes[: levels + 1], self.size**2
        samples = int((phases * m).max()) * size
        scratch = int(((phases[:-1] + 2 * phases[1:]) * m[1:]).max(initial=0)) * size
        work = self.work.arrays(samples, samples, scratch)
        P = work[0][: phases[0] * len(eps) * size].reshape(phases[0], len(eps), self.size, self.size)
        A, left, right, _ = self.equations
        single_steps(A, self.block.Fc, self.block.Fs, left, right, self.period / 2**L, eps, P)
        return doublings(P, plan.phases, plan.nodes, plan.weights, plan.present[:levels], scale, work)

    def _ordered_product(self, P: FloatArray, B: int, growth: float, scale: Scale) -> tuple[FloatArray, Scale]:
        """Return the product of the B factors P(2 pi b / B), b = 0 ... B - 1, of one amplitude, a part at a time."""
        p, halvings = P.shape[0], 0
        while 2**halvings < min(B, FACTORS) and self._fits(2 ** (halvings + 1), 2 ** (halvings + 1) * growth / B):
            halvings += 1
        some, missing = 2 ** np.arange(halvings, -1, -1), np.zeros((halvings, 3), bool)
        work = Workspace().arrays(2**halvings * self.size**2, 2**halvings * self.size**2, 0)
        product, total = np.eye(self.size)[None, None], unit_scale(1)
        for start in range(0, B, 2**halvings):
            phases = np.arange(start, start + 2**halvings)
            if p < B:
                weights = trigonometric_weights(p, 2 * np.pi * phases / B)
                factors = (weights @ P.reshape(p, -1)).reshape(-1, 1, self.size, self.size)
            else:
                factors = P[phases]
            part = Scale(scale.exponents.copy(), scale.losses)
            part_product = doublings(factors, some, some, np.empty(0), missing, part, work)
            before, product = product, part_product @ product
            loss = cancellation(part_product[0, 0], before[0, 0], product[0, 0])
            total.losses[0] = max(total.losses[0], part.losses[0], loss)
            total.exponents[:] += part.exponents
            rescale(product, total)
        return product, total


@lru_cache(maxsize=64)
def _interpolation(m: int, x: bytes) -> FloatArray:
    """Return the weights of a panel with m Chebyshev points for the amplitudes ``x``, scaled to [-1, 1]."""
    return in_lanes(chebyshev_weights(m, np.frombuffer(x)))


def in_lanes(weights: FloatArray) -> FloatArray:
    """Return ``weights`` (cells, m) of sixteen cells at a time, (groups, m, 16); the last cell fills the last group."""
    padded = np.concatenate([weights, np.repeat(weights[-1:], -len(weights) % WIDTH, axis=0)])
    return np.ascontiguousarray(padded.reshape(-1, WIDTH, weights.shape[1]).transpose(0, 2, 1))
