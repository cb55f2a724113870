"""Narrow regions cut where they meet wide ones: nothing of them is lost, nothing is there twice."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from floquet import Region
from floquet.boundary import Resonance
from floquet.regions.stretches import branches
from floquet.regions.tongues import Tongue
from periodic.checks import FloatArray

NAME = Resonance(1, 1, 1, "sum", 2.0)
EPS = np.linspace(0.0, 1.0, 50)


def tongue(half: FloatArray) -> Tongue:
    return Tongue(NAME, EPS, 2.0 - half, 2.0 + half, (2.0, 0.25), True, 1)


def right_of(line: float) -> object:
    """A wide region to the right of a line that leans to the left: it passes Omega = 2 at eps = 0.5."""

    def contains(Omega: FloatArray, eps: FloatArray) -> NDArray[np.bool_]:
        return np.asarray(Omega > 2.0 + line * (0.5 - eps))

    return contains


def test_a_region_is_cut_where_its_middle_enters_a_wide_one() -> None:
    one, wide = tongue(0.1 * EPS), right_of(0.3)
    (branch,) = branches([one], [wide], (1.0, 3.0))  # type: ignore[list-item]
    assert branch.parent == 0
    # the way between two corners, a 63rd of the height, is divided into 16
    assert branch.loop.eps.max() == pytest.approx(0.5, abs=1 / 63 / 8)
    region = Region((branch.loop,), (NAME,), (2.0, 0.0), (2.0, 0.25))
    Omega, eps = np.random.default_rng(0).uniform([[1.8], [0.0]], [[2.2], [1.0]], (2, 4000))
    clear = (np.abs(np.abs(Omega - 2.0) - 0.1 * eps) > 0.01) & (np.abs(eps - 0.5) > 0.01)
    inside = (np.abs(Omega - 2.0) < 0.1 * eps) & (eps < 0.5)
    np.testing.assert_array_equal(region.contains(Omega, eps)[clear], inside[clear])


def test_a_region_beside_a_wide_one_is_whole() -> None:
    (branch,) = branches([tongue(0.01 * EPS)], [lambda Omega, eps: Omega > 2.5], (1.0, 3.0))
    assert branch.parent is None
    assert branch.loop.eps.max() == 1.0
    assert 0.25 in branch.loop.eps  # the level of the witness is a corner


def test_branches_that_cross_are_inside_where_they_do() -> None:
    found = branches([tongue(0.1 * EPS), tongue(0.05 * EPS)], [], (1.0, 3.0))
    region = Region(tuple(branch.loop for branch in found), (NAME,), (2.0, 0.0), (2.0, 0.25))
    assert region.contains([2.0, 2.07], [0.9, 0.9]).all()
