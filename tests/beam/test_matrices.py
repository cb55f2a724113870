"""The integrals of the beam against quadrature, and what integration by parts says of them."""

from __future__ import annotations

import numpy as np
import pytest

from beam import matrices
from periodic.checks import FloatArray

n = 5
NODES, WEIGHTS = np.polynomial.legendre.leggauss(40)
x, weights = (NODES + 1) / 2, WEIGHTS / 2


def derivative(order: int) -> FloatArray:
    """Return the derivative of sqrt(2) sin(k pi x), by shifting the phase a quarter for each."""
    k = np.arange(1, n + 1) * np.pi
    return np.sqrt(2) * k**order * np.sin(np.outer(x, k) + order * np.pi / 2)


def angle(order: int) -> FloatArray:
    """Return the derivative of 1 and sqrt(2) cos(k pi x)."""
    k = np.arange(1, n + 1) * np.pi
    cosines = np.sqrt(2) * k**order * np.cos(np.outer(x, k) + order * np.pi / 2)
    return np.column_stack([np.full(len(x), float(order == 0)), cosines])


def integral(phi: FloatArray, w: FloatArray, factor: FloatArray | float = 1.0) -> FloatArray:
    return (phi * (weights * factor)[:, None]).T @ w


def test_matrices_are_the_integrals() -> None:
    expected = {
        "transport": integral(derivative(0), derivative(1)),
        "tension": integral(derivative(1), derivative(1)),
        "slope": integral(angle(0), derivative(1)),
        "rotation_transport": integral(angle(0), angle(1)),
        "curvature": integral(angle(1), angle(1)),
        "carried_curvature": integral(angle(1), angle(2)),
        "carried_curvature_strong": -integral(angle(0), angle(3)),
    }
    for name, matrix in expected.items():
        np.testing.assert_allclose(
            getattr(matrices, name)(n), matrix, atol=1e-12 * np.abs(matrix).max(), rtol=0, err_msg=name
        )


@pytest.mark.parametrize("held_at", [0.0, 0.3, 1.0])
def test_tension_that_accelerates(held_at: float) -> None:
    # v' w_x - (v' (x - x0) w_x)_x = - v' (x - x0) w_xx: what is left of the acceleration across the beam
    left = matrices.transport(n) + matrices.inertial_tension(n, held_at)
    np.testing.assert_allclose(left, -integral(derivative(0), derivative(2), x - held_at), atol=1e-12)


def test_symmetries() -> None:
    for name, sign in (("transport", -1), ("carried_curvature", -1), ("tension", 1), ("curvature", 1)):
        matrix = getattr(matrices, name)(n)
        np.testing.assert_array_equal(matrix, sign * matrix.T, err_msg=name)
    strong = matrices.carried_curvature_strong(n)
    assert np.abs(strong + strong.T).max() > 0.5 * np.abs(strong).max()
