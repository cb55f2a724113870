"""scripts/certify.py: what it prints, what it refuses, and its exit status."""

from __future__ import annotations

import importlib.util
import re
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from floquet import monodromy
from periodic.examples import mathieu
from plate import MovingPlate
from tests.paths import ROOT

pytest.importorskip("flint", reason="python-flint, the extra certify, is not installed")

Run = Callable[..., tuple[int, str, str]]


@pytest.fixture
def certify(capsys: pytest.CaptureFixture[str]) -> Run:
    """Run the script's main with these arguments; return exit status, output and error output."""
    spec = importlib.util.spec_from_file_location("certify", ROOT / "scripts" / "certify.py")
    assert spec is not None
    assert spec.loader is not None
    script = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(script)

    def run(*arguments: str) -> tuple[int, str, str]:
        try:
            status = script.main(list(arguments))
        except SystemExit as exit:
            status = exit.code
        return status, *capsys.readouterr()

    return run


def bounds(output: str) -> tuple[float, float]:
    found = re.search(r"growth rate in \[(\S+), (\S+)\]", output)
    assert found is not None
    return float(found[1]), float(found[2])


def test_help_teaches(certify: Run) -> None:
    status, output, _ = certify("--help")
    assert status == 0
    for word in ("examples:", "--at", "exit status", "undecided", "docs/certify.md", "certify]"):
        assert word in output


def test_unstable_point(certify: Run) -> None:
    """First order: growth rate eps / (4 omega) at Omega = 2 omega, here within 2 %."""
    status, output, _ = certify("--example", "mathieu", "--at", "2,0.2")
    lower, upper = bounds(output)
    assert status == 0
    assert "unstable" in output
    assert lower <= upper
    assert lower == pytest.approx(0.05, rel=0.02)


def test_stable_point_and_several_points(certify: Run) -> None:
    status, output, _ = certify("--example", "rotor", "--set", "stiffness=4,5", "--at", "3,0.2", "--at", "2.9,-0.2")
    assert status == 0
    assert output.count(": stable") == 2
    assert bounds(output) == (0, 0)
    assert "stiffness=[4, 5], spin=0.5" in output


def test_undecided_point_has_its_own_exit_status(certify: Run) -> None:
    status, output, _ = certify("--example", "mathieu", "--at", "2,1e-300")
    assert status == 1
    assert "undecided (512 bits)" in output


def test_bits_are_respected(certify: Run) -> None:
    assert "undecided (128 bits)" in certify("--example", "mathieu", "--at", "2,1e-60", "--bits", "128")[1]
    assert "unstable" in certify("--example", "mathieu", "--at", "2,1e-60", "--bits", "512")[1]


FIG2 = str(ROOT / "cases" / "fig2.toml")


@pytest.mark.slow
def test_plate_of_a_case_is_the_one_that_is_proved(certify: Run) -> None:
    """Growth by `monodromy`; cut to 2 x 3 terms the plate has its region elsewhere and is stable here."""
    status, output, _ = certify("--case", FIG2, "--at", "71.3,0.3")
    assert status == 0
    assert "(n = 28 = 16 + 12)" in output
    assert ": unstable (128 bits)" in output
    assert "terms" not in output
    lower, upper = bounds(output)
    assert lower <= upper
    assert lower == pytest.approx(monodromy(MovingPlate(), 71.3, 0.3).growth_rate, abs=1e-10)


def test_a_smaller_plate_is_named_in_every_line(certify: Run) -> None:
    status, output, _ = certify("--case", FIG2, "--terms", "2,3", "--at", "71.3,0.3")
    assert status == 0
    assert ": stable" in output
    assert all("with 2 x 3 terms" in line for line in output.splitlines())


def test_a_plate_beyond_what_is_practical_is_refused(certify: Run) -> None:
    status, output, message = certify("--case", FIG2, "--at", "0.001,0.3")
    assert status == 2
    assert "stable" not in output
    for advice in ("higher Omega", "fewer coordinates", "--terms"):
        assert advice in message


def test_terms_are_respected(certify: Run) -> None:
    assert "(n = 2)" in certify("--case", FIG2, "--terms", "2,1", "--at", "18.6,0.3")[1]


def test_own_matrices(certify: Run, tmp_path: Path) -> None:
    system = mathieu(2.5)
    np.savez(tmp_path / "mine.npz", M=system.mass, K=system.stiffness, F1c=system.cosine[0])
    _, own, _ = certify("--system", str(tmp_path / "mine.npz"), "--at", "3.1,0.3")
    _, example, _ = certify("--example", "mathieu", "--set", "delta=2.5", "--at", "3.1,0.3")
    assert bounds(own) == bounds(example)


def test_terms_of_all_matrices_from_a_file(certify: Run, tmp_path: Path) -> None:
    """The same oscillator as two states: other names, the same growth."""
    one, damping = np.eye(1), 0.0625 * np.eye(1)
    np.savez(tmp_path / "second.npz", M=one, K=one, C=damping, C1s=0.5 * one, K1c=one, K2c_2=0.25 * one)
    A, D = np.array([[0.0, 1.0], [-1.0, -0.0625]]), np.array([[0.0, 0.0], [0.0, -0.5]])
    F = np.array([[0.0, 0.0], [-1.0, 0.0]])
    np.savez(tmp_path / "first.npz", A=A, A1s=D, A1c=F, A2c_2=0.25 * F)
    _, second, _ = certify("--system", str(tmp_path / "second.npz"), "--at", "2.1,0.5")
    _, first, _ = certify("--system", str(tmp_path / "first.npz"), "--at", "2.1,0.5")
    assert bounds(second) == pytest.approx(bounds(first), abs=1e-15)
    assert bounds(second)[1] < -1e-3
    assert "second.npz (n = 1)" in second
    assert "first.npz (n = 2)" in first


def test_waveforms_from_a_python_file(certify: Run, tmp_path: Path) -> None:
    """Meissner's equation: the trace of the monodromy matrix in closed form."""
    (tmp_path / "wave.py").write_text(
        "from periodic import PeriodicSystem, Term, waveforms\n"
        "def system():\n"
        "    terms = [Term('stiffness', [[1.0]], waveforms.rectangular(0.5))]\n"
        "    return PeriodicSystem([[1.0]], stiffness=[[1.0]], terms=terms)\n"
    )
    status, output, _ = certify("--system", str(tmp_path / "wave.py"), "--at", "2,0.5")
    a, b, half = np.sqrt(1.5), np.sqrt(0.5), np.pi / 2
    trace = 2 * np.cos(a * half) * np.cos(b * half) - (a / b + b / a) * np.sin(a * half) * np.sin(b * half)
    assert status == 0
    assert bounds(output) == pytest.approx(2 * [np.arccosh(-trace / 2) / np.pi], abs=1e-14)


def test_pulsating_speed_is_named_with_what_was_changed(certify: Run) -> None:
    """All parameters are in the title, and the line says about which system the sentence is."""
    beam = ["--example", "beam", "--set", "speed=0.6", "--set", "flexural_rigidity=0.64"]
    status, output, _ = certify(*beam, "--at", "20,0.3")
    assert status == 0
    assert ": stable" in output
    assert "speed=0.6, flexural_rigidity=0.64" in output
    assert "K - K^T = G'" in output
    output = certify("--example", "plate", "--set", "speed_amplitude=0.5", "--set", "axial_terms=2", "--at", "60,0.3")[
        1
    ]
    assert "plate under a uniform load(" in output
    assert "speed_amplitude=0.5" in output


@pytest.mark.parametrize(
    ("arguments", "fault"),
    [
        (["--at", "1,1"], "--case"),
        (["--example", "mathieu"], "--at"),
        (["--example", "duffing", "--at", "1,1"], "duffing"),
        (["--example", "mathieu", "--case", "x.toml", "--at", "1,1"], "not allowed"),
        (["--example", "mathieu", "--at", "1"], "'1' is no point"),
        (["--example", "mathieu", "--at", "0,1"], "'0,1' is no point"),
        (["--example", "mathieu", "--at", "1,nan"], "no point"),
        (["--example", "mathieu", "--at", "1,2,3"], "no point"),
        (["--example", "mathieu", "--set", "delta", "--at", "1,1"], "NAME=VALUE"),
        (["--example", "mathieu", "--set", "mass=1", "--at", "1,1"], "delta, damping"),
        (["--example", "mathieu", "--set", "delta=heavy", "--at", "1,1"], "delta = 'heavy'"),
        (["--example", "coupled", "--set", "frequencies=1,2,3", "--at", "1,1"], "two numbers"),
        (["--example", "mathieu", "--terms", "2,2", "--at", "1,1"], "--terms"),
        (["--example", "beam", "--set", "speed=0.6", "--at", "1,1"], "--set flexural_rigidity"),
        (["--example", "plate", "--set", "load=1", "--at", "1,1"], "--set load"),
        (["--case", "cases/fig2.toml", "--set", "speed=1", "--at", "1,1"], "--set"),
        (["--case", "cases/fig2.toml", "--terms", "2", "--at", "1,1"], "two whole numbers"),
        (["--case", "no such.toml", "--at", "1,1"], "no such.toml"),
        (["--system", "no such.npz", "--at", "1,1"], "no such.npz"),
        (["--example", "mathieu", "--at", "1e-9,1"], "higher Omega"),
        (["--example", "mathieu", "--at", "1,1", "--bits", "64"], "--bits = 64"),
        (["--example", "mathieu", "--at", "1,1", "--bits", "many"], "many"),
    ],
)
def test_wrong_input(certify: Run, arguments: list[str], fault: str) -> None:
    status, _, message = certify(*arguments)
    assert status == 2
    assert fault in message
    assert "Traceback" not in message


def test_missing_flint(certify: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "flint", None)
    monkeypatch.delitem(sys.modules, "floquet.certified", raising=False)
    status, _, message = certify("--example", "mathieu", "--at", "1,1")
    assert status == 2
    assert "floquet-charts[certify]" in message


def test_a_window_is_proved(certify: Run, tmp_path: Path) -> None:
    """First order: at eps = 0.1 unstable between 1.95 and 2.05; a certificate and a picture are written."""
    from floquet.certified import ProvedChart

    name = str(tmp_path / "sub" / "mathieu")
    status, output, _ = certify("--example", "mathieu", "--window", "1.8:2.2", "0:0.2", "--output", name)
    assert status == 0
    assert re.search(r"99\.99\d+ % proved", output)
    chart = ProvedChart.load(f"{name}.npz")
    assert [str(chart.verdict(Omega, 0.1)) for Omega in (1.94, 2.0, 2.06)] == ["stable", "unstable", "stable"]
    assert Path(f"{name}.png").read_bytes().startswith(b"\x89PNG")


def test_what_is_no_window_is_refused(certify: Run) -> None:
    for arguments, message in (
        ((), "nothing is asked"),
        (("--window", "2:1", "0:0.2"), "lower value first"),
        (("--window", "2", "0:0.2"), "no interval"),
        (("--window", "1:2", "0:0.2", "--seconds", "0"), "seconds"),
    ):
        status, _, error = certify("--example", "mathieu", *arguments)
        assert status == 2
        assert message in error
