"""docs/cases.md: its example can be read, and no key is forgotten."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from pydantic import BaseModel

from compare.files.cases import Beam, Case, Chart, Load, Plate, Variant, load_case
from plate import EdgeLoad, MovingPlate
from tests.paths import ROOT

PAGE = (ROOT / "docs" / "cases.md").read_text(encoding="utf-8")
TABLES = {
    "Top level": Case,
    "`[plate]`": Plate,
    "`[plate.load]`": Load,
    "`[beam]`": Beam,
    "`[chart]`": Chart,
    "`[[variants]]`": Variant,
}


def _section(title: str) -> str:
    return re.split(r"^## ", PAGE.split(f"## {title}\n", 1)[1], maxsplit=1, flags=re.MULTILINE)[0]


def test_the_example_can_be_read(tmp_path: Path) -> None:
    [example] = re.findall(r"^```toml\n(.*?)^```", PAGE, re.MULTILINE | re.DOTALL)
    path = tmp_path / "mine.toml"
    path.write_text(example, encoding="utf-8")
    systems = load_case(path).plates("this test")
    assert list(systems)[:2] == ["elastic", "damped"]
    assert systems["damped"].damping == 1e-4
    assert systems["elastic"].load.harmonics == 3
    last = list(systems.values())[-1]
    assert last.load == EdgeLoad.uniform().with_waveform({1: (1.0, 0.0), 2: (0.0, 0.1)})


@pytest.mark.parametrize(("title", "model"), TABLES.items(), ids=lambda value: str(value))
def test_every_key_is_listed_and_no_other(title: str, model: type[BaseModel]) -> None:
    listed = set(re.findall(r"^\| `(\w+)` \|", _section(title).split("| shape |")[0], re.MULTILINE))
    if model is Plate:
        rows = re.findall(r"^\| `(\w+)` \| `(\w+)` \|", _section("`[plate]` in SI units"), re.MULTILINE)
        listed |= {key for row in rows for key in row}
    sections = {"plate", "beam", "load", "chart", "variants"} if model is not Variant else set()
    assert listed == set(model.model_fields) - sections


def test_the_defaults_are_those_of_the_plate() -> None:
    plate = MovingPlate()
    for name, default in re.findall(r"^\| `(\w+)` \|.*\| ([^|]+) \|$", _section("`[plate]`"), re.MULTILINE):
        value = getattr(plate, name)
        if value is None:  # chosen by the aspect ratio
            value = getattr(plate.terms, name.removesuffix("_terms"))
            default = default.removeprefix("by aspect ratio; ").removesuffix(" for a square plate")
        assert default.strip('`"') == str(list(value) if isinstance(value, tuple) else value)


def test_every_shape_is_listed() -> None:
    listed = set(
        re.findall(r"`(\w+)`", " ".join(re.findall(r"^\| (`\w+`(?:, `\w+`)*) \|", _section("`[plate.load]`"), re.M)))
    )
    shapes = set(Load.model_fields["shape"].annotation.__args__)  # type: ignore[union-attr]
    assert shapes <= listed
