"""Splitting into subsystems and energy coordinates: nothing is lost, nothing is coupled that is not."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from floquet import monodromy
from floquet.oracle.reduction import constant_matrix, modulation, reduce_system
from periodic import PeriodicSystem
from periodic.examples import coupled_mathieu, mathieu
from tests.floquet.oracle_systems import first_order, random_system
from tests.strategies import join, transformed


@pytest.mark.parametrize("symmetric", [True, False])
@pytest.mark.parametrize("t", [0.0, 0.9])
def test_equations_are_those_of_the_system(symmetric: bool, t: float) -> None:
    system, Omega, eps = random_system(5, 4, 3, symmetric=symmetric, damping=0.2), 1.3, 0.7
    (subsystem,) = reduce_system(system, eps, 1.0)
    eq = subsystem.equations
    m = len(eq.w)
    phase = np.arange(eq.alpha.shape[1]) * Omega * t
    f = eq.alpha @ np.cos(phase) + eq.beta @ np.sin(phase)
    S = eq.S.reshape(m, -1, m).transpose(1, 0, 2)
    stiffness = np.diag(eq.k) + np.tensordot(f, S[: len(f)], 1)
    A = np.block([[np.zeros((m, m)), np.diag(eq.w)], [-stiffness, -S[-1]]])
    back = subsystem.to_q @ A @ subsystem.from_q
    expected = first_order(system, Omega, eps, t)
    assert np.linalg.norm(back - expected) < 1e-13 * np.linalg.norm(expected)
    assert subsystem.from_q @ subsystem.to_q == pytest.approx(np.eye(2 * m), abs=1e-13)


def test_spectral_radius_is_below_the_rate() -> None:
    for seed in range(20):
        system = random_system(seed, 3, 2, damping=0.1 * (seed % 3))
        (subsystem,) = reduce_system(system, 0.8, 1.0)
        for t in np.linspace(0, 6, 13):
            assert np.abs(np.linalg.eigvals(first_order(system, 1.0, 0.8, t))).max() < subsystem.rate * (1 + 1e-12)


def test_subsystems_are_the_same_at_every_amplitude() -> None:
    # two parts in turned axes: what rounding leaves of their coupling is about as large as what counts as rounding
    for seed in range(40):
        random = np.random.default_rng(seed)
        turn, _ = np.linalg.qr(random.normal(size=(3, 3)))
        system = transformed(join(random_system(seed, 2), mathieu()), turn @ np.diag(random.uniform(0.7, 1.4, 3)))
        sizes = [[len(one.equations.w) for one in reduce_system(system, eps, 1.0)] for eps in (1e-3, 0.03, 1.0, 30.0)]
        assert sizes[1:] == sizes[:-1]


def test_constant_matrix_has_the_exponents() -> None:
    system = random_system(6, 3, symmetric=False, damping=0.4)
    (subsystem,) = reduce_system(system, 1.0, 1.0)
    exact = np.linalg.eigvals(first_order(system, 1.0, 0.0, 0.0))
    assert np.sort_complex(np.linalg.eigvals(constant_matrix(subsystem.equations))) == pytest.approx(
        np.sort_complex(exact), abs=1e-12
    )


def test_subsystems_are_found_in_any_order_of_coordinates() -> None:
    system = join(random_system(1, 2), random_system(2, 3, 2), mathieu())
    order = np.random.default_rng(0).permutation(6)
    subsystems = reduce_system(transformed(system, np.eye(6)[:, order]), 0.5, 1.0)
    assert sorted(len(subsystem.equations.w) for subsystem in subsystems) == [1, 2, 3]
    assert all(subsystem.neglected == 0 for subsystem in subsystems)
    assert sum(subsystem.to_q @ subsystem.from_q for subsystem in subsystems) == pytest.approx(np.eye(12), abs=1e-13)


def test_rounding_noise_does_not_couple_and_is_charged() -> None:
    system = join(random_system(1, 2), random_system(2, 3))
    noise = 1e-16 * np.random.default_rng(0).standard_normal((5, 5))
    noise += noise.T
    noisy = PeriodicSystem(
        system.mass, system.gyroscopic, system.damping, system.stiffness + noise, system.cosine, system.sine
    )
    subsystems = reduce_system(noisy, 0.5, 1.0)
    assert len(subsystems) == 2
    for subsystem in subsystems:
        assert subsystem.reciprocal
        assert 1e-16 < subsystem.neglected < 1e-14
    coupled = PeriodicSystem(
        system.mass, system.gyroscopic, system.damping, system.stiffness + 1e4 * noise, system.cosine, system.sine
    )
    assert len(reduce_system(coupled, 0.5, 1.0)) == 1


def test_equal_frequencies_are_separated_by_symmetry() -> None:
    # for x1 + x2 and x1 - x2 the equations are two of Mathieu's, although every basis diagonalises the stiffness
    subsystems = reduce_system(coupled_mathieu("sum", frequencies=(1.3, 1.3)), 0.4, 1.0)
    assert [len(subsystem.equations.w) for subsystem in subsystems] == [1, 1]
    rotation = np.linalg.qr(np.random.default_rng(1).random((4, 4)))[0]
    rotated = transformed(join(random_system(7, 2), random_system(8, 2)), rotation)
    assert [len(subsystem.equations.w) for subsystem in reduce_system(rotated, 0.4, 1.0)] == [2, 2]


def test_rank_of_the_excitation() -> None:
    base = np.array([[1.0, 0.4], [0.4, -0.3]])
    cosine = np.array([base / j for j in range(1, 17)])
    system = PeriodicSystem(np.eye(2), np.zeros((2, 2)), np.zeros((2, 2)), [[1.0, 0.1], [0.1, 2.0]], cosine)
    (subsystem,) = reduce_system(system, 0.5, 1.0)
    assert subsystem.equations.alpha.shape == (1, 17)


@pytest.mark.parametrize(
    ("arguments", "reciprocal", "conservative"),
    [
        ({}, True, True),
        ({"damping": 0.1}, False, False),
        ({"symmetric": False}, False, False),
        ({"symmetric": False, "gyroscopic": False}, False, False),  # sines are left
    ],
)
def test_structure_is_recognised(arguments: dict[str, Any], reciprocal: bool, conservative: bool) -> None:
    (subsystem,) = reduce_system(random_system(9, 3, 2, **arguments), 0.5, 1.0)
    assert subsystem.reciprocal is reciprocal
    assert (subsystem.form is not None) is conservative


def test_form_is_conserved() -> None:
    # d/dt of x^T form y vanishes along solutions: form A is symmetric at every time
    system, Omega, eps = random_system(5, 3, 2), 1.3, 0.7
    (subsystem,) = reduce_system(system, eps, 1.0)
    assert subsystem.form is not None
    assert subsystem.form == pytest.approx(-subsystem.form.T)
    for t in (0.0, 0.4, 2.1):
        A = subsystem.from_q @ first_order(system, Omega, eps, t) @ subsystem.to_q
        assert subsystem.form @ A == pytest.approx((subsystem.form @ A).T, abs=1e-13)


def test_reversible_systems_are_reciprocal() -> None:
    system = random_system(9, 3, 2, symmetric=False, gyroscopic=False)
    cosines = PeriodicSystem(system.mass, system.gyroscopic, system.damping, system.stiffness, system.cosine)
    (subsystem,) = reduce_system(cosines, 0.5, 1.0)
    assert subsystem.reciprocal
    assert subsystem.form is None


def test_a_gyroscopic_system_with_unsymmetric_stiffness_is_not_reciprocal() -> None:
    system = random_system(9, 3, 2, symmetric=False, gyroscopic=True)
    cosines = PeriodicSystem(system.mass, system.gyroscopic, system.damping, system.stiffness, system.cosine)
    (subsystem,) = reduce_system(cosines, 0.5, 1.0)
    assert not subsystem.reciprocal
    # and rightly: the multipliers are not
    moduli = np.abs(monodromy(cosines, 2.0, 0.5).multipliers)
    assert np.prod(moduli) == pytest.approx(1, abs=1e-9)
    assert np.abs(moduli * moduli[::-1] - 1).max() > 1e-3


def test_frequencies_are_good_to_their_own_rounding() -> None:
    # a graded stiffness, as of a Ritz basis: the smallest eigenvalue is the reciprocal of the largest of the inverse
    n = 6
    core = np.eye(n) + 0.3 * np.ones((n, n))
    grade = 10.0 ** np.arange(n)
    smallest = 1 / np.linalg.eigvalsh(np.linalg.inv(core) / np.outer(grade, grade))[-1]
    system = PeriodicSystem(
        np.eye(n), np.zeros((n, n)), np.zeros((n, n)), core * np.outer(grade, grade), np.eye(n)[None]
    )
    subsystems = reduce_system(system, 0.0, 1.0)
    lowest = min((subsystem.equations.w * subsystem.equations.k).min() for subsystem in subsystems)
    assert lowest == pytest.approx(smallest, rel=1e-14)
    assert np.linalg.eigvalsh(system.stiffness)[0] != pytest.approx(smallest, rel=1e-12)  # what it would be otherwise


def test_modulation_of_mathieu() -> None:
    (subsystem,) = reduce_system(mathieu(4.0), 1.0, 1e-3)
    assert modulation(subsystem.equations) == pytest.approx(0.25)
