"""Lane-wise eigenvalues against LAPACK and against identities."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import scipy.linalg as sla
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from floquet.engine.eigen.hessenberg import HESSENBERG_VECTORS, eigenvalues, hessenberg
from floquet.engine.eigen.lanes import LANE_COUNT
from floquet.engine.eigen.reflections import lane_array, lane_vectors
from floquet.engine.eigen.symplectic import PVL_VECTORS, pvl, reciprocal_pairs, reciprocal_sums, skew_hamiltonian
from periodic.checks import ComplexArray, FloatArray

some = settings(max_examples=25, deadline=None)
ONE_EACH = np.eye(LANE_COUNT)[None]  # lane i is sample i: weights (1 group, 16 samples, 16 lanes)


def lanes(matrices: FloatArray) -> ComplexArray:
    """Eigenvalues of sixteen matrices (16, n, n), one to a lane."""
    # a lane that has converged computes on, and what it finds is thrown away: without compilation NumPy would warn
    with np.errstate(all="ignore"):
        return eigenvalues(np.ascontiguousarray(matrices, dtype=float), ONE_EACH)


def distance(found: NDArray[Any], expected: NDArray[Any]) -> float:
    """Largest distance of an eigenvalue from its nearest in the other set, both ways."""
    between = np.abs(found[:, None] - expected)
    return max(between.min(axis=0).max(), between.min(axis=1).max())


def random_symplectic(rng: np.random.Generator, n: int, size: float) -> FloatArray:
    """exp(J S) with S symmetric."""
    S = rng.standard_normal((2 * n, 2 * n)) * size
    J = np.block([[np.zeros((n, n)), np.eye(n)], [-np.eye(n), np.zeros((n, n))]])
    return sla.expm(J @ (S + S.T) / 2)


@some
@given(st.integers(0, 10**6), st.integers(1, 16))
def test_random_matrices(seed: int, n: int) -> None:
    A = np.random.default_rng(seed).standard_normal((LANE_COUNT, n, n)) / np.sqrt(n)
    found = lanes(A)
    for matrix, mu in zip(A, found, strict=True):
        # sums of powers are well-conditioned, whatever the eigenvalues are
        for power in (1, 2, 3):
            exact = np.trace(np.linalg.matrix_power(matrix, power))
            assert (mu**power).sum() == pytest.approx(exact, abs=1e-12 * n)
        assert np.prod(mu) == pytest.approx(np.linalg.det(matrix), abs=1e-12)


@some
@given(st.integers(0, 10**6), st.integers(2, 24))
def test_orthogonal_matrices(seed: int, n: int) -> None:
    # normal: every eigenvalue is as good as the matrix; neighbours in eps look like this
    rng = np.random.default_rng(seed)
    S, D = (X - X.T for X in rng.standard_normal((2, n, n)))
    A = np.array([sla.expm(S + 0.01 * lane * D) for lane in range(LANE_COUNT)])
    for matrix, mu in zip(A, lanes(A), strict=True):
        assert distance(mu, np.linalg.eigvals(matrix)) < 1e-13
        assert np.abs(mu) == pytest.approx(1, abs=1e-13)


@pytest.mark.kernel
def test_awkward_matrices_share_a_group() -> None:
    n = 6
    rng = np.random.default_rng(3)
    cycle = np.roll(np.eye(n), 1, axis=0)  # Francis shifts do nothing here: needs the exceptional ones
    subsystems = np.kron(np.eye(3), [[0.0, 1.0], [-1.0, 0.0]])
    graded = rng.standard_normal((n, n)) * 10.0 ** -np.add.outer(np.arange(n), np.arange(n))
    matrices = np.array(
        [
            np.eye(n),
            np.zeros((n, n)),
            cycle,
            subsystems,
            np.triu(rng.standard_normal((n, n))),
            np.diag(np.arange(n) / n),
            rng.standard_normal((n, n)),
            graded,
            *rng.standard_normal((LANE_COUNT - 8, n, n)),
        ]
    )
    for matrix, mu in zip(matrices, lanes(matrices), strict=True):
        assert distance(mu, np.linalg.eigvals(matrix)) < 1e-12


def twins(rng: np.random.Generator) -> FloatArray:
    """Two pairs of eigenvalues 0 and 2, weakly coupled: ordinary shifts are one of each, and get nowhere."""
    turns = [sla.expm(angle * np.array([[0.0, 1.0], [-1.0, 0.0]])) for angle in rng.uniform(0, np.pi, 2)]
    pairs = sla.block_diag(*(turn @ np.diag([0.0, 2.0]) @ turn.T for turn in turns))
    coupling = 10.0 ** -rng.integers(5, 9) * rng.standard_normal((4, 4))
    return 10.0 ** -rng.integers(0, 13) * np.triu(pairs + coupling, -1)


def test_sweeps_in_vain_are_noticed() -> None:
    rng = np.random.default_rng(0)
    for _ in range(40):
        matrices = np.array([twins(rng) for _ in range(LANE_COUNT)])
        for matrix, mu in zip(matrices, lanes(matrices), strict=True):
            assert distance(mu, np.linalg.eigvals(matrix)) < 1e-7 * np.linalg.norm(matrix)  # nearly double


def test_defective_matrix() -> None:
    n = 5
    jordan = np.eye(n, k=1) + 0.5 * np.eye(n)
    mu = lanes(np.array([jordan] * LANE_COUNT))
    # backward stable: each eigenvalue within the fifth square_root of a few roundings
    assert np.abs(mu - 0.5).max() < (10 * n * 2e-16) ** (1 / n)


@pytest.mark.kernel
def test_hessenberg_form() -> None:
    n = 5
    A = lane_array(n)
    A[:n, :n] = np.random.default_rng(1).standard_normal((n, n, LANE_COUNT))
    before = A[:n, :n].copy()
    hessenberg(A, n, lane_vectors(HESSENBERG_VECTORS, n))
    for lane in range(LANE_COUNT):
        H = A[:n, :n, lane]
        assert (np.tril(H, -2) == 0).all()
        assert np.linalg.norm(H) == pytest.approx(np.linalg.norm(before[..., lane]), rel=1e-14)
        assert np.poly(H) == pytest.approx(np.poly(before[..., lane]), abs=1e-12)


@pytest.mark.kernel
def test_weights_combine_samples() -> None:
    rng = np.random.default_rng(2)
    samples, weights = rng.standard_normal((3, 4, 4)), rng.standard_normal((2, 3, LANE_COUNT))
    found = eigenvalues(samples, weights).reshape(2, LANE_COUNT, 4)
    for group in range(2):
        for lane in range(LANE_COUNT):
            matrix = np.tensordot(weights[group, :, lane], samples, 1)
            assert distance(found[group, lane], np.linalg.eigvals(matrix)) < 1e-12


@some
@given(st.integers(0, 10**6), st.integers(1, 10), st.floats(0.05, 0.5))
def test_symplectic_matrices(seed: int, n: int, size: float) -> None:
    rng = np.random.default_rng(seed)
    Phi = np.array([random_symplectic(rng, n, size / np.sqrt(n)) for _ in range(LANE_COUNT)])
    found = reciprocal_sums(Phi, ONE_EACH)
    for matrix, s in zip(Phi, found, strict=True):
        # every s = mu + 1/mu is a double eigenvalue of Phi + Phi^-1
        W = matrix + np.linalg.inv(matrix)
        for power in (1, 2, 3):
            exact = np.trace(np.linalg.matrix_power(W, power)) / 2
            assert (s**power).sum() == pytest.approx(exact, abs=1e-12 * n * float(np.linalg.norm(W, 2)) ** power)


@pytest.mark.kernel
def test_pvl_reduction() -> None:
    n = 5
    rng = np.random.default_rng(0)
    Phi = lane_array(2 * n)
    for lane in range(LANE_COUNT):
        Phi[: 2 * n, : 2 * n, lane] = random_symplectic(rng, n, 0.3)
    A, G, Q = lane_array(n), lane_array(n), lane_array(n)
    skew_hamiltonian(Phi, A, G, Q, n)
    W = [Phi[: 2 * n, : 2 * n, lane] + np.linalg.inv(Phi[: 2 * n, : 2 * n, lane]) for lane in range(LANE_COUNT)]
    for lane in range(LANE_COUNT):
        a, g, q = (X[:n, :n, lane] for X in (A, G, Q))
        whole = np.block([[a, g - g.T], [q - q.T, a.T]])  # only what is below the diagonal is written
        assert whole == pytest.approx(W[lane], abs=1e-14 * float(np.linalg.norm(W[lane])))
    pvl(A, G, Q, n, lane_vectors(PVL_VECTORS, n))
    for lane in range(LANE_COUNT):
        H = A[:n, :n, lane]
        assert (np.tril(H, -2) == 0).all()
        doubled = np.polymul(np.poly(H), np.poly(H))
        assert doubled == pytest.approx(np.poly(W[lane]), abs=1e-12 * np.abs(doubled).max())


def test_no_excitation_stays_exactly_on_the_circle() -> None:
    # rotations: all s are real between -2 and 2, so that every |mu| is exactly one; decoupled ones meet 0 / 0 in the
    # reduction
    n = 4
    angles = np.linspace(0.3, 2.9, n)
    rotation = np.block(
        [[np.diag(np.cos(angles)), np.diag(np.sin(angles))], [-np.diag(np.sin(angles)), np.diag(np.cos(angles))]]
    )
    s = reciprocal_sums(np.array([rotation] * LANE_COUNT), ONE_EACH)
    assert (s.imag == 0).all()
    assert np.sort(s.real, axis=1) == pytest.approx(np.tile(np.sort(2 * np.cos(angles)), (LANE_COUNT, 1)), abs=1e-15)


def test_reciprocal_pairs() -> None:
    mu = np.array([3.0, -0.2, 0.5 + 0.1j, np.exp(0.4j), 1e9, 1.0])
    pairs = reciprocal_pairs((mu + 1 / mu)[None].astype(complex))[0]
    assert distance(pairs, np.concatenate([mu, 1 / mu])) < 1e-7  # the double one at 1 is good to the root of rounding
    assert (pairs[:6] * pairs[6:]) == pytest.approx(1, abs=1e-14)
