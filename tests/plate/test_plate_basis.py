"""Trial functions: identities, and exact integrals against Gauss's rule."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.polynomial import legendre as numpy_legendre

from plate.basis import (
    gauss_legendre,
    kronecker,
    legendre,
    legendre_derivative,
    sine_derivative,
    sine_legendre,
    sine_slopes,
    sines,
)

# Many more nodes than any product below needs: what remains is rounding.
NODES = 120
ROUNDING = 1e-12


@pytest.mark.parametrize("r", [0.5, 1.0, 3.0])
def test_sines_are_orthonormal(r: float) -> None:
    X, weights = gauss_legendre(NODES, 0.0, r)
    s = sines(X, 12, r)
    np.testing.assert_allclose((s.T * weights) @ s, np.eye(12), atol=ROUNDING)


def test_legendre_is_orthonormal() -> None:
    y, weights = gauss_legendre(NODES, 0.0, 1.0)
    q = legendre(y, 20)
    np.testing.assert_allclose((q.T * weights) @ q, np.eye(20), atol=ROUNDING)


def test_slopes_are_derivatives_of_the_sines() -> None:
    X, step = np.linspace(0.1, 1.9, 7), 1e-6
    central = (sines(X + step, 5, 2.0) - sines(X - step, 5, 2.0)) / (2 * step)
    np.testing.assert_allclose(sine_slopes(X, 5, 2.0), central, atol=1e-7)  # step^2 times the third derivative


def test_legendre_derivative_against_numpys() -> None:
    terms, y = 15, np.linspace(0, 1, 9)
    derivative = legendre(y, terms) @ legendre_derivative(terms)
    for l in range(terms):
        series = numpy_legendre.Legendre.basis(l, domain=[0, 1]) * np.sqrt(2 * l + 1)
        np.testing.assert_allclose(derivative[:, l], series.deriv()(y), atol=1e-9)  # values up to 7e2


@pytest.mark.parametrize("r", [0.5, 1.0, 3.0])
def test_sine_derivative_is_its_integral_and_skew(r: float) -> None:
    X, weights = gauss_legendre(NODES, 0.0, r)
    S = sine_derivative(12, r)
    integral = (sines(X, 12, r).T * weights) @ sine_slopes(X, 12, r)
    np.testing.assert_allclose(S, integral, atol=ROUNDING * np.abs(S).max())
    np.testing.assert_array_equal(S, -S.T)


@pytest.mark.parametrize("r", [0.5, 1.0, 3.0])
def test_sines_against_legendre_polynomials(r: float) -> None:
    X, weights = gauss_legendre(NODES, 0.0, r)
    p = legendre(X / r, 25) / np.sqrt(r)
    np.testing.assert_allclose(sine_legendre(30, 25), (p.T * weights) @ sines(X, 30, r), atol=ROUNDING)


def test_kronecker_is_numpys() -> None:
    rng = np.random.default_rng(1)
    A, B = rng.normal(size=(3, 2)), rng.normal(size=(4, 5))
    np.testing.assert_array_equal(kronecker(A, B), np.kron(A, B))


@pytest.mark.parametrize("points", [1, 2, 5])
def test_gauss_is_exact_to_its_degree_and_no_further(points: int) -> None:
    y, weights = gauss_legendre(points, 0.0, 2.0)
    for degree in range(2 * points):
        assert weights @ y**degree == pytest.approx(2.0 ** (degree + 1) / (degree + 1), rel=1e-13)
    assert weights @ y ** (2 * points) != pytest.approx(2.0 ** (2 * points + 1) / (2 * points + 1), rel=1e-8)
