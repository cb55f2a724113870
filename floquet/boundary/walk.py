"""From a point inside a region to its two edges at one amplitude, past no gap and across no other region unseen."""

from __future__ import annotations

from typing import NamedTuple, TypeGuard

import numpy as np
from scipy.optimize import brentq

from floquet.boundary.pair import Point, Reference, growing, judge
from floquet.boundary.solutions import Integrator, OutOfReachError

# Edges are found to this part of Omega.
EDGE_RESOLUTION = 1e-10
# The same of systems that are integrated exactly: those that are constant between jumps.
EXACT_RESOLUTION = 1e-13
# At this part of Omega beyond an edge it is checked that the subsystem is stable; gaps of half the width are no gaps.
GAP_RESOLUTION = 1e-6
# The pair of the next point must be at least so like that of the last (cosine of the largest angle between them).
MIN_STEP_LIKENESS = 0.95
# An edge is looked for between these multiples of the centre of the resonance.
MIN_SEARCH_FACTOR, MAX_SEARCH_FACTOR = 0.5, 5.0
# Steps: the first as part of the expected distance of the edge, the growth from one to the next, and the longest as
# part of the distance Omega / j between a resonance and the next one of the same modes.
FIRST_STEP, STEP_GROWTH, MAX_STEP = 1.2, 1.6, 0.125
# The slope of the test function at an edge is measured at about this part of the distance to the last point inside: at
# the edge itself the condition numbers of the two solutions are infinite.
SLOPE_DISTANCE = 0.05
# The first step of another region's pair, which turns fast at first, as part of the way to the meeting.
STEP_BEYOND_MEETING = 0.01
# Steps, as part of Omega, in which the end of instability is looked for where pairs turn too fast to be followed.
BLIND_STEP = 2e-3
# Most steps to an edge, halvings included; three are usual, and twenty where a region has merged with the next.
MAX_EDGE_STEPS = 200


class Edge(NamedTuple):
    """One end of an interval, or NaN where there is none, its error, and where another region has taken over."""

    Omega: float = np.nan
    error: float = np.nan
    meeting: float = np.nan


class Unreachable(NamedTuple):
    """A point at which nothing can be integrated: it counts as unstable."""

    Omega: float


class Walk:
    """The way along Omega, at one amplitude and in one subsystem.

    Parameters
    ----------
    integrator : Integrator
    eps : float
    centre : float
        Of the resonance, in whose neighbourhood the search stays.
    j : int
        Its order.
    error : float
        Error of the monodromy matrix near by.
    is_window : bool
        Whether a window of stability is meant, which ends where the subsystem is unstable.
    """

    def __init__(
        self, integrator: Integrator, eps: float, centre: float, j: int, error: float, is_window: bool
    ) -> None:
        self.integrator, self.eps, self.error, self.is_window = integrator, eps, error, is_window
        self.centre, self.j = centre, j
        self.resolution = EXACT_RESOLUTION if integrator.is_exact(centre, eps) else EDGE_RESOLUTION

    def edge(self, inside: Point, side: int) -> Edge:
        """Return the edge below (``side`` -1) or above (+1) a point inside.

        From one point inside to the next; where the next is not of the same region as far as its pair can tell, halving
        the step between the two until a gap is found, or none can be.
        """
        a, meeting = inside, np.nan
        b: Point | Unreachable | None = None
        step = FIRST_STEP * np.sqrt(abs(a.value)) * a.Omega / (np.pi * self.j)
        for _ in range(MAX_EDGE_STEPS):
            if not MIN_SEARCH_FACTOR < a.Omega / self.centre < MAX_SEARCH_FACTOR:
                break
            if b is None:
                step = min(max(step, 10 * EDGE_RESOLUTION * a.Omega), MAX_STEP * a.Omega / self.j)
                b = self._point(a.Omega + side * step, a.reference)
            if self._continues(b, a):
                step = self._next_step(a, b)
                a, b = b, None
                continue
            if not self._is_inside(b):
                zero, points = self._zero(a, b)
                strangers = [point for point in points if point is not a and not self._continues(point, a)]
                if strangers:
                    b = strangers[0]
                    continue
                beyond = self._point(zero + side * GAP_RESOLUTION * zero, a.reference)
                if not self._is_inside(beyond):
                    return Edge(zero, self._edge_error(points, zero), meeting)
                a, b = points[0], beyond
            elif abs(b.Omega - a.Omega) > GAP_RESOLUTION * a.Omega / 2:
                middle = self._point((a.Omega + b.Omega) / 2, a.reference)
                if self._continues(middle, a):
                    a, b = middle, judge(b.found, middle.reference) if isinstance(b, Point) else b
                else:
                    b = middle
                continue
            meeting = a.Omega if np.isnan(meeting) else meeting
            step = STEP_BEYOND_MEETING * abs(a.Omega - inside.Omega)
            if isinstance(b, Unreachable):
                break
            a, b = b if self.is_window else judge(b.found, growing(b.found)), None
        else:
            return self._end_of_growth(a, side, meeting)
        return Edge(meeting=meeting)

    def _end_of_growth(self, a: Point, side: int, meeting: float) -> Edge:
        """Return the first edge in steps of `BLIND_STEP` where no pair can be followed from a point inside."""
        while MIN_SEARCH_FACTOR < a.Omega / self.centre < MAX_SEARCH_FACTOR:
            b = self._point(a.Omega * (1 + side * BLIND_STEP), a.reference)
            if not self._is_inside(b):
                zero, points = self._zero(a, b)
                return Edge(zero, self._edge_error(points, zero), meeting)
            if isinstance(b, Unreachable):
                break
            a = b if self.is_window else judge(b.found, growing(b.found))
        return Edge(meeting=meeting)

    def _next_step(self, a: Point, b: Point) -> float:
        """Return the step after that from ``a`` to ``b``.

        Where the test function falls, not much further than to the zero of the secant: beyond may be another region.
        """
        way = abs(b.Omega - a.Omega)
        fall = (abs(a.value) - abs(b.value)) / way
        return float(min(STEP_GROWTH * way, FIRST_STEP * abs(b.value) / fall) if fall > 0 else STEP_GROWTH * way)

    def _zero(self, inside: Point, outside: Point | Unreachable) -> tuple[float, list[Point]]:
        """Return a zero of the test function between two points, and the points inside, the nearest to it first.

        Where the function is a parabola with a top of the height h, sqrt(h - f) is linear, and so found at once.
        """
        points = {inside.Omega: inside, outside.Omega: outside}
        top = self._top_height(inside, outside)

        def value(Omega: float) -> float:
            if Omega not in points:
                points[Omega] = self._point(Omega, inside.reference)
            point = points[Omega]
            f = point.value if isinstance(point, Point) else 1.0
            return f if np.isinf(top) else float(np.sqrt(top) - np.sqrt(max(top - f, 0.0)))

        zero = float(brentq(value, inside.Omega, outside.Omega, xtol=self.resolution * inside.Omega))
        within = [point for point in points.values() if isinstance(point, Point) and self._is_inside(point)]
        return zero, sorted(within, key=lambda point: abs(point.Omega - zero))

    def _top_height(self, inside: Point, outside: Point | Unreachable) -> float:
        """Return the height of the parabola through two points whose sides are as steep as those of a resonance."""
        if self.is_window or isinstance(outside, Unreachable):
            return np.inf
        way = outside.Omega - inside.Omega
        steepness = (np.pi * self.j / inside.Omega) ** 2
        slope = (outside.value - inside.value) / way + steepness * way
        return float(inside.value + slope**2 / (4 * steepness))

    def _edge_error(self, points: list[Point], edge: float) -> float:
        """Return the error of an edge, given points inside: that of the test function over its slope."""
        far = max(abs(points[-1].Omega - edge), self.resolution * edge)

        def fitness(point: Point) -> float:
            return float(abs(np.log(max(abs(point.Omega - edge) / far, self.resolution) / SLOPE_DISTANCE)))

        point = min(points, key=fitness)
        measured = point._replace(found=point.found._replace(error=self.error))
        return measured.error * abs(point.Omega - edge) / abs(point.own) + self.resolution * edge

    def _point(self, Omega: float, reference: Reference) -> Point | Unreachable:
        try:
            return judge(self.integrator.at(Omega, self.eps), reference)
        except OutOfReachError:
            return Unreachable(Omega)

    def _is_inside(self, point: Point | Unreachable) -> bool:
        """Whether a point belongs to what is traced; what cannot be reached is unstable."""
        return self.is_window != (isinstance(point, Unreachable) or point.value > 0)

    def _continues(self, b: Point | Unreachable, a: Point) -> TypeGuard[Point]:
        """Whether ``b`` belongs to the same region as ``a``, as far as the pair can tell."""
        if isinstance(b, Unreachable) or not self._is_inside(b):
            return False
        return self.is_window or (b.own > 0 and b.kind == a.kind and b.likeness >= MIN_STEP_LIKENESS)
