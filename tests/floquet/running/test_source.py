"""The state of the code: every edit of a file that charts are computed with is another state."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from floquet.running import source_hash
from floquet.running.source import PACKAGES, kernel_files, kernel_hash
from tests.paths import ROOT


@pytest.fixture
def copy(tmp_path: Path) -> Path:
    """A copy of the packages' sources."""
    for package in PACKAGES:
        for source in (ROOT / package).rglob("*.py"):
            target = tmp_path / source.relative_to(ROOT)
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_bytes(source.read_bytes())
    return tmp_path


@pytest.mark.parametrize(
    "file", ["floquet/kind.py", "floquet/engine/eigen/lanes.py", "floquet/chart/chart.py", "periodic/system.py"]
)
def test_an_edit_in_any_room_is_another_state(copy: Path, file: str) -> None:
    assert source_hash(copy) == source_hash()
    (copy / file).write_bytes((copy / file).read_bytes() + b"\n")
    assert source_hash(copy) != source_hash()


@pytest.mark.parametrize(
    ("file", "stale"),
    [
        ("floquet/engine/eigen/lanes.py", True),  # has kernels
        ("floquet/oracle/taylor.py", True),
        ("floquet/kind.py", True),  # values that kernels return
        ("floquet/boundary/trace.py", False),
        ("floquet/certified/growth.py", False),
    ],
)
def test_kernels_are_stale_where_they_or_what_they_import_is_edited(copy: Path, file: str, stale: bool) -> None:
    assert (copy / file in kernel_files(copy)) is stale


def test_the_kernels_hash_is_that_of_their_files(copy: Path) -> None:
    assert kernel_hash(copy) == kernel_hash()
    for file, stale in (("floquet/boundary/trace.py", False), ("floquet/engine/eigen/lanes.py", True)):
        (copy / file).write_bytes((copy / file).read_bytes() + b"\n")
        assert (kernel_hash(copy) != kernel_hash()) is stale


def test_every_file_with_a_kernel_counts(copy: Path) -> None:
    with_kernels = {file for file in (copy / "floquet").rglob("*.py") if "@njit" in file.read_text()}
    assert len(with_kernels) > 10
    assert with_kernels <= set(kernel_files(copy))


def test_a_moved_file_is_another_state(copy: Path) -> None:
    (copy / "floquet/engine/krein.py").rename(copy / "floquet/krein.py")
    assert source_hash(copy) != source_hash()


def test_other_packages_do_not_count(copy: Path) -> None:
    (copy / "plate").mkdir()
    (copy / "plate/plate.py").write_text("")
    assert source_hash(copy) == source_hash()


def test_the_makefile_gets_the_same_hash() -> None:
    # without the packages on the path: before anything is installed
    command = [sys.executable, "-I", str(ROOT / "floquet/running/source.py")]
    assert subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip() == kernel_hash()
