"""`trace_plane`: known boundaries, corners, narrow regions, names; how crossings are joined."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest
from scipy.linalg import eigvalsh_tridiagonal

from floquet import Kind, PlaneChart, Point, monodromy, plane_chart
from floquet.plane import PlaneBoundary, trace_plane
from floquet.plane.joining import Corner, joined, lines
from periodic import PeriodicSystem, waveforms
from periodic.checks import FloatArray
from periodic.examples import coupled_mathieu, mathieu, quadrupole_trap

a_mathieu = cache(mathieu)
TERMS = 40


def canonical(a: float, q: float) -> Point:
    return Point(a_mathieu(a), 2.0, 2 * q)


def chart(make: Any, x: Any, y: Any) -> PlaneChart:
    return plane_chart(make, x, y, n_jobs=1, progress=False, audit=0)


def trace(make: Any, x: Any, y: Any, **options: Any) -> list[PlaneBoundary]:
    return trace_plane(make, chart(make, x, y), progress=False, **options)


def characteristic_values(q: float) -> dict[str, FloatArray]:
    """Mathieu's a and b of even and odd order from tridiagonal matrices: DLMF 28.4(ii)."""
    k, off = np.arange(TERMS), np.full(TERMS - 1, q)
    odd = (2.0 * k + 1) ** 2
    first = np.where(k == 0, q, 0.0)
    even_off = off.copy()
    even_off[0] *= np.sqrt(2)
    found = {
        "a even": eigvalsh_tridiagonal((2.0 * k) ** 2, even_off),
        "b even": eigvalsh_tridiagonal((2.0 * k + 2) ** 2, off),
        "a odd": eigvalsh_tridiagonal(odd + first, off),
        "b odd": eigvalsh_tridiagonal(odd - first, off),
    }
    return {name: np.asarray(values, float) for name, values in found.items()}


def test_boundaries_of_mathieu() -> None:
    """Every point is a characteristic value of a tridiagonal matrix, of the class that belongs to its kind."""
    found = trace(canonical, ("a", np.linspace(-0.9, 5.1, 16)), ("q", np.linspace(0.05, 4.05, 9)), orders=2)
    assert sorted(one.label for one in found) == ["", "2ω₁", "2ω₁", "2ω₁/2", "2ω₁/2"]
    assert not any(one.closed for one in found)
    for one in found:
        for a, q, kind in zip(one.x.tolist(), one.y.tolist(), one.kind.tolist(), strict=True):
            classes = ("a even", "b even") if kind == Kind.PLUS_ONE else ("a odd", "b odd")
            values = np.concatenate([characteristic_values(q)[name] for name in classes])
            assert np.abs(values - a).min() < 1e-10
        assert one.y.min() == 0.05
    # 1e-3 wide at the bottom, between cells 0.4 apart
    start = [one.x[one.y.argmin()] for one in found if one.label == "2ω₁/2"]
    assert abs(start[0] - start[1]) == pytest.approx(0.05**2 / 2, rel=1e-2)


@pytest.mark.parametrize("swapped", [False, True])
def test_the_apex_of_a_quadrupole_trap(swapped: bool) -> None:
    """The first stable region ends where a boundary at +1 and one at -1 cross: q, a to 1e-12."""
    trap = cache(quadrupole_trap)

    def make(q: float, a: float) -> Point:
        return Point(trap(a), 2.0, q)

    def turned(a: float, q: float) -> Point:
        return make(q, a)

    q, a = ("q", np.linspace(0.05, 0.95, 6)), ("a", np.linspace(-0.31, 0.31, 8))
    (outline,) = trace(turned, a, q) if swapped else trace(make, q, a)
    assert outline.corner.sum() == 2
    at_q, at_a = (outline.y, outline.x) if swapped else (outline.x, outline.y)
    assert at_q[outline.corner] == pytest.approx([0.70599606971337] * 2, abs=1e-12)
    assert np.sort(at_a[outline.corner]) == pytest.approx([-0.23699399311247, 0.23699399311247], abs=1e-12)


def test_a_digital_trap() -> None:
    """Boundaries of a rectangular wave are where the trace of a product of two matrices is 2 or -2."""
    duty = 0.54
    wave = waveforms.rectangular(duty)
    trap = cache(lambda a: quadrupole_trap(a, wave))
    found = trace(lambda a, q: Point(trap(a), 2.0, q), ("a", [-0.1, 0.05]), ("q", [0.3, 0.6, 0.9]), orders=0)
    points = [(a, q) for one in found for a, q in zip(one.x.tolist(), one.y.tolist(), strict=True)]
    assert len(points) > 1
    for a, q in points:
        offs = [abs(abs(half_trace(sign * a, sign * 2 * q, duty)) - 1) for sign in (1, -1)]
        assert min(offs) < 1e-9


def half_trace(mean: float, amplitude: float, duty: float) -> float:
    product = np.eye(2)
    for stiffness, span in ((mean + amplitude, duty * np.pi), (mean - amplitude, (1 - duty) * np.pi)):
        root = np.sqrt(complex(stiffness))
        c, s = np.cos(root * span).real, (np.sin(root * span) / root).real
        product = np.array([[c, s], [-stiffness * s, c]]) @ product
    return float(np.trace(product)) / 2


@pytest.mark.parametrize("damping", [0.0, 0.02])
def test_combination_resonance(damping: float) -> None:
    """Edges of complex kind: unstable on one side and stable on the other within 1e-7, by `monodromy`."""

    @cache
    def pair(frequency: float) -> PeriodicSystem:
        return coupled_mathieu("sum", (1.0, frequency), damping=(damping, damping))

    def make(frequency: float, Omega: float) -> Point:
        return Point(pair(frequency), Omega, 0.3)

    found = trace(make, ("frequency", [1.5, 1.7, 1.9]), ("Omega", np.linspace(2.2, 3.2, 7)))
    assert [one.label for one in found] == ["ω₁+ω₂", "ω₁+ω₂"]
    for one in found:
        assert (one.kind == Kind.COMPLEX).all()
        for x, y in zip(one.x.tolist(), one.y.tolist(), strict=True):
            kinds = [monodromy(pair(x), y + shift, 0.3).kind for shift in (-1e-7, 1e-7)]
            assert sorted(kinds) == [Kind.STABLE, Kind.COMPLEX]


def test_lines_end_at_refused_cells() -> None:
    def make(a: float, q: float) -> Point:
        if a > 0.9:
            raise ValueError("too much")
        return canonical(a, q)

    found = trace(make, ("a", np.linspace(0.1, 1.3, 7)), ("q", np.linspace(0.1, 0.5, 5)))
    assert len(found) == 1
    assert found[0].x.max() <= 0.9
    assert [one.label for one in found] == ["2ω₁"]


def test_arguments_are_checked() -> None:
    whole = chart(canonical, ("a", [0.5, 0.9]), ("q", [0.1, 0.2]))
    with pytest.raises(ValueError, match=r"(?s)chart = .* is no chart of a plane"):
        trace_plane(canonical, whole.kind, progress=False)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="orders = -1"):
        trace_plane(canonical, whole, orders=-1, progress=False)
    with pytest.raises(ValueError, match="progress = 3"):
        trace_plane(canonical, whole, progress=3)  # type: ignore[arg-type]


def test_crossings_are_joined_round_regions() -> None:
    plus, minus = Kind.PLUS_ONE, Kind.MINUS_ONE
    two = [Corner("a", plus, False), Corner("b", plus, True)]
    assert joined(two, lambda *_: False) == [("b", "a")]
    four = [Corner("a", plus, True), Corner("b", plus, False), Corner("c", plus, True), Corner("d", plus, False)]
    assert joined(four, lambda *_: False) == [("a", "b"), ("c", "d")]
    assert joined(four, lambda *_: True) == [("b", "c"), ("d", "a")]
    others = [*four[:2], Corner("c", minus, True), Corner("d", minus, False)]
    assert joined(others, lambda *_: True) == [("a", "b"), ("c", "d")]  # two kinds have a stable gap between them
    six = [*four, Corner("e", minus, True), Corner("f", minus, False)]
    assert joined(six, lambda *_: True) == [("e", "f"), ("b", "c"), ("d", "a")]


def test_pairs_make_lines() -> None:
    found = lines([(1, 2), (3, 2), (5, 6), (6, 7), (7, 5)])
    assert found[0] == ([1, 2, 3], False)
    assert found[1] == ([5, 6, 7], True)
