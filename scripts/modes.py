#!/usr/bin/env python3
"""Show how a system moves at one point (Omega, eps): frequencies, growth, damping, harmonics of each Floquet mode."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

try:
    from compare import plot
    from compare.files import load_case, load_system, staged
    from floquet.modes import FloquetModes, floquet_modes
    from floquet_scripts import running
    from floquet_scripts.compiling import announce_compilation
    from periodic import AnyFamily
    from periodic.checks import one_of, whole_number
    from plate import MovingPlate
except ModuleNotFoundError as error:
    if __name__ != "__main__":
        raise
    print(
        f"modes: this python has no package {error.name}; set up .venv by make validate and take .venv/bin/python, "
        "or install the program into this python: pip install .",
        file=sys.stderr,
    )
    sys.exit(2)

MODES_HELP = f"""\
examples:
  {{command}} --at 18.6,0.3                   the standard plate
  {{command}} --case fig4 --variant uniform --at 37,0.3
  {{command}} --system mine.npz --at 4.2,0.1 --count 12
  {{command}} --case fig2 --at 18.6,0.3 --output moving   and pictures of the first mode and of the multipliers

A Floquet mode is a motion p(t) exp(lambda t), where p has the period of the excitation, 2 pi / Omega. Of each mode,
the one that grows fastest first, a line has: the frequency and the growth rate of its strongest harmonic (per unit of
time; the frequency in radians), its damping ratio, the modulus of its multiplier, and its strongest harmonics as
frequency and share of the mean square. Motions of one frequency and its negative are two modes, which together are a
real motion; the line of the positive one stands for both.

{running.SYSTEM_FILES_HELP}
The exit status is 0 if the modes were found and 2 if the input is wrong.
"""
STANDARD_PLATE = "Standard plate"
# Modes in the table, and harmonics of each, unless asked for others.
MODES_LISTED, HARMONICS_LISTED = 6, 3


def main(arguments: list[str] | None = None) -> int:
    running.steady_output()
    announce_compilation()
    options = _parser().parse_args(arguments)
    try:
        count = whole_number("--count", options.count, least=1)
        title, family = _system(options)
        Omega, eps = options.at
        modes = floquet_modes(family, Omega, eps)
        _print(title, modes, eps, count)
        if options.output is not None:
            _draw(options.output, modes, family)
    except ValueError as error:
        print(f"modes: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("modes: interrupted", file=sys.stderr)
        return 130
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = running.Parser("modes", __doc__, MODES_HELP)
    what = parser.add_mutually_exclusive_group()
    what.add_argument("--case", type=Path, metavar="CASE", help=running.CASE_HELP)
    what.add_argument("--system", type=Path, metavar="FILE", help=running.SYSTEM_HELP)
    parser.add_argument("--variant", metavar="LABEL", help="one of a case that has several; the first if not given")
    parser.add_argument("--at", type=running.point, required=True, metavar="OMEGA,EPS", help="the point")
    parser.add_argument(
        "--count", type=int, default=MODES_LISTED, metavar="N", help=f"modes in the table ({MODES_LISTED})"
    )
    parser.add_argument("--output", type=Path, metavar="DIR", help="also pictures, in this folder")
    return parser


def _system(options: argparse.Namespace) -> tuple[str, AnyFamily]:
    if options.variant is not None and options.case is None:
        raise ValueError("--variant belongs to a case with several; add --case")
    if options.system:
        return options.system.name, load_system(options.system)
    if options.case is None:
        return STANDARD_PLATE, MovingPlate()
    case = load_case(options.case)
    systems = case.systems()
    label = next(iter(systems)) if options.variant is None else one_of("--variant", options.variant, tuple(systems))
    return ", ".join(filter(None, (case.title, label))), systems[label]


def _print(title: str, modes: FloquetModes, eps: float, count: int) -> None:
    print(f"{title}: Omega = {modes.Omega:.6g}, eps = {eps:.6g}, period = {modes.period:.6g}")
    print(f"{'mode':>4}  {'frequency':>10}  {'growth rate':>11}  {'damping':>10}  {'|mu|':>9}  strongest harmonics")
    listed = [number for number, frequency in enumerate(modes.frequencies) if frequency >= 0]
    for number in listed[:count]:
        mode = modes[number]
        strongest = ", ".join(f"{f:.5g} ({share:.1%})" for f, share in mode.strongest(HARMONICS_LISTED))
        print(
            f"{number + 1:>4}  {mode.frequency:>10.6g}  {mode.growth_rate:>11.4g}  {mode.damping_ratio:>10.4g}  "
            f"{abs(mode.multiplier):>9.6g}  {strongest}"
        )
    left_out = len(listed) - count
    if left_out > 0:
        print(f"{left_out} more; --count {len(listed)} shows all")
    if modes[0].growth_rate > modes[0].error:
        print(f"the first grows tenfold in {modes.time_to_grow():.6g}")
    else:
        print("no mode grows by more than the error of its growth rate")


def _draw(output: Path, modes: FloquetModes, family: AnyFamily) -> None:
    pictures = {"multipliers": plot(modes), "harmonics": plot(modes[0])}
    if isinstance(family, MovingPlate):
        pictures["deflection"] = plot(modes[0], plate=family)
    with staged(output) as folder:
        for name, picture in pictures.items():
            picture.savefig(folder / f"{name}.png")
    print(f"in {output}: {', '.join(f'{name}.png' for name in pictures)}")


if __name__ == "__main__":
    sys.exit(main())
