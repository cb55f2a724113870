"""Narrow regions of instability, followed from the resonances that they start from.

A region much narrower than the distance between the columns of a scan is met by none of them. But beside it the
exponents of its two modes are smooth: the columns on both sides know the detuning of these for all amplitudes, and the
centreline of the region is where that is zero. One column placed there measures how unstable the region is, which is
how wide it is.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from floquet.boundary import Resonance
from floquet.engine import Sampler, Workspace, log2_steps, spectra, subsystems
from floquet.regions.centrelines import Centreline, centreline, polynomial_zero
from floquet.regions.column import SubsystemColumn
from floquet.regions.detuning import EQUAL_DAMPING_BALANCE, Detuning, detunings, matching_subsystem
from floquet.regions.scan import Scan
from floquet.regions.tracking import log_multipliers
from floquet.regions.widths import ExpectedTongue
from floquet.regions.window import Window
from floquet.running import as_completed
from periodic.checks import FloatArray

# Narrow regions are followed up to this width, in distances between the columns before any refinement.
MAX_TONGUE_WIDTH = 2.0
# Error of the multipliers of a column, coarse or fine. Columns with one error share the plan of their doublings.
COARSE_COLUMN_ERROR, FINE_COLUMN_ERROR = 1e-7, 1e-12
# A coarse column will do if its error is no more than this part of the expected f.
MAX_PART_OF_F = 1e-2
# Tongues that share their work space.
TONGUES_PER_TASK = 4
# Columns placed for one tongue, at most; each shows where to place the next.
MAX_EXTRA_COLUMNS = 4
# Levels in a row that may be unknown within a segment: where one of the modes meets a third one in passing.
MAX_UNKNOWN_AMPLITUDES = 8
# Levels beyond the upper end of a segment at which a column is placed, if it may go on there.
AMPLITUDES_AHEAD = 4
# The centreline is known if it is known to this part of the width of the window.
CENTRELINE_TOLERANCE = 1e-4
# A column is unstable by something else if f is more than this many times what is expected.
MAX_HEIGHT_RATIO = 16.0
# With columns on one side only, the centreline is known this near to one of them, as part of the width of the window.
MAX_ONE_SIDED_DISTANCE = 1e-3
# Instability is sure if f is this many times its error.
SURE_RATIO = 30.0
# Times that heights and centrelines are found from one another.
FIT_PASSES = 2
# The witness of a segment is at the largest amplitude with at least this part of the largest f.
WITNESS_HEIGHT = 0.5
# Values of f, and of eps, below this are zero.
MIN_VALUE = 1e-30


class Tongue(NamedTuple):
    """A segment of a narrow region: its edges ``lower`` and ``upper`` in Omega at the amplitudes ``eps``, arrays (k,),
    upwards.

    ``witness`` is an (Omega, eps) inside, where a subsystem with so many ``modes`` is unstable. ``sure`` says that a
    column meets it there and finds its multipliers off the unit circle by far more than their error.
    """

    resonance: Resonance
    eps: FloatArray
    lower: FloatArray
    upper: FloatArray
    witness: tuple[float, float]
    sure: bool
    modes: int


def trace_tongues(expected: Sequence[ExpectedTongue], scan: Scan) -> list[Tongue]:
    """Return the segments of narrow regions in the window of a scan, in the order of the ``expected`` ones.

    A region is followed where it is not wider than `max_width` and not lost among others.
    """
    pairs = list(zip(expected, detunings(expected, scan), strict=True))
    batches = [pairs[i : i + TONGUES_PER_TASK] for i in range(0, len(pairs), TONGUES_PER_TASK)]
    tasks = ((scan.window, scan.grid.steps, batch) for batch in batches)
    found = dict(as_completed(_tongues, tasks, scan.window.n_jobs))
    return [tongue for i in range(len(batches)) for tongue in found[i]]


def max_width(window: Window) -> float:
    """Return the width in Omega up to which narrow regions are followed."""
    return MAX_TONGUE_WIDTH * window.width / window.spans


def _tongues(window: Window, steps: float, pairs: Sequence[tuple[ExpectedTongue, Detuning]]) -> list[Tongue]:
    work, found = Workspace(), []
    for expected, detuning in pairs:
        found += _TongueTracer(window, expected, steps, work).tongues(detuning)
    return found


class _TongueTracer:
    """Follows one expected tongue along the amplitudes of a window, with new columns where they are needed."""

    def __init__(self, window: Window, expected: ExpectedTongue, steps: float, work: Workspace) -> None:
        self.window, self.expected, self.steps, self.work = window, expected, steps, work
        self.eps = window.amplitudes
        self.first = int(np.searchsorted(self.eps, window.eps_range[0]))
        self.count = int(np.searchsorted(self.eps, expected.eps_of_width(max_width(window)), side="right"))
        self.damped = not expected.modes.subsystem.reciprocal
        self.free, self.rise = _expected_heights(expected, self.eps)
        self.errors: dict[float, float] = {}
        self.slope = -expected.resonance.j * np.pi * expected.balance

    def tongues(self, detuning: Detuning) -> list[Tongue]:
        """Return the segments of the region in the window."""
        line = self.centreline(detuning)
        for _ in range(MAX_EXTRA_COLUMNS):
            wanted = (place(line, detuning) for place in (self._unmet, self._further, self._uncertain))
            Omega = next((place for place in wanted if place is not None), None)
            if Omega is None:
                break
            detuning = self._with_column(detuning, Omega)
            line = self.centreline(detuning)
        found = [self._tongue(line, detuning, max(start, self.first), last) for start, last in _segments(line.Omega)]
        return [tongue for tongue in found if tongue is not None]

    def _visible(self, line: Centreline, detuning: Detuning) -> NDArray[np.bool_]:
        """Return at which amplitudes of the window the centreline is in the window and in no wide region."""
        visible = ~detuning.wide.at(np.nan_to_num(line.Omega))
        visible &= (line.Omega >= self.window.Omega_range[0]) & (line.Omega <= self.window.Omega_range[1])
        visible[: self.first] = False
        return visible

    def _unmet(self, line: Centreline, detuning: Detuning) -> float | None:
        """Return where to place a column to meet a segment that none meets; None if there is nowhere."""
        visible = self._visible(line, detuning)
        for start, last in _segments(line.Omega):
            start = max(start, self.first)
            if last > start and visible[start : last + 1].any():
                top = start + int(np.flatnonzero(visible[start : last + 1])[-1])
                if line.Omega[top] not in detuning.Omega and self._witness(line, detuning, start, last) is None:
                    return float(line.Omega[top])
        return None

    def _further(self, line: Centreline, detuning: Detuning) -> float | None:
        """Return where to place a column to follow a segment beyond its upper end; None if there is nowhere."""
        likely = np.where(detuning.wide.at(np.nan_to_num(line.likely)), np.nan, line.likely)
        for start, last in _segments(line.Omega):
            ahead = likely[last + 1 : last + 1 + AMPLITUDES_AHEAD]
            known = last > max(start, self.first) and len(ahead) == AMPLITUDES_AHEAD and np.isfinite(ahead).all()
            if known and self.window.covers(ahead[-1]) and ahead[-1] not in detuning.Omega:
                return float(ahead[-1])
        return None

    def _uncertain(self, line: Centreline, detuning: Detuning) -> float | None:
        """Return where to place a column to know the centreline better; None if it is known everywhere."""
        uncertainty = np.where(self._visible(line, detuning), line.uncertainty, 0.0)
        worst = int(uncertainty.argmax())
        if uncertainty[worst] <= CENTRELINE_TOLERANCE * self.window.width or line.Omega[worst] in detuning.Omega:
            return None
        return float(line.Omega[worst])

    def _witness(self, line: Centreline, detuning: Detuning, start: int, last: int) -> tuple[float, float, bool] | None:
        """Return a point inside a segment that a column meets, and whether instability is sure there.

        The point is at a amplitude, or else between two. None if no column meets the segment.
        """
        met = np.flatnonzero(line.inside[start : last + 1] >= 0) + start
        if len(met):
            f = detuning.f[line.inside[met], met]
            best = met[np.flatnonzero(f >= WITNESS_HEIGHT * f.max())[-1]]
            Omega = float(detuning.Omega[line.inside[best]])
            sure = detuning.f[line.inside[best], best] > SURE_RATIO * self.errors.get(Omega, COARSE_COLUMN_ERROR)
            return Omega, float(self.eps[best]), bool(sure)
        if self.damped:
            return None
        centre = line.Omega[start : last + 1]
        sides = detuning.detuning[:, start : last + 1] > 0
        known = np.isfinite(centre)
        fits = np.isfinite(detuning.f[:, start : last + 1]) & (~known | (sides == (detuning.Omega[:, None] < centre)))
        crossed = fits[:, 1:] & fits[:, :-1] & (sides[:, 1:] != sides[:, :-1]) & (known[1:] | known[:-1])
        if not crossed.any():
            return None
        beside = np.pad(fits, ((0, 0), (1, 1)))
        well = crossed & beside[:, :-3] & beside[:, 3:]  # next to a third one modes are bent
        crossed = well if well.any() else crossed
        amplitude = int(np.flatnonzero(crossed.any(axis=0))[-1])
        column = int(crossed[:, amplitude].argmax())
        some = np.arange(max(start + amplitude - 1, 0), min(start + amplitude + 3, len(self.eps)))
        steps = np.diff(detuning.detuning[column, some])
        if not (np.isfinite(detuning.f[column, some]).all() and ((steps > 0).all() or (steps < 0).all())):
            some = start + amplitude + np.array([0, 1])
        zero = polynomial_zero(self.eps[some], detuning.detuning[column, some])
        return (
            float(detuning.Omega[column]),
            float(np.clip(zero, *self.eps[start + amplitude + np.array([0, 1])])),
            False,
        )

    def _with_column(self, detuning: Detuning, Omega: float) -> Detuning:
        """Return what is known with a new column."""
        is_coarse = MAX_PART_OF_F * self.rise[-1] > COARSE_COLUMN_ERROR
        error = COARSE_COLUMN_ERROR if is_coarse else FINE_COLUMN_ERROR
        column, losses = self._column(Omega, self.eps, error)
        self.errors[Omega] = error * float(losses.max())
        return detuning.with_column(self.expected, Omega, column, self.eps)

    def _column(self, Omega: float, eps: FloatArray, error: float) -> tuple[SubsystemColumn, FloatArray]:
        """Return a column of the subsystem at ``eps`` (k,), and how many times (k,) ``error`` it is off."""
        parts = subsystems(self.window.family.at(Omega))
        subsystem = parts[matching_subsystem(parts, self.expected.modes, Omega)]
        sampler = Sampler.of(subsystem, Omega, self.work)
        # fourth order; where steps are symplectic they only shift the region, by a small part of its width
        finer = 1.0 if subsystem.symplectic else (COARSE_COLUMN_ERROR / error) ** 0.25
        found = spectra(sampler, eps, log2_steps(subsystem, Omega, self.eps, self.steps * finer), error)
        return SubsystemColumn(subsystem, log_multipliers(found)), found.losses

    def _is_sure(self, Omega: float, amplitude: float) -> bool:
        """Return whether a column of one point is unstable there by far more than its error."""
        (_, found), losses = self._column(Omega, np.array([amplitude]), FINE_COLUMN_ERROR)
        growth = float((found.modulus + found.half_difference).max())
        return bool(growth > 0 and growth**2 > SURE_RATIO * FINE_COLUMN_ERROR * losses[0])

    def centreline(self, detuning: Detuning) -> Centreline:
        """Return what the columns say about the centreline, up to the amplitude at which the region is too wide."""
        height, exact = self.free + self.rise, self.expected.balance < EQUAL_DAMPING_BALANCE
        most, close = self.free + MAX_HEIGHT_RATIO * self.rise, MAX_ONE_SIDED_DISTANCE * self.window.width
        for _ in range(FIT_PASSES):
            line = centreline(*detuning[:3], exact, height, most, self.expected.resonance.centre, self.slope, close)
            line.Omega[self.count :] = np.nan
            known = np.flatnonzero(line.measured & np.isfinite(line.Omega) & (line.height > self.free))
            if not len(known):
                break
            ratio = np.maximum(line.height[known] - self.free, MIN_VALUE) / np.maximum(self.rise[known], MIN_VALUE)
            above = np.minimum(np.searchsorted(known, np.arange(len(self.eps))), len(known) - 1)
            part = np.minimum((self.eps / np.maximum(self.eps[known[above]], MIN_VALUE)) ** 2, 1.0)
            height = self.free + self.rise * ratio[above] ** part
        inside = np.where(np.isfinite(line.Omega), line.inside, -1)
        return line._replace(height=np.minimum(height, line.bound), inside=inside)

    def _tongue(self, line: Centreline, detuning: Detuning, start: int, last: int) -> Tongue | None:
        """Return a segment of the region; None if no column meets it."""
        amplitudes = np.arange(start, last + 1)
        if len(amplitudes) < 2:
            return None
        known = amplitudes[np.isfinite(line.Omega[amplitudes])]
        squares = self.eps**2
        centre, square, height = (
            np.interp(squares[amplitudes], squares[known], part[known])
            for part in (line.Omega, line.square, line.height)
        )
        closed = np.flatnonzero(height < 0)
        bottom = closed[-1] + 1 if len(closed) else 0
        if len(amplitudes) - bottom < 2:
            return None
        half, at = np.sqrt(np.maximum(square * height, 0.0))[bottom:], self.eps[amplitudes[bottom:]]
        centre = centre[bottom:]
        if bottom > 0:  # the tip, where f is zero on the centreline
            part = height[bottom] / (height[bottom] - height[bottom - 1])
            at = np.append(at[0] - part * (at[0] - self.eps[amplitudes[bottom - 1]]), at)
            centre, half = np.append(centre[0], centre), np.append(0.0, half)
        witness = self._witness(line, detuning, int(amplitudes[bottom]), last)
        if witness is None:
            return None
        Omega, amplitude, sure = witness
        sure = sure or (not (amplitude in self.eps and Omega in self.errors) and self._is_sure(Omega, amplitude))
        where = int(np.searchsorted(at, amplitude))
        if at[min(where, len(at) - 1)] != amplitude:
            width = np.interp(amplitude, at, half)
            at, centre, half = (np.insert(a, where, b) for a, b in ((at, amplitude), (centre, Omega), (half, width)))
        elif abs(centre[where] - Omega) > half[where]:
            centre[where] = Omega
        modes = len(self.expected.modes.exponents)
        return Tongue(self.expected.resonance, at, centre - half, centre + half, (Omega, amplitude), sure, modes)


def _segments(centre: FloatArray) -> list[tuple[int, int]]:
    """Return the first and last amplitude of each segment with a known centreline. A few between may be unknown."""
    known = np.flatnonzero(np.isfinite(centre))
    if not len(known):
        return []
    gaps = np.flatnonzero(np.diff(known) > MAX_UNKNOWN_AMPLITUDES + 1)
    return list(zip(known[[0, *(gaps + 1)]].tolist(), known[[*gaps, -1]].tolist(), strict=True))


def _expected_heights(expected: ExpectedTongue, eps: FloatArray) -> tuple[float, FloatArray]:
    """Return f on the centreline without excitation, and by how much more it is expected to be at ``eps``."""
    one, exponents = expected.resonance, expected.modes.exponents
    period = 2 * np.pi / one.centre
    conservative = expected.modes.subsystem.reciprocal
    decay = 0.0 if conservative else exponents[expected.p].real * exponents[expected.q].real
    growth = expected.width * expected.balance * one.j / 4 * (eps / expected.eps) ** one.j
    return -float(decay) * period**2, (growth * period) ** 2
