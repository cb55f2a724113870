"""Every region of a window: exact edges, names, nothing missed and nothing invented."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import mathieu_a, mathieu_b

from floquet import Kind, trace_regions
from periodic import PeriodicSystem
from periodic.examples import coupled_mathieu, mathieu


def edge_of_mathieu(order: int, sort: str, eps: float) -> float:
    """Edge of the n-th region of x'' + (1 + eps cos Omega t) x = 0: a = 4/Omega^2 is a_n(q) or b_n(q), q = 2
    eps/Omega^2 (DLMF 28.2(v))."""
    characteristic = mathieu_a if sort == "a" else mathieu_b
    return brentq(
        lambda Omega: 4 / Omega**2 - characteristic(order, 2 * eps / Omega**2), 1.4 / order, 3.0 / order, xtol=1e-12
    )


def test_edges_and_names_of_the_regions_of_mathieu() -> None:
    tolerance = 1e-3
    regions = trace_regions(mathieu(), (0.5, 3.0), (0.0, 0.8), tolerance=tolerance, progress=False)
    assert [region.label for region in regions][-2:] == ["2ω₁/2", "2ω₁"]
    for order, region in ((2, regions[-2]), (1, regions[-1])):
        assert region.explained
        kinds = set(region.outlines[0].kind.tolist())
        assert kinds == {Kind.MINUS_ONE if order == 1 else Kind.PLUS_ONE}
        for eps in (0.3, 0.5, 0.75):
            for sort, side in (("a", 1), ("b", -1)):
                edge = edge_of_mathieu(order, sort, eps)
                # outside stays outside, inside stays inside, but for the stated tolerance
                off = 2 * tolerance * 2.5
                inwards = -side if edge_of_mathieu(order, "a", eps) > edge_of_mathieu(order, "b", eps) else side
                assert region.contains(edge + inwards * off, eps)
                assert not region.contains(edge - inwards * off, eps)
