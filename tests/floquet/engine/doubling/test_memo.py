"""Results that are kept, but not more of them than there is memory for."""

from __future__ import annotations

import numpy as np
import pytest

import floquet.engine.doubling.memo
from floquet.engine.doubling.memo import memoized


def test_a_result_is_computed_once() -> None:
    calls = []

    @memoized
    def squares(n: int) -> tuple[np.ndarray, int] | None:
        calls.append(n)
        return (np.arange(n) ** 2, n) if n > 0 else None

    assert squares(3) is squares(3)
    assert squares(0) is None
    assert squares(0) is None
    assert calls == [3, 0]


def test_results_are_dropped_when_they_are_too_many(monkeypatch: pytest.MonkeyPatch) -> None:
    calls = []

    @memoized
    def zeros(n: int) -> np.ndarray:
        calls.append(n)
        return np.zeros(1000 + n)

    monkeypatch.setattr(floquet.engine.doubling.memo, "MAX_MEMO_BYTES", 30_000)  # three of them
    for n in (1, 2, 3, 3, 4, 4, 1):
        assert len(zeros(n)) == 1000 + n
    assert calls == [1, 2, 3, 4, 1]
    for n in range(10, 60):  # as long as it takes to fill any store without a bound
        zeros(n)
    contents = [cell.cell_contents for cell in getattr(zeros, "__closure__", ())]
    assert sum(len(kept) for kept in contents if isinstance(kept, dict)) <= 3
