"""One region in one subsystem: its intervals at an amplitude, and how it is unstable."""

from __future__ import annotations

from functools import cached_property
from typing import NamedTuple

import numpy as np

from floquet.boundary.crowd import SCAN_POINTS, Crowd, States, drift_of, free_states, gather, scan
from floquet.boundary.follow import Follower, Top
from floquet.boundary.forcing import strength_of
from floquet.boundary.pair import Point, Reference, judge
from floquet.boundary.resonance import Modes, Resonance
from floquet.boundary.solutions import Integrator, OutOfReachError
from floquet.boundary.subsystems import free_subsystems, home
from floquet.boundary.walk import EDGE_RESOLUTION, Edge, Walk
from floquet.kind import Kind
from periodic import AnyFamily

# Regions narrower than this part of Omega count as closed.
MIN_OPEN_WIDTH = 10 * EDGE_RESOLUTION
# How like that of the last station a pair must be to count as closed although other solutions grow at its place.
MIN_COVERED_LIKENESS = 0.8
# Growth in one period, in errors of log mu, below which a region counts as closed.
MIN_GROWTH_ERRORS = 10.0
# Growth without excitation, as part of the largest exponent, that is rounding.
FREE_GROWTH_ROUNDING = 1e-11
# How far a crowd is unstable by second-order effects: at most this part of its centre.
MAX_SECOND_ORDER_REACH = 0.1
# Second-order effects are known to this factor.
SECOND_ORDER_ROOM = 2.0
# A pair that was lost among states that second-order effects join, one by one, over more than this part of the centre
# cannot be told from all others.
MAX_CHAIN_REACH = 0.5
# A window of stability is looked for at least so far from its centre, as part of it.
MIN_WINDOW_REACH = 0.01


class Found(NamedTuple):
    """What there is at one amplitude.

    Attributes
    ----------
    kind : Kind
    intervals : list of (Edge, Edge)
        From left to right.
    growth_rate : float
        Of the solutions that resonate, where they grow most or decay least; NaN if it is not known.
    covered : bool
        Whether the place of a closed region lies in that of other solutions.
    """

    kind: Kind
    intervals: list[tuple[Edge, Edge]]
    growth_rate: float
    covered: bool = False


class Region:
    """The region of a resonance of two modes of one subsystem."""

    def __init__(self, family: AnyFamily, resonance: Resonance, modes: Modes) -> None:
        self.resonance, self.modes = resonance, modes
        solutions, centre = modes.solutions(resonance), resonance.centre
        self.integrator = Integrator(family, solutions[:, 0], centre / (2 * np.pi))
        member = family.at(centre)
        subsystem = home(free_subsystems(member, centre), solutions[:, 0])
        self.strength = strength_of(member, subsystem, centre)
        self.states: States = free_states(member, subsystem, centre)
        lock = (-1.0) ** resonance.j if resonance.p == resonance.q else None
        self.pair = Reference(solutions, lock, modes.decay(resonance))
        self.lost = np.inf  # the smallest eps at which the pair could not be told from others

    @cached_property
    def is_window(self) -> bool:
        """Whether the subsystem is unstable without excitation, so that a window of stability is traced."""
        exponents = self.states.exponents
        return bool(exponents.real.max() > FREE_GROWTH_ROUNDING * np.abs(exponents).max())

    @cached_property
    def follower(self) -> Follower:
        """The continuation of the pair in eps."""
        resonance = self.resonance
        sign = -1 if self.is_window else 1
        drift = drift_of(self.states, self.modes, resonance)
        return Follower(self.integrator, resonance.centre, resonance.j, self.pair, self.strength, sign, drift)

    def crowd(self, eps: float) -> Crowd:
        """Return the states that resonate together."""
        second_order = self._second_order(eps) if eps >= self.lost else 0.0
        return gather(self.states, self.modes, self.resonance, eps, second_order)

    def at(self, eps: float) -> Found:
        """Return what there is at an amplitude."""
        if eps == 0 or not any(self.strength.sizes):
            growth_rate = float(self.states.exponents[self.crowd(0.0).members].real.max())
            return Found(Kind.COMPLEX if self.is_window else Kind.STABLE, [], growth_rate)
        try:
            if self.is_window or len(self.crowd(eps).members) == 2:
                try:
                    return self._of_pair(eps, self.follower.top(eps))
                except OutOfReachError:
                    self.lost = min(self.lost, eps)
            if self.is_window:
                return self._window(eps)
            crowd = self.crowd(eps)
            chained = eps >= self.lost and crowd.reach > MAX_CHAIN_REACH * self.resonance.centre
            if len(crowd.members) == 2 or chained:
                raise OutOfReachError
            points = self._scan(eps, crowd)
            return self._intervals(eps, points, crowd.reach) if points else self._closed(eps)
        except OutOfReachError:
            return Found(Kind.UNDECIDED, [], np.nan)

    def _window(self, eps: float) -> Found:
        """Return the windows of stability round the centre, whatever makes them."""
        centre, reach = self.resonance.centre, max(self._second_order(eps), MIN_WINDOW_REACH)
        grid = centre * (1 + reach * np.linspace(-1, 1, SCAN_POINTS))
        points = [judge(self.integrator.at(Omega, eps), self.pair) for Omega in grid.tolist()]
        stable = [point for point in points if point.value <= 0]
        if stable:
            return self._intervals(eps, stable)
        middle = points[SCAN_POINTS // 2]
        return Found(middle.kind, [], float(middle.found.growth.max()) * centre / (2 * np.pi))

    def _second_order(self, eps: float) -> float:
        """Return the rate of second-order effects as part of the centre."""
        return min(self.strength.at(eps) ** 2 / self.resonance.j, MAX_SECOND_ORDER_REACH)

    def _of_pair(self, eps: float, top: Top) -> Found:
        point = top.point
        if self.is_window:
            return self._intervals(eps, [point]) if point.value <= 0 else Found(point.kind, [], point.growth_rate)
        if point.own > 0:
            if self.resonance.p != self.resonance.q and point.kind != Kind.COMPLEX:
                raise OutOfReachError  # one of the two modes resonates with itself instead
            return self._intervals(eps, [point])
        covered = point.value > 0 or bool(self.integrator.at(self.resonance.centre, eps).growth.max() > 0)
        told = top.likeness >= MIN_COVERED_LIKENESS
        return Found(Kind.STABLE if told or not covered else Kind.UNDECIDED, [], point.growth_rate, covered)

    def _scan(self, eps: float, crowd: Crowd) -> list[Point]:
        """Return points at which the crowd grows."""
        centre = self.resonance.centre
        reach = max(crowd.reach, SECOND_ORDER_ROOM * centre * self._second_order(eps))
        low, high = max(centre - reach, centre / 2), min(centre + reach, 2 * centre)
        return scan(self.integrator, eps, low, high, self.states.solutions[:, crowd.members], crowd.spread)

    def _closed(self, eps: float) -> Found:
        """Return that a crowd is closed, unless its place lies in another region."""
        growth = float(self.integrator.at(self.resonance.centre, eps).growth.max())
        rate = growth * self.resonance.centre / (2 * np.pi)
        return Found(Kind.UNDECIDED if growth > 0 else Kind.STABLE, [], rate)

    def _intervals(self, eps: float, points: list[Point], reach: float = 0.0) -> Found:
        """Return the intervals that some points lie in.

        Nearer to the centre than ``reach`` the pairs of a crowd may take over from each other: no other region does.
        """
        best = max(points, key=lambda point: abs(point.own))
        closed = Found(best.kind if self.is_window else Kind.STABLE, [], best.growth_rate)
        width = 2 * np.sqrt(abs(best.own)) / (np.pi * self.resonance.j)
        error = self.integrator.error(best.Omega, eps)
        shift = best.found.sensitivity[best.members].max() * error
        if width < MIN_OPEN_WIDTH or np.sqrt(abs(best.own)) < MIN_GROWTH_ERRORS * shift:
            return closed
        walk = Walk(self.integrator, eps, self.resonance.centre, self.resonance.j, error, self.is_window)
        found: list[tuple[Edge, Edge]] = []
        for point in points:
            if not found or point.Omega > found[-1][1].Omega:
                lower, upper = (self._own_edge(walk.edge(point, side), reach) for side in (-1, 1))
                if not upper.Omega - lower.Omega < MIN_OPEN_WIDTH * point.Omega:  # NaN where there is no edge
                    found.append((lower, upper))
                if np.isnan(upper.Omega):
                    break
        if not found:
            return closed
        return Found(Kind.STABLE if self.is_window else best.kind, found, best.growth_rate)

    def _own_edge(self, edge: Edge, reach: float) -> Edge:
        met_its_own = abs(edge.meeting - self.resonance.centre) <= reach
        return edge._replace(meeting=np.nan) if met_its_own and np.isfinite(edge.Omega) else edge
