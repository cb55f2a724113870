"""One resonance followed from eps = 0 upwards: where its region must be at an amplitude, and a point inside."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from floquet.boundary.forcing import Strength
from floquet.boundary.hill import Height, climb
from floquet.boundary.pair import Point, Reference, judge
from floquet.boundary.solutions import Integrator, OutOfReachError
from floquet.boundary.walk import EDGE_RESOLUTION, MAX_SEARCH_FACTOR, MIN_SEARCH_FACTOR

# Relative change of stiffness (norm of eps F in energy coordinates) between two stations of the continuation in eps,
# for a resonance with j = 1. With larger j regions are closer together, about in proportion.
STIFFNESS_CHANGE_PER_STATION = 0.25
# A pair that is less like that of the last station (cosine of the largest angle) is followed in half the step, so
# often.
MIN_STATION_LIKENESS, MAX_HALVINGS = 0.8, 3
# One that is even then less like it than this is lost.
MIN_PAIR_LIKENESS = 0.5
# First step on the way to the top as part of Omega: this factor times the square of the relative change of stiffness,
# with which the centreline bends, between two bounds.
BEND, MIN_TOP_STEP, MAX_TOP_STEP = 0.1, 1e-5, 0.02
# The top is found to this part of the half width.
TOP_TOLERANCE = 0.1


class Station(NamedTuple):
    """Where the continuation has been: the top of the test function at eps, and the pair there."""

    eps: float
    Omega: float
    reference: Reference


class Top(NamedTuple):
    """Where the region of a pair was expected, a point inside or, if it is closed, the top of its test function, and
    how like that of eps = 0 or the last station the pair is."""

    expected: Point
    point: Point

    @property
    def likeness(self) -> float:
        """The less of the two."""
        return min(self.expected.likeness, self.point.likeness)


class Follower:
    """The continuation of a pair in eps.

    Parameters
    ----------
    integrator : Integrator
    centre, j : float, int
        Of the resonance.
    reference : Reference
        The two modes.
    strength : Strength
        Of the excitation.
    sign : {1, -1}
        -1 if a window of stability is looked for.
    drift : float
        d Omega / d eps of the centreline at eps = 0.
    """

    def __init__(
        self,
        integrator: Integrator,
        centre: float,
        j: int,
        reference: Reference,
        strength: Strength,
        sign: int,
        drift: float,
    ) -> None:
        self.integrator, self.j, self.strength, self.sign, self.drift = integrator, j, strength, sign, drift
        self.within = MIN_SEARCH_FACTOR * centre, MAX_SEARCH_FACTOR * centre
        self.stations = [Station(0.0, centre, reference)]
        self.lost = np.inf  # the eps of the station at which the pair could not be told from others

    def top(self, eps: float) -> Top:
        """Return a point inside the region, or the top of the test function.

        Raises
        ------
        OutOfReachError
            If the pair is lost on the way, or nothing can be integrated there.
        """
        while (following := self.after(self.stations[-1].eps, 1)) < eps < self.lost:
            try:
                way = self._way(self.stations, following, MAX_HALVINGS)
                self.stations.append(self._station(way, following))
            except OutOfReachError:
                self.lost = following
        if eps >= self.lost:
            raise OutOfReachError
        way = self._way(self.stations, eps, MAX_HALVINGS)
        return self._top(way, eps, exact=False)

    def after(self, eps: float, stations: int) -> float:
        """Return the amplitude that is so many stations above another one."""
        return self.strength.after(eps, stations * (STIFFNESS_CHANGE_PER_STATION / self.j))

    def _way(self, stations: list[Station], eps: float, halvings: int) -> list[Station]:
        """Return stations from the last of which the pair at ``eps`` can be told, in smaller steps if need be."""
        likeness = self._top(stations, eps, exact=False).likeness
        if halvings and likeness < MIN_STATION_LIKENESS:
            middle = (stations[-1].eps + eps) / 2
            way = self._way(stations, middle, halvings - 1)
            return self._way([*way, self._station(way, middle)], eps, halvings - 1)
        if likeness < MIN_PAIR_LIKENESS:
            raise OutOfReachError
        return stations

    def _station(self, stations: list[Station], eps: float) -> Station:
        point = self._top(stations, eps, exact=True).point
        return Station(eps, point.Omega, point.reference)

    def _top(self, stations: list[Station], eps: float, exact: bool) -> Top:
        """Return the top from the last of some ``stations``.

        Parabolas through the three best points. With ``exact``, or where the region has not been hit, to a tenth of its
        half width.
        """
        start, reference = self._predict(stations, eps)
        self._check_within(start)
        bend = BEND * self.strength.at(eps) ** 2
        step = start * min(max(bend, MIN_TOP_STEP), MAX_TOP_STEP)
        expected = self._point(start, eps, reference)
        if self._height(expected) > 0 and not exact:
            return Top(expected, expected)

        def value(Omega: float) -> float:
            return self._height(self._point(Omega, eps, reference))

        def enough(best: Height, way: float) -> bool:
            return not exact or way <= TOP_TOLERANCE * np.sqrt(best.value) * best.Omega / (np.pi * self.j)

        around = [start, start - step, start + step]
        best = climb([Height(x, value(x)) for x in around], value, EDGE_RESOLUTION * start, self.within, enough)
        self._check_within(best.Omega)
        return Top(expected, self._point(best.Omega, eps, reference))

    def _check_within(self, Omega: float) -> None:
        """A function that still rises where the search ends has no top that belongs to this resonance."""
        if not self.within[0] < Omega < self.within[1]:
            raise OutOfReachError

    def _predict(self, stations: list[Station], eps: float) -> tuple[float, Reference]:
        """Return where the top must be, to second order in eps, and the pair at the last station."""
        below = [station for station in stations if station.eps < eps][-2:]
        last = below[-1]
        there = last.Omega + self.drift * (eps - last.eps)
        if len(below) < 2:
            return there, last.reference
        bend = last.Omega - below[0].Omega - self.drift * (last.eps - below[0].eps)
        return there + bend / (last.eps**2 - below[0].eps ** 2) * (eps**2 - last.eps**2), last.reference

    def _point(self, Omega: float, eps: float, reference: Reference) -> Point:
        return judge(self.integrator.at(Omega, eps), reference)

    def _height(self, point: Point) -> float:
        return self.sign * point.own
