"""The tables that tests fill are printed at the end, whether one process runs the tests or several do."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.paths import ROOT

TEST = """
import pytest

@pytest.mark.parametrize("n", [1, 2, 3])
def test_row(n, tabulate):
    tabulate("Squares", n=n, square=n * n)
"""


@pytest.mark.parametrize("workers", ["0", "2"])
def test_tables_arrive_from_every_worker(workers: str, tmp_path: Path) -> None:
    (tmp_path / "test_rows.py").write_text(TEST, encoding="utf-8")
    options = ["-p", "tests.conftest", "-p", "no:cacheprovider", "--numprocesses", workers]
    run = subprocess.run(
        [sys.executable, "-m", "pytest", *options, "test_rows.py"],
        cwd=tmp_path,
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
    )
    assert run.returncode == 0, run.stdout + run.stderr
    *_, closing = lines = run.stdout.splitlines()
    assert "| n | square |" in lines
    assert sorted(line for line in lines if line[:3] in ("| 1", "| 2", "| 3")) == [
        "| 1 | 1 |",
        "| 2 | 4 |",
        "| 3 | 9 |",
    ]
    assert "3 passed" in closing
