"""Proofs of charts go on where they were stopped; what is kept is what would be found."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from periodic import PeriodicSystem

pytest.importorskip("flint", reason="python-flint, the extra certify, is not installed")

from floquet.certified import ProvedChart, prove_chart
from floquet.certified.areas import keeping

# Two oscillators that nothing couples: two subsystems, each with pieces of its own.
SYSTEM = PeriodicSystem(np.eye(2), stiffness=np.diag([1.0, 1.7]), cosine=np.diag([1.0, 0.5]))
WINDOW: Any = (SYSTEM, (1.8, 3.0), (0.0, 0.4))


def proved(cache: Path | None, **options: Any) -> ProvedChart:
    return prove_chart(*WINDOW, least=1 / 32, n_jobs=1, progress=False, cache=cache, **options)


def same(a: ProvedChart, b: ProvedChart) -> None:
    for one, other in zip(a.parts, b.parts, strict=True):
        for name, value in one._asdict().items():
            np.testing.assert_array_equal(value, getattr(other, name), err_msg=name)


def test_what_is_kept_is_not_proved_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    without, first = proved(None), proved(tmp_path / "kept")
    same(without, first)
    kept = sorted((tmp_path / "kept").iterdir())
    assert len(kept) > 2
    searched: list[Any] = []
    search = keeping.search

    def counted(*arguments: Any) -> Any:
        searched.append(arguments)
        return search(*arguments)

    monkeypatch.setattr(keeping, "search", counted)
    same(without, proved(tmp_path / "kept"))
    assert not searched
    kept[0].write_bytes(kept[0].read_bytes()[:100])  # a damaged piece
    kept[1].unlink()
    same(without, proved(tmp_path / "kept"))
    assert len(searched) == 2


def test_what_time_ended_is_not_kept(tmp_path: Path) -> None:
    assert proved(tmp_path, seconds=1e-9).proved_fraction == 0
    assert not list(tmp_path.iterdir())
    assert proved(tmp_path).proved_fraction > 0.99


def test_a_cache_that_is_no_folder(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(ValueError, match=r"cache = .*file.* is no folder"):
        proved(tmp_path / "file")
