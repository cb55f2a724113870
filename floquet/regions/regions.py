"""Every region of instability of a window as closed polylines, each with the resonances that it starts from."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray
from tqdm import tqdm

from floquet.boundary import Resonance
from floquet.oracle import is_unstable
from floquet.regions.naming import Naming, resonance_named
from floquet.regions.outlines import Column, IntervalId, Loop, components, contained, largest_width, loops
from floquet.regions.scan import Scan
from floquet.regions.segments import intervals, segments
from floquet.regions.tongues import Tongue, max_width, trace_tongues
from floquet.regions.widths import ExpectedTongue, expected_tongues
from floquet.regions.window import Window
from periodic import SystemFamily
from periodic.checks import FloatArray, interval, one_of, points, real_number, workers

# The tolerance, as part of the window: below, edges are not known that well; above, regions are not told apart.
MIN_TOLERANCE, MAX_TOLERANCE = 1e-5, 0.1
# A resonance whose region becomes wider than this part of the distance between the columns has a column of its own.
MIN_WIDTH_FOR_COLUMN = 0.5
# That column is no nearer to another one than this part of the width of the window.
MIN_DISTANCE_OF_COLUMN = 1e-4
# Regions that are nowhere wider than this part of the tolerance are left out.
MIN_REGION_WIDTH = 4e-4
# A region that is no longer narrow at this part of the height of the window is left to the columns.
MIN_TONGUE_HEIGHT = 0.05
# Amplitudes at which a resonance is compared with the wide regions, as parts of the height.
PROBED_HEIGHTS = np.array([1 / 64, 1 / 32, 1 / 16, *(np.arange(1, 9) / 8)])
# Narrow regions that are followed, at most: at low Omega and large eps there is no end of them.
MAX_TONGUES = 400
# Levels at which the width of a region is measured.
WIDTH_AMPLITUDES = 64
# Regions that get a line where all are shown.
MAX_REGIONS_SHOWN = 20

Ranges = tuple[tuple[float, float], tuple[float, float]]


@dataclass(frozen=True, eq=False, repr=False)
class Region:
    """One connected region of instability in a window of the (Omega, eps) plane.

    Attributes
    ----------
    outlines : tuple of Loop
        Closed polylines with arrays ``Omega`` and ``eps`` (dimensionless) and ``kind``, each (k,). The outer one comes
        first and runs counterclockwise. Those round stable islands follow and run clockwise. Then come its narrow
        tongues, in which the region goes on to its resonances; they run counterclockwise and may overlap. The first
        corner is not repeated at the end. ``kind`` is the `Kind` of the instability just inside. Where the region goes
        on beyond the window, the polyline follows the edge of the window.
    resonances : tuple of Resonance
        The resonances that the region starts from, from the left. They are several if regions have merged, or if they
        resonate together: with centres nearer to each other than their regions are wide, at the order of the lowest.
        Empty if none explains the region, or if the system is unstable without excitation.
    tip : (float, float)
        Omega and eps of its lowest point.
    witness : (float, float)
        Omega and eps of a point inside that is unstable by the method of `monodromy`; in a narrow region it may be one
        where the multipliers of a column are off the unit circle by far more than their error.
    window : ((float, float), (float, float)) or None
        The ranges of Omega and of eps that were traced; None if not known.
    """

    outlines: tuple[Loop, ...]
    resonances: tuple[Resonance, ...]
    tip: tuple[float, float]
    witness: tuple[float, float]
    window: Ranges | None = None

    @property
    def label(self) -> str:
        """Names of the resonances, such as "2ω₁" or "ω₁+ω₃, 2ω₂/2"; empty if none explains the region."""
        return ", ".join(one.label for one in self.resonances)

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
        return contained(self.outlines, x, y)

    def intervals(self, eps: float) -> FloatArray:
        """Return the intervals of Omega that the region has at one amplitude, shape (m, 2), from the left.

        Parameters
        ----------
        eps : float
            Within the amplitudes that were traced.

        Returns
        -------
        ndarray
            Of what lies in the window, to the tolerance of the outlines; m = 0 where the region is closed.
            `trace_boundary` finds edges to nine digits.

        Raises
        ------
        ValueError
            If ``eps`` is no number, or was not traced.
        """
        eps = real_number("eps", eps)
        if self.window is not None:
            bottom, top = self.window[1]
            if not bottom <= eps <= top:
                raise ValueError(f"eps = {eps:.6g} was not traced; give {bottom:.6g} to {top:.6g}, or trace more")
            eps = min(max(eps, np.nextafter(bottom, top)), np.nextafter(top, bottom))  # an outline ends at its window
        return intervals(self.outlines, eps)

    def width(self, eps: float) -> float:
        """Return the width in Omega at one amplitude: of all its intervals together; 0 where the region is closed.

        Raises
        ------
        ValueError
            As `intervals`, and if the region goes on beyond the window at this amplitude, so that its width is unknown.
        """
        found = self.intervals(eps)
        if self.window is not None and found.size:
            low, high = self.window[0]
            if found[0, 0] <= low or found[-1, 1] >= high:
                raise ValueError(
                    f"at eps = {eps:.6g} the region goes on beyond the window, Omega = {low:.6g} to {high:.6g}; trace "
                    "a wider one, or ask for its intervals"
                )
        return float(np.diff(found).sum())

    def __repr__(self) -> str:
        (Omega, eps), width = self.tip, largest_width(self.outlines, WIDTH_AMPLITUDES)
        name = self.label or "unexplained"
        return f"Region({name}: tip at Omega = {Omega:.6g}, eps = {eps:.4g}, up to {width:.4g} wide)"


class Regions(list[Region]):
    """The regions of a window, a list that also knows them by name: ``regions["2ω₁"]``.

    A name is that of a resonance which the region starts from, in any spelling: ``regions["w1+w3"]``.

    Attributes
    ----------
    Omega_range, eps_range : (float, float)
        The window.
    """

    def __init__(
        self, found: Iterable[Region], Omega_range: tuple[float, float], eps_range: tuple[float, float]
    ) -> None:
        super().__init__(replace(region, window=(Omega_range, eps_range)) for region in found)
        self.Omega_range, self.eps_range = Omega_range, eps_range

    @overload  # type: ignore[override]
    def __getitem__(self, key: int | str) -> Region: ...
    @overload
    def __getitem__(self, key: slice) -> list[Region]: ...
    def __getitem__(self, key: Any) -> Any:
        if not isinstance(key, str):
            return super().__getitem__(key)
        try:
            meant = resonance_named(key)
        except ValueError as error:
            raise KeyError(f"{error}; there are {self._names()}") from None
        found = [i for i, region in enumerate(self) if any(one[:4] == meant for one in region.resonances)]
        if not found:
            raise KeyError(f"no region in the window starts from {key}; there are {self._names()}")
        if len(found) > 1:
            raise KeyError(
                f"{len(found)} regions start from {key}; take one by its number: {', '.join(map(str, found))}"
            )
        return super().__getitem__(found[0])

    def _names(self) -> str:
        return ", ".join(region.label or "unexplained" for region in self) or "no regions"

    def __repr__(self) -> str:
        low, high, bottom, top = *self.Omega_range, *self.eps_range
        lines = [f"{len(self)} regions, Omega = {low:.6g} to {high:.6g}, eps = {bottom:.6g} to {top:.6g}"]
        lines += [f"  {i}  {region!r}" for i, region in enumerate(self[:MAX_REGIONS_SHOWN])]
        more = len(self) - MAX_REGIONS_SHOWN
        return "\n".join([*lines, *([f"  and {more} more"] if more > 0 else [])])


def trace_regions(
    family: SystemFamily,
    Omega_range: tuple[float, float],
    eps_range: tuple[float, float],
    *,
    tolerance: float = 1e-3,
    n_jobs: int | None = -1,
    progress: bool | None = None,
) -> Regions:
    """Follow every region of instability of a window and name it by the resonances that it starts from.

    Parameters
    ----------
    family : PeriodicSystem or SystemFamily
        The system. Only the excitation may depend on Omega.
    Omega_range, eps_range : (float, float)
        The window, 0 < Omega and 0 <= eps.
    tolerance : float
        Largest distance between a polyline and the true edge, as part of the window's width and height. A region is
        left out if it is nowhere wider in Omega than 0.0004 tolerance times the width of the window.
    n_jobs : int or None
        Workers, as in `stability_chart`.
    progress : bool or None
        Whether to show a progress bar. None shows it on a terminal only.

    Returns
    -------
    Regions
        A list of `Region`, from the left, that takes names, too: ``regions["2ω₁"]``. Regions that no resonance explains
        have an empty label.

    Raises
    ------
    ValueError
        If an argument has the wrong type or sign, is out of range, not finite or empty. Also if the family falls into
        other independent subsystems at one frequency of the window than at another.

    Notes
    -----
    Wide regions are found by 128 columns over the window, and by as many more as their edges, and stable gaps between
    them, need. Narrower ones pass between the columns. They are looked for at the resonances j Omega = omega_p ±
    omega_q, j <= 8, and followed from there (`floquet.regions.tongues`). A narrow region may be missed if it starts at
    none of these, or where others crowd it. A stable gap may be missed if it is narrower than the tolerance in Omega or
    in eps. Every region has a witness.
    """
    low, high = interval("Omega_range", Omega_range)
    real_number("Omega_range[0]", low, positive=True)
    bottom, top = interval("eps_range", eps_range, nonnegative=True)
    tolerance = real_number("tolerance", tolerance, positive=True)
    if not MIN_TOLERANCE <= tolerance <= MAX_TOLERANCE:
        limits = f"{MIN_TOLERANCE:g} to {MAX_TOLERANCE:g}"
        raise ValueError(f"tolerance = {tolerance!r} is out of range; give a number from {limits}")
    n_jobs = workers("n_jobs", n_jobs)
    progress = one_of("progress", progress, (True, False, None))
    window = Window(family, (low, high), (bottom, top), tolerance, n_jobs)
    expected = _expected(window)
    scan = Scan(window)
    with tqdm(total=4, unit="stage", disable=None if progress is None else not progress) as bar:
        scan.add(_first_columns(window, expected))
        bar.update()
        scan.refine()
        bar.update()
        wide = _wide_regions(scan, expected)
        bar.update()
        regions = _joined(window, wide, trace_tongues(_narrow(window, expected, wide), scan))
        bar.update()
    return Regions(sorted(regions, key=lambda region: region.tip[0]), (low, high), (bottom, top))


def _expected(window: Window) -> list[ExpectedTongue]:
    """Return what may open at the resonances in the window, or at most one span beside it."""
    (low, high), spare = window.Omega_range, window.spacing
    some = [one for one in window.resonances if low - spare < one.centre < high + spare]
    return expected_tongues(window.member, window.modes, some, window.eps_range[1])


def _first_columns(window: Window, expected: Sequence[ExpectedTongue]) -> list[float]:
    """Return the frequencies of the columns before any refinement: equally spaced ones, and some at resonances.

    The first and the last lie beside the window: they know the modes for what starts outside.
    """
    low, high = window.Omega_range
    columns: list[float] = np.linspace(low, high, window.spans + 1).tolist()
    for tongue in expected:
        centre, is_wide = tongue.resonance.centre, tongue.width > MIN_WIDTH_FOR_COLUMN * window.spacing
        is_wide &= tongue.resonance.j <= 2 * window.member.harmonics and low < centre < high
        if is_wide and min(abs(w - centre) for w in columns) > MIN_DISTANCE_OF_COLUMN * window.width:
            columns.append(centre)
    return [*columns, *(w for w in (low - window.spacing, high + window.spacing) if w > 0)]


def _narrow(window: Window, expected: Sequence[ExpectedTongue], wide: Sequence[Region]) -> list[ExpectedTongue]:
    """Return the expected tongues that may be narrow and are not yet known to belong to wide regions."""
    bottom, widest = window.eps_range[0], max_width(window)
    narrowest, lowest = MIN_REGION_WIDTH * window.tolerance * window.width, bottom + MIN_TONGUE_HEIGHT * window.height
    tall = [one for one in expected if one.width >= narrowest and one.eps_of_width(widest) >= lowest]
    if not tall:
        return []
    centres = np.array([one.resonance.centre for one in tall])[:, None]
    ends = np.array([one.eps_of_width(widest) for one in tall])[:, None]
    amplitudes = bottom + (ends - bottom) * PROBED_HEIGHTS
    known = np.zeros(amplitudes.shape, dtype=bool)
    for region in wide:
        known |= region.contains(centres, amplitudes)
    return [tall[i] for i in np.flatnonzero(~known.all(axis=1))][:MAX_TONGUES]


def _joined(window: Window, wide: Sequence[Region], narrow: Sequence[Tongue]) -> list[Region]:
    """Return the wide regions with the tongues that they go on in, and the tongues that stand alone."""
    regions = list(wide)
    narrowest = MIN_REGION_WIDTH * window.tolerance * window.width

    def named(tongue: Tongue) -> tuple[Resonance, ...]:
        return () if window.is_unstable_at_rest else (tongue.resonance,)

    for tongue, loop, number in segments(narrow, [region.contains for region in wide], window):
        lowest = int(loop.eps.argmin())
        tip = (float(loop.Omega[lowest]), float(loop.eps[lowest]))
        if number is not None:
            old = regions[number]
            names = tuple(dict.fromkeys((*old.resonances, *named(tongue))))
            tip = min(old.tip, tip, key=lambda place: place[1])
            regions[number] = replace(old, outlines=(*old.outlines, loop), resonances=names, tip=tip)
        elif (tongue.upper - tongue.lower).max() >= narrowest:
            witness, sure = _witness(tongue, loop, window)
            if sure or is_unstable(window.family, *witness, tongue.modes):
                regions.append(Region((loop,), named(tongue), tip, witness))
    return regions


def _witness(tongue: Tongue, loop: Loop, window: Window) -> tuple[tuple[float, float], bool]:
    """Return a point inside a segment of a tongue, and whether it is known to be unstable.

    The tongue has one, unless that lies in another segment or outside the window. Then it is on the centreline where
    the segment is widest.
    """
    Omega, eps = tongue.witness
    if loop.eps.min() <= eps <= loop.eps.max() and window.covers(Omega):
        return tongue.witness, tongue.sure
    amplitudes = len(loop.eps) // 2
    right, left = loop.Omega[:amplitudes], loop.Omega[: -amplitudes - 1 : -1]
    widest = int((right - left).argmax())
    return (float(right[widest] + left[widest]) / 2, float(loop.eps[widest])), False


def _wide_regions(scan: Scan, expected: Sequence[ExpectedTongue]) -> list[Region]:
    """Return the regions that the columns of a scan meet."""
    Omega, columns = scan.ordered()
    naming = Naming(scan, expected)
    bottom = scan.window.eps_range[0]
    shown = [[one._replace(low=max(one.low, bottom)) for one in column if one.high > bottom] for column in columns]
    found = (_region(scan, Omega, shown, members, naming) for members in components(shown))
    return [region for region in found if region is not None]


def _region(
    scan: Scan, Omega: FloatArray, columns: Sequence[Column], members: set[IntervalId], naming: Naming
) -> Region | None:
    """Return the region of connected intervals; None if it is too narrow, or not verified."""
    resolution = scan.window.resolution
    met = {c for c, _ in members}
    cut = not met.isdisjoint((0, len(columns) - 1))  # by an edge of the window: how wide it is beyond that is unknown
    if len(met) < 2 and not cut:
        return None
    outlines = loops(Omega, columns, members, resolution)
    if largest_width(outlines, WIDTH_AMPLITUDES) < resolution and not cut:
        return None
    c, i = max(members, key=lambda one: columns[one[0]][one[1]].high - columns[one[0]][one[1]].low)
    witness = (float(Omega[c]), (columns[c][i].low + columns[c][i].high) / 2)
    if not is_unstable(scan.window.family, *witness, scan.most_unstable(*witness)):
        return None
    lowest = int(outlines[0].eps.argmin())
    tip = (float(outlines[0].Omega[lowest]), float(outlines[0].eps[lowest]))
    return Region(tuple(outlines), tuple(naming.resonances_of(c, columns[c][i].high)), tip, witness)
