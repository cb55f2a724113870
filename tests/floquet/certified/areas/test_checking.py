"""The checker of certificates: it says yes to what was proved, and no to whatever was changed."""

from __future__ import annotations

import ast
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from periodic import PeriodicSystem
from periodic.examples import coupled_mathieu, gyroscopic_rotor, mathieu
from tests.paths import ROOT

pytest.importorskip("flint", reason="python-flint, the extra certify, is not installed")

from floquet.certified import prove_chart
from floquet.certified.areas import chart as chart_module
from floquet.certified.checking import check

SINE = PeriodicSystem(np.eye(2), stiffness=np.diag([1.0, 2.9]), sine=[[[0.2, 1.0], [-0.7, 0.1]]])
WINDOWS: dict[str, tuple[Any, ...]] = {
    "coupled": (coupled_mathieu(), (2.6, 2.8), (0.1, 0.2)),
    "difference": (coupled_mathieu("difference"), (0.66, 0.68), (0.1, 0.15)),
    "damped": (coupled_mathieu(damping=(0.02, 0.04)), (2.6, 2.7), (0.1, 0.2)),
    "sine": (SINE, (2.6, 2.8), (0.1, 0.2)),
    "rotor": (gyroscopic_rotor((4.0, 5.0)), (4.0, 4.3), (0.1, 0.2)),
}


@pytest.fixture(scope="module")
def certificate(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A small one, of Mathieu's equation with a bystander that is not excited, with an edge in it."""
    system = PeriodicSystem(np.eye(2), stiffness=np.diag([1.0, 0.7]), cosine=[np.diag([1.0, 0.0])])
    path = tmp_path_factory.mktemp("certificates") / "chart.npz"
    prove_chart(system, (1.9, 2.1), (0.0, 0.12), n_jobs=1, progress=False).save(path)
    return path


def changed(path: Path, folder: Path, change: Callable[[dict[str, Any]], None], *, sign: bool) -> Path:
    """Write the arrays of a certificate with a change; ``sign``: with a digest that fits them."""
    with np.load(path) as file:
        arrays = {name: file[name].copy() for name in file.files}
    change(arrays)
    if sign:
        arrays["digest"] = np.array(chart_module._digest({k: v for k, v in arrays.items() if k != "digest"}))
    np.savez(folder / "changed.npz", **arrays)
    return folder / "changed.npz"


def test_a_certificate_holds(certificate: Path) -> None:
    assert check(str(certificate)) == ""


@pytest.mark.slow
@pytest.mark.parametrize("name", WINDOWS)
def test_certificates_of_all_sorts_hold(name: str, tmp_path: Path) -> None:
    prove_chart(*WINDOWS[name], least=1 / 16, progress=False).save(tmp_path / "chart.npz")
    assert check(str(tmp_path / "chart.npz")) == ""


def test_a_bit_flipped_in_any_field_is_noticed(certificate: Path, tmp_path: Path) -> None:
    rng = np.random.default_rng(3)
    with np.load(certificate) as file:
        names = [name for name in file.files if file[name].size]
    assert len(names) > 20
    for name in names:

        def flip(arrays: dict[str, Any], name: str = name) -> None:
            flat = arrays[name].reshape(-1)
            bits = flat.view(np.uint8)
            if arrays[name].dtype == bool:
                flat[0] = ~flat[0]
            elif arrays[name].dtype.kind == "U":
                arrays[name] = np.array(str(arrays[name]).replace("1", "2", 1).replace("stable", "open"))
            else:
                bits[rng.integers(len(bits))] ^= 1 << rng.integers(8)

        assert check(str(changed(certificate, tmp_path, flip, sign=False))), name


def scaled(name: str, factor: float) -> Callable[[dict[str, Any]], None]:
    def change(arrays: dict[str, Any]) -> None:
        arrays[name] = (arrays[name] * factor).astype(arrays[name].dtype)

    return change


def put(name: str, value: Any) -> Callable[[dict[str, Any]], None]:
    def change(arrays: dict[str, Any]) -> None:
        arrays[name].reshape(-1)[0] = value

    return change


def without_signs(arrays: dict[str, Any]) -> None:
    """Claim that all cells are stable."""
    for name in ("signs_0", "coef_0", "sign_radius_0"):
        arrays[name] = arrays[name][:0]
    arrays["first_sign_0"] *= 0
    arrays["first_coef_0"] = arrays["first_coef_0"][:1]


LIES: dict[str, Callable[[dict[str, Any]], None]] = {
    "another stiffness": scaled("stiffness", 1 + 1e-6),
    "another excitation": scaled("cosine", 1 + 1e-5),
    "a larger window": put("window", 1.8),
    "smaller radii": scaled("sign_radius_0", 0.0),
    "signs turned round": scaled("coef_0", -1.0),
    "a polynomial moved a little": lambda arrays: arrays["coef_0"].__setitem__(0, arrays["coef_0"][0] + 1e-8),
    "a patch moved": lambda arrays: arrays["patches_0"].__setitem__((0, 0), arrays["patches_0"][0, 0] * (1 + 1e-7)),
    "a cell made narrower": lambda arrays: arrays["leaves_0"].__setitem__((0, 1), arrays["leaves_0"][0, 1] / 2),
    "all stable": without_signs,
    "another sign": lambda arrays: arrays["signs_0"].__setitem__((0, 1), 1 - arrays["signs_0"][0, 1]),
    "clusters that do not add up": lambda arrays: arrays["sizes_0"].__setitem__((0, 0), 1),
    "coordinates left out": lambda arrays: arrays.__setitem__("coordinates_0", np.array([1])),
    "the bystander unstable": scaled("stiffness", -1.0),
}


@pytest.mark.parametrize("lie", LIES)
def test_a_lie_is_noticed_even_if_the_digest_fits(certificate: Path, tmp_path: Path, lie: str) -> None:
    wrong = check(str(changed(certificate, tmp_path, LIES[lie], sign=True)))
    assert wrong
    assert "digest" not in wrong
    assert wrong != "Refused: the file was changed"


def test_the_checker_shares_no_code() -> None:
    """It imports itself, python-flint, and Python's own library."""
    for file in (ROOT / "floquet" / "certified" / "checking").glob("*.py"):
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            names += [node.module or ""] if isinstance(node, ast.ImportFrom) else []
            for name in names:
                assert name.startswith("floquet.certified.checking") or name.split(".")[0] in {
                    "flint",
                    *sys.stdlib_module_names,
                }, (file.name, name)


def test_mathieu_cannot_be_had_for_nothing(tmp_path: Path) -> None:
    """Nothing is proved without time: such a certificate is right, and says so little."""
    chart = prove_chart(mathieu(), (1.5, 2.5), (0.0, 0.4), seconds=1e-9, progress=False)
    chart.save(tmp_path / "chart.npz")
    assert check(str(tmp_path / "chart.npz")) == ""
