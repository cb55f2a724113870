"""Damaged case files and matrix files: a clear error or a result, whatever is in them.

Never another exception, a traceback from the scripts, a hang, a dead process, much memory or a half-written result.
Inputs are made and tried in child processes (`fuzz.py`), which may die without taking the test run along.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections import Counter
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from itertools import chain
from pathlib import Path
from typing import NamedTuple

import pytest

from tests.hunt.fuzz import MAKERS
from tests.paths import ROOT

FUZZ = Path(__file__).with_name("fuzz.py")
CHILDREN = 2


class Outcome(NamedTuple):
    number: int
    form: str
    kind: str
    outcome: str
    what: str


def tried(numbers: range, folder: Path) -> list[Outcome]:
    """Return what became of the inputs; one that kills its process is a fault, and the next goes on after it."""
    outcomes: list[Outcome] = []
    while numbers:
        command = [sys.executable, str(FUZZ), *map(str, (numbers.start, numbers.stop, numbers.step)), str(folder)]
        child = subprocess.run(command, capture_output=True, text=True, env=os.environ | {"PYTHONPATH": str(ROOT)})
        lines = child.stdout.splitlines()
        for begun, ended in zip(lines[::2], lines[1::2], strict=False):
            outcomes.append(Outcome(int(begun), *json.loads(ended)))
        if len(lines) % 2:
            what = f"the process ended with {child.returncode}: {child.stderr[-2000:]}"
            outcomes.append(Outcome(int(lines[-1]), "?", "?", "fault", what))
        elif child.returncode or not lines:
            raise RuntimeError(f"fuzz.py does not run: {child.stderr[-2000:]}")
        numbers = numbers[len(lines[::2]) :]
    return outcomes


def faults(outcomes: list[Outcome]) -> str:
    return "\n".join(f"{o.number} ({o.form}, {o.kind}): {o.what}" for o in outcomes if o.outcome == "fault")


def test_damaged_files_are_refused_or_read(tmp_path: Path) -> None:
    outcomes = tried(range(300), tmp_path)
    assert not faults(outcomes), faults(outcomes)
    counts = Counter(o.outcome for o in outcomes)
    # neither all broken beyond recognition nor all harmless
    assert counts["error"] > 100
    assert counts["result"] > 30


@pytest.mark.slow
def test_ten_thousand_damaged_files(tmp_path: Path, tabulate: Callable[..., None]) -> None:
    shares = [range(300 + child, 10_300, CHILDREN) for child in range(CHILDREN)]
    with ThreadPoolExecutor(CHILDREN) as pool:
        folders = [tmp_path / str(child) for child in range(CHILDREN)]
        outcomes = list(chain.from_iterable(pool.map(tried, shares, folders)))
    for form in ("toml", "npz", "mat", "mtx"):
        counts = Counter(o.outcome for o in outcomes if o.form == form)
        columns = {"inputs": counts.total(), "errors": counts["error"], "results": counts["result"]}
        tabulate("Damaged files", format=form, **columns, faults=counts["fault"])
    assert len(outcomes) == 10_000
    assert not faults(outcomes), faults(outcomes)


# What `fuzz.py` must notice: a reader that fails in another way on each input.
FAILING = {
    "an exception": ("raise KeyError('M')", "KeyError"),
    "a message without the file": ("raise ValueError('M is wrong')", "does not name the file"),
    "a message without a matrix": ("raise ValueError(f'{path}: bad')", "neither key nor matrix"),
    "a message of a megabyte": ("raise ValueError(f'{path}: M' + 10**6 * '.')", "characters"),
    "a dead process": ("import os; os.abort()", "the process ended"),
    "a hang": ("import time; time.sleep(60)", "Timeout"),
    "memory": ("bytearray(2**33)", "MemoryError"),
}


@pytest.fixture(scope="module")
def noticed(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """What the hunt notices of each."""
    folder = tmp_path_factory.mktemp("failing")
    first, step = 1, len(MAKERS)  # inputs of one form
    numbers = range(first, first + step * len(FAILING), step)
    codes = dict(zip(numbers, (code for code, _ in FAILING.values()), strict=True))
    source = FUZZ.read_text(encoding="utf-8")
    before = "if __name__"
    assert source.count(f"\n{before}") == 1
    spoiled = f"""
SECONDS = 3
def load_system(path):
    exec({codes!r}[int(path.relative_to({str(folder)!r}).parts[0])], {{"path": path}})
load_case = load_system

{before}"""
    script = folder / "fuzz.py"
    script.write_text(source.replace(before, spoiled), encoding="utf-8")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sys.modules[__name__], "FUZZ", script)
        outcomes = tried(numbers, folder)
    assert [one.number for one in outcomes] == [*numbers]
    return {name: faults([one]) for name, one in zip(FAILING, outcomes, strict=True)}


@pytest.mark.slow
@pytest.mark.parametrize("name", FAILING)
def test_the_hunt_finds_what_it_hunts(noticed: dict[str, str], name: str) -> None:
    assert FAILING[name][1] in noticed[name]
