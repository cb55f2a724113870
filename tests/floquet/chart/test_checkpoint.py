"""A chart that was stopped goes on where it was, and ends with the same bits."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from floquet import StabilityChart, stability_chart
from floquet.chart import filling as chart_module
from periodic.examples import coupled_mathieu, mathieu

OMEGA, EPS = np.linspace(0.7, 5.0, 40), np.linspace(0.0, 1.0, 12)
NAMES = ("growth_rate", "multiplier", "kind", "error")

# Batches slowed down, so that a kill falls between the first and the last of them.
CHILD = """
import sys, time
import numpy as np
from floquet import stability_chart
from floquet.chart import filling
from periodic.examples import coupled_mathieu
whole = filling.chart_batch
def slow(*arguments):
    time.sleep(0.05)
    return whole(*arguments)
filling.chart_batch = slow
stability_chart(coupled_mathieu(), np.linspace(0.7, 5.0, 40), np.linspace(0.0, 1.0, 12), n_jobs=1, progress=False,
                audit=0, cache=sys.argv[1])
"""


def _chart(**options: Any) -> StabilityChart:
    return stability_chart(coupled_mathieu(), OMEGA, EPS, n_jobs=1, progress=False, audit=0, **options)


def _same(a: StabilityChart, b: StabilityChart) -> bool:
    return all(np.array_equal(getattr(a, name), getattr(b, name)) for name in NAMES)


@pytest.fixture
def counted(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Count the tiles that are computed."""
    calls: list[int] = []
    whole = chart_module.chart_batch

    def tile(*arguments: Any) -> object:
        calls.append(1)
        return whole(*arguments)

    monkeypatch.setattr(chart_module, "chart_batch", tile)
    return calls


def test_a_second_call_computes_nothing(tmp_path: Path, counted: list[int]) -> None:
    plain = _chart()
    tiles = len(counted)
    first = _chart(cache=tmp_path)
    assert len(counted) == 2 * tiles
    second = _chart(cache=tmp_path)
    assert len(counted) == 2 * tiles
    assert _same(plain, first)
    assert _same(plain, second)


def test_another_input_is_another_tile(tmp_path: Path, counted: list[int]) -> None:
    _chart(cache=tmp_path)
    tiles = len(counted)
    stability_chart(mathieu(), OMEGA, EPS, n_jobs=1, progress=False, audit=0, cache=tmp_path)
    stability_chart(coupled_mathieu(), OMEGA, EPS[:-1], n_jobs=1, progress=False, audit=0, cache=tmp_path)
    stability_chart(coupled_mathieu(), 1.01 * OMEGA, EPS, n_jobs=1, progress=False, audit=0, cache=tmp_path)
    assert len(counted) == 4 * tiles
    # an amplitude that decides nothing about the steps
    others = np.concatenate([EPS[:10], [0.99 * EPS[10]], EPS[11:]])
    stability_chart(coupled_mathieu(), OMEGA, others, n_jobs=1, progress=False, audit=0, cache=tmp_path)
    assert len(counted) == 5 * tiles


@pytest.mark.parametrize("damage", ["truncated", "flipped", "empty", "gone"])
def test_a_damaged_tile_is_noticed_and_computed_again(tmp_path: Path, counted: list[int], damage: str) -> None:
    whole = _chart(cache=tmp_path)
    tiles = len(counted)
    victim = sorted(tmp_path.glob("*.tile"))[1]
    data = bytearray(victim.read_bytes())
    if damage == "truncated":
        victim.write_bytes(data[: len(data) // 2])
    elif damage == "flipped":
        data[len(data) // 2] ^= 1
        victim.write_bytes(data)
    elif damage == "empty":
        victim.write_bytes(b"")
    else:
        victim.unlink()
    assert _same(whole, _chart(cache=tmp_path))
    assert len(counted) == tiles + 1


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="this system has no kill -9")
def test_kill_nine_at_any_moment_loses_no_finished_tile(tmp_path: Path, counted: list[int]) -> None:
    whole = _chart()
    tiles = len(counted)
    child = subprocess.Popen([sys.executable, "-c", CHILD, str(tmp_path)])
    while child.poll() is None and len(list(tmp_path.glob("*.tile"))) < 2:
        time.sleep(0.01)
    os.kill(child.pid, signal.SIGKILL)
    assert child.wait() == -signal.SIGKILL
    kept = len(list(tmp_path.glob("*.tile")))
    assert 2 <= kept < tiles
    assert _same(whole, _chart(cache=tmp_path))
    assert len(counted) == 2 * tiles - kept


@pytest.mark.slow
def test_ten_kills_at_random_moments(tmp_path: Path) -> None:
    whole = _chart()
    moments = np.random.default_rng(0).uniform(0.0, 1.5, 10)
    for number, moment in enumerate(moments):
        folder = tmp_path / str(number)
        child = subprocess.Popen([sys.executable, "-c", CHILD, str(folder)])
        while child.poll() is None and not folder.exists():
            time.sleep(0.01)
        time.sleep(moment * 0.25)
        child.kill()
        child.wait()
        assert _same(whole, _chart(cache=folder))


@pytest.mark.parametrize("bad", [3.5, object()])
def test_a_cache_that_is_no_path_is_refused(bad: object) -> None:
    with pytest.raises(ValueError, match="cache"):
        _chart(cache=bad)


def test_a_cache_that_cannot_be_made_is_refused(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(ValueError, match=r"cache .* cannot be written to"):
        _chart(cache=tmp_path / "file")
