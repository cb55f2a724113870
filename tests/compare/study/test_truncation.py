"""Large models in their lowest modes: no verdict changes, and what is left out is said."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from compare.study import truncation
from compare.study.truncation import MAX_MODE_OVER_OMEGA, MAX_WHOLE_SIZE, lowest_modes
from compare.window import default_window
from floquet import Kind, stability_chart
from periodic import PeriodicSystem
from periodic.examples import coupled_mathieu
from tests.finite_elements import column


def test_modes_far_above_the_window_are_left_out_and_change_no_verdict() -> None:
    system = column(20)
    window, eps = default_window(system)
    small, remark = lowest_modes(system, window, eps)
    assert small.size < 0.5 * system.size
    assert f"the {small.size} lowest of 40 modes" in remark
    frequencies = np.sqrt(np.diag(small.stiffness))
    assert frequencies.max() <= MAX_MODE_OVER_OMEGA * window[1]
    grid = np.linspace(*window, 24), np.linspace(0, eps, 12)
    a, b = (stability_chart(s, *grid, progress=False, audit=0) for s in (system, small))
    decided = (a.kind != Kind.UNDECIDED) & (b.kind != Kind.UNDECIDED)
    assert decided.mean() > 0.9
    np.testing.assert_array_equal(a.kind[decided] > Kind.STABLE, b.kind[decided] > Kind.STABLE)


def test_what_leaving_out_changes_falls_as_more_is_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    # At a small eps: at a large one second-order theory takes more and more neighbours together as modes are added.
    system, eps = column(20), 0.05
    window, _ = default_window(system)
    kept, changes = [], []
    for reach in (1.5, 4.0, 12.0):
        monkeypatch.setattr(truncation, "MAX_MODE_OVER_OMEGA", reach)
        small, remark = lowest_modes(system, window, eps)
        kept.append(small.size)
        changes.append(float(remark.split(" of their frequency")[0].split()[-1]))
    assert kept[0] < kept[1] < kept[2]
    assert changes[0] > changes[1] > changes[2] > 0


def test_a_model_without_theory_is_reduced_all_the_same() -> None:
    # A damper that feeds energy into the second mode: no theory says what leaving out changes.
    system = column(20)
    window, eps = default_window(system)
    shape = np.linalg.eigh(system.stiffness)[1][:, :1]
    driven = replace(system, damping=-shape @ shape.T)
    small, remark = lowest_modes(driven, window, eps)
    assert 0 < small.size < driven.size
    assert remark == f"Integrated are the {small.size} lowest of 40 modes."


@pytest.mark.parametrize(
    "system",
    [
        column(MAX_WHOLE_SIZE // 2),
        coupled_mathieu(),
        PeriodicSystem(np.eye(30), np.zeros((30, 30)), np.zeros((30, 30)), -np.eye(30), [np.eye(30)]),
        PeriodicSystem(np.eye(30), np.zeros((30, 30)), np.zeros((30, 30)), np.diag(np.arange(1.0, 31)), [np.eye(30)]),
    ],
    ids=["small", "tiny", "unstable", "all modes slow"],
)
def test_what_need_not_be_left_out_is_kept(system: PeriodicSystem) -> None:
    assert lowest_modes(system, (1.0, 20.0), 0.1) == (system, "")
