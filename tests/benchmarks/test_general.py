"""Other systems than eq. (11): what is timed is what is said, and the peer finds the same multipliers."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.general import dop853_between_jumps, general_charts, subjects
from benchmarks.methods import REQUIRED_ERROR, Plan
from floquet import monodromy

TINY = Plan(columns=12, rows=6, sizes=(12,), rounds=(1,), points=2, timed=1)


@pytest.mark.slow
def test_charts_are_verified_and_compared_with_the_like() -> None:
    found = general_charts(TINY)
    assert [one.name.split(",")[0] for one in found[:3]] == ["cosine", "pulsating speed", "rectangular wave"]
    assert all(one.error < REQUIRED_ERROR for one in found)
    assert found[0].ratios == (1.0,)
    assert found[-1].ratios == ()  # a drive is not compared with a plate
    assert all(one.peer_seconds > 0 for one in found)


@pytest.mark.parametrize("place", [1, 2, 6])
def test_dop853_is_given_the_same_task(place: int) -> None:
    """Pulsating speed, a rectangular wave, a gear mesh."""
    subject = subjects(TINY)[place]
    w, e = float(subject.Omega[5]), float(subject.eps[4])
    found = np.linalg.eigvals(dop853_between_jumps(1e-11)(subject.family.at(w), w, e))
    exact = monodromy(subject.family, w, e).multipliers
    assert abs(np.abs(found).max() - np.abs(exact).max()) < 1e-8
    assert abs(found.sum() - exact.sum()) < 1e-7
