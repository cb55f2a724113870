"""Rigid motions are found, set apart, and leave the verdict to all other motions."""

from __future__ import annotations

import numpy as np
import pytest

from floquet import Kind, monodromy
from floquet.oracle import reduce_system, rigid_basis
from periodic import PeriodicSystem
from periodic.checks import FloatArray
from periodic.examples import coupled_mathieu, mathieu
from tests.floquet.oracle_systems import dop853
from tests.strategies import join, transformed

INERTIAS = np.diag([3.0, 1.0, 0.5, 2.0])
TWIST = np.diff(np.eye(4), axis=0)  # of the three shafts between four discs


def drivetrain(damping: float = 0.0, seed: int | None = None) -> PeriodicSystem:
    """Four discs on a shaft with free ends, one section of which has pulsating stiffness."""
    K = TWIST.T @ np.diag([1.0, 2.3, 0.7]) @ TWIST
    F = TWIST.T @ np.diag([0.5, 0.0, 0.0]) @ TWIST
    system = PeriodicSystem(INERTIAS, np.zeros((4, 4)), damping * K, K, [F])
    if seed is None:
        return system
    return transformed(system, np.random.default_rng(seed).standard_normal((4, 4)))


def elastic(damping: float = 0.0) -> PeriodicSystem:
    """The same without its rigid rotation, by hand: in the twists of the shafts."""
    flexibility = np.linalg.inv(TWIST @ np.linalg.inv(INERTIAS) @ TWIST.T)
    k = np.diag([1.0, 2.3, 0.7])
    return PeriodicSystem(flexibility, np.zeros((3, 3)), damping * k, k, [np.diag([0.5, 0.0, 0.0])])


@pytest.mark.parametrize("damping", [0.0, 0.02])
@pytest.mark.parametrize("Omega", [1.0, 1.4, 2.0, 2.6, 3.3, 5.0])
@pytest.mark.parametrize("seed", [None, 0, 1])
def test_the_rest_is_judged_as_if_it_were_alone(Omega: float, damping: float, seed: int | None) -> None:
    found, alone = monodromy(drivetrain(damping, seed), Omega, 0.8), monodromy(elastic(damping), Omega, 0.8)
    assert (found.rigid, alone.rigid) == (1, 0)
    assert found.kind == alone.kind != Kind.UNDECIDED
    assert found.growth_rate == pytest.approx(alone.growth_rate, abs=1e-10)
    assert np.sum(found.multipliers == 1) == 2
    others = found.multipliers[found.multipliers != 1]
    assert np.poly(others) == pytest.approx(np.poly(alone.multipliers), abs=1e-9)


def test_the_matrix_holds_the_rigid_motion_too() -> None:
    system = drivetrain(0.02)
    assert monodromy(system, 1.3, 0.8).matrix == pytest.approx(dop853(system, 1.3, 0.8), abs=1e-9)


@pytest.mark.parametrize("scale", [1e-3, 1e3])
def test_units_do_not_matter(scale: float) -> None:
    units = np.diag([1.0, scale, 1.0, scale**2])
    assert monodromy(transformed(drivetrain(), units), 2.0, 0.8).rigid == 1


def test_several_rigid_motions() -> None:
    both = join(drivetrain(), mathieu(0.0), drivetrain(0.1))
    found = monodromy(both, 2.0, 0.0)
    assert found.rigid == 3
    assert found.kind == Kind.STABLE
    # excitation touches the middle one, which has no stiffness
    assert monodromy(both, 2.0, 0.3).rigid == 2


def grounded(
    *, stiffness: float = 0.0, damping: float = 0.0, turning: float = 0.0, excitation: float = 0.0
) -> FloatArray:
    """Return the rigid motions of the drivetrain if something is attached to its first disc."""
    system, first = drivetrain(), np.zeros((4, 4))
    first[0, 0] = 1.0
    turn = np.zeros((4, 4))
    turn[0, 1], turn[1, 0] = turning, -turning
    changed = PeriodicSystem(
        system.mass, turn, damping * first, system.stiffness + stiffness * first, system.cosine + excitation * first
    )
    return rigid_basis(changed, 0.5)


def test_what_anything_acts_on_is_not_rigid() -> None:
    assert grounded().shape == (4, 1)
    for attached in ("stiffness", "damping", "turning", "excitation"):
        assert grounded(**{attached: 1e-6}).shape == (4, 0), attached


def test_a_motion_that_drives_others_is_not_rigid() -> None:
    # K r = 0 but r K is not: x1 is free, and its acceleration follows x2
    system = PeriodicSystem(
        np.eye(2), np.zeros((2, 2)), np.zeros((2, 2)), [[0.0, 1.0], [0.0, 2.0]], [np.diag([0.0, 1.0])]
    )
    assert monodromy(system, 2.0, 0.1).rigid == 0


def test_a_soft_motion_of_a_graded_system_is_not_rigid() -> None:
    graded = PeriodicSystem(np.eye(2), np.zeros((2, 2)), np.zeros((2, 2)), np.diag([1.0, 1e16]), [np.zeros((2, 2))])
    coupled = PeriodicSystem(
        np.eye(2), np.zeros((2, 2)), np.zeros((2, 2)), [[1.0, 1e6], [1e6, 1e16]], [np.zeros((2, 2))]
    )
    for system in (graded, coupled):
        assert rigid_basis(system, 0.0).shape == (2, 0)


def test_systems_without_rigid_motions_are_reduced_as_before() -> None:
    for system in (mathieu(), coupled_mathieu(), elastic()):
        assert rigid_basis(system, 0.5).shape == (system.size, 0)
        modes = sum(len(subsystem.equations.w) for subsystem in reduce_system(system, 0.5, 1.0))
        assert modes == system.size
