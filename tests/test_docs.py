"""The documentation does what it says: every python example runs, and prints what the page says it prints."""

from __future__ import annotations

import contextlib
import importlib
import io
import re
from pathlib import Path
from typing import Any, NamedTuple

import pytest

from floquet_charts.__main__ import COMMANDS
from tests.paths import ROOT

PAGES = [*sorted(ROOT.glob("*.md")), *sorted((ROOT / "docs").glob("*.md"))]

# A python block, perhaps excused by a comment before it, perhaps followed by what it prints.
BLOCK = re.compile(
    r"^(?P<excuse><!-- not executed: [^>]+ -->\s*)?"
    r"^```python\n(?P<code>.*?)^```\n"
    r"(?:\s*^```output\n(?P<output>.*?)^```\n)?",
    re.MULTILINE | re.DOTALL,
)
COMMAND = re.compile(
    rf"(?:(?<!tests/)scripts/(?P<script>\w+)\.py|floquet-charts (?P<entry>{'|'.join(COMMANDS)})\b)(?P<options>[^\n`]*)"
)
OPTIONAL = {"flint", "xarray", "bokeh", "distributed"}  # packages of extras that an example may need


class Example(NamedTuple):
    line: int
    code: str
    output: str | None


def examples(text: str) -> list[Example]:
    return [
        Example(text.count("\n", 0, block.start("code")), block["code"], block["output"])
        for block in BLOCK.finditer(text)
        if not block["excuse"]
    ]


def run(page: str, text: str) -> None:
    """Run the examples of a page one after the other in one namespace, and compare what they print."""
    namespace: dict[str, Any] = {"__name__": page}
    for example in examples(text):
        printed = io.StringIO()
        source = "\n" * example.line + example.code  # so that a traceback names the line of the page
        with contextlib.redirect_stdout(printed):
            exec(compile(source, page, "exec"), namespace)
        if example.output is not None:
            assert printed.getvalue() == example.output, f"{page}, example at line {example.line}"


@pytest.mark.parametrize("page", [page for page in PAGES if examples(page.read_text())], ids=lambda page: page.name)
def test_examples_of_page(page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    try:
        run(page.name, page.read_text())
    except ImportError as error:
        missing = error.__cause__ or error.__context__ or error
        if getattr(missing, "name", None) not in OPTIONAL:
            raise
        pytest.skip(str(error))


def test_commands_have_the_options_that_the_pages_use(capsys: pytest.CaptureFixture[str]) -> None:
    used: dict[str, set[str]] = {}
    for page in PAGES:
        for command in COMMAND.finditer(page.read_text()):
            given = re.findall(r"(?<!\S)--[a-z][a-z-]*", command["options"])
            used.setdefault(command["script"] or command["entry"], set()).update(given)
    for module in ("compiling", "running"):  # what the commands share
        used.pop(module, None)
    assert "certify" in used
    for name, options in used.items():
        with pytest.raises(SystemExit, match="0"):
            importlib.import_module(f"floquet_scripts.{name}").main(["--help"])
        unknown = options - set(re.findall(r"--[a-z][a-z-]*", capsys.readouterr().out))
        assert not unknown, f"{name} has no {', '.join(unknown)}"


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_files_and_tests_that_a_page_names_exist(page: Path) -> None:
    text = page.read_text()
    missing = [name for name in re.findall(r"`(\w+/[\w/]+\.(?:py|md))`", text) if not (ROOT / name).is_file()]
    tests = "".join(file.read_text() for file in (ROOT / "tests").rglob("test_*.py"))
    missing += [name for name in re.findall(r"`(test_\w+)`", text) if f"def {name}(" not in tests]
    assert not missing


def test_examples_are_found_and_compared() -> None:
    page = (
        "text\n```python\nx = 1\n```\n\n<!-- not executed: takes an hour -->\n```python\nx = 2\n```\n"
        "```python\nprint(x)\n```\n\n```output\n1\n```\n"
    )
    assert [example.line for example in examples(page)] == [2, 10]
    run("page", page)
    with pytest.raises(AssertionError, match="page, example at line 10"):
        run("page", page.replace("output\n1", "output\n2"))
