"""One picture of everything: growth rates, traced edges and analytic curves, one over the other."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import matplotlib as mpl
import numpy as np

from compare.pictures.answers import draw_regions
from compare.pictures.labels import is_visible, label_regions
from compare.pictures.layers import draw_curves, draw_growth, draw_traces, legend_handles
from compare.pictures.style import STYLE, Picture, new_figure
from compare.pictures.units import show_frequency, units_of
from floquet import BoundaryTrace, Region, StabilityChart
from perturb import TransitionCurve


def overlay(
    chart: StabilityChart | None,
    curves: Sequence[TransitionCurve],
    traces: Sequence[BoundaryTrace | Region] = (),
    *,
    title: str = "",
    size: tuple[float, float] = (9.0, 4.8),
    units: Any = None,
) -> Picture:
    """Draw a stability chart, the traced boundaries and the analytic transition curves in one picture.

    Parameters
    ----------
    chart : StabilityChart or None
        Growth-rate map to lay underneath; None leaves it out.
    curves : sequence of TransitionCurve
        Analytic curves, each labelled with its resonance on the upper edge.
    traces : sequence of BoundaryTrace or Region
        Edges found by root-finding on the multipliers, and outlines found by `trace_regions`.
    title : str
        Heading.
    size : (float, float)
        Width and height in inches.
    units : "Hz", "rpm", "rad/s" or a plate in SI units, optional
        Of the excitation frequency on the axis and of growth rates, as `compare.plot` takes them.

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
    regions = [one for one in traces if isinstance(one, Region)]
    edges = [one for one in traces if isinstance(one, BoundaryTrace)]
    with mpl.rc_context(STYLE):
        figure = new_figure(size)
        axes = figure.add_subplot()
        heights = [trace.eps for trace in edges] + [loop.eps for region in regions for loop in region.outlines]
        eps = chart.eps if chart is not None else np.unique(np.concatenate(heights))
        if chart is not None:
            axes.set_xlim(chart.Omega[0], chart.Omega[-1])
        axes.set_ylim(0, eps[-1])
        scale = units_of(units)
        draw_growth(axes, chart, colour_bar=True, rate=scale.rate, rate_unit=scale.rate_unit)
        draw_traces(axes, edges)
        traced = {trace.near for trace in edges if trace.is_open.any()}
        shown = [curve for curve in curves if curve.centre in traced or is_visible(axes, curve, eps[-1])]
        draw_curves(axes, shown, eps[-1])
        draw_regions(axes, regions, names=not shown)
        label_regions(figure, axes, shown, eps[-1], first=traced)
        show_frequency(axes, units)
        axes.set_ylabel("amplitude ε")
        axes.set_title(title, loc="left", pad=30)
        handles = legend_handles(chart, traced=bool(traces), theory=bool(shown))
        figure.legend(handles=handles, loc="outside lower center", ncols=4)
    return figure
