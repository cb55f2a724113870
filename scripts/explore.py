#!/usr/bin/env python3
"""Draw the stability chart of any system in any window, look at it in the browser, or follow its regions."""

from __future__ import annotations

import argparse
import math
import re
import sys
from collections.abc import Callable
from dataclasses import dataclass, replace
from importlib import import_module
from pathlib import Path
from typing import Any, cast

try:
    import numpy as np

    from compare.explorer import (
        KNOWN_PLANES,
        SWEEPABLE,
        clickable_responses,
        explore,
        explore_plane,
        parametric_file,
        parametric_plate,
        plate_table,
        point_maker,
        region_lines,
        sweep,
        sweep_picture,
    )
    from compare.files import STANDARD_REGIONS, Plate, load_case, staged
    from compare.study import own_system
    from compare.window import default_window
    from floquet import Point
    from floquet.chart import TileStore
    from floquet_scripts import running
    from floquet_scripts.compiling import announce_compilation
    from periodic import AnyFamily, SystemFamily, stiffness_alone
    from periodic.checks import one_of
    from plate import MovingPlate
except ModuleNotFoundError as error:
    if __name__ != "__main__":
        raise
    print(
        f"explore: this python has no package {error.name}; set up .venv by make validate and take .venv/bin/python, "
        "or install the program into this python: pip install .",
        file=sys.stderr,
    )
    sys.exit(2)

EXPLORE_HELP = f"""\
examples:
  {{command}}                                   the standard plate; pictures and data go to output/
  {{command}} --case fig4 --variant "middle half" --eps 2
  {{command}} --system mine.npz --Omega 1 30    your own matrices
  {{command}} --system mine.npz --html          and a page to click in, in one file
  {{command}} --serve                           the same page live, with sliders, on this machine only
  {{command}} --sweep speed=0:4.3:40            how the regions move with the speed
  {{command}} --x speed=0:4.3:100 --y Omega=10:80:100 --set eps=.2     a plate over any two parameters
  {{command}} --system mine.py --x a=-1:6:200 --y q=0:10:200 --set Omega=2
  {{command}} --plane mathieu --x a=-1:6:200 --y q=0:10:200

--x and --y take the parameters of the function system(...) in a .py file, of a plate what --sweep takes and waveform,
and Omega and eps unless the function returns a Point. --plane takes {", ".join(KNOWN_PLANES)}.
--sweep takes {", ".join(SWEEPABLE)} (of the load).
Without --Omega and --eps the window is the case's. For a system it is one that shows the main regions of its three
lowest modes. The exit status is 0 if everything was written and 2 if the input is wrong.

{running.SYSTEM_FILES_HELP}
{running.STOPPED_RUNS_HELP}"""
STANDARD_NAME, STANDARD_TITLE = "plate", "Standard plate: a/b = 1, ν = 0.3, V = 3, f₀ = 10"
OPTIONS_OF_CHARTS = ("points", "html", "netcdf", "no_regions")
# Options that a chart over --x and --y cannot heed.
NOT_OF_PLANES = ("Omega", "eps", "points", "html", "serve", "sweep", "all_modes")
# Amplitude at which a sweep compares widths, and the most values of a parameter.
SWEEP_EPS, MAX_SWEEP_VALUES = 0.1, 1000


@dataclass(frozen=True, eq=False)
class Target:
    """What is explored: a plate's table or a system, with the window and the title of its pictures."""

    name: str
    title: str
    source: Plate | AnyFamily
    window: tuple[float, float]
    eps: float
    points: tuple[int, int] = (256, 128)
    regions: list[tuple[int, int]] | None = None

    @property
    def family(self) -> AnyFamily:
        return self.source.build() if isinstance(self.source, Plate) else self.source

    @property
    def units(self) -> MovingPlate | None:
        """The plate whose SI units the pictures are in, if it has any."""
        family = self.family
        return family if isinstance(family, MovingPlate) and family.si is not None else None


@dataclass(frozen=True, eq=False)
class PlaneTarget:
    """What is explored over two parameters."""

    name: str
    title: str
    make: Callable[[float, float], Point]
    x: tuple[str, np.ndarray]
    y: tuple[str, np.ndarray]


def main(arguments: list[str] | None = None) -> int:
    running.steady_output()
    announce_compilation()
    options = _parser().parse_args(arguments)
    try:
        _check(options)
        target = _plane_target(options) if options.x else _target(options)
        if options.serve:
            return _serve(cast(Target, target), options)
    except ValueError as error:
        print(f"explore: {error}", file=sys.stderr)
        return 2
    return running.run("explore", options, lambda store: _explore(target, options, store))


def _explore(target: Target | PlaneTarget, options: argparse.Namespace, store: TileStore) -> int:
    if isinstance(target, PlaneTarget):
        write = _planed(target, options, store)
    else:
        write = _swept(target, options) if options.sweep else _charted(target, options, store)
    with staged(options.output) as folder:
        write(folder)
        names = sorted(path.name for path in folder.iterdir())
    print(f"in {options.output}: {', '.join(names)}")
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = running.Parser("explore", __doc__, EXPLORE_HELP)
    what = parser.add_argument_group("what to explore (by default the standard plate)").add_mutually_exclusive_group()
    what.add_argument("--case", type=Path, metavar="CASE", help=running.CASE_HELP)
    what.add_argument("--system", type=Path, metavar="FILE", help=running.SYSTEM_HELP)
    what.add_argument("--plane", choices=tuple(KNOWN_PLANES), help="a system that is known over two parameters")
    parser.add_argument("--variant", metavar="LABEL", help="one of a case that has several; the first if not given")
    window = parser.add_argument_group("where")
    window.add_argument(
        "--Omega",
        type=float,
        nargs=2,
        metavar=("LOW", "HIGH"),
        help="excitation frequencies (of a plate in SI units: in Hz)",
    )
    window.add_argument(
        "--eps", type=float, metavar="MAX", help="largest amplitude; with --sweep, the one at which widths are compared"
    )
    window.add_argument("--points", type=int, nargs=2, metavar=("COLUMNS", "ROWS"), help="resolution of the chart")
    window.add_argument("--all-modes", action="store_true", help=running.ALL_MODES_HELP)
    window.add_argument("--order", type=int, choices=(1, 2), default=1, help="order of the analytic curves (1)")
    plane = parser.add_argument_group("over any two parameters, instead of Omega and eps")
    plane.add_argument("--x", metavar="NAME=LOW:HIGH:COUNT", help="the parameter across")
    plane.add_argument("--y", metavar="NAME=LOW:HIGH:COUNT", help="the parameter upwards")
    plane.add_argument(
        "--set", action="append", default=[], metavar="NAME=VALUE", help="another parameter; as often as needed"
    )
    result = parser.add_argument_group("result")
    result.add_argument("--html", action="store_true", help="also one self-contained page (needs bokeh)")
    result.add_argument("--netcdf", action="store_true", help="also the chart as NetCDF (needs xarray)")
    result.add_argument("--no-regions", action="store_true", help="do not trace the regions, which doubles the time")
    result.add_argument("--sweep", metavar="NAME=LOW:HIGH:COUNT", help="instead: the regions over a parameter")
    result.add_argument("--serve", action="store_true", help="instead: the page live, with sliders (needs bokeh)")
    result.add_argument("--port", type=int, default=5006, help="of the live page (5006); 0 takes a free one")
    result.add_argument("--output", type=Path, default=Path("output"), metavar="DIR", help="where to write (output)")
    running.add_options(parser)
    return parser


def _check(options: argparse.Namespace) -> None:
    """Refuse options that would have no effect, and amplitudes that are none."""
    running.check_window(options)
    if (options.x is None) != (options.y is None):
        there, other = ("--x", "--y") if options.x else ("--y", "--x")
        raise ValueError(f"{there} alone is no plane; add {other} NAME=LOW:HIGH:COUNT")
    if options.x is None and (options.set or options.plane):
        raise ValueError(f"{'--set' if options.set else '--plane'} belongs to a plane; add --x and --y")
    for other in NOT_OF_PLANES if options.x else ():
        if getattr(options, other):
            raise ValueError(f"--{other.replace('_', '-')} has no meaning with --x and --y; leave it out")
    if options.all_modes and not options.system:
        raise ValueError("--all-modes belongs to a system; add --system")
    without_effect = {"serve": ("sweep", *OPTIONS_OF_CHARTS), "sweep": ("Omega", *OPTIONS_OF_CHARTS)}
    for instead, others in without_effect.items():
        for other in others:
            if getattr(options, instead) and getattr(options, other):
                raise ValueError(f"--{other.replace('_', '-')} has no meaning with --{instead}; leave it out")
    if options.netcdf:
        running.check_extra("--netcdf", "xarray", "xarray")
    if options.html or options.serve:
        running.check_extra("--html" if options.html else "--serve", "bokeh", "explore")


def _target(options: argparse.Namespace) -> Target:
    """Return what the options name, in the window that they give, or else in its own."""
    if options.variant is not None and options.case is None:
        raise ValueError("--variant belongs to a case with several; add --case")
    if options.case:
        case = load_case(options.case)
        label, table = plate_table(case, options.variant)
        if options.variant is None and len(case.variants) > 1:
            others = ", ".join(repr(variant.label) for variant in case.variants[1:])
            print(f"this is the variant {label!r}; --variant also takes {others}")
        title = ", ".join(filter(None, (case.title, label)))
        name = re.sub(r"[^\w.]+", "-", f"{case.name} {label}".strip())
        window, eps, points = case.window, case.chart.eps, case.chart.points
        target = Target(name, title, table, window, eps, points, case.regions)
    elif options.system:
        own = own_system(options.system, options.Omega, options.eps, all_modes=options.all_modes)
        if own.remark:
            print(own.remark)
        target = Target(own.path.stem, own.path.name, own.system, own.window, own.eps)
    else:
        window, eps = default_window(Plate().build().at(0.0))
        target = Target(STANDARD_NAME, STANDARD_TITLE, Plate(), window, eps, regions=STANDARD_REGIONS)
    scale = 1.0 if target.units is None else 2 * math.pi / target.units.frequency_unit  # given in Hz
    given = {
        "window": options.Omega and tuple(scale * frequency for frequency in options.Omega),
        "eps": options.eps,
        "points": options.points and tuple(options.points),
    }
    return replace(target, **{name: value for name, value in given.items() if value is not None})


def _plane_target(options: argparse.Namespace) -> PlaneTarget:
    """Return the plane that the options name."""
    x, y = (_values(name, getattr(options, name)) for name in ("x", "y"))
    fixed = dict(_fixed(text) for text in options.set)
    if options.plane:
        name, system = options.plane, KNOWN_PLANES[options.plane]
    elif options.system:
        name, system = options.system.stem, parametric_file(options.system)
    else:
        one = _target(options)
        name, system = one.name, parametric_plate(one.title, cast(Plate, one.source))
    others = "".join(f", {key} = {value}" for key, value in fixed.items())
    make = point_maker(system, (x[0], x[1].tolist()), (y[0], y[1].tolist()), fixed)
    return PlaneTarget(f"{name}-{x[0]}-{y[0]}", system.title + others, make, x, y)


def _planed(target: PlaneTarget, options: argparse.Namespace, store: TileStore) -> Callable[[Path], None]:
    """Compute and report; return what writes the result into a folder."""
    result = explore_plane(
        target.make,
        target.x,
        target.y,
        trace=not options.no_regions,
        title=target.title,
        n_jobs=options.jobs,
        progress=not options.no_progress,
        cache=store,
    )
    print(result.remark)
    for line in result.lines():
        print(f"  {line}")
    return lambda folder: result.write(folder, target.name, netcdf=options.netcdf)


def _charted(target: Target, options: argparse.Namespace, store: TileStore) -> Callable[[Path], None]:
    """Compute and report; return what writes the result into a folder."""
    family, progress = target.family, not options.no_progress
    bokeh: Any = import_module("compare.explorer.page") if options.html else None
    if options.html:  # the solutions that a click shows
        stiffness_alone(family.at(target.window[0]), "--html: the system")
    result = explore(
        family,
        target.window,
        target.eps,
        points=target.points,
        order=options.order,
        trace=not options.no_regions,
        title=target.title,
        n_jobs=options.jobs,
        progress=progress,
        cache=store,
    )
    remarks = " ".join(filter(None, (result.audit, result.remark)))
    print(remarks)
    for line in region_lines(result.regions, target.eps, f"{target.name}-regions.json", target.units):
        print(f"  {line}")
    page = ""
    if bokeh is not None:
        points = clickable_responses(cast(SystemFamily, family), result.chart, n_jobs=options.jobs, progress=progress)
        view = bokeh.Page(target.title, "Click the chart: the nearest computed point is shown.")
        view.frame(target.window, (0.0, target.eps))
        view.show(result)
        view.tell(remarks)
        page = view.html(points)

    def write(folder: Path) -> None:
        result.write(folder, target.name, netcdf=options.netcdf, units=target.units)
        if page:
            (folder / f"{target.name}.html").write_text(page, encoding="utf-8")

    return write


def _swept(target: Target, options: argparse.Namespace) -> Callable[[Path], None]:
    """Compute and report; return what writes the result into a folder."""
    if not isinstance(target.source, Plate) or target.regions is None:
        raise ValueError("--sweep changes a parameter of the plate; leave out --system")
    name, values = _values("sweep", options.sweep)
    one_of("--sweep", name, SWEEPABLE)
    result = sweep(
        target.source,
        name,
        values,
        target.regions,
        eps=SWEEP_EPS if options.eps is None else options.eps,
        order=options.order,
        n_jobs=options.jobs,
        progress=not options.no_progress,
    )
    if result.remark:
        print(result.remark)
    stem = f"{target.name}-{name}"

    def write(folder: Path) -> None:
        result.write(folder, stem)
        figure = sweep_picture(result, title=f"{target.title}; {name.replace('_', ' ')} varied")
        for suffix in ("png", "pdf"):
            figure.savefig(folder / f"{stem}.{suffix}")

    return write


def _values(option: str, text: str) -> tuple[str, np.ndarray]:
    """Return name and values of a parameter."""
    name, _, numbers = text.partition("=")
    try:
        low, high, count = numbers.split(":")
        values = np.linspace(float(low), float(high), min(int(count), MAX_SWEEP_VALUES + 1))
    except ValueError:
        raise ValueError(f"--{option} {text!r} is not NAME=LOW:HIGH:COUNT; give for example speed=0:4.3:40") from None
    if not 2 <= values.size <= MAX_SWEEP_VALUES:
        raise ValueError(f"--{option} {text!r} asks for {count} values; give 2 to {MAX_SWEEP_VALUES}")
    return name, values


def _fixed(text: str) -> tuple[str, float | str]:
    """Return name and value of a parameter: a number, or a word such as that of a waveform."""
    name, equals, value = text.partition("=")
    if not (name and equals and value):
        raise ValueError(f"--set {text!r} is not NAME=VALUE; give for example eps=0.2")
    try:
        return name, float(value)
    except ValueError:
        return name, value


def _serve(target: Target, options: argparse.Namespace) -> int:
    live: Any = import_module("compare.explorer.live")
    if not isinstance(target.source, Plate):
        stiffness_alone(target.source.at(target.window[0]), "--serve: the system")
    state = live.State(target.source, target.window, (0.0, target.eps))
    server = live.serve(target.title, state, port=options.port, order=options.order, n_jobs=options.jobs)
    print(f"open http://{live.ADDRESS}:{server.port}/ in a browser; stop with Ctrl-C", flush=True)
    try:
        server.io_loop.start()
    except KeyboardInterrupt:
        server.stop()
    return 0


if __name__ == "__main__":
    sys.exit(main())
