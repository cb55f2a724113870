"""The first five minutes: commands can be run, say what is missing, and say that they compile."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.paths import ROOT

COMMANDS = ("validate", "explore", "modes", "gallery", "certify")
COMPILE_TWICE = """
import numba
from floquet_scripts.compiling import announce_compilation
announce_compilation()
announce_compilation()
print("begin", flush=True)
for number in (1, 1.0):
    numba.njit(cache=False)(lambda x: x + 1)(number)
"""


@pytest.mark.parametrize("name", [*(f"scripts/{name}.py" for name in COMMANDS), ".ci/run"])
def test_a_command_can_be_run_after_a_clone(name: str) -> None:
    """Git keeps the bit, whatever this file system does."""
    listed = subprocess.run(["git", "ls-files", "-s", name], cwd=ROOT, check=True, capture_output=True, text=True)
    assert listed.stdout.startswith("100755 ")
    assert (ROOT / name).read_text(encoding="utf-8").startswith("#!/usr/bin/env ")


@pytest.mark.parametrize("name", COMMANDS)
def test_without_packages_a_command_says_what_to_do(name: str, tmp_path: Path) -> None:
    command = [sys.executable, "-S", "-I", str(ROOT / "scripts" / f"{name}.py"), "--help"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 2
    assert done.stderr.startswith(f"{name}: this python has no package ")
    assert "make validate" in done.stderr
    assert "pip install ." in done.stderr
    assert done.stderr.count("\n") == 1


def test_compilation_is_announced_once() -> None:
    done = subprocess.run(
        [sys.executable, "-c", COMPILE_TWICE],
        env={name: value for name, value in os.environ.items() if name != "NUMBA_DISABLE_JIT"},
        capture_output=True,
        text=True,
    )
    assert (done.returncode, done.stderr) == (0, "")
    begin, *said = done.stdout.splitlines()
    assert begin == "begin"
    assert len(said) == 1
    assert said[0].startswith("compiling the integrator, once ")
