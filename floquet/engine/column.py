"""One column of a chart: all amplitudes at one frequency, subsystem by subsystem, each with its error."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import groupby
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from floquet.engine.coordinates import Subsystem, subsystems
from floquet.engine.doubling.sampling import Sampler, Workspace, largest_amplitude
from floquet.engine.doubling.schedule import TOLERANCE
from floquet.engine.eigen.hessenberg import eigenvalues
from floquet.engine.eigen.symplectic import reciprocal_pairs, symplectic_eigenvalues
from floquet.engine.krein import held_apart
from floquet.engine.verdict import (
    TINY,
    Cells,
    Dominant,
    combine,
    discrepancy,
    dominant,
    dominant_symplectic,
    judge,
)
from floquet.kind import Kind
from floquet.running.threads import single_blas_thread
from periodic import PeriodicSystem
from periodic.checks import ComplexArray, FloatArray

# Steps in one cycle of the fastest motion, at least. With fewer than two and a bit, the steps themselves are in
# resonance with the fast modes, which then look unstable.
LEAST_STEPS = 16.0
MOST_STEPS = 2.0**16  # more only collect rounding errors
MOST_DOUBLINGS = 20  # of the steps of one period, for the same reason
TARGET = 1e-10  # for the error E of `floquet.engine.verdict`
# Columns whose frequencies differ by less than this part share a measurement of the error.
CLOSE = 0.1
# The error is measured at two amplitudes, and with all multipliers; elsewhere it may be a little larger.
SAFETY = 4.0
ROUNDINGS = 32  # for each row of a matrix, from interpolation and eigenvalues
STEP_ROUNDINGS = 4  # for each step of the period: what its samples are off adds up
UNIT = float(np.finfo(float).eps)


class Columns(NamedTuple):
    """The cells of some columns of a chart, each array of shape (k, columns)."""

    growth_rate: FloatArray
    multiplier: ComplexArray
    kind: NDArray[np.int8]
    error: FloatArray


def chart_batch(systems: Sequence[PeriodicSystem], Omega: FloatArray, eps: FloatArray, steps_a_cycle: float) -> Columns:
    """Return some columns of a chart, one for each system and frequency.

    A pure function, in which each column depends on its own system and frequency, ``eps`` and ``steps_a_cycle`` alone:
    subsystems can be computed anywhere, in any order, and kept.
    """
    work, cells, done = Workspace(), [], 0
    with single_blas_thread():
        for system, same in groupby(systems, key=lambda system: system):
            count = len(list(same))
            cells.append(_columns(subsystems(system), Omega[done : done + count], eps, steps_a_cycle, work))
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
    """Return how many steps in one cycle of the fastest motion the given columns need, for `chart_batch`."""
    work = Workspace()
    with single_blas_thread():
        return max(
            _needed_steps(subsystem, float(frequency), eps, work)
            for system, frequency in zip(systems, Omega, strict=True)
            for subsystem in subsystems(system)
        )


def _columns(
    parts: Sequence[Subsystem], Omega: FloatArray, eps: FloatArray, steps_a_cycle: float, work: Workspace
) -> Cells:
    """Return the cells of a system at some neighbouring frequencies, arrays of shape (frequencies, k)."""
    measured = _measured(Omega)
    cells = []
    for subsystem in parts:
        columns = [
            _column(subsystem, float(w), eps, steps_a_cycle, work, measure=i in measured) for i, w in enumerate(Omega)
        ]
        found = Dominant(*(np.array(part) for part in zip(*(column.found for column in columns), strict=True)))
        E = _errors(subsystem, eps, columns, found.excess, measured)
        judged = judge(found, E, subsystem.reciprocal)
        if subsystem.symplectic:
            for i in np.flatnonzero(_in_doubt(judged).any(axis=1)):
                _look_again(subsystem, float(Omega[i]), eps, steps_a_cycle, work, Cells(*(x[i] for x in judged)), E[i])
        cells.append(judged)
    return combine(cells)


def _in_doubt(judged: Cells) -> NDArray[np.bool_]:
    """Return where all multipliers are on the unit circle within their errors, but two of them close."""
    return np.asarray(judged.kind == Kind.UNDECIDED)


def _look_again(
    subsystem: Subsystem,
    Omega: float,
    eps: FloatArray,
    steps_a_cycle: float,
    work: Workspace,
    judged: Cells,
    E: FloatArray,
) -> None:
    """Decide cells of a column, in place, whose multipliers are held apart by Krein's form."""
    cells = np.flatnonzero(_in_doubt(judged))
    sampler = Sampler.of(subsystem, Omega, work)
    Phi = sampler.matrices(eps[cells], log2_steps(subsystem, Omega, eps, steps_a_cycle), TOLERANCE)
    stable = cells[held_apart(Phi, E[cells])]
    judged.kind[stable] = Kind.STABLE
    judged.log_modulus[stable] = 0.0
    judged.error[stable] = E[stable]


class _Column(NamedTuple):
    """The dominant multipliers of a subsystem at one frequency, and what their errors follow from."""

    found: Dominant
    losses: FloatArray
    cycles: float  # T and h, the period and a step, in cycles of the fastest motion
    step: float
    slope: float  # E as part of T h^4 |eps| nu, the largest of those measured; 0 if it was not measured


def _column(
    subsystem: Subsystem, Omega: float, eps: FloatArray, steps_a_cycle: float, work: Workspace, *, measure: bool
) -> _Column:
    """Integrate a column; ``measure`` its error at two amplitudes, by integrating once more with half the step."""
    L = log2_steps(subsystem, Omega, eps, steps_a_cycle)
    sampler = Sampler.of(subsystem, Omega, work)
    mu, exponents, losses, norms = multipliers(sampler, eps, L, TOLERANCE)
    if subsystem.symplectic:
        found = dominant_symplectic(mu, exponents, norms)
    else:
        found = dominant(mu, exponents, norms, subsystem.reversible)
    cycles = fastest(subsystem, Omega, eps) / Omega
    step, slope = cycles / 2.0**L, 0.0
    if measure:
        tested = _tested(eps)
        unit = cycles * step**4 * np.abs(eps) * found.excess
        measured = _discrepancies(sampler, mu[tested], exponents[tested], eps[tested], L)
        slope = (measured / np.maximum(unit[tested], unit.max() / 4 + TINY)).max()
    return _Column(found, losses, cycles, step, slope)


def _errors(
    subsystem: Subsystem, eps: FloatArray, columns: Sequence[_Column], nu: FloatArray, measured: Sequence[int]
) -> FloatArray:
    """Return the errors E (columns, k) of neighbouring columns, of which some were ``measured``.

    The error of a matrix goes with its norm, E with that in units of the multipliers: the excess ``nu`` (columns, k).
    Truncation makes E a multiple of T h^4 |eps| nu, by a factor that neighbouring columns share: it is exact at
    eps = 0, and its error grows at least like eps^2, so that the straight line is on the safe side. Rounding errors are
    u nu: where two multipliers coalesce there is an off-diagonal entry of size nu between them, and the square of their
    distance shifts by u nu^2. Of a symplectic matrix the sums mu + 1/mu are computed, which rounding errors u nu shift
    by as much.
    """
    losses = np.array([column.losses for column in columns])
    cycles, step, slope = np.array([(column.cycles, column.step, column.slope) for column in columns]).T
    places = np.arange(len(columns))
    before, after = np.searchsorted(measured, places, side="right") - 1, np.searchsorted(measured, places)
    slope = slope[list(measured)]
    unit = cycles * step**4 * np.maximum(slope[before], slope[after])
    truncation = unit[:, None] * np.abs(eps) * nu
    roundings = STEP_ROUNDINGS * cycles / step + ROUNDINGS * 2 * len(subsystem.K)
    rounding = UNIT * roundings[:, None] * (nu if subsystem.symplectic else nu**2)
    return np.asarray(SAFETY * losses * np.maximum(truncation, rounding))


def _measured(Omega: FloatArray) -> list[int]:
    """Return the columns whose error is measured: the first, the last, and as many as leave none far from one."""
    found = [0]
    for i in range(1, len(Omega)):
        if i == len(Omega) - 1 or Omega[i + 1] > (1 + CLOSE) * Omega[found[-1]]:
            found.append(i)
    return found


def _needed_steps(subsystem: Subsystem, Omega: float, eps: FloatArray, work: Workspace) -> float:
    """Return how many steps in one cycle of the fastest motion bring the error at ``Omega`` down to TARGET."""
    sampler, some = Sampler.of(subsystem, Omega, work), eps[_tested(eps)]
    steps = LEAST_STEPS
    while True:
        L = log2_steps(subsystem, Omega, eps, steps)
        found = multipliers(sampler, some, L, TOLERANCE)
        error = _discrepancies(sampler, found.mu, found.exponents, some, L).max()
        taken = 2.0**L * Omega / fastest(subsystem, Omega, eps)
        steps = min(max(taken * (error / TARGET) ** 0.25, LEAST_STEPS), MOST_STEPS)  # fourth order
        if steps <= 4 * taken or L == MOST_DOUBLINGS:
            return steps


def fastest(subsystem: Subsystem, Omega: float, eps: FloatArray) -> float:
    """Return the rate of the fastest motion: of the system at its stiffest, or of the excitation."""
    return max(math.sqrt(subsystem.rate**2 + largest_amplitude(eps) * subsystem.modulation), len(subsystem.Fc) * Omega)


def log2_steps(subsystem: Subsystem, Omega: float, eps: FloatArray, steps_a_cycle: float) -> int:
    """Return L, where 2^L steps make one period.

    Raises
    ------
    ValueError
        If they would have to be more than 2^MOST_DOUBLINGS.
    """
    cycles = fastest(subsystem, Omega, eps) / Omega
    if not LEAST_STEPS * cycles <= 2.0**MOST_DOUBLINGS:
        raise ValueError(
            f"Omega = {Omega!r} with eps up to {largest_amplitude(eps)!r}: one period has {cycles:.2g} cycles of the "
            "fastest motion, too many to integrate; give a larger Omega or a smaller eps"
        )
    return min(math.ceil(math.log2(steps_a_cycle * cycles)), MOST_DOUBLINGS)


class Spectra(NamedTuple):
    """Multipliers 2^exponents[c] mu[c, i] of k cells of a subsystem; for a symplectic one ``mu`` is mu + 1/mu.

    ``losses`` as in `Scale`; ``norms`` are those of the matrices, 1 for a rotation, at the scale of ``mu``.
    """

    mu: ComplexArray
    exponents: FloatArray
    losses: FloatArray
    norms: FloatArray


def multipliers(sampler: Sampler, eps: FloatArray, L: int, tolerance: float) -> Spectra:
    """Return the multipliers of a subsystem at the amplitudes ``eps``, from 2^L steps a period."""
    solve = symplectic_eigenvalues if sampler.subsystem.symplectic else eigenvalues
    parts = []
    for panel in sampler.panels(eps, L, tolerance):
        mu = solve(panel.samples, panel.weights)[: panel.norms.size]
        lose_unfinished(mu, panel.scale.losses)
        parts.append(Spectra(mu, *panel.scale, panel.norms))
    return parts[0] if len(parts) == 1 else Spectra(*(np.concatenate(part) for part in zip(*parts, strict=True)))


@njit(cache=True, nogil=True)
def lose_unfinished(mu: ComplexArray, losses: FloatArray) -> None:
    """Make losses infinite where an eigenvalue did not converge: nothing is known."""
    for c in range(len(mu)):
        for i in range(mu.shape[1]):
            if not (np.isfinite(mu[c, i].real) and np.isfinite(mu[c, i].imag)):
                losses[c] = np.inf


def _tested(eps: FloatArray) -> list[int]:
    """Return the amplitudes to integrate once more with half the step: the largest and the one nearest to its half."""
    sizes = np.abs(eps)
    return sorted({int(sizes.argmax()), int(np.abs(sizes - sizes.max() / 2).argmin())})


def _discrepancies(sampler: Sampler, mu: ComplexArray, exponents: FloatArray, eps: FloatArray, L: int) -> FloatArray:
    """Return E at the amplitudes ``eps``, whose multipliers from 2^L steps are given as by `multipliers`."""
    again = multipliers(sampler, eps, L + 1, TOLERANCE / 10)
    finer = again.mu * 2.0 ** np.clip(again.exponents - exponents, -1000, 1000)[:, None]
    if sampler.subsystem.symplectic and not exponents.any():  # beyond the range of exponents mu + 1/mu is mu
        mu, finer = reciprocal_pairs(mu), reciprocal_pairs(finer)
    return discrepancy(mu, finer)
