"""Several regions or several systems side by side, as the paper's Figs. 2 to 6 show them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import zip_longest
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from compare.pictures.labels import label_regions
from compare.pictures.layers import draw_curves, draw_traces, legend_handles
from compare.pictures.style import (
    EDGE_LINE_WIDTH,
    GREY,
    ORANGE,
    STYLE,
    THEORY,
    VARIANT_COLOURS,
    VARIANT_WIDENING,
    Picture,
    new_figure,
)
from floquet import BoundaryTrace, StabilityChart
from perturb import TransitionCurve

# Width that the legend of a picture with a single panel needs, in inches.
MIN_LEGEND_INCHES = 4.8


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


def region_panels(layers: Sequence[Layer], *, title: str = "") -> Picture:
    """Draw one panel a region, as the paper's Figs. 2-4 and 6 do, with every system inside it.

    Parameters
    ----------
    layers : sequence of Layer
        One to four systems with the same regions.
    title : str
        Heading.

    Returns
    -------
    Picture
        A matplotlib figure.
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
        for axes in figure.axes[len(regions) :]:
            axes.set_axis_off()
        figure.suptitle(title, fontsize=11)
        if len(layers) == 1:
            figure.legend(handles=legend_handles(None, traced=True), loc="outside lower center", ncols=4)
        else:
            figure.legend(handles=_variant_handles(layers), loc="outside lower center", ncols=len(layers))
    return figure


def _region(curve: TransitionCurve) -> tuple[frozenset[int], int, str]:
    """Return what tells one region of a system from another."""
    return frozenset((curve.p, curve.q)), curve.j, curve.type


def variant_panels(layers: Sequence[Layer], *, title: str = "") -> Picture:
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
