"""Gyroscopic modes: identities (14)-(17), exact cases, repeated frequencies, refusals."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from periodic import PeriodicSystem
from periodic.examples import gyroscopic_rotor, mathieu
from perturb import gyroscopic_modes
from tests.perturb.paper_blocks import modal_blocks
from tests.perturb.perturb_oracles import changed, congruent, copies, moving_string, random_system

seeds = st.integers(0, 10**6)
few = settings(deadline=None, max_examples=15)


def first_order_matrices(system: PeriodicSystem) -> tuple[np.ndarray, np.ndarray]:
    """A and B of eq. (13)."""
    M, G, K, zero = system.mass, system.gyroscopic, system.stiffness, np.zeros_like(system.mass)
    return np.block([[M, zero], [zero, K]]), np.block([[G, K], [-K, zero]])


@few
@given(seeds, st.integers(1, 8))
def test_modal_matrix_diagonalises(seed: int, n: int) -> None:
    """Eqs. (15), (16)."""
    system = random_system(seed, n)
    A, B = first_order_matrices(system)
    modes = gyroscopic_modes(system)
    P = modes.modal_matrix
    np.testing.assert_allclose(P.T @ A @ P, np.eye(2 * n), atol=1e-12)
    Lambda = np.kron(np.diag(modes.frequencies), [[0, -1], [1, 0]])
    np.testing.assert_allclose(P.T @ B @ P, Lambda, atol=1e-12 * modes.frequencies[-1])


@few
@given(seeds, st.integers(1, 8))
def test_frequencies_are_eigenvalues(seed: int, n: int) -> None:
    """Against the eigenvalues of the companion matrix, an unsymmetric problem."""
    system = random_system(seed, n)
    inverse = np.linalg.inv(system.mass)
    companion = np.block([[np.zeros((n, n)), np.eye(n)], [-inverse @ system.stiffness, -inverse @ system.gyroscopic]])
    values = np.sort(np.linalg.eigvals(companion).imag)[n:]
    np.testing.assert_allclose(gyroscopic_modes(system).frequencies, values, rtol=1e-10)


@few
@given(seeds)
def test_vectors_solve_the_equations_of_motion(seed: int) -> None:
    system = random_system(seed, 5)
    modes = gyroscopic_modes(system)
    for omega, w in zip(modes.frequencies, modes.vectors.T, strict=True):
        residual = (-(omega**2) * system.mass + 1j * omega * system.gyroscopic + system.stiffness) @ w
        assert np.abs(residual).max() < 1e-11
        assert (w.conj() @ (omega**2 * system.mass + system.stiffness) @ w).real == pytest.approx(2.0, rel=1e-13)
        largest = w[np.argmax(np.abs(w))]
        assert largest.real > 0
        assert abs(largest.imag) < 1e-12 * largest.real


def test_shapes_and_freezing() -> None:
    modes = gyroscopic_modes(random_system(1, 4))
    assert (modes.frequencies.shape, modes.vectors.shape, modes.decay.shape) == ((4,), (4, 4), (4,))
    assert (modes.states.shape, modes.modal_matrix.shape) == ((8, 4), (8, 8))
    assert (np.diff(modes.frequencies) > 0).all()
    for array in (modes.frequencies, modes.vectors, modes.decay):
        assert not array.flags.writeable


@few
@given(seeds)
def test_coordinates_decide_nothing(seed: int) -> None:
    """W = T V leaves frequencies and decay alone and turns w into T^{-1} w, but for a phase."""
    system = random_system(seed, 4, damping=0.1)
    T = np.random.default_rng(seed).normal(size=(4, 4)) + 3 * np.eye(4)
    there, here = gyroscopic_modes(congruent(system, T)), gyroscopic_modes(system)
    np.testing.assert_allclose(there.frequencies, here.frequencies, rtol=1e-10)
    np.testing.assert_allclose(there.decay, here.decay, rtol=1e-8)
    back = T @ there.vectors
    phase = np.sum(here.vectors.conj() * back, axis=0)
    np.testing.assert_allclose(back, here.vectors * phase / np.abs(phase), atol=1e-8)


@few
@given(seeds, st.floats(0.01, 100))
def test_unit_of_time(seed: int, unit: float) -> None:
    """t = unit t': M / unit^2, (G, C) / unit."""
    system = random_system(seed, 3, damping=0.1)
    other = changed(
        system,
        mass=system.mass / unit**2,
        gyroscopic=system.gyroscopic / unit,
        damping=system.damping / unit,
    )
    here, there = gyroscopic_modes(system), gyroscopic_modes(other)
    np.testing.assert_allclose(there.frequencies, unit * here.frequencies, rtol=1e-11)
    np.testing.assert_allclose(there.decay, unit * here.decay, rtol=1e-10)


@few
@given(seeds)
def test_decay_coefficients_are_twice_the_decay_rates(seed: int) -> None:
    """To first order in C; the error of the exponents falls with its square."""
    system = random_system(seed, 4, damping=1.0)
    modes = gyroscopic_modes(system)
    inverse = np.linalg.inv(system.mass)
    error = []
    for part in (1e-3, 5e-4):
        damped = -inverse @ (system.gyroscopic + part * system.damping)
        companion = np.block([[np.zeros((4, 4)), np.eye(4)], [-inverse @ system.stiffness, damped]])
        values = np.linalg.eigvals(companion)
        rates = -values[np.argsort(values.imag)][4:].real
        error.append(np.abs(rates - part * modes.decay / 2).max())
    # Second order in C; its coefficient may vanish, then third.
    assert error[1] < 0.27 * error[0]


@pytest.mark.parametrize("seed", range(4))
def test_decay_is_exactly_zero_where_the_damper_does_not_reach(seed: int) -> None:
    """Two systems that know nothing of each other, one of them damped; with coordinates kept apart and mixed."""
    one, two = random_system(seed, 3, damping=0.1), random_system(seed + 9, 2)
    both = PeriodicSystem(
        **{
            name: np.concatenate(
                [
                    np.concatenate([getattr(one, name), np.zeros((*getattr(one, name).shape[:-1], 2))], axis=-1),
                    np.concatenate([np.zeros((*getattr(two, name).shape[:-1], 3)), getattr(two, name)], axis=-1),
                ],
                axis=-2,
            )
            for name in ("mass", "gyroscopic", "damping", "stiffness", "cosine")
        }
    )
    T = np.random.default_rng(seed).normal(size=(5, 5)) + 4 * np.eye(5)
    for case in (both, congruent(both, T)):
        decay = gyroscopic_modes(case).decay
        assert (decay == 0).sum() == 2
        np.testing.assert_allclose(np.sort(decay)[2:], np.sort(gyroscopic_modes(one).decay), rtol=1e-9)


def test_blocks_are_those_of_the_transformed_equations() -> None:
    """Eq. (17): C = P^T diag(C, 0) P, F* = P^T [[0, F], [0, 0]] P, entry rs of block nm."""
    system = random_system(3, 3, harmonics=2, damping=0.1)
    modes = gyroscopic_modes(system)
    P, zero = modes.modal_matrix, np.zeros((3, 3))
    blocks = modal_blocks(system, modes)
    C = P.T @ np.block([[system.damping, zero], [zero, zero]]) @ P
    for n in range(3):
        for m in range(3):
            at = np.ix_([2 * n, 2 * n + 1], [2 * m, 2 * m + 1])
            np.testing.assert_allclose(blocks.C[n, m], C[at], atol=1e-14)
            for part, harmonics in ((blocks.G, system.cosine), (blocks.H, system.sine)):
                for j in range(2):
                    F = P.T @ np.block([[zero, harmonics[j]], [zero, zero]]) @ P
                    np.testing.assert_allclose(part[j, n, m], F[at], atol=1e-14)
    # eq. (26a)
    np.testing.assert_allclose(np.einsum("nnrr->n", blocks.C), modes.decay, rtol=1e-12)


def test_rotor_in_closed_form() -> None:
    """omega = sqrt(k) ± s; decay d omega / sqrt(k) (docstring of `gyroscopic_rotor`)."""
    k, s, d = 4.0, 0.7, 0.02
    modes = gyroscopic_modes(gyroscopic_rotor((k, k), s, d))
    np.testing.assert_allclose(modes.frequencies, [np.sqrt(k) - s, np.sqrt(k) + s], rtol=1e-13)
    np.testing.assert_allclose(modes.decay, d * modes.frequencies / np.sqrt(k), rtol=1e-12)


def test_moving_string_converges_to_its_frequencies() -> None:
    """omega_k = k pi (1 - v^2); the sine series converges like n^-3 (kinks of the travelling wave at the ends)."""
    v, sizes = 0.4, np.array([10, 20, 40])
    error = [gyroscopic_modes(moving_string(v, n)).frequencies[0] / (np.pi * (1 - v**2)) - 1 for n in sizes]
    assert -3.1 < np.polyfit(np.log(sizes), np.log(error), 1)[0] < -2.8
    assert error[-1] < 1e-5


@few
@given(seeds, st.integers(2, 4))
def test_repeated_frequencies_stay_orthogonal(seed: int, count: int) -> None:
    """Copies of one system, mixed by a random change of coordinates."""
    one = random_system(seed, 2, damping=0.1)
    T = np.random.default_rng(seed).normal(size=(2 * count, 2 * count)) + 4 * np.eye(2 * count)
    many = congruent(copies(one, count), T)
    modes = gyroscopic_modes(many)
    np.testing.assert_allclose(modes.frequencies, np.repeat(gyroscopic_modes(one).frequencies, count), rtol=1e-10)
    assert modes.repeated.all()
    A, _ = first_order_matrices(many)
    P = modes.modal_matrix
    np.testing.assert_allclose(P.T @ A @ P, np.eye(4 * count), atol=1e-10)


def test_repeated_frequencies_have_one_basis() -> None:
    """Largest components first: the coordinate axes where the system allows them, whatever the solver returns."""
    modes = gyroscopic_modes(copies(changed(mathieu(4.0), cosine=[[[0.0]]]), 3))
    np.testing.assert_allclose(np.abs(modes.vectors), 0.5 * np.eye(3), atol=1e-15)
    np.testing.assert_allclose(modes.vectors.real, np.abs(modes.vectors), atol=1e-15)


@few
@given(seeds)
def test_vectors_are_real_without_gyroscopic_forces(seed: int) -> None:
    one = random_system(seed, 3, gyroscopic=0.0)
    two = copies(one, 2)
    for system in (one, two):
        modes = gyroscopic_modes(system)
        assert np.abs(modes.vectors.imag).max() < 1e-12 * np.abs(modes.vectors.real).max()
    assert modes.repeated.all()
    assert not gyroscopic_modes(one).repeated.any()


@pytest.mark.parametrize("value", [None, 3.0, "plate", np.eye(2)])
def test_refuses_what_is_no_system(value: object) -> None:
    with pytest.raises(ValueError, match=r"^system is of type .*; give a PeriodicSystem"):
        gyroscopic_modes(value)  # type: ignore[arg-type]


def test_refuses_indefinite_stiffness_with_its_eigenvalue() -> None:
    with pytest.raises(ValueError, match=r"^stiffness has the lowest eigenvalue -0\.3;.*floquet/ takes any"):
        gyroscopic_modes(mathieu(-0.3))
    with pytest.raises(ValueError, match=r"^stiffness has the lowest eigenvalue -5;"):
        gyroscopic_modes(gyroscopic_rotor((4.0, 9.0), spin=3.0))


def test_refuses_singular_stiffness() -> None:
    with pytest.raises(ValueError, match=r"^stiffness has the lowest eigenvalue"):
        gyroscopic_modes(changed(random_system(1, 3), stiffness=np.ones((3, 3))))


def test_refuses_unsymmetric_stiffness() -> None:
    K = random_system(1, 2).stiffness.copy()
    K[0, 1] += 0.1
    with pytest.raises(ValueError, match=r"^stiffness is not symmetric \(largest defect 0\.1\).*floquet/ takes any"):
        gyroscopic_modes(changed(random_system(1, 2), stiffness=K))
