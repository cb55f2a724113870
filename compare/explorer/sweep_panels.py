"""The picture of a sweep: centres, widths and tips of the regions over a parameter."""

from __future__ import annotations

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from compare.explorer.sweeps import MAX_TRACED_TIP, Sweep
from compare.pictures import BLUE, GREEN, GREY, ORANGE, PURPLE, STYLE, new_figure

# Okabe and Ito's colours that stand out from white.
REGION_COLOURS = (BLUE, ORANGE, GREEN, PURPLE, "#E69F00", "#56B4E9", "#000000")
AXIS_NAMES = {
    "speed": "speed V",
    "tension": "tension f₀",
    "damping": "damping c",
    "aspect_ratio": "aspect ratio a/b",
    "poisson_ratio": "Poisson's ratio ν",
    "thickness_ratio": "thickness ratio h/b",
    "width": "width of the load / b",
}


def sweep_picture(result: Sweep, *, title: str = "") -> Figure:
    """Draw centres and widths, and tips if there is damping: lines by theory, circles by integration.

    Parameters
    ----------
    result : Sweep
        From `compare.explorer.sweep`.
    title : str
        Heading.

    Returns
    -------
    matplotlib.figure.Figure
    """
    damped = any(((region.tip > 0) & np.isfinite(region.tip)).any() for region in result.regions)
    panels = [("centre", "centre Ω at ε → 0"), ("width", f"width in Ω at ε = {result.eps:g}")]
    if damped:
        panels.append(("tip", "tip ε"))
    with mpl.rc_context(STYLE):
        figure = new_figure((9.0, 2.5 * len(panels) + 0.9))
        axes = figure.subplots(len(panels), 1, sharex=True, squeeze=False)[:, 0]
        for panel, (quantity, label) in zip(axes, panels, strict=True):
            _draw(panel, result, quantity)
            panel.set_ylabel(label)
            panel.set_ylim(0, min(panel.get_ylim()[1], _most(result, quantity)))
        axes[0].set_title(title, loc="left")
        axes[-1].set_xlabel(AXIS_NAMES[result.name])
        beyond = [value for value, _ in result.left_out if value > result.values[-1]]
        if beyond:
            axes[0].set_xlim(right=max(beyond))
            for panel in axes:
                panel.axvspan(result.values[-1], max(beyond), color="#eeeeee", lw=0, zorder=0)
            axes[0].text(
                max(beyond), axes[0].get_ylim()[1], "no plate", ha="right", va="bottom", color=GREY, fontsize=8
            )
        handles = [
            Line2D([], [], color=colour, lw=1.6, label=region.label)
            for region, colour in zip(result.regions, _colours(result), strict=True)
        ]
        handles.append(Line2D([], [], color=GREY, lw=0, marker="o", ms=4.5, mfc="white", label="traced (Floquet)"))
        figure.legend(handles=handles, loc="outside lower center", ncols=min(7, len(handles)))
    return figure


def _draw(axes: Axes, result: Sweep, quantity: str) -> None:
    for region, colour in zip(result.regions, _colours(result), strict=True):
        line = np.where(np.isfinite(getattr(region, quantity)), getattr(region, quantity), np.nan)
        axes.plot(result.values, line, color=colour, lw=1.6)
        points = getattr(region, f"traced_{quantity}")
        axes.plot(result.traced_values, points, "o", color=colour, mfc="white", ms=4.5, zorder=4)


def _most(result: Sweep, quantity: str) -> float:
    """Return how far up an axis has to reach; near divergence the widths of theory grow beyond bounds."""
    if quantity == "tip":
        return MAX_TRACED_TIP
    traced = [getattr(region, f"traced_{quantity}") for region in result.regions]
    return 2 * float(np.nanmax(traced)) if np.isfinite(traced).any() else float("inf")


def _colours(result: Sweep) -> list[str]:
    return [REGION_COLOURS[k % len(REGION_COLOURS)] for k in range(len(result.regions))]
