"""Traced regions as lines: the same corners for the printed overlay and for the page."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from compare.overlay import legend_handles
from floquet import Region, StabilityChart
from periodic.checks import FloatArray

LINE_WIDTH = 1.0


def closed(values: FloatArray) -> FloatArray:
    """Return the corners of a polyline with the first one repeated at the end."""
    return np.append(values, values[:1])


def draw_outlines(figure: Figure, chart: StabilityChart, regions: Sequence[Region]) -> None:
    """Draw the regions into the overlay of ``chart``, and give them an entry in its legend."""
    if not regions:
        return
    axes = figure.axes[0]
    for region in regions:
        for loop in region.outlines:
            axes.plot(closed(loop.Omega), closed(loop.eps), color="black", lw=LINE_WIDTH, zorder=3)
    figure.legends[0].remove()
    figure.legend(handles=legend_handles(chart, True), loc="outside lower center", ncols=4, frameon=False)
