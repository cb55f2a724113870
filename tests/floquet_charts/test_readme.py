"""What the README and its companions say is so: its commands run as printed, versions and lists agree."""

from __future__ import annotations

import json
import re
import shlex
import tomllib
from pathlib import Path

import pytest

import floquet_charts as fc
from floquet_charts.__main__ import COMMANDS, main
from floquet_scripts.gallery import gallery
from tests.paths import ROOT

README = (ROOT / "README.md").read_text(encoding="utf-8")
NUMERALS = {21: "twenty-one", 22: "twenty-two", 23: "twenty-three", 24: "twenty-four"}


def commands() -> list[str]:
    """Return the commands of the README's shell blocks, as printed but for the comments."""
    blocks = re.findall(r"^```sh\n(.*?)^```", README, re.MULTILINE | re.DOTALL)
    return [line.partition("  #")[0] for block in blocks for line in block.splitlines()]


def test_the_readme_has_commands_and_they_are_ours() -> None:
    assert len(commands()) >= 2
    assert all(command.split()[0] == "floquet-charts" and command.split()[1] in COMMANDS for command in commands())


@pytest.mark.slow
@pytest.mark.parametrize("command", commands())
def test_a_command_of_the_readme_runs_as_printed(command: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(shlex.split(command)[1:]) == 0
    assert list((tmp_path / "output").glob("*.png"))


def test_one_version_everywhere() -> None:
    assert f"\nversion: {fc.__version__}\n" in (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    assert json.loads((ROOT / "codemeta.json").read_text(encoding="utf-8"))["version"] == fc.__version__
    assert f'set version = "{fc.__version__}"' in (ROOT / "recipe" / "meta.yaml").read_text(encoding="utf-8")


def test_the_recipe_asks_for_what_the_package_needs() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    needed = {name.replace(">=", " >=").replace("matplotlib ", "matplotlib-base ") for name in project["dependencies"]}
    recipe = (ROOT / "recipe" / "meta.yaml").read_text(encoding="utf-8")
    run = recipe.partition("  run:\n")[2].partition("\n\n")[0]
    assert {line.strip("- ") for line in run.splitlines()} == {*needed, f"python {project['requires-python']}"}


def test_the_gallery_is_as_large_as_they_say() -> None:
    number = NUMERALS[len(gallery())]
    pages = (README, (ROOT / "paper.md").read_text(encoding="utf-8"), COMMANDS["gallery"])
    assert all(f"{number} " in page for page in pages)


def test_every_reference_of_the_paper_is_there() -> None:
    cited = set(re.findall(r"@(\w+)", (ROOT / "paper.md").read_text(encoding="utf-8").partition("# Summary")[2]))
    listed = set(re.findall(r"^@\w+\{(\w+),", (ROOT / "paper.bib").read_text(encoding="utf-8"), re.MULTILINE))
    assert cited == listed
    assert len(cited) >= 5
