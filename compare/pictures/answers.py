"""Pictures of single answers: traced regions, responses, transient growth, proved charts."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Patch

from compare.pictures.colours import GROWTH_PALETTE, UNDECIDED_GREY
from compare.pictures.style import BLUE, EDGE_LINE_WIDTH, ORANGE
from compare.pictures.units import Units
from floquet import Region
from floquet.modes import Response, TransientGrowth

# Coordinates of a response that are drawn: those that move most.
SHOWN_COORDINATES = 3
# Least room between the names of regions, as part of the width of the window.
LABEL_ROOM = 0.06
# Pixels of a proved chart, along Omega and eps: each has the verdict of its centre.
PIXELS = (700, 420)
# Amplitudes at which edges are drawn, as dots.
EDGE_AMPLITUDES = 240
STABLE_COLOUR, UNSTABLE_COLOUR = "#eef3f7", GROWTH_PALETTE[40]


def draw_regions(
    axes: Axes, regions: Sequence[Region], colour: str = "black", *, frequency: float = 1.0, names: bool = True
) -> list[object]:
    """Draw the outlines of traced regions, with their names at their tops as far as there is room."""
    drawn: list[object] = []
    for region in regions:
        for loop in region.outlines:
            x, y = np.append(loop.Omega, loop.Omega[0]) * frequency, np.append(loop.eps, loop.eps[0])
            drawn += axes.plot(x, y, color=colour, lw=EDGE_LINE_WIDTH, zorder=3)
    if names and regions:
        low, high = axes.get_xlim()
        free = low
        for region in sorted(regions, key=_top):
            place = _top(region) * frequency
            if region.label and place >= free and low <= place <= high:
                label = region.resonances[0].label + ("…" if len(region.resonances) > 1 else "")
                drawn.append(
                    axes.annotate(
                        label, (place, 1.0), (0, 3), xycoords=("data", "axes fraction"), textcoords="offset points",
                        ha="center", va="bottom", fontsize=8.5,
                    )
                )  # fmt: skip
                free = place + LABEL_ROOM * (high - low)
    return drawn


def _top(region: Region) -> float:
    """Return the middle of the highest edge of a region."""
    loop = region.outlines[0]
    highest = loop.Omega[loop.eps >= loop.eps.max() * (1 - 1e-9)]
    return float(highest.min() + highest.max()) / 2


def draw_response(axes: Axes, response: Response, units: Units) -> list[object]:
    """Draw the coordinates that move most over time."""
    first_order = response.states.shape[1] == response.system.size
    moves = response.states if first_order else response.displacement
    chosen = np.argsort(-np.abs(moves).max(axis=0), kind="stable")[:SHOWN_COORDINATES]
    drawn: list[object] = []
    for i, (colour, dash) in zip(chosen, ((BLUE, "-"), ("black", (0, (5, 2))), (ORANGE, (0, (1, 1.2)))), strict=False):
        name = f"state {i + 1}" if first_order else f"coordinate {i + 1}"
        drawn += axes.plot(response.times * units.time, moves[:, i], color=colour, ls=dash, lw=1.2, label=name)
    axes.set_xlim(0, response.times[-1] * units.time)
    axes.set_xlabel(units.label("time", "time"))
    axes.set_ylabel("state" if first_order else "displacement")
    axes.legend(loc="upper left", ncols=SHOWN_COORDINATES)
    low, high = axes.get_ylim()
    axes.set_ylim(low, high + 0.15 * (high - low))
    return drawn


def draw_transient(axes: Axes, growth: TransientGrowth, units: Units) -> list[object]:
    """Draw the largest amplification of energy over time, and where it is largest."""
    drawn: list[object] = [*axes.semilogy(growth.times * units.time, growth.amplification, color=BLUE, lw=1.3)]
    drawn += axes.plot(growth.time * units.time, growth.largest, "o", color=ORANGE, ms=5)
    axes.set_xlim(0, growth.times[-1] * units.time)
    axes.set_xlabel(units.label("time", "time"))
    axes.set_ylabel("energy / energy at t = 0")
    axes.set_title(f"at most {growth.largest:.4g}, at {growth.time * units.time:.4g}", loc="left")
    return drawn


def draw_proved(axes: Axes, chart: Any, *, frequency: float = 1.0) -> list[Any]:
    """Draw a `ProvedChart`; frequencies are multiplied by ``frequency``.

    Returns
    -------
    list of artists
    """
    (low, high), (bottom, top) = chart.Omega_range, chart.eps_range
    across, up = PIXELS
    Omega = low + (high - low) * (np.arange(across) + 0.5) / across
    eps = bottom + (top - bottom) * (np.arange(up) + 0.5) / up
    verdict = chart.verdict(Omega, eps[:, None])
    code = np.where(verdict == "stable", 0.0, np.where(verdict == "unstable", 1.0, 2.0))
    colours = [STABLE_COLOUR, UNSTABLE_COLOUR, "white"]
    drawn: list[Any] = [
        axes.contourf(
            Omega * frequency,
            eps,
            code,
            levels=[-0.5, 0.5, 1.5, 2.5],
            colors=colours,
            hatches=[None, None, "////"],
        )
    ]
    for rows in drawn:
        rows.set_edgecolor(UNDECIDED_GREY)
        rows.set_linewidth(0)
    # tongues thinner than a pixel are seen by their edges
    edges = [s for s in chart.edges(np.linspace(bottom, top, EDGE_AMPLITUDES)) if s.below != s.above]
    places = [(s.lower + s.upper) / 2 * frequency for s in edges]
    drawn += axes.plot(places, [s.eps for s in edges], ".", color=GROWTH_PALETTE[-1], markersize=0.7)
    axes.set_xlim(low * frequency, high * frequency)
    axes.set_ylim(bottom, top)
    handles = [
        Patch(facecolor=STABLE_COLOUR, edgecolor=UNDECIDED_GREY, label="proved stable"),
        Patch(facecolor=UNSTABLE_COLOUR, label="proved unstable"),
        Patch(facecolor="white", edgecolor=UNDECIDED_GREY, hatch="////", label="open"),
    ]
    shown = np.floor(1e6 * chart.proved_fraction) / 1e4
    title = f"at least {shown:.4f} % of the area proved"
    drawn.append(axes.legend(handles=handles, title=title, loc="upper center", bbox_to_anchor=(0.5, -0.14), ncols=3))
    return drawn
