"""The boundaries of one region of instability, by root-finding on the pair of multipliers that resonates."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations
from typing import NamedTuple

import numpy as np
import scipy.linalg as sla
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import brentq

from floquet.monodromy import member_at, period_map, propagate, steps_of_period
from floquet.multipliers import Kind
from floquet.reduction import Reduction, modulation, reduce_system
from floquet.resonance import Resonance, nearest_resonance
from periodic import PeriodicSystem, SystemFamily
from periodic.checks import FloatArray, real_array, real_number

ComplexArray = NDArray[np.complex128]

# Edges are found to this part of Omega; regions narrower than ten times that count as closed.
RESOLUTION = 1e-10
# Tolerance of the integration. The series cost little more than at 1e-11, and an edge is only as good as the
# multipliers.
TOLERANCE = 1e-13
# Mean decay of the pair in one period that is rounding.
LEAST_DAMPING = 1e-11
# Part of an eigenvector in the span of the two resonating solutions below which it is no longer one of them.
LEAST_PART = 0.5
# Parts that are as large as this compared with each other do not tell which eigenvector belongs to the pair.
COMPARABLE = 0.9
# Relative change of stiffness (norm of eps F in energy coordinates) between two stations of the continuation in eps.
STATION = 0.25
# Most points on the way to the middle of a region, and to bracket an edge. A parabola needs about 6 and 3.
MOST_TRIALS = 40
# What f may differ from zero by at an edge, compared with its value inside.
LARGEST_JUMP = 1e-3
# Part of a step by which to go aside where another multiplier passes through the pair.
ASIDE = 0.02
# An edge is looked for between these multiples of the frequency of resonance.
LOWEST, HIGHEST = 0.2, 5.0


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
    kind: NDArray[np.int8]

    @property
    def is_open(self) -> NDArray[np.bool_]:
        """Where the region exists, shape (k,)."""
        return self.kind > Kind.STABLE


class LostError(Exception):
    """The pair of multipliers can no longer be told from the others."""


class Point(NamedTuple):
    """The resonating pair at one Omega: test function, its error (NaN if not asked for), and solutions in (W', W)."""

    Omega: float
    value: float
    error: float
    multipliers: ComplexArray
    vectors: ComplexArray


def trace_boundary(family: SystemFamily, near: float, eps: ArrayLike) -> BoundaryTrace:
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
    The pair of multipliers mu_1, mu_2 is told from the others by its eigenvectors, which grow continuously out of the
    two modes at eps = 0. With a = log mu_1, b = log mu_2,

        Delta = ((a - b) / 2)^2,   p = - Re(a + b),

    are symmetric functions of the pair and therefore analytic in Omega where the two coalesce, unlike the multipliers
    themselves. By the criterion of Routh and Hurwitz for z^2 + p z + p^2/4 - Delta with complex Delta the pair is
    unstable if and only if

        f = Re Delta + (Im Delta / p)^2 - p^2 / 4 > 0;

    for conservative and reversible systems p = Im Delta = 0 and f = Re Delta is the square of the growth inside and
    minus the square of half the angle between the multipliers outside. Near a resonance f is nearly a parabola in
    Omega: its top is found by interpolation, however narrow the region, and its zeros by Brent's method.
    """
    near = real_number("near", near, positive=True)
    amplitudes = real_array("eps", np.atleast_1d(np.asarray(eps)), 1)
    if amplitudes.size == 0:
        raise ValueError("eps is empty; give at least one amplitude")
    if amplitudes.min() < 0:
        raise ValueError(f"eps has the entry {float(amplitudes.min())!r}; give amplitudes >= 0")
    resonance = nearest_resonance(member_at(family, near, "family"), near)
    route = _Route(family, resonance)
    found = [route.edges(float(amplitude)) for amplitude in amplitudes]
    kind = np.array([k for k, _ in found], dtype=np.int8)
    edges = np.array([e for _, e in found])
    for array in (amplitudes, kind, edges):
        array.setflags(write=False)
    lower, upper, lower_error, upper_error = edges.T
    return BoundaryTrace(near, resonance, amplitudes, lower, upper, lower_error, upper_error, kind)


class _Station(NamedTuple):
    """Where the continuation has been: the middle of the region at eps, and the pair there."""

    eps: float
    Omega: float
    vectors: ComplexArray


class _Route:
    """One region followed from eps = 0 upwards."""

    def __init__(self, family: SystemFamily, resonance: Resonance) -> None:
        self.family = family
        self.resonance = resonance
        blocks = reduce_system(family.at(resonance.centre), 1.0, resonance.centre / (2 * np.pi))
        first, second = (_home(blocks, vector) for vector in resonance.vectors.T)
        self.coupled = first is second
        self.latest: tuple[PeriodicSystem, float, Reduction] | None = None
        self.spacing = STATION / max(modulation(first.equations), np.finfo(float).tiny)
        self.stations = [_Station(0.0, resonance.centre, resonance.vectors)]

    def edges(self, eps: float) -> tuple[Kind, tuple[float, float, float, float]]:
        """Return the kind of the region at ``eps``, its edges and their errors."""
        closed = (np.nan, np.nan, np.nan, np.nan)
        if not self.coupled or eps == 0:
            return Kind.STABLE, closed
        try:
            self._advance(eps)
            station = max((s for s in self.stations if s.eps < eps), key=lambda s: s.eps)
            top = self._top(eps, station, exact=False)
            if top.value <= 0:
                return Kind.STABLE, closed
        except LostError:
            return Kind.UNDECIDED, closed
        lower, upper = (self._edge(eps, top, side) for side in (-1, 1))
        if upper - lower < 10 * RESOLUTION * top.Omega:
            return Kind.STABLE, closed
        lower_error, upper_error = self._error(eps, top, lower, upper), self._error(eps, top, upper, lower)
        return _kind(self._lock()), (lower, upper, lower_error, upper_error)

    def _advance(self, eps: float) -> None:
        """Add the stations below ``eps``. They lie on a fixed ladder: no result depends on what else was asked for."""
        while self.stations[-1].eps + self.spacing < eps:
            last = self.stations[-1]
            following = last.eps + self.spacing
            top = self._top(following, last, exact=True)
            self.stations.append(_Station(following, top.Omega, top.vectors))

    def _point(self, Omega: float, eps: float, reference: ComplexArray, checked: bool = False) -> Point:
        """Return the pair at one Omega: the eigenvectors that lie most in the span of ``reference`` (2n, 2)."""
        block = self._block(Omega, eps)
        error = np.nan
        if checked:
            found = period_map(block, Omega, eps, TOLERANCE)
            Phi, error = found.matrix, found.error
        else:
            Phi = propagate(block, Omega, eps, steps_of_period(block, Omega), TOLERANCE, np.eye(len(block.from_q)))
        mu, left, right = sla.eig(Phi, left=True, right=True)  # type: ignore[misc]  # the stubs know two results only
        span, _ = np.linalg.qr(block.from_q @ reference)
        inside = span.conj().T @ right
        pair = self._choose(mu, inside, 2 * np.pi / Omega)
        condition = 1 / np.abs(np.einsum("ij,ij->j", left[:, pair].conj(), right[:, pair]))
        relative = float(np.sum(condition / np.abs(mu[pair])) * error)
        value, error = _test(mu[pair], self._lock(), block.reciprocal, relative)
        return Point(Omega, value, error, mu[pair], block.to_q @ right[:, pair])

    def _point_or_aside(self, Omega: float, eps: float, reference: ComplexArray, shift: float) -> Point:
        """Return the pair at ``Omega``, or at ``Omega + shift`` if another multiplier happens to be too near."""
        try:
            return self._point(Omega, eps, reference)
        except LostError:
            return self._point(Omega + shift, eps, reference)

    def _choose(self, mu: ComplexArray, inside: ComplexArray, T: float) -> list[int]:
        """Return the two multipliers whose eigenvectors have large parts ``inside`` (2, count) the reference.

        More than two have if multipliers are equal or so close that their eigenvectors mix. Then, for two different
        modes, those that span the reference best; for a single mode, the one of its pairs nearest to instability: two
        conjugate multipliers, or two real ones whose product is that of the mode's decay.
        """
        part = np.linalg.norm(inside, axis=0)
        candidates = np.flatnonzero(part > max(LEAST_PART, COMPARABLE * np.sort(part)[-2])).tolist()
        lock, decay = self._lock(), self.resonance.decay * T

        def belong(pair: list[int]) -> bool:
            first, second = mu[pair]
            if first.imag or second.imag:
                return bool(first == second.conj())
            excess = abs(np.log(abs(first * second)) + decay)
            return bool(excess <= 0.5 * abs(np.log(abs(first / second))) + 0.1 * decay + LEAST_DAMPING)

        pairs = [list(pair) for pair in combinations(candidates, 2)]
        if lock is not None and len(pairs) > 1:
            pairs = [pair for pair in pairs if belong(pair)]
        if not pairs:
            raise LostError
        if lock is None:
            return max(pairs, key=lambda pair: abs(np.linalg.det(inside[:, pair])))
        return max(pairs, key=lambda pair: _test(mu[pair], lock, True, 0.0)[0])

    def _block(self, Omega: float, eps: float) -> Reduction:
        """Return the block of the pair; computed anew only if the system or eps has changed."""
        member = self.family.at(Omega)
        if self.latest is None or self.latest[0] is not member or self.latest[1] != eps:
            blocks = reduce_system(member, eps, self.resonance.centre / (2 * np.pi))
            self.latest = (member, eps, _home(blocks, self.resonance.vectors[:, 0]))
        return self.latest[2]

    def _lock(self) -> float | None:
        """Return the point of the unit circle at which the pair meets: fixed if both belong to one mode."""
        r = self.resonance
        return (-1.0) ** r.j if r.p == r.q else None

    def _top(self, eps: float, station: _Station, exact: bool) -> Point:
        """Return a point inside the region or, if it is closed, that of the largest test function.

        Parabolas through the three best points. With ``exact``, or where the region has not been hit, to a tenth of its
        half width.
        """
        start = self._predict(eps)
        relative = min(eps * STATION / self.spacing, 1.0)
        step = start * min(max(0.1 * relative**2, 1e-5), 0.02)
        points = [self._point(start, eps, station.vectors)]
        if points[0].value > 0 and not exact:
            return points[0]
        points += [self._point(start + sign * step, eps, station.vectors) for sign in (-1, 1)]
        previous = np.inf
        for _ in range(MOST_TRIALS):
            points.sort(key=lambda point: -point.value)
            best = points[0]
            if best.value > 0 and not exact:
                return best
            x, height, curvature = _parabola(points[:3])
            reach = 4 * max(abs(point.Omega - best.Omega) for point in points[1:3])
            if curvature >= 0:
                x = best.Omega + np.sign(best.Omega - points[2].Omega) * reach / 2
            x = min(max(x, best.Omega - reach), best.Omega + reach)
            half_width = np.sqrt(max(best.value, 0.0)) / self._scale(best.Omega)
            if abs(x - best.Omega) <= max(0.1 * half_width, RESOLUTION * best.Omega):
                break
            if curvature < 0 and height < 0 and abs(height - previous) < 0.01 * abs(height):
                break  # certainly closed
            previous = height
            points.append(self._point(x, eps, station.vectors))
        return points[0]

    def _predict(self, eps: float) -> float:
        """Extrapolate the middle of the region: it moves with eps^2."""
        stations = [s for s in self.stations if s.eps < eps][-2:]
        if len(stations) < 2:
            return stations[-1].Omega
        one, two = stations
        slope = (two.Omega - one.Omega) / (two.eps**2 - one.eps**2)
        return two.Omega + slope * (eps**2 - two.eps**2)

    def _scale(self, Omega: float) -> float:
        """Return d sqrt(-f) / d Omega far from the region: half of how fast the two multipliers turn apart."""
        return np.pi * self.resonance.j / Omega

    def _edge(self, eps: float, inside: Point, side: int) -> float:
        """Return the edge below (``side`` -1) or above (+1) a point inside; NaN if there is none or the pair is lost.

        Outwards from one point to the next, each time with the pair at the last point as reference, until f < 0.
        """
        a = inside
        step = 1.2 * np.sqrt(a.value) / self._scale(a.Omega)
        try:
            for _ in range(MOST_TRIALS):
                step = min(max(step, 10 * RESOLUTION * a.Omega), a.Omega / (8 * self.resonance.j))
                b = self._point_or_aside(a.Omega + side * step, eps, a.vectors, -side * ASIDE * step)
                if b.value <= 0:
                    return self._zero(eps, a, b)
                # where f falls, not much further than to the zero of the secant: beyond may be another region
                fall = (a.value - b.value) / step
                step = min(1.6 * step, 1.2 * b.value / fall) if fall > 0 else 1.6 * step
                a = b
                if not LOWEST < a.Omega / self.resonance.centre < HIGHEST:
                    break
        except LostError:
            pass
        return np.nan

    def _zero(self, eps: float, inside: Point, outside: Point) -> float:
        """Return the zero of f between two points."""
        values = {inside.Omega: inside.value, outside.Omega: outside.value}
        aside = ASIDE * (inside.Omega - outside.Omega)

        def value(Omega: float) -> float:
            if Omega not in values:
                values[Omega] = self._point_or_aside(Omega, eps, inside.vectors, aside).value
            return values[Omega]

        zero = float(brentq(value, inside.Omega, outside.Omega, xtol=RESOLUTION * inside.Omega))
        # as near to the zero as this, f is that part of its value inside, unless it changes sign by a jump
        nearness = 10 * RESOLUTION * zero / max(abs(zero - inside.Omega), RESOLUTION * zero)
        if min(map(abs, values.values())) > (LARGEST_JUMP + nearness) * inside.value:
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
            inside = self._point(edge + shift, eps, top.vectors, checked=True)
        except LostError:
            return np.inf
        return inside.error / abs(inside.value / shift) + RESOLUTION * edge


def _home(blocks: list[Reduction], vector: ComplexArray) -> Reduction:
    """Return the block that a solution belongs to."""
    return max(blocks, key=lambda block: float(np.linalg.norm(block.from_q @ vector)))


def _kind(lock: float | None) -> Kind:
    if lock is None:
        return Kind.COMPLEX
    return Kind.PLUS_ONE if lock > 0 else Kind.MINUS_ONE


def _test(mu: ComplexArray, lock: float | None, reciprocal: bool, relative_error: float) -> tuple[float, float]:
    """Return f of a pair of multipliers, positive if they are unstable, and its error (`trace_boundary`, Notes)."""
    difference = np.log(mu[0] / mu[1]) if lock is None else np.log(mu[0] / lock) - np.log(mu[1] / lock)
    Delta = complex((difference / 2) ** 2)
    error = abs(difference) / 2 * relative_error
    p = -float(np.log(np.abs(mu)).sum())
    if reciprocal or abs(p) < LEAST_DAMPING:
        return Delta.real, error
    if p < 0:  # growing already in the mean of the two
        return np.sqrt(Delta).real ** 2 + p**2 / 4, error - p / 2 * relative_error
    skew = Delta.imag / p
    error *= 1 + 2 * abs(skew) / p
    return Delta.real + skew**2 - p**2 / 4, error + (p / 2 + 2 * skew**2 / p) * relative_error


def _parabola(points: list[Point]) -> tuple[float, float, float]:
    """Return place, value and curvature of the extremum of the parabola through three points."""
    (x0, y0), (x1, y1), (x2, y2) = ((point.Omega, point.value) for point in points)
    first, second = (y1 - y0) / (x1 - x0), (y2 - y0) / (x2 - x0)
    curvature = (second - first) / (x2 - x1)
    slope = first - curvature * (x1 - x0)  # at x0
    if curvature == 0:
        return x0, y0, 0.0
    return x0 - slope / (2 * curvature), y0 - slope**2 / (4 * curvature), curvature
