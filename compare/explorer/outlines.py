"""Traced regions as lines: the same for the printed overlay and for the page."""

from __future__ import annotations

from collections.abc import Sequence

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from compare.pictures import STYLE, THEORY, legend_handles
from floquet import Region, StabilityChart
from floquet.regions import Loop, largest_width
from periodic.checks import FloatArray

# Width of an outline, in points.
OUTLINE_POINTS = 1.0
# Largest width in Omega, as a part of the window, of an outline that would look like one thick line. It is drawn as a
# faint line, since at large eps there are a hundred of them.
NARROW_PART = 1 / 300
FAINT_COLOUR, FAINT_POINTS = "#9a9a9a", 0.5
# Amplitudes at which the width of an outline is measured.
WIDTH_LEVELS = 32


def closed(values: FloatArray) -> FloatArray:
    """Return the corners of an outline, the first one again at the end."""
    return np.append(values, values[:1])


def is_narrow(loop: Loop, Omega_range: FloatArray) -> bool:
    """Whether an outline in the window ``Omega_range`` is narrower than a line of the picture."""
    return bool(largest_width([loop], WIDTH_LEVELS) < NARROW_PART * (Omega_range[-1] - Omega_range[0]))


def draw_outlines(figure: Figure, chart: StabilityChart, regions: Sequence[Region]) -> None:
    """Draw the regions into the overlay of ``chart``, and give them an entry in its legend."""
    if not regions:
        return
    axes = figure.axes[0]
    theory = any(text.get_text() == THEORY for text in figure.legends[0].get_texts())
    handles = legend_handles(chart, traced=True, theory=theory)
    loops = [(loop, is_narrow(loop, chart.Omega)) for region in regions for loop in region.outlines]
    for loop, narrow in loops:
        colour, width, order = (FAINT_COLOUR, FAINT_POINTS, 2) if narrow else ("black", OUTLINE_POINTS, 3)
        axes.plot(closed(loop.Omega), closed(loop.eps), color=colour, lw=width, zorder=order)
    if any(narrow for _, narrow in loops):
        handles.append(Line2D([], [], color=FAINT_COLOUR, lw=2 * FAINT_POINTS, label="traced, narrower than a line"))
    figure.legends[0].remove()
    with mpl.rc_context(STYLE):
        figure.legend(handles=handles, loc="outside lower center", ncols=3 if len(handles) > 4 else 4)
