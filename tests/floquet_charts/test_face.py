"""One import, one command: every public name is there, nothing is defined, and slips are explained."""

from __future__ import annotations

import importlib
import subprocess
import sys
import tomllib

import pytest

import floquet_charts as fc
from compare.files import load_case, load_system, save_system
from floquet_charts.__main__ import COMMANDS, main
from floquet_scripts import running
from floquet_scripts.compiling import COMPILING
from tests.paths import ROOT

ROOMS = ("periodic", "plate", "beam", "reduction", "perturb", "perturb.general", "floquet", "floquet.modes", "compare")


@pytest.mark.parametrize("room", ROOMS)
def test_every_public_name_is_handed_on(room: str) -> None:
    package = importlib.import_module(room)
    for name in package.__all__:
        assert getattr(fc, name) is getattr(package, name)
        assert name in dir(fc)


def test_nothing_else_is() -> None:
    offered = {name for room in ROOMS for name in importlib.import_module(room).__all__}
    assert set(fc.__all__) - offered == {"__version__", "examples", "load_system", "save_system"}
    assert (fc.load_system, fc.save_system) == (load_system, save_system)
    assert fc.examples is importlib.import_module("periodic.examples")


def test_a_slip_is_noticed() -> None:
    with pytest.raises(AttributeError, match="has no attribute 'MovngPlate'") as raised:
        fc.MovngPlate  # noqa: B018
    assert (raised.value.name, raised.value.obj) == ("MovngPlate", fc)  # what Python's "Did you mean" needs


def test_rooms_are_imported_when_they_are_needed() -> None:
    program = (
        "import sys, floquet_charts as fc\n"
        "print('numpy' in sys.modules)\n"
        "fc.PeriodicSystem, fc.MovingBeam\n"
        "print('numba' in sys.modules, 'matplotlib' in sys.modules)\n"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["False", "False", "False"]


def test_one_version() -> None:
    citation = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    assert f"\nversion: {fc.__version__}\n" in citation
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    assert "version" not in project["project"]


# ---- the command ----


def test_the_command_says_what_there_is(capsys: pytest.CaptureFixture[str]) -> None:
    for arguments in ([], ["--help"]):
        assert main(arguments) == 0
        said = capsys.readouterr().out
        assert all(f"\n  {name} " in said for name in COMMANDS)
    assert main(["--version"]) == 0
    assert capsys.readouterr().out == f"floquet-charts {fc.__version__}\n"
    assert main(["explor", "--eps", "1"]) == 2
    assert capsys.readouterr().err.endswith("did you mean explore?\n")


@pytest.mark.parametrize("name", COMMANDS)
def test_help_names_the_command_as_it_was_started(
    name: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    for started, command in (
        (f"scripts/{name}.py", f"scripts/{name}.py"),
        ("floquet-charts", f"floquet-charts {name}"),
    ):
        monkeypatch.setattr(sys, "argv", [started])
        with pytest.raises(SystemExit, match="0"):
            main([name, "--help"])
        said = capsys.readouterr().out
        assert said.startswith(f"usage: {command} ")
        assert f"\n  {command} " in said
        assert "{command}" not in said


def test_as_a_module() -> None:
    done = subprocess.run([sys.executable, "-m", "floquet_charts", "--version"], capture_output=True, text=True)
    assert (done.returncode, done.stdout) == (0, f"floquet-charts {fc.__version__}\n")


def test_slips_on_the_command_line(capsys: pytest.CaptureFixture[str]) -> None:
    slips = {
        "explore --omega 1 2": "explore: --omega is not known here; did you mean --Omega?; ",
        "certify --example matieu --at 1,1": "did you mean mathieu?; floquet-charts certify --help shows all",
        "certify --example mathieu --set detla=1 --at 1,1": "it has delta, damping; did you mean delta?",
        "explore --case fg4": "did you mean fig4?",
        "explore --Omega 5 4": "explore: --Omega = (5.0, 4.0) is empty; give low < high",
        "validate --system mine.npz --Omega -1 4": "validate: --Omega = -1.0 is out of range; give a positive number",
        "modes --at 1": "modes: argument --at: '1' is no point; give Omega > 0 and eps, such as 18.6,0.3; ",
        "modes --at 1,1 --case fig4 --variant midle": "variant = 'midle' is not known; give one of",
        "modes --at 1,1 --count 0": "modes: --count = 0 is out of range; give a whole number >= 1",
    }
    for line, sentence in slips.items():
        try:
            status: object = main(line.split())
        except SystemExit as stop:
            status = stop.code
        said = capsys.readouterr().err
        assert status == 2
        assert sentence in said
        assert said.count("\n") == 1


@pytest.mark.parametrize(("option", "package"), [("--netcdf", "xarray"), ("--html", "bokeh"), ("--serve", "bokeh")])
def test_a_missing_extra_is_noticed_before_the_work(
    option: str, package: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, package, None)
    monkeypatch.setattr(running, "run", lambda *_: pytest.fail("it computes"))
    assert main(["explore", option]) == 2
    assert f"{option} needs {package}; install it with: pip install" in capsys.readouterr().err


def test_a_shipped_case_by_its_name(tmp_path: object, monkeypatch: pytest.MonkeyPatch) -> None:
    assert load_case("fig4") == load_case(ROOT / "cases" / "fig4.toml")
    with pytest.raises(ValueError, match=r"^fig4\.toml: cannot be read"):
        load_case("fig4.toml")


# ---- modes ----


def test_modes_of_a_point(capsys: pytest.CaptureFixture[str], tmp_path: object) -> None:
    """The rates are those of `monodromy`, which shares no code with modes but the integration."""
    path = f"{tmp_path}/mine.npz"
    save_system(path, fc.examples.mathieu(damping=0.1))
    assert main(["modes", "--system", path, "--at", "2,0.5", "--output", f"{tmp_path}/out"]) == 0
    said = capsys.readouterr().out.splitlines()
    head, _, first, *rest = said[1:] if said[0] == COMPILING else said
    assert head == "mine.npz: Omega = 2, eps = 0.5, period = 3.14159"
    rate = fc.monodromy(fc.examples.mathieu(damping=0.1), 2.0, 0.5).growth_rate
    number, frequency, growth, _, modulus, *_ = first.split()
    assert (number, frequency) == ("1", "1")
    assert float(growth) == pytest.approx(rate, rel=1e-3)
    assert float(modulus) == pytest.approx(2.718281828 ** (rate * 3.14159265), rel=1e-5)
    assert f"the first grows tenfold in {2.302585093 / rate:.6g}" in rest
    assert rest[-1].endswith("out: multipliers.png, harmonics.png")
    assert main(["modes", "--system", path, "--at", "2,0.1"]) == 0
    assert "no mode grows" in capsys.readouterr().out
