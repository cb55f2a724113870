"""`trace_boundary` on Mathieu's equation, whose edges are known: by its characteristic values and by series."""

from __future__ import annotations

import math

import numpy as np
import pytest
import scipy.linalg as sla
from scipy.optimize import brentq
from scipy.special import mathieu_a, mathieu_b

from floquet import Kind, trace_boundary
from periodic.examples import mathieu
from tests.floquet.oracle_systems import dop853


def characteristic(n: int, q: float, odd: bool) -> float:
    """a_n(q), or b_n(q) if ``odd``: eigenvalues of tridiagonal matrices (DLMF 28.4, from the Fourier series)."""
    size = 40 + int(abs(q))
    if n % 2:
        diagonal = (2.0 * np.arange(size) + 1) ** 2
        diagonal[0] += -q if odd else q
        off = np.full(size - 1, float(q))
        index = n // 2
    else:
        diagonal = (2.0 * np.arange(size)) ** 2
        off = np.full(size - 1, float(q))
        off[0] *= math.sqrt(2)
        if odd:
            diagonal, off = diagonal[1:], off[1:]
        index = n // 2 - odd
    return sla.eigh_tridiagonal(diagonal, off, eigvals_only=True, select="i", select_range=(index, index))[0]


def mathieu_edge(delta: float, eps: float, n: int, odd: bool, bracket: tuple[float, float]) -> float:
    """Omega at which x'' + (delta + eps cos Omega t) x = 0 has the solution that b_n (``odd``) or a_n belongs to."""

    def mismatch(Omega: float) -> float:
        return characteristic(n, 2 * eps / Omega**2, odd) - 4 * delta / Omega**2

    return brentq(mismatch, *bracket, xtol=1e-14)


def test_the_oracle_for_mathieu() -> None:
    for n in (1, 2, 3, 4):
        for q in (0.3, 2.0, 5.0):
            assert characteristic(n, q, odd=False) == pytest.approx(mathieu_a(n, q), rel=1e-11)
            assert characteristic(n, q, odd=True) == pytest.approx(mathieu_b(n, q), rel=1e-11)


@pytest.mark.parametrize(
    ("n", "eps", "kind"),
    [
        (1, [1e-6, 1e-3, 0.1, 0.5, 1.0, 2.0, 4.0, 5.0, 10.0], Kind.MINUS_ONE),
        (2, [1e-2, 0.1, 0.5, 1.5, 3.0, 10.0], Kind.PLUS_ONE),
        (3, [0.005, 0.05, 0.3, 1.5, 3.0, 5.0], Kind.MINUS_ONE),  # the first is 1e-8 wide
        (4, [0.3, 1.0, 2.0, 5.0], Kind.PLUS_ONE),
    ],
)
def test_edges_of_mathieu(n: int, eps: list[float], kind: Kind) -> None:
    trace = trace_boundary(mathieu(), 2 / n, eps)
    assert trace.is_open.all()
    assert (trace.kind == kind).all()
    assert (trace.resonance.p, trace.resonance.q, trace.resonance.j, trace.resonance.type) == (1, 1, n, "sum")
    for i, e in enumerate(eps):
        # a_n > b_n: the lower edge belongs to a_n
        for found, error, odd in (
            (trace.lower[i], trace.lower_error[i], False),
            (trace.upper[i], trace.upper_error[i], True),
        ):
            exact = mathieu_edge(1.0, e, n, odd, (found * (1 - 1e-6), found * (1 + 1e-6)))
            assert found == pytest.approx(exact, rel=1e-9)
            assert abs(found - exact) <= 3 * error + 1e-13
            assert error < 1e-8 * found


def test_edges_of_mathieu_agree_with_scipy() -> None:
    eps = np.array([0.2, 1.0, 5.0])
    trace = trace_boundary(mathieu(1.7), 2 * math.sqrt(1.7), eps)
    q = 2 * eps / trace.lower**2
    assert (q <= 5).all()
    assert 4 * 1.7 / trace.lower**2 == pytest.approx(mathieu_a(1, q), rel=1e-8)
    q = 2 * eps / trace.upper**2
    assert 4 * 1.7 / trace.upper**2 == pytest.approx(mathieu_b(1, q), rel=1e-8)


def test_width_of_mathieu_tongues_shrinks_with_their_order() -> None:
    # the width of the n-th tongue is of order eps^n (Arnold, Mathematical Methods of Classical Mechanics, section 25)
    eps = np.array([0.05, 0.1, 0.2])
    for n in (1, 2, 3):
        trace = trace_boundary(mathieu(), 2 / n, eps)
        order = np.polyfit(np.log(eps), np.log(trace.upper - trace.lower), 1)[0]
        assert order == pytest.approx(n, abs=0.01)


def test_second_tongue_of_mathieu_against_its_series() -> None:
    # y'' + (d + e cos t) y = 0 near d = 1: d = 1 + 5 e^2 / 12 and d = 1 - e^2 / 12, up to O(e^4) (A. H. Nayfeh and
    # D. T. Mook, Nonlinear Oscillations, 1979, section 5.3); here d = 1 / Omega^2, e = eps / Omega^2
    for eps in (0.02, 0.04):
        trace = trace_boundary(mathieu(), 1.0, eps)
        for Omega, coefficient in ((trace.lower[0], 5 / 12), (trace.upper[0], -1 / 12)):
            e = eps / Omega**2
            assert 1 / Omega**2 == pytest.approx(1 + coefficient * e**2, abs=2 * e**4)


def test_damped_mathieu() -> None:
    # x = y exp(-c t / 2): the edge is where the undamped trace is -2 cosh(c T / 2), that of the damped system, which
    # DOP853 integrates, -(1 + exp(-c T))
    c, eps = 0.05, np.array([0.08, 0.099, 0.12, 0.5])
    trace = trace_boundary(mathieu(1.0, c), 2.0, eps)
    assert trace.is_open.tolist() == [False, False, True, True]  # the tip is at 2 omega c = 0.1 to first order
    assert np.isnan(trace.lower[:2]).all()
    assert np.isnan(trace.upper_error[:2]).all()
    assert (trace.kind == [Kind.STABLE, Kind.STABLE, Kind.MINUS_ONE, Kind.MINUS_ONE]).all()

    def excess(Omega: float, e: float) -> float:
        return np.trace(dop853(mathieu(1.0, c), Omega, e)) + 1 + math.exp(-c * 2 * np.pi / Omega)

    for i in (2, 3):
        for found, error in ((trace.lower[i], trace.lower_error[i]), (trace.upper[i], trace.upper_error[i])):
            exact = brentq(excess, found - 1e-4, found + 1e-4, args=(eps[i],), xtol=1e-13)
            assert found == pytest.approx(exact, rel=1e-9)
            assert abs(found - exact) <= 3 * error + 1e-11
            # to first order Omega = 2 ± sqrt((eps / 2)^2 - c^2), next to it a shift of order eps^2
            assert abs(found - 2) == pytest.approx(math.sqrt((eps[i] / 2) ** 2 - c**2), abs=0.2 * eps[i] ** 2)


@pytest.mark.parametrize("n", [2, 3, 4])
def test_a_little_damping_moves_edges_a_little_where_gaps_between_regions_are_narrow(n: int) -> None:
    eps = [2.0, 3.0]
    elastic, damped = (trace_boundary(mathieu(1.0, c), 2 / n, eps) for c in (0.0, 1e-4))
    assert damped.lower == pytest.approx(elastic.lower, rel=1e-6)
    assert damped.upper == pytest.approx(elastic.upper, rel=1e-6)


def test_tip_of_damped_mathieu() -> None:
    c = 0.02
    tip = 2 * c  # to first order, with a correction of order c^3
    trace = trace_boundary(mathieu(1.0, c), 2.0, tip * np.array([0.99, 0.999, 1.001, 1.01]))
    assert trace.is_open.tolist() == [False, False, True, True]
    # the region ends in a parabola: widths go like the square root of the distance from the tip
    width = trace.upper - trace.lower
    assert width[3] / width[2] == pytest.approx(math.sqrt(10), rel=0.1)
