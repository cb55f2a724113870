"""Rigid motions are set apart: counted, not judged, and no reason to leave a cell undecided."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from floquet import Kind, StabilityChart, monodromy, stability_chart
from periodic import PeriodicSystem
from periodic.checks import FloatArray
from tests.floquet.chart.chart_oracles import agrees, chart

OMEGA, EPS = np.linspace(1.0, 4.0, 9), np.linspace(0.0, 0.8, 9)


def drivetrain(discs: int, damping: float = 0.0) -> PeriodicSystem:
    """Discs on a shaft with free ends; the stiffness of its second part pulsates."""
    twist = np.diff(np.eye(discs), axis=0)
    K, F = twist.T @ twist, np.outer(twist[1], twist[1])
    return PeriodicSystem(np.diag(np.arange(1.0, discs + 1)), 0 * K, damping * K, K, [F])


def without_rotation(system: PeriodicSystem) -> PeriodicSystem:
    """The same drivetrain in its twists, from the kinetic energy that remains when the momentum is zero."""
    J = np.diag(system.mass)
    # angles from twists: the difference of neighbours, and no angular momentum
    angles = np.linalg.inv(np.vstack([np.diff(np.eye(len(J)), axis=0), J]))[:, :-1]
    M, G, C, K, F = (
        angles.T @ S @ angles
        for S in (system.mass, system.gyroscopic, system.damping, system.stiffness, system.cosine[0])
    )
    return PeriodicSystem(M, G, C, K, [F])


def free_truss() -> PeriodicSystem:
    """Three masses in a plane, joined by three bars: it may shift in two directions, and turn."""
    places, K, F = np.array([[0.0, 0.0], [1.0, 0.0], [0.4, 0.9]]), np.zeros((6, 6)), np.zeros((6, 6))
    for number, (i, j) in enumerate(((0, 1), (1, 2), (0, 2))):
        bar = np.zeros((3, 2))
        bar[j] = (places[j] - places[i]) / np.linalg.norm(places[j] - places[i])
        bar[i] = -bar[j]
        K += (1 + number) * np.outer(bar, bar)
        F += (number == 1) * np.outer(bar, bar)
    return PeriodicSystem(np.diag([1.0, 1.0, 2.0, 2.0, 0.5, 0.5]), 0 * K, 0 * K, K, [F])


def in_other_units(system: PeriodicSystem, scales: FloatArray) -> PeriodicSystem:
    """The system in coordinates of different units, turned so that none of them is a mode."""
    T = np.linalg.qr(np.random.default_rng(0).standard_normal((system.size, system.size)))[0] * scales
    matrices = (system.mass, system.gyroscopic, system.damping, system.stiffness, system.cosine[0])
    M, G, C, K, F = (7e3 * T.T @ S @ T for S in matrices)
    return PeriodicSystem(M, G, C, K, [F])


@pytest.mark.parametrize("damping", [0.0, 0.02])
def test_a_free_drivetrain_is_judged_by_its_twists(damping: float) -> None:
    system = drivetrain(4, damping)
    found, twists = chart(system, OMEGA, EPS), chart(without_rotation(system), OMEGA, EPS)
    assert (found.rigid, twists.rigid) == (1, 0)
    assert monodromy(system, 2.0, 0.3).rigid == 1
    allowed = (found.error + twists.error) * OMEGA / (2 * np.pi) + 1e-13
    assert (np.abs(found.growth_rate - twists.growth_rate) <= allowed).all()
    decided = (found.kind != Kind.UNDECIDED) & (twists.kind != Kind.UNDECIDED)
    assert decided.mean() > 0.95
    assert (found.kind == twists.kind)[decided].all()
    assert {Kind.STABLE, Kind.MINUS_ONE} <= {Kind(int(k)) for k in np.unique(found.kind)}


def test_several_rigid_motions() -> None:
    system = free_truss()
    found = chart(system, OMEGA, EPS)
    assert found.rigid == 3
    assert agrees(system, found)
    assert (found.kind != Kind.UNDECIDED).mean() > 0.95


def test_units_do_not_matter() -> None:
    plain, other = drivetrain(5), in_other_units(drivetrain(5), np.array([1.0, 1e-3, 1e3, 1.0, 1e-2]))
    one, two = chart(plain, OMEGA, EPS), chart(other, OMEGA, EPS)
    assert one.rigid == two.rigid == 1
    assert (np.abs(one.growth_rate - two.growth_rate) * 2 * np.pi / OMEGA <= one.error + two.error + 1e-12).all()


@pytest.mark.parametrize(
    ("K", "C", "F"),
    [
        (np.diag([1e6, 1.0]), np.zeros((2, 2)), np.diag([2e5, 0.0])),  # a soft spring is a spring
        (np.diag([1e14, 1.0]), np.zeros((2, 2)), np.diag([2e13, 0.0])),
        (np.diag([1.0, 0.0]), np.zeros((2, 2)), np.diag([1.0, 0.3])),  # excited
        (np.diag([1.0, 0.0]), np.diag([0.0, 0.1]), np.diag([1.0, 0.0])),  # damped
    ],
    ids=["soft", "softer", "excited", "damped"],
)
def test_what_is_not_rigid(K: FloatArray, C: FloatArray, F: FloatArray) -> None:
    system = PeriodicSystem(np.eye(2), np.zeros((2, 2)), C, K, [F])
    frequency = 1.5 * np.sqrt(K.max())
    assert chart(system, [frequency], [0.0, 0.1]).rigid == 0


def test_nothing_but_rigid_motions() -> None:
    zero = np.zeros((2, 2))
    found = chart(PeriodicSystem(np.eye(2), zero, zero, zero, [zero]), OMEGA, EPS, audit=2)
    assert found.rigid == 2
    assert (found.kind == Kind.STABLE).all()
    assert not found.growth_rate.any()
    assert found.audit is not None
    assert found.audit.ok


def test_the_number_is_kept(tmp_path: Path) -> None:
    found = stability_chart(drivetrain(3), [1.0, 2.0], [0.1], audit=0, n_jobs=1, progress=False)
    found.save(tmp_path / "chart.npz")
    assert StabilityChart.load(tmp_path / "chart.npz").rigid == 1
