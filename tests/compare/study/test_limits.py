"""How far a theory holds, against Mathieu's equation, whose edges are known in closed form."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import mathieu_a, mathieu_b

from compare.study import validity
from floquet import BoundaryTrace, trace_boundary
from periodic.examples import mathieu
from perturb import transition_curves

EPS = np.linspace(0.05, 1.2, 24)


def _exact_edges(eps: float) -> tuple[float, float]:
    """Edges in Omega of the main region of x'' + (1 + eps cos Omega t) x = 0: a = 4/Omega^2 on a_1(q) and b_1(q)."""
    lower = brentq(lambda w: 4 / w**2 - mathieu_a(1, 2 * eps / w**2), 0.9, 2.5)
    upper = brentq(lambda w: 4 / w**2 - mathieu_b(1, 2 * eps / w**2), 1.5, 3.5)
    return lower, upper


@pytest.fixture(scope="module")
def trace() -> BoundaryTrace:
    return trace_boundary(mathieu(), 2.0, EPS)


@pytest.mark.parametrize("order", [1, 2])
def test_limits_are_where_the_exact_edge_leaves_the_curve(trace: BoundaryTrace, order: int) -> None:
    (curve,) = [c for c in transition_curves(mathieu(), (1.9, 2.1), order=order) if c.j == 1]

    def deviation(eps: float) -> float:
        exact, theory = np.array(_exact_edges(eps)), np.array([float(edge) for edge in curve.edges(eps)])
        return float(np.abs(exact - theory).max() / (exact[1] - exact[0]))

    for limit in validity(curve, trace):
        if limit.to_the_end:
            assert deviation(EPS[-1]) <= limit.tolerance
        else:
            wanted = brentq(lambda e, t=limit.tolerance: deviation(e) - t, 1e-3, 1.2)
            assert limit.last == pytest.approx(wanted, abs=(EPS[1] - EPS[0]) ** 2)
        assert limit.first == 0


def test_second_order_reaches_further_than_first(trace: BoundaryTrace) -> None:
    first, second = (
        validity(next(c for c in transition_curves(mathieu(), (1.9, 2.1), order=m) if c.j == 1), trace) for m in (1, 2)
    )
    # At 5 and 10 per cent the lower edge of first order bends back to the exact one by chance, beyond eps = 1.
    assert second[0].last > 2 * first[0].last
    assert str(first[0]).startswith("first order holds to eps = 0.")


def test_a_damped_region_counts_from_its_tip() -> None:
    system = mathieu(damping=0.1)
    (curve,) = transition_curves(system, (1.9, 2.1))
    trace = trace_boundary(system, 2.0, np.linspace(0.05, 1.0, 20))
    limit = validity(curve, trace)[2]
    assert curve.tip < limit.first < limit.last
    assert "from eps" in str(limit)


def test_a_closed_region_holds_nowhere() -> None:
    system = mathieu(damping=0.1)
    (curve,) = transition_curves(system, (1.9, 2.1))
    limit = validity(curve, trace_boundary(system, 2.0, [0.05, 0.1]))[0]
    assert np.isnan(limit.last)
    assert "nowhere" in str(limit)


def test_bad_tolerances_are_refused(trace: BoundaryTrace) -> None:
    (curve,) = transition_curves(mathieu(), (1.9, 2.1))
    with pytest.raises(ValueError, match="tolerances"):
        validity(curve, trace, (0.0,))
