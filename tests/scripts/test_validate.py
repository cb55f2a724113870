"""The command line: what it writes, when it fails, and that it never leaves half a result."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from floquet_scripts.validate import main

SMALL = """
title = "A small plate"
regions = [[1, 1], [1, 2]]
[plate]
axial_terms = 2
lateral_terms = 3
[chart]
Omega = [15.0, 28.0]
eps = 0.2
points = [12, 6]
"""


@pytest.fixture
def case(tmp_path: Path) -> Path:
    path = tmp_path / "small.toml"
    path.write_text(SMALL)
    return path


def test_a_case_goes_from_plate_to_picture(case: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    output = tmp_path / "out"
    assert main(["--case", str(case), "--output", str(output), "--no-progress", "--jobs", "1"]) == 0
    for name in ("small-regions", "small-chart"):
        assert (output / f"{name}.png").read_bytes().startswith(b"\x89PNG")
        assert (output / f"{name}.pdf").read_bytes().startswith(b"%PDF")
    assert "agrees" in capsys.readouterr().out
    text = (output / "agreement.json").read_text(encoding="utf-8")
    assert "2ω₁" in text
    assert "NaN" not in text
    json.loads(text)
    assert not [path for path in output.iterdir() if path.name.startswith(".")]


def test_a_wrong_case_is_one_clear_line_and_status_two(
    case: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    case.write_text(SMALL.replace("axial_terms", "axial_tems"))
    output = tmp_path / "out"
    assert main(["--case", str(case), "--output", str(output), "--no-progress"]) == 2
    error = capsys.readouterr().err
    assert "small.toml: [plate] axial_tems: unknown key" in error
    assert "Traceback" not in error
    assert not output.exists()


def test_disagreement_is_status_one(case: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # A theory whose edges are 1 % off the centre must be caught.
    from perturb import TransitionCurve

    whole = TransitionCurve.edges
    monkeypatch.setattr(TransitionCurve, "edges", lambda self, eps: tuple(1.01 * edge for edge in whole(self, eps)))
    assert main(["--case", str(case), "--output", str(tmp_path), "--no-progress", "--quick"]) == 1


def test_a_failure_leaves_the_old_output_whole(case: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    output = tmp_path / "out"
    output.mkdir()
    (output / "agreement.json").write_text("old")
    from compare.study import CaseStudy

    def fail(self: CaseStudy) -> None:
        raise RuntimeError("the disk is on fire")

    monkeypatch.setattr(CaseStudy, "figures", fail)
    with pytest.raises(RuntimeError):
        main(["--case", str(case), "--output", str(output), "--no-progress", "--quick"])
    assert [(path.name, path.read_text()) for path in output.iterdir()] == [("agreement.json", "old")]


@pytest.mark.parametrize("jobs", ["0", "-2", "many"])
def test_a_wrong_number_of_jobs_is_refused(jobs: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit, match="2"):
        main([f"--jobs={jobs}"])
    assert f"'{jobs}' is no number of workers" in capsys.readouterr().err


def test_help_teaches(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit, match="0"):
        main(["--help"])
    text = capsys.readouterr().out
    assert "examples:" in text
    assert "exit status" in text
