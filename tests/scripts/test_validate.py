"""The command line: what it writes, when it fails, and that it never leaves half a result."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from compare.files import save_system
from floquet_scripts.validate import main
from periodic.examples import coupled_mathieu, gyroscopic_rotor, mathieu
from tests.finite_elements import column
from tests.small_case import SMALL_CASE


@pytest.fixture
def case(tmp_path: Path) -> Path:
    path = tmp_path / "small.toml"
    path.write_text(SMALL_CASE)
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


def test_a_title_is_no_mathematics(case: Path, tmp_path: Path) -> None:
    text = case.read_text(encoding="utf-8").replace("A small plate", "costs 5$ and a $b^{2$")
    case.write_text(text, encoding="utf-8")
    assert main(["--case", str(case), "--quick", "--no-progress", "--output", str(tmp_path / "out")]) == 0


def test_a_window_without_regions_is_refused(case: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    case.write_text(case.read_text(encoding="utf-8").replace("[15.0, 28.0]", "[1.0, 2.0]"), encoding="utf-8")
    assert main(["--case", str(case), "--quick", "--no-progress", "--output", str(tmp_path / "out")]) == 2
    assert "none of the regions between the 2 lowest modes starts in the window" in capsys.readouterr().err


def test_a_wrong_case_is_one_clear_line_and_status_two(
    case: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    case.write_text(SMALL_CASE.replace("axial_terms", "axial_tems"))
    output = tmp_path / "out"
    assert main(["--case", str(case), "--output", str(output), "--no-progress"]) == 2
    error = capsys.readouterr().err
    assert "small.toml: [plate] axial_tems: unknown key" in error
    assert "Traceback" not in error
    assert not output.exists()


def test_disagreement_is_status_one(case: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # A theory whose edges are 1 % off the centre must be caught.
    from perturb import TransitionCurve

    whole = TransitionCurve.merged_edges
    monkeypatch.setattr(
        TransitionCurve, "merged_edges", lambda self, eps: tuple(1.01 * edge for edge in whole(self, eps))
    )
    assert main(["--case", str(case), "--output", str(tmp_path), "--no-progress", "--quick"]) == 1


def test_a_failure_leaves_the_old_output_whole(case: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    output = tmp_path / "out"
    output.mkdir()
    (output / "agreement.json").write_text("old")
    from compare.study import Study

    def fail(self: Study) -> None:
        raise RuntimeError("the disk is on fire")

    monkeypatch.setattr(Study, "figures", fail)
    with pytest.raises(RuntimeError):
        main(["--case", str(case), "--output", str(output), "--no-progress", "--quick"])
    assert [(path.name, path.read_text()) for path in output.iterdir() if path.is_file()] == [("agreement.json", "old")]


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


def test_a_system_goes_from_file_to_picture(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    save_system(tmp_path / "pair.npz", coupled_mathieu())
    save_system(tmp_path / "one.mat", mathieu())
    save_system(tmp_path / "matrices", gyroscopic_rotor())
    output = tmp_path / "out"
    names = ("pair.npz", "one.mat", "matrices")
    systems = [option for name in names for option in ("--system", str(tmp_path / name))]
    assert main([*systems, "--points", "16", "8", "--output", str(output), "--no-progress", "--jobs", "1"]) == 0
    said = capsys.readouterr().out
    data = json.loads((output / "agreement.json").read_text(encoding="utf-8"))
    assert [case["title"] for case in data["cases"]] == list(names)
    assert data["claims"] == []
    for name in names:
        assert name in said
        assert (output / f"{Path(name).stem}-chart.png").read_bytes().startswith(b"\x89PNG")
    assert (output / "pair-regions.pdf").read_bytes().startswith(b"%PDF")
    report = (output / "report.html").read_text(encoding="utf-8")
    assert all(name in report for name in names)


@pytest.mark.slow
def test_a_finite_element_model_of_fifty_coordinates(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    save_system(tmp_path / "column.npz", column(25))
    output = tmp_path / "out"
    arguments = ["--system", str(tmp_path / "column.npz"), "--modes", "2", "--points", "24", "8", "--no-progress"]
    assert main([*arguments, "--output", str(output)]) == 0
    said = capsys.readouterr().out
    assert "lowest of 50 modes" in said
    assert "cells of the chart, integrated again by another method" in said
    for name in ("report.md", "agreement.json"):
        assert "lowest of 50 modes" in (output / name).read_text(encoding="utf-8")


def test_a_system_that_theory_gets_wrong_is_status_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # Edges whose slope is one per cent off: no shift of a centre that a chart would show.
    from perturb import TransitionCurve

    whole = TransitionCurve.merged_edges

    def wider(self: TransitionCurve, eps: Any) -> tuple[object, ...]:
        return tuple(self.centre + 1.01 * (edge - self.centre) for edge in whole(self, eps))

    monkeypatch.setattr(TransitionCurve, "merged_edges", wider)
    save_system(tmp_path / "one.npz", mathieu())
    arguments = ["--system", str(tmp_path / "one.npz"), "--quick", "--no-progress", "--output", str(tmp_path / "out")]
    assert main(arguments) == 1


@pytest.mark.parametrize(
    ("arguments", "wanted"),
    [
        (["--system", "nowhere.npz"], "nowhere.npz: cannot be read"),
        (["--system", "trap.npz"], "trap.npz: there is no theory to compare with, because of K (stiffness)"),
        (["--system", "bare.npz"], "bare.npz: there is no excitation"),
        (["--system", "one.npz", "--Omega", "7", "8"], "one.npz: none of the regions"),
        (["--system", "one.npz", "--Omega", "8", "7"], "is empty"),
        (["--system", "one.npz", "--Omega", "nan", "7"], "--Omega[0] = nan"),
        (["--system", "one.npz", "--eps", "-1"], "--eps = -1.0"),
        (["--system", "one.npz", "--points", "1", "8"], "points = 1"),
        (["--system", "one.npz", "--points", "99999", "99999"], "points = 99999"),
        (["--system", "one.npz", "--modes", "0"], "modes = 0"),
        (["--system", "one.npz", "--system", "one.npz"], "two of the files are called 'one'"),
        (["--eps", "1"], "--eps belongs to a system"),
        (["--all-modes"], "--all-modes belongs to a system"),
    ],
)
def test_wrong_systems_are_one_sentence_and_write_nothing(
    arguments: list[str],
    wanted: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    save_system("one.npz", mathieu())
    save_system("trap.npz", mathieu(-0.3))
    np.savez("bare.npz", M=[[1.0]], K=[[1.0]])
    assert main([*arguments, "--no-progress"]) == 2
    error = capsys.readouterr().err
    assert wanted in error
    assert "Traceback" not in error
    assert not Path("output").exists()


def test_nothing_compared_is_status_three_with_a_sentence(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    np.savez(tmp_path / "still.npz", M=[[1.0]], K=[[1.0]], C=[[0.2]], F1c=[[1.0]])
    arguments = ["--system", str(tmp_path / "still.npz"), "--quick", "--no-progress", "--output", str(tmp_path / "out")]
    assert main(arguments) == 3
    said = capsys.readouterr()
    assert "NOTHING WAS COMPARED" in said.out
    assert "still.npz: nothing was compared" in said.err
    data = json.loads((tmp_path / "out" / "agreement.json").read_text(encoding="utf-8"))
    assert data["summary"]["compared"] == 0


def test_a_free_drivetrain_is_judged(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    chain, mesh = [[1.0, -1.0, 0.0], [-1.0, 3.0, -2.0], [0.0, -2.0, 2.0]], np.zeros((3, 3))
    mesh[:2, :2] = [[1.0, -1.0], [-1.0, 1.0]]
    np.savez(tmp_path / "drive.npz", M=np.eye(3), K=chain, F1c=mesh)
    arguments = ["--system", str(tmp_path / "drive.npz"), "--quick", "--no-progress", "--output", str(tmp_path / "out")]
    assert main(arguments) == 0
    assert "1 rigid-body motion is set apart" in capsys.readouterr().out
