"""Narrow regions of instability, followed from the resonances that they start from.

A region much narrower than the distance between the columns of a scan is met by none of them. But beside it the
exponents of its two modes are smooth: by how much they miss the resonance is known in the columns on both sides, for
all amplitudes, and the region is where nothing is missed. One column placed there measures how unstable it is, which is
how wide it is.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from floquet.boundary import Resonance
from floquet.engine import Sampler, Workspace, log2_steps, spectra, subsystems
from floquet.regions.centrelines import middles, root
from floquet.regions.detuning import BALANCED, Nodes, home_of, scan_nodes
from floquet.regions.exponents import modes_of
from floquet.regions.scan import Modes, Scan
from floquet.regions.widths import Candidate
from floquet.running import as_completed
from periodic import SystemFamily
from periodic.checks import FloatArray

# Error of the multipliers: coarse if that is no more than this part of the expected f, else fine enough to be sure of
# most regions; columns with one error share the plan of their doublings.
ACCURACY, FINEST, COARSEST = 1e-2, 1e-12, 1e-7
# Candidates that share their work space.
A_TASK = 4
# Columns placed in a region, at most; each shows where to place the next.
TRIALS = 4
# Levels in a row at which nothing may be known within a stretch: where one of the modes meets a third one in passing.
GAP = 8
# Levels beyond the upper end of a stretch at which a column is placed, if it may go on there.
AHEAD = 4
# The middle of a region is known to this part of the window, or a column is placed where it is known least.
KNOWN = 1e-4
# A column that is unstable by more than this many times what is expected is so by something else.
MOST = 16.0
# A node on one side only says where a region is that is this near to it, as part of the window.
CLOSE = 1e-3
# What is this many times the error is sure.
SURE = 30.0
# Times that heights and places are found from one another.
PASSES = 2
TINY = 1e-30


class Tongue(NamedTuple):
    """A stretch of a narrow region: its edges ``lower`` and ``upper`` in Omega at the amplitudes ``eps``, arrays (k,),
    upwards.

    ``witness`` is an (Omega, eps) inside, where a subsystem with so many ``modes`` is unstable; ``sure`` if a column
    meets it there and finds its multipliers off the unit circle by far more than their error.
    """

    name: Resonance
    eps: FloatArray
    lower: FloatArray
    upper: FloatArray
    witness: tuple[float, float]
    sure: bool
    modes: int


class _Fit(NamedTuple):
    """What is known of the middle of a region at all levels, arrays (k,): its place, NaN where unknown, the square of
    the half width, f there, whether that is measured, the node that is nearest to it and inside the region, -1 if there
    is none, where it may be where it is unknown, and by how much it may be off."""

    centre: FloatArray
    square: FloatArray
    height: FloatArray
    measured: NDArray[np.bool_]
    inside: NDArray[np.intp]
    likely: FloatArray
    doubt: FloatArray


def trace_tongues(
    family: SystemFamily,
    candidates: Sequence[Candidate],
    scan: Scan,
    eps_range: tuple[float, float],
    widest: float,
    n_jobs: int | None,
) -> list[Tongue]:
    """Return the narrow regions that start at the candidates, in stretches: where they are not wider than ``widest`` in
    Omega, nor lost among others, within ``eps_range``."""
    pairs = list(zip(candidates, scan_nodes(candidates, scan), strict=True))
    batches = [pairs[i : i + A_TASK] for i in range(0, len(pairs), A_TASK)]
    tasks = ((family, batch, (scan.window, eps_range), scan.eps, widest, scan.steps) for batch in batches)
    found = dict(as_completed(_tongues, tasks, n_jobs))
    return [tongue for i in range(len(batches)) for tongue in found[i]]


def reach(candidate: Candidate, top: float, widest: float) -> float:
    """Return the amplitude, at most ``top``, up to which a candidate is not wider than ``widest``."""
    return top * min(1.0, (widest / max(candidate.width, TINY)) ** (1 / candidate.name.j))


def _tongues(
    family: SystemFamily,
    pairs: Sequence[tuple[Candidate, Nodes]],
    window: tuple[tuple[float, float], tuple[float, float]],
    eps: FloatArray,
    widest: float,
    steps: float,
) -> list[Tongue]:
    work, found = Workspace(), []
    for candidate, nodes in pairs:
        levels = int(np.searchsorted(eps, reach(candidate, window[1][1], widest), side="right"))
        first = int(np.searchsorted(eps, window[1][0]))
        found += _Follower(family, candidate, window[0], eps, steps, work).tongues(nodes, first, levels)
    return found


class _Follower:
    """Follows one candidate along the amplitudes ``eps``, with new columns where they are needed."""

    def __init__(
        self,
        family: SystemFamily,
        candidate: Candidate,
        window: tuple[float, float],
        eps: FloatArray,
        steps: float,
        work: Workspace,
    ) -> None:
        self.family, self.candidate, self.window = family, candidate, window
        self.eps, self.steps, self.work = eps, steps, work
        subsystem = candidate.home.subsystem
        self.damped = not subsystem.reciprocal
        self.free, self.expected = _expected(candidate, eps)
        self.errors: dict[float, float] = {}
        self.close = CLOSE * (window[1] - window[0])
        self.slope = -candidate.name.j * np.pi * candidate.balance

    def tongues(self, nodes: Nodes, first: int, levels: int) -> list[Tongue]:
        """Return the stretches of the region among the first ``levels``, from the level ``first`` on."""
        fit = self.fit(nodes, levels)
        for _ in range(TRIALS):
            wanted = (way(fit, nodes, first) for way in (self._unmet, self._further, self._doubtful))
            place = next((place for place in wanted if place is not None), None)
            if place is None:
                break
            nodes = self._with(nodes, place)
            fit = self.fit(nodes, levels)
        found = [self._outline(fit, nodes, max(start, first), last) for start, last in _stretches(fit.centre)]
        return [tongue for tongue in found if tongue is not None]

    def _seen(self, fit: _Fit, nodes: Nodes, first: int) -> NDArray[np.bool_]:
        """Return at which levels, from ``first`` on, the middle is in the window and in no wide region."""
        seen = ~nodes.wide.at(np.nan_to_num(fit.centre))
        seen &= (fit.centre >= self.window[0]) & (fit.centre <= self.window[1])
        seen[:first] = False
        return seen

    def _unmet(self, fit: _Fit, nodes: Nodes, first: int) -> float | None:
        """Return where to place a column to meet a stretch that none meets; None if there is nowhere."""
        seen = self._seen(fit, nodes, first)
        for start, last in _stretches(fit.centre):
            start = max(start, first)
            if last > start and seen[start : last + 1].any():
                top = start + int(np.flatnonzero(seen[start : last + 1])[-1])
                if fit.centre[top] not in nodes.Omega and self._witness(fit, nodes, start, last) is None:
                    return float(fit.centre[top])
        return None

    def _further(self, fit: _Fit, nodes: Nodes, first: int) -> float | None:
        """Return where to place a column to follow a stretch beyond its upper end; None if there is nowhere."""
        likely = np.where(nodes.wide.at(np.nan_to_num(fit.likely)), np.nan, fit.likely)
        for start, last in _stretches(fit.centre):
            ahead = likely[last + 1 : last + 1 + AHEAD]
            known = last > max(start, first) and len(ahead) == AHEAD and np.isfinite(ahead).all()
            if known and self.window[0] <= ahead[-1] <= self.window[1] and ahead[-1] not in nodes.Omega:
                return float(ahead[-1])
        return None

    def _doubtful(self, fit: _Fit, nodes: Nodes, first: int) -> float | None:
        """Return where to place a column to know better where the region is; None if that is known everywhere."""
        doubt = np.where(self._seen(fit, nodes, first), fit.doubt, 0.0)
        worst = int(doubt.argmax())
        if doubt[worst] <= KNOWN * (self.window[1] - self.window[0]) or fit.centre[worst] in nodes.Omega:
            return None
        return float(fit.centre[worst])

    def _witness(self, fit: _Fit, nodes: Nodes, start: int, last: int) -> tuple[float, float, bool] | None:
        """Return a point inside a stretch that a column meets: at a level, or else between two; None if none does.

        And whether instability is sure there.
        """
        met = np.flatnonzero(fit.inside[start : last + 1] >= 0) + start
        if len(met):
            f = nodes.f[fit.inside[met], met]
            best = met[np.flatnonzero(f >= 0.5 * f.max())[-1]]
            Omega = float(nodes.Omega[fit.inside[best]])
            sure = nodes.f[fit.inside[best], best] > SURE * self.errors.get(Omega, COARSEST)
            return Omega, float(self.eps[best]), bool(sure)
        if self.damped:
            return None
        centre = fit.centre[start : last + 1]
        sides = nodes.apart[:, start : last + 1] > 0
        known = np.isfinite(centre)
        fits = np.isfinite(nodes.f[:, start : last + 1]) & (~known | (sides == (nodes.Omega[:, None] < centre)))
        crossed = fits[:, 1:] & fits[:, :-1] & (sides[:, 1:] != sides[:, :-1]) & (known[1:] | known[:-1])
        if not crossed.any():
            return None
        beside = np.pad(fits, ((0, 0), (1, 1)))
        well = crossed & beside[:, :-3] & beside[:, 3:]  # next to a third one modes are bent
        crossed = well if well.any() else crossed
        level = int(np.flatnonzero(crossed.any(axis=0))[-1])
        column = int(crossed[:, level].argmax())
        some = np.arange(max(start + level - 1, 0), min(start + level + 3, len(self.eps)))
        steps = np.diff(nodes.apart[column, some])
        if not (np.isfinite(nodes.f[column, some]).all() and ((steps > 0).all() or (steps < 0).all())):
            some = start + level + np.array([0, 1])
        zero = root(self.eps[some], nodes.apart[column, some])
        return float(nodes.Omega[column]), float(np.clip(zero, *self.eps[start + level + np.array([0, 1])])), False

    def _with(self, nodes: Nodes, Omega: float) -> Nodes:
        """Return the nodes with a new column."""
        error = COARSEST if ACCURACY * self.expected[-1] > COARSEST else FINEST
        column, losses = self._column(Omega, self.eps, error)
        self.errors[Omega] = error * float(losses.max())
        return nodes.with_column(self.candidate, Omega, column, self.eps)

    def _column(self, Omega: float, eps: FloatArray, error: float) -> tuple[Modes, FloatArray]:
        """Return the modes of the subsystem at ``eps`` (k,), and how many times (k,) ``error`` they are off."""
        parts = subsystems(self.family.at(Omega))
        subsystem = parts[home_of(parts, self.candidate.home, Omega)]
        sampler = Sampler.of(subsystem, Omega, self.work)
        # fourth order; where steps are symplectic they only shift the region, by a small part of its width
        finer = 1.0 if subsystem.symplectic else (COARSEST / error) ** 0.25
        found = spectra(sampler, eps, log2_steps(subsystem, Omega, self.eps, self.steps * finer), error)
        return Modes(subsystem, modes_of(found)), found.losses

    def _is_sure(self, Omega: float, level: float) -> bool:
        """Return whether a column of one point is unstable there by far more than its error."""
        (_, found), losses = self._column(Omega, np.array([level]), FINEST)
        growth = float((found.modulus + found.split).max())
        return bool(growth > 0 and growth**2 > SURE * FINEST * losses[0])

    def fit(self, nodes: Nodes, levels: int) -> _Fit:
        """Return what the nodes say about the first ``levels``; the others are unknown."""
        height, exact = self.free + self.expected, self.candidate.balance < BALANCED
        limits = (self.free + MOST * self.expected, self.candidate.name.centre, self.slope, self.close)
        for _ in range(PASSES):
            centre, square, f, room, inside, measured, likely, doubt = middles(*nodes[:3], exact, height, *limits)
            centre[levels:] = np.nan
            known = np.flatnonzero(measured & np.isfinite(centre) & (f > self.free))
            if not len(known):
                break
            ratio = np.maximum(f[known] - self.free, TINY) / np.maximum(self.expected[known], TINY)
            above = np.minimum(np.searchsorted(known, np.arange(len(centre))), len(known) - 1)
            part = np.minimum((self.eps / np.maximum(self.eps[known[above]], TINY)) ** 2, 1.0)
            height = self.free + self.expected * ratio[above] ** part
        height = np.minimum(height, room)
        return _Fit(centre, square, height, measured, np.where(np.isfinite(centre), inside, -1), likely, doubt)

    def _outline(self, fit: _Fit, nodes: Nodes, start: int, last: int) -> Tongue | None:
        """Return a stretch of the region; None if no column meets it."""
        levels = np.arange(start, last + 1)
        if len(levels) < 2:
            return None
        known = levels[np.isfinite(fit.centre[levels])]
        squares = self.eps**2
        centre, square, height = (
            np.interp(squares[levels], squares[known], part[known]) for part in (fit.centre, fit.square, fit.height)
        )
        closed = np.flatnonzero(height < 0)
        bottom = closed[-1] + 1 if len(closed) else 0
        if len(levels) - bottom < 2:
            return None
        half, at = np.sqrt(np.maximum(square * height, 0.0))[bottom:], self.eps[levels[bottom:]]
        middle = centre[bottom:]
        if bottom > 0:  # the tip, where f is zero in the middle
            part = height[bottom] / (height[bottom] - height[bottom - 1])
            at = np.append(at[0] - part * (at[0] - self.eps[levels[bottom - 1]]), at)
            middle, half = np.append(middle[0], middle), np.append(0.0, half)
        witness = self._witness(fit, nodes, int(levels[bottom]), last)
        if witness is None:
            return None
        Omega, level, sure = witness
        sure = sure or (not (level in self.eps and Omega in self.errors) and self._is_sure(Omega, level))
        where = int(np.searchsorted(at, level))
        if at[min(where, len(at) - 1)] != level:
            width = np.interp(level, at, half)
            at, middle, half = (np.insert(a, where, b) for a, b in ((at, level), (middle, Omega), (half, width)))
        elif abs(middle[where] - Omega) > half[where]:
            middle[where] = Omega
        modes = len(self.candidate.home.exponents)
        return Tongue(self.candidate.name, at, middle - half, middle + half, (Omega, level), sure, modes)


def _stretches(centre: FloatArray) -> list[tuple[int, int]]:
    """Return the first and the last level of each stretch in which the middle is known, short gaps apart."""
    known = np.flatnonzero(np.isfinite(centre))
    if not len(known):
        return []
    gaps = np.flatnonzero(np.diff(known) > GAP + 1)
    return list(zip(known[[0, *(gaps + 1)]].tolist(), known[[*gaps, -1]].tolist(), strict=True))


def _expected(candidate: Candidate, eps: FloatArray) -> tuple[float, FloatArray]:
    """Return f in the middle of a region without excitation, and by how much more it is expected to be at ``eps``."""
    name, exponents = candidate.name, candidate.home.exponents
    period = 2 * np.pi / name.centre
    conservative = candidate.home.subsystem.reciprocal
    decay = 0.0 if conservative else exponents[candidate.p].real * exponents[candidate.q].real
    growth = candidate.width * candidate.balance * name.j / 4 * (eps / candidate.eps) ** name.j
    return -float(decay) * period**2, (growth * period) ** 2
