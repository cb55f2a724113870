"""Every region of instability of a window as closed polylines, each with the resonances that it starts from."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray
from tqdm import tqdm

from floquet.boundary import Resonance, natural_modes, open_types, resonances
from floquet.oracle import is_unstable
from floquet.regions.naming import Namer
from floquet.regions.outlines import Column, Loop, Place, area, components, largest_width, loops, within
from floquet.regions.scan import AMPLITUDES, Scan
from floquet.regions.stretches import branches
from floquet.regions.tongues import Tongue, reach, trace_tongues
from floquet.regions.widths import Candidate, candidates
from periodic import SystemFamily, member_at
from periodic.checks import FloatArray, interval, one_of, points, real_number, workers

# Columns before any refinement. Regions narrower than the distance between them are looked for at their resonances.
COLUMNS = 128
# The resonances of regions that become wider than this part of the distance between the columns have a column each.
FOOT = 0.5
# Narrow regions are followed up to this many such distances.
WIDE = 2.0
# Regions that are nowhere wider than this part of the tolerance are left out.
NARROWEST = 4e-4
# A region that is no longer narrow at this part of the height of the window is left to the columns.
SOON = 0.05
# Amplitudes at which a resonance is compared with the wide regions, as parts of the height.
PROBES = np.array([1 / 64, 1 / 32, 1 / 16, *(np.arange(1, 9) / 8)])
# No more resonances than these are followed: at low Omega and large eps there is no end of them.
MOST = 400
# A column at a resonance is placed no nearer to the others than this part of the window.
APART = 1e-4
# Levels at which the width of a region is measured.
LEVELS = 64
# Amplitudes below the window, on the way down to the resonances.
BELOW = 64


@dataclass(frozen=True, eq=False)
class Region:
    """One connected region of instability in a window of the (Omega, eps) plane.

    Attributes
    ----------
    outlines : tuple of Loop
        Closed polylines with arrays ``Omega``, ``eps`` and ``kind`` (k,): the outer one first, counterclockwise, then
        those round stable islands, clockwise, then those of its narrow branches, in which the region goes on to its
        resonances, counterclockwise; these may overlap. The first corner is not repeated at the end. ``kind`` is the
        `Kind` of the instability just inside. Where the region goes on beyond the window, the polyline follows the edge
        of the window.
    resonances : tuple of Resonance
        The resonances that the region starts from, several if regions have merged; empty if none explains it.
    tip : (float, float)
        Omega and eps of its lowest point.
    witness : (float, float)
        Omega and eps of a point inside that is unstable: by the method of `monodromy`, or, in a narrow region, by the
        multipliers of a column that are off the unit circle by far more than their error.
    """

    outlines: tuple[Loop, ...]
    resonances: tuple[Resonance, ...]
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
        """Return whether points lie inside, or on an edge.

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
            If an argument is not real or not finite, or the shapes do not broadcast.
        """
        x, y = points(Omega, eps)
        inside = np.zeros((2, *x.shape), dtype=int)
        for loop in self.outlines:
            box = (x >= loop.Omega.min()) & (x <= loop.Omega.max()) & (y >= loop.eps.min()) & (y <= loop.eps.max())
            if box.any():
                # islands run clockwise; branches may overlap
                turn = -1 if area(loop.Omega, loop.eps) < 0 else 1
                inside[:, box] += turn * within(loop.Omega, loop.eps, x[box], y[box])
        return np.asarray((inside > 0).any(axis=0))


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
        are nowhere wider in Omega than 0.0004 of this part of the window are left out.
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
        If an argument has the wrong type or sign, is out of range, not finite or empty; or if the family falls into
        other independent subsystems at one frequency of the window than at another.

    Notes
    -----
    Wide regions are what 128 columns of the window meet, and as many more as their edges, and stable gaps between them,
    need. Narrower ones, which pass between the columns, are looked for at the resonances j Omega = omega_p ± omega_q,
    j <= 8, and followed from there (`tongues`). A narrow region may be missed if it starts at none of these, or
    where it is crowded by others; so may a stable gap that is narrower than the tolerance in Omega, or than an 80th of
    the window in eps. Every region has a witness.
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
    modes = natural_modes(member, (low + high) / 2)
    names = resonances(modes, (low - 0.2 * width, high + 0.2 * width), open_types(member))
    # below the window, too: names come from where the regions start
    eps = np.concatenate(
        [np.linspace(0.0, bottom, BELOW, endpoint=False)[: BELOW * (bottom > 0)], np.linspace(bottom, top, AMPLITUDES)]
    )
    scan = Scan(family, (low, high), eps, n_jobs)
    base = np.linspace(low, high, COLUMNS + 1).tolist()
    spare = width / COLUMNS
    expected = candidates(member, modes, [name for name in names if low - spare < name.centre < high + spare], top)
    feet = [
        one.name.centre for one in expected if one.width > FOOT * width / COLUMNS and one.name.j <= 2 * member.harmonics
    ]
    for foot in feet:
        if low < foot < high and min(abs(w - foot) for w in base) > APART * width:
            base.append(foot)
    with tqdm(total=4, unit="stage", disable=None if progress is None else not progress) as bar:
        beside = [w for w in (low - spare, high + spare) if w > 0]  # where modes go on, for what starts outside
        scan.add([*base, *beside])
        bar.update()
        scan.refine((width, top - bottom), bottom, tolerance)
        bar.update()
        Omega, columns = scan.ordered()
        namer = Namer(family, Omega, columns, names, tolerance * width)
        shown = [_above(column, bottom) for column in columns]
        found = (_region(scan, Omega, shown, places, namer, tolerance * width) for places in components(shown))
        wide = [region for region in found if region is not None]
        bar.update()
        narrow = trace_tongues(
            family,
            _narrow(expected, wide, (low, high), (bottom, top), tolerance),
            scan,
            (bottom, top),
            WIDE * width / COLUMNS,
            n_jobs,
        )
        regions = _joined(family, wide, narrow, (low, high), NARROWEST * tolerance * width)
        bar.update()
    return sorted(regions, key=lambda region: region.tip[0])


def _narrow(
    expected: Sequence[Candidate],
    wide: Sequence[Region],
    Omega_range: tuple[float, float],
    eps_range: tuple[float, float],
    tolerance: float,
) -> list[Candidate]:
    """Return the resonances whose regions may be narrow and are not yet known to belong to wide ones."""
    (low, high), (bottom, top) = Omega_range, eps_range
    widest = WIDE * (high - low) / COLUMNS
    narrowest = NARROWEST * tolerance * (high - low)
    tall = [
        one for one in expected if one.width >= narrowest and reach(one, top, widest) >= bottom + SOON * (top - bottom)
    ]
    if not tall:
        return []
    centres = np.array([one.name.centre for one in tall])[:, None]
    ends = np.array([reach(one, top, widest) for one in tall])[:, None]
    levels = bottom + (ends - bottom) * PROBES
    known = np.zeros(levels.shape, dtype=bool)
    for region in wide:
        known |= region.contains(centres, levels)
    return [tall[i] for i in np.flatnonzero(~known.all(axis=1))][:MOST]


def _joined(
    family: SystemFamily,
    wide: Sequence[Region],
    narrow: Sequence[Tongue],
    window: tuple[float, float],
    narrowest: float,
) -> list[Region]:
    """Return the wide regions with the narrow ones that they go on in, and the narrow ones that stand alone."""
    regions = list(wide)
    for tongue, loop, parent in branches(narrow, [region.contains for region in wide], window):
        lowest = int(loop.eps.argmin())
        tip = (float(loop.Omega[lowest]), float(loop.eps[lowest]))
        if parent is not None:
            old = regions[parent]
            names = old.resonances if tongue.name in old.resonances else (*old.resonances, tongue.name)
            tip = min(old.tip, tip, key=lambda place: place[1])
            regions[parent] = replace(old, outlines=(*old.outlines, loop), resonances=names, tip=tip)
        elif (tongue.upper - tongue.lower).max() >= narrowest:
            witness, sure = _witness(tongue, loop, window)
            if sure or is_unstable(family, *witness, tongue.modes):
                regions.append(Region((loop,), (tongue.name,), tip, witness))
    return regions


def _witness(tongue: Tongue, loop: Loop, window: tuple[float, float]) -> tuple[tuple[float, float], bool]:
    """Return a point inside a stretch of a narrow region, and whether it is known to be unstable.

    The tongue has one, unless it lies in another stretch, or outside the window; then it is the middle of the widest
    level.
    """
    Omega, eps = tongue.witness
    if loop.eps.min() <= eps <= loop.eps.max() and window[0] <= Omega <= window[1]:
        return tongue.witness, tongue.sure
    levels = len(loop.eps) // 2
    right, left = loop.Omega[:levels], loop.Omega[: -levels - 1 : -1]
    widest = int((right - left).argmax())
    return (float(right[widest] + left[widest]) / 2, float(loop.eps[widest])), False


def _above(column: Column, bottom: float) -> Column:
    """Return the part of the intervals of a column that is above ``bottom``."""
    return [interval._replace(low=max(interval.low, bottom)) for interval in column if interval.high > bottom]


def _region(
    scan: Scan,
    Omega: FloatArray,
    columns: Sequence[Column],
    places: set[Place],
    namer: Namer,
    narrowest: float,
) -> Region | None:
    """Return the region of connected intervals; None if it is too narrow, or not verified."""
    met = {c for c, _ in places}
    cut = not met.isdisjoint((0, len(columns) - 1))  # by an edge of the window: how wide it is beyond that is unknown
    if len(met) < 2 and not cut:
        return None
    outlines = loops(Omega, columns, places, narrowest)
    if largest_width(outlines, LEVELS) < narrowest and not cut:
        return None
    c, i = max(places, key=lambda place: columns[place[0]][place[1]].high - columns[place[0]][place[1]].low)
    witness = (float(Omega[c]), (columns[c][i].low + columns[c][i].high) / 2)
    if not is_unstable(scan.family, *witness, scan.most_unstable(*witness)):
        return None
    lowest = int(outlines[0].eps.argmin())
    tip = (float(outlines[0].Omega[lowest]), float(outlines[0].eps[lowest]))
    return Region(tuple(outlines), tuple(namer.names_of(c, columns[c][i].high)), tip, witness)
