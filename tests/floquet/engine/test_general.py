"""Steps and samples of general systems: orders, exact cases, structure, and the step of stiffness alone inside."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.linalg as sla

from floquet import Kind, stability_chart
from floquet.engine import subsystems
from floquet.engine.coordinates import equations, least_frequency
from floquet.engine.doubling import Workspace
from floquet.engine.doubling.step import single_steps
from floquet.engine.general import Parts, fourier, general_sampler, general_subsystems
from floquet.engine.general.exponential import WORK_MATRICES, exponential_into
from floquet.engine.general.radius import Radii, numerical_radius
from floquet.engine.general.step import general_steps
from periodic import AnySystem, FirstOrderSystem, PeriodicSystem, Term, waveforms
from plate import MovingPlate
from tests.floquet.general_oracles import dop853, random_first_order, random_second_order
from tests.general_systems import Reference

TOLERANCE = 1e-10
ROTATION = np.array([[0.0, 1.0, 0.2], [-1.0, 0.0, 0.0], [-0.2, 0.0, 0.0]])
SHEAR = np.array([[0.3, 1.0, 0.0], [0.5, 0.0, 0.4], [0.0, -1.0, 0.2]])


def parts_at(system: AnySystem, Omega: float) -> Parts:
    """The subsystems of one system."""
    return general_subsystems([system], np.array([Omega]))[0]


def multipliers(system: AnySystem, Omega: float, eps: float, L: int) -> np.ndarray:
    """All multipliers by the sampler, from 2^L steps a period."""
    parts = parts_at(system, Omega).subsystems
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
        (subsystem,) = parts_at(system, 1.1).subsystems
        eps = np.linspace(-0.5, 1.5, 60)
        sampler = general_sampler(subsystem, 1.1, Workspace())
        together = sampler.matrices(eps, 9, TOLERANCE)
        alone = [sampler.matrices(eps[i : i + 1], 9, TOLERANCE)[0] for i in range(60)]
        sizes = np.linalg.norm(alone, axis=(1, 2))
        assert (np.linalg.norm(together - alone, axis=(1, 2)) / sizes).max() < 1e-9


def test_an_accelerating_beam_is_symplectic_in_its_coordinates() -> None:
    """J A and J V(t) are symmetric; without v' B there are no such coordinates."""
    system = Reference("beam_v2.0_vf0.8_N4_a0", 0.1).at(11.3)
    (subsystem,) = parts_at(system, 11.3).subsystems
    assert subsystem.symplectic
    one = np.eye(4)
    J = np.block([[0 * one, one], [-one, 0 * one]])
    assert subsystem.smooth is not None
    for X in (subsystem.A, *subsystem.smooth.cosine, *subsystem.smooth.sine):
        np.testing.assert_allclose(J @ X, (J @ X).T, atol=1e-11 * np.abs(X).max())
    assert set(subsystem.smooth.powers) == {1, 2}
    assert isinstance(system, PeriodicSystem)
    partial = PeriodicSystem(system.mass, system.gyroscopic, None, system.stiffness, system.cosine, terms=system.terms)
    (other,) = parts_at(partial, 11.3).subsystems
    assert not other.reciprocal


def test_sums_of_waves_multiply_and_differentiate_like_functions() -> None:
    rng = np.random.default_rng(5)
    X, Y = rng.standard_normal((2, 3, 3))
    g, h = waveforms.Trigonometric((0.3, 1.0, 0.2), (0.0, -0.5, 0.4)), waveforms.cosine(2, 0.1)
    one = fourier.total([fourier.waves(1, g, X), fourier.constant(Y)])
    other = fourier.waves(2, h, Y)

    def value(sums: fourier.Sums, theta: float, eps: float) -> np.ndarray:
        return sum((eps**p * Z * np.exp(1j * j * theta)).real for (p, j), Z in sums.items())

    for theta, eps in ((0.3, 0.7), (4.0, -1.2)):
        one_there, other_there = eps * g.values(theta) * X + Y, eps**2 * h.values(theta) * Y
        np.testing.assert_allclose(value(one, theta, eps), one_there, atol=1e-14)
        product = fourier.product(one, other)
        np.testing.assert_allclose(value(product, theta, eps), one_there @ other_there, atol=1e-13)
        assert all(not Z.imag.any() for (_, j), Z in product.items() if j == 0)
        slope = 1.7 * eps * g.derivative(theta) * X
        np.testing.assert_allclose(value(fourier.derivative(one, 1.7), theta, eps), slope, atol=1e-13)


def test_the_numerical_radius_bounds_the_growth_in_every_direction() -> None:
    X = np.random.default_rng(3).standard_normal((4, 4))
    bound = numerical_radius(X)
    turns = np.exp(2j * np.pi * np.arange(400) / 400)[:, None, None] * X
    largest = np.linalg.eigvalsh((turns + turns.conj().transpose(0, 2, 1)) / 2).max()
    assert largest <= bound <= 1.7 * largest
    nilpotent = np.array([[0.0, 0.0], [3.0, 0.0]])
    assert numerical_radius(nilpotent) == pytest.approx(1.5)  # the rate of y' = z X y at its best is half of |X|
    radii = Radii()
    for factor, other in ((1.0, 0.0), (-2.0, 0.001), (0.5, 1.0), (0.0, 0.0)):
        Y = factor * X + other * np.ones((4, 4))
        assert numerical_radius(Y) <= radii.bound("X", Y) * (1 + 1e-12) <= 1.04 * numerical_radius(Y) + 1e-12


def test_members_of_a_family_are_taken_apart_alike_together_and_alone() -> None:
    """What is kept from one member to the next changes nothing but rounding: multipliers to 1e-10."""
    plate = MovingPlate(speed=2.0, axial_terms=2, lateral_terms=3, speed_amplitude=0.3, damping=1e-3)
    spring = np.diag([0.0, 1.0, 0.0])

    class Changing:
        """The stiffness and the mass go with Omega, and at 3 two subsystems become one."""

        def at(self, Omega: float) -> PeriodicSystem:
            K = np.diag([1.0, 2.0, 5.0]) + Omega**2 * spring
            K[0, 2] = K[2, 0] = 0.3 * (Omega > 3)
            turn = np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
            M, C = np.diag([1.0, 1.0, 1.0 + (Omega > 4)]), 0.1 * np.eye(3)
            terms = [Term("damping", spring, waveforms.cosine(2)), Term("gyroscopic", Omega * turn)]
            return PeriodicSystem(M, 0.2 * turn, C, K, np.diag([0.0, 0.0, 1.0]), terms=terms)

    for family, Omega in ((plate, np.linspace(20.0, 24.0, 4)), (Changing(), np.linspace(2.0, 5.0, 6))):
        systems = [family.at(float(w)) for w in Omega]
        for system, w, together in zip(systems, Omega, general_subsystems(systems, Omega), strict=True):
            alone = parts_at(system, float(w))
            assert [one.states for one in together.subsystems] == [one.states for one in alone.subsystems]
            samplers = (
                [general_sampler(one, float(w), Workspace()) for one in parts.subsystems] for parts in (together, alone)
            )
            found, expected = (
                np.concatenate([np.linalg.eigvals(one.matrices(np.array([0.3]), 8, TOLERANCE)[0]) for one in each])
                for each in samplers
            )
            assert distance(found, expected) < 1e-10


def test_exponentials_of_any_size() -> None:
    rng = np.random.default_rng(7)
    for N in (1, 2, 5, 16, 17, 30):
        for size in (0.0, 1e-9, 1e-3, 0.1, 0.49, 0.6, 5.0):
            work, found = np.empty((WORK_MATRICES, N, N)), np.empty((1, N, N))
            A = rng.standard_normal((N, N))
            work[0] = A = A * (size / np.abs(A).sum(axis=1).max())
            exponential_into(work, found, 0)
            # long doubles: SciPy's formula for two rows loses four digits at size 5
            term = exact = np.eye(N, dtype=np.longdouble)
            for k in range(1, 60):
                term = term @ A.astype(np.longdouble) / k
                exact = exact + term
            assert np.abs(found[0] - exact).max() <= 2e-15 * (1 + size) * np.abs(exact).max()


def test_a_rectangular_wave_of_a_conservative_system_is_symplectic() -> None:
    """Its multipliers come in pairs, and half as many eigenvalues tell them."""
    K = np.diag([1.0, 3.0])
    X = np.array([[1.0, 0.3], [0.3, -0.5]])
    G = np.array([[0.0, 0.4], [-0.4, 0.0]])
    pulses = Term("stiffness", 0.2 * X, waveforms.impulses([0.4], [1.0]))
    system = PeriodicSystem(np.eye(2), G, stiffness=K, terms=[Term("stiffness", X, waveforms.rectangular(0.3)), pulses])
    (subsystem,) = parts_at(system, 2.1).subsystems
    assert subsystem.symplectic
    (Phi,) = general_sampler(subsystem, 2.1, Workspace()).matrices(np.array([0.5]), 6, TOLERANCE)
    J = np.block([[np.zeros((2, 2)), np.eye(2)], [-np.eye(2), np.zeros((2, 2))]])
    np.testing.assert_allclose(Phi.T @ J @ Phi, J, atol=1e-13)
    assert distance(np.linalg.eigvals(Phi), np.linalg.eigvals(dop853(system, 2.1, 0.5))) < 1e-11
    (other,) = parts_at(PeriodicSystem(np.eye(2), G, 1e-3 * K, K, terms=system.terms), 2.1).subsystems
    assert not other.reciprocal


def test_rigid_motions_are_counted_and_left_out() -> None:
    X = np.array([[1.0, -1.0], [-1.0, 1.0]])
    system = PeriodicSystem(np.eye(2), damping=0.1 * X, stiffness=X, terms=[Term("damping", 0.2 * X)])
    found = parts_at(system, 2.0)
    assert found.rigid == 1
    assert [one.states for one in found.subsystems] == [2]
    assert found.subsystems[0].smooth is not None


def test_a_chart_of_a_rectangular_wave_without_damping() -> None:
    """Meissner's equation: the trace of the monodromy matrix is known, and tells every verdict."""
    system = PeriodicSystem([[1.0]], stiffness=[[1.0]], terms=[Term("stiffness", [[1.0]], waveforms.rectangular())])
    Omega, eps = np.linspace(0.3, 3.0, 40), np.linspace(0.0, 0.9, 20)
    chart = stability_chart(system, Omega, eps, audit=0, n_jobs=1, progress=False)
    u, v = (np.pi / Omega * np.sqrt(1 + sign * eps[:, None]) for sign in (1, -1))
    trace = 2 * np.cos(u) * np.cos(v) - (u / v + v / u) * np.sin(u) * np.sin(v)
    growth = np.arccosh(np.maximum(np.abs(trace) / 2, 1.0))
    assert np.abs(chart.growth_rate * 2 * np.pi / Omega - growth).max() < 1e-9
    clear = np.abs(np.abs(trace) - 2) > 1e-6
    np.testing.assert_array_equal((chart.kind > Kind.STABLE)[clear], (growth > 0)[clear])
    assert (chart.kind[clear] != Kind.UNDECIDED).all()
