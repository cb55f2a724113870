"""The second look: close multipliers that cannot meet, and those that do."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.linalg as sla

from floquet import Kind, monodromy, stability_chart
from floquet.engine.krein import held_apart
from periodic.checks import FloatArray
from plate import EdgeLoad, MovingPlate


def rotations(*angles: float) -> FloatArray:
    """The symplectic matrix of uncoupled rotations; a negative angle is a motion of the other Krein sign."""
    c, s = np.diag(np.cos(angles)), np.diag(np.sin(angles))
    return np.block([[c, s], [-s, c]])


def coupled(strength: float, *angles: float, seed: int = 0) -> FloatArray:
    """A rotation in other canonical coordinates: the multipliers stay, the eigenvectors become oblique."""
    n = len(angles)
    S = strength * np.random.default_rng(seed).standard_normal((2 * n, 2 * n))
    J = np.block([[np.zeros((n, n)), np.eye(n)], [-np.eye(n), np.zeros((n, n))]])
    T = sla.expm(J @ (S + S.T))
    return T @ rotations(*angles) @ np.linalg.inv(T)


@pytest.mark.parametrize("second", [1.0001, -1.0001])
def test_rotations_are_held_apart_up_to_the_error(second: float) -> None:
    # 1e-4 apart, of the same and of opposite sign; sqrt(E) would not tell
    Phi = np.array([rotations(1.0, second)] * 3)
    assert held_apart(Phi, np.array([1e-8, 1e-6, 1e-3])).tolist() == [True, True, False]


def test_oblique_eigenvectors_need_more_distance() -> None:
    E = np.array([1e-6])
    assert held_apart(rotations(1.0, -1.0001)[None], E)[0]
    assert not held_apart(coupled(2.0, 1.0, -1.0001)[None], E)[0]
    assert held_apart(coupled(2.0, 1.0, -1.0001)[None], E * 1e-6)[0]


def test_off_the_circle_nothing_is_held() -> None:
    # a quadruple mu, 1/mu and their conjugates, next to the circle
    a, b = 1.0, 1e-6
    R = np.exp(b) * np.array([[np.cos(a), np.sin(a)], [-np.sin(a), np.cos(a)]])
    Phi = sla.block_diag(R, np.linalg.inv(R).T)
    assert not held_apart(Phi[None], np.array([1e-14]))[0]


def test_on_a_boundary_nothing_is_held() -> None:
    # +1 twice with one eigenvector, and a double multiplier with two
    assert not held_apart(np.array([[[1.0, 2.0], [0.0, 1.0]]]), np.array([1e-15]))[0]
    assert not held_apart(rotations(1.0, -1.0)[None], np.array([1e-15]))[0]


def test_the_plate_is_decided_and_rightly() -> None:
    plate = MovingPlate(load=EdgeLoad.partial(0.5), inplane="static")
    Omega, eps = np.linspace(20, 40, 96), np.linspace(0, 1, 64)
    chart = stability_chart(plate, Omega, eps, audit=0, progress=False)
    assert (chart.kind == Kind.UNDECIDED).sum() <= 2
    # cells that had to be looked at twice: some multipliers are close to each other there
    system = plate.at(30.0)
    doubtful = []
    for i, j in np.argwhere(chart.kind == Kind.STABLE)[::58]:
        found = monodromy(system, float(Omega[j]), float(eps[i]))
        mu = np.asarray(found.multipliers)
        distance = np.abs(mu[:, None] - mu) + np.diag(np.full(len(mu), 9.0))
        if distance.min() < 1e-3:
            doubtful.append(found.kind)
    assert len(doubtful) >= 3
    assert all(kind <= Kind.STABLE for kind in doubtful)
