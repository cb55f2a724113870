"""Charts of random systems of every kind against points and DOP853: a few always, two thousand in `make test-full`."""

from __future__ import annotations

import numpy as np
import pytest

from floquet import Kind
from tests.hunt.charts import contradict, examine, is_fault, summary


@pytest.mark.parametrize("seed", range(5))
def test_chart_point_and_dop853_agree(seed: int) -> None:
    found = examine(seed, with_dop853=True)
    assert not is_fault(found), summary([found])
    assert np.isfinite(found.dop853)


def test_what_is_a_fault() -> None:
    assert contradict(Kind.STABLE, Kind.COMPLEX)
    assert contradict(Kind.PLUS_ONE, Kind.STABLE)
    assert not contradict(Kind.UNDECIDED, Kind.STABLE)
    good = examine(1, with_dop853=False)
    assert not is_fault(good)
    for change in ({"wrong": 1}, {"difference": 1e-8}, {"ratio": 4.0}, {"dop853_ratio": 4.0}):
        assert is_fault(good._replace(**change))


@pytest.mark.slow
def test_two_thousand_systems() -> None:
    found = [examine(seed, with_dop853=seed % 50 < 5) for seed in range(2000)]
    assert not any(map(is_fault, found)), summary(found)
