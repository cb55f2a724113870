"""Steps and samples of general systems: orders, exact cases, structure, and the step of stiffness alone inside."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.linalg as sla

from floquet.engine import subsystems
from floquet.engine.coordinates import equations, least_frequency
from floquet.engine.doubling import Workspace
from floquet.engine.doubling.step import single_steps
from floquet.engine.general import general_sampler, general_subsystems
from floquet.engine.general.step import general_steps
from floquet.engine.general.subsystems import Part, _product, numerical_radius
from periodic import FirstOrderSystem, PeriodicSystem, Term, waveforms
from tests.floquet.general_oracles import dop853, random_first_order, random_second_order
from tests.general_systems import Reference

TOLERANCE = 1e-10
ROTATION = np.array([[0.0, 1.0, 0.2], [-1.0, 0.0, 0.0], [-0.2, 0.0, 0.0]])
SHEAR = np.array([[0.3, 1.0, 0.0], [0.5, 0.0, 0.4], [0.0, -1.0, 0.2]])


def multipliers(system: PeriodicSystem | FirstOrderSystem, Omega: float, eps: float, L: int) -> np.ndarray:
    """All multipliers by the sampler, from 2^L steps a period."""
    parts = general_subsystems(system, Omega).subsystems
    found = [general_sampler(one, Omega, Workspace()).matrices(np.array([eps]), L, TOLERANCE)[0] for one in parts]
    return np.concatenate([np.linalg.eigvals(Phi) for Phi in found])


def distance(one: np.ndarray, other: np.ndarray) -> float:
    """Largest distance of a multiplier from the nearest of the other set."""
    return float(np.abs(one[:, None] - other).min(axis=1).max())


@pytest.mark.parametrize("kind", ["smooth", "first order", "mass", "jumps"])
def test_the_step_is_of_fourth_order(kind: str) -> None:
    """Processed steps where all is smooth, Magnus' where not; halving the step divides the error by sixteen."""
    Omega, eps = 1.3, 0.4
    systems: dict[str, PeriodicSystem | FirstOrderSystem] = {
        "smooth": random_second_order(5, 3, kinds=1, of=("damping", "gyroscopic", "stiffness")),
        "first order": random_first_order(8, 3, kinds=1),
        "mass": PeriodicSystem(np.eye(1), damping=[[0.1]], stiffness=[[1.0]], terms=[Term("mass", [[0.5]])]),
        "jumps": FirstOrderSystem(-0.3 * np.eye(3) + ROTATION, terms=[Term("state", SHEAR, waveforms.sawtooth())]),
    }
    system = systems[kind]
    exact = np.linalg.eigvals(dop853(system, Omega, eps))
    errors = [distance(multipliers(system, Omega, eps, L), exact) for L in (5, 6, 7)]
    assert np.log2(np.divide(errors[:-1], errors[1:])) == pytest.approx([4, 4], abs=0.25)


def test_stiffness_alone_has_the_same_step() -> None:
    """exp(h A) (I - kick) with the term of Takahashi and Imada, to the last digits."""
    system = random_second_order(2, 3, kinds=1, of=("stiffness",))
    F = np.array([[1.0, 0.2, 0.0], [0.2, -0.5, 0.1], [0.0, 0.1, 0.3]])
    short = PeriodicSystem(system.mass, system.gyroscopic, system.damping, system.stiffness, F)
    (subsystem,) = subsystems(short)
    A, left, right, _ = equations(subsystem, least_frequency(1.7))
    h, theta, eps = 0.07, np.array([0.3, 2.0]), np.array([0.4, -0.7])
    P, Q = np.empty((2, 6, 6)), np.empty((2, 6, 6))
    single_steps(A, subsystem.Fc, subsystem.Fs, left, right, h, theta, eps, P)
    V = np.zeros((1, 6, 6))
    V[0, 3:, :3] = -left[:, None] * subsystem.Fc[0] * right
    general_steps(A, np.ones(1), np.ones(1), V, 0 * V, h, 1.7, theta, eps, Q)
    # the kick of that step is the whole exponential: V is nilpotent
    np.testing.assert_allclose(Q, P, rtol=0, atol=1e-14)


def test_piecewise_constant_systems_are_exact_with_any_step() -> None:
    rng = np.random.default_rng(4)
    A, X = rng.standard_normal((2, 3, 3))
    system = FirstOrderSystem(A, terms=[Term("state", X, waveforms.rectangular(0.3, 0.2), 2)])
    Omega, eps = 1.7, 0.6
    parts = [sla.expm((A + x * eps**2 * X) * part * 2 * np.pi / Omega) for part, x in ((0.2, -1), (0.3, 1), (0.5, -1))]
    exact = np.linalg.eigvals(parts[2] @ parts[1] @ parts[0])
    assert distance(multipliers(system, Omega, eps, 1), exact) < 1e-13 * np.abs(exact).max()


def test_interpolation_in_eps_knows_powers_and_constants() -> None:
    """Sixty amplitudes by samples, against each by itself: eps^2 with one harmonic is no function of eps cos theta."""
    X = np.array([[0.2, 1.0], [-0.5, 0.1]])
    squares = (waveforms.constant(), waveforms.cosine(2, 0.3))
    for terms in (
        [Term("state", X, waveforms.cosine(3), 2)],
        [Term("state", X, waveforms.cosine()), Term("state", 0.4 * X.T, waveforms.constant())],
        [Term("state", X, waveforms.cosine(), 3), Term("state", X.T, waveforms.rectangular(0.3), 2)],
        # graded, as with a pulsating speed: eps^p with the harmonics p, p - 2, ...
        [Term("state", X, waveforms.cosine(1, 0.1)), *(Term("state", X.T, g, 2) for g in squares)],
        [Term("state", 0.1 * X, waveforms.cosine(1, 0.1)), *(Term("state", X.T, g, 2) for g in squares)],
        [Term("state", X, waveforms.sine()), Term("state", X.T, waveforms.cosine(1, 0.3), 3)],
    ):
        system = FirstOrderSystem([[-0.1, 1.0], [-1.0, -0.2]], terms=terms)
        (subsystem,) = general_subsystems(system, 1.1).subsystems
        eps = np.linspace(-0.5, 1.5, 60)
        sampler = general_sampler(subsystem, 1.1, Workspace())
        together = sampler.matrices(eps, 9, TOLERANCE)
        alone = [sampler.matrices(eps[i : i + 1], 9, TOLERANCE)[0] for i in range(60)]
        sizes = np.linalg.norm(alone, axis=(1, 2))
        assert (np.linalg.norm(together - alone, axis=(1, 2)) / sizes).max() < 1e-9


def test_an_accelerating_beam_is_symplectic_in_its_coordinates() -> None:
    """J A and J V(t) are symmetric; without v' B there are no such coordinates."""
    system = Reference("beam_v2.0_vf0.8_N4_a0", 0.1).at(11.3)
    (subsystem,) = general_subsystems(system, 11.3).subsystems
    assert subsystem.symplectic
    one = np.eye(4)
    J = np.block([[0 * one, one], [-one, 0 * one]])
    for X in (subsystem.A, *(part.A for part in subsystem.parts)):
        np.testing.assert_allclose(J @ X, (J @ X).T, atol=1e-11 * np.abs(X).max())
    assert {part.power for part in subsystem.parts} == {1, 2}
    assert isinstance(system, PeriodicSystem)
    partial = PeriodicSystem(system.mass, system.gyroscopic, None, system.stiffness, system.cosine, terms=system.terms)
    (other,) = general_subsystems(partial, 11.3).subsystems
    assert not other.reciprocal


def test_products_of_waveforms() -> None:
    g, h = waveforms.Trigonometric((0.3, 1.0, 0.2), (0.0, -0.5, 0.4)), waveforms.cosine(3, 0.1)
    theta = np.linspace(0, 6, 11)
    np.testing.assert_allclose(_product(g, h).values(theta), g.values(theta) * h.values(theta), atol=1e-14)


def test_the_numerical_radius_bounds_the_growth_in_every_direction() -> None:
    X = np.random.default_rng(3).standard_normal((4, 4))
    bound = numerical_radius(X)
    turns = np.exp(2j * np.pi * np.arange(400) / 400)[:, None, None] * X
    largest = np.linalg.eigvalsh((turns + turns.conj().transpose(0, 2, 1)) / 2).max()
    assert largest <= bound <= 1.7 * largest
    nilpotent = np.array([[0.0, 0.0], [3.0, 0.0]])
    assert numerical_radius(nilpotent) == pytest.approx(1.5)  # the rate of y' = z X y at its best is half of |X|


def test_rigid_motions_are_counted_and_left_out() -> None:
    X = np.array([[1.0, -1.0], [-1.0, 1.0]])
    system = PeriodicSystem(np.eye(2), damping=0.1 * X, stiffness=X, terms=[Term("damping", 0.2 * X)])
    found = general_subsystems(system, 2.0)
    assert found.rigid == 1
    assert [one.states for one in found.subsystems] == [2]
    assert all(isinstance(part, Part) for part in found.subsystems[0].parts)
