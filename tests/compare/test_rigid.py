"""Rigid-body motion: set apart where nothing touches it, and only there."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from compare import agreement
from compare.rigid import elastic_part
from periodic import PeriodicSystem

ZERO = np.zeros((3, 3))
CHAIN = np.array([[1.0, -1.0, 0.0], [-1.0, 3.0, -2.0], [0.0, -2.0, 2.0]])  # free at both ends
MESH = np.array([[1.0, -1.0, 0.0], [-1.0, 1.0, 0.0], [0.0, 0.0, 0.0]])  # a spring between the first two that varies
MASS = np.diag([1.0, 2.0, 0.5])


def _multipliers(system: PeriodicSystem, Omega: float, eps: float) -> np.ndarray:
    n, period = system.size, 2 * np.pi / Omega
    inverse = np.linalg.inv(system.mass)

    def slope(t: float, y: np.ndarray) -> np.ndarray:
        Y = y.reshape(2 * n, -1)
        K = system.stiffness + eps * np.cos(Omega * t) * system.cosine[0]
        return np.concatenate([Y[n:], -inverse @ (K @ Y[:n] + (system.gyroscopic + system.damping) @ Y[n:])]).ravel()

    end = solve_ivp(slope, (0, period), np.eye(2 * n).ravel(), method="DOP853", rtol=1e-12, atol=1e-12).y[:, -1]
    return np.linalg.eigvals(end.reshape(2 * n, 2 * n))


def test_the_elastic_part_has_the_other_multipliers() -> None:
    system = PeriodicSystem(MASS, ZERO, 0.05 * CHAIN, CHAIN, [MESH])
    part, rigid = elastic_part(system, 1.0)
    assert rigid == 1
    whole, rest = (_multipliers(s, 1.7, 0.6) for s in (system, part.at(1.7)))
    for mu in rest:
        assert np.abs(whole - mu).min() < 1e-8
    left = sorted(whole, key=lambda mu: np.abs(rest - mu).min())[-2:]
    np.testing.assert_allclose(left, 1, atol=1e-5)  # a double multiplier with one eigenvector: the root of rounding


@pytest.mark.parametrize(
    ("damping", "cosine"),
    [(ZERO, np.diag([1.0, 0.0, 0.0])), (0.1 * MASS, MESH)],
    ids=["excited", "damped"],
)
def test_a_motion_that_something_touches_stays(damping: np.ndarray, cosine: np.ndarray) -> None:
    system = PeriodicSystem(MASS, ZERO, damping, CHAIN, [cosine])
    assert elastic_part(system, 1.0) == (system, 0)


def test_a_free_drivetrain_is_compared() -> None:
    verdicts = agreement(PeriodicSystem(MASS, ZERO, ZERO, CHAIN, [MESH]), (0.5, 6.0))
    sums = [verdict for verdict in verdicts if verdict.type == "sum"]
    assert [verdict.label for verdict in sums] == ["2ω₁", "ω₁+ω₂", "2ω₂"]
    assert all(verdict.agrees for verdict in sums), [verdict.reason for verdict in sums]
