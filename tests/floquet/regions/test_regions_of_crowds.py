"""Regions where many meet: nothing is drawn where little is unstable, and names are those of what is there."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import ArrayLike
from scipy.integrate import solve_ivp

from floquet import Kind, Region, stability_chart, trace_regions
from periodic import PeriodicSystem
from periodic.checks import FloatArray
from periodic.examples import mathieu


def crowded(seed: int, n: int) -> PeriodicSystem:
    """Frequencies close together, all coupled by a strong excitation."""
    rng = np.random.default_rng(seed)
    turn = np.linalg.qr(rng.normal(size=(n, n)))[0]
    K = turn @ np.diag(rng.uniform(1, 9 * n, n)) @ turn.T
    F = rng.normal(size=(n, n))
    return PeriodicSystem(np.eye(n), np.zeros((n, n)), np.zeros((n, n)), (K + K.T) / 2, [F + F.T])


def widest(region: Region) -> tuple[float, float, float]:
    """The left and right edge of the widest level of a region with one outline, and its eps."""
    (loop,) = region.outlines
    found = (0.0, 0.0, 0.0)
    for eps in np.unique(loop.eps)[1:-1]:
        Omega = loop.Omega[loop.eps == eps]
        if Omega.size > 1 and np.ptp(Omega) > found[1] - found[0]:
            found = float(Omega.min()), float(Omega.max()), float(eps)
    return found


@pytest.mark.parametrize(("seed", "window", "top"), [(101, (1.2, 8.4), 0.74), (106, (1.4, 12.0), 0.85)])
def test_what_is_drawn_wide_is_unstable(seed: int, window: tuple[float, float], top: float) -> None:
    system, tolerance = crowded(seed, 10), 1e-3 * (window[1] - window[0])
    seen = 0
    for region in trace_regions(system, window, (0.0, top), progress=False):
        if len(region.outlines) > 1 or len(region.resonances) > 1:
            continue
        low, high, eps = widest(region)
        if high - low > 2 * tolerance:
            seen += 1
            kind = stability_chart(system, np.linspace(low, high, 202)[1:-1], [eps], progress=False, audit=0).kind
            assert (kind > Kind.STABLE).mean() > 0.4, region.label
    assert seen >= 2


def oscillators(stiffness: ArrayLike, excitation: ArrayLike) -> PeriodicSystem:
    K = np.diag(np.asarray(stiffness, dtype=float))
    zero = np.zeros_like(K)
    return PeriodicSystem(np.eye(len(K)), zero, zero, K, [np.diag(np.asarray(excitation, dtype=float))])


@pytest.mark.parametrize("top", [0.1, 0.5, 1.0])
@pytest.mark.parametrize("excitation", [(1.0, 1.0), (1.0, 0.3), (0.3, 1.0)])
def test_of_two_that_start_together_the_wider_one_gives_the_name(excitation: ArrayLike, top: float) -> None:
    # 2 omega_1 and 2 omega_2 / 2 are the same frequency; the second region is of second order
    regions = trace_regions(oscillators((1.0, 4.0), excitation), (1.5, 4.5), (0.0, top), progress=False)
    assert [region.label for region in regions] == ["2ω₁", "2ω₂"]


def test_a_higher_harmonic_opens_its_resonance_at_eps_zero() -> None:
    system = PeriodicSystem([[1.0]], [[0.0]], [[0.0]], [[1.0]], [[[1.0]], [[0.0]], [[-0.5]]])
    tips = {region.label: region.tip for region in trace_regions(system, (0.5, 3.0), (0.0, 0.5), progress=False)}
    assert tips["2ω₁/3"] == pytest.approx((2 / 3, 0.0), abs=1e-6)


def edges_by_integration(system: PeriodicSystem, Omega: FloatArray, eps: float) -> FloatArray:
    """Where a scan along ``Omega`` changes between stable and unstable: DOP853, then the multipliers."""
    M, K = np.linalg.inv(system.mass), system.stiffness

    def growth(w: float) -> float:
        def rate(t: float, y: FloatArray) -> FloatArray:
            x, v = y.reshape(2, system.size, -1)
            force = (K + eps * np.cos(w * t) * system.cosine[0]) @ x + system.damping @ v
            return np.concatenate([v, -M @ force]).ravel()

        start = np.eye(2 * system.size).ravel()
        end = solve_ivp(rate, (0, 2 * np.pi / w), start, "DOP853", rtol=1e-11, atol=1e-13).y[:, -1]
        return float(np.log(np.abs(np.linalg.eigvals(end.reshape(2 * system.size, -1))).max()))

    values = np.array([growth(float(w)) for w in Omega])
    return (Omega[1:] + Omega[:-1])[(values[1:] > 0) != (values[:-1] > 0)] / 2


def test_a_narrow_gap_between_two_regions_has_no_islands() -> None:
    # near the place where 2ω₁ and ω₁+ω₂ grow together, the gap between them is narrower in eps than an 80th
    one = np.eye(2)
    system = PeriodicSystem(one, 0 * one, 0.02 * one, np.diag([1.0, 1.5]), [[[1.0, 0.5], [0.5, 1.0]]])
    window, top = (1.6, 2.8), 0.45
    regions = trace_regions(system, window, (0.0, top), progress=False)
    assert [len(region.outlines) for region in regions] == [1, 1]
    for eps in (0.38, 0.4):
        Omega = np.linspace(2.15, 2.22, 71)
        left, right = edges_by_integration(system, Omega, eps)
        inside = np.any([region.contains(Omega, eps) for region in regions], axis=0)
        found = (Omega[1:] + Omega[:-1])[inside[1:] != inside[:-1]] / 2
        assert found == pytest.approx([left, right], abs=1e-3 * (window[1] - window[0]))


@pytest.mark.parametrize("damping", [0.0, 0.05])
def test_stable_strips_of_an_inverted_pendulum_are_not_bridged(damping: float) -> None:
    # x'' + damping x' + (-0.24 + eps cos Omega t) x = 0: narrower in eps than an 80th of the window at low Omega
    system, top = mathieu(-0.24, damping=damping), 5.0
    regions = trace_regions(system, (0.6, 4.0), (0.0, top), progress=False)
    for Omega in (0.8, 1.0, 1.3, 2.0):
        eps = np.linspace(0.0, top, 2002)[1:-1]
        kind = stability_chart(system, [Omega], eps, progress=False, audit=0).kind[:, 0]
        inside = np.any([region.contains(Omega, eps) for region in regions], axis=0)
        assert ((kind == Kind.STABLE) & ~inside).sum() > 2
        edge = np.flatnonzero((kind[1:] > Kind.STABLE) != (kind[:-1] > Kind.STABLE))
        wrong = np.flatnonzero((kind > Kind.STABLE) != inside)
        assert (np.abs(wrong[:, None] - edge).min(axis=1) <= 3).all()  # 1.5e-3 of the window


ONE, ZERO = np.eye(2), np.zeros((2, 2))
TURN = np.array([[np.cos(0.3), -np.sin(0.3)], [np.sin(0.3), np.cos(0.3)]])
TURNED = TURN @ np.diag([1.5, 0.5]) @ TURN.T
# a simply supported square plate, modes (1, 1), (1, 2), (2, 1), (2, 2)
SQUARE = np.pi**2 * np.array([2.0, 5.0, 5.0, 8.0])


@pytest.mark.parametrize(
    ("system", "centre", "eps", "edges", "labels"),
    [
        # the slopes are 3/4 and 1/4: eigenvalues of the excitation over 2 omega
        (PeriodicSystem(ONE, ZERO, ZERO, ONE, [TURNED]), 2.0, 0.1, (1.92434, 2.07427), {"2ω₁", "2ω₂"}),
        (PeriodicSystem(ONE, ZERO, 0.02 * ONE, ONE, [TURNED]), 2.0, 0.1, None, {"2ω₁", "2ω₂"}),
        (
            PeriodicSystem(ONE, ZERO, 0.02 * np.diag([1.0, 2.0]), ONE, [TURNED]),
            2.0,
            0.1,
            None,
            {"2ω₁", "ω₁+ω₂", "2ω₂"},
        ),
        (PeriodicSystem(ONE, ZERO, ZERO, np.diag([1.0, 1.0001]), [TURNED]), 2.0, 0.1, None, {"2ω₁", "ω₁+ω₂", "2ω₂"}),
        (
            PeriodicSystem(
                np.eye(4),
                np.zeros((4, 4)),
                np.zeros((4, 4)),
                np.diag(SQUARE**2),
                [-0.3 * 4 * np.pi**4 * np.diag([1.0, 1.0, 4.0, 4.0])],
            ),
            98.696,
            0.4,
            (96.792, 100.582),
            {"2ω₂", "2ω₃"},
        ),
    ],
    ids=["turned", "turned, damped", "damped unequally", "nearly equal", "square plate"],
)
def test_resonances_of_one_frequency_have_one_region_with_all_their_names(
    system: PeriodicSystem, centre: float, eps: float, edges: tuple[float, float] | None, labels: set[str]
) -> None:
    window = (0.85 * centre, 1.15 * centre)
    (region,) = trace_regions(system, window, (0.0, 1.5 * eps), progress=False)
    assert {one.label for one in region.resonances} == labels
    Omega = np.linspace(*window, 241)
    low, high = edges or edges_by_integration(system, Omega, eps)
    inside = Omega[region.contains(Omega, eps)]
    assert [inside[0], inside[-1]] == pytest.approx(
        [low, high], abs=2e-3 * (window[1] - window[0]) + Omega[1] - Omega[0]
    )


@pytest.mark.parametrize(("stiffness", "damping"), [((1.0, 1.6), (-0.06, 0.06)), ((1.0, 4.0), (-0.01, 0.3))])
def test_what_is_unstable_without_excitation_has_no_names_and_its_stable_windows_are_right(
    stiffness: tuple[float, float], damping: tuple[float, float]
) -> None:
    # an anti-resonance: excitation at omega_2 - omega_1 lets the damped mode quench the other
    zero = np.zeros((2, 2))
    system = PeriodicSystem(np.eye(2), zero, np.diag(damping), np.diag(stiffness), [[[0.0, 1.0], [1.0, 0.0]]])
    window = (0.1, 1.5)
    regions = trace_regions(system, window, (0.0, 0.9), progress=False)
    assert {region.label for region in regions} == {""}
    chart = stability_chart(
        system, np.linspace(*window, 142)[1:-1], np.linspace(0, 0.9, 62)[1:-1], progress=False, audit=0
    )
    inside = np.any([region.contains(chart.Omega, chart.eps[:, None]) for region in regions], axis=0)
    assert ((chart.kind > Kind.STABLE) != inside).mean() < 2e-3
