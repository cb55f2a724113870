"""Fixtures that several packages' tests share, and an environment in which every run is alike."""

from __future__ import annotations

import json
import os
import runpy
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from hypothesis import settings

from tests.paths import ROOT

# Numba's cache does not notice an edited callee in another file: a cache folder for each state of what kernels are
# made of, the same as the Makefile's. This runs before any test imports numba.
_kernel_hash = runpy.run_path(str(ROOT / "floquet" / "running" / "source.py"))["kernel_hash"]
os.environ.setdefault("NUMBA_CACHE_DIR", str(ROOT / ".numba_cache" / _kernel_hash()[:16]))
for _name in ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS"):
    os.environ.setdefault(_name, "1")

# The same examples on every machine, so that only a change makes `make test` fail; `make test-full` tries new ones.
settings.register_profile("same", derandomize=True)
settings.load_profile("same")


@pytest.fixture(scope="session")
def references() -> dict[str, Any]:
    """Independent reference numbers: exact or spectrally converged solutions made without this code base."""
    return json.loads((Path(__file__).parent / "references.json").read_text())


TABLE = "table"  # what a row of a table is called among the properties of a test's report
ROWS: dict[str, list[dict[str, str]]] = {}


@pytest.fixture
def tabulate(record_property: Callable[[str, object], None]) -> Callable[..., None]:
    """Give tests a function (title, **columns) that adds a row to a table at the end of the run's output."""

    def add(title: str, **columns: object) -> None:
        record_property(TABLE, (title, {name: str(value) for name, value in columns.items()}))

    return add


def pytest_runtest_logreport(report: pytest.TestReport) -> None:
    """Collect the rows: with several workers they come with the reports, to the process that prints."""
    if report.when == "call":
        filled: list[Any] = [value for name, value in report.user_properties if name == TABLE]
        for title, row in filled:
            ROWS.setdefault(title, []).append(row)


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Print the tables that tests have filled, in Markdown, before pytest's closing line."""
    for title, rows in ROWS.items():
        terminalreporter.section(title)
        terminalreporter.write_line(f"| {' | '.join(rows[0])} |")
        terminalreporter.write_line(f"|{'---|' * len(rows[0])}")
        for row in rows:
            terminalreporter.write_line(f"| {' | '.join(row.values())} |")
