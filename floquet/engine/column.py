"""Columns of a chart: all amplitudes at one frequency, subsystem by subsystem, each cell with its error."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import groupby
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from floquet.engine.doubling import INTERPOLATION_TOLERANCE, Workspace
from floquet.engine.eigen import UNIT_ROUNDOFF
from floquet.engine.krein import held_apart
from floquet.engine.multipliers import dominant, select, spectra
from floquet.engine.parts import AnySubsystem, parts_of, sampler_of
from floquet.engine.stability import SMALLEST_NORMAL, DominantMultiplier, Stability, combine, judge
from floquet.engine.steps import ORDER, fastest, log2_steps, measured_amplitudes, step_errors
from floquet.kind import Kind
from floquet.running import single_blas_thread
from periodic import AnySystem, has_stiffness_alone
from periodic.checks import ComplexArray, FloatArray

# Relative distance of the frequencies of columns that share a measurement of the error.
MEASUREMENT_REACH = 0.1
# The error is measured at a few amplitudes, with all multipliers; between them it may be larger by up to this factor.
ERROR_SAFETY = 4.0
# Measured errors are divided by what they are expected to go with, but at least by this part of its largest value in
# the cells that follow from them: at a tiny amplitude rounding is measured, which must not be magnified without bound.
MIN_UNIT_PART = 1e-3
ROUNDINGS_PER_ROW = 32  # of a matrix, from interpolation and eigenvalues
ROUNDINGS_PER_STEP = 4  # of the period: errors of the samples add up


class Tile(NamedTuple):
    """The cells of some columns of a chart, each array of shape (k, columns)."""

    growth_rate: FloatArray
    multiplier: ComplexArray
    kind: NDArray[np.int8]
    error: FloatArray


def chart_batch(systems: Sequence[AnySystem], Omega: FloatArray, eps: FloatArray, steps_per_cycle: float) -> Tile:
    """Return some columns of a chart, one for each system and frequency.

    This is a pure function. A column depends on its own system and frequency, on ``eps`` and ``steps_per_cycle``, and,
    as far as its errors go, on the columns beside it. So batches can be computed anywhere, in any order, and kept.
    """
    work, parts, done = Workspace(), [], 0
    with single_blas_thread():
        # columns of one system share what is known of their errors, and so do all those of general systems
        for _, same in groupby(systems, key=lambda system: system if has_stiffness_alone(system) else None):
            members = list(same)
            here = Omega[done : done + len(members)]
            split = parts_of(members, here, eps)
            for alike in runs(split):
                parts.append(_columns(split[alike], here[alike], eps, steps_per_cycle, work))
            done += len(members)
    log_modulus, angle, error, kind = (np.concatenate(part).T for part in zip(*parts, strict=True))
    with np.errstate(over="ignore"):
        modulus = np.exp(log_modulus)
    direction = np.where(angle == np.pi, -1, np.cos(angle) + 1j * np.sin(angle))
    multiplier = np.empty_like(direction)
    for part, factor in ((multiplier.real, direction.real), (multiplier.imag, direction.imag)):
        part[:] = np.multiply(modulus, factor, where=factor != 0, out=np.zeros_like(factor))  # not infinity times zero
    return Tile(log_modulus * Omega / (2 * np.pi), multiplier, kind, error)


def runs(split: Sequence[tuple[AnySubsystem, ...]]) -> Iterator[slice]:
    """Yield the runs of columns whose systems fall into subsystems of the same sizes."""
    sizes = [tuple(part.states for part in parts) for parts in split]
    start = 0
    for _, same in groupby(sizes):
        count = len(list(same))
        yield slice(start, start + count)
        start += count


def _columns(
    split: Sequence[tuple[AnySubsystem, ...]],
    Omega: FloatArray,
    eps: FloatArray,
    steps_per_cycle: float,
    work: Workspace,
) -> Stability:
    """Return the stability at some neighbouring frequencies, arrays of shape (frequencies, k).

    ``split`` has the subsystems at each of them, the same number.
    """
    measured = _measured(Omega)
    if not split[0]:  # all motions are rigid
        nothing = np.zeros((len(Omega), len(eps)))
        return Stability(nothing, nothing, nothing, np.full(nothing.shape, Kind.STABLE, np.int8))
    cells = []
    for parts in zip(*split, strict=True):
        columns = [
            _column(subsystem, float(w), eps, steps_per_cycle, work, measure=i in measured)
            for i, (subsystem, w) in enumerate(zip(parts, Omega, strict=True))
        ]
        found = DominantMultiplier(*(np.array(part) for part in zip(*(c.found for c in columns), strict=True)))
        symplectic = all(subsystem.symplectic for subsystem in parts)
        E = _errors(symplectic, parts[0].states, eps, columns, found.excess, measured)
        judged = judge(found, E, all(subsystem.reciprocal for subsystem in parts))
        if symplectic:
            for i in np.flatnonzero(_in_doubt(judged).any(axis=1)):
                column = Stability(*(x[i] for x in judged))
                _look_again(parts[i], float(Omega[i]), eps, steps_per_cycle, work, column, E[i])
        cells.append(judged)
    return combine(cells)


def _in_doubt(judged: Stability) -> NDArray[np.bool_]:
    """Return where all multipliers are on the unit circle within their errors, but two of them are close."""
    return np.asarray(judged.kind == Kind.UNDECIDED)


def _look_again(
    subsystem: AnySubsystem,
    Omega: float,
    eps: FloatArray,
    steps_per_cycle: float,
    work: Workspace,
    judged: Stability,
    E: FloatArray,
) -> None:
    """Decide the cells of a column whose multipliers are held apart by Krein's form, in place."""
    cells = np.flatnonzero(_in_doubt(judged))
    sampler = sampler_of(subsystem, Omega, work)
    L = log2_steps(subsystem, Omega, eps, steps_per_cycle)
    Phi = sampler.matrices(eps[cells], L, INTERPOLATION_TOLERANCE)
    stable = cells[held_apart(Phi, E[cells])]
    judged.kind[stable] = Kind.STABLE
    judged.log_modulus[stable] = 0.0
    judged.error[stable] = E[stable]


class _Column(NamedTuple):
    """The dominant multipliers of a subsystem at one frequency, and what their errors follow from."""

    found: DominantMultiplier
    losses: FloatArray
    cycles: float  # T and h, the period and a step, in cycles of the fastest motion
    step: float
    slopes: FloatArray  # E in units of T h^4 |eps| nu, from the amplitudes at which it was measured; else 0


def _column(
    subsystem: AnySubsystem, Omega: float, eps: FloatArray, steps_per_cycle: float, work: Workspace, *, measure: bool
) -> _Column:
    """Integrate a column; ``measure`` its error at a few amplitudes by integrating once more with half the step."""
    L = log2_steps(subsystem, Omega, eps, steps_per_cycle)
    sampler = sampler_of(subsystem, Omega, work)
    all_of_them = spectra(sampler, eps, L, INTERPOLATION_TOLERANCE)
    found = dominant(all_of_them, subsystem.reversible)
    cycles = fastest(subsystem, Omega, eps) / Omega
    step, slopes, losses = cycles / 2.0**L, np.zeros(len(eps)), all_of_them.losses
    if measure:
        places = measured_amplitudes(eps)
        errors = step_errors(sampler, select(all_of_them, places), eps[places], L)
        known = np.isfinite(errors)  # where all eigenvalues converged
        if known.any():
            unit = cycles * step**ORDER * np.abs(eps) * found.excess
            slopes = _slopes(errors[known], np.array(places)[known], unit)
        else:
            losses = np.full(len(eps), np.inf)
    return _Column(found, losses, cycles, step, slopes)


def _slopes(errors: FloatArray, places: NDArray[np.intp], unit: FloatArray) -> FloatArray:
    """Return E / ``unit`` (k,) at all amplitudes from ``errors`` E (t,) at some ``places``: the largest of four.

    These are the two amplitudes on either side of a cell. E goes through zero here and there, as its sign changes, but
    hardly at two of them; and it grows faster in one part of a column than in another, where tongues are crossed.
    """
    cells = np.arange(len(unit))
    after = np.searchsorted(places, cells)
    before = np.searchsorted(places, cells, side="right") - 1
    nearest = np.clip([before - 1, before, after, after + 1], 0, len(places) - 1)
    largest = np.zeros(len(places))
    for row in nearest:
        np.maximum.at(largest, row, unit)
    measured = errors / np.maximum(np.maximum(unit[places], MIN_UNIT_PART * largest), SMALLEST_NORMAL)
    return np.asarray(measured[nearest].max(axis=0))


def _errors(
    symplectic: bool,
    states: int,
    eps: FloatArray,
    columns: Sequence[_Column],
    nu: FloatArray,
    measured: Sequence[int],
) -> FloatArray:
    """Return the errors E (columns, k) of neighbouring columns, of which some were ``measured``.

    The error of a matrix goes with its norm, and so E goes with the norm in units of the dominant multiplier: the
    excess ``nu`` (columns, k). Truncation makes E a multiple of T h^4 |eps| nu, by a factor that neighbouring columns
    share. It is zero at eps = 0 and grows at least like eps^2, so that the straight line is on the safe side. Rounding
    errors are u nu: where two multipliers coalesce there is an off-diagonal entry of size nu between them, and the
    square of their distance shifts by u nu^2. Of a symplectic matrix the sums mu + 1/mu are computed, which rounding
    errors u nu shift by as much.
    """
    losses = np.array([column.losses for column in columns])
    cycles, step = np.array([(column.cycles, column.step) for column in columns]).T
    places = np.arange(len(columns))
    before, after = np.searchsorted(measured, places, side="right") - 1, np.searchsorted(measured, places)
    slopes = np.array([columns[i].slopes for i in measured])
    unit = (cycles * step**ORDER)[:, None] * np.abs(eps) * nu
    truncation = unit * np.maximum(slopes[before], slopes[after])
    roundings = ROUNDINGS_PER_STEP * cycles / step + ROUNDINGS_PER_ROW * states
    rounding = UNIT_ROUNDOFF * roundings[:, None] * (nu if symplectic else nu**2)
    return np.asarray(ERROR_SAFETY * losses * np.maximum(truncation, rounding))


def _measured(Omega: FloatArray) -> list[int]:
    """Return the columns whose error is measured: the first, the last, and enough between for none to be far off."""
    found = [0]
    for i in range(1, len(Omega)):
        if i == len(Omega) - 1 or Omega[i + 1] > (1 + MEASUREMENT_REACH) * Omega[found[-1]]:
            found.append(i)
    return found
