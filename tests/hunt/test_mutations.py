"""The tests are tested: each of the faults in `tests/hunt/faults/` must make the tests named with it fail."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from queue import SimpleQueue

import pytest

from tests.hunt.fault import Fault
from tests.hunt.faults import FAULTS
from tests.hunt.table import PAGE, with_table
from tests.paths import ROOT

ROOMS = ("periodic", "plate", "beam", "perturb", "floquet", "compare")
TREE = (*ROOMS, "scripts", "cases", "tests", "docs", "pyproject.toml")
WORKERS = 2
# A fault that makes its tests hang is not caught: whoever makes it would wait.
SECONDS = 600
TESTS_FAILED = 1  # pytest's exit status; anything else is no verdict of a test


def copied(folder: Path) -> Path:
    """Copy what the tests need, with the times of its files: Numba's cache goes by them."""
    for name in TREE:
        if (ROOT / name).is_dir():
            shutil.copytree(ROOT / name, folder / name, ignore=shutil.ignore_patterns("__pycache__"))
        else:
            shutil.copy2(ROOT / name, folder / name)
    return folder


def run_tests(tree: Path, tests: list[str], cache: Path) -> tuple[int, str]:
    """Run tests in a copy; return pytest's exit status and what it printed last."""
    command = [sys.executable, "-m", "pytest", "-x", "-q", "-m", "not slow", "-p", "no:cacheprovider"]
    environment = os.environ | {"NUMBA_CACHE_DIR": str(cache), "PYTHONDONTWRITEBYTECODE": "1"}
    run = subprocess.run(
        [*command, *(f"tests/{test}" for test in tests)],
        cwd=tree,
        env=environment,
        capture_output=True,
        text=True,
        timeout=SECONDS,
    )
    return run.returncode, run.stdout[-3000:] + run.stderr[-1000:]


def survives(fault: Fault, tree: Path, cache: Path) -> str:
    """Return nothing if the fault is caught, else why not."""
    file = tree / fault.file
    good = file.read_bytes()
    times = file.stat()
    try:
        file.write_text(good.decode().replace(fault.old, fault.new), encoding="utf-8")
        if fault.compiled:
            cache = tree / "fresh-cache"
            shutil.rmtree(cache, ignore_errors=True)
        status, output = run_tests(tree, [fault.tests], cache)
    except subprocess.TimeoutExpired:
        return f"its tests hang for {SECONDS} s"
    finally:
        file.write_bytes(good)
        os.utime(file, ns=(times.st_atime_ns, times.st_mtime_ns))
    return "" if status == TESTS_FAILED else f"pytest ended with {status}: {output[-1500:]}"


def test_every_fault_is_where_the_list_says() -> None:
    for fault in FAULTS:
        count = (ROOT / fault.file).read_text(encoding="utf-8").count(fault.old)
        assert count == 1, f"{fault.name}: {fault.old!r} is {count} times in {fault.file}; mend the list"
        assert fault.old != fault.new
        assert (ROOT / "tests" / fault.tests.split("::")[0]).is_file(), fault
    assert len({fault.name for fault in FAULTS}) == len(FAULTS)


def test_the_documentation_has_the_list() -> None:
    text = PAGE.read_text(encoding="utf-8")
    assert text == with_table(text), "docs/testing.md lacks some faults: python -m tests.hunt.faults renews its table"


def test_the_list_covers_every_room() -> None:
    for room in ROOMS:
        assert sum(fault.file.startswith(f"{room}/") for fault in FAULTS) >= 4


@pytest.mark.slow
def test_every_fault_is_caught(tmp_path: Path, tabulate: Callable[..., None]) -> None:
    trees: SimpleQueue[Path] = SimpleQueue()
    for worker in range(WORKERS):
        trees.put(copied(tmp_path / str(worker)))
    tests = sorted({fault.tests for fault in FAULTS})

    def without(share: list[str]) -> tuple[int, str]:
        tree = trees.get()
        try:
            return run_tests(tree, share, tree / "cache")
        finally:
            trees.put(tree)

    def outcome(fault: Fault) -> str:
        tree = trees.get()
        try:
            return survives(fault, tree, tree / "cache")
        finally:
            trees.put(tree)

    with ThreadPoolExecutor(WORKERS) as pool:
        for status, output in pool.map(without, [tests[worker::WORKERS] for worker in range(WORKERS)]):
            assert status == 0, f"without any fault the tests end with {status}:\n{output}"
        outcomes = list(pool.map(outcome, FAULTS))
    for fault, why in zip(FAULTS, outcomes, strict=True):
        first = re.search(r"pytest ended with \d+", why)
        tabulate(
            "Faults",
            fault=fault.name,
            where=fault.file,
            tests=fault.tests,
            caught="yes" if not why else f"NO ({first[0] if first else why})",
        )
    survivors = [f"{fault.name} ({fault.file}): {why}" for fault, why in zip(FAULTS, outcomes, strict=True) if why]
    assert not survivors, "\n\n".join(survivors)
