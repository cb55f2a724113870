"""The house in order: rooms of a size that can be overseen, one value for a name, and a way in that runs."""

from __future__ import annotations

import ast
import doctest
import importlib
import subprocess
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

import pytest
from setuptools import find_packages

from tests.paths import ROOT

MAX_FILES_IN_A_FOLDER = 14
MAX_LINES_IN_A_FILE = 400
# Top-level packages. The first are installed as they are, the second under the names that setup.py gives them; the
# third are not in the wheel.
INSTALLED, RENAMED, LEFT_OUT = (
    ("periodic", "plate", "beam", "reduction", "perturb", "floquet", "compare", "floquet_charts"),
    ("scripts", "cases", "examples"),
    ("benchmarks", "tests"),
)
# Packages that need a package of an extra.
NEEDED_EXTRAS = {"floquet.certified": "flint"}


def python_files() -> list[Path]:
    """Return the Python files that git knows, or would add."""
    command = ["git", "ls-files", "--cached", "--others", "--exclude-standard", "-z", "*.py"]
    listed = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout
    return [ROOT / name for name in filter(None, listed.split("\0")) if (ROOT / name).is_file()]


FILES = python_files()
PACKAGES = sorted(
    ".".join(file.parent.relative_to(ROOT).parts)
    for file in FILES
    if file.name == "__init__.py" and file.relative_to(ROOT).parts[0] in (*INSTALLED, "benchmarks")
)


def constants(file: Path) -> Iterator[tuple[str, str]]:
    """Yield name and value, as it is written, of every constant of a module."""
    for statement in ast.parse(file.read_text(encoding="utf-8")).body:
        if isinstance(statement, ast.AnnAssign) and statement.value is not None:
            targets: list[ast.expr] = [statement.target]
        elif isinstance(statement, ast.Assign):
            targets = statement.targets
        else:
            continue
        value = statement.value
        assert value is not None
        for target in targets:
            several = isinstance(target, ast.Tuple) and isinstance(value, ast.Tuple)
            pairs = zip(target.elts, value.elts, strict=True) if several else [(target, value)]  # type: ignore[attr-defined]
            for name, part in pairs:
                if isinstance(name, ast.Name) and name.id.isupper():
                    yield name.id, ast.unparse(part)


def test_no_folder_has_too_many_files() -> None:
    counts: dict[Path, int] = defaultdict(int)
    for file in FILES:
        counts[file.parent.relative_to(ROOT)] += 1
    crowded = {str(folder): count for folder, count in counts.items() if count > MAX_FILES_IN_A_FOLDER}
    assert not crowded, "give a part of them a folder of its own"


def test_no_file_is_too_long() -> None:
    lengths = {str(file.relative_to(ROOT)): len(file.read_text(encoding="utf-8").splitlines()) for file in FILES}
    long = {name: length for name, length in lengths.items() if length > MAX_LINES_IN_A_FILE}
    assert not long, "give a part of it a file of its own"


def test_one_name_has_one_value() -> None:
    values: dict[str, dict[str, list[str]]] = defaultdict(lambda: defaultdict(list))
    for file in FILES:
        if file.relative_to(ROOT).parts[0] in (*INSTALLED, *RENAMED, "benchmarks"):
            for name, value in constants(file):
                values[name][value].append(str(file.relative_to(ROOT)))
    several = {name: dict(found) for name, found in values.items() if len(found) > 1}
    assert not several, "say in the name what each bounds"


def test_every_package_is_in_the_wheel() -> None:
    folders = {file.parent.relative_to(ROOT) for file in FILES if file.parent != ROOT}
    top = {folder.parts[0] for folder in folders} - {"docs"}
    assert top == {*INSTALLED, *RENAMED, *LEFT_OUT}
    source = (ROOT / "setup.py").read_text(encoding="utf-8")
    rooms = next(ast.literal_eval(node.value) for node in ast.parse(source).body if isinstance(node, ast.Assign))
    assert rooms == [*INSTALLED]
    packed = set(find_packages(str(ROOT), include=[*rooms, *(f"{room}.*" for room in rooms)]))
    assert {".".join(folder.parts) for folder in folders if folder.parts[0] in INSTALLED} == packed


@pytest.mark.parametrize("name", PACKAGES)
def test_the_way_in_runs(name: str) -> None:
    """The docstring of each package shows how its parts work together, and its names are all there."""
    for needy, extra in NEEDED_EXTRAS.items():
        if f"{name}.".startswith(f"{needy}."):
            pytest.importorskip(extra, reason=f"{extra} is not installed")
    package = importlib.import_module(name)
    tried = doctest.testmod(package)
    assert tried.failed == 0
    assert tried.attempted > 0, f"{name}/__init__.py shows no example"
    names = package.__all__
    assert len(set(names)) == len(names)
    for exported in names:
        found = getattr(package, exported)
        file = ROOT.joinpath(*name.split("."), f"{exported}.py")
        assert not file.is_file() or getattr(found, "__file__", None) == str(file), f"{exported} hides a module"


def test_other_rooms_come_in_by_the_door() -> None:
    """An import from another room names the room, not a file inside it."""
    rooms = {package for package in PACKAGES if package.count(".") == 1}
    deep = []
    for file in FILES:
        place = ".".join(file.relative_to(ROOT).with_suffix("").parts)
        if place.startswith("tests."):
            continue
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom) and node.module:
                room = ".".join(node.module.split(".")[:2])
                inside = room in rooms and node.module != room and node.module not in PACKAGES
                if inside and not place.startswith(f"{room}."):
                    deep.append(f"{place}: from {node.module} import {', '.join(name.name for name in node.names)}")
    assert not deep, "\n".join(["let the room hand it on", *deep])
