"""Long runs: stopped in whatever way they go on where they were, and they may be computed elsewhere."""

from __future__ import annotations

import io
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from compare.files import save_system
from floquet import StabilityChart
from floquet_scripts import explore, validate
from periodic.examples import coupled_mathieu, mathieu
from tests.sparing import all_but

COLUMNS, BLOCKS = 640, 40
CHART = ("--Omega", "0.7", "5.0", "--eps", "1.0", "--points", str(COLUMNS), "12", "--no-regions", "--no-progress")
SYSTEM = ("--system", "pair.npz", "--jobs", "1")
NAMES = ("growth_rate", "multiplier", "kind", "error")

# The command with its blocks slowed down, so that a kill falls between the first and the last of them. It listens to
# Ctrl-C even if the tests run in the background of a shell, which has them ignore it.
SLOWED = """
import signal, sys, time
signal.signal(signal.SIGINT, signal.default_int_handler)
from floquet.chart import filling
from floquet_scripts import explore
whole = filling.chart_batch
def slow(*arguments):
    time.sleep(0.04)
    return whole(*arguments)
filling.chart_batch = slow
sys.exit(explore.main(sys.argv[1:]))
"""

needs_kill = pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="this system has no kill -9")


def _start(folder: Path, *options: str) -> subprocess.Popen[str]:
    command = [sys.executable, "-c", SLOWED, *SYSTEM, *CHART, *options]
    return subprocess.Popen(command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def _wait_for_blocks(child: subprocess.Popen[str], folder: Path, count: int) -> None:
    while child.poll() is None and len(list(folder.glob("*.tile"))) < count:
        time.sleep(0.005)


def _arrays(path: Path) -> list[np.ndarray]:
    chart = StabilityChart.load(path)
    assert chart.audit is not None
    return [*(getattr(chart, name) for name in NAMES), chart.audit.differences]


def _same(a: Path, b: Path) -> bool:
    return all(np.array_equal(left, right) for left, right in zip(_arrays(a), _arrays(b), strict=True))


@pytest.fixture(scope="module")
def home(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a system in it, and its chart from an uninterrupted run in whole/."""
    folder = tmp_path_factory.mktemp("home")
    save_system(folder / "pair.npz", coupled_mathieu())
    arguments = ["--system", str(folder / "pair.npz"), "--output", str(folder / "whole"), "--jobs", "2", *CHART]
    assert explore.main(arguments) == 0
    return folder


def test_a_complete_run_leaves_no_parts(home: Path) -> None:
    assert sorted(path.suffix for path in (home / "whole").iterdir()) == [".json", ".npz", ".pdf", ".png", ".png"]


@needs_kill
@pytest.mark.slow
def test_kill_nine_twice_and_go_on(
    home: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    parts = home / "twice" / ".unfinished"
    kept: list[int] = []
    for _ in range(2):
        child = _start(home, "--output", "twice", "--resume")
        _wait_for_blocks(child, parts, (kept or [0])[-1] + 3)
        child.send_signal(signal.SIGKILL)
        child.communicate()
        assert child.returncode == -signal.SIGKILL
        kept.append(len(list(parts.glob("*.tile"))))
    assert 3 <= kept[0] < kept[0] + 3 <= kept[1] < BLOCKS
    victim = sorted(parts.glob("*.tile"))[0]
    victim.write_bytes(victim.read_bytes()[:-1])  # and a damaged one
    monkeypatch.chdir(home)
    assert explore.main([*SYSTEM, *CHART, "--output", "twice", "--resume"]) == 0
    said, errors = capsys.readouterr()
    assert not errors
    assert "twice/.unfinished holds finished parts of charts of a run that was stopped\n" in said
    assert _same(home / "whole" / "pair.npz", home / "twice" / "pair.npz")
    assert not parts.exists()


@needs_kill
@pytest.mark.slow
def test_ten_kills_at_random_moments_of_one_chart(home: Path) -> None:
    parts = home / "ten" / ".unfinished"
    rng = np.random.default_rng(6)
    for moment in rng.uniform(0.0, 0.2, 10):
        before = len(list(parts.glob("*.tile")))
        child = _start(home, "--output", "ten", "--resume")
        _wait_for_blocks(child, parts, before + 1)
        time.sleep(moment)
        child.kill()
        child.communicate()
        assert child.returncode == -signal.SIGKILL
        # As it would be if nobody stopped it again, from a copy of what there is now.
        copy = home / f"ten-{moment}"
        copy.mkdir()
        for block in parts.glob("*.tile"):
            (copy / block.name).write_bytes(block.read_bytes())
        arguments = ["--system", str(home / "pair.npz"), "--output", str(copy), "--resume", str(copy), *CHART]
        assert explore.main(arguments) == 0
        assert _same(home / "whole" / "pair.npz", copy / "pair.npz")


@pytest.mark.slow
def test_ctrl_c_says_how_to_go_on(
    home: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    parts = home / "stopped" / ".unfinished"
    child = _start(home, "--output", "stopped")
    _wait_for_blocks(child, parts, 2)
    child.send_signal(signal.SIGINT)
    _, errors = child.communicate()
    assert child.returncode == 130
    assert "Traceback" not in errors
    assert "explore: interrupted; nothing was written\n" in errors
    assert "kept in stopped/.unfinished: the same command with --resume goes on" in errors
    assert list((home / "stopped").iterdir()) == [parts]
    kept = len(list(parts.glob("*.tile")))
    assert 2 <= kept < BLOCKS
    # Without --resume everything is computed, and what another run has left stays until it is needed no more.
    monkeypatch.chdir(home)
    assert explore.main([*SYSTEM, *CHART, "--output", "stopped"]) == 0
    said, errors = capsys.readouterr()
    assert not errors
    assert "stopped/.unfinished holds finished parts" in said
    assert "--resume goes on with them" in said
    assert _same(home / "whole" / "pair.npz", home / "stopped" / "pair.npz")
    assert not parts.exists()


@pytest.mark.slow
def test_a_quick_look_into_the_same_folder_leaves_the_parts_of_a_long_run(home: Path, tmp_path: Path) -> None:
    parts = tmp_path / "out" / ".unfinished"
    parts.mkdir(parents=True)
    (parts / "of-a-long-run.tile").write_bytes(b"hours")
    arguments = ["--system", str(home / "pair.npz"), "--output", str(tmp_path / "out"), *CHART, "--points", "8", "4"]
    assert explore.main(arguments) == 0
    assert [path.name for path in parts.iterdir()] == ["of-a-long-run.tile"]


def test_a_folder_of_ones_own_keeps_the_parts_for_two_commands(
    home: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    from floquet.chart import filling

    common = ["--system", str(home / "pair.npz"), "--resume", str(tmp_path / "parts"), "--no-progress", "--jobs", "1"]
    window = ["--Omega", "2.0", "3.5", "--eps", "0.5", "--points", "16", "6"]
    assert validate.main([*common, *window, "--output", str(tmp_path / "a")]) == 0
    assert len(list((tmp_path / "parts").glob("*.tile"))) == 2
    monkeypatch.setattr(filling, "chart_batch", None)  # nothing is left to compute
    assert explore.main([*common, *window, "--output", str(tmp_path / "b"), "--no-regions"]) == 0
    assert len(list((tmp_path / "parts").glob("*.tile"))) == 2


def written(stream: io.TextIOWrapper) -> str:
    """Return what has been written to a stream in memory."""
    stream.seek(0)
    return stream.read()


@pytest.mark.parametrize("encoding", all_but(["cp1252"], ["ascii", "cp1252"]))
def test_a_terminal_without_greek_letters_is_no_obstacle(
    home: Path, tmp_path: Path, encoding: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    # As where the output of a command goes into a file or a pipe under Windows.
    streams = {name: io.TextIOWrapper(io.BytesIO(), encoding=encoding) for name in ("stdout", "stderr")}
    for name, stream in streams.items():
        monkeypatch.setattr(sys, name, stream)
    arguments = ["--system", str(home / "pair.npz"), "--points", "8", "4", "--no-progress", "--output", str(tmp_path)]
    status = explore.main(arguments)
    monkeypatch.undo()
    said, errors = (written(stream) for stream in streams.values())
    assert (status, errors) == (0, "")
    assert "?" in said  # for a Greek letter
    assert "pair.npz" in said


STREAMS = [("stdout",), ("stderr",), ("stdout", "stderr")]


@pytest.mark.parametrize("streams", all_but(STREAMS[:2], STREAMS), ids="+".join)
def test_results_are_written_although_nobody_reads_the_output(home: Path, tmp_path: Path, streams: set[str]) -> None:
    # as with `| head -1`, and with `2>&1 | head -1`, where progress bars go as well
    command = [sys.executable, "-c", "import sys; from floquet_scripts import explore; sys.exit(explore.main())"]
    arguments = ["--system", str(home / "pair.npz"), "--points", "8", "4", "--no-regions", "--output", str(tmp_path)]
    reading, writing = os.pipe()
    os.close(reading)
    broken: dict[str, Any] = {name: writing if name in streams else subprocess.PIPE for name in ("stdout", "stderr")}
    done = subprocess.run([*command, *arguments], text=True, **broken)
    os.close(writing)
    assert done.returncode == 0
    assert "Error" not in (done.stderr or "")
    assert (tmp_path / "pair.npz").exists()


def test_a_folder_that_cannot_be_written_to_is_refused_at_once(
    home: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "file").write_text("")
    common = ["--system", str(home / "pair.npz"), "--no-progress"]
    file = str(tmp_path / "file")
    for options in (["--output", file], ["--resume", file, "--output", "x"]):
        assert explore.main([*common, *options]) == 2
        said = capsys.readouterr().err
        assert "cannot be written to" in said
        assert f"{options[0]} {file}: " in said


@pytest.fixture(scope="module")
def scheduler() -> Iterator[str]:
    """The address of a real scheduler with two worker processes."""
    distributed = pytest.importorskip("distributed")
    options: dict[str, Any] = {"n_workers": 2, "threads_per_worker": 1, "dashboard_address": None}
    with distributed.LocalCluster(host="127.0.0.1", processes=True, **options) as cluster:
        yield cluster.scheduler_address


@pytest.mark.filterwarnings("ignore")  # distributed's own, of sockets that die with their worker
def test_a_cluster_that_loses_a_worker_gives_the_same_chart(
    home: Path, scheduler: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from distributed import Client

    from floquet.chart import TileStore

    with Client(scheduler, set_as_default=False) as client:
        victim = min(client.run(os.getpid).values())
    saved: list[Path] = []
    save = TileStore.save

    def save_and_kill(self: TileStore, path: Path, block: Any) -> None:
        save(self, path, block)
        saved.append(path)
        if len(saved) == BLOCKS // 4:
            os.kill(victim, signal.SIGKILL)

    monkeypatch.setattr(TileStore, "save", save_and_kill)
    arguments = ["--system", str(home / "pair.npz"), "--output", str(tmp_path), "--dask", scheduler, *CHART]
    assert explore.main(arguments) == 0
    assert len(saved) == BLOCKS
    assert _same(home / "whole" / "pair.npz", tmp_path / "pair.npz")


@pytest.mark.filterwarnings("ignore")
@pytest.mark.slow
def test_a_whole_study_runs_on_a_cluster(scheduler: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    save_system(tmp_path / "one.npz", mathieu())
    arguments = ["--system", str(tmp_path / "one.npz"), "--points", "16", "8", "--no-progress"]
    assert validate.main([*arguments, "--output", str(tmp_path / "here")]) == 0
    assert validate.main([*arguments, "--output", str(tmp_path / "there"), "--dask", scheduler]) == 0
    here, there = ((tmp_path / name / "agreement.json").read_text() for name in ("here", "there"))
    assert here == there


ADDRESSES = ["tcp://127.0.0.1:9", "nonsense://", "127.0.0.1:9", ""]


@pytest.mark.parametrize("address", all_but(ADDRESSES[:1], ADDRESSES))
def test_a_scheduler_that_is_not_there_is_one_sentence(
    home: Path, tmp_path: Path, address: str, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("distributed")
    arguments = ["--system", str(home / "pair.npz"), "--output", str(tmp_path / "out"), *CHART]
    assert explore.main([*arguments, "--dask", address]) == 2
    errors = capsys.readouterr().err
    assert errors.startswith(f"explore: --dask {address}: no scheduler answers there")
    assert "dask scheduler" in errors
    assert "Traceback" not in errors
    assert list((tmp_path / "out").iterdir()) == []


def test_without_distributed_it_says_what_to_install(
    home: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    arguments = ["--system", str(home / "pair.npz"), "--output", str(tmp_path), "--dask", "tcp://127.0.0.1:9", *CHART]
    assert explore.main(arguments) == 2
    assert "pip install 'floquet-charts[distributed]'" in capsys.readouterr().err


@pytest.mark.filterwarnings("ignore")
def test_a_scheduler_that_is_lost_on_the_way_is_one_sentence_and_keeps_what_is_done(
    home: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    distributed = pytest.importorskip("distributed")
    from floquet.chart import TileStore

    options: dict[str, Any] = {"n_workers": 1, "threads_per_worker": 2, "dashboard_address": None}
    cluster = distributed.LocalCluster(protocol="tcp://", host="127.0.0.1", processes=False, **options)
    save = TileStore.save

    def save_and_close(self: TileStore, path: Path, block: Any) -> None:
        save(self, path, block)
        cluster.close()

    monkeypatch.setattr(TileStore, "save", save_and_close)
    common = ["--system", str(home / "pair.npz"), "--output", str(tmp_path), *CHART]
    assert explore.main([*common, "--dask", cluster.scheduler_address]) == 2
    errors = capsys.readouterr().err
    assert "the connection to the scheduler was lost" in errors
    assert ".unfinished: the same command with --resume goes on" in errors
    assert 1 <= len(list((tmp_path / ".unfinished").glob("*.tile"))) < BLOCKS
    monkeypatch.undo()
    assert explore.main([*common, "--resume"]) == 0
    assert _same(home / "whole" / "pair.npz", tmp_path / "pair.npz")
