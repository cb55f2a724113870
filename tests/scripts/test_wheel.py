"""The wheel in a clean environment, far from the sources: its commands run, cases included."""

from __future__ import annotations

import os
import subprocess
import sys
import venv
from pathlib import Path

import numpy as np
import pytest

from floquet_charts.__main__ import COMMANDS
from tests.paths import ROOT
from tests.small_case import SMALL_CASE


@pytest.fixture(scope="module")
def bin_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Build the wheel from the files that git knows, install it with its extra, and return where its commands are."""
    folder = tmp_path_factory.mktemp("wheel")
    tracked = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, check=True, capture_output=True, text=True).stdout
    for name in filter(None, tracked.split("\0")):
        copy = folder / "source" / name
        copy.parent.mkdir(parents=True, exist_ok=True)
        copy.write_bytes((ROOT / name).read_bytes())
    pip = [sys.executable, "-m", "pip", "--quiet", "--disable-pip-version-check"]
    subprocess.run([*pip, "wheel", "--no-deps", "--wheel-dir", folder, folder / "source"], check=True)
    venv.create(folder / "env", with_pip=True)
    bin_folder = folder / "env" / ("Scripts" if os.name == "nt" else "bin")
    wheel = next(folder.glob("*.whl"))
    subprocess.run([bin_folder / "python", *pip[1:], "install", f"{wheel}[certify]"], check=True)
    return bin_folder


def _run(bin_folder: Path, empty: Path, command: str, *arguments: str) -> str:
    names = ("PATH", "HOME", "TMPDIR", "SYSTEMROOT")
    environment = {name: os.environ[name] for name in names if name in os.environ}  # no PYTHONPATH, no cache of kernels
    result = subprocess.run(
        [bin_folder / command, *arguments], cwd=empty, env=environment, capture_output=True, text=True, check=False
    )
    assert result.returncode == 0, result.stdout + result.stderr
    return result.stdout


@pytest.mark.slow
def test_the_installed_commands_run_from_an_empty_folder(bin_folder: Path, tmp_path: Path) -> None:
    shipped = (
        "from compare.files import load_case, shipped_cases\n"
        "print([load_case(path).name for path in shipped_cases()], load_case.__code__.co_filename)"
    )
    said = _run(bin_folder, tmp_path, "python", "-c", shipped)
    assert all(f"'{path.stem}'" in said for path in (ROOT / "cases").glob("*.toml"))
    assert str(ROOT) not in said

    (tmp_path / "quick.toml").write_text(SMALL_CASE, encoding="utf-8")
    said = _run(
        bin_folder, tmp_path, "floquet-charts", "validate", "--case", "quick.toml", "--quick", "--output", "judged"
    )
    assert "yes" in said
    assert (tmp_path / "judged" / "report.html").is_file()

    np.savez(tmp_path / "mine.npz", M=[[1.0]], K=[[1.0]], F1c=[[1.0]])
    said = _run(
        bin_folder, tmp_path, "floquet-charts", "validate", "--system", "mine.npz", "--quick", "--output", "mine"
    )
    assert "2ω₁" in said
    said = _run(bin_folder, tmp_path, "floquet-charts", "explore", "--system", "mine.npz", "--points", "16", "8")
    assert "2ω₁" in said
    assert (tmp_path / "output" / "mine-overlay.png").is_file()
    said = _run(bin_folder, tmp_path, "floquet-charts", "certify", "--system", "mine.npz", "--at", "2,0.1")
    assert "unstable" in said
    for command in COMMANDS:
        said = _run(bin_folder, tmp_path, "floquet-charts", command, "--help")
        assert f"  floquet-charts {command} --" in said
