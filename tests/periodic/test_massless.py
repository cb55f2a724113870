"""Coordinates without mass: the eigenvalues that are left are those of the pencil."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import scipy.linalg as sla

from periodic import FirstOrderSystem, PeriodicSystem, Term, waveforms, without_massless

# a chain of three: the one in the middle has no mass
K = np.array([[3.0, -1.0, 0.0], [-1.0, 2.5, -1.5], [0.0, -1.5, 2.0]])
M = np.diag([1.0, 0.0, 2.0])
C = 0.1 * K


def free_motion(system: Any) -> np.ndarray:
    """Eigenvalues of the free motion."""
    if isinstance(system, FirstOrderSystem):
        return np.sort_complex(np.linalg.eigvals(system.constant))
    n = system.size
    Mi = np.linalg.inv(system.mass)
    velocity = system.gyroscopic + system.damping
    return np.sort_complex(
        np.linalg.eigvals(np.block([[-Mi @ velocity, -Mi @ system.stiffness], [np.eye(n), np.zeros((n, n))]]))
    )


def pencil(M: np.ndarray, C: np.ndarray, K: np.ndarray) -> np.ndarray:
    """Finite eigenvalues of lambda^2 M + lambda C + K."""
    n = len(M)
    zero, one = np.zeros((n, n)), np.eye(n)
    values = sla.eigvals(np.block([[-C, -K], [one, zero]]), sla.block_diag(M, one))
    return np.sort_complex(values[np.isfinite(values) & (np.abs(values) < 1e6)])


def test_without_damping_they_are_condensed() -> None:
    found = without_massless(M, stiffness=K, cosine=np.diag([1.0, 0.0, 0.0]))
    assert isinstance(found.system, PeriodicSystem)
    assert found.system.size == 2
    assert "1 of 3 coordinates have no mass" in found.said
    np.testing.assert_allclose(free_motion(found.system), pencil(M, 0 * K, K), atol=1e-12)
    # the massless coordinate is in equilibrium
    np.testing.assert_allclose((K @ found.coordinates)[1], 0, atol=1e-14)
    turned = found.coordinates.T @ np.diag([1.0, 0.0, 0.0]) @ found.coordinates
    np.testing.assert_allclose(found.system.cosine[0], turned, atol=1e-14)


def test_with_damping_they_are_states_of_their_own() -> None:
    excitation = np.array([[0.0, 0.2, 0.0], [0.2, 1.0, 0.0], [0.0, 0.0, 0.3]])
    found = without_massless(M, damping=C, stiffness=K, sine=excitation)
    assert isinstance(found.system, FirstOrderSystem)
    assert found.system.size == 5
    np.testing.assert_allclose(free_motion(found.system), pencil(M, C, K), atol=1e-12)
    # with the excitation frozen at any phase, too
    frozen = np.sort_complex(np.linalg.eigvals(found.system.matrix(0.7, 0.4)))
    np.testing.assert_allclose(frozen, pencil(M, C, K + 0.4 * np.sin(0.7) * excitation), atol=1e-12)


def test_directions_that_are_no_coordinates() -> None:
    T = np.array([[1.0, 0.4, -0.2], [0.3, 1.0, 0.5], [-0.1, 0.2, 1.0]])
    found = without_massless(T.T @ M @ T, damping=T.T @ C @ T, stiffness=T.T @ K @ T)
    np.testing.assert_allclose(free_motion(found.system), pencil(M, C, K), atol=1e-11)


def test_a_regular_mass_is_left_alone() -> None:
    found = without_massless(np.eye(3), damping=C, stiffness=K)
    assert isinstance(found.system, PeriodicSystem)
    np.testing.assert_array_equal(found.system.damping, C)
    assert "nothing was condensed" in found.said


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ({"mass": np.diag([1.0, -1.0, 1.0])}, "mass has the diagonal entry -1"),
        ({"mass": [[1.0, 2.0], [2.0, 1.0]]}, "mass has the lowest eigenvalue -1"),
        ({"mass": M, "stiffness": np.diag([1.0, 0.0, 1.0])}, "no stiffness; nothing determines its motion"),
        ({"mass": M, "stiffness": K, "cosine": K}, "damping acts on some of them only or not at all"),
        ({"mass": M, "stiffness": K, "terms": [Term("mass", K)]}, "a mass term acts on a coordinate without mass"),
        ({"mass": M, "damping": C, "stiffness": K, "terms": [Term("damping", C)]}, "needs a quotient of terms"),
        (
            {"mass": M, "damping": C, "stiffness": K, "terms": [Term("stiffness", K, waveforms.impulses([0], [1]))]},
            "impulses act on a coordinate without mass",
        ),
    ],
)
def test_refusals(arguments: dict[str, Any], says: str) -> None:
    with pytest.raises(ValueError, match=says):
        without_massless(**arguments)
