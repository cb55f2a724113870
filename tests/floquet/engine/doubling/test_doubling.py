"""Steps, interpolation and doubling of the chart engine against expm, Bessel functions and plain products."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
import pytest
import scipy.linalg as sla
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import ArrayLike, NDArray
from scipy.special import iv

import floquet.engine.doubling.sampling
from floquet import monodromy
from floquet.engine import Sampler, Subsystem, Workspace, equations, subsystems
from floquet.engine.column import ROUNDINGS_PER_STEP
from floquet.engine.doubling.doubling import doublings, unit_scale
from floquet.engine.doubling.interpolation import chebyshev_points, chebyshev_weights, degree, trigonometric_weights
from floquet.engine.doubling.schedule import INTERPOLATION_TOLERANCE, Schedule, growth_bounds, schedule
from floquet.engine.doubling.step import exponential, forcing_on_grid, grid_steps, single_steps
from periodic import PeriodicSystem
from periodic.checks import FloatArray
from periodic.examples import mathieu
from tests.floquet.oracle_systems import random_system

some = settings(max_examples=20, deadline=None)


def steps(subsystem: Subsystem, Omega: float, eps: float, N: int, phases: int | None = None) -> FloatArray:
    """The single steps of a subsystem at ``phases`` (default: all N) phases, and amplitude ``eps``."""
    free = equations(subsystem, 0.01)
    size = len(free.A)
    theta = 2 * np.pi * np.arange(phases or N) / (phases or N)
    P = np.empty((len(theta), size, size))
    h = 2 * np.pi / Omega / N
    single_steps(free.A, subsystem.Fc, subsystem.Fs, free.left, free.right, h, theta, np.full(len(theta), eps), P)
    return P


def ordered(factors: FloatArray) -> FloatArray:
    """Product of matrices, the first one first in time, thus rightmost."""
    total = np.eye(factors.shape[-1])
    for factor in factors:
        total = factor @ total
    return total


def sampled(
    subsystem: Subsystem, Omega: float, eps: ArrayLike, L: int, tolerance: float = INTERPOLATION_TOLERANCE
) -> FloatArray:
    """Monodromy matrices of a subsystem at ``eps`` from the pieces of a `Sampler`."""
    sampler = Sampler(subsystem, equations(subsystem, 0.01), Omega, Workspace())
    return sampler.matrices(np.asarray(eps), L, tolerance)


def many_harmonics(J: int, n: int = 1) -> PeriodicSystem:
    """A damped system with J harmonics, cosines and sines, that fall like 1 / j."""
    rng = np.random.default_rng(J)
    cosine, sine = rng.standard_normal((2, J, n, n)) / np.arange(1, J + 1)[:, None, None]
    return PeriodicSystem(
        np.eye(n), damping=0.02 * np.eye(n), stiffness=np.diag(1.0 + np.arange(n)), cosine=cosine, sine=sine
    )


# ---- the single step ----


@pytest.mark.kernel
@pytest.mark.parametrize("size", [0.0, 0.1, 3.0, 50.0])
def test_exponential(size: float) -> None:
    A = np.random.default_rng(0).standard_normal((4, 4))
    A = size * (A - A.T) / 4  # skew: well-conditioned for every size
    assert exponential(A) == pytest.approx(sla.expm(A), abs=1e-14 * (1 + size))


@pytest.mark.kernel
def test_a_step_without_excitation_is_exact() -> None:
    subsystem = subsystems(random_system(1, 3, damping=0.3))[0]
    step = steps(subsystem, 2.0, 0.0, 8, 1)[0]
    assert step == pytest.approx(sla.expm(equations(subsystem, 0.01).A * 2 * np.pi / 2.0 / 8), abs=1e-13)


def test_steps_keep_the_volume_of_liouville() -> None:
    # det of a kick is 1, so that det P = exp(-h tr C) for every step
    subsystem = subsystems(random_system(2, 3, 2, damping=0.5))[0]
    expected = math.exp(-np.trace(subsystem.C) * 2 * np.pi / 1.3 / 16)
    for step in steps(subsystem, 1.3, 0.8, 16):
        assert np.linalg.det(step) == pytest.approx(expected, rel=1e-13)


def test_steps_are_symplectic() -> None:
    subsystem = subsystems(random_system(3, 4, 2))[0]
    assert subsystem.symplectic
    b = len(subsystem.K)
    J = np.block([[np.zeros((b, b)), np.eye(b)], [-np.eye(b), np.zeros((b, b))]])
    for step in steps(subsystem, 1.3, 0.8, 16):
        assert step.T @ J @ step == pytest.approx(J, abs=1e-13 * float(np.linalg.norm(step)) ** 2)


def trace_error(system: PeriodicSystem, Omega: float, eps: float, N: int) -> float:
    """Error of the sum of the multipliers; smooth in h and eps also where multipliers coalesce."""
    subsystem = subsystems(system)[0]
    return abs(np.trace(ordered(steps(subsystem, Omega, eps, N))) - np.trace(monodromy(system, Omega, eps).matrix))


@pytest.mark.parametrize("seed", [11, 12])
def test_fourth_order_in_the_step(seed: int) -> None:
    system = random_system(seed, 2, 2, damping=0.1)
    N = np.array([64, 128, 256])
    errors = [trace_error(system, 1.1, 0.7, n) for n in N]
    slopes = -np.diff(np.log2(errors))
    assert slopes == pytest.approx(4, abs=0.1)


def test_second_order_in_the_amplitude() -> None:
    system = random_system(11, 2, 2, damping=0.1)
    eps = np.array([0.02, 0.04, 0.08])
    slopes = np.diff(np.log2([trace_error(system, 1.1, e, 16) for e in eps]))
    assert slopes == pytest.approx(2, abs=0.15)


# ---- interpolation ----


@pytest.mark.parametrize("x", [1e-4, 0.1, 1.0, 7.0])
def test_degree_bounds_the_coefficients(x: float) -> None:
    # the Fourier coefficients of exp(x cos z) are the Bessel functions I_q(x)
    for tolerance in (1e-6, 1e-12):
        q = degree((x,), tolerance)
        assert 2 * iv(q + 1, x) < tolerance
        # and not many more than needed
        assert 2 * iv(q - 2, x) > tolerance or q <= 3


def test_degree_of_several_harmonics() -> None:
    x = (0.5, 0.3, 0.2)
    z = 2 * np.pi * np.arange(256) / 256
    coefficients = np.abs(np.fft.rfft(np.exp(sum(a * np.cos((j + 1) * z) for j, a in enumerate(x))))) / 128
    q = degree(x, 1e-10)
    assert coefficients[q + 1 : 100].max() < 1e-10
    assert q < 3 * degree((1.0,), 1e-10)


@pytest.mark.parametrize("m", [1, 2, 7])
def test_chebyshev_weights_reproduce_polynomials(m: int) -> None:
    x = np.linspace(-1, 1, 5)
    for power in range(m):
        assert chebyshev_weights(m, x) @ chebyshev_points(m) ** power == pytest.approx(x**power, abs=1e-14)


@pytest.mark.parametrize("p", [1, 3, 9, 501])
def test_trigonometric_weights_reproduce_harmonics(p: int) -> None:
    grid, theta = 2 * np.pi * np.arange(p) / p, np.array([0.0, 0.1, 2.0, 2 * np.pi / p])
    for q in {*range(min(p // 2 + 1, 9)), p // 2}:
        for wave in (np.cos, np.sin):
            assert trigonometric_weights(p, theta) @ wave(q * grid) == pytest.approx(wave(q * theta), abs=1e-12)


# ---- where to sample ----

CHARTS = [
    ((2.0,), 0.0),
    ((0.03,), 0.0),
    ((2.5,), -1.0),
    ((0.4,), 0.9),
    ((30.0,), 0.0),
    ((0.0, 1.5), 0.0),
    ((1.0, 0.5), 0),
]
NODES = 25


def planned(x: tuple[float, ...], lowest: float, levels: int) -> tuple[Schedule, FloatArray]:
    """A plan that ends with the monodromy matrices at Chebyshev points of lowest <= eps <= 1, and these points."""
    points = (1 + lowest) / 2 + (1 - lowest) / 2 * chebyshev_points(NODES)
    across = (sum(x) * (1 - lowest) / 2,)
    return schedule(x, across, (points / points[0]).tobytes(), 1, 1, levels, INTERPOLATION_TOLERANCE), points


def doubled(plan: Schedule, values: FloatArray) -> FloatArray:
    """What becomes of matrices (s, N, N) at the beginning of a plan."""
    N = values.shape[-1]
    work = (np.zeros(plan.max_matrices * N * N), np.zeros(plan.max_matrices * N * N))
    work[0][: values.size] = values.ravel()
    return doublings(N, plan, unit_scale(1), work)


def scalar_growth(
    x: tuple[float, ...], theta: FloatArray, eps: FloatArray, span: float, phases: NDArray[np.floating]
) -> FloatArray:
    """exp of the integral of eps sum_j x_j cos(j t + phase_j) / (2 pi) over a part ``span`` of the period from theta: a
    product of steps for a system of one coordinate, whose factors commute."""
    total = np.zeros_like(theta)
    for j, (rate, phase) in enumerate(zip(x, phases, strict=True), 1):
        total += rate / (2 * np.pi * j) * (np.sin(j * (theta + span) + phase) - np.sin(j * theta + phase))
    return np.exp(eps * total)


@pytest.mark.kernel
@pytest.mark.parametrize(("x", "lowest"), CHARTS)
def test_samples_are_enough(x: tuple[float, ...], lowest: float) -> None:
    levels, phases = 8, np.arange(len(x)) + 0.4
    plan, points = planned(x, lowest, levels)
    some = scalar_growth(x, plan.theta, plan.eps * points[0], 2 * np.pi / 2**levels, phases)
    # the mean of F is zero; errors of the factors count once for each of them, and as parts of what they grow by
    tolerance = (1e-10 if plan.grid.all() else 2e-12) * np.exp(2 * sum(x) / np.pi)
    assert doubled(plan, some[:, None, None]).ravel() == pytest.approx(np.ones(NODES), abs=tolerance)


@pytest.mark.kernel
@pytest.mark.parametrize(("x", "lowest"), CHARTS)
def test_rounding_errors_do_not_grow_by_interpolation(x: tuple[float, ...], lowest: float) -> None:
    # [[1, d], [0, 1]]: products add the d, an error at each sample in turn
    plan, _ = planned(x, lowest, 8)
    ways = []
    for one in range(plan.sizes[0]):
        values = np.tile(np.eye(2), (plan.sizes[0], 1, 1))
        values[one, 0, 1] = 1.0
        ways.append(doubled(plan, values)[:, 0, 1])
    assert np.linalg.norm(ways, axis=0).max() < 1.25 * 2**8


@pytest.mark.kernel
def test_a_single_harmonic_needs_fewer_samples_than_a_grid() -> None:
    levels, x = 9, 2.0
    single, _ = planned((x,), 0.0, levels)
    several, _ = planned((x, 1e-9), 0.0, levels)
    assert several.grid.all()
    assert not single.grid[:-1].any()
    assert single.sizes[:-1].sum() < 0.6 * several.sizes[:-1].sum()


def test_growth_is_rounded_up() -> None:
    for strength in ((3.0,), (3.0, 0.01, 1.0)):
        for size in (0.0, 0.013, 7.7):
            x = growth_bounds(strength, size)
            assert all(bound >= size * rate for bound, rate in zip(x, strength, strict=True))
            assert sum(x) <= size * (sum(strength) * 2**0.25 * (1 + len(x) / 16))


# ---- doubling ----


@some
@given(st.integers(0, 10**6), st.integers(1, 3), st.integers(1, 4), st.booleans(), st.floats(0.5, 6.0))
def test_doubling_is_the_ordered_product(seed: int, n: int, harmonics: int, damped: bool, Omega: float) -> None:
    system = random_system(seed, n, harmonics, damping=0.2 * damped)
    eps, L = np.linspace(-0.4, 1.0, 40), 7
    for subsystem in subsystems(system):
        found = sampled(subsystem, Omega, eps, L)
        for i in (0, 11, 39):
            expected = ordered(steps(subsystem, Omega, eps[i], 2**L))
            # 2^L roundings, magnified by the growth that pieces are allowed, and the interpolation
            assert np.linalg.norm(found[i] - expected) < 1e-10 * np.linalg.norm(expected)


@pytest.mark.kernel
def test_doubling_a_single_phase() -> None:
    # constant coefficients: one phase, one amplitude, repeated squaring
    plan = schedule((0.0,), (0.0,), np.ones(1).tobytes(), 1, 1, 3, INTERPOLATION_TOLERANCE)
    assert plan.sizes.tolist() == [1, 1, 1, 1]
    P = sla.expm([[0.0, 0.1], [-0.1, 0.0]])
    assert doubled(plan, P[None])[0] == pytest.approx(np.linalg.matrix_power(P, 8), abs=1e-14)


@pytest.mark.parametrize("entries", [2**22, 300, 40])
def test_little_memory_changes_nothing(monkeypatch: pytest.MonkeyPatch, entries: int) -> None:
    # with room for a few matrices only, cells are done one by one, and the end of the period factor by factor
    subsystem = subsystems(mathieu(1.0, 0.01))[0]
    eps = np.linspace(0.0, 3.0, 5)
    monkeypatch.setattr(floquet.engine.doubling.sampling, "MAX_SAMPLE_ENTRIES", entries)
    found = sampled(subsystem, 0.1, eps, 10)
    expected = [ordered(steps(subsystem, 0.1, e, 2**10)) for e in eps]
    for one, other in zip(found, expected, strict=True):
        assert np.linalg.norm(one - other) < 1e-11 * np.linalg.norm(other)


@pytest.mark.parametrize("x", [(0.01,), (10.0,), (0.5, 0.3), (3.0, 1.0, 1.0)])
def test_interpolation_is_exact_for_constants(x: tuple[float, ...]) -> None:
    # what a constant is off adds up from step to step; without care it is 10 to 30 units
    plan = schedule(x, x[:1], np.linspace(-1, 1, 9).tobytes(), 1, 1, 10, INTERPOLATION_TOLERANCE)
    for weights in interpolations(plan):
        assert max(abs(math.fsum(row) - 1) for row in weights) < 8 * np.finfo(float).eps
    shear = np.broadcast_to([[1.0, 2.0**-20], [0.0, 1.0]], (plan.sizes[0], 2, 2))  # its products have no rounding
    for found in doubled(plan, shear):
        assert abs(np.diag(found) - 1).max() < ROUNDINGS_PER_STEP * 2**10 * np.finfo(float).eps


def interpolations(plan: Schedule) -> Iterator[FloatArray]:
    """The matrices of weights of a schedule, one after the other."""
    done = 0
    parts = (plan.phases, plan.amplitudes, plan.needed_amplitudes, plan.added_phases)
    for phases, amplitudes, needed, added in zip(*parts, strict=False):
        for rows, columns in ((needed * (needed != amplitudes), amplitudes), (added, phases)):
            if rows:
                yield plan.weights[done : done + rows * columns].reshape(rows, columns)
                done += rows * columns
    assert done == len(plan.weights)


def test_growth_beyond_the_largest_float() -> None:
    # a saddle: log|mu| = sqrt(k) T = 2000 pi, hundreds of decimal orders more than a float holds
    subsystem = subsystems(mathieu(-1.0))[0]
    sampler = Sampler(subsystem, equations(subsystem, 0.01), 1e-3, Workspace())
    (piece,) = sampler.pieces(np.array([0.0]), 16, INTERPOLATION_TOLERANCE)
    mu = np.abs(np.linalg.eigvals(piece.samples[0])).max()
    assert np.log(mu) + piece.scale.exponents[0] * math.log(2) == pytest.approx(2000 * math.pi, rel=1e-10)


def test_cancellation_is_noted() -> None:
    # rotations lose nothing; growth in one half of the period against decay in the other does
    turn = sla.expm([[0.0, 0.3], [-0.3, 0.0]])
    saddle = np.diag([1e4, 1e-4])
    # both halves as they are
    plan = schedule(
        (np.inf,), (0.0,), np.ones(1).tobytes(), 1, 1, 1, INTERPOLATION_TOLERANCE
    )  # both halves as they are
    losses = []
    for first, second in ((turn, turn), (saddle, np.linalg.inv(saddle))):
        scale, work = unit_scale(1), (np.concatenate([first.ravel(), second.ravel()]), np.empty(8))
        doublings(2, plan, scale, work)
        losses.append(scale.losses[0])
    assert losses[0] == pytest.approx(1, rel=1e-14)
    assert losses[1] == pytest.approx(1e8 / 2, rel=1e-6)


# ---- many harmonics ----


@pytest.mark.parametrize(("J", "n", "phases"), [(3, 2, 16), (7, 1, 9), (5, 4, 8), (9, 6, 64)])
def test_steps_on_a_grid_are_the_single_steps(J: int, n: int, phases: int) -> None:
    """Also where the grid is too coarse to tell all harmonics apart."""
    subsystem, *others = subsystems(many_harmonics(J, n))
    assert not others
    free, h, eps = equations(subsystem, 0.01), 0.03, np.array([-0.4, 0.0, 0.7])
    theta = np.repeat(2 * np.pi * np.arange(phases) / phases, 3)
    P, Q = np.empty((2, 3 * phases, 2 * n, 2 * n))
    F = forcing_on_grid(subsystem.Fc, subsystem.Fs, phases)
    grid_steps(free.A, F, free.left, free.right, h, eps, P)
    single_steps(free.A, subsystem.Fc, subsystem.Fs, free.left, free.right, h, theta, np.tile(eps, phases), Q)
    np.testing.assert_allclose(P, Q, rtol=0, atol=1e-14)


@pytest.mark.parametrize("J", [2, 9, 60])
def test_whole_periods_and_interpolation_agree(J: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """With many harmonics all steps are taken, with few phases are interpolated; either way the point is the same."""
    system, Omega, eps = many_harmonics(J), 1.7, np.linspace(-0.1, 0.3, 60)
    (subsystem,) = subsystems(system)
    L = 12
    plans, found = [], []
    for states in (0, 2):
        monkeypatch.setattr(floquet.engine.doubling.sampling, "MAX_WHOLE_STATES", states)
        sampler = Sampler(subsystem, equations(subsystem, 0.01), Omega, Workspace())
        plans.append(sampler.plan(eps, L, INTERPOLATION_TOLERANCE))
        found.append(sampler.matrices(eps, L, INTERPOLATION_TOLERANCE))
    interpolated, chosen = (plan.schedule.added_phases.sum() for plan in plans if plan is not None)
    assert interpolated > 0
    assert (chosen == 0) == (J > 9)
    np.testing.assert_allclose(found[1], found[0], rtol=0, atol=1e-11)
    for i in (0, 59):
        mu = np.sort(np.abs(np.linalg.eigvals(found[1][i])))
        expected = np.sort(np.abs(monodromy(system, Omega, float(eps[i])).multipliers))
        np.testing.assert_allclose(mu, expected, rtol=1e-7)
