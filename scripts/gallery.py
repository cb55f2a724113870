#!/usr/bin/env python3
"""Compute the gallery: charts that are published or exactly known, and how many digits of their numbers are found."""

from __future__ import annotations

import argparse
import math
import sys
import time
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from pkgutil import iter_modules
from types import ModuleType
from typing import NamedTuple

try:
    import floquet_examples
    from compare import plot
    from compare.files import did_you_mean, staged
    from floquet_scripts import running
    from floquet_scripts.compiling import announce_compilation
except ModuleNotFoundError as error:
    if __name__ != "__main__":
        raise
    print(
        f"gallery: this python has no package {error.name}; set up .venv by make validate and take .venv/bin/python, "
        "or install the program into this python: pip install .",
        file=sys.stderr,
    )
    sys.exit(2)

GALLERY_HELP = """\
examples:
  {command}                       all of it: the table, in a minute or two
  {command} mathieu gear_mesh     some of it
  {command} --output gallery      and a picture of each, which takes longer

Each line has a number from a paper, an exact one or one computed by other means, that number as it is found here, and
how many digits agree. A number from a paper has to be met in all digits that are printed there, another one in six.
Every example is a script to copy; --list says what each is about, where its script is, and where its numbers come from.

The exit status is 0 if every number was met, 1 if one was not, and 2 if the input is wrong.
"""
# Digits in which an exact or computed number has to be met, and the most that are counted: rounding decides the others.
MIN_DIGITS, MAX_DIGITS = 6, 10
# A number that is rounded to its last digit is off by half of it; a little more, as it is itself read as a float.
ROUNDED = 0.51


class Line(NamedTuple):
    """One number of an example: what it is, what it should be, what is found, in how many digits, whether it is met."""

    what: str
    reference: str
    found: float
    digits: int
    met: bool


def main(arguments: list[str] | None = None) -> int:
    running.steady_output()
    options = _parser().parse_args(arguments)
    examples = gallery()
    unknown = [name for name in options.names if name not in examples]
    if unknown:
        remedy = f"give some of {', '.join(examples)}{did_you_mean(unknown[0], examples)}"
        print(f"gallery: there is no example {unknown[0]!r}; {remedy}", file=sys.stderr)
        return 2
    chosen = {name: module for name, module in examples.items() if name in options.names or not options.names}
    if options.list:
        for name, module in chosen.items():
            print(f"{name}\n  {module.__file__}\n  {'  '.join((module.__doc__ or '').splitlines(keepends=True))}")
        return 0
    announce_compilation()
    try:
        return _compute(chosen, options.output)
    except ValueError as error:
        print(f"gallery: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("gallery: interrupted; nothing was written", file=sys.stderr)
        return 130


def _parser() -> argparse.ArgumentParser:
    parser = running.Parser("gallery", __doc__, GALLERY_HELP)
    parser.add_argument("names", nargs="*", metavar="NAME", help="examples; all if none is named")
    parser.add_argument("--list", action="store_true", help="say what there is, and compute nothing")
    parser.add_argument("--output", type=Path, metavar="DIR", help="draw the charts, too, into this folder")
    return parser


def gallery() -> dict[str, ModuleType]:
    """Return the examples by name, in the order of their problems."""
    found = {}
    for problem in filter(lambda one: one.ispkg, iter_modules(floquet_examples.__path__)):
        package = import_module(f"floquet_examples.{problem.name}")
        for example in iter_modules(package.__path__):
            found[example.name] = import_module(f"{package.__name__}.{example.name}")
    return found


def lines_of(example: ModuleType) -> Iterator[Line]:
    """Compute the numbers of an example."""
    for what, reference, found in example.numbers():
        digits, met = judged(reference, float(found))
        shown = reference if isinstance(reference, str) else f"{reference:.{MAX_DIGITS}g}"
        yield Line(what, shown, float(found), digits, met)


def judged(reference: str | float, found: float) -> tuple[int, bool]:
    """Return in how many digits a number agrees with its reference, and whether that is enough.

    A text is a rounded number, which cannot agree in more digits than it has.
    """
    value = float(reference)
    error = abs(found - value) / abs(value)
    digits = min(MAX_DIGITS, math.floor(-math.log10(error))) if error > 0 else MAX_DIGITS
    if isinstance(reference, str):
        decimals = len(reference.partition(".")[2])
        significant = len(reference.strip("-").replace(".", "").lstrip("0"))
        return min(digits, significant), abs(found - value) <= ROUNDED * 10.0**-decimals
    return max(digits, 0), digits >= MIN_DIGITS


def _compute(examples: dict[str, ModuleType], output: Path | None) -> int:
    began, missed, count = time.perf_counter(), 0, 0
    print(f"{'what':<46}{'reference':>14}  {'found here':>16}  digits")
    for name, example in examples.items():
        print(f"{name}: {(example.__doc__ or '').partition(chr(10))[0]}")
        for line in lines_of(example):
            verdict = "" if line.met else "  NOT MET"
            print(f"  {line.what:<44}{line.reference:>14}  {line.found:>16.{MAX_DIGITS}g}  {line.digits:>6}{verdict}")
            missed, count = missed + (not line.met), count + 1
        sys.stdout.flush()
    print(f"{count - missed} of {count} numbers are met, in {time.perf_counter() - began:.0f} s")
    if output is not None:
        with staged(output) as folder:
            for name, example in examples.items():
                plot(example.chart()).savefig(folder / f"{name}.png")
        print(f"in {output}: {', '.join(f'{name}.png' for name in examples)}")
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
