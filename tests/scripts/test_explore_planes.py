"""scripts/explore.py over any two parameters: what it writes, what it says, and what it refuses."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from floquet import PlaneChart, Point, plane_chart
from floquet_scripts import explore
from periodic.examples import mathieu

SYSTEM = """
from periodic import PeriodicSystem

def system(a, q, damping=0.0):
    if a > 3:
        raise ValueError("a is too large")
    return PeriodicSystem([[1.0]], damping=[[damping]], stiffness=[[a]], cosine=[[2 * q]])
"""
POINTS = """
from floquet import Point
from periodic.examples import mathieu

def system(a, q):
    return Point(mathieu(delta=a), Omega=2.0, eps=2 * q)
"""
NAMELESS = """
def system(*values):
    return None
"""
A_Q = ("--x", "a=0.1:2:4", "--y", "q=0.1:0.7:3")
Run = Callable[..., tuple[int, str, str]]


@pytest.fixture
def run(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> Run:
    """Run the script's main; return exit status, output and error output."""
    for name, text in (("mine.py", SYSTEM), ("points.py", POINTS), ("nameless.py", NAMELESS)):
        (tmp_path / name).write_text(text, encoding="utf-8")

    def run(*arguments: str) -> tuple[int, str, str]:
        given = [str(tmp_path / a) if a.endswith(".py") else a for a in arguments]
        try:
            status = explore.main(["--output", str(tmp_path / "out"), "--no-progress", "--jobs", "1", *given])
        except SystemExit as end:
            status = int(end.code or 0)
        return (status, *capsys.readouterr())

    return run


def test_a_function_of_ones_own(run: Run, tmp_path: Path) -> None:
    status, said, _ = run("--system", "mine.py", *A_Q, "--set", "Omega=2", "--netcdf")
    assert status == 0
    assert "2ω₁: at −1" in said
    names = ["mine-a-q-boundaries.json", "mine-a-q.nc", "mine-a-q.npz", "mine-a-q.pdf", "mine-a-q.png"]
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == names
    chart = PlaneChart.load(tmp_path / "out" / "mine-a-q.npz")
    same = plane_chart(
        lambda a, q: Point(mathieu(a), 2.0, 2 * q), ("a", chart.x), ("q", chart.y), progress=False, audit=0
    )
    np.testing.assert_array_equal(chart.kind, same.kind)
    np.testing.assert_allclose(chart.growth_rate, same.growth_rate, rtol=0, atol=1e-9)
    lines = json.loads((tmp_path / "out" / "mine-a-q-boundaries.json").read_text(encoding="utf-8"))
    assert {line["label"] for line in lines} == {"2ω₁"}


def test_a_function_that_returns_points(run: Run, tmp_path: Path) -> None:
    assert run("--system", "points.py", *A_Q, "--no-regions")[0] == 0
    assert json.loads((tmp_path / "out" / "points-a-q-boundaries.json").read_text()) is None
    one = PlaneChart.load(tmp_path / "out" / "points-a-q.npz")
    assert run("--plane", "mathieu", *A_Q, "--no-regions")[0] == 0
    other = PlaneChart.load(tmp_path / "out" / "mathieu-a-q.npz")
    np.testing.assert_array_equal(one.growth_rate, other.growth_rate)


def test_a_plate(run: Run, tmp_path: Path) -> None:
    status, said, _ = run("--x", "speed=3:6:3", "--y", "Omega=20:30:3", "--set", "eps=.2", "--no-regions")
    assert status == 0
    assert "6 of 9 cells are no system, first speed = 4.5, Omega = 20.0: speed = 4.5 is not below" in said
    assert PlaneChart.load(tmp_path / "out" / "plate-speed-Omega.npz").refused.sum() == 6


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--x", "a=0:1:3"), "--x alone is no plane; add --y NAME=LOW:HIGH:COUNT"),
        (("--set", "eps=2"), "--set belongs to a plane; add --x and --y"),
        (("--plane", "trap"), "--plane belongs to a plane; add --x and --y"),
        (("--plane", "trapp", *A_Q), "did you mean trap?"),
        (("--plane", "trap", "--x", "q=0:1:3", "--y", "b=0:1:3"), "has no parameter 'b'; it has a, q, waveform, duty"),
        (("--x", "speed=0:4:3", "--y", "omega=1:2:3"), "has no parameter 'omega'; it has .*did you mean Omega?"),
        (("--x", "speed=0:4:3", "--y", "Omega=1:2:3"), "needs a value of eps; add --set eps=VALUE"),
        (("--system", "mine.py", *A_Q), "mine.py needs a value of Omega; add --set Omega=VALUE"),
        (("--system", "mine.py", *A_Q, "--set", "a=2"), "a is given twice"),
        (("--system", "points.py", *A_Q, "--set", "Omega=2"), "points.py returns a Point, which has its own Omega"),
        (("--system", "nameless.py", *A_Q), "takes parameters without a name"),
        (
            ("--system", "mine.py", "--x", "a=4:5:3", "--y", "q=0:1:3", "--set", "Omega=2"),
            "refuses all 9 cells, first a = 4.0",
        ),
        ((*A_Q, "--html"), "--html has no meaning with --x and --y"),
        ((*A_Q, "--eps", "1"), "--eps has no meaning with --x and --y"),
        (("--x", "a=0-4", "--y", "q=1:2:3"), "--x 'a=0-4' is not NAME=LOW:HIGH:COUNT"),
        (("--x", "speed=0:4:3", "--y", "Omega=1:2:3", "--set", "eps"), "--set 'eps' is not NAME=VALUE"),
        (("--x", "speed=0:4:3", "--y", "Omega=1:2:3", "--set", "eps=big"), "eps = 'big' is not a number"),
        (
            ("--plane", "trap", "--x", "q=.1:1:3", "--y", "a=0:.2:3", "--set", "duty=.3"),
            "duty = 0.3 belongs to a rectangular",
        ),
        (
            ("--plane", "trap", "--x", "q=.1:1:3", "--y", "a=0:.2:3", "--set", "waveform=square"),
            "waveform = 'square' is not known",
        ),
    ],
)
def test_what_is_refused(run: Run, arguments: tuple[str, ...], message: str) -> None:
    import re

    status, _, error = run(*arguments)
    assert status == 2
    assert error.startswith("explore: ")
    assert error.count("\n") == 1
    assert re.search(message.replace("?", r"\?"), error), error
