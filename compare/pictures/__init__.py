"""Pictures: the growth rates of a chart under traced edges and analytic curves.

`plot` draws one thing, whatever it is; `animate` moves a mode of the plate. `overlay` draws chart, edges and curves in
one picture; `region_panels` and `variant_panels` set regions or systems side by side, as the paper's figures do;
`draw_plate` draws the plate itself. They are put together from the `layers` and the `labels`, in one `style` and one
set of `colours`.

>>> import numpy as np
>>> from compare.pictures import overlay
>>> from floquet import stability_chart
>>> from periodic.examples import mathieu
>>> from perturb import transition_curves
>>> chart = stability_chart(mathieu(), np.linspace(1.5, 2.5, 20), [0.0, 0.2, 0.4], progress=False)
>>> picture = overlay(chart, transition_curves(mathieu(), (1.5, 2.5)))
>>> [text.get_text() for text in picture.axes[0].texts]
['2ω₁']

As the last value of a notebook's cell a picture shows itself; ``picture.savefig(path)`` writes it.
"""

from compare.pictures.colours import GROWTH_MAP, GROWTH_PALETTE, UNDECIDED_GREY
from compare.pictures.fields import animate
from compare.pictures.layers import draw_curves, draw_growth, draw_traces, legend_handles
from compare.pictures.overlays import overlay
from compare.pictures.panels import Layer, region_panels, variant_panels
from compare.pictures.planes import plane_picture
from compare.pictures.schematic import draw_plate
from compare.pictures.style import BLUE, GREEN, GREY, ORANGE, PURPLE, STYLE, THEORY, Picture, new_figure
from compare.pictures.units import Units, units_of
from compare.pictures.verb import plot

__all__ = [
    "BLUE",
    "GREEN",
    "GREY",
    "GROWTH_MAP",
    "GROWTH_PALETTE",
    "ORANGE",
    "PURPLE",
    "STYLE",
    "THEORY",
    "UNDECIDED_GREY",
    "Layer",
    "Picture",
    "Units",
    "animate",
    "draw_curves",
    "draw_growth",
    "draw_plate",
    "draw_traces",
    "legend_handles",
    "new_figure",
    "overlay",
    "plane_picture",
    "plot",
    "region_panels",
    "units_of",
    "variant_panels",
]
