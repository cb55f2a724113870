"""Multipliers, the error of the largest modulus, and the verdict: never wrong, seldom undecided."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.linalg as sla
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import brentq
from scipy.special import mathieu_a

from floquet import Kind, monodromy
from floquet.oracle.multipliers import by_modulus, combine, spectrum
from periodic import PeriodicSystem
from periodic.checks import FloatArray
from periodic.examples import coupled_mathieu, gyroscopic_rotor, mathieu
from tests.floquet.oracle_systems import random_system

some = settings(max_examples=40, deadline=None)
FORM = np.array([[0.0, 1.0], [-1.0, 0.0]])


def largest(matrix: FloatArray) -> float:
    return np.log(np.abs(np.linalg.eigvals(matrix)).max())


def random_matrix(seed: int, N: int = 6) -> FloatArray:
    """Real matrix with one dominant eigenvalue, or two close or equal ones, in coordinates of moderate condition."""
    rng = np.random.default_rng(seed)
    core = np.triu(rng.standard_normal((N, N)), 1) + np.diag(rng.uniform(-0.7, 0.7, N))
    core[0, 0] = rng.uniform(0.8, 1.3)
    core[1, 1] = core[0, 0] - rng.choice([0.0, 1e-12, 1e-9, 1e-6, 1e-3, 0.3])
    core[0, 1] *= rng.choice([0.0, 1e-6, 1.0])
    T = np.eye(N) + 0.5 * rng.standard_normal((N, N)) / np.sqrt(N)
    return T @ core @ np.linalg.inv(T)


@some
@given(st.integers(0, 10**6), st.sampled_from([1e-12, 1e-10, 1e-7]))
def test_error_of_the_largest_modulus_is_honest(seed: int, E: float) -> None:
    Phi = random_matrix(seed)
    found = spectrum(Phi, E, reciprocal=False)
    rng = np.random.default_rng(seed)
    worst = 0.0
    for _ in range(20):
        D = rng.standard_normal(Phi.shape)
        if rng.random() < 0.5:  # perturbations of rank one are the ones that matter for a defective eigenvalue
            D = np.outer(D[0], D[1])
        worst = max(worst, abs(largest(Phi + E * D / np.linalg.norm(D, 2)) - found.log_modulus))
    assert worst <= 1.2 * found.error + 1e-13  # the excursion is looked for to 10 %; eigvals has rounding of its own
    # and of use: random perturbations in 36 dimensions are a few times weaker than the worst one
    assert found.error < 300 * worst + 1e-13


def test_error_follows_the_square_root_near_a_defective_multiplier() -> None:
    for E in (1e-12, 1e-8):
        for distance in (0.0, 1e-7, 1e-2):
            found = spectrum(np.array([[1.2, 1.0], [0.0, 1.2 - distance]]), E, reciprocal=False)
            # shift x with x (x + distance) = E, relative to 1.2
            exact = (np.sqrt(distance**2 + 4 * E) - distance) / 2 / 1.2
            assert exact * 0.8 < found.error < 2 * exact


def test_error_of_well_conditioned_multiple_multipliers_is_not_a_root() -> None:
    found = spectrum(1.1 * np.eye(4), 1e-10, reciprocal=False)
    assert found.error == pytest.approx(1e-10 / 1.1, rel=0.1)


@pytest.mark.parametrize(
    ("mu", "kind"),
    [
        (1.01, Kind.PLUS_ONE),
        (-1.01, Kind.MINUS_ONE),
        (1.01 * np.exp(0.3j), Kind.COMPLEX),
        (0.99, Kind.STABLE),
        (-0.99, Kind.STABLE),
        (1.0 + 1e-12, Kind.UNDECIDED),
        (1.0 - 1e-12, Kind.UNDECIDED),
    ],
)
def test_kinds_of_a_dissipative_system(mu: complex, kind: Kind) -> None:
    pair = np.array([[np.real(mu), np.imag(mu)], [-np.imag(mu), np.real(mu)]])
    Phi = sla.block_diag(pair if np.imag(mu) else pair[:1, :1], [[0.5]])
    found = spectrum(Phi, 1e-10, reciprocal=False)
    assert found.kind == kind
    assert found.log_modulus == pytest.approx(np.log(abs(mu)), abs=1e-14)


def rotation(angle: float) -> FloatArray:
    return np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])


def symplectic(*subsystems: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Two-by-two subsystems (x_i, p_i) in the order (x, p), and the form they conserve."""
    n = len(subsystems)
    order = np.argsort(np.arange(2 * n) % 2, kind="stable")
    inner = np.ix_(order, order)
    return sla.block_diag(*subsystems)[inner], sla.block_diag(*[FORM] * n)[inner]


def test_isolated_multipliers_stay_on_the_circle() -> None:
    Phi, form = symplectic(rotation(0.5), rotation(1.5))
    rng = np.random.default_rng(0)
    for _ in range(10):
        noisy = Phi + 1e-9 * rng.standard_normal((4, 4))
        found = spectrum(noisy, 1e-8, reciprocal=True, form=form)
        assert found.kind == Kind.STABLE
        assert found.log_modulus == 0.0
        assert np.abs(found.multipliers) == pytest.approx(np.ones(4), abs=1e-15)


@pytest.mark.parametrize(
    ("angles", "kind"),
    [
        ((0.5, 0.5), Kind.STABLE),  # equal signatures: no perturbation of the Hamiltonian makes them leave
        ((0.5, -0.5), Kind.UNDECIDED),  # opposite ones: almost any does
        ((0.5, np.pi), Kind.UNDECIDED),
        ((0.5, 1e-12), Kind.UNDECIDED),
        ((0.5, 1e-3), Kind.STABLE),
    ],
)
def test_signature_decides_whether_multipliers_can_leave(angles: tuple[float, float], kind: Kind) -> None:
    Phi, form = symplectic(*[rotation(angle) for angle in angles])
    assert spectrum(Phi, 1e-9, reciprocal=True, form=form).kind == kind


def test_reciprocal_systems_without_a_form_are_undecided_at_double_multipliers() -> None:
    Phi, _ = symplectic(rotation(0.5), rotation(0.5))
    assert spectrum(Phi, 1e-9, reciprocal=True).kind == Kind.UNDECIDED
    Phi, _ = symplectic(rotation(0.5), rotation(0.7))
    assert spectrum(Phi, 1e-9, reciprocal=True).kind == Kind.STABLE


def test_combination_of_subsystems() -> None:
    stable = spectrum(0.9 * rotation(0.5), 1e-9, reciprocal=False)
    growing = spectrum(np.diag([1.1, 0.2]), 1e-9, reciprocal=False)
    open_ = spectrum(np.diag([1.0, 0.2]), 1e-9, reciprocal=False)
    assert combine([stable]).log_modulus == stable.log_modulus
    assert combine([stable]).error == pytest.approx(stable.error)
    assert combine([stable, growing]).kind == Kind.PLUS_ONE
    assert combine([growing, open_]).kind == Kind.PLUS_ONE
    both = combine([stable, open_])
    assert both.kind == Kind.UNDECIDED
    assert both.log_modulus == open_.log_modulus
    assert np.abs(both.multipliers) == pytest.approx([1.0, 0.9, 0.9, 0.2])


def test_order_of_multipliers() -> None:
    mu = np.array([0.5, -2.0, 1j, -1j, 1.0])
    assert mu[by_modulus(mu)] == pytest.approx([-2.0, -1j, 1.0, 1j, 0.5])


@some
@given(st.integers(0, 10**6), st.integers(1, 4), st.floats(0.5, 5.0), st.floats(0.0, 1.0))
def test_no_false_verdict_on_conservative_systems(seed: int, n: int, Omega: float, eps: float) -> None:
    found = monodromy(random_system(seed, n, 2), Omega, eps)
    tight = monodromy(random_system(seed, n, 2), Omega, eps, tolerance=1e-14)
    log_modulus = largest(tight.matrix)
    if found.kind == Kind.STABLE:
        assert log_modulus < 1e-6  # what rounding makes of multipliers on the circle, however close to each other
        assert np.abs(found.multipliers) == pytest.approx(np.ones(2 * n), abs=1e-14)
    elif found.kind > Kind.STABLE:
        assert log_modulus > 0.5 * found.log_modulus_error
    else:
        assert log_modulus < 1e-5


def mathieu_edge(eps: float) -> float:
    """Lower edge of the first region of x'' + (1 + eps cos Omega t) x = 0."""
    return brentq(lambda Omega: mathieu_a(1, 2 * eps / Omega**2) - 4 / Omega**2, 1.5, 2.0, xtol=1e-15)


@pytest.mark.parametrize("offset", [1e-3, 1e-6, 1e-9])
def test_verdict_near_an_edge_of_mathieu(offset: float) -> None:
    edge, eps = mathieu_edge(0.1), 0.1
    assert monodromy(mathieu(), edge - offset, eps).kind == Kind.STABLE
    inside = monodromy(mathieu(), edge + offset, eps)
    assert inside.kind == Kind.MINUS_ONE
    # |mu| - 1 goes like the square root of the distance
    reference = monodromy(mathieu(), edge + 1e-4, eps).growth_rate
    assert inside.growth_rate == pytest.approx(reference * (offset / 1e-4) ** 0.5, rel=0.01)
    assert inside.log_modulus_error < 0.01 * inside.growth_rate * np.pi


def test_verdict_on_an_edge_is_undecided() -> None:
    found = monodromy(mathieu(), mathieu_edge(0.1), 0.1)
    assert found.kind == Kind.UNDECIDED
    assert 1e-9 < found.log_modulus_error < 1e-5


@pytest.mark.parametrize(
    ("system", "Omega", "eps", "kind"),
    [
        (mathieu(), 2.0, 0.1, Kind.MINUS_ONE),
        (mathieu(), 1.0, 0.5, Kind.PLUS_ONE),
        (mathieu(), 3.0, 0.5, Kind.STABLE),
        (mathieu(1.0, 0.2), 2.0, 0.1, Kind.STABLE),
        (mathieu(1.0, 0.01), 2.0, 0.1, Kind.MINUS_ONE),
        (coupled_mathieu("sum"), 2.7, 0.1, Kind.COMPLEX),
        (coupled_mathieu("sum"), 0.7, 0.1, Kind.STABLE),
        (coupled_mathieu("difference"), 0.7, 0.1, Kind.COMPLEX),
        (coupled_mathieu("difference"), 2.7, 0.1, Kind.STABLE),
        (gyroscopic_rotor(), 4.0, 0.1, Kind.COMPLEX),
        (gyroscopic_rotor(), 3.0, 0.1, Kind.STABLE),
    ],
)
def test_known_verdicts(system: PeriodicSystem, Omega: float, eps: float, kind: Kind) -> None:
    assert monodromy(system, Omega, eps).kind == kind


@pytest.mark.parametrize("Omega", [2.0, 1.0, 0.4, 1.3])
def test_what_is_not_excited_is_stable_even_at_resonance(Omega: float) -> None:
    for system in (mathieu(), gyroscopic_rotor((1.0, 1.0), 0.3)):
        found = monodromy(system, Omega, 0.0)
        assert found.kind == Kind.STABLE
        assert found.growth_rate == 0.0
    assert monodromy(mathieu(-1.0), Omega, 0.0).kind == Kind.PLUS_ONE
    # above its critical speeds the stiffness is negative and gyroscopic forces alone keep the rotor up
    assert monodromy(gyroscopic_rotor((4.0, 4.0), 3.0), 1.3, 0.0).kind == Kind.STABLE


def test_two_equal_oscillators_are_not_undecided() -> None:
    one = mathieu()
    arrays = (one.mass, one.gyroscopic, one.damping, one.stiffness, one.cosine)
    twice = PeriodicSystem(*[np.kron(np.eye(2), S) for S in arrays])
    for Omega, kind in ((2.0, Kind.MINUS_ONE), (3.0, Kind.STABLE)):
        assert monodromy(twice, Omega, 0.2).kind == kind


@pytest.mark.parametrize("size", [2.0**470, 2.0**490])
def test_large_matrices(size: float) -> None:
    # grows by 1e140 and more in a period, as monodromy allows
    Phi = np.random.default_rng(0).standard_normal((12, 12))
    found = spectrum(size * Phi, 0.0, reciprocal=False)
    assert found.log_modulus == pytest.approx(np.log(np.abs(np.linalg.eigvals(Phi)).max()) + np.log(size), rel=1e-13)
