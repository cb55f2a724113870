"""What all pictures have in common: colours, type sizes, and figures that a notebook shows."""

from __future__ import annotations

from io import BytesIO
from typing import Any

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

# Okabe and Ito's colours, told apart by readers with any colour vision; the analytic curve always wears the warm one.
BLUE, ORANGE, GREEN, PURPLE, GREY = "#0072B2", "#D55E00", "#009E73", "#CC79A7", "#777777"
VARIANT_COLOURS = (BLUE, ORANGE, GREEN, PURPLE)
# Width of the line of an edge, in points, and how much wider the line of each earlier variant is, so that it stays
# visible beneath the next.
EDGE_LINE_WIDTH, VARIANT_WIDENING = 1.4, 1.0
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
