"""Narrow regions cut where they meet wide ones: nothing of them is lost, nothing is there twice."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from floquet import Region
from floquet.boundary import Resonance
from floquet.regions.segments import segments
from floquet.regions.tongues import Tongue
from floquet.regions.window import Window
from periodic.checks import FloatArray
from periodic.examples import mathieu

NAME = Resonance(1, 1, 1, "sum", 2.0)
EPS = np.linspace(0.0, 1.0, 50)
WINDOW = Window(mathieu(), (1.0, 3.0), (0.0, 1.0))


def tongue(half: FloatArray) -> Tongue:
    return Tongue(NAME, EPS, 2.0 - half, 2.0 + half, (2.0, 0.25), True, 1)


def right_of(line: float) -> object:
    """A wide region to the right of a line that leans to the left: it passes Omega = 2 at eps = 0.5."""

    def contains(Omega: FloatArray, eps: FloatArray) -> NDArray[np.bool_]:
        return np.asarray(Omega > 2.0 + line * (0.5 - eps))

    return contains


def test_a_tongue_is_cut_where_its_centreline_enters_a_wide_one() -> None:
    one, wide = tongue(0.1 * EPS), right_of(0.3)
    (segment,) = segments([one], [wide], WINDOW)  # type: ignore[list-item]
    assert segment.wide == 0
    # the way between two corners, a 63rd of the height, is divided into 16
    assert segment.loop.eps.max() == pytest.approx(0.5, abs=1 / 63 / 8)
    region = Region((segment.loop,), (NAME,), (2.0, 0.0), (2.0, 0.25))
    Omega, eps = np.random.default_rng(0).uniform([[1.8], [0.0]], [[2.2], [1.0]], (2, 4000))
    clear = (np.abs(np.abs(Omega - 2.0) - 0.1 * eps) > 0.01) & (np.abs(eps - 0.5) > 0.01)
    inside = (np.abs(Omega - 2.0) < 0.1 * eps) & (eps < 0.5)
    np.testing.assert_array_equal(region.contains(Omega, eps)[clear], inside[clear])


def test_a_region_beside_a_wide_one_is_whole() -> None:
    (segment,) = segments([tongue(0.01 * EPS)], [lambda Omega, eps: Omega > 2.5], WINDOW)
    assert segment.wide is None
    assert segment.loop.eps.max() == 1.0
    assert 0.25 in segment.loop.eps  # the level of the witness is a corner


def test_segments_that_cross_are_inside_where_they_do() -> None:
    found = segments([tongue(0.1 * EPS), tongue(0.05 * EPS)], [], WINDOW)
    region = Region(tuple(segment.loop for segment in found), (NAME,), (2.0, 0.0), (2.0, 0.25))
    assert region.contains([2.0, 2.07], [0.9, 0.9]).all()
