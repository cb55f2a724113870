"""The paper's Fig. 1, drawn for the plate at hand: its shape, its motion, its supports and its load."""

from __future__ import annotations

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Rectangle

from compare.pictures.style import BLUE, GREY, ORANGE, STYLE, Picture, new_figure
from plate import MovingPlate

# Inches of the longer side of the plate and of the margins beside and above it.
LONGER_SIDE = 3.4
SIDE_MARGIN = 2.6
HEIGHT_MARGIN = 1.6
# Shortest side of the drawing, as part of the longer one: beyond it the drawing says that it is not to scale.
MIN_DRAWN_RATIO = 0.3
# The largest load arrow and the motion's arrow, as parts of the drawn length and width.
LONGEST_ARROW = 0.28
# Arrows along an edge, points of the line that joins their ends, and the distance before a jump at which it turns.
LOAD_ARROWS = 9
LOAD_POINTS = 201
JUMP = 1e-9
# Arrows of less than this part of the longest are left out.
MIN_DRAWN_LOAD = 0.02
# Hatches of a simple support, drawn along the edge.
SUPPORTS = 12


def draw_plate(plate: MovingPlate) -> Picture:
    """Draw a plate as the paper's Fig. 1 does, with the numbers of the case at hand.

    Parameters
    ----------
    plate : MovingPlate

    Returns
    -------
    Picture
        The plate from above. Triangles mark the simply supported edges x = 0 and x = a, dashed lines the free ones
        y = 0 and y = b; arrows show the speed and the static tension over the edges.
    """
    r = plate.aspect_ratio
    length, width = (max(r, MIN_DRAWN_RATIO), 1.0) if r <= 1 else (1.0, max(1 / r, MIN_DRAWN_RATIO))
    inches = LONGER_SIDE * np.array([length, width]) + np.array([SIDE_MARGIN, HEIGHT_MARGIN])
    with mpl.rc_context(STYLE):
        figure = new_figure((float(inches[0]), float(inches[1])))
        axes = figure.add_subplot()
        axes.add_patch(Rectangle((0, 0), length, width, facecolor=BLUE, alpha=0.12, lw=0))
        _draw_edges(axes, length, width)
        _draw_motion(axes, plate, length, width)
        reach = _draw_load(axes, plate, length, width)
        _draw_axes(axes, length, width)
        to_scale = np.isclose(length / width, r)
        axes.set_title(f"a/b = {r:g}" + ("" if to_scale else " (not to scale)"), loc="left")
        axes.set_xlim(-reach - 0.12, length + reach + 0.12)
        axes.set_ylim(-0.2, width + 0.04)
        axes.set_aspect("equal")
        axes.set_axis_off()
        figure.supxlabel(_captions(plate), fontsize=8, color=GREY)
    return figure


def _draw_edges(axes: Axes, length: float, width: float) -> None:
    for y in (0.0, width):
        axes.plot([0, length], [y, y], color="black", lw=1.0, ls=(0, (5, 3)))
    for x in (0.0, length):
        axes.plot([x, x], [0, width], color="black", lw=1.6)
        rows = np.linspace(0, width, SUPPORTS)
        axes.plot(np.full(SUPPORTS, x), rows, ls="none", marker="^", ms=3.5, color="black", clip_on=False)


def _draw_motion(axes: Axes, plate: MovingPlate, length: float, width: float) -> None:
    """Draw the transport speed as an arrow in its direction, or say that the plate rests."""
    y = width / 2
    if plate.speed == 0:
        axes.text(length / 2, y, "at rest, V = 0", ha="center", va="center")
        return
    half = LONGEST_ARROW * length / 2 * np.sign(plate.speed)
    arrow = {"arrowstyle": "-|>", "lw": 2.0, "color": "black"}
    axes.annotate("", xy=(length / 2 + half, y), xytext=(length / 2 - half, y), arrowprops=arrow)
    axes.text(length / 2, y + 0.03, f"V = {plate.speed:.3g}", ha="center", va="bottom")


def _draw_load(axes: Axes, plate: MovingPlate, length: float, width: float) -> float:
    """Draw the static tension on both edges, outwards where it pulls, and return how far its arrows reach."""
    static = plate.load.static
    places = np.union1d(np.linspace(0, 1, LOAD_POINTS), np.clip(np.subtract(static.breaks, JUMP), 0, 1))
    outline = plate.tension * static(places)
    largest = float(np.abs(outline).max())
    if largest == 0:
        return 0.0
    scale = LONGEST_ARROW / largest
    rows = np.linspace(0, 1, LOAD_ARROWS)
    for edge, side in ((0.0, -1), (length, 1)):
        axes.plot(edge + side * scale * np.abs(outline), places * width, color=ORANGE, lw=1.2)
        for row, value in zip(rows, plate.tension * static(rows), strict=True):
            if abs(value) > MIN_DRAWN_LOAD * largest:
                ends = ((edge, row * width), (edge + side * scale * abs(value), row * width))
                start, tip = ends if value > 0 else ends[::-1]
                arrow = {"arrowstyle": "-|>", "color": ORANGE, "lw": 0.9, "shrinkA": 0, "shrinkB": 0}
                axes.annotate("", xy=tip, xytext=start, arrowprops=arrow)
    return LONGEST_ARROW


def _captions(plate: MovingPlate) -> str:
    """Return what the lines and arrows mean."""
    supports = "triangles: simply supported edges; dashed: free edges"
    if plate.tension == 0:
        return f"{supports}\nno tension, and so no excitation"
    harmonics = "cos Ωt" if plate.load.harmonics == 1 else f"{plate.load.harmonics} harmonics of Ω"
    return f"{supports}\narrows: static tension, f₀ = {plate.tension:.3g} on average; ε times {harmonics} is added"


def _draw_axes(axes: Axes, length: float, width: float) -> None:
    arrow = {"arrowstyle": "->", "lw": 0.8, "color": GREY, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", xy=(0.16, -0.1), xytext=(0, -0.1), arrowprops=arrow)
    axes.annotate("", xy=(0, 0.06), xytext=(0, -0.1), arrowprops=arrow)
    axes.text(0.17, -0.1, "x", va="center", color=GREY)
    axes.text(-0.03, 0.0, "y", ha="right", va="center", color=GREY)
    axes.text(length, -0.1, "a", ha="center", va="center", color=GREY)
    axes.text(length + 0.03, width, "b", ha="left", va="bottom", color=GREY)
