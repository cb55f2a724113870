"""Unstable intervals of one column: exact edges, though they bend between two amplitudes, and narrow gaps."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import mathieu_a, mathieu_b

from floquet.regions.scan import Scan
from floquet.regions.window import Window
from periodic.checks import FloatArray
from periodic.examples import mathieu


def exact_edges(delta: float, Omega: float, top: float) -> FloatArray:
    """Edges in eps of x'' + (delta + eps cos Omega t) x = 0: a = 4 delta / Omega^2 is a_n(q) or b_n(q), q = 2 eps /
    Omega^2 (DLMF 28.2(v))."""
    a, q = 4 * delta / Omega**2, 2 * np.linspace(1e-6, top, 4000) / Omega**2
    exact = []
    for characteristic, orders in ((mathieu_a, range(12)), (mathieu_b, range(1, 12))):
        for n in orders:
            off = characteristic(n, q) - a
            for i in np.flatnonzero(off[1:] * off[:-1] < 0):
                root = brentq(lambda x, n=n, f=characteristic: f(n, x) - a, q[i], q[i + 1], xtol=1e-13)
                exact.append(root * Omega**2 / 2)
    return np.sort(exact)


@pytest.mark.parametrize(("delta", "top"), [(-0.24, 5.0), (0.05, 5.0), (1.0, 8.0)])
def test_edges_are_exact_within_the_tolerance_and_gaps_are_seen_down_to_it(delta: float, top: float) -> None:
    scan = Scan(Window(mathieu(delta), (0.6, 4.0), (0.0, top)))
    frequencies = np.linspace(0.61, 1.18, 12)
    scan.add(frequencies)
    count = 0
    for Omega in frequencies.tolist():
        exact = exact_edges(delta, Omega, top)
        found = np.array([end for one in scan.columns[Omega] for end in one[:2] if 0 < end < top])
        distance = np.abs(found[:, None] - exact)
        assert (distance.min(axis=1) < 0.7e-3 * top).all()
        gaps = np.diff(exact, prepend=-np.inf, append=np.inf)
        clear = np.minimum(gaps[1:], gaps[:-1]) > 1e-3 * top
        assert (distance.min(axis=0)[clear] < 0.7e-3 * top).all()
        count += clear.sum()
    assert count > 20
