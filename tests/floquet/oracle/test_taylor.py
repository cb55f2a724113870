"""The Taylor kernels: order of convergence, one step against its series, the scalar functions they are fed."""

from __future__ import annotations

import math

import numpy as np
import pytest
import scipy.linalg as sla

from floquet.oracle.reduction import Subsystem, constant_matrix, reduce_system
from floquet.oracle.taylor import (
    CONVERGED,
    OVERFLOWN,
    UNCONVERGED,
    Equations,
    forcing_coefficients,
    integrate,
    taylor_step,
)
from periodic import PeriodicSystem
from periodic.checks import FloatArray
from tests.floquet.oracle_systems import random_system


def subsystem_of(system: PeriodicSystem, eps: float = 0.5) -> Subsystem:
    (subsystem,) = reduce_system(system, eps, 1.0)
    return subsystem


def period(
    subsystem: Subsystem, Omega: float, steps: int, order: int, tolerance: float = 0.0
) -> tuple[FloatArray, int]:
    m = len(subsystem.equations.w)
    y = np.eye(2 * m)
    y1, y2 = y[:m].copy(), y[m:].copy()
    status, _ = integrate(subsystem.equations, Omega, steps, 0, steps, order, tolerance, y1, y2)
    return np.vstack([y1, y2]), status


@pytest.mark.kernel
def test_forcing_coefficients_are_the_taylor_series() -> None:
    alpha, beta = np.array([[0.3, 1.0, -0.5], [0.0, 0.2, 0.0]]), np.array([[0.0, 0.4, 2.0], [0.0, 0.0, -1.0]])
    step, steps = 5, 13
    coefficients = forcing_coefficients(alpha, beta, step, steps, 30)
    j = np.arange(3)
    for fraction in (0.0, 0.3, 1.0):
        phase = 2 * np.pi * j * (step + fraction) / steps
        exact = alpha @ np.cos(phase) + beta @ np.sin(phase)
        series = coefficients[:, ::-1] @ fraction ** np.arange(30)
        assert series == pytest.approx(exact, abs=1e-14)


@pytest.mark.kernel
def test_step_without_excitation_is_the_exponential() -> None:
    subsystem = subsystem_of(random_system(1, 2, damping=0.3))
    quiet = subsystem.equations._replace(alpha=0 * subsystem.equations.alpha, beta=0 * subsystem.equations.beta)
    h, order = 0.5, 40
    y1, y2 = np.eye(2, 4), np.eye(2, 4, 2)
    history, stacked = np.empty((order + 1, 8)), np.empty((len(quiet.alpha) + 1, 8))
    coefficients = forcing_coefficients(quiet.alpha, quiet.beta, 0, 12, order)
    terms, last, _ = taylor_step(quiet, coefficients, h, 1e-16, y1, y2, history, stacked)
    assert terms < order
    assert last <= 1e-16
    A = constant_matrix(subsystem.equations)
    assert np.vstack([y1, y2]) == pytest.approx(sla.expm(h * A), abs=1e-14)


@pytest.mark.kernel
def test_terms_are_the_derivatives_of_the_solution() -> None:
    # x'' + (1 + cos t) x = 0 with x(0) = 1, x'(0) = 0: x = 1 - t^2 + (5/24) t^4 + ... by hand from the equation
    one = np.ones((1, 1))
    subsystem = Equations(one[0], one[0], one.copy(), False, np.array([[0.0, 1.0]]), np.array([[0.0, 0.0]]))
    y1, y2 = np.array([[1.0]]), np.array([[0.0]])
    history, stacked = np.empty((6, 1)), np.empty((2, 1))
    coefficients = forcing_coefficients(subsystem.alpha, subsystem.beta, 0, 6, 5)
    h = 2 * np.pi / 6
    taylor_step(subsystem, coefficients, h, 0.0, y1, y2, history, stacked)
    assert history[:5, 0] / h ** np.arange(5) == pytest.approx([1.0, 0.0, -1.0, 0.0, 5 / 24], abs=1e-15)


@pytest.mark.parametrize("h", [0.5, 2.0, 6.0, 12.0])
def test_rounding_of_a_step_is_estimated(h: float) -> None:
    # a rotation by h: its terms reach h^h / h!, 65 at h = 6 and 19 000 at h = 12, and cancel
    one = np.ones((1, 1))
    subsystem = Equations(one[0], one[0], one.copy(), False, np.zeros((1, 2)), np.zeros((1, 2)))
    angles = h * np.linspace(1.0, 1.01, 40)
    errors, estimates = [], []
    for angle in angles:
        y1, y2 = np.eye(1, 2), np.eye(1, 2, 1)
        status, rounding = integrate(subsystem, 2 * np.pi / angle, 1, 0, 1, 80, 1e-17, y1, y2)
        exact = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
        assert status == CONVERGED
        errors.append(np.linalg.norm(np.vstack([y1, y2]) - exact))
        estimates.append(rounding)
    assert (np.array(errors) <= 3 * np.array(estimates)).all()
    assert np.median(estimates) < 30 * np.median(errors)


@pytest.mark.parametrize("order", [4, 7])
def test_order_of_convergence(order: int) -> None:
    subsystem = subsystem_of(random_system(3, 3, 2))
    exact, status = period(subsystem, 1.1, 60, 60, 1e-17)
    assert status == CONVERGED
    steps = np.array([40, 57, 80, 113])
    errors = []
    for number in steps:
        approximate, status = period(subsystem, 1.1, number, order)
        assert status == UNCONVERGED  # the series were cut
        errors.append(np.linalg.norm(approximate - exact, 2))
    slope = np.polyfit(np.log(steps), np.log(errors), 1)[0]
    # the global error of a series cut after h^p is of order h^p; the next term bends the fit by a few per cent
    assert -slope == pytest.approx(order, abs=0.25)


def test_overflow_is_reported() -> None:
    # x'' = 1e4 x over T = 2 pi: e^628
    one = np.ones((1, 1))
    subsystem = Equations(np.array([100.0]), np.array([-100.0]), one.copy(), False, np.zeros((1, 2)), np.zeros((1, 2)))
    y1, y2 = np.eye(1, 2), np.eye(1, 2, 1)
    assert integrate(subsystem, 1.0, 300, 0, 300, 60, 1e-16, y1, y2)[0] == OVERFLOWN


def test_many_harmonics() -> None:
    # Fejér's kernel: sum_j 2 (1 - j / 17) cos jt has the closed form sin^2(17 t / 2) / (17 sin^2(t / 2)) - 1
    alpha = np.concatenate([[0.0], 2 * (1 - np.arange(1, 17) / 17)])[None]
    t = 2 * np.pi * 37 / 600
    value = forcing_coefficients(alpha, np.zeros_like(alpha), 37, 600, 20)[0, -1]
    assert value == pytest.approx(math.sin(17 * t / 2) ** 2 / (17 * math.sin(t / 2) ** 2) - 1, abs=1e-13)
