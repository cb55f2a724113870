"""Modes followed through a column: crossings, locks and damping, and edges between two amplitudes."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import mathieu_a, mathieu_b

from floquet import monodromy
from floquet.engine import Sampler, Workspace, log2_steps, spectra, subsystems
from floquet.regions.tracking import (
    LogMultipliers,
    edge_between,
    log_multipliers,
    log_multipliers_general,
    log_multipliers_symplectic,
    pair_test_function,
    strongest_pair,
    track_modes,
)
from periodic.examples import mathieu

EPS = np.linspace(0.0, 1.0, 49)


def shuffled(angle: np.ndarray, modulus: np.ndarray, half_difference: np.ndarray) -> LogMultipliers:
    """Exponents of known modes as a column finds them: in any order, angles folded to [0, pi]."""
    rng = np.random.default_rng(3)
    order = np.array([rng.permutation(angle.shape[1]) for _ in angle])
    folded = np.abs((angle + np.pi) % (2 * np.pi) - np.pi)
    return LogMultipliers(*(np.take_along_axis(part, order, axis=1) for part in (folded, modulus, half_difference)))


def coupled_by(k: np.ndarray, d1: float, d2: float, s: float) -> LogMultipliers:
    """Exponents i + lambda of [[-d1 + i s, k], [k, -d2 - i s]]: unstable from k^2 = d1 d2 (1 + (2 s / (d1 + d2))^2)."""
    root = np.sqrt(((d2 - d1) / 2 + 1j * s) ** 2 + k**2)
    pair = -(d1 + d2) / 2 + np.column_stack([root, -root])
    return LogMultipliers(1.0 + pair.imag, pair.real.copy(), np.zeros((len(k), 2)))


@pytest.mark.kernel
def test_modes_that_cross_are_told_apart() -> None:
    angle = np.array([5.0, 7.3, 31.0, 12.0]) + EPS[:, None] ** 2 * [2.0, -1.5, 0.4, 3.0]
    zero = np.zeros_like(angle)
    found = track_modes(shuffled(angle, zero, zero), EPS, 1j * angle[0], True)
    np.testing.assert_allclose(found.angle, angle, atol=1e-12)


@pytest.mark.kernel
def test_shifts_begin_with_the_square_of_eps() -> None:
    # the first shift, four times as large at the second amplitude, overtakes a mode at rest
    angle = np.array([1.0, 1.0 + 2.5 * 50 * EPS[1] ** 2]) + 50 * EPS[:, None] ** 2 * [1.0, 0.0]
    zero = np.zeros_like(angle)
    found = track_modes(shuffled(angle, zero, zero), EPS, 1j * angle[0], True)
    np.testing.assert_allclose(found.angle, angle, atol=1e-12)


@pytest.mark.kernel
def test_two_modes_that_lock_are_told_apart_afterwards() -> None:
    # collision of opposite signatures: angles 1 + x and 3 - x at x = 1 ± kappa, unstable between
    kappa, x = 0.1, 2 * EPS**2 - 0.03
    off = np.sqrt(((x - 1) ** 2 - kappa**2).astype(complex))
    apart, growth = np.where(x < 1, -off.real, off.real), off.imag
    # the second one has the angle of its mirror image: sums of angles count
    angle = np.column_stack([2 + apart, 2 * np.pi - 2 + apart])
    modulus = np.column_stack([growth, -growth])
    found = track_modes(shuffled(angle, modulus, np.zeros_like(angle)), EPS, 1j * angle[0], True)
    f = pair_test_function(found, 0, 1, 1, 1, True)
    np.testing.assert_allclose(f, kappa**2 - (x - 1) ** 2, atol=1e-12)
    free = np.abs(x - 1) > kappa
    np.testing.assert_allclose(found.angle[free], angle[free], atol=1e-12)


@pytest.mark.kernel
@pytest.mark.parametrize("conservative", [True, False])
def test_instability_by_another_number_says_nothing(conservative: bool) -> None:
    # two modes grow together where their angles sum up to 4 pi: by j = 2; and one at 3 pi, by 2 omega_1 = 3 Omega
    angle, growth, zero = np.array([[5.0, 4 * np.pi - 5.0]]), np.array([[0.1, -0.1]]), np.zeros((1, 2))
    pair = LogMultipliers(angle, growth - (not conservative) * 0.01, zero)
    assert pair_test_function(pair, 1, 0, 2, 1, conservative) > 0
    assert np.isnan(pair_test_function(pair, 1, 0, 1, 1, conservative))
    single = LogMultipliers(np.array([[3 * np.pi, 1.0]]), zero, np.array([[0.1, 0.0]]))
    assert pair_test_function(single, 0, 0, 3, 1, conservative) == pytest.approx(0.01)
    assert np.isnan(pair_test_function(single, 0, 0, 5, 1, conservative))


@pytest.mark.kernel
def test_damped_modes_cross_by_their_decay() -> None:
    angle = np.array([4.0, 4.5]) + EPS[:, None] ** 2 * [1.0, 0.0]
    modulus = np.zeros_like(angle) - [0.1, 0.9]
    # no more than rounding: angle and modulus are noise
    noise = np.random.default_rng(1).uniform(0, np.pi, (len(EPS), 1))
    dead = -8.5 - 20 * noise
    found = track_modes(
        shuffled(np.hstack([angle, noise]), np.hstack([modulus, dead]), np.zeros((len(EPS), 3))),
        EPS,
        np.array([-0.1 + 4.0j, -0.9 + 4.5j, -30 + 1j]),
        False,
    )
    assert found.modulus[:, 2] == pytest.approx(-30.0)  # left as it starts
    np.testing.assert_allclose(found.angle[:, :2], angle, atol=1e-12)
    np.testing.assert_allclose(found.modulus[:, :2], modulus, atol=1e-12)


@pytest.mark.kernel
def test_multipliers_become_modes() -> None:
    mu = np.array([[0.5 + 0.5j, 0.5 - 0.5j, 2.0, 0.4], [-3.0, -0.3, -0.9, -0.8]], complex)
    found = log_multipliers_general(mu, np.zeros(2))
    assert sorted(found.angle[0]) == pytest.approx([0.0, np.pi / 4])
    np.testing.assert_allclose(found.angle[1], np.pi)
    assert sorted(found.half_difference[0]) == pytest.approx([0.0, np.log(2.0 / 0.4) / 2])
    # the two largest belong together
    assert found.modulus[1] == pytest.approx([np.log(3.0 * 0.9) / 2, np.log(0.8 * 0.3) / 2])
    s = np.array([[2 * np.cos(1.0), 2 * np.cosh(0.3)]], complex)
    symplectic = log_multipliers_symplectic(s, np.zeros(1))
    np.testing.assert_allclose(symplectic.angle, [[1.0, 0.0]], atol=1e-12)
    np.testing.assert_allclose(symplectic.half_difference, [[0.0, 0.3]], atol=1e-12)
    # a quadruple: one mode grows, the other decays
    quadruple = log_multipliers_symplectic(2 * np.cosh([[0.1 + 1j, 0.1 - 1j]]), np.zeros(1))
    np.testing.assert_allclose(quadruple.angle, 1.0, atol=1e-12)
    np.testing.assert_allclose(quadruple.modulus, [[0.1, -0.1]], atol=1e-12)


def test_the_test_function_of_two_damped_modes_is_analytic() -> None:
    d1, d2, s, k = 0.1, 0.4, 0.05, np.linspace(0, 0.5, 21)
    found = coupled_by(k, d1, d2, s)
    found.angle[:, 0] += 2 * np.pi
    f = pair_test_function(found, 0, 1, 1, -1, False)
    np.testing.assert_allclose(f, k**2 - d1 * d2 * (1 + (2 * s / (d1 + d2)) ** 2), atol=1e-12)


def test_the_test_function_is_unknown_where_a_mode_is_unstable_with_another() -> None:
    zero = np.zeros((1, 2))
    angle, one = np.array([[2.0, 2 * np.pi - 2.0]]), np.array([[0.3, 0.0]])
    assert pair_test_function(LogMultipliers(angle, zero, zero), 0, 1, 1, 1, True) == pytest.approx([0.0])
    for modulus, real in ((one, zero), (zero, one)):
        assert np.isnan(pair_test_function(LogMultipliers(angle, modulus, real), 0, 1, 1, 1, True)).all()
    assert np.isnan(pair_test_function(LogMultipliers(angle, one, zero), 0, 0, 1, 1, True)).all()
    assert (
        pair_test_function(LogMultipliers(angle, one, zero), 0, 0, 1, 1, False) < 0
    )  # damped, it has left the circle anyway


@pytest.mark.kernel
def test_an_edge_may_be_met_exactly() -> None:
    eps, angle = np.array([0.1, 0.2, 0.3]), np.full((3, 1), np.pi)
    found = LogMultipliers(angle, np.zeros((3, 1)), np.array([[0.0], [0.2], [0.25]]))
    assert edge_between(found, eps, 0, 1, 2, True) == (0.1, 0.0)


@pytest.mark.parametrize("damping", [0.0, 0.05])
def test_an_edge_between_two_amplitudes(damping: float) -> None:
    system, Omega, eps = mathieu(damping=damping), 1.8, np.linspace(0, 1, 33)
    (subsystem,) = subsystems(system)
    sampler = Sampler.of(subsystem, Omega, Workspace())
    found = log_multipliers(spectra(sampler, eps, log2_steps(subsystem, Omega, eps, 64.0), 1e-11))
    inside = int(np.flatnonzero((found.modulus + found.half_difference).max(axis=1) > 1e-9)[0])
    low, uncertainty = edge_between(found, eps, inside - 1, inside, inside + 1, subsystem.symplectic)
    if damping == 0:
        exact = min(
            brentq(lambda e, side=side: 4 / Omega**2 - side(1, 2 * e / Omega**2), 0.1, 1.0)
            for side in (mathieu_a, mathieu_b)
            if (4 / Omega**2 - side(1, 0.2 / Omega**2)) * (4 / Omega**2 - side(1, 2 / Omega**2)) < 0
        )
    else:  # x = y exp(-damping t): y grows like exp(damping t) at the edge, found by integration
        exact = brentq(lambda e: monodromy(system, Omega, e).growth_rate, eps[inside - 1], eps[inside], xtol=1e-10)
    # a parabola through amplitudes 1/32 apart
    assert low == pytest.approx(exact, abs=1e-4)
    straight, _ = edge_between(found, eps, inside - 1, inside, inside, subsystem.symplectic)
    assert straight == pytest.approx(exact, abs=3e-3)
    assert uncertainty == pytest.approx(abs(low - straight), rel=1e-6)


@pytest.mark.kernel
def test_the_edge_of_two_modes_of_unequal_damping_is_exact_where_f_is_a_parabola() -> None:
    d1, d2, s, eps = 0.1, 0.4, 0.05, np.linspace(0, 0.5, 21)
    found = coupled_by(eps, d1, d2, s)
    inside = int(np.flatnonzero(found.modulus.max(axis=1) > 0)[0])
    exact = np.sqrt(d1 * d2 * (1 + (2 * s / (d1 + d2)) ** 2))
    assert edge_between(found, eps, inside - 1, inside, inside + 1, False)[0] == pytest.approx(exact, abs=1e-9)


@pytest.mark.kernel
def test_the_most_unstable_pair_leads() -> None:
    angle = np.array([[0.7, 2.0, 2.0], [np.pi, 2.0, 2.0], [0.0, 1.0, 2.0]])
    modulus = np.array([[-0.01, 0.09, -0.11], [-0.01, -0.01, -0.01], [-0.01, 0.02, -0.04]])
    half_difference = np.array([[0.0, 0.0, 0.0], [0.3, 0.0, 0.0], [0.1, 0.0, 0.0]])
    f, mark = strongest_pair(LogMultipliers(angle, modulus, half_difference))
    for c, (p, q) in enumerate([(2, 1), (0, 0), (0, 0)]):
        j, sign = (0, -1) if p != q else (c % 2, 1)
        found = LogMultipliers(*(part[c] for part in (angle, modulus, half_difference)))
        assert f[c] == pytest.approx(pair_test_function(found, p, q, j, sign, False))
    # real multipliers, positive or negative, are told from a pair at any angle
    assert mark[0] == 2.0
    assert np.abs(np.diff(mark)).min() > 3
    assert mark[1:].min() > np.pi
