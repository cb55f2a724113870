"""The regions in lines: the widest ones in full, the others counted, and never more than fit a screen."""

from __future__ import annotations

import numpy as np

from compare.explorer.listing import MAX_REGION_LINES, region_lines
from floquet import Region
from floquet.boundary import Resonance
from floquet.regions import Loop


def region(*resonances: Resonance, Omega: float = 2.0, eps: float = 0.0, width: float = 0.5) -> Region:
    corners = np.array([Omega - width / 2, Omega + width / 2, Omega]), np.array([1.0, 1.0, eps])
    return Region((Loop(*corners, np.full(3, 2, dtype=np.int8)),), resonances, (Omega, eps), (Omega, 0.9))


def test_a_line_names_places_and_measures_its_region() -> None:
    (line,) = region_lines([region(Resonance(1, 1, 1, "sum", 2.0), Omega=2.5, eps=0.08361)], 1.0, "file")
    assert line == "2ω₁  from Ω = 2.5, ε = 0.0836, up to 0.49 wide"  # of the levels, the highest is just below the top
    (line,) = region_lines([region(eps=5e-16)], 2.0, "file")
    assert line.startswith("unexplained  from Ω = 2, ε = 0, ")


def test_of_many_resonances_those_of_low_order_are_named() -> None:
    names = [Resonance(p, 1, j, "sum", 2.0) for p, j in ((1, 4), (2, 2), (3, 1), (4, 3), (5, 1))]
    (line,) = region_lines([region(*names)], 1.0, "file")
    assert line.startswith("ω₁+ω₃, ω₁+ω₅, (ω₁+ω₂)/2 and 2 more  ")


def test_of_many_feet_the_one_of_the_first_name_is_told() -> None:
    names = Resonance(3, 2, 2, "sum", 2.6), Resonance(1, 1, 1, "sum", 2.0)
    (line,) = region_lines([region(*names, Omega=2.6)], 1.0, "file")
    assert line.startswith("2ω₁, (ω₂+ω₃)/2  from Ω = 2, ε = 0, ")
    (line,) = region_lines([region(*names, Omega=2.6, eps=0.1)], 1.0, "file")  # damped: the lowest one
    assert line.startswith("2ω₁, (ω₂+ω₃)/2  from Ω = 2.6, ε = 0.1, ")


def test_the_narrowest_are_counted() -> None:
    widths = np.random.default_rng(3).permutation(np.linspace(0.01, 0.3, MAX_REGION_LINES + 10))
    regions = [region(Resonance(1, 1, 1, "sum", 2.0), Omega=1.0 + i, width=width) for i, width in enumerate(widths)]
    *lines, last = region_lines(regions, 1.0, "all.json")
    assert last == "and 10 narrower ones, at most 0.098 wide; all are in all.json"
    shown = [float(line.split("Ω = ")[1].split(",")[0]) for line in lines]
    assert shown == [1.0 + i for i in np.flatnonzero(widths > 0.105)]  # in their own order


def test_as_many_as_fit_are_not_counted() -> None:
    lines = region_lines([region(width=0.1 + i) for i in range(MAX_REGION_LINES)], 1.0, "file")
    assert len(lines) == MAX_REGION_LINES
    assert not any("narrower" in line for line in lines)
    assert region_lines([], 1.0, "file") == []
