#!/usr/bin/env python3
"""Prove whether points (Omega, eps) of a stability chart, or all points of a window, are stable or unstable."""

from __future__ import annotations

import argparse
import dataclasses
import inspect
import json
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

try:
    from beam import MovingBeam
    from compare.files import did_you_mean, load_case, load_system
    from floquet_scripts import running
    from periodic import AnyFamily, examples
    from periodic.checks import whole_number
    from plate import MovingPlate
except ModuleNotFoundError as error:
    if __name__ != "__main__":
        raise
    print(
        f"certify: this python has no package {error.name}; set up .venv by make validate and take .venv/bin/python, "
        "or install the program into this python: pip install .",
        file=sys.stderr,
    )
    sys.exit(2)

EXAMPLES: dict[str, Callable[..., AnyFamily]] = {
    "mathieu": examples.mathieu,
    "coupled": examples.coupled_mathieu,
    "rotor": examples.gyroscopic_rotor,
    "meissner": examples.meissner,
    "beam": MovingBeam,
    "plate": MovingPlate,
}

EPILOG = """\
examples:
  {command} --example mathieu --at 1.9,0.3
  {command} --example mathieu --set delta=2.5 --set damping=0.01 --at 3.1,0.4 --at 3.2,0.4
  {command} --example coupled --set type=difference --set frequencies=1,1.7 --at 0.7,0.5
  {command} --example beam --set speed=0.6 --set flexural_rigidity=0.64 --at 20,0.3
  {command} --example plate --set speed_amplitude=0.5 --set axial_terms=2 --at 18.6,0.3
  {command} --case fig2 --at 18.6,0.3
  {command} --case fig2 --terms 3,2 --at 18.6,0.3
  {command} --system mine.npz --at 4.2,0.1
  {command} --system mine.py --at 4.2,0.1
  {command} --example mathieu --window 0.8:3 0:0.6 --output mathieu-proved
  {command} --case fig2 --terms 2,3 --window 40:90 0:1 --seconds 60 --output plate-proved

The verdict is a theorem about the ordinary differential equations with exactly these coefficients: the matrices and
waveforms as float64 numbers, Omega and eps as the float64 numbers next to the decimals given. It comes from ball
arithmetic, which encloses every error of rounding and truncation; docs/certify.md has the proof. Where it is about
neighbouring coefficients, because waveforms are known within a bound or the speed pulsates, the line says so.

  stable     every solution is bounded for all t >= 0
  unstable   some solution grows exponentially
  undecided  neither was proved with --bits; on a boundary of stability itself no number of bits is enough

A plate of --case is proved with all terms that the case gives it. That takes seconds to minutes: longer with more terms
and with a lower Omega. --terms takes other terms; fewer terms are another plate, whose boundaries lie elsewhere, and
every line then names them.

--window proves the whole chart of a system with periodic stiffness alone, matrices that are the same at all
frequencies: every point of it, but for strips along the edges that are thinner than a picture can show, and what
--seconds left. The number printed is a proved lower bound. --output NAME writes the certificate, NAME.npz, and a
picture, NAME.png; `python -m floquet.certified.checking NAME.npz` checks the certificate by other code.

The exit status is 0 if every point was decided, 1 if one was not, 2 if the input is wrong or python-flint is missing
(pip install 'floquet-charts[certify]').
"""


def main(arguments: list[str] | None = None) -> int:
    running.steady_output()
    options = _parser().parse_args(arguments)
    try:
        from floquet.certified import FIRST_BITS, MAX_BITS, ProvedVerdict, certified_growth, uncoupled_subsystems

        if not (options.at or options.window):
            raise ValueError(
                "nothing is asked; give points, --at OMEGA,EPS, or a window, --window OMEGA0:OMEGA1 EPS0:EPS1"
            )
        bits = whole_number("--bits", options.bits, least=FIRST_BITS, most=MAX_BITS)
        systems = _systems(options)
        other = f", with {options.terms[0]} x {options.terms[1]} terms" if options.terms else ""
        decided = True
        for title, family in systems.items():
            for Omega, eps in options.at or ():
                sizes = [subsystem.size for subsystem in uncoupled_subsystems(family.at(Omega), eps)]
                parts = f" = {' + '.join(map(str, sizes))}" if len(sizes) > 1 else ""
                print(f"{title}{other} (n = {sum(sizes)}{parts})", flush=True)
                found = certified_growth(family, Omega, eps, max_bits=bits)
                print(f"  Omega = {Omega!r}, eps = {eps!r}{other}: {found.verdict} ({found.bits} bits)")
                print(f"    {found.reason}{other}")
                print(f"    growth rate in [{found.lower!r}, {found.upper!r}]{other}", flush=True)
                decided &= found.verdict is not ProvedVerdict.UNDECIDED
        if options.window:
            _prove_window(options, systems, other)
    except (ValueError, ImportError) as error:
        smaller = "; --terms K,L proves a smaller plate" if "fewer coordinates" in str(error) and options.case else ""
        print(f"certify: {error}{smaller}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("certify: interrupted", file=sys.stderr)
        return 130
    return 0 if decided else 1


def _parser() -> argparse.ArgumentParser:
    parser = running.Parser("certify", __doc__, EPILOG)
    what = parser.add_mutually_exclusive_group(required=True)
    what.add_argument("--case", type=Path, metavar="CASE", help=f"each plate of {running.CASE_HELP}")
    what.add_argument("--system", type=Path, metavar="FILE", help=running.SYSTEM_HELP)
    what.add_argument("--example", choices=sorted(EXAMPLES), help="a small system with known answers")
    parser.add_argument(
        "--at",
        type=running.point,
        action="append",
        metavar="OMEGA,EPS",
        help="the point; may be repeated",
    )
    parser.add_argument(
        "--window",
        nargs=2,
        type=_interval,
        metavar=("OMEGA0:OMEGA1", "EPS0:EPS1"),
        help="prove the whole chart between these frequencies and amplitudes",
    )
    parser.add_argument(
        "--cache", metavar="DIR", help="of --window: keep what is proved, so that the command can go on"
    )
    parser.add_argument("--seconds", type=float, metavar="S", help="of --window: leave open what is not proved by then")
    parser.add_argument("--output", type=Path, metavar="NAME", help="of --window: write NAME.npz and NAME.png")
    parser.add_argument("--terms", type=_terms, metavar="K,L", help="axial and lateral terms of the plates of --case")
    parser.add_argument(
        "--set", type=_setting, action="append", default=[], metavar="NAME=VALUE", help="a parameter of --example"
    )
    parser.add_argument("--bits", type=int, default=512, metavar="N", help="highest precision, 128 to 2048 (512)")
    return parser


def _interval(text: str) -> tuple[float, float]:
    try:
        low, high = map(float, text.split(":"))
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is no interval; give two numbers, such as 0.8:3") from None
    return low, high


def _prove_window(options: argparse.Namespace, systems: dict[str, AnyFamily], other: str) -> None:
    """Prove the chart of each system; print what was proved, and write what is asked for."""
    from compare.pictures import plot
    from floquet.certified import prove_chart

    for number, (title, family) in enumerate(systems.items(), start=1):
        chart = prove_chart(family, *options.window, seconds=options.seconds, cache=options.cache)  # type: ignore[arg-type]
        print(f"{title}{other}\n  {chart!r}", flush=True)
        if options.output:
            name = options.output if len(systems) == 1 else options.output.with_name(f"{options.output.name}-{number}")
            name.parent.mkdir(parents=True, exist_ok=True)
            chart.save(name.with_name(f"{name.name}.npz"))
            picture = plot(chart)
            picture.axes[0].set_title(f"{title}{other}")
            picture.savefig(name.with_name(f"{name.name}.png"))
            print(f"  written: {name}.npz, {name}.png", flush=True)


def _terms(text: str) -> tuple[int, int]:
    try:
        axial, lateral = map(int, text.split(","))
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} are no terms; give two whole numbers, such as 2,3") from None
    return axial, lateral


def _setting(text: str) -> tuple[str, Any]:
    name, given, value = text.partition("=")
    if not (name and given and value):
        raise argparse.ArgumentTypeError(f"{text!r} is no setting; give NAME=VALUE, such as delta=2.5")
    try:
        return name, json.loads(f"[{value}]" if "," in value else value)
    except json.JSONDecodeError:
        return name, value


def _systems(options: argparse.Namespace) -> dict[str, AnyFamily]:
    """Return what is asked for under a title. Raises ValueError if it cannot be had."""
    if options.set and not options.example:
        raise ValueError("--set is for the parameters of --example; leave it out")
    if options.terms and not options.case:
        raise ValueError("--terms is for the plates of --case; leave it out")
    if options.system:
        return {str(options.system): load_system(options.system)}
    if options.example:
        return _example(options.example, dict(options.set))
    case = load_case(options.case)
    return {
        f"{case.title}: {label}" if label else case.title: _with_terms(plate, options.terms)
        for label, plate in case.plates("certify").items()
    }


def _example(name: str, settings: dict[str, Any]) -> dict[str, AnyFamily]:
    make = EXAMPLES[name]
    # a load, for one, is no value for a command line
    known = {
        key: parameter.default
        for key, parameter in inspect.signature(make).parameters.items()
        if parameter.default is parameter.empty or isinstance(parameter.default, float | int | str | tuple | None)
    }
    for key in settings:
        if key not in known:
            suggestion = did_you_mean(key, known)
            raise ValueError(f"--set {key}: {name} has no such parameter; it has {', '.join(known)}{suggestion}")
    values = known | settings
    for key, value in values.items():
        if value is inspect.Parameter.empty:
            raise ValueError(f"--set {key}: {name} needs this parameter; give it a value")
    title = "plate under a uniform load" if make is MovingPlate else name
    return {f"{title}({', '.join(f'{key}={value!r}' for key, value in values.items())})": make(**values)}


def _with_terms(plate: MovingPlate, terms: tuple[int, int] | None) -> MovingPlate:
    if terms is None:
        return plate
    return dataclasses.replace(plate, axial_terms=terms[0], lateral_terms=terms[1])


if __name__ == "__main__":
    sys.exit(main())
