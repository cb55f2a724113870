"""One column of a chart: all amplitudes at one frequency, block by block, each with its error."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import groupby
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from floquet.coordinates import Block, blocks, equations
from floquet.doubling import TOLERANCE, Scale
from floquet.sampling import Sampler, Workspace
from floquet.spectra import eigenvalues
from floquet.symplectic import reciprocal_pairs, symplectic_eigenvalues
from floquet.threads import single_blas_thread
from floquet.verdict import Cells, ComplexArray, Dominant, combine, discrepancy, dominant, dominant_symplectic, judge
from periodic import PeriodicSystem
from periodic.checks import FloatArray

# Steps in one cycle of the fastest motion, at least. With fewer than two and a bit, the steps themselves are in
# resonance with the fast modes, which then look unstable.
LEAST_STEPS = 16.0
MOST_STEPS = 2.0**16  # more only collect rounding errors
TARGET = 1e-10  # for the error E of `floquet.verdict`
# Columns whose frequencies differ by less than this part share a measurement of the error.
CLOSE = 0.1
# The error is measured at two amplitudes, and with all multipliers; elsewhere it may be a little larger.
SAFETY = 4.0
UNIT, TINY = float(np.finfo(float).eps), float(np.finfo(float).tiny)


class Columns(NamedTuple):
    """The cells of some columns of a chart, each array of shape (k, columns)."""

    growth_rate: FloatArray
    multiplier: ComplexArray
    kind: NDArray[np.int8]
    error: FloatArray


def chart_block(systems: Sequence[PeriodicSystem], Omega: FloatArray, eps: FloatArray, steps_a_cycle: float) -> Columns:
    """Return some columns of a chart, one for each system and frequency.

    A pure function, in which each column depends on its own system and frequency, ``eps`` and ``steps_a_cycle`` alone:
    blocks can be computed anywhere, in any order, and kept.
    """
    work, cells, done = Workspace(), [], 0
    with single_blas_thread():
        for system, same in groupby(systems, key=lambda system: system):
            count = len(list(same))
            cells.append(_columns(blocks(system), Omega[done : done + count], eps, steps_a_cycle, work))
            done += count
    log_modulus, angle, error, kind = (np.concatenate(parts).T for parts in zip(*cells, strict=True))
    with np.errstate(over="ignore"):
        modulus = np.exp(log_modulus)
    direction = np.where(angle == np.pi, -1, np.cos(angle) + 1j * np.sin(angle))
    multiplier = np.empty_like(direction)
    for part, factor in ((multiplier.real, direction.real), (multiplier.imag, direction.imag)):
        part[:] = np.multiply(modulus, factor, where=factor != 0, out=np.zeros_like(factor))  # not infinity times zero
    return Columns(log_modulus * Omega / (2 * np.pi), multiplier, kind, error)


def steps_needed(systems: Sequence[PeriodicSystem], Omega: FloatArray, eps: FloatArray) -> float:
    """Return how many steps in one cycle of the fastest motion the given columns need, for `chart_block`."""
    work = Workspace()
    with single_blas_thread():
        return max(
            _needed_steps(block, float(frequency), eps, work)
            for system, frequency in zip(systems, Omega, strict=True)
            for block in blocks(system)
        )


def _columns(
    parts: Sequence[Block], Omega: FloatArray, eps: FloatArray, steps_a_cycle: float, work: Workspace
) -> Cells:
    """Return the cells of a system at some neighbouring frequencies, arrays of shape (frequencies, k)."""
    measured = _measured(Omega)
    after = np.searchsorted(measured, np.arange(len(Omega)))
    before = np.searchsorted(measured, np.arange(len(Omega)), side="right") - 1
    cells = []
    for block in parts:
        columns = [
            _column(block, float(w), eps, steps_a_cycle, work, measure=i in measured) for i, w in enumerate(Omega)
        ]
        found = Dominant(*(np.array(part) for part in zip(*(column.found for column in columns), strict=True)))
        slopes = np.array([columns[i].slope for i in measured])
        slopes = np.maximum(slopes[before], slopes[after])
        E = SAFETY * np.array([column.error(eps, slope) for column, slope in zip(columns, slopes, strict=True)])
        cells.append(judge(found, E, block.symplectic or block.reversible))
    return combine(cells)


class _Column(NamedTuple):
    """The dominant multipliers of a block at one frequency, and what their errors follow from."""

    found: Dominant
    size: float  # T h^4, which the error is proportional to
    slope: float  # E / size / |eps|, the largest of those measured; 0 if it was not measured
    rounding: float
    losses: FloatArray

    def error(self, eps: FloatArray, slope: float) -> FloatArray:
        """Return the errors E (k,): exact at eps = 0, they grow like eps^2, of which a straight line is on the safe
        side."""
        return self.losses * np.maximum(slope * self.size * np.abs(eps), self.rounding)


def _column(
    block: Block, Omega: float, eps: FloatArray, steps_a_cycle: float, work: Workspace, *, measure: bool
) -> _Column:
    """Integrate a column; ``measure`` its error at two amplitudes, by integrating once more with half the step."""
    L = log2_steps(block, Omega, eps, steps_a_cycle)
    sampler = Sampler(block, equations(block, least_frequency(Omega)), Omega, work)
    mu, (exponents, losses) = multipliers(sampler, eps, L, TOLERANCE)
    found = dominant_symplectic(mu, exponents) if block.symplectic else dominant(mu, exponents, block.reversible)
    size, slope = sampler.period * (sampler.period / 2.0**L) ** 4, 0.0
    if measure:
        tested = _tested(eps)
        measured = _discrepancies(sampler, mu[tested], exponents[tested], eps[tested], L)
        slope = (measured / np.maximum(np.abs(eps[tested]), np.abs(eps).max() / 4 + TINY)).max() / size
    return _Column(found, size, slope, UNIT * 2.0**L, losses)


def _measured(Omega: FloatArray) -> list[int]:
    """Return the columns whose error is measured: the first, the last, and as many as leave none far from one."""
    found = [0]
    for i in range(1, len(Omega)):
        if i == len(Omega) - 1 or Omega[i + 1] > (1 + CLOSE) * Omega[found[-1]]:
            found.append(i)
    return found


def _needed_steps(block: Block, Omega: float, eps: FloatArray, work: Workspace) -> float:
    """Return how many steps in one cycle of the fastest motion bring the error at ``Omega`` down to TARGET."""
    sampler, some = Sampler(block, equations(block, least_frequency(Omega)), Omega, work), eps[_tested(eps)]
    steps = LEAST_STEPS
    while True:
        L = log2_steps(block, Omega, eps, steps)
        mu, scale = multipliers(sampler, some, L, TOLERANCE)
        error = _discrepancies(sampler, mu, scale.exponents, some, L).max()
        taken = 2.0**L * Omega / fastest(block, Omega, eps)
        steps = min(max(taken * (error / TARGET) ** 0.25, LEAST_STEPS), MOST_STEPS)  # fourth order
        if steps <= 4 * taken:
            return steps


def fastest(block: Block, Omega: float, eps: FloatArray) -> float:
    """Return the rate of the fastest motion: of the system at its stiffest, or of the excitation."""
    return max(math.sqrt(block.rate**2 + np.abs(eps).max() * block.modulation), len(block.Fc) * Omega)


def least_frequency(Omega: float) -> float:
    """Return a frequency well below Omega that serves as a scale where there is no stiffness; few different ones."""
    return 2.0 ** math.floor(math.log2(Omega / 50))


def log2_steps(block: Block, Omega: float, eps: FloatArray, steps_a_cycle: float) -> int:
    """Return L, where 2^L steps make one period."""
    return math.ceil(math.log2(steps_a_cycle * fastest(block, Omega, eps) / Omega))


def multipliers(sampler: Sampler, eps: FloatArray, L: int, tolerance: float) -> tuple[ComplexArray, Scale]:
    """Return mu (k, N), or mu + 1/mu (k, n) of a symplectic block, and their scale."""
    solve = symplectic_eigenvalues if sampler.block.symplectic else eigenvalues
    parts, scales = [], []
    for panel in sampler.panels(eps, L, tolerance):
        parts.append(solve(panel.samples, panel.weights)[: panel.scale.exponents.size])
        scales.append(panel.scale)
    mu, scale = np.concatenate(parts), Scale(*(np.concatenate(part) for part in zip(*scales, strict=True)))
    scale.losses[~np.isfinite(mu).all(axis=1)] = np.inf  # an eigenvalue that did not converge: nothing is known
    return mu, scale


def _tested(eps: FloatArray) -> list[int]:
    """Return the amplitudes to integrate once more with half the step: the largest and the one nearest to its half."""
    sizes = np.abs(eps)
    return sorted({int(sizes.argmax()), int(np.abs(sizes - sizes.max() / 2).argmin())})


def _discrepancies(sampler: Sampler, mu: ComplexArray, exponents: FloatArray, eps: FloatArray, L: int) -> FloatArray:
    """Return E at the amplitudes ``eps``, whose multipliers from 2^L steps are given as by `multipliers`."""
    finer, (finer_exponents, _) = multipliers(sampler, eps, L + 1, TOLERANCE / 10)
    finer = finer * 2.0 ** np.clip(finer_exponents - exponents, -1000, 1000)[:, None]
    if sampler.block.symplectic and not exponents.any():  # beyond the range of exponents mu + 1/mu is mu
        mu, finer = reciprocal_pairs(mu), reciprocal_pairs(finer)
    return discrepancy(mu, finer)
