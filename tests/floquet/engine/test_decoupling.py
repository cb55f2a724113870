"""Independent subsystems, and the coordinates in which each is integrated."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.linalg as sla
from hypothesis import example, given, settings
from hypothesis import strategies as st

import floquet.engine.decoupling
from floquet import stability_chart
from floquet.engine import equations, subsystems
from floquet.engine.decoupling import invariant_subspaces
from periodic import PeriodicSystem
from periodic.checks import FloatArray
from periodic.examples import coupled_mathieu, gyroscopic_rotor, mathieu
from tests.floquet.oracle_systems import first_order, random_system

some = settings(max_examples=20, deadline=None)


def joined(*systems: PeriodicSystem, seed: int = 0) -> PeriodicSystem:
    """One system made of independent ones, hidden by a random change of coordinates."""
    n = sum(s.size for s in systems)
    T = np.eye(n) + 0.5 * np.random.default_rng(seed).standard_normal((n, n)) / np.sqrt(n)

    def direct_sum(name: str) -> FloatArray:
        return T.T @ sla.block_diag(*(getattr(s, name) for s in systems)) @ T

    def harmonics(name: str) -> list[FloatArray]:
        return [T.T @ sla.block_diag(*F) @ T for F in zip(*(getattr(s, name) for s in systems), strict=True)]

    M, G, C, K = (direct_sum(name) for name in ("mass", "gyroscopic", "damping", "stiffness"))
    return PeriodicSystem(M, G, C, K, harmonics("cosine"), harmonics("sine"))


@some
@example(218754, [3, 4], False)  # with one combination the two stay together
@given(st.integers(0, 10**6), st.lists(st.integers(1, 4), min_size=1, max_size=3), st.booleans())
def test_hidden_subsystems_are_found(seed: int, sizes: list[int], symmetric: bool) -> None:
    parts = [random_system(seed + i, n, 2, symmetric=symmetric, damping=0.1) for i, n in enumerate(sizes)]
    found = sorted(len(subsystem.K) for subsystem in subsystems(joined(*parts, seed=seed)))
    assert found == sorted(sizes)


@some
@given(st.integers(0, 10**6), st.integers(1, 6))
def test_bases_are_orthonormal_and_complete(seed: int, n: int) -> None:
    matrices = np.random.default_rng(seed).standard_normal((3, n, n))
    matrices[:, : n // 2, n // 2 :] = matrices[:, n // 2 :, : n // 2] = 0
    X = np.hstack(invariant_subspaces(matrices))
    np.testing.assert_allclose(X.T @ X, np.eye(n), atol=1e-13)


@some
@given(st.integers(0, 10**6), st.lists(st.integers(1, 3), min_size=2, max_size=4))
def test_subsystems_of_a_family_keep_their_order(seed: int, sizes: list[int]) -> None:
    # members of a family differ in their excitation; the order of eigenvalues of a combination differs with it
    rng = np.random.default_rng(seed)
    turn = sla.qr(rng.standard_normal((sum(sizes), sum(sizes))))[0]
    one, other = (
        invariant_subspaces(
            np.array([turn @ sla.block_diag(*(rng.standard_normal((n, n)) for n in sizes)) @ turn.T for _ in range(3)])
        )
        for _ in range(2)
    )
    for X, Y in zip(one, other, strict=True):
        np.testing.assert_allclose(X @ X.T, Y @ Y.T, atol=1e-10)


def test_no_matrices_at_all() -> None:
    assert [X.tolist() for X in invariant_subspaces(np.zeros((2, 2, 2)))] == [[[1.0], [0.0]], [[0.0], [1.0]]]


def test_one_sided_coupling_keeps_subsystems_together() -> None:
    # no invariant complement is lost: an unsymmetric matrix couples both ways
    matrices = np.array([[[1.0, 0.3], [0.0, 2.0]], np.diag([1.0, 3.0])])
    assert len(invariant_subspaces(matrices)) == 1


@pytest.mark.parametrize("coupling", [1e-2, 1e-5, 1e-9])
def test_weak_couplings_are_couplings(coupling: float) -> None:
    matrices = np.array([np.diag([1.0, 2.0, 3.0]), np.diag([0.5, 0.1, 0.3])])
    matrices[0, 0, 1] = matrices[0, 1, 0] = coupling
    assert sorted(X.shape[1] for X in invariant_subspaces(matrices)) == [1, 2]


def test_split_and_unsplit_agree(monkeypatch: pytest.MonkeyPatch) -> None:
    system = joined(random_system(5, 3, 2), random_system(6, 2, 2), mathieu_like(2))
    Omega, eps = np.linspace(1.0, 3.0, 6), np.linspace(0.0, 0.8, 9)
    split = stability_chart(system, Omega, eps, audit=0)
    monkeypatch.setattr(floquet.engine.decoupling, "COUPLING_TOLERANCE", -1.0)
    subsystems.cache_clear()
    assert len(subsystems(system)) == 1
    whole = stability_chart(system, Omega, eps, audit=0)
    difference = np.abs(split.growth_rate - whole.growth_rate) * 2 * np.pi / Omega
    assert (difference <= split.error + whole.error + 1e-13).all()
    decided = (split.kind >= 0) & (whole.kind >= 0)
    assert ((split.kind > 0) == (whole.kind > 0))[decided].all()
    assert decided.mean() > 0.9


def mathieu_like(harmonics: int) -> PeriodicSystem:
    """Mathieu's equation as a system of that many harmonics."""
    F = np.zeros((harmonics, 1, 1))
    F[0] = 1.0
    return PeriodicSystem([[1.0]], [[0.0]], [[0.0]], [[1.3]], F)


@some
@given(st.integers(0, 10**6), st.integers(1, 4), st.booleans(), st.sampled_from([0.0, 0.4]))
def test_free_motion_has_the_eigenvalues_of_the_system(seed: int, n: int, symmetric: bool, damping: float) -> None:
    system = random_system(seed, n, symmetric=symmetric, damping=damping)
    exact = first_order(system, 1.0, 0.0, 0.0)
    found = [equations(subsystem, 0.1).A for subsystem in subsystems(system)]
    # characteristic polynomials: eigenvalues themselves may be ill-conditioned
    polynomial = np.array([1.0])
    for A in found:
        polynomial = np.polymul(polynomial, np.poly(A))
    expected = np.poly(exact)
    assert polynomial == pytest.approx(expected, abs=1e-11 * np.abs(expected).max())


def test_energy_coordinates() -> None:
    # conservative motion is a rotation, damping shrinks: A + A^T = -2 diag(0, C), with nothing left of the stiffness
    system = random_system(8, 4, damping=0.3)
    (subsystem,) = subsystems(
        PeriodicSystem(
            system.mass, system.gyroscopic, system.damping, system.mass + 0.1 * system.damping, system.cosine
        )
    )
    free = equations(subsystem, 1e-3)
    zero = np.zeros((4, 4))
    expected = np.block([[zero, zero], [zero, -2 * subsystem.C]])
    np.testing.assert_allclose(free.A + free.A.T, expected, atol=1e-12)


def test_canonical_coordinates() -> None:
    # the flow is Hamiltonian: J A is symmetric
    (subsystem,) = subsystems(random_system(9, 4))
    assert subsystem.symplectic
    A = equations(subsystem, 1e-3).A
    b = len(subsystem.K)
    J = np.block([[np.zeros((b, b)), np.eye(b)], [-np.eye(b), np.zeros((b, b))]])
    np.testing.assert_allclose(J @ A, (J @ A).T, atol=1e-12 * np.abs(A).max())


def test_kinds_of_subsystems() -> None:
    def properties(system: PeriodicSystem) -> list[tuple[bool, bool]]:
        return [(subsystem.symplectic, subsystem.reversible) for subsystem in subsystems(system)]

    assert properties(mathieu()) == [(True, True)]
    assert properties(mathieu(damping=0.1)) == [(False, False)]
    assert properties(coupled_mathieu("difference")) == [(False, True)]
    assert properties(gyroscopic_rotor()) == [(True, False)]


def test_damping_of_one_subsystem_leaves_the_other_conservative() -> None:
    system = joined(mathieu(1.0), mathieu(2.0, damping=0.3))
    assert sorted(subsystem.symplectic for subsystem in subsystems(system)) == [False, True]


def test_ill_conditioned_mass() -> None:
    # a change of coordinates with condition 1e4: mass with 1e8
    system = random_system(4, 3, damping=0.2)
    T = sla.qr(np.random.default_rng(1).standard_normal((3, 3)))[0] @ np.diag([1.0, 1e-2, 1e-4])
    arrays = (system.mass, system.gyroscopic, system.damping, system.stiffness, system.cosine, system.sine)
    changed = PeriodicSystem(*[T.T @ S @ T for S in arrays])
    one, other = (stability_chart(s, [1.0, 2.0], [0.0, 0.5], audit=0) for s in (system, changed))
    assert other.growth_rate == pytest.approx(one.growth_rate, abs=1e-8)
