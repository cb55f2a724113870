"""Every region of instability of a window as closed polylines, each with the resonances that it starts from."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from tqdm import tqdm

from floquet.monodromy import member_at, monodromy
from floquet.multipliers import Kind
from floquet.names import Name, resonances
from floquet.outline import Column, Loop, Place, components, loops
from floquet.scanning import AMPLITUDES, Scan
from periodic import SystemFamily
from periodic.checks import FloatArray, interval, one_of, real_array, real_number, workers

# Columns before any refinement, at least. Regions narrower than the distance between them are found at resonances.
COLUMNS = 256
# Levels at which the width of a region is measured.
LEVELS = 64
# A region that starts at a resonance is followed down to its foot; from there the middle goes on like a + b eps^2. The
# place at eps = 0 is known to this part of the way that the middle has gone, plus this many tolerances.
DOUBT, TOLERANCES = 0.3, 2.0


@dataclass(frozen=True, eq=False)
class Region:
    """One connected region of instability in a window of the (Omega, eps) plane.

    Attributes
    ----------
    outlines : tuple of Loop
        Closed polylines with arrays ``Omega``, ``eps`` and ``kind`` (k,): the outer one first, then those round stable
        islands. The first corner is not repeated at the end. ``kind`` is the `Kind` of the instability just inside.
        Where the region goes on beyond the window, the polyline follows the edge of the window.
    resonances : tuple of Name
        The resonances that the region starts from, several if regions have merged; empty if none explains it.
    tip : (float, float)
        Omega and eps of its lowest point.
    witness : (float, float)
        Omega and eps of a point inside, at which `monodromy` found instability beyond its error.
    """

    outlines: tuple[Loop, ...]
    resonances: tuple[Name, ...]
    tip: tuple[float, float]
    witness: tuple[float, float]

    @property
    def label(self) -> str:
        """Names of the resonances, such as "2ω₁" or "ω₁+ω₃, 2ω₂/2"; empty if none explains the region."""
        return ", ".join(name.label for name in self.resonances)

    @property
    def explained(self) -> bool:
        """Whether the region is connected to a resonance as eps -> 0."""
        return bool(self.resonances)

    def contains(self, Omega: ArrayLike, eps: ArrayLike) -> NDArray[np.bool_]:
        """Return whether points lie inside.

        Parameters
        ----------
        Omega, eps : array_like
            Shapes that broadcast together.

        Returns
        -------
        ndarray of bool

        Raises
        ------
        ValueError
            If the arguments are not real or not finite.
        """
        x, y = np.broadcast_arrays(real_array("Omega", Omega, None), real_array("eps", eps, None))
        inside = np.zeros(x.shape, dtype=bool)
        for loop in self.outlines:
            inside ^= _inside(loop, x, y)
        return inside


def trace_regions(
    family: SystemFamily,
    Omega_range: tuple[float, float],
    eps_range: tuple[float, float],
    *,
    tolerance: float = 1e-3,
    n_jobs: int | None = -1,
    progress: bool | None = None,
) -> list[Region]:
    """Follow every region of instability of a window and name it by the resonances that it starts from.

    Parameters
    ----------
    family : PeriodicSystem or SystemFamily
        The system. Only the excitation may depend on Omega.
    Omega_range, eps_range : (float, float)
        The window, 0 < Omega and 0 <= eps.
    tolerance : float
        Largest distance between a polyline and the true edge, as part of the window's width and height. Regions that
        are nowhere wider in Omega than this part of the window are left out.
    n_jobs : int or None
        Workers, as in `stability_chart`.
    progress : bool or None
        Whether to show a progress bar; None shows it on a terminal only.

    Returns
    -------
    list of Region
        From the left. Regions that no resonance explains have an empty label.

    Raises
    ------
    ValueError
        If an argument has the wrong type or sign, is out of range, not finite or empty.
    """
    low, high = interval("Omega_range", Omega_range)
    real_number("Omega_range[0]", low, positive=True)
    bottom, top = interval("eps_range", eps_range, nonnegative=True)
    tolerance = real_number("tolerance", tolerance, positive=True)
    if not 1e-5 <= tolerance <= 0.1:
        raise ValueError(f"tolerance = {tolerance!r} is out of range; give a number from 1e-5 to 0.1")
    member = member_at(family, (low + high) / 2, "family")
    n_jobs = workers("n_jobs", n_jobs)
    progress = one_of("progress", progress, (True, False, None))

    width = high - low
    names = resonances(member, low - 0.2 * width, high + 0.2 * width)
    scan = Scan(family, (low, high), np.linspace(0.0, top, AMPLITUDES), n_jobs)
    base = np.linspace(low, high, COLUMNS + 1)
    feet = [name.centre for name in names if name.j <= 2 and name.sign > 0 and low < name.centre < high]
    with tqdm(total=3, unit="stage", disable=None if progress is None else not progress) as bar:
        scan.add([*base, *feet])
        bar.update()
        scan.refine(low, high, width, tolerance, tolerance * width / 4)
        bar.update()
        Omega, columns = scan.ordered()
        regions = []
        for places in components(columns):
            region = _region(family, Omega, columns, places, names, tolerance * width, bottom)
            if region is not None:
                regions.append(region)
        bar.update()
    return sorted(regions, key=lambda region: region.tip[0])


def _region(
    family: SystemFamily,
    Omega: FloatArray,
    columns: Sequence[Column],
    places: set[Place],
    names: list[Name],
    narrowest: float,
    bottom: float,
) -> Region | None:
    """Return the region of connected intervals; None if it is too narrow, or not verified."""
    if len({c for c, _ in places}) < 2:
        return None
    outlines = loops(Omega, columns, places)
    if _width(outlines) < narrowest:
        return None
    by_height = sorted(places, key=lambda place: columns[place[0]][place[1]].high - columns[place[0]][place[1]].low)
    c, i = by_height[-1]
    witness = (float(Omega[c]), columns[c][i].peak)
    if monodromy(family, *witness).kind <= Kind.STABLE:
        return None
    lowest = min(places, key=lambda place: columns[place[0]][place[1]].low)
    tip = (float(Omega[lowest[0]]), columns[lowest[0]][lowest[1]].low)
    named = _named(family, Omega, columns, places, outlines, names, narrowest)
    return Region(tuple(outlines), tuple(named), tip, witness)


def _named(
    family: SystemFamily,
    Omega: FloatArray,
    columns: Sequence[Column],
    places: set[Place],
    outlines: Sequence[Loop],
    names: list[Name],
    narrowest: float,
) -> list[Name]:
    """Return the resonances from which the feet of a region start."""
    found: list[Name] = []
    for c, i in _feet(columns, places, 0.01):
        foot = columns[c][i]
        eps = foot.low
        level = 1.3 * eps + 0.02 * (foot.high - eps)
        above = _chord(outlines, float(Omega[c]), level)
        middle = sum(above) / 2 if above else float(Omega[c])
        centre = Omega[c] - (middle - Omega[c]) * eps**2 / (level**2 - eps**2)
        reach = TOLERANCES * narrowest + DOUBT * abs(centre - Omega[c])
        fitting = [n for n in names if n.kind == foot.low_kind and abs(n.centre - centre) <= reach]
        fitting.sort(key=lambda n: (n.j, -n.sign, abs(n.centre - centre)))
        if fitting and fitting[0] not in found:
            found.append(fitting[0])
    return found


def _feet(columns: Sequence[Column], places: set[Place], prominence: float) -> list[Place]:
    """Return the intervals whose lower ends are lower than those on both sides."""
    row = sorted(places)
    feet = []
    lowest: dict[int, Place] = {}
    for place in row:
        if place[0] not in lowest or columns[place[0]][place[1]].low < columns[place[0]][lowest[place[0]][1]].low:
            lowest[place[0]] = place
    order = sorted(lowest)
    depth = [columns[c][lowest[c][1]].low for c in order]
    for k, c in enumerate(order):
        left = next((d for d in depth[k::-1] if d < depth[k] or d > depth[k] + prominence), np.inf)
        right = next((d for d in depth[k:] if d < depth[k] or d > depth[k] + prominence), np.inf)
        if min(left, right) > depth[k]:
            feet.append(lowest[c])
    return feet


def _chord(outlines: Sequence[Loop], Omega: float, level: float) -> tuple[float, float] | None:
    """Return the part of the region at the height ``level`` that is nearest to ``Omega``."""
    ends = _crossings(outlines, level)
    chords = list(zip(ends[::2], ends[1::2], strict=True))
    return min(chords, key=lambda chord: max(chord[0] - Omega, Omega - chord[1]), default=None)


def _width(outlines: Sequence[Loop]) -> float:
    """Return the largest width in Omega at one eps."""
    eps = outlines[0].eps
    levels = eps.min() + (eps.max() - eps.min()) * (np.arange(LEVELS) + 0.5) / LEVELS
    ends = [_crossings(outlines, level) for level in levels]
    return max((b - a for row in ends for a, b in zip(row[::2], row[1::2], strict=True)), default=0.0)


def _crossings(outlines: Sequence[Loop], level: float) -> list[float]:
    """Return where the outlines cross the height ``level``, in increasing order."""
    found: list[float] = []
    for loop in outlines:
        x, y = loop.Omega, loop.eps
        after_x, after_y = np.roll(x, -1), np.roll(y, -1)
        crossing = (y > level) != (after_y > level)
        part = (level - y[crossing]) / (after_y[crossing] - y[crossing])
        found += (x[crossing] + part * (after_x[crossing] - x[crossing])).tolist()
    return sorted(found)


def _inside(loop: Loop, Omega: FloatArray, eps: FloatArray) -> NDArray[np.bool_]:
    """Return whether points lie inside a closed polyline: an odd number of sides is crossed on the way to the right."""
    inside = np.zeros(Omega.shape, dtype=bool)
    for x0, y0, x1, y1 in zip(loop.Omega, loop.eps, np.roll(loop.Omega, -1), np.roll(loop.eps, -1), strict=True):
        if y0 != y1:
            crossing = (eps >= min(y0, y1)) & (eps < max(y0, y1))
            inside ^= crossing & (Omega < x0 + (eps - y0) * ((x1 - x0) / (y1 - y0)))
    return inside
