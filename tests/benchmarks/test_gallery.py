"""Other programs judge the gallery: all of it is asked for, and SciPy says what the page says."""

from __future__ import annotations

import math
from importlib import import_module

import numpy as np
import pytest

from benchmarks.gallery import PAGE, POINTS, Motion, by_scipy
from floquet_scripts.gallery import gallery

LINES = PAGE.read_text(encoding="utf-8").splitlines()
ROWS = {
    cells[0]: cells[1:]
    for cells in ([cell.strip() for cell in line.strip("| ").split("|")] for line in LINES)
    if len(cells) > 5
}


def test_every_example_is_asked_for_and_stands_on_the_page() -> None:
    asked = {point.example.partition(".")[2] for point in POINTS}
    assert asked == set(gallery())
    assert asked <= set(ROWS)


@pytest.mark.parametrize("example", ["rotors.gear_mesh", "rotors.two_bladed_whirl", "oscillators.blade_flap"])
def test_scipy_says_so(example: str) -> None:
    """Jumps, a mass matrix that depends on time, powers of eps and periodic damping."""
    point = next(one for one in POINTS if one.example.partition(".")[2] == example.partition(".")[2])
    family = point.make(import_module(f"floquet_examples.{point.example}"))
    found = by_scipy(Motion(family.at(point.Omega), point.Omega, point.eps))  # type: ignore[arg-type]
    growth = math.log(np.abs(np.linalg.eigvals(found)).max())
    Omega, eps, printed, *_ = ROWS[point.example.partition(".")[2]]
    assert (float(Omega), float(eps)) == (point.Omega, point.eps)
    assert growth == pytest.approx(float(printed), abs=1e-11)


def test_no_peer_differs_by_more_than_rounding() -> None:
    for name in gallery():
        differences = [float(cell) for cell in ROWS[name][4:] if cell != "–"]
        assert len(differences) >= 2
        assert max(differences) < 1e-11
