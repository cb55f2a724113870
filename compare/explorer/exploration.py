"""One system in one window of excitation frequency and amplitude: its chart, regions, analytic curves, files."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast

import numpy as np

from compare.audit import audit_sentence
from compare.explorer.outlines import WIDTH_LEVELS, draw_outlines
from compare.files import MAX_CHART_POINTS, save
from compare.pictures import overlay
from compare.window import RIGID_FREQUENCY
from floquet import Region, StabilityChart, stability_chart, trace_regions
from floquet.chart import TileStore
from floquet.regions import largest_width
from periodic import AnyFamily, AnySystem, PeriodicSystem, SystemFamily, has_stiffness_alone
from periodic.checks import interval, one_of, real_number, whole_number
from perturb import TransitionCurve, transition_curves

# How far beside the window, in parts of its width, a region may start that leans into it.
LEANING_PART = 0.25
# What is said where theory has nothing to draw.
NO_RESONANCE = "There are no analytic curves: no resonance starts in the window or beside it"
# What is said of a system that the tracing of regions does not take.
UNTRACED = (
    "The regions are not traced: that takes systems of which the stiffness alone depends on time, in harmonics. "
    "trace_boundary traces one of them, and agreement judges them."
)
# Amplitudes at which a curve is tested for being open in the window.
OPEN_TEST_POINTS = 65


@dataclass(frozen=True, eq=False)
class Exploration:
    """What theory and integration say about a system in a window.

    Attributes
    ----------
    title : str
        Heading of pictures and pages.
    chart : StabilityChart
        Floquet multipliers over the window.
    curves : list of TransitionCurve
        Analytic regions that are open somewhere in the window, by ascending centre.
    regions : list of Region
        Every region of instability in the window, traced and named. Empty if it was not asked for: see ``traced``.
    order : int
        Order of the theory, 1 or 2.
    remark : str
        Why there are no analytic curves, or no traced regions though they were asked for; empty if there are.
    traced : bool
        Whether regions were traced.
    """

    title: str
    chart: StabilityChart
    curves: list[TransitionCurve]
    regions: list[Region]
    order: int
    remark: str
    traced: bool = True

    @property
    def audit(self) -> str:
        """What the chart's audit found, in a sentence."""
        return audit_sentence(self.chart.audit)

    def write(self, folder: Path, name: str, *, netcdf: bool = False, units: Any = None) -> None:
        """Write ``name``-chart.png, -overlay.png and .pdf, -regions.json and ``name``.npz; with ``netcdf`` ``name``.nc.

        The axes of the pictures are in ``units`` (as `compare.plot` takes them), the data as they are.

        Raises
        ------
        ValueError
            If ``netcdf`` is asked for without the package xarray.
        """
        overlay(self.chart, [], title=self.title, units=units).savefig(folder / f"{name}-chart.png")
        figure = overlay(self.chart, self.curves, title=self.title, units=units)
        draw_outlines(figure, self.chart, self.regions)
        for suffix in ("png", "pdf"):
            figure.savefig(folder / f"{name}-overlay.{suffix}")
        found = [_plain(region) for region in self.regions] if self.traced else None
        regions = json.dumps(found, ensure_ascii=False)
        (folder / f"{name}-regions.json").write_text(regions, encoding="utf-8")
        self.chart.save(folder / f"{name}.npz")
        if netcdf:
            save(folder / f"{name}.nc", self.chart)


def _plain(region: Region) -> dict[str, Any]:
    """Return a region as numbers and strings, fit for JSON."""
    outlines = [
        {"Omega": loop.Omega.tolist(), "eps": loop.eps.tolist(), "kind": loop.kind.tolist()} for loop in region.outlines
    ]
    return {
        "label": region.label,
        "explained": region.explained,
        "tip": list(region.tip),
        "width": largest_width(region.outlines, WIDTH_LEVELS),
        "outlines": outlines,
    }


def explore(
    family: AnyFamily,
    Omega_range: tuple[float, float],
    eps_max: float,
    *,
    points: tuple[int, int] = (256, 128),
    order: int = 1,
    trace: bool = True,
    title: str = "",
    n_jobs: int = -1,
    progress: bool = False,
    cache: str | os.PathLike[str] | TileStore | None = None,
) -> Exploration:
    """Integrate a window, trace its regions and lay the analytic curves over them.

    Parameters
    ----------
    family : AnyFamily
        Any linear periodic system. What there is no theory for has no analytic curves, and what cannot be traced no
        regions; ``remark`` says so.
    Omega_range : (float, float)
        Excitation frequencies, 0 < low < high, in the system's units.
    eps_max : float
        Largest amplitude, > 0; the chart starts at 0.
    points : (int, int)
        Columns along Omega and rows along eps, 2 to 10,000 each.
    order : 1 or 2
        Order of the theory.
    trace : bool
        Whether to trace the regions, which takes about as long as a chart of 256 columns.
    title : str
        Heading.
    n_jobs : int
        Workers, as in joblib.
    progress : bool
        Show a progress bar.
    cache : path or TileStore, optional
        Folder that keeps finished tiles of the chart, as in `floquet.stability_chart`.

    Raises
    ------
    ValueError
        If an argument is out of range, or the system cannot be integrated in this window.
    """
    window = interval("Omega_range", Omega_range, nonnegative=True)
    real_number("Omega_range[0]", window[0], positive=True)
    eps_max = real_number("eps_max", eps_max, positive=True)
    columns, rows = (whole_number("points", number, least=2, most=MAX_CHART_POINTS) for number in points)
    one_of("order", order, (1, 2))
    curves, remark = analytic_curves(family, window, eps_max, order)
    Omega, eps = np.linspace(*window, columns), np.linspace(0, eps_max, rows)
    chart = stability_chart(family, Omega, eps, n_jobs=n_jobs, progress=progress, cache=cache)
    bounds = window, (0.0, eps_max)
    if trace and not has_stiffness_alone(family.at(window[0])):
        trace, remark = False, " ".join(filter(None, (remark, UNTRACED)))
    regions = trace_regions(cast(SystemFamily, family), *bounds, n_jobs=n_jobs, progress=progress) if trace else []
    return Exploration(title, chart, curves, regions, order, remark, trace)


def analytic_curves(
    family: AnyFamily, window: tuple[float, float], eps_max: float, order: int
) -> tuple[list[TransitionCurve], str]:
    """Return the curves open somewhere in the window, or none and a sentence that says why there is no theory."""
    low, high = window
    beside = LEANING_PART * (high - low)
    try:
        curves = transition_curves(cast(SystemFamily, family), (max(low - beside, 0.0), high + beside), order=order)
    except ValueError as error:  # the window has been checked: the theory refuses the system
        return [], f"The analytic curves are left out: {error}." + _without_stiffness(family.at(low))
    if not curves:
        return [], f"{NO_RESONANCE}.{_without_stiffness(family.at(low))}"
    return [curve for curve in curves if _enters(curve, window, eps_max)], ""


def _without_stiffness(system: AnySystem) -> str:
    """Return a sentence about motions without stiffness; nothing if there are none."""
    if not isinstance(system, PeriodicSystem):
        return ""
    scale = np.linalg.inv(np.linalg.cholesky(system.mass))
    held = np.linalg.svd(scale @ system.stiffness @ scale.T, compute_uv=False)
    free = int((held <= RIGID_FREQUENCY**2 * held[0]).sum())
    if free == 0:
        return ""
    motions = "1 motion has" if free == 1 else f"{free} motions have"
    return (
        f" {motions} no stiffness (K is singular), and so no frequency: a region that such a motion opens belongs to "
        "no resonance, even if it bears the names of those that it has swallowed."
    )


def _enters(curve: TransitionCurve, window: tuple[float, float], eps_max: float) -> bool:
    """Whether theory finds the region open, with some width, anywhere in the window."""
    lower, upper = curve.edges(np.linspace(0, eps_max, OPEN_TEST_POINTS))
    return bool(((upper > lower) & (upper > window[0]) & (lower < window[1])).any())
