"""Orders in eps: fitted, and what is left of a gap as eps -> 0."""

from __future__ import annotations

import numpy as np
import pytest

from compare.orders import fitted_order, still_falls, vanishes


@pytest.mark.parametrize("order", [1, 2, 3])
def test_fitted_order_is_that_of_the_leading_term(order: int) -> None:
    eps = np.array([0.01, 0.02, 0.04, 0.08])
    gap = 0.7 * eps**order * (1 + 2 * eps)
    assert fitted_order(eps, gap) == pytest.approx(order, abs=5e-3)
    assert np.isnan(fitted_order(eps, np.zeros(4)))


@pytest.mark.parametrize(
    ("a", "agrees"),
    [
        ((0.0, 0.0, 1e-3, -0.1), True),  # the leading part is small: the gap changes sign on the ladder
        ((0.0, 0.0, 1.0, 1.0), True),
        ((0.0, 1e-2, 0.1, 0.0), False),  # a slope that is wrong
        ((0.0, 1e-4, 1e-3, -0.1), False),
        ((1e-3, 0.0, 1.0, 0.0), False),  # a centre that is wrong
        ((0.0, 0.0, 0.0, np.nan), False),
    ],
)
def test_a_signed_gap_has_no_first_order_left(a: tuple[float, ...], agrees: bool) -> None:
    eps = np.array([0.0125, 0.025, 0.05, 0.1])
    assert vanishes(eps, np.polynomial.Polynomial(a)(eps), 1, 1e-12) is agrees


@pytest.mark.parametrize(
    ("a", "falls"),
    [((0.0, 0.0, 1.0, 1.0), True), ((0.0, 0.1, 0.1, 0.0), False), ((1e-3, 0.0, 1.0, 0.0), False)],
)
def test_what_has_a_limit_does_not_fall_any_more(a: tuple[float, ...], falls: bool) -> None:
    eps = np.array([0.0125, 0.025, 0.05, 0.1])
    assert still_falls(eps, np.polynomial.Polynomial(a)(eps), 1) is falls
