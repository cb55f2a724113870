"""Distributions over the edge: values, exact integrals across jumps, arithmetic, bad input."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from numpy.polynomial import Legendre
from scipy.integrate import quad

from plate import Distribution, EdgeLoad
from tests.plate.plate_oracles import distributions, numbers

TERMS = 9


def by_antiderivatives(f: Distribution, factor: Legendre) -> float:
    """The integral of f times a polynomial, piece by piece from antiderivatives."""
    total = 0.0
    for i, row in enumerate(f.coefficients):
        start, end = f.breaks[i], f.breaks[i + 1]
        product = Legendre(row, domain=[start, end]).convert(domain=[0, 1], kind=Legendre) * factor
        antiderivative = product.integ()
        total += antiderivative(end) - antiderivative(start)
    return total


@settings(max_examples=20, deadline=None)
@given(distributions())
def test_integrals_are_exact_across_jumps(f: Distribution) -> None:
    q = [np.sqrt(2 * l + 1) * Legendre.basis(l, domain=[0, 1]) for l in range(TERMS)]
    projection = [by_antiderivatives(f, q_l) for q_l in q]
    moments = [[by_antiderivatives(f, q_l * q_j) for q_l in q] for q_j in q]
    # numpy's change of domain of short pieces loses digits: up to (1/width)^3 of rounding
    np.testing.assert_allclose(f.projection(TERMS), projection, atol=1e-8)
    np.testing.assert_allclose(f.moments(TERMS), moments, atol=1e-8)
    assert f.mean == pytest.approx(projection[0], abs=1e-8)


def test_moments_of_a_partial_load_by_hand() -> None:
    # f = 2 on [1/4, 3/4], q_0 = 1, q_1 = sqrt(3) (2 y - 1): (f q_1, q_1) = 6 int_(1/4)^(3/4) (2 y - 1)^2 dy = 1/4
    moments = EdgeLoad.partial(0.5).static.moments(2)
    np.testing.assert_allclose(moments, [[1.0, 0.0], [0.0, 0.25]], atol=1e-15)


def test_smooth_distribution_against_adaptive_quadrature() -> None:
    arch = EdgeLoad.cosine(edge=0.3).static
    exact = [
        quad(lambda y, l=l: (0.3 + 0.35 * np.pi * np.sin(np.pi * y)) * Legendre.basis(l, domain=[0, 1])(y), 0, 1)[0]
        for l in range(TERMS)
    ]
    np.testing.assert_allclose(arch.projection(TERMS), exact * np.sqrt(2 * np.arange(TERMS) + 1), atol=1e-13)


@settings(max_examples=30, deadline=None)
@given(distributions(), distributions(), numbers)
def test_arithmetic_acts_on_values_and_integrals(f: Distribution, g: Distribution, factor: float) -> None:
    y = np.linspace(0, 1, 57)  # off the breaks, which are hundredths, but for the ends
    combined = f + factor * g
    scale = 1e-12 * (1 + np.abs(f(y)).max() + abs(factor) * np.abs(g(y)).max())
    np.testing.assert_allclose(combined(y), f(y) + factor * g(y), atol=scale)
    np.testing.assert_allclose((f - g * factor)(y), f(y) - factor * g(y), atol=scale)
    np.testing.assert_allclose(
        combined.projection(TERMS), f.projection(TERMS) + factor * g.projection(TERMS), atol=1e-11
    )
    assert combined.mean == pytest.approx(f.mean + factor * g.mean, abs=1e-11)


def test_samples_are_joined_by_straight_lines() -> None:
    places, values = [0.0, 0.1, 0.4, 1.0], [1.0, -2.0, 3.0, 0.5]
    y = np.linspace(0, 1, 33)
    np.testing.assert_allclose(Distribution.from_samples(places, values)(y), np.interp(y, places, values), atol=1e-14)


def test_a_jump_has_the_value_to_its_right() -> None:
    f = EdgeLoad.partial(0.5).static
    np.testing.assert_array_equal(f([0.0, 0.25, 0.5, 0.75, 1.0]), [0.0, 2.0, 2.0, 0.0, 0.0])


def test_equal_distributions_compare_and_hash_alike() -> None:
    one, other = (Distribution.from_samples([0, 0.5, 1], [1, 2, 3]) for _ in range(2))
    assert one == other
    assert hash(one) == hash(other)
    assert one != 2 * other


@pytest.mark.parametrize(
    ("breaks", "coefficients", "message"),
    [
        ((0.0, 0.5), ((1.0,),), "breaks runs from 0 to 0.5"),
        ((0.0, 0.5, 0.5, 1.0), ((1.0,),) * 3, "breaks is not strictly increasing"),
        ((0.0, np.nan, 1.0), ((1.0,),) * 2, "breaks"),
        ((), (), "breaks is empty"),
        ((1.0,), (), "breaks runs from"),
        ("ab", ((1.0,),), "breaks"),
        ((0.0, 1.0), ((1.0,), (2.0,)), "coefficients has 2 rows"),
        ((0.0, 1.0), 3.0, "coefficients = 3.0"),
        ((0.0, 1.0), (1.0,), r"coefficients\[0\]"),
        ((0.0, 1.0), ((),), r"coefficients\[0\] is empty"),
        ((0.0, 1.0), ((np.inf,),), r"coefficients\[0\]"),
        ((0.0, 1.0), ((1j,),), r"coefficients\[0\]"),
    ],
)
def test_bad_pieces_are_refused(breaks: Any, coefficients: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        Distribution(breaks, coefficients)


@pytest.mark.parametrize(
    ("y", "f", "message"),
    [
        ([0.0, 1.0], [1.0], "f has 1 values"),
        ([0.0, 0.9], [1.0, 1.0], "y runs from 0 to 0.9"),
        ([0.1, 1.0], [1.0, 1.0], "y runs from 0.1"),
        ([1.0, 0.0], [1.0, 1.0], "y is not strictly increasing"),
        ([0.0, 1.0], [1.0, np.nan], "f has the entry nan"),
        ([0.0, 1.0], [[1.0, 1.0]], "f has shape"),
        ([0.0, 1.0], ["a", "b"], "f has entries"),
        ([0.0], [1.0], "y runs from"),
    ],
)
def test_bad_samples_are_refused(y: Any, f: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        Distribution.from_samples(y, f)


@pytest.mark.parametrize("y", [-0.1, 1.1, np.nan, "a", [0.5, 2.0]])
def test_values_are_asked_for_on_the_edge_only(y: Any) -> None:
    with pytest.raises(ValueError, match="y "):
        EdgeLoad.uniform().static(y)


@pytest.mark.parametrize("factor", [np.nan, "2", None, 1j])
def test_factors_are_numbers(factor: Any) -> None:
    with pytest.raises(ValueError, match="factor"):
        EdgeLoad.uniform().static * factor
