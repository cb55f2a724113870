"""Where a boundary crosses the line between two neighbouring cells of a plane."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

from scipy.optimize import brentq, minimize_scalar

from floquet.kind import Kind
from floquet.plane.looking import Look

# A crossing is found to this part of the distance between two cells.
CROSSING_TOLERANCE = 1e-10
# So far to both sides, in the same unit, a crossing has to be between stable and unstable.
BESIDE_CROSSING = 1e-5
# Halvings that find a crossing of which no function tells.
CROSSING_HALVINGS = 34
# The lowest point of a function between two cells is looked for to this part of their distance.
LOWEST_TOLERANCE = 1e-6

# What a point of the line is like, from 0 to 1.
LookAlong = Callable[[float], Look]


class Crossing(NamedTuple):
    """A boundary at the part ``at`` of the way: of this kind of instability, which is ``ahead`` or behind."""

    at: float
    kind: Kind
    ahead: bool


def between(look: LookAlong, low: float, high: float) -> list[Crossing]:
    """Return the crossings between a point that is stable and one that is not, or between two kinds of instability.

    Two unstable kinds may have a narrow stable gap between them, or none.
    """
    start, end = look(low), look(high)
    if (start.kind > Kind.STABLE) != (end.kind > Kind.STABLE):
        return [_edge(look, low, high)]
    if start.kind == end.kind or start.kind == Kind.STABLE:
        return []
    leaving = _root(look, low, high, start.kind)
    entering = _root(look, low, high, end.kind)
    if leaving is None or entering is None or not leaving < entering:
        return []
    middle = (leaving + entering) / 2
    if look(middle).kind > Kind.STABLE:
        return []
    return [Crossing(leaving, start.kind, False), Crossing(entering, end.kind, True)]


def around(look: LookAlong, low: float, inside: float, high: float) -> list[Crossing]:
    """Return the two crossings of a region round ``inside`` between two stable places; none if that is stable."""
    if look(inside).kind <= Kind.STABLE:
        return []
    return [_edge(look, low, inside), _edge(look, inside, high)]


def within(look: LookAlong, places: Sequence[float], kind: Kind) -> list[Crossing]:
    """Return the two crossings of a region of ``kind`` between some places that are stable; none if there is none.

    It is looked for where the function of its edge is lowest. That of many states has many low points, of which it is
    found only by chance.
    """
    values = [look(at).of(kind) for at in places]
    for which in range(len(values[0])):
        lowest = min(range(len(places)), key=lambda k: values[k][which])
        if not 0 < lowest < len(places) - 1:
            continue
        value = _function(look, kind, which)
        bracket = places[lowest - 1], places[lowest], places[lowest + 1]
        if not value(bracket[0]) > value(bracket[1]) < value(bracket[2]):
            continue
        found = minimize_scalar(value, bracket=bracket, method="brent", options={"xtol": LOWEST_TOLERANCE})
        if crossings := around(look, bracket[0], float(found.x), bracket[2]):
            return crossings
    return []


def _function(look: LookAlong, kind: Kind, which: int) -> Callable[[float], float]:
    """Return one of the functions of an edge along the line."""
    return lambda at: look(at).of(kind)[which]


def _edge(look: LookAlong, low: float, high: float) -> Crossing:
    """Return the crossing between a stable and an unstable point: by a function, or else by halving."""
    ahead = look(high).kind > Kind.STABLE
    kind = look(high if ahead else low).kind
    at = _root(look, low, high, kind)
    if at is not None:
        beside = min(BESIDE_CROSSING, (at - low) / 2, (high - at) / 2)
        before, after = look(at - beside).kind, look(at + beside).kind
        inside, outside = (after, before) if ahead else (before, after)
        if inside == kind and outside == Kind.STABLE:
            return Crossing(at, kind, ahead)
    for _ in range(CROSSING_HALVINGS):
        middle = (low + high) / 2
        here = look(middle).kind
        kind = here if here > Kind.STABLE else kind
        if (here > Kind.STABLE) == ahead:
            high = middle
        else:
            low = middle
    return Crossing((low + high) / 2, kind, ahead)


def _root(look: LookAlong, low: float, high: float, kind: Kind) -> float | None:
    """Return where a function of an edge of ``kind`` changes its sign; None if none does between these points."""
    ends = zip(look(low).of(kind), look(high).of(kind), strict=True)
    for which, (start, end) in enumerate(ends):
        if start == 0:
            return low
        if start * end < 0:
            return float(brentq(_function(look, kind, which), low, high, xtol=CROSSING_TOLERANCE))
    return None
