"""`plane_chart` over any two parameters: known charts, what cells share, cells without a system, files, bad input."""

from __future__ import annotations

import math
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.special import mathieu_a, mathieu_b

from floquet import Kind, PlaneChart, Point, monodromy, plane_chart, stability_chart
from floquet.chart import filling
from periodic import AnySystem, FirstOrderSystem, PeriodicSystem, Term, waveforms
from periodic.checks import FloatArray
from periodic.examples import blade_flap, mathieu, quadrupole_trap
from plate import MovingPlate
from tests.floquet.oracle_systems import random_system

CELLS = ("growth_rate", "multiplier", "kind", "error")


def plane(make: Any, x: Any, y: Any, **options: Any) -> PlaneChart:
    return plane_chart(make, x, y, **{"n_jobs": 1, "progress": False, "audit": 0} | options)


@cache
def a_mathieu(a: float) -> PeriodicSystem:
    return mathieu(delta=a)


def canonical(a: float, q: float) -> Point:
    return Point(a_mathieu(a), 2.0, 2 * q)


def every_cell_agrees(make: Any, chart: PlaneChart) -> bool:
    """Compare every cell with `monodromy`: growth within the errors, no contradiction."""
    for i, y in enumerate(chart.y.tolist()):
        for j, x in enumerate(chart.x.tolist()):
            point = make(x, y)
            exact = monodromy(point.system, point.Omega, point.eps)
            difference = abs(chart.growth_rate[i, j] - exact.growth_rate) * 2 * np.pi / point.Omega
            assert difference <= 3 * (chart.error[i, j] + exact.log_modulus_error) + 1e-13
            if chart.kind[i, j] >= 0 and exact.kind >= 0:
                assert (chart.kind[i, j] > 0) == (exact.kind > 0)
    return True


# ---- charts that are known ----


@pytest.mark.parametrize("count", [40, pytest.param(200, marks=pytest.mark.slow)])
def test_mathieu_in_its_own_parameters(count: int) -> None:
    """Every cell that is not within 1e-8 of an edge is right, with its kind: DLMF 28.2(v)."""
    chart = plane(canonical, ("a", np.linspace(-1, 6, count)), ("q", np.linspace(0, 10, 200)), audit=8)
    a, q = np.meshgrid(chart.x, chart.y)
    expected, nearest = np.where(a < mathieu_a(0, q), Kind.PLUS_ONE, Kind.STABLE), np.abs(a - mathieu_a(0, q))
    for n in range(1, 8):
        low, high = mathieu_b(n, q), mathieu_a(n, q)
        expected[(a > low) & (a < high)] = Kind.MINUS_ONE if n % 2 else Kind.PLUS_ONE
        nearest = np.minimum(nearest, np.minimum(np.abs(a - low), np.abs(a - high)))
    clear = nearest > 1e-8
    assert clear.mean() > 0.99
    assert (chart.kind[clear] == expected[clear]).all()
    assert chart.audit is not None
    assert chart.audit.ok


def test_a_digital_trap_whose_mean_grows_with_the_amplitude() -> None:
    """Two exponentials a period: duty 54/46, so that the mean stiffness is a + 0.16 q."""
    duty = 0.54
    wave = waveforms.rectangular(duty)
    chart = plane(
        lambda a, q: Point(quadrupole_trap(a, wave), 2.0, q),
        ("a", [-0.1, 0.0, 0.15, 0.4]),
        ("q", np.linspace(0, 1.5, 16)),
    )
    for i, q in enumerate(chart.y.tolist()):
        for j, a in enumerate(chart.x.tolist()):
            largest = max(exact_log_modulus(sign * a, sign * 2 * q, duty) for sign in (1, -1))
            assert chart.growth_rate[i, j] * math.pi == pytest.approx(largest, abs=max(1e-11, 2 * chart.error[i, j]))
            if chart.kind[i, j] >= 0:
                assert (chart.kind[i, j] > 0) == (largest > 1e-7)
    assert {*np.unique(chart.kind).tolist()} >= {0, 1, 2}


def exact_log_modulus(mean: float, amplitude: float, duty: float) -> float:
    """log|mu| of x'' + (mean ± amplitude) x = 0 over a period of pi."""
    product = np.eye(2)
    for stiffness, span in ((mean + amplitude, duty * math.pi), (mean - amplitude, (1 - duty) * math.pi)):
        root = np.sqrt(complex(stiffness))
        c = np.cos(root * span).real
        s = span if root == 0 else (np.sin(root * span) / root).real
        product = np.array([[c, s], [-stiffness * s, c]]) @ product
    half = abs(np.trace(product)) / 2
    return math.acosh(half) if half > 1 else 0.0


def test_a_flapping_blade() -> None:
    """Growth rates of references-general.json at gamma = 12; other Lock numbers by `monodromy`."""
    reference = {0.5: -0.49668687573779985, 1.5: 0.09061360827909941, 2.5: 0.9805073919396903}

    def make(gamma: float, mu: float) -> Point:
        return Point(blade_flap(gamma), 1.0, mu)

    chart = plane(make, ("gamma", [4.0, 8.0, 12.0]), ("mu", [0.0, *reference]))
    assert chart.growth_rate[1:, 2] == pytest.approx(list(reference.values()), abs=1e-11)
    assert every_cell_agrees(make, chart)
    assert (chart.kind[0] == Kind.STABLE).all()


# ---- what cells share ----


class Rotor:
    """A family: the system depends on the frequency."""

    def __init__(self, damping: float) -> None:
        self.damping = damping

    def at(self, Omega: float) -> PeriodicSystem:
        return PeriodicSystem(
            np.eye(2),
            [[0, -Omega], [Omega, 0]],
            self.damping * np.eye(2),
            np.diag([1.0, 2.0]),
            [[[0.5, 0.1], [0.1, 0.4]]],
        )


@pytest.mark.parametrize("family", [random_system(23, 4, 2), Rotor(0.01)], ids=["system", "family"])
def test_a_stability_chart_is_a_plane(family: Any) -> None:
    """The same bits, whichever axis is which, and whether systems are the same or made anew."""
    Omega, eps = np.array([0.8, 0.85, 1.3, 2.0, 2.9]), np.array([0.0, 0.1, 0.35, 0.5])
    whole = stability_chart(family, Omega, eps, n_jobs=1, progress=False, audit=3)
    upright = plane(lambda x, y: Point(family, x, y), ("Omega", Omega), ("eps", eps), audit=3)
    lying = plane(lambda x, y: Point(family, y, x), ("eps", eps), ("Omega", Omega))
    for name in CELLS:
        np.testing.assert_array_equal(getattr(upright, name), getattr(whole, name))
        np.testing.assert_array_equal(getattr(lying, name).T, getattr(whole, name))
    assert upright.audit is not None
    assert whole.audit is not None
    np.testing.assert_array_equal(upright.audit.differences, whole.audit.differences)


def test_equal_systems_are_computed_together(monkeypatch: pytest.MonkeyPatch) -> None:
    calls: list[tuple[int, int]] = []
    whole = filling.chart_batch

    def counted(systems: Any, Omega: FloatArray, eps: FloatArray, steps: float) -> Any:
        calls.append((len(Omega), len(eps)))
        return whole(systems, Omega, eps, steps)

    monkeypatch.setattr(filling, "chart_batch", counted)
    plane(lambda a, q: Point(mathieu(a), 2.0, q), ("a", [0.5, 1.0]), ("q", [0.0, 0.1, 0.2]))
    assert sorted(calls) == [(1, 3), (1, 3)]  # columns along eps
    calls.clear()
    # the amplitude in the matrices, and no excitation at all
    plane(
        lambda a, q: Point(PeriodicSystem([[1]], stiffness=[[a]], cosine=[[q]]), 2.0, 1.0),
        ("a", [0.5, 1.0]),
        ("q", [0.0, 0.1, 0.2]),
    )
    assert sorted(calls) == [(1, 1), (1, 1), (1, 2), (1, 2)]
    calls.clear()
    plane(lambda a, w: Point(mathieu(a), w, 0.1), ("a", [0.5, 1.0]), ("Omega", [1.0, 1.1, 2.0]))
    assert sorted(calls) == [(3, 1), (3, 1)]  # one amplitude at many frequencies
    calls.clear()
    plane(lambda a, w: Point(Rotor(a), w, 0.1), ("a", [0.5, 1.0]), ("Omega", [1.0, 1.1]))
    assert sorted(calls) == [(1, 1)] * 4  # families that nobody can compare


def test_cells_that_share_nothing() -> None:
    def make(size: float, shift: float) -> Point:
        one = random_system(5, 2, 1, damping=0.1)
        stiffness = one.stiffness + shift * np.eye(2)
        scaled = PeriodicSystem(one.mass, one.gyroscopic, one.damping, stiffness, size * one.cosine, one.sine)
        return Point(scaled, 1.0 + 0.3 * size + shift, 0.2 * size)

    chart = plane(make, ("size", [0.5, 0.7, 2.0, 2.1]), ("shift", [0.1, 0.5, 0.52]))
    assert every_cell_agrees(make, chart)
    assert chart.Omega[2, 3] == pytest.approx(1.0 + 0.63 + 0.52)
    assert chart.eps[2, 3] == pytest.approx(0.42)


def test_excitations_that_differ_in_size() -> None:
    """The amplitude may be a part of the matrices, with terms and negative factors, too."""
    one = random_system(6, 2, 1, damping=0.1)

    def make(size: float, damping: float) -> Point:
        terms = [Term("damping", 0.3 * size * np.eye(2), waveforms.sine(2))]
        damped = one.damping + damping * np.eye(2)
        return Point(
            PeriodicSystem(one.mass, one.gyroscopic, damped, one.stiffness, size * one.cosine, terms=terms), 1.3, 0.7
        )

    assert every_cell_agrees(make, plane(make, ("size", [-0.9, -0.1, 0.0, 0.3, 1.1]), ("damping", [0.0, 0.1])))


def test_one_point_many_times() -> None:
    chart = plane(lambda x, y: Point(a_mathieu(1.0), 2.0, 0.1 * round(x)), ("x", [0.9, 1.1, 2.0]), ("y", [0.0, 1.0]))
    exact = [monodromy(mathieu(), 2.0, eps).growth_rate for eps in (0.1, 0.1, 0.2)]
    assert chart.growth_rate == pytest.approx(np.array([exact, exact]), abs=1e-9)


def test_first_order_systems() -> None:
    @cache
    def lag(loss: float) -> FirstOrderSystem:
        A = [[0.0, 1.0, 0.0], [-1.0, 0.0, -1.0], [0.0, 0.05, -loss]]
        return FirstOrderSystem(A, cosine=[[0.0, 0.0, 0.0], [-0.6, 0.0, 0.0], [0.0, 0.0, 0.0]])

    def make(Omega: float, loss: float) -> Point:
        return Point(lag(loss), Omega, 0.4)

    assert every_cell_agrees(make, plane(make, ("Omega", [1.8, 2.0, 3.1]), ("loss", [0.1, 0.5])))


def test_a_plate_at_one_amplitude() -> None:
    @cache
    def plate(speed: float) -> MovingPlate:
        return MovingPlate(speed=speed, axial_terms=2, lateral_terms=2, damping=1e-3)

    def make(speed: float, Omega: float) -> Point:
        return Point(plate(speed), Omega, 0.2)

    chart = plane(make, ("speed", [0.0, 1.0, 3.0, 9.0]), ("Omega", [15.0, 20.0, 40.0, 60.0]))
    assert chart.refused.tolist() == [[False, False, False, True]] * 4
    shown = plane(make, ("speed", [0.0, 1.0, 3.0]), ("Omega", [15.0, 20.0, 40.0, 60.0]))
    assert every_cell_agrees(make, shown)


# ---- cells without a system ----


def test_refused_cells() -> None:
    def make(a: float, q: float) -> Point:
        if a > 2 and q > 0.5:
            raise ValueError(f"a = {a!r} is beyond divergence; give less")
        return canonical(a, q)

    chart = plane(make, ("a", [1.0, 1.5, 2.5]), ("q", [0.1, 0.6, 0.9]), audit=5)
    assert chart.refused.tolist() == [[False, False, False], [False, False, True], [False, False, True]]
    assert chart.remark == "2 of 9 cells are no system, first a = 2.5, q = 0.6: a = 2.5 is beyond divergence; give less"
    assert np.isnan(chart.growth_rate[chart.refused]).all()
    assert np.isnan(chart.error[chart.refused]).all()
    assert (chart.kind[chart.refused] == Kind.UNDECIDED).all()
    whole = plane(canonical, ("a", [1.0, 1.5, 2.5]), ("q", [0.1, 0.6, 0.9]))
    there = ~chart.refused
    assert (chart.kind[there] == whole.kind[there]).all()
    assert np.allclose(chart.growth_rate[there], whole.growth_rate[there], rtol=0, atol=1e-10)
    assert chart.audit is not None
    assert len(chart.audit.cells) >= 5
    assert not chart.refused[tuple(chart.audit.cells.T)].any()
    said = "PlaneChart(a 1 to 2.5 (3), q 0.1 to 0.9 (3): 71.4% of the cells unstable, 22.2% refused)"
    assert repr(chart) == said


def test_a_plane_that_is_refused_at_its_ends() -> None:
    def make(a: float, q: float) -> Point:
        if (a, q) != (1.5, 0.6):
            raise ValueError("a is not 1.5; give that")
        return canonical(a, q)

    chart = plane(make, ("a", [0.5, 1.0, 1.1, 1.5]), ("q", [0.1, 0.6, 0.9, 1.0]))
    assert chart.refused.sum() == 15
    assert chart.remark.startswith("15 of 16 cells are no system, first a = 0.5, q = 0.1: a is not 1.5")
    assert chart.growth_rate[1, 3] == pytest.approx(monodromy(mathieu(1.5), 2.0, 1.2).growth_rate, abs=1e-10)


def test_a_plane_without_any_system_is_refused() -> None:
    def make(a: float, q: float) -> Point:
        raise ValueError("no such trap")

    with pytest.raises(ValueError, match=r"make refuses all 4 cells, first a = 1.0, q = 0.0: no such trap"):
        plane(make, ("a", [1.0, 2.0]), ("q", [0.0, 1.0]))


def test_what_make_does_wrong_is_not_hidden() -> None:
    def make(a: float, q: float) -> Point:
        if q == 0.7:
            raise ZeroDivisionError("a mistake")
        return canonical(a, q)

    for n_jobs in (1, 2):
        with pytest.raises(ZeroDivisionError, match="a mistake"):
            plane(make, ("a", np.linspace(0, 1, 60)), ("q", [0.0, 0.5, 0.7, 0.8, 0.9]), n_jobs=n_jobs)


# ---- workers, files ----


def test_a_plane_goes_on_where_it_was(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    axes = ("a", np.linspace(0, 2, 20)), ("q", [0.1, 0.6])
    first = plane(canonical, *axes, cache=tmp_path)
    assert len(list(tmp_path.glob("*.tile"))) == 3
    two = plane(canonical, *axes, n_jobs=2)
    monkeypatch.setattr(filling, "chart_batch", None)  # nothing is left to compute
    again = plane(canonical, *axes, cache=tmp_path)
    for name in CELLS:
        np.testing.assert_array_equal(getattr(first, name), getattr(two, name))
        np.testing.assert_array_equal(getattr(first, name), getattr(again, name))


def test_save_load_and_xarray(tmp_path: Path) -> None:
    pytest.importorskip("xarray")

    def make(a: float, Omega: float) -> Point:
        if a > 2:
            raise ValueError("too much")
        return Point(mathieu(a), Omega, 0.5)

    chart = plane(make, ("a", [1.0, 2.5]), ("Omega", [1.0, 2.0, 3.0]), audit=2)
    chart.save(tmp_path / "plane.npz")
    loaded = PlaneChart.load(tmp_path / "plane.npz")
    for name in ("x", "y", "Omega", "eps", "refused", *CELLS):
        np.testing.assert_array_equal(getattr(chart, name), getattr(loaded, name))
    assert (loaded.names, loaded.remark, loaded.rigid) == (chart.names, chart.remark, chart.rigid)
    assert loaded.audit is not None
    data = chart.to_xarray()
    assert data.kind.dims == ("Omega", "a")
    assert data.Omega.values.tolist() == [1.0, 2.0, 3.0]
    assert data.kind.sel(a=1.0, Omega=2.0).item() == Kind.MINUS_ONE
    stability_chart(mathieu(), [1.0], [0.1], progress=False, audit=0).save(tmp_path / "other.npz")
    with pytest.raises(ValueError, match="is not a saved chart"):
        PlaneChart.load(tmp_path / "other.npz")


# ---- bad input ----


def no_system(a: float, q: float) -> AnySystem:
    return mathieu(a)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"make": None}, "make = None cannot be called"),
        ({"make": no_system}, r"make gave .* at a = 1.0, q = 0.1; it must give a Point"),
        ({"x": [1.0, 2.0, 3.0]}, "x = .* is no axis; give a name and values"),
        ({"x": ("a", [])}, r"x \(a\) is empty"),
        ({"x": ("a", [2.0, 1.0])}, r"x \(a\) is not strictly increasing"),
        ({"x": ("kind", [1.0])}, "x is called 'kind'"),
        ({"y": ("a", [1.0])}, "x and y are both called 'a'"),
        ({"y": ("q", [np.nan])}, r"y \(q\) has the entry nan"),
        ({"n_jobs": 0}, "n_jobs = 0"),
        ({"audit": -1}, "audit = -1"),
    ],
)
def test_arguments_are_checked(arguments: dict[str, Any], message: str) -> None:
    good: dict[str, Any] = {"make": canonical, "x": ("a", [1.0]), "y": ("q", [0.1])}
    with pytest.raises(ValueError, match=message):
        plane(**good | arguments)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((None, 1.0, 0.1), "system = None is no system"),
        ((PeriodicSystem, 1.0, 0.1), "is no system"),
        ((mathieu(), 0.0, 0.1), "Omega = 0.0 is out of range; give a positive number"),
        ((mathieu(), 1.0, math.nan), "eps = nan is out of range"),
    ],
)
def test_points_are_checked(arguments: tuple[Any, ...], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        Point(*arguments)
