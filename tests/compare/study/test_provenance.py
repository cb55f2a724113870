"""A report says how it was made: by which version, when, by which command, of which parameters."""

from __future__ import annotations

import re
import sys
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path

import pytest

from compare.files import load_case, save_system
from compare.study import Study, Subject, own_system, run_study, system_subject, write_report
from compare.study.provenance import provenance
from floquet.running import source_hash
from periodic.examples import mathieu
from plate import MovingPlate
from tests.small_case import SMALL_CASE


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> Study:
    path = tmp_path_factory.mktemp("case") / "small.toml"
    path.write_text(SMALL_CASE, encoding="utf-8")
    return run_study(Subject.of_case(load_case(path)), n_jobs=1, quick=True)


def test_both_reports_say_how_they_were_made(study: Study, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "argv", ["/far/away/validate.py", "--case", "a plate.toml"])
    before = datetime.now(UTC)
    write_report([study], [], tmp_path)
    for name in ("report.md", "report.html"):
        text = (tmp_path / name).read_text(encoding="utf-8").replace("&#39;", "'")
        assert "validate.py --case 'a plate.toml'" in text
        assert "/far/away" not in text
        assert source_hash()[:12] in text
        date = re.search(r"(\d{4}-\d\d-\d\d \d\d:\d\d) UTC", text)
        assert date is not None
        made = datetime.strptime(date[1], "%Y-%m-%d %H:%M").replace(tzinfo=UTC)
        assert abs((made - before).total_seconds()) < 600
        for value in ("axial_terms = 2", "lateral_terms = 3", "Ω from 15 to 28, ε to 0.2", "; 1 harmonic"):
            assert value in text


def test_another_parameter_is_another_line(study: Study) -> None:
    def line(family: MovingPlate) -> str:
        changed = replace(study, subject=replace(study.subject, systems={"": family}))
        return provenance([changed]).parameters[0][1]

    plate = study.subject.systems[""]
    assert isinstance(plate, MovingPlate)
    lines = {line(replace(plate, **{name: value})) for name, value in (("speed", 1.0), ("damping", 1e-3))}
    lines |= {line(plate), line(replace(plate, load=plate.load.with_waveform("square", harmonics=3)))}
    assert len(lines) == 4


def test_terms_that_the_plate_chose_are_told(study: Study) -> None:
    plate = MovingPlate()
    assert plate.axial_terms is None
    changed = replace(study, subject=replace(study.subject, systems={"": plate}))
    line = provenance([changed]).parameters[0][1]
    assert f"axial_terms = {plate.terms.axial}, lateral_terms = {plate.terms.lateral}" in line
    assert "None" not in line


def test_matrices_are_told_by_their_hash(tmp_path: Path) -> None:
    found = set()
    for delta in (1.0, 1.0, 1.0000001):
        save_system(tmp_path / "mine.npz", mathieu(delta))
        subject = system_subject(own_system(tmp_path / "mine.npz"), points=(8, 4), modes=1)
        found.add(provenance([run_study(subject, n_jobs=1, quick=True)]).parameters[0][1])
    assert len(found) == 2
    assert all(re.search(r"n = 1, 1 harmonic, matrices [0-9a-f]{12}; ", line) for line in found)
