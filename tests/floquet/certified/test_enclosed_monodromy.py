"""Certified monodromy matrices against exact solutions, other integrators and conserved quantities."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from periodic import PeriodicSystem
from periodic.checks import FloatArray
from periodic.examples import mathieu
from tests.floquet.certified.certified_oracles import (
    OMEGA,
    contains,
    exact_whittaker_hill,
    largest_radius,
    middle,
    random_system,
    whittaker_hill,
)

flint = pytest.importorskip("flint", reason="python-flint, the extra certify, is not installed")
from flint import arb, arb_mat, ctx  # noqa: E402

from floquet.certified import certified_monodromy, enclosure  # noqa: E402
from floquet.certified.equation import block_matrix  # noqa: E402
from floquet.certified.reading import equation_of  # noqa: E402
from floquet.certified.steps import Plan, Steps  # noqa: E402


@pytest.mark.parametrize("phase", ["cosine", "sine"])
@pytest.mark.parametrize(
    ("kappa", "spin", "decay"), [(0.5, 0.0, 0.0), (0.5, 0.25, 0.0), (-1.25, 0.0, 0.125), (2.0, 3.5, -0.0625)]
)
@pytest.mark.parametrize("bits", [64, 128, 400])
def test_monodromy_contains_exact_solution(kappa: float, spin: float, decay: float, phase: str, bits: int) -> None:
    system = whittaker_hill(kappa, spin, decay, phase)
    found = certified_monodromy(system, OMEGA, 1.0, bits=bits)
    with ctx.workprec(bits + 200):
        exact = exact_whittaker_hill(kappa, spin, decay, phase)
        assert contains(found, exact)
    # e^4 in the step's terms, a dozen operations a term and a few steps cost about 25 bits of the working precision
    assert largest_radius(found) < 2.0 ** (40 - bits) * np.abs(middle(exact)).max()


def test_monodromy_under_congruence_contains_exact_solution() -> None:
    """Mass, and every other matrix, full: W = S^-1 (x, y)."""
    S = np.array([[1.0, 0.5], [-0.25, 2.0]])
    plain = whittaker_hill(0.5, 0.25, 0.125)

    def congruent(a: FloatArray) -> FloatArray:
        return S.T @ a @ S  # exact: all entries are short binary numbers

    M, G, C, K = map(congruent, (plain.mass, plain.gyroscopic, plain.damping, plain.stiffness))
    system = PeriodicSystem(M, G, C, K, congruent(plain.cosine))
    found = certified_monodromy(system, OMEGA, 1.0)
    with ctx.workprec(300):
        to_plain = arb_mat(np.kron(np.eye(2), S).tolist())
        assert contains(found, to_plain.inv() * exact_whittaker_hill(0.5, 0.25, 0.125, "cosine") * to_plain)


@pytest.mark.parametrize("order", [4, 9, 20])
@pytest.mark.parametrize(("kappa", "steps", "radius"), [(0.5, 1, 1.5), (0.5, 3, 4.0), (0.5, 8, 1.5), (2.0**-7, 2, 8.0)])
def test_remainder_bounds_what_low_orders_leave_out(
    monkeypatch: pytest.MonkeyPatch, kappa: float, steps: int, radius: float, order: int
) -> None:
    """In the last case the series of the excitation, not that of the motion, is what is cut."""
    monkeypatch.setattr(enclosure, "plan_of", lambda *_: Plan(steps, order, arb(radius)))
    found = certified_monodromy(whittaker_hill(kappa, 0.25 * kappa), OMEGA, 1.0)
    with ctx.workprec(300):
        exact = exact_whittaker_hill(kappa, 0.25 * kappa, 0.0, "cosine")
        assert contains(found, exact)
        assert not contains(found.mid(), exact)


@pytest.mark.parametrize("order", [5, 20, 60])
def test_remainder_is_sharp(order: int) -> None:
    """For x'' = x the flow of a step h is its own majorant, e^h, and the best radius overestimates by sqrt(2 pi N)."""
    with ctx.workprec(128):
        found = equation_of(mathieu(-1.0), 4.0, 0.0)._replace(B=arb_mat([[1]]), scale=arb(1))
        h = arb.pi() / 2
        step = Steps(found, Fraction(1, 2), Plan(1, order, (order + 1) / h))
        remainder = step._remainder(Fraction(1), arb(1))
        assert remainder is not None
        bound = remainder[0, 0].abs_upper()
        rest = sum((h**k / arb(k).fac() for k in range(order + 1, order + 80)), arb(0))
        assert 1 < float(bound / rest) < 1.3 * np.sqrt(2 * np.pi * order)


@pytest.mark.parametrize("seed", range(4))
def test_constant_coefficients_are_the_matrix_exponential(seed: int) -> None:
    system = random_system(seed, 3)
    found = certified_monodromy(system, 1.3, 0.0)
    with ctx.workprec(300):
        inverse = arb_mat(system.mass.tolist()).inv()
        P = inverse * (arb_mat(system.gyroscopic.tolist()) + arb_mat(system.damping.tolist()))
        Q = inverse * arb_mat(system.stiffness.tolist())
        one, zero = arb_mat(np.eye(3).tolist()), arb_mat(3, 3)
        exact = (block_matrix([[-P, -Q], [one, zero]]) * (2 * arb.pi() / arb(1.3))).exp()
        assert contains(found, exact)


@pytest.mark.parametrize(("seed", "n"), [(0, 1), (1, 2), (2, 4)])
def test_monodromy_agrees_with_dop853(seed: int, n: int) -> None:
    system, Omega, eps = random_system(seed, n), 1.7, 0.6

    def slope(t: float, q: FloatArray) -> FloatArray:
        v, w = q.reshape(2, n, 2 * n)
        K = system.stiffness.copy()
        for j in range(system.harmonics):
            angle = (j + 1) * Omega * t
            K += eps * (np.cos(angle) * system.cosine[j] + np.sin(angle) * system.sine[j])
        force = (system.gyroscopic + system.damping) @ v + K @ w
        return np.concatenate([-np.linalg.solve(system.mass, force), v]).ravel()

    period = 2 * np.pi / Omega
    reference = solve_ivp(slope, (0, period), np.eye(2 * n).ravel(), "DOP853", rtol=1e-12, atol=1e-13).y[:, -1]
    found = middle(certified_monodromy(system, Omega, eps))
    np.testing.assert_allclose(found, reference.reshape(2 * n, 2 * n), atol=1e-9 * np.abs(found).max())


@pytest.mark.parametrize("seed", range(3))
def test_more_bits_stay_within_fewer(seed: int) -> None:
    system = random_system(seed, 3)
    coarse, fine, finest = (certified_monodromy(system, 2.1, -0.7, bits=bits) for bits in (64, 128, 256))
    assert contains(coarse, finest.mid())
    assert contains(fine, finest.mid())
    assert largest_radius(finest) < 1e-30 * largest_radius(fine) < 1e-45 * largest_radius(coarse)


@pytest.mark.parametrize("seed", range(3))
def test_determinant_obeys_liouville(seed: int) -> None:
    system = random_system(seed, 3)
    determinant = certified_monodromy(system, 0.9, 0.8).det()
    with ctx.workprec(300):
        trace = (arb_mat(system.mass.tolist()).inv() * arb_mat(system.damping.tolist())).trace()
        assert determinant.contains((-trace * 2 * arb.pi() / arb(0.9)).exp())


@pytest.mark.parametrize("seed", range(3))
def test_conservative_monodromy_is_symplectic(seed: int) -> None:
    """W'^T M Z - W^T M Z' - W^T G Z is the same for ever, for any two motions."""
    system = random_system(seed, 3, conservative=True)
    Phi = certified_monodromy(system, 1.1, 0.4)
    J = arb_mat(np.block([[np.zeros((3, 3)), system.mass], [-system.mass, -system.gyroscopic]]).tolist())
    with ctx.workprec(128):
        assert contains(Phi.transpose() * J * Phi, J)
