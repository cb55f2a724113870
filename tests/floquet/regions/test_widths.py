"""Estimated widths of resonances: exact to lowest order, and closed by damping."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import mathieu_a, mathieu_b

from floquet import trace_boundary
from periodic import PeriodicSystem
from periodic.examples import coupled_mathieu, mathieu
from tests.floquet.regions.resonating import resonances_of, tongues_expected


def width_of_mathieu(order: int, eps: float) -> float:
    """Width of the n-th region of x'' + (1 + eps cos Omega t) x = 0: a = 4/Omega^2 is a_n(q) or b_n(q), q = 2
    eps/Omega^2 (DLMF 28.2(v))."""
    a, b = (
        brentq(
            lambda Omega, edge=edge: 4 / Omega**2 - edge(order, 2 * eps / Omega**2),
            1.9 / order,
            2.1 / order,
            xtol=1e-15,
        )
        for edge in (mathieu_a, mathieu_b)
    )
    return abs(a - b)


@pytest.mark.parametrize("order", [1, 2, 3, 4])
def test_widths_of_mathieu_tongues(order: int) -> None:
    # the next term is smaller by eps^2, with a factor that grows with the order
    for eps in (0.05, 0.1):
        found = {one.resonance.j: one for one in tongues_expected(mathieu(), eps, 0.2, 3.0)}
        assert found[order].width == pytest.approx(width_of_mathieu(order, eps), rel=order**2 * eps**2)
        widths = [one.width for one in found.values()]
        assert widths == sorted(widths, reverse=True)


@pytest.mark.parametrize("kind", ["sum", "difference"])
def test_width_of_a_combination_resonance(kind: str) -> None:
    omega = np.array([1.0, 1.7])
    centre = omega[1] + (omega[0] if kind == "sum" else -omega[0])
    system = coupled_mathieu(kind, omega)
    window = 0.99 * centre, 1.01 * centre
    (one,) = tongues_expected(system, 0.01, *window, resonances_of(system, *window)[:1])
    # Omega = centre ± eps sqrt(L), L = 1 / (4 omega_1 omega_2); the next order in eps is left out at eps = 0.01
    assert one.width == pytest.approx(0.01 / np.sqrt(omega.prod()), rel=1e-3)
    assert (one.p, one.q) == (1, 0)


def test_a_second_harmonic_opens_the_second_tongue_to_first_order() -> None:
    one = np.eye(1)
    system = PeriodicSystem(one, 0 * one, 0 * one, one, cosine=[0 * one, one])
    (tongue,) = [one for one in tongues_expected(system, 0.01, 0.9, 1.1) if one.resonance.j == 2]
    # x'' + (1 + eps cos 2 Omega t) x = 0 is Mathieu's equation at 2 Omega = 2 ± eps / 2
    assert tongue.width == pytest.approx(0.01 / 2, rel=1e-3)


def test_a_tongue_without_a_coupling_of_its_lowest_order() -> None:
    # from mode 1 to mode 2 by the first harmonic and back by the second: 2 omega_1 opens like eps^2, nothing directly
    zero, swap = np.zeros((2, 2)), np.array([[0.0, 1.0], [1.0, 0.0]])
    system = PeriodicSystem(np.eye(2), zero, zero, np.diag([1.0, 1.7**2]), cosine=[swap, 0.5 * swap])
    eps = 0.02
    (one,) = tongues_expected(system, eps, 1.99, 2.01)
    region = trace_boundary(system, near=2.0, eps=[eps])
    assert one.width == pytest.approx(float(region.upper[0] - region.lower[0]), rel=0.02)


@pytest.mark.parametrize("sense", [1, -1])
def test_a_rotating_stiffness_meets_the_mode_that_whirls_along(sense: int) -> None:
    # z'' + i g z' + z + eps exp(i Omega t) conj(z) = 0: the slow mode, forward, has Omega = 2 omega ± 2 eps / (2 omega
    # + g); the fast one, backward, would need Omega < 0. If the stiffness turns backward it is the other way round.
    zero, g, eps = np.zeros((2, 2)), 0.8, 0.01
    along, across = np.diag([1.0, -1.0]), np.array([[0.0, 1.0], [1.0, 0.0]])
    system = PeriodicSystem(np.eye(2), g * np.array([[0, -1], [1, 0]]), zero, np.eye(2), [along], [sense * across])
    found = tongues_expected(system, eps, 0.5, 4.0)
    widths = {one.p: one.width for one in found if one.p == one.q and one.resonance.j == 1 and one.width > 1e-9}
    assert widths == pytest.approx({0 if sense > 0 else 1: 4 * eps / np.sqrt(g**2 + 4)}, rel=1e-3)


def test_damping_closes_narrow_resonances() -> None:
    # the tongue of order n of the damped equation is closed while its largest growth is below the damping
    window = 0.2, 3.0
    some = resonances_of(mathieu(), *window)
    open_ = {one.resonance.j for one in tongues_expected(mathieu(damping=0.01), 0.1, *window, some)}
    assert open_ == {1}
    assert tongues_expected(mathieu(damping=0.5), 0.1, *window, some) == []
    assert tongues_expected(mathieu(), 0.1, *window, []) == []
    # growth eps / 4 = 0.025 against decay damping / 2: what is closed by less than a factor of two is looked for
    assert [one.resonance.j for one in tongues_expected(mathieu(damping=0.08), 0.1, *window, some)] == [1]
    assert tongues_expected(mathieu(damping=0.12), 0.1, *window, some) == []


@pytest.mark.parametrize(("stiffness", "damping"), [(1.0, 2.0), (0.0, 0.0)])
def test_a_third_mode_with_a_single_eigenvector(stiffness: float, damping: float) -> None:
    # critically damped, or free: its two exponents coincide, and so do their eigenvectors
    zero, F = np.zeros((2, 2)), [[0.3, 1.0], [1.0, 0.5]]

    def widths(more: float) -> dict[int, float]:
        system = PeriodicSystem(np.eye(2), zero, np.diag([damping + more, 0.0]), np.diag([stiffness, 4.0]), [F])
        return {one.resonance.j: one.width for one in tongues_expected(system, 0.3, 1.3, 5.0)}

    assert widths(0.0)[1] == pytest.approx(0.3 / 4, rel=1e-2)  # Mathieu's, to first order: eps F_22 / omega
    if damping > 0:  # for a free mode the even tongues are those of three states
        assert widths(0.0) == pytest.approx(widths(1e-3), rel=1e-2)


def test_modes_without_damping_in_a_damped_block_are_undamped() -> None:
    # their exponents have rounding for a decay: of one mode sometimes much more than of the other
    zero, F = np.zeros((5, 5)), np.full((5, 5), 0.1)
    F[1, 2] = F[2, 1] = 1.0
    for seed in range(60):
        turn = np.linalg.qr(np.random.default_rng(seed).standard_normal((5, 5)))[0]
        C, K, F_turned = (
            turn @ A @ turn.T for A in (np.diag([0.4, 0, 0, 0, 0]), np.diag([2.0, 4.0, 9.0, 15.0, 22.0]), F)
        )
        system = PeriodicSystem(np.eye(5), zero, C, K, [F_turned])
        (one,) = [one for one in tongues_expected(system, 0.05, 4.9, 5.1) if one.resonance.j == 1]
        assert one.balance == 1.0
        assert one.width == pytest.approx(0.05 / np.sqrt(6), rel=0.01)  # eps F_23 / sqrt(omega_2 omega_3)


def test_unequal_damping_makes_a_combination_resonance_wider() -> None:
    damping = (0.002, 0.018)
    system = coupled_mathieu("sum", damping=damping)
    (one,) = tongues_expected(system, 0.1, 2.6, 2.8, resonances_of(system, 2.6, 2.8)[:1])
    # Bolotin 1964: as both go to zero at a fixed ratio, the width stays this many times the undamped one
    factor = sum(damping) / (2 * np.sqrt(np.prod(damping)))
    assert one.balance == pytest.approx(1 / factor, rel=1e-3)
    assert one.width == pytest.approx(factor * 0.1 / np.sqrt(1.7), rel=0.01)  # the next order is eps^2
    undamped = coupled_mathieu("sum")
    assert tongues_expected(undamped, 0.1, 2.6, 2.8, resonances_of(undamped, 2.6, 2.8)[:1])[0].balance == 1
