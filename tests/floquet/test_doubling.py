"""Steps, interpolation and doubling of the chart engine against expm, Bessel functions and plain products."""

from __future__ import annotations

import math

import numpy as np
import pytest
import scipy.linalg as sla
from hypothesis import given, settings
from hypothesis import strategies as st
from oracle_systems import random_system
from scipy.special import iv

import floquet.sampling
from floquet import monodromy
from floquet.coordinates import blocks, equations
from floquet.doubling import TOLERANCE, doublings, schedule, unit_scale
from floquet.interpolation import chebyshev_points, chebyshev_weights, degree, trigonometric_weights
from floquet.kernels import exponential, single_steps
from floquet.sampling import Sampler, Workspace
from periodic.examples import mathieu

some = settings(max_examples=20, deadline=None)


def steps(block, Omega, eps, N, phases=None):
    """The single steps of a block at ``phases`` (default: all N) phases, and amplitude ``eps``."""
    free = equations(block, 0.01)
    size = len(free.A)
    P = np.empty((phases or N, 1, size, size))
    single_steps(free.A, block.Fc, block.Fs, free.left, free.right, 2 * np.pi / Omega / N, np.array([eps]), P)
    return P[:, 0]


def ordered(factors):
    """Product of matrices, the first one first in time, thus rightmost."""
    total = np.eye(factors.shape[-1])
    for factor in factors:
        total = factor @ total
    return total


def sampled(block, Omega, eps, L, tolerance=TOLERANCE):
    """Monodromy matrices of a block at ``eps`` from the panels of a `Sampler`."""
    sampler = Sampler(block, equations(block, 0.01), Omega, Workspace())
    return sampler.matrices(np.asarray(eps), L, tolerance)


# ---- the single step ----


@pytest.mark.kernel
@pytest.mark.parametrize("size", [0.0, 0.1, 3.0, 50.0])
def test_exponential(size):
    A = np.random.default_rng(0).standard_normal((4, 4))
    A = size * (A - A.T) / 4  # skew: well-conditioned for every size
    assert exponential(A) == pytest.approx(sla.expm(A), abs=1e-14 * (1 + size))


@pytest.mark.kernel
def test_a_step_without_excitation_is_exact():
    block = blocks(random_system(1, 3, damping=0.3))[0]
    step = steps(block, 2.0, 0.0, 8, 1)[0]
    assert step == pytest.approx(sla.expm(equations(block, 0.01).A * 2 * np.pi / 2.0 / 8), abs=1e-13)


def test_steps_keep_the_volume_of_liouville():
    # det of a kick is 1, so that det P = exp(-h tr C) for every step
    block = blocks(random_system(2, 3, 2, damping=0.5))[0]
    expected = math.exp(-np.trace(block.C) * 2 * np.pi / 1.3 / 16)
    for step in steps(block, 1.3, 0.8, 16):
        assert np.linalg.det(step) == pytest.approx(expected, rel=1e-13)


def test_steps_are_symplectic():
    block = blocks(random_system(3, 4, 2))[0]
    assert block.symplectic
    b = len(block.K)
    J = np.block([[np.zeros((b, b)), np.eye(b)], [-np.eye(b), np.zeros((b, b))]])
    for step in steps(block, 1.3, 0.8, 16):
        assert step.T @ J @ step == pytest.approx(J, abs=1e-13 * np.linalg.norm(step) ** 2)


def trace_error(system, Omega, eps, N):
    """Error of the sum of the multipliers; smooth in h and eps also where multipliers coalesce."""
    block = blocks(system)[0]
    return abs(np.trace(ordered(steps(block, Omega, eps, N))) - np.trace(monodromy(system, Omega, eps).matrix))


@pytest.mark.parametrize("seed", [11, 12])
def test_fourth_order_in_the_step(seed):
    system = random_system(seed, 2, 2, damping=0.1)
    N = np.array([64, 128, 256])
    errors = [trace_error(system, 1.1, 0.7, n) for n in N]
    slopes = -np.diff(np.log2(errors))
    assert slopes == pytest.approx(4, abs=0.1)


def test_second_order_in_the_amplitude():
    system = random_system(11, 2, 2, damping=0.1)
    eps = np.array([0.02, 0.04, 0.08])
    slopes = np.diff(np.log2([trace_error(system, 1.1, e, 16) for e in eps]))
    assert slopes == pytest.approx(2, abs=0.15)


# ---- interpolation ----


@pytest.mark.parametrize("x", [1e-4, 0.1, 1.0, 7.0])
def test_degree_bounds_the_coefficients(x):
    # the Fourier coefficients of exp(x cos z) are the Bessel functions I_q(x)
    for tolerance in (1e-6, 1e-12):
        q = degree((x,), tolerance)
        assert 2 * iv(q + 1, x) < tolerance
        # and not many more than needed
        assert 2 * iv(q - 2, x) > tolerance or q <= 3


def test_degree_of_several_harmonics():
    x = (0.5, 0.3, 0.2)
    z = 2 * np.pi * np.arange(256) / 256
    coefficients = np.abs(np.fft.rfft(np.exp(sum(a * np.cos((j + 1) * z) for j, a in enumerate(x))))) / 128
    q = degree(x, 1e-10)
    assert coefficients[q + 1 : 100].max() < 1e-10
    assert q < 3 * degree((1.0,), 1e-10)


@pytest.mark.parametrize("m", [1, 2, 7])
def test_chebyshev_weights_reproduce_polynomials(m):
    x = np.linspace(-1, 1, 5)
    for power in range(m):
        assert chebyshev_weights(m, x) @ chebyshev_points(m) ** power == pytest.approx(x**power, abs=1e-14)


@pytest.mark.parametrize("p", [1, 3, 9, 501])
def test_trigonometric_weights_reproduce_harmonics(p):
    grid, theta = 2 * np.pi * np.arange(p) / p, np.array([0.0, 0.1, 2.0, 2 * np.pi / p])
    for q in {*range(min(p // 2 + 1, 9)), p // 2}:
        for wave in (np.cos, np.sin):
            assert trigonometric_weights(p, theta) @ wave(q * grid) == pytest.approx(wave(q * theta), abs=1e-12)


# ---- doubling ----


@some
@given(st.integers(0, 10**6), st.integers(1, 3), st.integers(1, 4), st.booleans(), st.floats(0.5, 6.0))
def test_doubling_is_the_ordered_product(seed, n, harmonics, damped, Omega):
    system = random_system(seed, n, harmonics, damping=0.2 * damped)
    eps, L = np.linspace(-0.4, 1.0, 40), 7
    for block in blocks(system):
        found = sampled(block, Omega, eps, L)
        for i in (0, 11, 39):
            expected = ordered(steps(block, Omega, eps[i], 2**L))
            # 2^L roundings, magnified by the growth that panels are allowed, and the interpolation
            assert np.linalg.norm(found[i] - expected) < 1e-10 * np.linalg.norm(expected)


@pytest.mark.kernel
def test_doubling_a_single_phase():
    # constant coefficients: one phase, one amplitude, repeated squaring
    plan = schedule(3, (0.0,), 0.0, TOLERANCE, 3)
    assert plan.phases.tolist() == [1, 1, 1, 1]
    P = sla.expm([[0.0, 0.1], [-0.1, 0.0]])
    work = (np.empty(4), np.empty(4), np.empty(12))
    found = doublings(P[None, None], plan.phases, plan.nodes, plan.weights, plan.present, unit_scale(1), work)
    assert found[0, 0] == pytest.approx(np.linalg.matrix_power(P, 8), abs=1e-15)


@pytest.mark.parametrize("entries", [2**22, 300])
def test_little_memory_changes_nothing(monkeypatch, entries):
    # with room for a few matrices only, cells are done one by one, and the end of the period factor by factor
    block = blocks(mathieu(1.0, 0.01))[0]
    eps = np.linspace(0.0, 3.0, 5)
    monkeypatch.setattr(floquet.sampling, "MOST_ENTRIES", entries)
    found = sampled(block, 0.1, eps, 10)
    expected = [ordered(steps(block, 0.1, e, 2**10)) for e in eps]
    for one, other in zip(found, expected, strict=True):
        assert np.linalg.norm(one - other) < 1e-11 * np.linalg.norm(other)


def test_growth_beyond_the_largest_float():
    # a saddle: log|mu| = sqrt(k) T = 2000 pi, hundreds of decimal orders more than a float holds
    block = blocks(mathieu(-1.0))[0]
    (panel,) = Sampler(block, equations(block, 0.01), 1e-3, Workspace()).panels(np.array([0.0]), 16, TOLERANCE)
    mu = np.abs(np.linalg.eigvals(panel.samples[0])).max()
    assert np.log(mu) + panel.scale.exponents[0] * math.log(2) == pytest.approx(2000 * math.pi, rel=1e-10)


def test_cancellation_is_noted():
    # rotations lose nothing; growth in one half of the period against decay in the other does
    turn = sla.expm([[0.0, 0.3], [-0.3, 0.0]])
    saddle = np.diag([1e4, 1e-4])
    present, one = np.zeros((1, 3), bool), np.array([2, 1])
    work = (np.empty(8), np.empty(8), np.empty(8))
    losses = []
    for first, second in ((turn, turn), (saddle, np.linalg.inv(saddle))):
        scale = unit_scale(1)
        doublings(np.array([first, second])[:, None], one, one, np.empty(0), present, scale, work)
        losses.append(scale.losses[0])
    assert losses[0] == pytest.approx(1, rel=1e-14)
    assert losses[1] == pytest.approx(1e8 / 2, rel=1e-6)
