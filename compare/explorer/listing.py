"""The traced regions as lines of text: the widest ones, and how many more there are."""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil, log10
from typing import Any

from compare.explorer.outlines import WIDTH_LEVELS
from compare.pictures import Units, units_of
from floquet import Region
from floquet.boundary import Resonance
from floquet.regions import largest_width

# Regions that get a line: as many as fit a screen. At large eps there are a hundred, most of them narrower than a line.
MAX_REGION_LINES = 20
# Resonances that are named in a line. A wide region may unite dozens; those of the lowest order are the strongest.
MAX_RESONANCE_NAMES = 3
# Digits of a tip, as a part of the height of the window: below are the errors of tracing.
TIP_RESOLUTION = 1e-4


def region_lines(regions: Sequence[Region], eps_max: float, file: str, units: Any = None) -> list[str]:
    """Return a line for each of the widest regions, in the order of ``regions``, and a last one that counts the others.

    Parameters
    ----------
    regions : sequence of Region
        From `floquet.trace_regions`.
    eps_max : float
        Height of the window in which they were traced.
    file : str
        Name of the file that holds all of them.
    units : optional
        Of frequencies, as `compare.plot` takes them.
    """
    scale = units_of(units)
    widths = [largest_width(region.outlines, WIDTH_LEVELS) for region in regions]
    widest = sorted(range(len(regions)), key=lambda i: -widths[i])
    shown, rest = sorted(widest[:MAX_REGION_LINES]), widest[MAX_REGION_LINES:]
    names = [_name(regions[i]) for i in shown]
    column = max(map(len, names), default=0)
    lines = [
        f"{name:<{column}}  {_place(regions[i], widths[i], eps_max, scale)}"
        for i, name in zip(shown, names, strict=True)
    ]
    if rest:
        widest_left = f"{widths[rest[0]] * scale.frequency:.2g}{_unit(scale)}"
        lines.append(f"and {len(rest)} narrower ones, at most {widest_left} wide; all are in {file}")
    return lines


def _by_order(region: Region) -> list[Resonance]:
    return sorted(region.resonances, key=lambda name: name.j)


def _name(region: Region) -> str:
    names = [name.label for name in _by_order(region)]
    more = f" and {len(names) - MAX_RESONANCE_NAMES} more" if len(names) > MAX_RESONANCE_NAMES else ""
    return ", ".join(names[:MAX_RESONANCE_NAMES]) + more or "unexplained"


def _place(region: Region, width: float, eps_max: float, scale: Units) -> str:
    Omega, eps = region.tip
    eps = round(eps, ceil(-log10(TIP_RESOLUTION * eps_max)))
    if eps == 0 and len(region.resonances) > 1:  # it starts at each of its resonances; the first one is named
        Omega = _by_order(region)[0].centre
    start = f"{Omega * scale.frequency:.5g}{_unit(scale)}"
    return f"from Ω = {start}, ε = {eps:.3g}, up to {width * scale.frequency:.2g}{_unit(scale)} wide"


def _unit(scale: Units) -> str:
    return f" {scale.frequency_unit}" if scale.frequency_unit else ""
