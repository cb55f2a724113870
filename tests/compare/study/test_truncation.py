"""Large models in their lowest modes: no verdict changes, and what is left out is said."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from compare.study.truncation import lowest_modes
from compare.window import default_window
from floquet import Kind, monodromy, stability_chart
from periodic import PeriodicSystem
from periodic.examples import coupled_mathieu
from reduction.reduced import MODES_OVER_OMEGA
from tests.finite_elements import column


def reduced(system: PeriodicSystem, window: tuple[float, float], eps: float) -> tuple[PeriodicSystem, str]:
    small, remark = lowest_modes(system, window, eps)
    assert isinstance(small, PeriodicSystem)
    return small, remark


def test_modes_far_above_the_window_are_left_out_and_change_no_verdict() -> None:
    system = column(20)
    window, eps = default_window(system)
    small, remark = reduced(system, window, eps)
    assert small.size < 0.5 * system.size
    assert f"the {small.size} lowest of 40 modes" in remark
    assert np.sqrt(np.diag(small.stiffness)).max() <= MODES_OVER_OMEGA * window[1]
    grid = np.linspace(*window, 12), np.linspace(0, eps, 4)
    a, b = (stability_chart(s, *grid, progress=False, audit=0) for s in (system, small))
    decided = (a.kind != Kind.UNDECIDED) & (b.kind != Kind.UNDECIDED)
    assert decided.mean() > 0.9
    np.testing.assert_array_equal(a.kind[decided] > Kind.STABLE, b.kind[decided] > Kind.STABLE)


@pytest.mark.parametrize("stiffness", [1e8, 1e10])
def test_a_penalty_spring_is_left_out_however_small_the_model(stiffness: float) -> None:
    K = np.diag([1.0, 3.0, 0.0]) + stiffness * np.outer([0, 0.1, 1], [0, 0.1, 1])
    F = np.array([[1.0, 0.5, 0.2], [0.5, 1.0, 0.1], [0.2, 0.1, 1.0]])
    system = PeriodicSystem(np.eye(3), damping=0.01 * np.eye(3), stiffness=K, cosine=F)
    small, remark = reduced(system, (1.0, 4.0), 0.3)
    assert small.size == 2
    assert remark.startswith("Integrated are the 2 lowest of 3 modes; the others move edges of regions by ")
    # the constraint itself: x_3 = -0.1 x_2
    T = np.array([[1.0, 0.0], [0.0, 1.0], [0.0, -0.1]])
    held = system.restricted(T)
    for Omega in (2.0, 2.75, 3.4):
        rate = monodromy(held, Omega, 0.3).growth_rate
        assert monodromy(small, Omega, 0.3).growth_rate == pytest.approx(rate, abs=100 / stiffness)


def test_a_model_without_theory_is_reduced_all_the_same() -> None:
    # a damper that feeds energy into the second mode
    system = column(20)
    window, eps = default_window(system)
    shape = np.linalg.eigh(system.stiffness)[1][:, :1]
    driven = replace(system, damping=-shape @ shape.T)
    small, remark = reduced(driven, window, eps)
    assert 0 < small.size < driven.size
    assert remark.startswith(f"Integrated are the {small.size} lowest of 40 modes; ")


@pytest.mark.parametrize(
    "system",
    [
        column(4),
        coupled_mathieu(),
        PeriodicSystem(np.eye(30), np.zeros((30, 30)), np.zeros((30, 30)), -np.eye(30), [np.eye(30)]),
        PeriodicSystem(np.eye(30), np.zeros((30, 30)), np.zeros((30, 30)), np.diag(np.arange(1.0, 31)), [np.eye(30)]),
    ],
    ids=["small", "tiny", "unstable", "all modes slow"],
)
def test_what_need_not_be_left_out_is_kept(system: PeriodicSystem) -> None:
    assert lowest_modes(system, (1.0, 20.0), 0.1) == (system, "")
