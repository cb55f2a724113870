"""Every region of a window: exact edges, names, nothing missed and nothing invented."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.optimize import brentq
from scipy.spatial import cKDTree
from scipy.special import mathieu_a, mathieu_b

from floquet import Kind, Region, StabilityChart, monodromy, stability_chart, trace_regions
from floquet.oracle import is_unstable
from floquet.regions import Loop
from floquet.regions.column import _with_neighbours
from floquet.regions.refinement import Refinement
from floquet.regions.regions import _witness
from floquet.regions.scan import Scan
from floquet.regions.tongues import Tongue
from floquet.regions.window import Window
from periodic import PeriodicSystem
from periodic.examples import coupled_mathieu, mathieu
from plate import EdgeLoad, MovingPlate
from tests import strategies
from tests.floquet.regions.resonating import resonances_of


def edge_of_mathieu(order: int, sort: str, eps: float) -> float:
    """Edge of the n-th region of x'' + (1 + eps cos Omega t) x = 0: a = 4/Omega^2 is a_n(q) or b_n(q), q = 2
    eps/Omega^2 (DLMF 28.2(v))."""
    characteristic = mathieu_a if sort == "a" else mathieu_b
    return brentq(
        lambda Omega: 4 / Omega**2 - characteristic(order, 2 * eps / Omega**2), 1.4 / order, 3.0 / order, xtol=1e-12
    )


def test_edges_and_names_of_the_regions_of_mathieu() -> None:
    tolerance = 1e-3
    regions = trace_regions(mathieu(), (0.5, 3.0), (0.0, 0.8), tolerance=tolerance, progress=False)
    assert [region.label for region in regions][-2:] == ["2ω₁/2", "2ω₁"]
    for order, region in ((2, regions[-2]), (1, regions[-1])):
        assert region.explained
        kinds = set(region.outlines[0].kind.tolist())
        assert kinds == {Kind.MINUS_ONE if order == 1 else Kind.PLUS_ONE}
        for eps in (0.3, 0.5, 0.75):
            for sort, side in (("a", 1), ("b", -1)):
                edge = edge_of_mathieu(order, sort, eps)
                # outside stays outside, inside stays inside, but for the stated tolerance
                off = 2 * tolerance * 2.5
                inwards = -side if edge_of_mathieu(order, "a", eps) > edge_of_mathieu(order, "b", eps) else side
                assert region.contains(edge + inwards * off, eps)
                assert not region.contains(edge - inwards * off, eps)


def misses(regions: list[Region], chart: StabilityChart, tolerance: float) -> tuple[NDArray[Any], NDArray[Any]]:
    """Return the cells that contradict the regions, though further than ``tolerance``, as part of the window, from all
    edges: stable cells inside, unstable cells outside; bool, of the shape of the chart."""
    Omega, eps = np.meshgrid(chart.Omega, chart.eps)
    width, height = np.ptp(chart.Omega), np.ptp(chart.eps)
    inside = np.zeros(Omega.shape, dtype=bool)
    points = [np.full((1, 2), -1e9)]  # far away, lest there be no regions
    for region in regions:
        inside |= region.contains(Omega, eps)
        for loop in region.outlines:
            x, y = np.append(loop.Omega, loop.Omega[0]) / width, np.append(loop.eps, loop.eps[0]) / height
            for k in range(len(loop.Omega)):
                count = int(4 * np.hypot(x[k + 1] - x[k], y[k + 1] - y[k]) / tolerance) + 2
                part = np.linspace(0, 1, count)[:, None]
                points.append([x[k], y[k]] + part * [x[k + 1] - x[k], y[k + 1] - y[k]])
    invented, missed = (chart.kind == Kind.STABLE) & inside, (chart.kind > Kind.STABLE) & ~inside
    edges = cKDTree(np.concatenate(points))
    for wrong in (invented, missed):
        rows, columns = np.nonzero(wrong)
        near = edges.query(np.column_stack([chart.Omega[columns] / width, chart.eps[rows] / height]))[0] <= tolerance
        wrong[rows[near], columns[near]] = False
    return invented, missed


@pytest.mark.parametrize("damping", [0.0, 1e-3])
def test_regions_of_a_small_plate_agree_with_its_chart(damping: float) -> None:
    plate = MovingPlate(axial_terms=2, lateral_terms=3, damping=damping)
    regions = trace_regions(plate, (10.0, 60.0), (0.0, 1.0), progress=False)
    chart = stability_chart(plate, np.linspace(10, 60, 256), np.linspace(0, 1, 128), progress=False, audit=0)
    invented, missed = misses(regions, chart, 1e-3)
    assert not invented.any()
    assert not missed.any()
    assert all(region.explained for region in regions)
    for region in regions:
        assert region.contains(*region.witness)
        assert monodromy(plate, *region.witness).kind > Kind.STABLE


def random_system(seed: int) -> PeriodicSystem:
    """A conservative system with 2 to 4 coordinates and 1 to 3 harmonics, every second one with sines."""
    rng = np.random.default_rng(seed)
    size, harmonics = 2 + seed % 3, 1 + seed % 3
    zero = np.zeros((size, size))
    parts = 0.2 * rng.normal(size=(2, harmonics, size, size))
    cosine, sine = parts + parts.transpose(0, 1, 3, 2)
    stiffness = np.diag(np.sort(rng.uniform(0.5, 3, size) ** 2))
    return PeriodicSystem(np.eye(size), zero, zero, stiffness, cosine, sine if seed % 2 else None)


@pytest.mark.parametrize("seed", [0, 3, 7])
def test_regions_of_random_systems_agree_with_their_charts(seed: int) -> None:
    system = random_system(seed)
    regions = trace_regions(system, (0.6, 6.0), (0.0, 0.5), progress=False)
    chart = stability_chart(system, np.linspace(0.6, 6, 256), np.linspace(0, 0.5, 128), progress=False, audit=0)
    invented, missed = misses(regions, chart, 1e-3)
    # where several regions meet within a few tolerances, single cells may be taken for the wrong side
    unstable = (chart.kind > Kind.STABLE).sum()
    assert invented.sum() <= 1e-3 * unstable
    assert missed.sum() <= 1e-3 * unstable
    for region in regions:
        assert monodromy(system, *region.witness).kind > Kind.STABLE


def test_tongues_narrower_than_any_grid_are_found() -> None:
    # the fifth tongue of Mathieu's equation is 1e-4 of this window wide at eps = 0.5, the third 0.004
    regions = trace_regions(mathieu(), (0.35, 2.9), (0.0, 0.5), progress=False)
    assert [region.label for region in regions] == ["2ω₁/5", "2ω₁/4", "2ω₁/3", "2ω₁/2", "2ω₁"]
    for order, region in zip((5, 4, 3, 2, 1), regions, strict=True):
        middle = sum(edge_of_mathieu(order, sort, 0.49) for sort in "ab") / 2
        assert region.contains(middle, 0.49)


@pytest.mark.slow
@pytest.mark.parametrize("inplane", ["static", "membrane"])
@pytest.mark.parametrize("damping", [0.0, 2e-4, 1e-3])
def test_regions_of_the_standard_plate_agree_with_its_chart(inplane: str, damping: float) -> None:
    plate = MovingPlate(damping=damping, inplane=inplane)
    regions = trace_regions(plate, (5.0, 90.0), (0.0, 1.0), progress=False)
    Omega, eps = np.linspace(5, 90, 1024), np.linspace(0, 1, 512)
    chart = stability_chart(plate, Omega, eps, progress=False, audit=0)
    invented, missed = misses(regions, chart, 1e-3)
    assert not invented.any()
    assert not missed.any()
    labels = {name for region in regions for name in region.label.split(", ")}
    assert labels >= {"2ω₁", "2ω₂", "ω₁+ω₄", "ω₂+ω₅", "2ω₄"}
    assert "" not in labels


@pytest.mark.slow
@pytest.mark.parametrize("inplane", ["static", "membrane"])
@pytest.mark.parametrize(("width", "centre", "damping"), [(0.5, 0.5, 0.0), (0.4, 0.3, 2e-4), (0.8, 0.5, 1e-3)])
def test_regions_of_plates_with_partial_loads(inplane: str, width: float, centre: float, damping: float) -> None:
    plate = MovingPlate(damping=damping, inplane=inplane, load=EdgeLoad.partial(width, centre))
    regions = trace_regions(plate, (5.0, 90.0), (0.0, 1.0), progress=False)
    chart = stability_chart(plate, np.linspace(5, 90, 1024), np.linspace(0, 1, 512), progress=False, audit=0)
    invented, missed = misses(regions, chart, 1e-3)
    unstable = (chart.kind > Kind.STABLE).sum()
    assert invented.sum() <= 1e-3 * unstable
    assert missed.sum() <= 1e-3 * unstable


@pytest.mark.parametrize(("kind", "label", "centre"), [("sum", "ω₁+ω₂", 2.7), ("difference", "ω₂−ω₁", 0.7)])
def test_combination_resonances_are_named(kind: str, label: str, centre: float) -> None:
    regions = trace_regions(coupled_mathieu(kind), (0.97 * centre, 1.03 * centre), (0.0, 0.04), progress=False)
    assert [region.label for region in regions] == [label]
    assert set(regions[0].outlines[0].kind.tolist()) == {Kind.COMPLEX}
    assert regions[0].resonances[0].centre == pytest.approx(centre, rel=1e-12)


def test_a_difference_of_modes_is_told_from_a_sum_of_high_order_nearby() -> None:
    # (ω₁+ω₂)/4 = 0.675 and 2ω₂/5 = 0.68 are of the same order of magnitude, and inside the region of ω₂−ω₁ = 0.7
    regions = trace_regions(coupled_mathieu("difference"), (0.3, 4.0), (0.0, 1.0), progress=False)
    assert any("ω₂−ω₁" in region.label.split(", ") for region in regions)
    for region in regions:
        for loop in region.outlines:
            assert loop.eps.min() >= 0
            assert loop.eps.max() <= 1


def test_damping_lifts_the_tip() -> None:
    # exact to first order: closed below eps = 2 omega damping (periodic.examples.mathieu); the next order is eps^3
    regions = trace_regions(mathieu(damping=0.1), (1.6, 2.5), (0.0, 0.6), progress=False)
    assert [region.label for region in regions] == ["2ω₁"]
    Omega, eps = regions[0].tip
    assert eps == pytest.approx(0.2, abs=0.005)
    assert Omega == pytest.approx(2.0, abs=0.02)


def test_edges_at_the_bottom_of_a_window_are_as_exact_as_elsewhere() -> None:
    plate = MovingPlate(axial_terms=2, lateral_terms=3)
    regions = trace_regions(plate, (10.0, 60.0), (0.3, 0.6), progress=False)
    chart = stability_chart(plate, np.linspace(10, 60, 256), np.linspace(0.3, 0.6, 64), progress=False, audit=0)
    invented, missed = misses(regions, chart, 1e-3)
    assert not invented.any()
    assert missed.sum() <= 1e-3 * (chart.kind > Kind.STABLE).sum()


def test_a_window_above_the_tips_has_the_same_names() -> None:
    regions = trace_regions(mathieu(), (0.8, 3.0), (0.4, 0.8), progress=False)
    assert [region.label for region in regions][-2:] == ["2ω₁/2", "2ω₁"]
    for region in regions:
        assert region.outlines[0].eps.min() >= 0.4
        assert region.outlines[0].eps.max() <= 0.8
    assert regions[-1].tip[1] == 0.4


def test_instability_without_excitation_is_listed_without_a_name() -> None:
    diverging = mathieu(-0.5)
    regions = trace_regions(diverging, (3.0, 6.0), (0.0, 0.5), progress=False)
    assert len(regions) == 1
    assert not regions[0].explained
    assert regions[0].label == ""
    assert regions[0].contains([3.5, 5.0], 0.25).all()


def test_growth_without_excitation_is_no_resonance_although_one_is_near() -> None:
    zero = np.zeros((2, 2))
    system = PeriodicSystem(np.eye(2), zero, np.diag([0.1, -0.05]), np.diag([1.0, 4.0]), [[[1.0, 0.5], [0.5, 1.0]]])
    (region,) = trace_regions(system, (0.5, 5.0), (0.0, 1.0), progress=False)
    assert not region.explained


def test_outlines_stay_in_their_window() -> None:
    for region in trace_regions(MovingPlate(), (5.0, 90.0), (0.0, 1.5), progress=False):
        for outline in region.outlines:
            assert outline.Omega.min() >= 5.0
            assert outline.Omega.max() <= 90.0
            assert outline.eps.min() >= 0.0
            assert outline.eps.max() <= 1.5


@pytest.mark.parametrize("side", [-1, 1])
def test_a_region_that_only_touches_the_edge_of_the_window_is_not_lost(side: int) -> None:
    # 2ω₁ comes in at eps = 0.4, by 3e-4 up to the top: half the tolerance
    edge = edge_of_mathieu(1, "a" if side < 0 else "b", 0.4)
    window = (1.2, edge) if side < 0 else (edge, 3.0)
    (region,) = trace_regions(mathieu(), window, (0.0, 0.4005), progress=False)
    assert region.contains(edge, 0.4003)
    assert not region.contains(edge, 0.399)
    assert region.tip == pytest.approx((edge, 0.4), abs=1e-4)
    assert is_unstable(mathieu(), *region.witness)
    assert np.abs(region.outlines[0].Omega - edge).max() < 1e-3 * (window[1] - window[0])


@pytest.mark.parametrize("low", [0.9995, 1.0, 1.0005, 1.001, 1.002])
def test_a_region_that_the_window_cuts_at_its_resonance_is_there_once(low: float) -> None:
    # 2ω₁/2 starts at Omega = 1 and leans to the left
    found = [region for region in trace_regions(mathieu(), (low, 3.0), (0.0, 0.3), progress=False) if region.tip[0] < 2]
    assert [region.label for region in found] == ["2ω₁/2"]


def test_a_stable_window_has_no_regions() -> None:
    assert trace_regions(mathieu(damping=0.5), (1.5, 2.5), (0.0, 0.3), progress=False) == []


def test_workers_change_nothing() -> None:
    one, two = (trace_regions(mathieu(), (1.5, 2.5), (0.0, 0.5), n_jobs=n, progress=False) for n in (1, 2))
    for a, b in zip(one, two, strict=True):
        np.testing.assert_array_equal(a.outlines[0].Omega, b.outlines[0].Omega)
        np.testing.assert_array_equal(a.outlines[0].eps, b.outlines[0].eps)


@pytest.mark.parametrize(
    ("changes", "name"),
    [
        ({"family": 1}, "family"),
        ({"Omega_range": (0.0, 1.0)}, "Omega_range"),
        ({"Omega_range": (2.0, 1.0)}, "Omega_range"),
        ({"Omega_range": 1.0}, "Omega_range"),
        ({"eps_range": (-0.1, 1.0)}, "eps_range"),
        ({"eps_range": (0.0, np.nan)}, "eps_range"),
        ({"tolerance": 0.0}, "tolerance"),
        ({"tolerance": 0.5}, "tolerance"),
        ({"n_jobs": 0}, "n_jobs"),
        ({"progress": "yes"}, "progress"),
    ],
)
def test_wrong_arguments_are_named(changes: dict[str, Any], name: str) -> None:
    arguments = {"family": mathieu(), "Omega_range": (1.0, 2.0), "eps_range": (0.0, 1.0)} | changes
    with pytest.raises(ValueError, match=name):
        trace_regions(**arguments)


def test_a_resonance_that_rounding_parts_from_a_column() -> None:
    # Omega = 2 is in the middle of the window, but for rounding where the natural frequency is computed
    regions = trace_regions(mathieu(1.0 + 4e-16), (1.0, 3.0), (0.0, 0.5), progress=False)
    assert regions[-1].label == "2ω₁"
    # at the tip eps goes with the square root of a rounding error
    assert regions[-1].tip == pytest.approx((2.0, 0.0), abs=1e-6)


def test_weak_instability_beside_a_sure_one_belongs_to_it() -> None:
    sure = np.array([0, 0, 0, 1, 1, 0, 0, 0, 0], dtype=bool)
    likely = np.array([0, 1, 1, 0, 1, 0, 1, 1, 0], dtype=bool)
    np.testing.assert_array_equal(_with_neighbours(sure, likely), [0, 1, 1, 1, 1, 0, 0, 0, 0])


def test_a_column_at_a_resonance_is_unstable_from_the_bottom() -> None:
    # the first amplitudes are too small for a verdict
    scan = Scan(Window(mathieu(), (1.0, 3.0), (0.0, 1e-3)))
    scan.add([2.0])
    (interval,) = scan.columns[2.0]
    assert interval.low == pytest.approx(0, abs=1e-6)
    assert interval.low_kind == Kind.MINUS_ONE


def test_subsystems_that_are_stable_on_both_sides_are_spared() -> None:
    # two oscillators that nothing couples: 2 at the left, and 3 at the right of the window, are unstable on their own
    one, zero = np.eye(2), np.zeros((2, 2))
    system = PeriodicSystem(one, zero, zero, np.diag([1.0, 2.25]), [one])
    scan = Scan(Window(system, (1.5, 3.5), (0.0, 0.3)))
    scan.add(np.linspace(1.5, 3.5, 33))
    before = set(scan.subsystems)
    scan.refine()
    new = {w: list(scan.subsystems[w]) for w in set(scan.subsystems) - before}
    for centre, size in ((2.0, 1.0), (3.0, 2.25)):
        near = [numbers for w, numbers in new.items() if abs(w - centre) < 0.1]
        assert near
        for numbers in near:
            (number,) = numbers
            assert scan.subsystems[1.5][number].subsystem.K[0, 0] == pytest.approx(size)


def test_a_region_about_as_wide_as_the_columns_are_apart_has_one_at_its_resonance(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    added: list[list[float]] = []
    add = Scan.add

    def spied(scan: Scan, Omega: list[float], *rest: Any) -> int:
        added.append(list(Omega))
        return add(scan, Omega, *rest)

    monkeypatch.setattr(Scan, "add", spied)
    top = 0.1
    width = edge_of_mathieu(1, "b", top) - edge_of_mathieu(1, "a", top)
    window = (1.2, 1.2 + 128 * abs(width) / 0.7)
    trace_regions(mathieu(), window, (0.0, top), progress=False)
    assert min(abs(np.array(added[0]) - 2.0)) < 1e-9


def test_a_span_is_looked_at_again_only_when_a_column_near_it_is_new(monkeypatch: pytest.MonkeyPatch) -> None:
    looked: list[tuple[float, ...]] = []
    places = Refinement.places

    def spied(refinement: Refinement, c: int) -> list[float]:
        looked.append(refinement.around(c))
        return places(refinement, c)

    monkeypatch.setattr(Refinement, "places", spied)
    scan = Scan(Window(mathieu(), (1.0, 3.0), (0.0, 0.3)))
    scan.add(np.linspace(1.0, 3.0, 33))
    scan.refine()
    assert len(scan.columns) > 33
    assert len(looked) == len(set(looked))


def test_a_witness_lies_in_its_segment_and_in_the_window() -> None:
    one, window = resonances_of(mathieu(), 1.9, 2.1)[0], Window(mathieu(), (1.0, 2.05), (0.0, 0.4))
    eps = np.linspace(0, 0.4, 81)
    half = eps / 2.2
    corners, kind = np.concatenate([2 + half, (2 - half)[::-1]]), np.zeros(162, dtype=np.int8)
    loop = Loop(np.clip(corners, 1.0, 2.05), np.concatenate([eps, eps[::-1]]), kind)
    inside = Tongue(one, eps, 2 - half, 2 + half, (2.01, 0.2), True, 1)
    assert _witness(inside, loop, window) == ((2.01, 0.2), True)
    for place in ((2.01, 0.5), (2.06, 0.2)):
        witness, sure = _witness(inside._replace(witness=place), loop, window)
        assert not sure
        assert Region((loop,), (one,), (2.0, 0.0), witness).contains(*witness)
        assert is_unstable(mathieu(), *witness)


def test_a_region_reaches_down_to_its_resonance() -> None:
    plate = MovingPlate(axial_terms=2, lateral_terms=3, load=EdgeLoad.partial(0.5))
    for region in trace_regions(plate, (20.0, 60.0), (0.0, 0.5), progress=False):
        assert region.tip[1] < 1e-3 * 0.5


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 10**6), st.integers(1, 4), st.floats(0.5, 4.0), st.floats(-1.5, 1.5))
def test_a_point_is_unstable_for_regions_where_it_is_for_monodromy(seed: int, n: int, Omega: float, eps: float) -> None:
    system = strategies.random_system(seed, n, 2)
    found = monodromy(system, Omega, eps)
    assume(found.kind != Kind.UNDECIDED and abs(found.growth_rate) * 2 * np.pi / Omega > 1e-6)
    assert is_unstable(system, Omega, eps) == (found.kind > Kind.STABLE)
