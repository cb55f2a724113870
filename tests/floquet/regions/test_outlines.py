"""Intervals of columns joined to closed polylines."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from floquet import Kind, Region
from floquet.regions.outlines import Interval, _apex, area, components, links, loops


def test_intervals_that_are_connected_are_one_component() -> None:
    rng = np.random.default_rng(0)
    for _ in range(200):
        # columns of up to 6 intervals: trees with many branches
        ends = [np.sort(rng.uniform(size=2 * rng.integers(1, 7))).reshape(-1, 2) for _ in range(12)]
        columns = [[Interval(low, high, 2, 2) for low, high in column] for column in ends]
        places = [(c, i) for c, column in enumerate(columns) for i in range(len(column))]
        number = {place: n for n, place in enumerate(places)}
        pairs = [(number[c, i], number[c + 1, k]) for c in range(11) for i, k in links(columns[c], columns[c + 1])]
        rows, others = np.array(pairs).T
        graph = coo_array((np.ones(len(rows)), (rows, others)), shape=(len(places), len(places)))
        _, labels = connected_components(graph, directed=False)
        wanted = {frozenset(places[n] for n in np.flatnonzero(labels == label)) for label in set(labels.tolist())}
        assert {frozenset(one) for one in components(columns)} == wanted


def test_an_annulus_has_two_outlines() -> None:
    Omega = np.linspace(-1.3, 1.3, 53)

    def stretches(x: float) -> list[Interval]:
        if abs(x) >= 1:
            return []
        outer, inner = np.sqrt(1 - x**2), np.sqrt(max(0.25 - x**2, 0))
        ends = [(-outer, outer)] if inner == 0 else [(-outer, -inner), (inner, outer)]
        return [Interval(a, b, Kind.COMPLEX, Kind.COMPLEX) for a, b in ends]

    columns = [stretches(x) for x in Omega]
    (places,) = components(columns)
    outer, inner = loops(Omega, columns, places, 0.0)
    # inscribed polygons: the area is short by the square of the step, and by the caps
    assert abs(area(outer.Omega, outer.eps)) == pytest.approx(np.pi, abs=0.05)
    assert abs(area(inner.Omega, inner.eps)) == pytest.approx(np.pi / 4, abs=0.05)
    region = Region((outer, inner), (), (0.0, -1.0), (0.0, 0.75))
    x, y = np.random.default_rng(1).uniform(-1.2, 1.2, (2, 2000))
    radius = np.hypot(x, y)
    clear = (np.abs(radius - 1) > 0.06) & (np.abs(radius - 0.5) > 0.06)
    np.testing.assert_array_equal(region.contains(x, y)[clear], ((radius < 1) & (radius > 0.5))[clear])
    assert not region.explained


def test_edges_that_meet_on_that_of_the_window_meet_although_rounding_puts_them_beyond() -> None:
    for lower, part, top in np.random.default_rng(0).random((200, 3)):
        first, second = 0.5 * lower * top, (0.5 * lower + 0.4 * part) * top
        place = _apex(np.array([1.0, 1.1, 100.0]), (first, top), (second, top))
        assert place is not None
        assert place[0] == pytest.approx(1.1 + 0.1 * (top - second) / (second - first))
        assert place[1] == pytest.approx(top)
        assert place[1] <= top


def test_a_gap_that_rises_steeply_connects_nothing_across() -> None:
    # from one column to the next the gap between two kinds rises by more than it is wide
    def column(gap: float, above: int = Kind.PLUS_ONE) -> list[Interval]:
        low, high = Interval(0.0, gap, Kind.MINUS_ONE, Kind.MINUS_ONE), Interval(gap + 0.01, 1.0, above, above)
        return [low, high]

    assert links(column(0.50), column(0.53)) == [(0, 0), (1, 1)]
    assert links(column(0.53), column(0.50)) == [(0, 0), (1, 1)]
    # a gap between other kinds is another gap: there the region goes through between them
    assert links(column(0.50), column(0.53, Kind.COMPLEX)) == [(0, 0), (1, 0), (1, 1)]
