"""Regions asked for by name, their widths, and what they show of themselves."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import mathieu_a, mathieu_b

from compare import plot
from floquet import Regions, trace_regions
from floquet.regions import Loop, Region
from floquet.regions.naming import resonance_named
from periodic.examples import coupled_mathieu, mathieu


@pytest.fixture(scope="module")
def regions() -> Regions:
    return trace_regions(mathieu(), (0.8, 2.17), (0.0, 0.4), n_jobs=1, progress=False)


@pytest.fixture(scope="module")
def pair() -> Regions:
    return trace_regions(coupled_mathieu(), (1.3, 3.2), (0.0, 0.4), n_jobs=1, progress=False)


def edge(function: object, order: int, eps: float, guess: float) -> float:
    """The Omega at which x'' + (1 + eps cos Omega t) x = 0 has a solution of a period or two: a(q), b(q) of Mathieu."""

    def miss(Omega: float) -> float:
        return float(function(order, 2 * eps / Omega**2)) - 4 / Omega**2  # type: ignore[operator]

    return float(brentq(miss, 0.9 * guess, 1.1 * guess, xtol=1e-13))


@pytest.mark.parametrize("eps", [0.05, 0.2, 0.3, 0.4])
def test_width_is_that_between_characteristic_curves(regions: Regions, eps: float) -> None:
    tolerance = 2 * 1e-3 * 1.4  # of trace_regions, at both edges
    for name, order, guess in (("2ω₁/2", 2, 1.0),) + ((("2ω₁", 1, 2.0),) if eps < 0.4 else ()):
        ends = sorted(edge(function, order, eps, guess) for function in (mathieu_a, mathieu_b))
        assert regions[name].width(eps) == pytest.approx(ends[1] - ends[0], abs=tolerance)
        assert regions[name].intervals(eps) == pytest.approx(np.array([ends]), abs=tolerance)


def test_a_width_that_is_not_known_is_refused(regions: Regions) -> None:
    with pytest.raises(ValueError, match=r"^at eps = 0\.4 the region goes on beyond the window, Omega = 0\.8 to 2\.17"):
        regions["2ω₁"].width(0.4)
    assert regions["2ω₁"].intervals(0.4)[0, 1] == 2.17
    with pytest.raises(ValueError, match=r"^eps = 0\.5 was not traced; give 0 to 0\.4, or trace more$"):
        regions["2ω₁"].width(0.5)
    with pytest.raises(ValueError, match=r"^eps = 'high' is not a number"):
        regions["2ω₁"].width("high")


def test_closed_below_the_tip() -> None:
    damped = trace_regions(mathieu(damping=0.1), (1.6, 2.5), (0.0, 0.6), n_jobs=1, progress=False)
    assert damped["2w1"].tip == pytest.approx((2.0, 0.2), abs=4e-3)
    assert damped["2w1"].width(0.15) == 0.0
    assert damped["2w1"].intervals(0.15).shape == (0, 2)
    assert damped["2w1"].width(0.3) > 0.1


def test_islands_are_left_out_and_tongues_counted_once() -> None:
    kind = np.zeros(4, dtype=np.int8)

    def box(left: float, right: float, bottom: float, top: float, turn: int = 1) -> Loop:
        return Loop(np.array([left, right, right, left])[::turn], np.array([bottom, bottom, top, top])[::turn], kind)

    outlines = (box(0, 4, 0, 4), box(1, 2, 1, 3, -1), box(3, 5, 0, 4))
    region = Region(outlines, (), (0.0, 0.0), (0.5, 0.5))
    assert region.intervals(2.0).tolist() == [[0, 1], [2, 5]]
    assert region.width(2.0) == 4.0
    assert region.width(0.5) == 5.0


@pytest.mark.parametrize(
    ("names", "expected"),
    [
        (("2ω₁", "2w1", "2 omega_1", r"$2\omega_{1}$", "2*W1"), (1, 1, 1, "sum")),
        (("2ω₁/2", "ω₁", "w1"), (1, 1, 2, "sum")),
        (("2ω₁/3", "2w1/3"), (1, 1, 3, "sum")),
        (("ω₁/2", "2ω₁/4"), (1, 1, 4, "sum")),
        (("ω₁+ω₃", "w3 + w1", "omega1+omega3"), (3, 1, 1, "sum")),
        (("ω₁₂−ω₃", "w12-w3", "w3-w12"), (12, 3, 1, "difference")),
        (("(ω₃−ω₁)/2", "(w3-w1) / 2"), (3, 1, 2, "difference")),
    ],
)
def test_spellings(names: tuple[str, ...], expected: tuple[int, int, int, str]) -> None:
    assert {resonance_named(name) for name in names} == {expected}


@pytest.mark.parametrize("name", ["", "1", "2w", "w1+", "3w1", "0w1", "w1-w1", "2w1+w2", "the first", "w1+w2/0x"])
def test_other_words_are_no_names(name: str) -> None:
    with pytest.raises(ValueError, match="is the name of no resonance; write it as 2ω₁, "):
        resonance_named(name)


def test_every_name_that_is_shown_is_understood(regions: Regions, pair: Regions) -> None:
    for found in (regions, pair):
        assert len(found) == 2
        for region in found:
            for resonance in region.resonances:
                assert found[resonance.label] is region
                assert resonance.label in repr(found)


def test_what_is_not_there_is_named(pair: Regions) -> None:
    with pytest.raises(KeyError, match=r"no region in the window starts from 2w1; there are 2ω₂/2, ω₁\+ω₂"):
        pair["2w1"]
    with pytest.raises(KeyError, match=r"'first' is the name of no resonance; .* there are 2ω₂/2, ω₁\+ω₂"):
        pair["first"]
    twice = Regions([pair[1], pair[1]], (1.3, 3.2), (0.0, 0.4))
    with pytest.raises(KeyError, match=r"2 regions start from ω₁\+ω₂; take one by its number: 0, 1"):
        twice["ω₁+ω₂"]


def test_it_is_a_list(pair: Regions) -> None:
    assert pair[0] is next(iter(pair))
    assert pair[:1] == [pair[0]]
    assert plot(pair).axes


def test_it_fits_a_screen(pair: Regions) -> None:
    many = Regions([*pair] * 40, (1.3, 3.2), (0.0, 0.4))
    lines = repr(many).splitlines()
    assert len(lines) == 22
    assert lines[0] == "80 regions, Omega = 1.3 to 3.2, eps = 0 to 0.4"
    assert lines[2].startswith("  1  Region(ω₁+ω₂: tip at Omega = 2.7, eps = 0, up to 0.3")
    assert lines[-1] == "  and 60 more"
    assert max(map(len, lines)) < 100
