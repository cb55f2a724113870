"""Case files: what they mean, and errors that name file, table and key."""

from __future__ import annotations

from pathlib import Path

import pytest

from beam import MovingBeam
from compare.files.cases import load_case
from plate import MovingPlate
from tests.paths import ROOT


def _case(tmp_path: Path, text: str) -> Path:
    path = tmp_path / "mine.toml"
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.parametrize("path", sorted((ROOT / "cases").glob("*.toml")), ids=lambda path: path.stem)
def test_every_case_that_we_ship_can_be_read(path: Path) -> None:
    case = load_case(path)
    assert case.name == path.stem
    model = MovingPlate if case.beam is None else MovingBeam
    assert all(isinstance(system, model) for system in case.systems().values())


def test_what_is_left_out_keeps_the_default(tmp_path: Path) -> None:
    plate = load_case(_case(tmp_path, 'title = "t"')).plates("this test")[""]
    assert plate.speed == MovingPlate().speed
    assert plate.inplane == MovingPlate().inplane


def test_a_variant_replaces_entries_of_the_plate(tmp_path: Path) -> None:
    text = """
    title = "t"
    [plate]
    speed = 2
    [[variants]]
    label = "slow"
    [[variants]]
    label = "tight"
    plate = {tension = 20.0, load = {shape = "partial", parameters = {width = 0.5}}}
    """
    systems = load_case(_case(tmp_path, text)).plates("this test")
    assert (systems["slow"].speed, systems["slow"].tension) == (2.0, MovingPlate().tension)
    assert (systems["tight"].speed, systems["tight"].tension) == (2.0, 20.0)
    assert systems["tight"].load != systems["slow"].load


def test_a_beam_and_what_changes_it(tmp_path: Path) -> None:
    text = """
    title = "t"
    regions = [[1, 1]]
    [beam]
    speed = 2
    flexural_rigidity = 0.64
    [[variants]]
    label = "damped"
    beam = {damping = 1e-3, terms = 6}
    """
    case = load_case(_case(tmp_path, text))
    assert case.systems() == {"damped": MovingBeam(2.0, 0.64, damping=1e-3, terms=6)}
    with pytest.raises(ValueError, match=r"a sweep is about plates, and the case 'mine' is about a beam"):
        case.plates("a sweep")


@pytest.mark.parametrize(
    ("text", "wanted"),
    [
        ('title = "t"\n[beam]\nspeed = 1.0', r"mine\.toml: \[beam\] flexural_rigidity: missing"),
        ('title = "t"\n[beam]\nspeed = 1.0\nflexural_rigidity = 1.0\nmass = 1', r"\[beam\] mass: unknown key"),
        ('title = "t"\n[plate]\n[beam]\nspeed = 1.0\nflexural_rigidity = 1.0', r"about one of them"),
        ('title = "t"\n[[variants]]\nlabel = "a"\nbeam = {speed = 1.0}', r"no \[beam\]; add it"),
        ("", r"mine\.toml: title: missing"),
        ('title = "t"\n[plat]\n', r"mine\.toml: plat: unknown key"),
        ('title = "t"\n[plate]\nsped = 3.0', r"mine\.toml: \[plate\] sped: unknown key"),
        ('title = "t"\n[plate]\nspeed = "3"', r"mine\.toml: \[plate\]: speed = '3' is no quantity in m/s"),
        ('title = "t"\n[plate]\nspeed = true', r"mine\.toml: \[plate\] speed: .*a finite number"),
        ('title = "t"\n[plate]\nspeed = nan', r"mine\.toml: \[plate\] speed"),
        ('title = "t"\n[plate]\nspeed = 9.0', r"mine\.toml: \[plate\].*speed.*4\.4"),
        ('title = "t"\n[plate]\naspect_ratio = -1.0', r"mine\.toml: \[plate\].*aspect_ratio"),
        ('title = "t"\n[plate.load]\nshape = "round"', r"mine\.toml: \[plate\.load\] shape: .*'round'"),
        ('title = "t"\n[plate.load]\nshape = "partial"', r"mine\.toml: \[plate\].*'partial'.*width"),
        ('title = "t"\n[chart]\nOmega = [5.0, 1.0]', r"mine\.toml: chart: .*Omega"),
        ('title = "t"\n[chart]\npoints = [0, 4]', r"mine\.toml: \[chart\.points\] 0"),
        ('title = "t"\n[chart]\npoints = [1, 4]', r"mine\.toml: \[chart\.points\] 0"),
        ('title = "t"\n[chart]\npoints = [4, 1000000000]', r"mine\.toml: \[chart\.points\] 1"),
        ('title = "t"\n[chart]\neps = inf', r"mine\.toml: \[chart\] eps"),
        ('title = "t"\nname = "../elsewhere"', r"mine\.toml: name: .*'\.\./elsewhere'"),
        ('title = "t"\nregions = [[1]]', r"mine\.toml: \[regions\.0\] 1"),
        ('title = "t"\nregions = []', r"mine\.toml: regions: "),
        ('title = "t"\nregions = [[1, 29]]', r"mine\.toml: regions names mode 29, .* 28 modes"),
        ('title = "t"\nvariants = []', r"mine\.toml: .*variants"),
        (
            'title = "t"\n[[variants]]\nlabel = "a"\nplate = {sped = 1.0}',
            r"mine\.toml: \[variants\.plate\] of 'a': sped",
        ),
        ("title = ", r"mine\.toml: not a TOML file"),
    ],
)
def test_an_error_names_file_table_and_key(tmp_path: Path, text: str, wanted: str) -> None:
    with pytest.raises(ValueError, match=wanted):
        load_case(_case(tmp_path, text))


def test_a_file_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"nowhere\.toml: cannot be read"):
        load_case(tmp_path / "nowhere.toml")
