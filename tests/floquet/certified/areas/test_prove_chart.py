"""Proved charts against exact edges, proofs of points, and chart and `monodromy`, which share no code with them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.special import mathieu_a, mathieu_b

from floquet import monodromy
from periodic import PeriodicSystem, Term, waveforms
from periodic.examples import coupled_mathieu, gyroscopic_rotor, mathieu
from plate import MovingPlate

pytest.importorskip("flint", reason="python-flint, the extra certify, is not installed")

from floquet.certified import ProvedChart, certified_growth, certified_monodromy, prove_chart
from floquet.certified.areas.coefficients import coefficients_of
from floquet.certified.areas.patches import patch_of

RNG = np.random.default_rng(19)
# Coupled oscillators whose excitation is odd in time, so that it is even about another phase; and with both phases.
SINE = PeriodicSystem(np.eye(2), stiffness=np.diag([1.0, 2.9]), sine=[[[0.2, 1.0], [-0.7, 0.1]]])
BOTH = PeriodicSystem(
    [[2.0, 0.3], [0.3, 1.0]],
    [[0.0, 0.4], [-0.4, 0.0]],
    [[0.1, 0.02], [0.02, 0.05]],
    [[3.0, 0.2], [0.1, 4.0]],
    [np.eye(2), [[0.3, 0.1], [0.0, 0.2]]],
    [[[0.1, 0.5], [0.2, 0.0]], np.eye(2)],
)
PLATE = MovingPlate(axial_terms=2, lateral_terms=2)
WINDOWS: dict[str, tuple[Any, tuple[float, float], tuple[float, float]]] = {
    "mathieu": (mathieu(), (0.8, 3.0), (0.0, 0.6)),
    "mathieu damped": (mathieu(1.0, 0.05), (0.8, 3.0), (0.0, 0.6)),
    "coupled": (coupled_mathieu(), (2.4, 3.0), (0.0, 0.4)),
    "coupled, difference": (coupled_mathieu("difference"), (0.6, 0.75), (0.1, 0.4)),
    "coupled, damped": (coupled_mathieu(damping=(0.02, 0.04)), (2.4, 3.0), (0.0, 0.4)),
    "coupled, sine": (SINE, (1.8, 2.9), (0.1, 0.3)),
    "rotor": (gyroscopic_rotor((4.0, 5.0)), (3.9, 4.5), (0.1, 0.5)),
    "both phases": (BOTH, (1.8, 4.0), (0.0, 0.6)),
    "plate": (PLATE, (50.0, 60.0), (0.0, 0.3)),
}


@pytest.fixture(scope="module")
def charts() -> dict[str, ProvedChart]:
    return {name: prove_chart(*window, least=1 / 64, progress=False) for name, window in WINDOWS.items()}


def test_mathieus_edges_are_between_proved_points(charts: dict[str, ProvedChart]) -> None:
    """DLMF 28.2(v): a = 4 / Omega^2 = a_n(q) or b_n(q), q = 2 eps / Omega^2; 1e-8 on both sides, and the strips."""
    chart = charts["mathieu"]
    count = 0
    for q in np.linspace(0.05, 2.0, 40).tolist():
        for characteristic, order in ((mathieu_b, 1), (mathieu_a, 1), (mathieu_b, 2), (mathieu_a, 2)):
            a = float(characteristic(order, q))
            Omega = 2 / np.sqrt(a) if a > 0 else 0.0
            eps = q * Omega**2 / 2
            if not (0.8 < Omega < 3.0 and 0.01 < eps < 0.6):
                continue
            sides = {str(chart.verdict(Omega + side, eps)) for side in (-1e-8, 1e-8)}
            assert sides == {"stable", "unstable"}, (Omega, eps)
            if count % 8 == 0:
                assert any(s.lower - 1e-14 <= Omega <= s.upper + 1e-14 and s.thickness < 1e-8 for s in chart.edges(eps))
            count += 1
    assert count > 60


@pytest.mark.parametrize("name", WINDOWS)
def test_verdicts_are_those_of_proofs_of_points(charts: dict[str, ProvedChart], name: str) -> None:
    """At random points and one thickness outside the strips, on both sides of every edge."""
    family, (low, high), (bottom, top) = WINDOWS[name]
    chart = charts[name]
    points = list(zip(RNG.uniform(low, high, 4), RNG.uniform(bottom, top, 4), strict=True))
    near = [
        (Omega, strip.eps)
        for strip in chart.edges(0.6 * top)
        for Omega in (strip.lower - strip.thickness, strip.upper + strip.thickness)
        if strip.below != strip.above and low < Omega < high
    ]
    assert near
    decided = 0
    for Omega, eps in [*points, *near]:
        said = str(chart.verdict(Omega, eps))
        if said != "open":
            decided += 1
            assert said == certified_growth(family, float(Omega), float(eps), progress=False).verdict, (Omega, eps)
    assert decided > 0.9 * (len(points) + len(near))


@pytest.mark.parametrize("name", ["mathieu", "mathieu damped", "coupled, damped", "rotor", "both phases"])
def test_hardly_anything_is_open(charts: dict[str, ProvedChart], name: str) -> None:
    """The fraction is a lower bound: fewer of many points are open."""
    (low, high), (bottom, top) = WINDOWS[name][1:]
    chart = charts[name]
    assert 0.9995 < chart.proved_fraction < 1
    verdicts = chart.verdict(RNG.uniform(low, high, 4000), RNG.uniform(bottom, top, 4000))
    assert (verdicts == "open").mean() <= 1 - chart.proved_fraction + 2e-3
    assert {"stable", "unstable"} <= set(verdicts.tolist())


def test_verdicts_of_monodromy(charts: dict[str, ProvedChart]) -> None:
    for name in ("mathieu", "both phases", "coupled"):
        family, (low, high), (bottom, top) = WINDOWS[name]
        for Omega, eps in zip(RNG.uniform(low, high, 20), RNG.uniform(bottom, top, 20), strict=True):
            said, kind = str(charts[name].verdict(Omega, eps)), monodromy(family, Omega, eps).kind.name
            if said != "open" and kind != "UNDECIDED":
                assert (said == "stable") == (kind == "STABLE"), (name, Omega, eps)


@pytest.mark.parametrize("name", WINDOWS)
def test_a_patch_encloses_the_monodromy_matrix(name: str) -> None:
    """Against ball arithmetic, which shares no code, at corners and inside; and the radius is not much too large."""
    family, (low, high), (bottom, top) = WINDOWS[name]
    system = family.at(low)
    equation = coefficients_of(system)
    degree, n = 8, system.size
    l0, e0, h2 = (1 / low + 1 / high) / 2, (bottom + top) / 2, 0.05
    h1 = 0.2 / equation.norm
    patch = patch_of(equation, l0, h1, e0, h2, degree, 1e-10)
    assert patch.model.radius < 1e-4
    Tz = np.zeros((2 * n, 2 * n))
    Tz[:n, :n], Tz[n:, n:] = equation.T1, equation.T1 / equation.scale
    errors = []
    for x, y in [(0.0, 0.0), (1.0, 1.0), (-1.0, 1.0), (0.4, -0.8)]:
        Omega = 1 / (l0 + h1 * x)
        # Omega is rounded: the point of the patch is that of the float
        x, eps = (1 / Omega - l0) / h1, e0 + h2 * y
        shift = _phase(equation, system)
        true = np.array([[float(v.mid()) for v in row] for row in certified_monodromy(shift, Omega, eps).tolist()])
        powers = [x ** (t - k) * y**k for t in range(degree + 1) for k in range(t + 1)]
        found = np.tensordot(powers, patch.model.coef, 1)
        errors.append(float(np.linalg.norm(found - np.linalg.solve(Tz, true @ Tz))))
    assert 1e-14 < max(errors) <= patch.model.radius + 1e-13
    assert errors[0] < 1e-13  # in the middle nothing is cut


def _phase(equation: Any, system: PeriodicSystem) -> PeriodicSystem:
    """Return the system that starts where the equation starts: about a phase in which it is even, if there is one."""
    if not equation.sines.any() and system.sine.any():
        return PeriodicSystem(system.mass, system.gyroscopic, system.damping, system.stiffness, system.sine)
    return system


def test_subsystems_are_proved_apart_and_put_together() -> None:
    """Two Mathieu equations that nothing couples, one of them not excited; the second is unstable by itself or not."""
    zero = np.zeros((3, 3))
    excited = np.diag([1.0, 0.0, 1.0])
    for third, expected in ((2.0, "stable"), (-1.0, "unstable")):
        system = PeriodicSystem(np.eye(3), zero, zero, np.diag([1.0, third, 1.2]), [excited])
        chart = prove_chart(system, (1.9, 2.3), (0.05, 0.1), progress=False)
        assert len(chart.parts) == 2
        assert str(chart.verdict(2.1, 0.06)) == expected
        assert str(chart.verdict(2.0, 0.1)) == str(chart.verdict(2 * np.sqrt(1.2), 0.1)) == "unstable"
        for strip in chart.edges(0.08) if third > 0 else []:
            assert strip.thickness < 1e-7
            assert certified_growth(system, strip.lower - 1e-7, 0.08).verdict == strip.below


def test_what_is_saved_is_what_is_loaded(tmp_path: Path, charts: dict[str, ProvedChart]) -> None:
    chart = charts["coupled, damped"]
    chart.save(tmp_path / "chart.npz")
    again = ProvedChart.load(tmp_path / "chart.npz")
    assert repr(again) == repr(chart)
    assert "% proved" in repr(chart)
    Omega, eps = RNG.uniform(2.4, 3.0, 200), RNG.uniform(0, 0.4, 200)
    assert (again.verdict(Omega, eps) == chart.verdict(Omega, eps)).all()
    (tmp_path / "no.npz").write_bytes(b"no chart")
    with pytest.raises(ValueError, match="holds no proved chart"):
        ProvedChart.load(tmp_path / "no.npz")


def test_without_time_everything_is_open() -> None:
    chart = prove_chart(mathieu(), (1.5, 2.5), (0.0, 0.4), seconds=1e-9, progress=False)
    assert chart.proved_fraction == 0
    assert str(chart.verdict(2.0, 0.1)) == "open"
    assert [(s.lower, s.upper) for s in chart.edges(0.1)] == [(1.5, 2.5)]


class Changing:
    """A family whose stiffness depends on Omega."""

    def at(self, Omega: float) -> PeriodicSystem:
        return mathieu(1.0 + 1e-9 * Omega)


def test_what_is_not_carried_is_refused(charts: dict[str, ProvedChart]) -> None:
    other = PeriodicSystem([[1.0]], stiffness=[[1.0]], terms=[Term("damping", [[1.0]], waveforms.cosine())])
    for family, message in ((other, "damping"), (Changing(), "other matrices at Omega"), (3, "no system")):
        with pytest.raises(ValueError, match=message):
            prove_chart(family, (1.0, 2.0), (0.0, 0.1))
    for window, message in (
        (((2.0, 1.0), (0.0, 0.1)), "lower value first"),
        (((1.0, 2.0), (0.0,)), "eps_range"),
        (((0.0, 2.0), (0.0, 0.1)), "Omega_range"),
    ):
        with pytest.raises(ValueError, match=message):
            prove_chart(mathieu(), *window)
    with pytest.raises(ValueError, match="outside the window"):
        charts["mathieu"].verdict(3.1, 0.1)
    with pytest.raises(ValueError, match="outside the window"):
        charts["mathieu"].edges(0.7)
