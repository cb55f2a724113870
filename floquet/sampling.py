"""Monodromy matrices of one block for a range of amplitudes: as samples to interpolate between, in as many panels as
it takes."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from floquet.coordinates import Block, Equations
from floquet.doubling import EMPTY, Level, Schedule, double, quantised, rescale, schedule
from floquet.interpolation import chebyshev_points, chebyshev_weights, trigonometric_weights
from floquet.kernels import single_steps
from floquet.lanes import WIDTH
from periodic.checks import FloatArray

MOST_ENTRIES = 2**22  # of one array of samples (32 MB); five such arrays are in use at a time
# Samples to be interpolated between may differ in size by this much; the smallest lose as many digits to rounding.
MOST_CONTRAST = 30.0
# Logarithm of the growth that the factors of one product may differ by; the small ones must not underflow.
MOST_FACTOR = 100.0


class Panel(NamedTuple):
    """Monodromy matrices at the amplitudes eps[cells]: 2^exponents * (weights @ samples).

    ``samples`` (m, N, N), ``weights`` (cells, m), ``exponents`` (cells,).
    """

    cells: slice
    samples: FloatArray
    weights: FloatArray
    exponents: FloatArray


class Workspace:
    """Arrays that are used again and again: fresh memory costs more than the arithmetic on it."""

    def __init__(self) -> None:
        self._buffers = [np.empty(0), np.empty(0), np.empty(0)]

    def array(self, which: int, *shape: int) -> FloatArray:
        """Return array number ``which`` (0, 1, 2) in the given shape; what it holds is void."""
        size = math.prod(shape)
        if self._buffers[which].size < size:
            self._buffers[which] = np.empty(size)
        return self._buffers[which][:size].reshape(shape)


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
            sample = self._interpolated if count > WIDTH else self._direct
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
        most = max(p * m for p, m in zip(plan.phases, plan.nodes, strict=True))
        if plan.nodes[-1] >= len(eps) or most * self.size**2 > MOST_ENTRIES:
            return None
        exponents = np.zeros(1)
        P = self._single_steps(plan.phases[0], middle + radius * chebyshev_points(plan.nodes[0]), L)
        samples = self._double(P, plan.levels, exponents, self.work)[0]
        sizes = np.linalg.norm(samples, axis=(1, 2))
        if not sizes.max() <= MOST_CONTRAST * sizes.min():
            return None
        weights = chebyshev_weights(len(samples), (eps - middle) / radius)
        return Panel(slice(0), samples, weights, np.full(len(eps), exponents[0]))

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
        exponents = np.zeros(len(eps))
        P = self._double(self._single_steps(plan.phases[0], eps, L), plan.levels[:stop], exponents, self.work)
        samples = P[0] if stop == L else self._ordered_product(P, 2 ** (L - stop), growth, exponents)
        return Panel(slice(0), samples, np.eye(len(eps)), exponents)

    def _fits(self, matrices: int, growth: float) -> bool:
        return matrices * self.size**2 <= MOST_ENTRIES and growth <= MOST_FACTOR

    def _plan(self, eps: FloatArray, radius: float, L: int, tolerance: float) -> Schedule:
        growth = self.period * self.equations.strength
        x_phase = tuple(quantised(x) for x in np.abs(eps).max() * growth)
        return schedule(L, x_phase, quantised(radius * growth.sum()), tolerance)

    def _single_steps(self, phases: int, eps: FloatArray, L: int) -> FloatArray:
        P = self.work.array(0, phases, len(eps), self.size, self.size)
        A, left, right, _ = self.equations
        single_steps(A, self.block.Fc, self.block.Fs, left, right, self.period / 2**L, eps, P)
        return P

    def _double(self, P: FloatArray, levels: tuple[Level, ...], exponents: FloatArray, work: Workspace) -> FloatArray:
        """Apply ``levels`` to P, which is array 0 of ``work`` or none of them."""
        for i, level in enumerate(levels):
            p, m = P.shape[:2]
            nodes, phases = len(level.nodes) or m, len(level.second) or p // 2
            scratch = work.array(2, (p + 2 * phases) * nodes * self.size**2)
            result = work.array(1 - i % 2, phases, nodes, self.size, self.size)
            double(P, *level, result, scratch)
            P = result
            exponents *= 2
            rescale(P, exponents)
        return P

    def _ordered_product(self, P: FloatArray, B: int, growth: float, exponents: FloatArray) -> FloatArray:
        """Return the product of the B factors P(2 pi b / B), b = 0 ... B - 1, of one amplitude, a part of them at a
        time."""
        p, halvings = P.shape[0], 0
        while 2**halvings < B and self._fits(2 ** (halvings + 1), 2 ** (halvings + 1) * growth / B):
            halvings += 1
        product, total, work = np.eye(self.size)[None, None], np.zeros(1), Workspace()
        for start in range(0, B, 2**halvings):
            phases = np.arange(start, start + 2**halvings)
            if p < B:
                weights = trigonometric_weights(p, 2 * np.pi * phases / B)
                factors = (weights @ P.reshape(p, -1)).reshape(-1, 1, self.size, self.size)
            else:
                factors = P[phases]
            part = exponents.copy()
            product = self._double(factors, (Level(EMPTY, EMPTY, EMPTY),) * halvings, part, work) @ product
            total += part
            rescale(product, total)
        exponents[:] = total
        return product[0]
