"""scripts/explore.py as a command: what it writes, what it says, and that nothing is left half-written."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from compare.files import save_system
from floquet import StabilityChart, stability_chart
from floquet_scripts import explore
from periodic.examples import coupled_mathieu, mathieu
from tests.finite_elements import column
from tests.small_case import SMALL_CASE

VARIANTS = """
[[variants]]
label = "slow"
plate = {speed = 1.0}
[[variants]]
label = "half as wide"
plate = {load = {shape = "partial", parameters = {width = 0.5}}}
"""
Run = Callable[..., tuple[int, str, str]]


@pytest.fixture
def run(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> Run:
    """Run the script's main in a folder of its own; return exit status, output and error output."""
    save_system(tmp_path / "pair.npz", coupled_mathieu())
    save_system(tmp_path / "trap.mat", mathieu(-0.3))
    (tmp_path / "two.toml").write_text(SMALL_CASE + VARIANTS, encoding="utf-8")

    def run(*arguments: object) -> tuple[int, str, str]:
        given = [str(tmp_path / str(a)) if (tmp_path / str(a)).is_file() else str(a) for a in arguments]
        try:
            status = explore.main(["--output", str(tmp_path / "out"), "--no-progress", "--jobs", "1", *given])
        except SystemExit as stop:  # argparse
            status = int(stop.code or 0)
        captured = capsys.readouterr()
        return status, captured.out, captured.err

    return run


def _written(tmp_path: Path) -> list[str]:
    return sorted(path.name for path in (tmp_path / "out").iterdir())


def test_a_system_in_a_window_of_ones_own(run: Run, tmp_path: Path) -> None:
    status, said, errors = run("--system", "pair.npz", "--Omega", 2.0, 3.5, "--eps", 1.0, "--points", 20, 10)
    assert (status, errors) == (0, "")
    assert _written(tmp_path) == [
        "pair-chart.png",
        "pair-overlay.pdf",
        "pair-overlay.png",
        "pair-regions.json",
        "pair.npz",
    ]
    assert "ω₁+ω₂" in said
    assert all(name in said for name in _written(tmp_path))
    chart = StabilityChart.load(tmp_path / "out" / "pair.npz")
    expected = stability_chart(coupled_mathieu(), np.linspace(2, 3.5, 20), np.linspace(0, 1, 10), progress=False)
    np.testing.assert_array_equal(chart.growth_rate, expected.growth_rate)


def test_a_system_chooses_its_window_and_may_have_no_theory(run: Run, tmp_path: Path) -> None:
    status, said, _ = run("--system", "trap.mat", "--points", 16, 8, "--no-regions")
    assert status == 0
    assert "from Ω" not in said
    assert said.count("There are no analytic curves: no resonance starts in the window") == 1
    assert "trap.npz" in _written(tmp_path)


def test_a_finite_element_model_is_explored_in_its_lowest_modes(run: Run, tmp_path: Path) -> None:
    save_system(tmp_path / "column.npz", column(50))
    status, said, errors = run("--system", "column.npz", "--points", 24, 8)
    assert (status, errors) == (0, "")
    assert "lowest of 100 modes" in said
    assert "within the estimated error" in said
    assert "2ω₁" in said


def test_the_variants_of_a_case(run: Run, tmp_path: Path) -> None:
    status, said, _ = run("--case", "two.toml")
    assert status == 0
    assert "this is the variant 'slow'; --variant also takes 'half as wide'" in said
    status, _, _ = run("--case", "two.toml", "--variant", "half as wide", "--eps", 0.1)
    assert status == 0
    assert {"two-slow.npz", "two-half-as-wide.npz"} <= set(_written(tmp_path))
    chart = StabilityChart.load(tmp_path / "out" / "two-half-as-wide.npz")
    assert (chart.Omega[0], chart.Omega[-1], chart.Omega.size, chart.eps[-1]) == (15.0, 28.0, 12, 0.1)


def test_a_sweep(run: Run, tmp_path: Path) -> None:
    status, said, _ = run("--case", "two.toml", "--sweep", "speed=0:5:6")
    assert status == 0
    assert "speed = 5 is left out" in said
    assert _written(tmp_path) == [f"two-slow-speed.{suffix}" for suffix in ("csv", "npz", "pdf", "png")]


@pytest.mark.parametrize(
    ("arguments", "wanted"),
    [
        (["--system", "nowhere.npz"], "nowhere.npz: cannot be read"),
        (["--case", "nowhere.toml"], "nowhere.toml: cannot be read"),
        (["--case", "two.toml", "--variant", "fast"], "variant = 'fast' is not known; give one of 'slow'"),
        (["--variant", "fast"], "--variant belongs to a case"),
        (["--system", "pair.npz", "--case", "two.toml"], "not allowed with argument"),
        (["--system", "pair.npz", "--Omega", 3, 2], "--Omega = (3.0, 2.0) is empty"),
        (["--system", "pair.npz", "--Omega", "nan", 2], "--Omega[0] = nan"),
        (["--system", "pair.npz", "--eps", 0], "--eps = 0.0"),
        (["--system", "pair.npz", "--points", 1, 1], "points = 1"),
        (["--system", "pair.npz", "--order", 3], "--order"),
        (["--system", "pair.npz", "--jobs", 0], "'0' is no number of workers"),
        (["--system", "pair.npz", "--sweep", "speed=0:1:2"], "--sweep changes a parameter of the plate"),
        (["--all-modes"], "--all-modes belongs to a system"),
        (["--sweep", "speed=0:1"], "is not NAME=LOW:HIGH:COUNT"),
        (["--sweep", "speed=0:1:1000000000"], "asks for 1000000000 values; give 2 to 1000"),
        (["--sweep", "speed=0:1:-3"], "is not NAME=LOW:HIGH:COUNT"),
        (["--sweep", "colour=0:1:3"], "--sweep = 'colour' is not known; give one of 'speed'"),
        (["--sweep", "speed=0:1:3", "--html"], "--html has no meaning with --sweep"),
        (["--sweep", "speed=0:1:3", "--points", 8, 4], "--points has no meaning with --sweep"),
        (["--serve", "--no-regions"], "--no-regions has no meaning with --serve"),
        (["--serve", "--sweep", "speed=0:1:3"], "--sweep has no meaning with --serve"),
        (["--sweep", "speed=1:0:3"], "not strictly increasing"),
        (["--serve", "--port", 99999], "port = 99999"),
    ],
)
def test_wrong_input_is_one_sentence_and_writes_nothing(
    run: Run, tmp_path: Path, arguments: list[object], wanted: str
) -> None:
    if "--serve" in arguments:
        pytest.importorskip("bokeh")
    status, _, errors = run(*arguments)
    assert status == 2
    assert wanted in errors
    assert "Traceback" not in errors
    assert not (tmp_path / "out").exists() or _written(tmp_path) == []


def test_an_old_result_survives_a_failure(run: Run, tmp_path: Path) -> None:
    assert run("--system", "pair.npz", "--points", 8, 4)[0] == 0
    before = {path.name: path.read_bytes() for path in (tmp_path / "out").iterdir()}
    assert run("--system", "pair.npz", "--points", 8, 4, "--eps", -1)[0] == 2
    assert {path.name: path.read_bytes() for path in (tmp_path / "out").iterdir()} == before


def test_without_bokeh_it_says_what_to_install(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "bokeh", None)
    for name in [
        name for name in sys.modules if name.startswith(("bokeh.", "compare.explorer.page", "compare.explorer.live"))
    ]:
        monkeypatch.delitem(sys.modules, name)
    status, _, errors = run("--system", "pair.npz", "--points", 8, 4, "--html")
    assert (status, errors) == (
        2,
        "explore: --html needs bokeh; install it with: pip install 'floquet-charts[explore]'\n",
    )


def test_help_teaches(run: Run) -> None:
    status, said, _ = run("--help")
    assert status == 0
    for word in ("--case fig4", "--system mine.npz", "--sweep speed=0:4.3:40", "docs/matrices.md"):
        assert word in said
