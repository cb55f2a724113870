"""Renew the numbers of docs/gallery.md: ``python -m tests.gallery``."""

from __future__ import annotations

from importlib import import_module
from types import ModuleType

from floquet_scripts.gallery import MAX_DIGITS, Line, gallery, lines_of
from tests.paths import ROOT

PAGE = ROOT / "docs" / "gallery.md"
MARK = "<!-- what follows is written by python -m tests.gallery -->\n"


def row(line: Line) -> str:
    """Return a number as a row of the page's tables, with two digits more than those that agree."""
    return f"| {line.what} | {line.reference} | {line.found:.{min(MAX_DIGITS, line.digits + 2)}g} | {line.digits} |"


def section(example: ModuleType) -> str:
    """Return what the page says of an example."""
    title, _, about = (example.__doc__ or "").strip().partition("\n\n")
    place = example.__name__.replace("floquet_examples.", "examples/").replace(".", "/") + ".py"
    head = "| what | reference | found here | digits |\n|---|---|---|---|"
    return "\n".join([f"### {title.rstrip('.')}\n\n`{place}`. {about}\n", head, *map(row, lines_of(example)), ""])


def body() -> str:
    """Compute all that is below the mark."""
    parts, problem = [], ""
    for example in gallery().values():
        package = example.__name__.rpartition(".")[0]
        if package != problem:
            problem = package
            name, _, about = (import_module(package).__doc__ or "").partition(": ")
            parts.append(f"## {name}\n\n{about.capitalize()}\n")
        parts.append(section(example))
    return "\n".join(parts)


if __name__ == "__main__":
    head, mark, _ = PAGE.read_text(encoding="utf-8").partition(MARK)
    PAGE.write_text(head + mark + "\n" + body(), encoding="utf-8")
