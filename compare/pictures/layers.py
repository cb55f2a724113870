"""The layers of a picture: growth rates, traced edges, analytic curves, and the legend of them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from numpy.typing import NDArray

from compare.pictures.colours import GROWTH_MAP, REFUSED_GREY, UNDECIDED_GREY
from compare.pictures.style import EDGE_LINE_WIDTH, ORANGE, THEORY
from floquet import BoundaryTrace, Kind, PlaneChart, StabilityChart
from periodic.checks import FloatArray
from perturb import TransitionCurve


def draw_growth(
    axes: Axes,
    chart: StabilityChart | PlaneChart | None,
    *,
    colour_bar: bool = False,
    frequency: float = 1.0,
    rate: float = 1.0,
    rate_unit: str = "",
) -> None:
    """Shade each cell by its growth rate: white where stable, grey where undecided, light grey without a system.

    Frequencies and rates are drawn ``frequency`` and ``rate`` times as large, the latter with their unit.
    """
    if chart is None:
        return
    unstable = chart.kind > Kind.STABLE
    growth = np.ma.masked_where(~unstable, chart.growth_rate * rate)
    if isinstance(chart, PlaneChart):
        x, y, undecided = chart.x, chart.y, (chart.kind == Kind.UNDECIDED) & ~chart.refused
        paint(axes, x, y, chart.refused, REFUSED_GREY)
    else:
        x, y, undecided = chart.Omega * frequency, chart.eps, chart.kind == Kind.UNDECIDED
    mesh = axes.pcolormesh(x, y, growth, cmap=GROWTH_MAP, vmin=0, shading="nearest", rasterized=True, zorder=0)
    paint(axes, x, y, undecided, UNDECIDED_GREY)
    if colour_bar and unstable.any():
        bar = axes.figure.colorbar(mesh, ax=axes, pad=0.01, aspect=30)
        bar.set_label("growth rate  max log|μ| / T" + (f" ({rate_unit})" if rate_unit else ""))
        bar.outline.set_visible(False)


def paint(axes: Axes, x: FloatArray, y: FloatArray, cells: NDArray[np.bool_], colour: str) -> None:
    """Give cells one colour."""
    if cells.any():
        ones = np.ma.masked_where(~cells, np.ones(cells.shape))
        axes.pcolormesh(x, y, ones, cmap=ListedColormap([colour]), shading="nearest", rasterized=True, zorder=0)


def draw_traces(
    axes: Axes,
    traces: Sequence[BoundaryTrace],
    colour: str = "black",
    width: float = EDGE_LINE_WIDTH,
    fill: bool = False,
    frequency: float = 1.0,
) -> None:
    """Draw the edges found by integration as solid lines, the region between them shaded on request.

    A line skips points at which an open region could not be followed, and breaks where the region is closed. Where it
    has merged with another one it ends at the place where that takes over.
    """
    for trace in traces:
        closed = trace.kind == Kind.STABLE
        lower = np.where(np.isnan(trace.lower_meeting), trace.lower, trace.lower_meeting) * frequency
        upper = np.where(np.isnan(trace.upper_meeting), trace.upper, trace.upper_meeting) * frequency
        for edge in (lower, upper):
            kept = closed | np.isfinite(edge)
            axes.plot(edge[kept], trace.eps[kept], color=colour, lw=width, zorder=3)
        if fill:
            kept = closed | np.isfinite(upper - lower)
            axes.fill_betweenx(
                trace.eps[kept],
                lower[kept],
                upper[kept],
                where=~closed[kept],
                color=colour,
                alpha=0.15,
                lw=0,
                zorder=1,
            )


def draw_curves(
    axes: Axes,
    curves: Sequence[TransitionCurve],
    eps_max: float,
    colour: str = ORANGE,
    width: float = EDGE_LINE_WIDTH,
    frequency: float = 1.0,
) -> None:
    """Draw the analytic transition curves as dashed lines."""
    for curve in curves:
        lower, upper = curve.edges(_curve_eps(curve, eps_max))
        for edge in (lower, upper):
            axes.plot(edge * frequency, _curve_eps(curve, eps_max), color=colour, lw=width, ls=(0, (4, 2)), zorder=4)


def _curve_eps(curve: TransitionCurve, eps_max: float) -> FloatArray:
    """Values of eps that show a straight line, and the parabola-like tip of a damped region where it turns."""
    if not 0 < curve.tip < eps_max:
        return np.linspace(0, eps_max, 41)
    return curve.tip + (eps_max - curve.tip) * np.linspace(0, 1, 81) ** 2


def legend_handles(chart: StabilityChart | None, *, traced: bool, theory: bool = True) -> list[Line2D | Patch]:
    """Return one legend entry for each thing that the picture shows."""
    handles: list[Line2D | Patch] = []
    if chart is not None:
        handles.append(Patch(color=GROWTH_MAP(0.6), label="unstable by integration"))
        if (chart.kind == Kind.UNDECIDED).any():
            handles.append(Patch(color=UNDECIDED_GREY, label="undecided"))
    if traced:
        handles.append(Line2D([], [], color="black", lw=EDGE_LINE_WIDTH, label="Floquet boundary (traced)"))
    if theory:
        handles.append(Line2D([], [], color=ORANGE, lw=EDGE_LINE_WIDTH, ls=(0, (4, 2)), label=THEORY))
    return handles
