"""The boundaries of one region of instability, by root-finding on the pair of multipliers that resonates."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import brentq

from floquet.boundary.pair import LostError, Pair, Point
from floquet.boundary.resonance import (
    MAX_ORDER,
    ORDERS,
    SIGNS,
    Modes,
    Resonance,
    natural_modes,
    nearest_resonance,
)
from floquet.kind import Kind
from floquet.oracle import is_unstable
from periodic import SystemFamily, member_at
from periodic.checks import ComplexArray, FloatArray, one_of, real_array, real_number, whole_number

# Edges are found to this part of Omega; regions narrower than ten times that count as closed.
EDGE_RESOLUTION = 1e-10
# Relative change of stiffness (norm of eps F in energy coordinates) between two stations of the continuation in eps for
# a resonance with j = 1, and how many there may be: a hundred times the stiffness is far beyond any separate region.
# With larger j regions are closer together, about in proportion.
STIFFNESS_CHANGE_PER_STATION = 0.25
MAX_STATIONS = 400
# Most points on the way to the middle of a region, and to bracket an edge. A parabola needs about 6 and 3.
MAX_SEARCH_POINTS = 40
# How like the two modes the pair must still be (cosine of the angle) for what is found to count as their region, and
# for nothing found to count as their region closed.
MIN_LIKENESS_OPEN, MIN_LIKENESS_CLOSED = 0.5, 0.8
# What f may differ from zero by at an edge, compared with its value inside.
MAX_RELATIVE_JUMP = 1e-6
# Where the pair is lost, the next step is this part of the last, a few times.
STEP_FACTOR_AFTER_LOSS, MAX_LOSSES = 0.25, 3
# A zero of a smooth f takes about 8 iterations, a jump 30.
MAX_BRENT_ITERATIONS = 20
# An edge is looked for between these multiples of the frequency of resonance.
MIN_SEARCH_FACTOR, MAX_SEARCH_FACTOR = 0.2, 5.0


@dataclass(frozen=True, eq=False)
class BoundaryTrace:
    """The two edges of one region of instability at k values of eps.

    Attributes
    ----------
    near : float
        The frequency the region was asked for by.
    resonance : Resonance
        The resonance that the region starts from at eps = 0.
    eps : ndarray, shape (k,)
        Excitation amplitudes, in the order given.
    lower, upper : ndarray, shape (k,)
        Edges in Omega; NaN where the region is closed or cannot be followed, or on the side on which it has no edge.
    lower_error, upper_error : ndarray, shape (k,)
        Estimated errors of the edges; NaN where they are.
    lower_meeting, upper_meeting : ndarray, shape (k,)
        Where an open region has no edge on that side because it has merged with another one, the Omega at which the
        other one takes over: the last at which the pair of multipliers could be told from others; beyond, the system is
        unstable. NaN elsewhere.
    kind : ndarray of int8, shape (k,)
        `Kind` of the instability; STABLE where the region is closed, UNDECIDED where the pair of multipliers has mixed
        with others so much that it cannot be told from them (regions that have merged).
    """

    near: float
    resonance: Resonance
    eps: FloatArray
    lower: FloatArray
    upper: FloatArray
    lower_error: FloatArray
    upper_error: FloatArray
    lower_meeting: FloatArray
    upper_meeting: FloatArray
    kind: NDArray[np.int8]

    @property
    def is_open(self) -> NDArray[np.bool_]:
        """Where the region exists, shape (k,)."""
        return self.kind > Kind.STABLE


def trace_boundary(
    family: SystemFamily, near: float, eps: ArrayLike, *, type: str | None = None, j: int | None = None
) -> BoundaryTrace:
    """Find the edges of the region of instability that starts at a resonance.

    Parameters
    ----------
    family : PeriodicSystem or SystemFamily
        The system. Only the excitation may depend on Omega.
    near : float
        Frequency of resonance, (omega_p ± omega_q) / j at eps = 0, or a guess within 5 %. Of several resonances the
        nearest is taken, with preference for low j and for sums.
    eps : array_like, shape (k,), or float
        Excitation amplitudes >= 0, in any order. What is found at one does not depend on the others.
    type : "sum" or "difference", optional
        Of the resonance, if only such are meant.
    j : int, optional
        Its order, if only that one is meant.

    Returns
    -------
    BoundaryTrace

    Raises
    ------
    ValueError
        If an argument is of the wrong type or shape, not finite, out of range or empty, or if ``near`` is near no
        resonance.

    Notes
    -----
    The pair of multipliers that resonates is told from the others by its eigenvectors, which grow continuously out of
    two modes at eps = 0, and judged by a test function f that is analytic in Omega where the two coalesce, positive
    inside the region and negative outside (`floquet.boundary.pair.instability`). Near a resonance f is nearly a
    parabola: its top is found by interpolation, however narrow the region, and its zeros by Brent's method.

    The edges are those of the pair: beyond them another one may still be unstable. Where regions have merged the edge
    between them is missing, and ``lower_meeting`` or ``upper_meeting`` says where. An undamped system that is neither
    conservative nor reversible may grow outside its resonances, if slowly (of order eps^2), and then its regions have
    no edges.
    """
    near = real_number("near", near, positive=True)
    amplitudes = real_array("eps", eps if isinstance(eps, list | tuple) else np.atleast_1d(eps), 1)
    if amplitudes.size == 0:
        raise ValueError("eps is empty; give at least one amplitude")
    if amplitudes.min() < 0:
        raise ValueError(f"eps has the entry {float(amplitudes.min())!r}; give amplitudes >= 0")
    types = SIGNS if type is None else (one_of("type", type, tuple(SIGNS)),)
    orders = ORDERS if j is None else (whole_number("j", j, least=1, most=MAX_ORDER),)
    modes = natural_modes(member_at(family, near, "family"), near)
    resonance = nearest_resonance(modes, near, types, orders)
    route = _Route(family, resonance, modes)
    if amplitudes.max() > MAX_STATIONS * route.spacing:
        raise ValueError(
            f"eps has the entry {float(amplitudes.max())!r}, which changes the stiffness by a factor of "
            f"{amplitudes.max() * route.pair.strength:.3g}; give amplitudes below {MAX_STATIONS * route.spacing:.3g}"
        )
    found = [route.edges(float(amplitude)) for amplitude in amplitudes]
    verdicts = np.array([k for k, _, _ in found], dtype=np.int8)
    edges = np.array([[edge.Omega for edge in sides] for _, sides, _ in found])
    meetings = np.array([[edge.meeting for edge in sides] for _, sides, _ in found])
    errors = np.array([e for _, _, e in found])
    for array in (amplitudes, verdicts, edges, meetings, errors):
        array.setflags(write=False)
    (lower, upper), (lower_error, upper_error), (left, right) = edges.T, errors.T, meetings.T
    return BoundaryTrace(near, resonance, amplitudes, lower, upper, lower_error, upper_error, left, right, verdicts)


class _Station(NamedTuple):
    """Where the continuation has been: the middle of the region at eps, and the two solutions there."""

    eps: float
    Omega: float
    solutions: ComplexArray


class _Edge(NamedTuple):
    """One edge, or the place at which a region that has merged with this one takes over; NaN for what there is not."""

    Omega: float = np.nan
    meeting: float = np.nan


NO_EDGE = _Edge()


class _Route:
    """One region followed from eps = 0 upwards."""

    def __init__(self, family: SystemFamily, resonance: Resonance, modes: Modes) -> None:
        self.family = family
        self.resonance = resonance
        self.pair = Pair(family, resonance, modes)
        self.spacing = STIFFNESS_CHANGE_PER_STATION / resonance.j / self.pair.strength if self.pair.strength else np.inf
        self.stations = [_Station(0.0, resonance.centre, self.pair.solutions)]

    def edges(self, eps: float) -> tuple[Kind, tuple[_Edge, _Edge], tuple[float, float]]:
        """Return the kind of the region at ``eps``, its edges and their errors."""
        none, closed = (np.nan, np.nan), (NO_EDGE, NO_EDGE)
        if not self.pair.coupled or eps == 0:
            return Kind.STABLE, closed, none
        try:
            self._advance(eps)
            expected, top = self._top(eps, exact=False)
        except LostError:
            return Kind.UNDECIDED, closed, none
        likeness = min(self.pair.likeness(point, eps) for point in (expected, top))
        if likeness < (MIN_LIKENESS_OPEN if top.value > 0 else MIN_LIKENESS_CLOSED):
            return Kind.UNDECIDED, closed, none
        if top.value <= 0:
            return Kind.STABLE, closed, none
        lower, upper = (self._edge(eps, top, side) for side in (-1, 1))
        if upper.Omega - lower.Omega < 10 * EDGE_RESOLUTION * top.Omega:
            return Kind.STABLE, closed, none
        errors = self._error(eps, top, lower.Omega, upper.Omega), self._error(eps, top, upper.Omega, lower.Omega)
        return _kind(top.multipliers), (lower, upper), errors

    def _advance(self, eps: float) -> None:
        """Add the stations below ``eps``. They lie on a fixed ladder: no result depends on what else was asked for."""
        while self.stations[-1].eps + self.spacing < eps:
            following = self.stations[-1].eps + self.spacing
            _, top = self._top(following, exact=True)
            self.stations.append(_Station(following, top.Omega, top.solutions))

    def _top(self, eps: float, exact: bool) -> tuple[Point, Point]:
        """Return where the region is expected, and a point inside it or, if it is closed, that of the largest f.

        Parabolas through the three best points. With ``exact``, or where the region has not been hit, to a tenth of its
        half width.
        """
        start, reference = self._predict(eps)
        # the middle of the region moves with eps^2
        step = start * min(max(0.1 * (eps * self.pair.strength) ** 2, 1e-5), 0.02)
        expected = self.pair.at(start, eps, reference)
        if expected.value > 0 and not exact:
            return expected, expected
        points = [expected]
        points += [self.pair.at(start + sign * step, eps, reference) for sign in (-1, 1)]
        previous = np.inf
        for _ in range(MAX_SEARCH_POINTS):
            points.sort(key=lambda point: -point.value)
            best = points[0]
            if best.value > 0 and not exact:
                return expected, best
            x, height, curvature = _parabola(points[:3])
            reach = 4 * max(abs(point.Omega - best.Omega) for point in points[1:3])
            if curvature >= 0:
                x = best.Omega + np.sign(best.Omega - points[2].Omega) * reach / 2
            x = min(max(x, best.Omega - reach), best.Omega + reach)
            half_width = np.sqrt(max(best.value, 0.0)) / self._scale(best.Omega)
            if abs(x - best.Omega) <= max(0.1 * half_width, EDGE_RESOLUTION * best.Omega):
                break
            certainly_closed = curvature < 0 and height < 0 and abs(height - previous) < 0.01 * abs(height)
            if certainly_closed or any(x == point.Omega for point in points):
                break
            previous = height
            points.append(self.pair.at(x, eps, reference))
        return expected, points[0]

    def _predict(self, eps: float) -> tuple[float, ComplexArray]:
        """Return where the middle of the region must be, to second order in eps, and the last solutions below."""
        stations = [station for station in self.stations if station.eps < eps][-2:]
        last = stations[-1]
        if len(stations) < 2:
            return last.Omega, last.solutions
        slope = (last.Omega - stations[0].Omega) / (last.eps**2 - stations[0].eps ** 2)
        return last.Omega + slope * (eps**2 - last.eps**2), last.solutions

    def _scale(self, Omega: float) -> float:
        """Return d sqrt(-f) / d Omega far from the region: half of how fast the two multipliers turn apart."""
        return np.pi * self.resonance.j / Omega

    def _edge(self, eps: float, inside: Point, side: int) -> _Edge:
        """Return the edge below (``side`` -1) or above (+1) a point inside.

        Outwards from one point to the next, each time with the pair at the last point as reference, until f < 0. Where
        the pair is lost on the way, or what is found beyond is not the same pair, in shorter steps.
        """
        a, beyond, losses = inside, np.nan, 0
        step, most = 1.2 * np.sqrt(a.value) / self._scale(a.Omega), np.inf
        for _ in range(MAX_SEARCH_POINTS):
            if not MIN_SEARCH_FACTOR < a.Omega / self.resonance.centre < MAX_SEARCH_FACTOR:
                return NO_EDGE
            if losses > MAX_LOSSES:
                break
            step = min(max(step, 10 * EDGE_RESOLUTION * a.Omega), a.Omega / (8 * self.resonance.j), most)
            try:
                b = self.pair.at(a.Omega + side * step, eps, a.solutions)
                if b.value <= 0:
                    return _Edge(self._zero(eps, a, b))
            except LostError:
                beyond, losses = a.Omega + side * step, losses + 1
                most = STEP_FACTOR_AFTER_LOSS * step
                continue
            # where f falls, not much further than to the zero of the secant: beyond may be another region
            fall = (a.value - b.value) / step
            step = min(1.6 * step, 1.2 * b.value / fall) if fall > 0 else 1.6 * step
            most = most if np.isnan(beyond) else abs(beyond - b.Omega) / 2
            a = b
        merged = losses > 0 and is_unstable(self.family, beyond, eps)
        return _Edge(meeting=a.Omega) if merged else NO_EDGE

    def _zero(self, eps: float, inside: Point, outside: Point) -> float:
        """Return the zero of f between two points."""
        values = {inside.Omega: inside.value, outside.Omega: outside.value}

        def value(Omega: float) -> float:
            if Omega not in values:
                values[Omega] = self.pair.at(Omega, eps, inside.solutions).value
            return values[Omega]

        try:
            zero = float(
                brentq(
                    value,
                    inside.Omega,
                    outside.Omega,
                    xtol=EDGE_RESOLUTION * inside.Omega,
                    maxiter=MAX_BRENT_ITERATIONS,
                )
            )
        except RuntimeError:  # nothing but halving: a jump
            raise LostError from None
        # f must vanish on both sides of the zero; where it jumps, another pair has taken over
        nearness = 10 * EDGE_RESOLUTION * zero / max(abs(zero - inside.Omega), EDGE_RESOLUTION * zero)
        jumps = min(map(abs, values.values())) > (MAX_RELATIVE_JUMP + nearness) * inside.value
        if jumps or value(zero + 1e-3 * (inside.Omega - zero)) > 0.1 * inside.value:
            raise LostError
        return zero

    def _error(self, eps: float, top: Point, edge: float, opposite: float) -> float:
        """Return the error of an edge: that of the test function over its slope.

        Both are taken a little inside the region. At the edge itself the two multipliers coalesce, and their condition
        numbers are infinite although the test function is as good there as anywhere.
        """
        if np.isnan(edge):
            return np.nan
        shift = 0.05 * ((top.Omega if np.isnan(opposite) else opposite) - edge)
        try:
            inside = self.pair.at(edge + shift, eps, top.solutions, with_error=True)
        except LostError:
            return np.inf
        return inside.error / abs(inside.value / shift) + EDGE_RESOLUTION * edge


def _kind(multipliers: ComplexArray) -> Kind:
    """Return how an unstable pair is unstable. Real multipliers of a real matrix are exactly real."""
    if multipliers.imag.any():
        return Kind.COMPLEX
    return Kind.PLUS_ONE if multipliers[0].real > 0 else Kind.MINUS_ONE


def _parabola(points: list[Point]) -> tuple[float, float, float]:
    """Return place, value and curvature of the extremum of the parabola through three points."""
    (x0, y0), (x1, y1), (x2, y2) = ((point.Omega, point.value) for point in points)
    first, second = (y1 - y0) / (x1 - x0), (y2 - y0) / (x2 - x0)
    curvature = (second - first) / (x2 - x1)
    slope = first - curvature * (x1 - x0)  # at x0
    if curvature == 0:
        return x0, y0, 0.0
    return x0 - slope / (2 * curvature), y0 - slope**2 / (4 * curvature), curvature
