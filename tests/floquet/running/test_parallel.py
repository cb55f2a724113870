"""Workers of every kind give the same bits, in whatever order they finish and even if one of them dies."""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import joblib
import numpy as np
import pytest
from threadpoolctl import threadpool_info, threadpool_limits
from tqdm import tqdm

from floquet import StabilityChart, stability_chart, trace_regions
from floquet.chart import TileStore
from floquet.running import as_completed, gather, single_blas_thread
from floquet.running.parallel import CALLS_PER_WAVE
from periodic.examples import coupled_mathieu

OMEGA, EPS = np.linspace(0.7, 5.0, 90), np.linspace(0.0, 1.0, 130)  # arrays of more than a kilobyte
NAMES = ("growth_rate", "multiplier", "kind", "error")


def _chart(**options: Any) -> StabilityChart:
    return stability_chart(coupled_mathieu(), OMEGA, EPS, progress=False, audit=2, **options)


def _same(a: StabilityChart, b: StabilityChart) -> bool:
    assert a.audit is not None
    assert b.audit is not None
    pairs = [(getattr(a, name), getattr(b, name)) for name in NAMES]
    pairs += [(a.audit.differences, b.audit.differences), (a.audit.estimates, b.audit.estimates)]
    return all(np.array_equal(left, right) for left, right in pairs)


@pytest.fixture(scope="module")
def alone() -> StabilityChart:
    return _chart(n_jobs=1)


@pytest.mark.parametrize("backend", ["threading", "loky", "multiprocessing"])
def test_every_backend_gives_the_same_bits(alone: StabilityChart, backend: str, tmp_path: Path) -> None:
    with joblib.parallel_config(backend=backend, n_jobs=2):
        assert _same(alone, _chart(n_jobs=None))
        assert _same(alone, _chart(n_jobs=2, cache=tmp_path))
    assert len(list(tmp_path.glob("*.tile"))) == -(-OMEGA.size // 8)


def test_regions_are_traced_by_processes_too() -> None:
    window = (2.0, 3.5), (0.0, 1.0)
    alone = trace_regions(coupled_mathieu(), *window, n_jobs=1, progress=False)
    with joblib.parallel_config(backend="loky"):
        spread_out = trace_regions(coupled_mathieu(), *window, n_jobs=2, progress=False)
    assert [region.label for region in alone] == [region.label for region in spread_out]
    for a, b in zip(alone, spread_out, strict=True):
        np.testing.assert_array_equal(a.outlines[0].Omega, b.outlines[0].Omega)
        np.testing.assert_array_equal(a.outlines[0].eps, b.outlines[0].eps)


def _square(x: int) -> int:
    return x * x


def _blas_threads() -> int:
    np.linalg.norm(np.eye(64) @ np.eye(64))
    return max(library["num_threads"] for library in threadpool_info() if library["user_api"] == "blas")


@pytest.mark.parametrize("backend", ["threading", "loky", "multiprocessing"])
def test_results_come_with_their_number(backend: str) -> None:
    with joblib.parallel_config(backend=backend):
        found = dict(as_completed(_square, ((x,) for x in range(70)), 2))
    assert found == {x: x * x for x in range(70)}
    with tqdm(total=5, disable=True) as bar:
        assert gather(_square, [(x,) for x in range(5)], 1, bar) == [0, 1, 4, 9, 16]


@pytest.mark.parametrize("backend", ["threading", "loky"])
def test_blas_has_one_thread_in_a_worker(backend: str) -> None:
    # This thread has set another number, which gives it control over OpenBLAS.
    with threadpool_limits(limits=2, user_api="blas"):
        assert _blas_threads() == 2
        with joblib.parallel_config(backend=backend):
            assert [threads for _, threads in as_completed(_blas_threads, [()] * 4, 2)] == [1, 1, 1, 1]
        assert _blas_threads() == 2


def test_the_last_of_several_threads_lifts_the_limit() -> None:
    inside, leave = threading.Barrier(3), threading.Event()
    seen: list[int] = []

    def hold() -> None:
        with single_blas_thread():
            inside.wait()
            seen.append(_blas_threads())
            leave.wait()

    with threadpool_limits(limits=2, user_api="blas"):
        holders = [threading.Thread(target=hold) for _ in range(2)]
        for thread in holders:
            thread.start()
        inside.wait()
        leave.set()
        for thread in holders:
            thread.join()
        assert seen == [1, 1]
        assert _blas_threads() == 2


def test_arguments_are_read_as_the_work_goes_on() -> None:
    read: list[int] = []
    done: list[int] = []
    ahead: list[int] = []

    def call(x: int) -> None:
        ahead.append(len(read) - len(done))
        done.append(x)

    arguments = ((read.append(x) or x,) for x in range(500))  # type: ignore[func-returns-value]
    assert len(dict(as_completed(call, arguments, 2))) == 500
    # two calls a worker are handed out in advance, and joblib reads as many as there are workers at a time
    assert max(ahead) <= 8


def test_multiprocessing_reads_a_wave_at_a_time() -> None:
    read: list[int] = []
    arguments = ((read.append(x) or x,) for x in range(100))  # type: ignore[func-returns-value]
    with joblib.parallel_config(backend="multiprocessing"):
        results = as_completed(_square, arguments, 2)
        next(results)
        assert len(read) == 2 * CALLS_PER_WAVE
        assert len(dict(results)) == 99


@pytest.fixture(scope="module")
def client() -> Iterator[Any]:
    """A real scheduler with two worker processes."""
    distributed = pytest.importorskip("distributed")
    options = {"n_workers": 2, "threads_per_worker": 1, "processes": True, "dashboard_address": None}
    with distributed.LocalCluster(host="127.0.0.1", **options) as cluster, distributed.Client(cluster) as client:
        yield client


@pytest.mark.filterwarnings("ignore")  # distributed's own, of sockets that die with their worker
@pytest.mark.slow
def test_dask_workers_that_die_change_no_bit(
    alone: StabilityChart, client: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with joblib.parallel_config(backend="dask", client=client):
        assert _same(alone, _chart(n_jobs=None))
        alive = sorted(client.run(os.getpid).values())
        save = TileStore.save

        def save_and_kill(self: TileStore, path: Path, tile: Any) -> None:
            save(self, path, tile)
            if alive:  # in mid-run: one of twelve tiles has arrived, then two; nannies start new workers
                os.kill(alive.pop(), signal.SIGKILL)

        monkeypatch.setattr(TileStore, "save", save_and_kill)
        assert _same(alone, _chart(n_jobs=None, cache=tmp_path))
    assert not alive
