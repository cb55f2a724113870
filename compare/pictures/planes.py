"""A chart over any two parameters, with its boundaries."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from compare.pictures.colours import GROWTH_MAP, REFUSED_GREY, UNDECIDED_GREY
from compare.pictures.layers import draw_growth
from compare.pictures.style import EDGE_LINE_WIDTH, STYLE, Picture, new_figure
from floquet import Kind, PlaneBoundary, PlaneChart

# Names are written beside boundaries that are at least this part of the picture long, in x or in y.
MIN_NAMED_LENGTH = 0.08
# How parameters are written that have a sign of their own.
SIGNS_OF_PARAMETERS = {"Omega": "excitation frequency Ω", "eps": "amplitude ε", "delta": "δ", "gamma": "γ", "mu": "μ"}


def draw_boundaries(axes: Axes, boundaries: Sequence[PlaneBoundary]) -> list[Any]:
    """Draw the lines of boundaries."""
    drawn = []
    for one in boundaries:
        places = [*range(len(one.x)), *([0] if one.closed else [])]
        drawn += axes.plot(one.x[places], one.y[places], color="black", lw=EDGE_LINE_WIDTH, zorder=3)
    return drawn


def name_axes_of_plane(axes: Axes, names: tuple[str, str]) -> None:
    """Write the names of the parameters."""
    across, up = (SIGNS_OF_PARAMETERS.get(name, name.replace("_", " ")) for name in names)
    axes.set_xlabel(across)
    axes.set_ylabel(up)


def plane_picture(chart: PlaneChart, boundaries: Sequence[PlaneBoundary] | None = None, *, title: str = "") -> Picture:
    """Draw a chart over two parameters, with boundaries and their names on request."""
    with mpl.rc_context(STYLE):
        figure = new_figure((7.0, 4.6))
        axes = figure.add_subplot()
        draw_growth(axes, chart, colour_bar=True)
        draw_boundaries(axes, boundaries or [])
        axes.set_xlim(chart.x[0], chart.x[-1])
        axes.set_ylim(chart.y[0], chart.y[-1])
        name_axes_of_plane(axes, chart.names)
        _write_names(axes, chart, boundaries or [])
        axes.set_title(title)
        axes.legend(
            handles=_handles(chart, traced=bool(boundaries)), loc="upper center", bbox_to_anchor=(0.5, -0.12), ncols=4
        )
    return figure


def _write_names(axes: Axes, chart: PlaneChart, boundaries: Sequence[PlaneBoundary]) -> None:
    """Write each name once, beside the middle of the longest boundary that bears it."""
    written: set[str] = set()
    for one in boundaries:
        long = max(np.ptp(one.x) / np.ptp(chart.x), np.ptp(one.y) / np.ptp(chart.y))
        if one.label and one.label not in written and long >= MIN_NAMED_LENGTH:
            written.add(one.label)
            middle = len(one.x) // 2
            text = axes.annotate(
                one.label, (one.x[middle], one.y[middle]), (3, 3), textcoords="offset points", zorder=5
            )
            text.set_bbox({"facecolor": "white", "alpha": 0.8, "edgecolor": "none", "pad": 0.8})


def _handles(chart: PlaneChart, *, traced: bool) -> list[Line2D | Patch]:
    handles: list[Line2D | Patch] = [Patch(color=GROWTH_MAP(0.6), label="unstable by integration")]
    if ((chart.kind == Kind.UNDECIDED) & ~chart.refused).any():
        handles.append(Patch(color=UNDECIDED_GREY, label="undecided"))
    if chart.refused.any():
        handles.append(Patch(color=REFUSED_GREY, label="no system"))
    if traced:
        handles.append(Line2D([], [], color="black", lw=EDGE_LINE_WIDTH, label="boundary (traced)"))
    return handles
