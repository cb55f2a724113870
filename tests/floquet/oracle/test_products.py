"""Multipliers of every size against arithmetic of several hundred digits."""

from __future__ import annotations

import numpy as np
import pytest

from floquet import monodromy
from floquet.oracle.products import product_eigenvalues
from periodic import PeriodicSystem
from periodic.checks import FloatArray
from periodic.examples import coupled_mathieu, mathieu
from tests.floquet.oracle_systems import random_system
from tests.sparing import all_but

flint = pytest.importorskip("flint", reason="python-flint, the extra certify, is not installed")
from flint import acb, acb_mat, arb_mat, ctx  # noqa: E402

from floquet.certified import certified_monodromy  # noqa: E402

BITS = 600


def relative_errors(found: np.ndarray, matrix: arb_mat) -> FloatArray:
    """Distance of each number from the nearest eigenvalue of ``matrix``, relative to that eigenvalue."""
    with ctx.workprec(BITS):
        exact = acb_mat(matrix.mid()).eig(algorithm="approx")
        points = [acb(float(mu.real), float(mu.imag)) for mu in found]
        return np.array([min(float(abs(point - mu) / abs(mu)) for mu in exact) for point in points])


def factors_of(log_moduli: FloatArray, p: int, seed: int) -> FloatArray:
    """Factors whose product has the eigenvalues exp(p log_moduli), each in coordinates of its own."""
    rng, N = np.random.default_rng(seed), len(log_moduli)
    bases = np.eye(N) + 0.5 * rng.standard_normal((p, N, N)) / np.sqrt(N)
    return np.array([bases[(k + 1) % p] @ np.diag(np.exp(log_moduli)) @ np.linalg.inv(bases[k]) for k in range(p)])


@pytest.mark.parametrize("N", [1, 2, 5, 12])
@pytest.mark.parametrize("spread", [0.0, 0.2, 2.0])
def test_eigenvalues_of_a_product(N: int, spread: float) -> None:
    p = 40
    factors = factors_of(np.random.default_rng(N).uniform(-spread, spread, N), p, seed=N)
    found = product_eigenvalues(factors, np.zeros(p), np.zeros(p))
    with ctx.workprec(BITS):
        product = arb_mat(np.eye(N).tolist())
        for factor in factors:
            product = arb_mat(factor.tolist()) * product
    true = relative_errors(found.values, product)
    assert (true <= 3 * found.errors + 1e-14).all()
    if spread:
        assert found.errors.max() < 1e-9
        moduli = np.sort(np.abs(found.values))
        assert N < 5 or moduli[0] < 1e-2 * moduli[-1]


@pytest.mark.parametrize("pairs", [1, 3])
def test_complex_pairs(pairs: int) -> None:
    """Rotations in planes that shrink at different rates: moduli come in equal pairs."""
    p, turn = 30, np.array([[np.cos(0.7), -np.sin(0.7)], [np.sin(0.7), np.cos(0.7)]])
    basis = np.linalg.qr(np.random.default_rng(pairs).standard_normal((2 * pairs, 2 * pairs)))[0]
    factor = basis @ np.kron(np.diag(np.exp(-0.8 * np.arange(pairs))), turn) @ basis.T
    found = product_eigenvalues(np.array([factor] * p), np.zeros(p), np.zeros(p))
    order = np.argsort(-np.abs(found.values), kind="stable")
    assert np.log(np.abs(found.values[order])) == pytest.approx(-0.8 * p * np.repeat(np.arange(pairs), 2), abs=1e-11)
    angle = np.angle(np.exp(0.7j * p))
    assert np.abs(np.angle(found.values)) == pytest.approx(np.full(2 * pairs, abs(angle)), abs=1e-10)


def test_errors_of_the_factors_arrive() -> None:
    """Random errors of a known size shift the eigenvalues by what is estimated, neither much more nor much less."""
    p, N, size = 20, 4, 1e-9
    factors = factors_of(np.array([0.9, 0.3, -0.4, -1.1]), p, seed=3)
    quiet = np.zeros(p)
    exact = product_eigenvalues(factors, quiet, quiet).values
    rng, worst = np.random.default_rng(0), np.zeros(N)
    for _ in range(20):
        noise = rng.standard_normal(factors.shape)
        noise *= size / np.linalg.norm(noise, axis=(1, 2))[:, None, None]
        worst = np.maximum(worst, np.abs(product_eigenvalues(factors + noise, quiet, quiet).values / exact - 1))
    estimated = product_eigenvalues(factors, np.full(p, size), quiet).errors
    assert (worst <= 2 * estimated).all()
    assert (estimated <= 50 * worst).all()
    systematic = product_eigenvalues(factors, quiet, np.full(p, size)).errors
    assert (systematic > 2 * estimated).all()


def test_below_the_range_of_float64_is_zero_and_says_so() -> None:
    p = 64
    factors = np.array([np.diag([1.1, 1e-3, 1e-8, 1e-14])] * p)
    found = product_eigenvalues(factors, np.zeros(p), np.zeros(p))
    assert np.sort(found.values.real)[::-1] == pytest.approx([1.1**p, 1e-192, 0.0, 0.0], rel=1e-9)
    assert (found.errors == 1.0).tolist() == (found.values == 0).tolist()


SYSTEMS = {
    "strong excitation": (mathieu(), 0.15, 10.0),
    "saddle": (mathieu(delta=-9.0), 1.0, 0.5),
    "overdamped": (mathieu(1.0, 5.0), 0.5, 0.3),
    "coupled": (coupled_mathieu(), 0.15, 10.0),
    "damped and excited": (coupled_mathieu(damping=(3.0, 0.2)), 0.4, 2.0),
    **{
        f"random {seed}": (
            random_system(seed, 1 + seed % 4, 1 + seed % 3, symmetric=seed % 2 == 0, damping=(0.0, 1.0, 3.0)[seed % 3]),
            0.4,
            2.0,
        )
        for seed in range(6)
    },
}


# Proofs of these take many seconds each.
LONG = {"random 1", "random 2", "random 3", "random 5", "coupled"}


@pytest.mark.parametrize("name", all_but(LONG, SYSTEMS))
def test_all_multipliers_are_right_to_1e_8_of_themselves(name: str) -> None:
    system, Omega, eps = SYSTEMS[name]
    found = monodromy(system, Omega, eps)
    true = relative_errors(found.multipliers, certified_monodromy(system, Omega, eps, bits=BITS))
    assert true.max() < 1e-8
    assert found.multiplier_errors.max() < 1e-8
    assert (true <= 3 * found.multiplier_errors + 1e-14).all()


def test_multipliers_printed_in_the_past() -> None:
    """What the eigenvalues of the matrix made -2.0e5 and -4.5e-8 of."""
    for (system, Omega, eps), largest in ((SYSTEMS["strong excitation"], 6.65e19), (SYSTEMS["saddle"], 1.53e8)):
        mu = monodromy(system, Omega, eps).multipliers
        assert mu[0] == pytest.approx(largest, rel=2e-3)
        assert mu[1] == pytest.approx(1 / mu[0], rel=1e-11)  # Liouville


@pytest.mark.parametrize("decay", [2.0, 20.0, 200.0])
def test_constant_coefficients_have_their_exponents(decay: float) -> None:
    system = PeriodicSystem([[1.0]], [[0.0]], [[decay]], [[0.5]], [[[0.0]]])
    found = monodromy(system, 1.0, 0.0)
    slow = 0.5 / (decay / 2 + np.sqrt(decay**2 / 4 - 0.5))
    exact = np.exp(-2 * np.pi * np.array([slow, 0.5 / slow]))
    assert found.multipliers == pytest.approx(exact, rel=1e-8)
    if exact[1] == 0:
        assert found.multiplier_errors[1] == 1.0


def test_near_a_boundary_the_error_says_so() -> None:
    """A double multiplier is known to the square root of rounding."""
    hill = PeriodicSystem([[1.0]], [[0.0]], [[0.0]], [[-0.5]], [[[-1.0]], [[0.5]]])  # solved by exp(-cos t)
    found = monodromy(hill, 1.0, 1.0)
    assert np.abs(found.multipliers - 1).max() <= 3 * found.multiplier_errors.max()
    assert found.multiplier_errors.max() > 1e-9
