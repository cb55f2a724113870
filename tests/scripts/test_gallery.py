"""The gallery: its numbers are met, its page says what is computed, and a wrong number would be noticed."""

from __future__ import annotations

from pathlib import Path

import pytest

from floquet_scripts.gallery import gallery, judged, lines_of, main
from tests.gallery import MARK, PAGE, body, row

QUICK = (
    "asymmetric_shaft", "blade_flap", "column", "digital_trap", "ground_resonance", "kapitza_pendulum", "mathieu",
    "meissner", "quadrupole_trap", "ship_roll", "square_plate", "two_bladed_whirl",
)  # fmt: skip


@pytest.mark.parametrize("name", QUICK)
def test_numbers_are_met_and_stand_on_the_page(name: str) -> None:
    page = PAGE.read_text(encoding="utf-8")
    for line in lines_of(gallery()[name]):
        assert line.met
        assert f"{row(line)}\n" in page


def test_every_example_names_its_source_and_stands_on_the_page() -> None:
    page = PAGE.read_text(encoding="utf-8")
    assert len(gallery()) >= 12
    for name, example in gallery().items():
        assert "\n\nSource: " in (example.__doc__ or ""), name
        assert f"/{name}.py`. Source: " in page


@pytest.mark.parametrize(
    ("reference", "found", "digits", "met"),
    [
        ("0.706", 0.70599606971337, 3, True),
        ("0.706", 0.7066, 3, False),
        ("20.05", 20.0509536, 4, True),
        ("20.05", 20.056, 3, False),
        ("-5.80004602", -5.8000460208, 9, True),
        ("30.1200", 30.12004, 5, True),
        (0.5, 0.5, 10, True),
        (0.5, 0.5000001, 6, True),
        (0.5, 0.50001, 4, False),
        (0.5, -0.5, 0, False),
    ],
)
def test_digits(reference: str | float, found: float, digits: int, met: bool) -> None:
    assert judged(reference, found) == (digits, met)


def test_the_command_prints_the_table(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["blade_flap"]) == 0
    said = capsys.readouterr().out.splitlines()
    assert said[1].startswith("blade_flap: Flapping of a helicopter's blade")
    assert said[2].split()[-3:] == ["-0.375", "-0.375", "10"]
    assert said[-1].startswith("5 of 5 numbers are met, in ")


def test_a_number_that_is_not_met_is_an_exit_status(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(gallery()["mathieu"], "numbers", lambda: [("one", "1.00", 1.0), ("wrong", 2.0, 2.1)])
    assert main(["mathieu"]) == 1
    said = capsys.readouterr().out
    assert said.count("NOT MET") == 1
    assert "1 of 2 numbers are met" in said


def test_what_there_is_is_listed(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--list"]) == 0
    said = capsys.readouterr().out
    assert all(f"{name}.py\n" in said for name in gallery())
    assert main(["mathiu"]) == 2
    assert capsys.readouterr().err.endswith("did you mean mathieu?\n")


@pytest.mark.slow
def test_the_whole_gallery(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--output", str(tmp_path / "out")]) == 0
    assert "NOT MET" not in capsys.readouterr().out
    assert len(list((tmp_path / "out").glob("*.png"))) == len(gallery())
    assert PAGE.read_text(encoding="utf-8").partition(MARK)[2] == "\n" + body()
