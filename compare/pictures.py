"""Pictures: the growth-rate map of the Floquet multipliers under the analytic transition curves."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from io import BytesIO
from itertools import zip_longest
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from compare.colours import GROWTH_MAP, UNDECIDED_GREY
from floquet import BoundaryTrace, Kind, StabilityChart
from periodic.checks import FloatArray
from perturb import TransitionCurve

# Okabe and Ito's colours, told apart by readers with any colour vision; the analytic curve always wears the warm one.
BLUE, ORANGE, GREEN, PURPLE, GREY = "#0072B2", "#D55E00", "#009E73", "#CC79A7", "#777777"
VARIANT_COLOURS = (BLUE, ORANGE, GREEN, PURPLE)
# Width of a character and least space between two labels, in points.
CHARACTER_POINTS, LABEL_GAP_POINTS = 5.6, 8.0
# Width at the top of the window, as part of the window, below which a region is not seen.
MIN_VISIBLE_WIDTH = 1 / 400
# Width of the line of an edge, in points, and how much wider the line of each earlier variant is, so that it stays
# visible beneath the next.
EDGE_LINE_WIDTH, VARIANT_WIDENING = 1.4, 1.0
# Width that the legend of a picture with a single panel needs, in inches.
MIN_LEGEND_INCHES = 4.8
THEORY = "multiple scales"  # in legends

STYLE: dict[Any, Any] = {
    "font.size": 9,
    "axes.titlesize": 10,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "legend.frameon": False,
    "figure.dpi": 150,
    "savefig.bbox": "tight",
    "text.parse_math": False,  # labels and file names are anybody's: a $ in them is a $
}


def overlay(
    chart: StabilityChart | None,
    curves: Sequence[TransitionCurve],
    traces: Sequence[BoundaryTrace] = (),
    *,
    title: str = "",
    size: tuple[float, float] = (9.0, 4.8),
) -> Picture:
    """Draw a stability chart, the traced boundaries and the analytic transition curves in one picture.

    Parameters
    ----------
    chart : StabilityChart or None
        Growth-rate map to lay underneath; None leaves it out.
    curves : sequence of TransitionCurve
        Analytic curves, each labelled with its resonance on the upper edge.
    traces : sequence of BoundaryTrace
        Edges found by root-finding on the multipliers.
    title : str
        Heading.
    size : (float, float)
        Width and height in inches.

    Returns
    -------
    Picture
        A matplotlib figure. Save it with ``figure.savefig(path)``; as the value of a notebook's cell it shows itself.

    Raises
    ------
    ValueError
        If there is nothing to draw.
    """
    if chart is None and not traces:
        raise ValueError("chart is None and traces is empty; give a chart, traces or both")
    with mpl.rc_context(STYLE):
        figure = new_figure(size)
        axes = figure.add_subplot()
        eps = chart.eps if chart is not None else np.unique(np.concatenate([trace.eps for trace in traces]))
        if chart is not None:
            axes.set_xlim(chart.Omega[0], chart.Omega[-1])
        axes.set_ylim(0, eps[-1])
        draw_growth(axes, chart, colour_bar=True)
        draw_traces(axes, traces)
        traced = {trace.near for trace in traces if trace.is_open.any()}
        shown = [curve for curve in curves if curve.centre in traced or _is_visible(axes, curve, eps[-1])]
        draw_curves(axes, shown, eps[-1])
        label_regions(figure, axes, shown, eps[-1], first=traced)
        axes.set_xlabel("excitation frequency Ω")
        axes.set_ylabel("amplitude ε")
        axes.set_title(title, loc="left", pad=30)
        handles = legend_handles(chart, traced=bool(traces), theory=bool(shown))
        figure.legend(handles=handles, loc="outside lower center", ncols=4)
    return figure


@dataclass(frozen=True, eq=False)
class Layer:
    """What a comparison draws of one system.

    Attributes
    ----------
    label : str
        Name in the legend; empty for a system that is alone.
    chart : StabilityChart
        Growth-rate map over the window.
    panels : sequence of (TransitionCurve, BoundaryTrace)
        Theory and integration, region by region.
    """

    label: str
    chart: StabilityChart
    panels: Sequence[tuple[TransitionCurve, BoundaryTrace]]


def region_panels(layers: Sequence[Layer], *, title: str = "") -> Figure:
    """Draw one panel a region, as the paper's Figs. 2-4 and 6 do, with every system inside it.

    Parameters
    ----------
    layers : sequence of Layer
        One to four systems with the same regions.
    title : str
        Heading.

    Returns
    -------
    matplotlib.figure.Figure
    """
    regions = list(dict.fromkeys(_region(curve) for layer in layers for curve, _ in layer.panels))
    columns = min(3, len(regions))
    rows = -(-len(regions) // columns)
    with mpl.rc_context(STYLE):
        figure = new_figure((max(3.2 * columns, MIN_LEGEND_INCHES), 2.6 * rows + 0.9))
        for index, (region, axes) in enumerate(
            zip(regions, figure.subplots(rows, columns, squeeze=False).flat, strict=False)
        ):
            shown = [
                (curve, trace, VARIANT_COLOURS[order], EDGE_LINE_WIDTH + VARIANT_WIDENING * (len(layers) - 1 - order))
                for order, layer in enumerate(layers)
                for curve, trace in layer.panels
                if _region(curve) == region
            ]
            alone = len(layers) == 1
            for curve, trace, colour, width in shown:
                draw_traces(axes, [trace], "black" if alone else colour, width, fill=True)
                if alone:
                    draw_curves(axes, [curve], trace.eps[-1], ORANGE, EDGE_LINE_WIDTH)
                elif trace.is_open.any():
                    draw_curves(axes, [curve], trace.eps[-1], "black", 0.9)
                else:  # nothing of its own colour to lie on
                    draw_curves(axes, [curve], trace.eps[-1], colour, width)
            _frame_region(axes, [(curve, trace) for curve, trace, *_ in shown])
            axes.set_title(f"({chr(ord('a') + index)})  {shown[0][0].label}", loc="left")
            axes.set_xlabel("Ω")
            axes.set_ylabel("ε")
        figure.suptitle(title, fontsize=11)
        if len(layers) == 1:
            figure.legend(handles=legend_handles(None, traced=True), loc="outside lower center", ncols=4)
        else:
            figure.legend(handles=_variant_handles(layers), loc="outside lower center", ncols=len(layers))
    return figure


def _region(curve: TransitionCurve) -> tuple[frozenset[int], int, str]:
    """Return what tells one region of a system from another."""
    return frozenset((curve.p, curve.q)), curve.j, curve.type


def variant_panels(layers: Sequence[Layer], *, title: str = "") -> Figure:
    """Draw one panel a system, as the paper's Fig. 5 does, with the regions that the case looks at inside.

    Parameters and returns as `region_panels`.
    """
    with mpl.rc_context(STYLE):
        figure = new_figure((9.0, 2.2 * len(layers) + 0.9))
        for index, (layer, axes) in enumerate(
            zip(layers, figure.subplots(len(layers), 1, sharex=True, squeeze=False).flat, strict=True)
        ):
            axes.set_xlim(layer.chart.Omega[0], layer.chart.Omega[-1])
            axes.set_ylim(0, layer.chart.eps[-1])
            opened = [(curve, trace) for curve, trace in layer.panels if trace.is_open.any()]
            draw_traces(axes, [trace for _, trace in opened], fill=True)
            curves = [curve for curve, _ in opened]
            draw_curves(axes, curves, layer.chart.eps[-1])
            label_regions(figure, axes, curves, layer.chart.eps[-1])
            axes.set_title(f"({chr(ord('a') + index)})  {layer.label}", loc="left", pad=26)
            axes.set_ylabel("ε")
        axes.set_xlabel("excitation frequency Ω")
        figure.suptitle(title, fontsize=11)
        figure.legend(handles=legend_handles(None, traced=True), loc="outside lower center", ncols=4)
    return figure


def _frame_region(axes: Axes, shown: Sequence[tuple[TransitionCurve, BoundaryTrace]]) -> None:
    """Set limits that hold every edge with a margin; say so where there is nothing to see."""
    edges = np.concatenate(
        [[curve.centre, *curve.edges(trace.eps[-1]), *trace.lower, *trace.upper] for curve, trace in shown]
    )
    edges = edges[np.isfinite(edges)]
    low, high = float(edges.min()), float(edges.max())
    margin = max(0.12 * (high - low), 2e-3 * high)
    axes.set_xlim(low - margin, high + margin)
    axes.set_ylim(0, max(trace.eps[-1] for _, trace in shown))
    axes.locator_params(nbins=5)
    if not any(trace.is_open.any() for _, trace in shown):
        place: dict[str, Any] = {"transform": axes.transAxes, "ha": "center", "zorder": 5}
        axes.text(0.5, 0.5, "no instability found", color=GREY, backgroundcolor="white", **place)


def _variant_handles(layers: Sequence[Layer]) -> list[Line2D | Patch]:
    """Return the entries column by column: variants in the first row, kinds of line in the second."""
    named = [Patch(color=colour, label=layer.label) for layer, colour in zip(layers, VARIANT_COLOURS, strict=False)]
    lines = [
        Line2D([], [], color=GREY, lw=EDGE_LINE_WIDTH + VARIANT_WIDENING, label="Floquet boundary (traced)"),
        Line2D([], [], color="black", lw=0.9, ls=(0, (4, 2)), label=THEORY),
    ]
    return [handle for pair in zip_longest(named, lines) for handle in pair if handle is not None]


class Picture(Figure):
    """A figure that no window system knows of; a notebook shows it as the value of a cell."""

    def _repr_png_(self) -> bytes:
        """Return the picture as IPython asks for it."""
        buffer = BytesIO()
        self.savefig(buffer, format="png")
        return buffer.getvalue()


def new_figure(size: tuple[float, float]) -> Picture:
    """Return an empty picture."""
    figure = Picture(figsize=size, layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def draw_growth(axes: Axes, chart: StabilityChart | None, *, colour_bar: bool = False) -> None:
    """Shade each cell by its growth rate: white where stable, grey where undecided."""
    if chart is None:
        return
    unstable = chart.kind > Kind.STABLE
    growth = np.ma.masked_where(~unstable, chart.growth_rate)
    mesh = axes.pcolormesh(
        chart.Omega, chart.eps, growth, cmap=GROWTH_MAP, vmin=0, shading="nearest", rasterized=True, zorder=0
    )
    undecided = np.ma.masked_where(chart.kind != Kind.UNDECIDED, np.ones_like(chart.growth_rate))
    grey = ListedColormap([UNDECIDED_GREY])
    axes.pcolormesh(chart.Omega, chart.eps, undecided, cmap=grey, shading="nearest", rasterized=True, zorder=0)
    if colour_bar and unstable.any():
        bar = axes.figure.colorbar(mesh, ax=axes, pad=0.01, aspect=30)
        bar.set_label("growth rate  max log|μ| / T")
        bar.outline.set_visible(False)


def draw_traces(
    axes: Axes,
    traces: Sequence[BoundaryTrace],
    colour: str = "black",
    width: float = EDGE_LINE_WIDTH,
    fill: bool = False,
) -> None:
    """Draw the edges found by integration as solid lines, the region between them shaded on request.

    A line skips points at which an open region could not be followed, and breaks where the region is closed. Where it
    has merged with another one it ends at the place where that takes over.
    """
    for trace in traces:
        closed = trace.kind == Kind.STABLE
        lower = np.where(np.isnan(trace.lower), trace.lower_meeting, trace.lower)
        upper = np.where(np.isnan(trace.upper), trace.upper_meeting, trace.upper)
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
    axes: Axes, curves: Sequence[TransitionCurve], eps_max: float, colour: str = ORANGE, width: float = EDGE_LINE_WIDTH
) -> None:
    """Draw the analytic transition curves as dashed lines."""
    for curve in curves:
        lower, upper = curve.edges(_curve_eps(curve, eps_max))
        for edge in (lower, upper):
            axes.plot(edge, _curve_eps(curve, eps_max), color=colour, lw=width, ls=(0, (4, 2)), zorder=4)


def _curve_eps(curve: TransitionCurve, eps_max: float) -> FloatArray:
    """Values of eps that show a straight line, and the parabola-like tip of a damped region where it turns."""
    if not 0 < curve.tip < eps_max:
        return np.linspace(0, eps_max, 41)
    return curve.tip + (eps_max - curve.tip) * np.linspace(0, 1, 81) ** 2


def label_regions(
    figure: Figure, axes: Axes, curves: Sequence[TransitionCurve], eps_max: float, first: Collection[float] = ()
) -> None:
    """Write the resonance above the upper edge, of as many regions as there is room for.

    Those that start at one of the frequencies ``first`` come first, then the widest ones.
    """
    figure.draw_without_rendering()  # only the layout knows how wide the axes are
    low, high = axes.get_xlim()
    width_points = axes.get_window_extent().width * 72 / axes.figure.dpi
    places = {curve: _where_seen(curve, low, high, eps_max) for curve in curves}
    inside = [curve for curve in curves if np.isfinite(places[curve])]
    spacing = CHARACTER_POINTS * max((len(curve.label) for curve in inside), default=0) + LABEL_GAP_POINTS
    width = {curve: float(np.nan_to_num(np.subtract(*reversed(curve.edges(eps_max))))) for curve in inside}
    inside.sort(key=lambda curve: (curve.centre not in first, -width[curve]))
    seen = sorted(inside[: int(width_points / spacing)], key=places.__getitem__)
    wanted = [(places[curve] - low) / (high - low) * width_points for curve in seen]
    for curve, place in zip(seen, _spread(wanted, spacing, width_points), strict=True):
        axes.annotate(
            curve.label,
            xy=(places[curve], eps_max),
            xytext=(low + place / width_points * (high - low), eps_max * 1.045),
            ha="center",
            va="bottom",
            fontsize=8.5,
            annotation_clip=False,
            # from below the label, so that none runs through another
            arrowprops={"arrowstyle": "-", "lw": 0.5, "color": GREY, "shrinkA": 0, "shrinkB": 0, "relpos": (0.5, 0.0)},
        )


def _where_seen(curve: TransitionCurve, low: float, high: float, eps_max: float) -> float:
    """Return where a region starts or, if that is outside, the middle of what leans into the window; NaN if nothing."""
    if low < curve.centre < high:
        return curve.centre
    lower, upper = curve.edges(eps_max)
    left, right = max(float(lower), low), min(float(upper), high)
    return (left + right) / 2 if right - left > MIN_VISIBLE_WIDTH * (high - low) else float("nan")


def _is_visible(axes: Axes, curve: TransitionCurve, eps_max: float) -> bool:
    """Whether the region is wide enough to be seen."""
    low, high = axes.get_xlim()
    lower, upper = curve.edges(eps_max)
    return bool(upper - lower > MIN_VISIBLE_WIDTH * (high - low))


def _spread(wanted: Sequence[float], spacing: float, room: float) -> list[float]:
    """Move sorted positions apart to at least ``spacing``, each cluster about its mean, all between 0 and ``room``."""
    clusters: list[list[float]] = []
    for position in wanted:
        clusters.append([position])
        while len(clusters) > 1:
            left, right = clusters[-2], clusters[-1]
            reach = spacing * (len(left) + len(right)) / 2
            if np.mean(right) - np.mean(left) >= reach:
                break
            clusters[-2:] = [left + right]
    apart = [
        float(np.mean(cluster)) + spacing * (index - (len(cluster) - 1) / 2)
        for cluster in clusters
        for index in range(len(cluster))
    ]
    last = len(apart) - 1
    return [min(max(place, i * spacing), room - (last - i) * spacing) for i, place in enumerate(apart)]


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
