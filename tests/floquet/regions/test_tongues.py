"""Narrow regions between the columns of a scan: edges, tips, and nothing where there is nothing."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import mathieu_a, mathieu_b

from floquet import Kind, monodromy, stability_chart, trace_boundary
from floquet.engine import Sampler, Spectra, Workspace, spectra
from floquet.regions.scan import Scan
from floquet.regions.tongues import Tongue, _TongueTracer, trace_tongues
from floquet.regions.window import Window
from periodic import SystemFamily
from periodic.checks import FloatArray
from periodic.examples import coupled_mathieu, mathieu
from plate import EdgeLoad, MovingPlate
from tests.floquet.regions.resonating import resonances_of, tongues_expected

# So few that every tongue counts as narrow.
WIDE_SPANS = 4


def segments_of(family: SystemFamily, Omega: tuple[float, float], eps: tuple[float, float]) -> list[Tongue]:
    """From 33 columns over a window that is wider than the range."""
    member = family.at(sum(Omega) / 2)
    low, high = 0.5 * Omega[0], 1.5 * Omega[1]
    scan = Scan(Window(family, (low, high), eps, spans=WIDE_SPANS))
    scan.add(np.linspace(low, high, 33))
    return trace_tongues(tongues_expected(member, eps[1], *Omega), scan)


def tongues_of(family: SystemFamily, Omega: tuple[float, float], eps: tuple[float, float]) -> dict[str, Tongue]:
    """The lowest segment of each region."""
    return {tongue.resonance.label: tongue for tongue in segments_of(family, Omega, eps)[::-1]}


@pytest.mark.parametrize("order", [2, 3, 4, 5])
def test_edges_of_mathieu_tongues(order: int) -> None:
    tongue = tongues_of(mathieu(), (1.8 / order, 2.2 / order), (0.0, 0.3))[f"2ω₁/{order}"]
    assert tongue.eps[-1] == 0.3
    for eps in (0.15, 0.3):
        edges = sorted(
            brentq(
                lambda Omega, side=side, eps=eps: 4 / Omega**2 - side(order, 2 * eps / Omega**2),
                1.7 / order,
                2.1 / order,
                xtol=1e-15,
            )
            for side in (mathieu_a, mathieu_b)
        )
        width = edges[1] - edges[0]
        found = [np.interp(eps, tongue.eps, side) for side in (tongue.lower, tongue.upper)]
        # parabolas of three columns: their error is a small part of what the centreline moves
        drift = abs(sum(edges) / 2 - 2 / order)
        np.testing.assert_allclose(found, edges, atol=0.05 * drift + 0.05 * width)
        assert found[1] - found[0] == pytest.approx(width, rel=0.3)


def test_a_narrow_region_of_a_plate_agrees_with_its_traced_edges() -> None:
    plate = MovingPlate(axial_terms=2, lateral_terms=3)
    tongue = tongues_of(plate, (24.4, 24.5), (0.0, 1.0))["(ω₁+ω₃)/2"]
    trace = trace_boundary(plate, tongue.resonance.centre, [0.5, 0.8])
    for eps, lower, upper in zip(trace.eps, trace.lower, trace.upper, strict=True):
        # as above
        off = 0.05 * abs((lower + upper) / 2 - tongue.resonance.centre) + 0.05 * (upper - lower)
        assert np.interp(eps, tongue.eps, tongue.lower) == pytest.approx(lower, abs=off)
        assert np.interp(eps, tongue.eps, tongue.upper) == pytest.approx(upper, abs=off)
    assert monodromy(plate, *tongue.witness).kind > Kind.STABLE


def test_damping_lifts_the_tip_of_a_narrow_region() -> None:
    damped = mathieu(damping=0.002)
    tongue = tongues_of(damped, (0.95, 1.05), (0.0, 0.4))["2ω₁/2"]
    # where the largest growth over Omega is zero, by integration
    at = tongue.lower[0]
    growth = [monodromy(damped, at, tongue.eps[0] + shift).growth_rate for shift in (-0.004, 0.004)]
    assert growth[0] < 0 < growth[1]


def test_a_window_above_the_feet_is_followed_from_below() -> None:
    tongue = tongues_of(mathieu(), (0.6, 0.75), (0.4, 0.6))["2ω₁/3"]
    assert tongue.eps[0] == 0.4
    assert tongue.lower[0] < tongue.upper[0]
    assert monodromy(mathieu(), (tongue.lower[0] + tongue.upper[0]) / 2, 0.4).kind > Kind.STABLE


def test_resonances_without_a_region_have_no_tongue() -> None:
    # a symmetric coupling has no difference resonance; the one of the sum is what is left
    labels = tongues_of(coupled_mathieu("sum"), (2.5, 2.9), (0.0, 0.1))
    assert set(labels) == {"ω₁+ω₂"}
    assert tongues_of(mathieu(damping=0.3), (0.5, 2.5), (0.0, 0.2)) == {}


def test_a_combination_resonance_with_unequal_damping() -> None:
    d, omega = np.array([0.0005, 0.008]), np.array([1.0, 1.7])
    system = coupled_mathieu("sum", omega, damping=d)
    tongue = tongues_of(system, (2.65, 2.75), (0.0, 0.1))["ω₁+ω₂"]
    # to first order (Bolotin 1964): closed below eps = 2 sqrt(d1 d2 omega1 omega2), then half as wide as here
    assert tongue.eps[0] == pytest.approx(2 * np.sqrt(d.prod() * omega.prod()), rel=0.02)
    for eps in (0.03, 0.1):
        half = d.sum() / 2 * np.sqrt(eps**2 / (4 * omega.prod() * d.prod()) - 1)
        lower, upper = (np.interp(eps, tongue.eps, side) for side in (tongue.lower, tongue.upper))
        assert (upper - lower) / 2 == pytest.approx(half, rel=0.02)
        for inwards in (-0.1, 0.1):  # the centreline is moved by terms with eps^2, which integration knows
            for edge, sign in ((lower, 1), (upper, -1)):
                kind = monodromy(system, edge + sign * inwards * half, eps).kind
                assert (kind > Kind.STABLE) == (inwards > 0)


def test_a_region_goes_on_where_another_one_was_in_its_way() -> None:
    plate = MovingPlate(axial_terms=2, lateral_terms=3)
    segments = [one for one in segments_of(plate, (33.0, 34.0), (0.0, 1.0)) if one.resonance.label == "(ω₂+ω₅)/2"]
    assert len(segments) > 1
    for below, above in pairwise(segments):
        assert below.eps[-1] < above.eps[0]
    for segment in segments:
        lower, upper = (np.interp(segment.witness[1], segment.eps, side) for side in (segment.lower, segment.upper))
        assert lower <= segment.witness[0] <= upper
        assert monodromy(plate, *segment.witness).kind > Kind.STABLE


def test_columns_of_few_errors_share_the_plans_of_their_doublings(monkeypatch: pytest.MonkeyPatch) -> None:
    errors = []

    def spied(sampler: Sampler, eps: FloatArray, L: int, error: float) -> Spectra:
        errors.append(error)
        return spectra(sampler, eps, L, error)

    monkeypatch.setattr("floquet.regions.tongues.spectra", spied)
    found = tongues_of(mathieu(), (0.24, 1.1), (0.0, 0.3))
    assert len(errors) >= len(found) > 5
    assert len(set(errors)) == 2


def test_a_stable_point_is_not_sure() -> None:
    scan = Scan(Window(mathieu(), (0.6, 0.8), (0.0, 0.4)))
    (one,) = [one for one in tongues_expected(mathieu(), 0.4, 0.66, 0.67) if one.resonance.j == 3]
    tracer = _TongueTracer(scan.window, one, scan.grid.steps, Workspace())
    trace = trace_boundary(mathieu(), 2 / 3, 0.3, j=3)
    lower, upper = float(trace.lower[0]), float(trace.upper[0])
    assert tracer._is_sure((lower + upper) / 2, 0.3)
    assert not tracer._is_sure(lower - 0.1 * (upper - lower), 0.3)


def test_a_region_that_passes_a_column_between_two_levels_needs_no_other(monkeypatch: pytest.MonkeyPatch) -> None:
    # the seventh tongue moves from 2/7 by 0.003, 5e-5 from level to level, and is much narrower
    scan = Scan(Window(mathieu(), (0.2, 0.4), (0.0, 0.4), spans=20))
    scan.add([*np.linspace(0.2, 0.4, 17), 0.2845])
    some = [one for one in tongues_expected(mathieu(), 0.4, 0.28, 0.29) if one.resonance.j == 7]

    def none(*_: object) -> None:
        raise AssertionError("a column was computed")

    monkeypatch.setattr("floquet.regions.tongues._TongueTracer._with_column", none)
    (tongue,) = trace_tongues(some, scan)
    assert tongue.witness[0] == 0.2845
    assert monodromy(mathieu(), *tongue.witness).kind > Kind.STABLE
    assert tongue.sure  # a column of this one point tells
    edges = sorted(
        brentq(lambda Omega, side=side: 4 / Omega**2 - side(7, 0.8 / Omega**2), 0.27, 0.29, xtol=1e-16)
        for side in (mathieu_a, mathieu_b)
    )
    # a cubic through columns 0.0125 apart
    assert (tongue.lower[-1] + tongue.upper[-1]) / 2 == pytest.approx(sum(edges) / 2, abs=1e-5)


def segments_of_one(plate: MovingPlate, wanted: tuple[int, int, int]) -> list[Tongue]:
    """The segments of one region (p, q, j), from columns as far apart as those of `trace_regions`."""
    scan = Scan(Window(plate, (5.0, 90.0), (0.0, 1.0)))
    scan.add(np.linspace(5.0, 90.0, 129))
    member = plate.at(47.5)
    named = [one for one in resonances_of(member, 5.0, 90.0) if one[:3] == wanted]
    some = tongues_expected(member, 1.0, 5.0, 90.0, named)
    return trace_tongues(some, scan)


def test_a_region_is_followed_beside_a_wide_one_that_is_on_one_side() -> None:
    # (ω₄+ω₁₁)/2 runs along the edge of 2ω₄: from eps = 0.43 on, the columns to the left of it lie in that
    plate = MovingPlate(inplane="static")
    (segment,) = segments_of_one(plate, (11, 4, 2))
    assert segment.eps[-1] > 0.46
    # within a tenth of the tolerance that regions have in this window, 0.085
    chart = stability_chart(plate, np.linspace(81.5, 82.0, 501), [0.3, 0.44, 0.46], progress=False, audit=0)
    for eps, kind in zip(chart.eps, chart.kind, strict=True):
        centre = (np.interp(eps, segment.eps, segment.lower) + np.interp(eps, segment.eps, segment.upper)) / 2
        assert np.abs(chart.Omega[kind == Kind.COMPLEX] - centre).min() < 0.0085


def test_a_witness_is_where_its_modes_are_free() -> None:
    # at eps = 0.9, a level before modes are unstable with a third one, a column passes through what looks like a region
    plate = MovingPlate(inplane="static", load=EdgeLoad.partial(0.5))
    (segment,) = segments_of_one(plate, (12, 1, 3))
    assert segment.sure
    assert monodromy(plate, *segment.witness).kind == Kind.COMPLEX


def test_a_region_that_bends_is_measured_where_it_is_known_least() -> None:
    # from eps = 0.8 on, (ω₁+ω₃)/3 has a wide region on its right, and columns beyond that are far away
    plate = MovingPlate(inplane="static")
    segment = segments_of_one(plate, (3, 1, 3))[0]
    chart = stability_chart(plate, np.linspace(14.3, 15.0, 701), [0.86, 0.91], progress=False, audit=0)
    for eps, kind in zip(chart.eps, chart.kind, strict=True):
        centre = (np.interp(eps, segment.eps, segment.lower) + np.interp(eps, segment.eps, segment.upper)) / 2
        assert np.abs(chart.Omega[kind == Kind.COMPLEX] - centre).min() < 0.017
