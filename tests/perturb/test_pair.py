"""Two resonant modes: growth, edges and tips in closed form against eigenvalues, and their limits."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from perturb.pair import pair_edges, pair_edges_vanishing, pair_growth, pair_slope, pair_tip

few = settings(deadline=None, max_examples=20)


def pair_matrix(C_p: float, C_q: float, L: complex, s: float) -> np.ndarray:
    return 0.5 * np.array([[-C_p - 1j * s, L], [1.0, -C_q + 1j * s]])


products = st.tuples(st.floats(-1, 1), st.floats(-1, 1)).map(lambda parts: complex(*parts))
decays = st.floats(0.01, 1)


@few
@given(decays, decays, products, st.floats(-3, 3))
def test_pair_growth_is_the_larger_eigenvalue(C_p: float, C_q: float, L: complex, s: float) -> None:
    expected = np.linalg.eigvals(pair_matrix(C_p, C_q, L, s)).real.max()
    # Near coalescence eigvals itself loses the square root of rounding.
    assert pair_growth(C_p, C_q, L, s) == pytest.approx(expected, abs=1e-7)


@settings(deadline=None, max_examples=60)
@given(decays, decays, products)
def test_pair_edges_bound_the_unstable_detunings(C_p: float, C_q: float, L: complex) -> None:
    """For complex L too: neutral on the edges, unstable between, stable outside; closed where NaN."""
    L *= 4
    low, high = map(float, pair_edges(C_p, C_q, L))
    if np.isnan(low):
        grid = np.linspace(-50, 50, 2001)
        assert pair_growth(C_p, C_q, L, grid).max() < 1e-12
        return
    scale = 1 + abs(low) + abs(high)
    assert pair_growth(C_p, C_q, L, low) == pytest.approx(0, abs=1e-12 * scale)
    assert pair_growth(C_p, C_q, L, high) == pytest.approx(0, abs=1e-12 * scale)
    width = high - low
    if width > 1e-6:
        assert pair_growth(C_p, C_q, L, 0.5 * (low + high)) > 0
        for outside in (low - width, low - 0.01 * width, high + 0.01 * width, high + width):
            assert pair_growth(C_p, C_q, L, outside) < 0


@few
@given(decays, decays, products.filter(lambda L: abs(L) + L.real > 0.01))
def test_pair_tip_is_where_the_edges_meet(C_p: float, C_q: float, L: complex) -> None:
    tip = float(pair_tip(C_p, C_q, L))
    assert np.isfinite(pair_edges(C_p, C_q, (1.001 * tip) ** 2 * L)).all()
    assert np.isnan(pair_edges(C_p, C_q, (0.999 * tip) ** 2 * L)).all()


def test_pair_limits() -> None:
    """One or both modes without damping."""
    np.testing.assert_array_equal(pair_edges(0, 0, 4), (-2, 2))
    np.testing.assert_array_equal(pair_edges(0, 0, 0), (0, 0))
    np.testing.assert_array_equal(pair_edges(0, 0, -4), (np.nan, np.nan))
    np.testing.assert_array_equal(pair_edges(0, 0, -4 + 1e-3j), (-np.inf, np.inf))
    np.testing.assert_array_equal(pair_edges(1, 0, 4), (-np.inf, np.inf))
    np.testing.assert_array_equal(pair_edges(1, 0, -4), (np.nan, np.nan))
    np.testing.assert_array_equal(pair_edges(1, 0, 0), (np.nan, np.nan))
    np.testing.assert_array_equal(pair_edges(1, -0.5, 0), (-np.inf, np.inf))
    tips = pair_tip([0, 0, 1, 1], 0, [4, -4, 4, -4])
    np.testing.assert_array_equal(tips, [0, np.inf, 0, np.inf])


@few
@given(decays, products.filter(lambda L: abs(L.imag) > 0.05))
def test_half_damped_pair_with_complex_product_is_unstable_on_one_side(C: float, L: complex) -> None:
    """The limit of both modes damped, and neutral on its one finite edge."""
    low, high = map(float, pair_edges(C, 0, L))
    assert np.isinf(low) != np.isinf(high)
    edge, side = (high, -1) if np.isinf(low) else (low, 1)
    assert pair_growth(C, 0, L, edge) == pytest.approx(0, abs=1e-12)
    assert pair_growth(C, 0, L, edge + side * 0.1) > 0 > pair_growth(C, 0, L, edge - side * 0.1)
    nearly = pair_edges(C, 1e-9, L)
    assert nearly[0 if side == 1 else 1] == pytest.approx(edge, abs=1e-5)


@few
@given(decays, decays, st.floats(0.01, 1))
def test_vanishing_damping_is_the_limit_of_damping(c_p: float, c_q: float, L: float) -> None:
    """And not the undamped result."""
    limit = pair_edges_vanishing(c_p, c_q, L)
    np.testing.assert_allclose(pair_edges(1e-6 * c_p, 1e-6 * c_q, L), limit, rtol=1e-6)
    assert limit[1] == pytest.approx(float((c_p + c_q) / (2 * np.sqrt(c_p * c_q)) * np.sqrt(L)), rel=1e-12)
    assert pair_slope(c_p, c_q, L) == pytest.approx(float(limit[1]), rel=1e-12)
