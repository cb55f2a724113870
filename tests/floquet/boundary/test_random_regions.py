"""What `trace_boundary` says of random systems, held against DOP853."""

from __future__ import annotations

import numpy as np
import pytest

from floquet import BoundaryTrace, Kind, trace_boundary
from floquet.boundary import natural_modes
from periodic import PeriodicSystem
from tests.floquet.oracle_systems import dop853

FEW, MANY = 12, 300
SORTS = ("plain", "damped", "repeated", "near", "gyroscopic", "unsymmetric", "two harmonics", "strong damping")
# A growth of one period that DOP853 cannot tell from none: next to an edge the root of its error without damping.
FAINT_DAMPED, FAINT_UNDAMPED = 1e-9, 3e-6


def random_case(seed: int) -> tuple[str, PeriodicSystem, float, float]:
    """Return a sort, a system of it, a sum resonance of its modes and an amplitude."""
    random = np.random.default_rng(seed)
    sort, size = SORTS[seed % len(SORTS)], int(random.integers(2, 4))
    frequencies = np.sort(random.uniform(1.0, 2.5, size))
    if sort in ("repeated", "near"):
        frequencies[1] = frequencies[0] * (1 + (0 if sort == "repeated" else 10 ** random.uniform(-5, -2)))
    turn, _ = np.linalg.qr(random.normal(size=(size, size)))
    K = turn @ np.diag(frequencies**2) @ turn.T
    loads = random.normal(size=(2 if sort == "two harmonics" else 1, size, size))
    if sort != "unsymmetric":
        loads = loads + loads.transpose(0, 2, 1)
    G = np.zeros((size, size))
    if sort == "gyroscopic":
        G = random.normal(size=(size, size))
        G = 0.5 * (G - G.T)
    damping = {"plain": 0.0, "gyroscopic": 0.0, "repeated": 0.0, "strong damping": 0.1}.get(sort, 0.01)
    system = PeriodicSystem(np.eye(size), G, damping * np.diag(random.uniform(0.5, 1.5, size)), K, loads)
    omega = natural_modes(system, 2.0).exponents.imag
    p, q = random.integers(0, len(omega), 2)
    return sort, system, float(omega[p] + omega[q]), float(10 ** random.uniform(-1.5, -0.4))


def growth(system: PeriodicSystem, Omega: float, eps: float) -> float:
    return float(np.log(np.abs(np.linalg.eigvals(dop853(system, Omega, eps))).max()))


def wrong_statements(system: PeriodicSystem, trace: BoundaryTrace) -> tuple[int, list[str]]:
    """Return how many statements of a trace were checked, and those that DOP853 contradicts."""
    eps, checked, wrong = float(trace.eps[0]), 0, []
    faint = FAINT_DAMPED if system.damping.any() else FAINT_UNDAMPED
    for low, high in trace.intervals[0]:
        if not (np.isfinite(low) and np.isfinite(high)) or high - low < 1e-5 * low:
            continue
        inside = [low * (1 + 1e-6), high * (1 - 1e-6), *np.linspace(low, high, 9)[1:-1]]
        outside = [low * (1 - 1e-6), high * (1 + 1e-6)]
        for Omega, unstable in [(x, True) for x in inside] + [(x, False) for x in outside]:
            checked += 1
            found = growth(system, float(Omega), eps)
            if (found > faint) != unstable:
                wrong.append(f"{'unstable' if unstable else 'stable'} at Omega = {Omega!r}: {found:.3g}")
    if trace.kind[0] == Kind.STABLE and not trace.covered[0]:
        checked += 1
        if growth(system, trace.resonance.centre, eps) > faint:
            wrong.append(f"closed, but unstable at its centre {trace.resonance.centre!r}")
    return checked, wrong


@pytest.mark.parametrize("count", [FEW, pytest.param(MANY, marks=pytest.mark.slow)])
def test_statements_about_random_systems(count: int) -> None:
    checked, withheld, wrong = 0, 0, []
    for seed in range(count):
        sort, system, near, eps = random_case(seed)
        trace = trace_boundary(system, near, [eps])
        number, found = wrong_statements(system, trace)
        checked += number
        wrong += [f"{sort}, seed {seed}, eps = {eps:.4g}: {one}" for one in found]
        withheld += int(trace.kind[0] == Kind.UNDECIDED or trace.covered[0])
    assert not wrong, "\n".join(wrong)
    assert checked > 4 * count
    assert withheld <= max(1, 0.05 * count), f"{withheld} of {count} withheld"
