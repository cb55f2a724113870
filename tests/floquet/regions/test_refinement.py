"""Where a scan needs one more column: between two regions that look like one, and at a corner of an edge."""

from __future__ import annotations

import numpy as np
import pytest

from floquet import Kind
from floquet.regions.outlines import Column, Interval
from floquet.regions.refinement import Refinement
from floquet.regions.window import Window
from periodic.checks import FloatArray
from periodic.examples import mathieu

OMEGA = np.arange(10.0, 20.0)


def refinement(columns: list[Column], strongest: FloatArray) -> Refinement:
    window = Window(mathieu(), (10.0, 20.0), (0.0, 1.0))
    return Refinement(window, OMEGA, columns, strongest)


def full(kind: Kind = Kind.COMPLEX) -> list[Column]:
    return [[Interval(0.0, 1.0, kind, kind)] for _ in OMEGA]


def regions(*spans: tuple[float, float, float]) -> FloatArray:
    """f and the mark in the columns of regions from Omega to Omega with a mark, at three amplitudes that are alike."""
    f, mark = np.full(OMEGA.shape, np.nan), np.full(OMEGA.shape, np.nan)
    for low, high, own in spans:
        here = (OMEGA - low) * (high - OMEGA)
        stronger = (here > 0) & ~(here <= f)
        f[stronger], mark[stronger] = here[stronger], own
    return np.repeat(np.stack([f, mark], axis=1)[:, :, None], 3, axis=2)


def test_a_gap_between_two_regions_is_looked_for_where_it_is() -> None:
    (place,) = refinement(full(), regions((5.0, 14.3, 1.0), (14.5, 25.0, 2.0))).places(4)
    # on a straight way f is zero further on: at 14.33 and at 14.48
    assert 14.3 < place < 14.5
    # two that are alike are told apart by f falling towards the gap from both sides
    (place,) = refinement(full(), regions((5.0, 14.3, 1.0), (14.5, 25.0, 1.0))).places(4)
    assert 14.3 < place < 14.5


def test_one_region_and_two_that_overlap_have_no_gap() -> None:
    for spans in ([(5.0, 25.0, 1.0)], [(5.0, 14.9, 1.0), (14.1, 25.0, 2.0)]):
        found = refinement(full(), regions(*spans))
        for c in range(2, len(OMEGA) - 3):
            assert found.places(c) == []


def test_a_region_of_one_column_may_end_anywhere() -> None:
    (place,) = refinement(full(), regions((5.0, 14.1, 1.0), (14.6, 15.4, 2.0))).places(4)
    assert place == pytest.approx((14.1 + 15.0) / 2, abs=0.02)


def test_an_edge_of_two_regions_has_a_corner() -> None:
    # from below on both sides, straight within the tolerance of a chord, but of two regions
    columns = full()
    for c, (low, kind) in enumerate(zip(0.1 + 1e-5 * OMEGA, [Kind.COMPLEX] * 5 + [Kind.PLUS_ONE] * 5, strict=True)):
        columns[c] = [Interval(low, 1.0, kind, kind)]
    none = np.full((len(OMEGA), 2, 3), np.nan)
    found = refinement(columns, none)
    assert found.places(4) == [14.5]
    assert found.places(2) == []


@pytest.mark.parametrize(
    ("last", "bend", "foreseen"),
    [(Kind.COMPLEX, 0.0, True), (Kind.PLUS_ONE, 0.0, False), (Kind.COMPLEX, 0.0018, False)],
)
def test_an_end_is_foreseen_from_a_straight_edge_of_one_region(last: Kind, bend: float, foreseen: bool) -> None:
    # the lower edge rises to the top of the window at Omega = 13.5; the bend moves that by half the tolerance
    columns: list[Column] = [[] for _ in OMEGA]
    for c in range(4):
        kind = last if c == 3 else Kind.COMPLEX
        columns[c] = [Interval(0.65 + 0.1 * c - bend * (c == 1), 1.0, kind, kind)]
    found = refinement(columns, np.full((len(OMEGA), 2, 3), np.nan))
    assert found.places(3) == ([] if foreseen else [13.5])
