"""The explorer's page in Bokeh: chart, multipliers and growing solution, the same in a file and on the live server.

All that the page shows is in its data sources, and data flow one way. `Page.show` fills the sources of the chart from
an `Exploration`. `Page.pick` (live) or a click (in a file) chooses a `Response`. The browser draws what is in the
sources.
"""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from pathlib import Path
from typing import Any

import numpy as np
from bokeh.core.properties import value
from bokeh.document import Document
from bokeh.embed import file_html
from bokeh.events import DocumentReady, Tap
from bokeh.layouts import column, row
from bokeh.models import (
    ColorBar,
    ColumnDataSource,
    CustomJS,
    CustomJSHover,
    CustomJSTickFormatter,
    Div,
    FixedTicker,
    HoverTool,
    Legend,
    LegendItem,
    LinearColorMapper,
    RadioButtonGroup,
    Range1d,
)
from bokeh.models.layouts import LayoutDOM
from bokeh.plotting import figure
from bokeh.resources import INLINE

from compare.explorer.exploration import Exploration
from compare.explorer.page_data import cell_data, curve_data, label_data, outline_data, point_data
from compare.explorer.responses import Response
from compare.pictures import BLUE, GREEN, GREY, GROWTH_PALETTE, ORANGE, PURPLE, UNDECIDED_GREY
from floquet import Kind

SCRIPT = (Path(__file__).parent / "page.js").read_text(encoding="utf-8")
TEXT_STYLE = {"font-family": "system-ui, sans-serif", "font-size": "14px", "color": "#222"}

KIND_COLOURS = {Kind.PLUS_ONE: GREEN, Kind.MINUS_ONE: BLUE, Kind.COMPLEX: PURPLE}
KIND_NAMES = [
    (int(Kind.UNDECIDED), "undecided"),
    (int(Kind.STABLE), "stable"),
    (int(Kind.PLUS_ONE), "unstable, multiplier near +1"),
    (int(Kind.MINUS_ONE), "unstable, multiplier near −1"),
    (int(Kind.COMPLEX), "unstable, complex pair"),
]
# Periods over which the solution is drawn.
SOLUTION_PERIODS = 10
# Circles around the unit circle, at |mu| = 10, 100, ...
MAX_CIRCLE_DECADES = 16


class Page:
    """One page: `show` and `pick` fill it, `html` makes a file of it, `live` puts it into a server's document.

    Parameters
    ----------
    title : str
        Heading.
    hint : str
        What a click does, in a sentence.
    """

    def __init__(self, title: str, hint: str) -> None:
        self.cells = ColumnDataSource(cell_data(None), name="cells")
        self.curves = ColumnDataSource({"xs": [], "ys": [], "label": []}, name="curves")
        self.outlines = ColumnDataSource({"xs": [], "ys": [], "label": [], "color": [], "width": []}, name="outlines")
        self.labels = ColumnDataSource({"x": [], "y": [], "text": []}, name="labels")
        self.points = ColumnDataSource(point_data([]), name="points")
        heading = f"<b style='font-size:17px'>{escape(title)}</b>"
        self.heading = Div(text=heading, styles=TEXT_STYLE, margin=(8, 10, 0, 10))
        self.message = Div(text="", styles=TEXT_STYLE, margin=(0, 10, 0, 10), name="message")
        self.facts = Div(text=hint, height=66, styles=TEXT_STYLE, margin=(0, 10, 0, 10), name="facts")
        self.figure = self._chart()
        self._draw = self._details()

    def tell(self, text: str, *, fault: bool = False) -> None:
        """Show a sentence under the heading, in the warning colour for a ``fault``."""
        self.message.text = f"<span style='color:{ORANGE if fault else GREY}'>{escape(text)}</span>"

    def frame(self, Omega: tuple[float, float], eps: tuple[float, float]) -> None:
        """Set the window that the page opens with, and to which the reset tool returns."""
        self.figure.x_range.update(start=Omega[0], end=Omega[1], reset_start=Omega[0], reset_end=Omega[1])
        self.figure.y_range.update(start=eps[0], end=eps[1], reset_start=eps[0], reset_end=eps[1])

    def show(self, exploration: Exploration) -> None:
        """Show a chart with its curves."""
        chart = exploration.chart
        self.cells.data = cell_data(chart)
        unstable = chart.growth_rate[chart.kind > Kind.STABLE]
        self._growth_colours.high = float(unstable.max()) if unstable.size else 1.0
        self.curves.data = curve_data(exploration.curves, chart)
        self.outlines.data = outline_data(exploration.regions, exploration.chart)
        self._outline_item.visible = bool(exploration.regions)
        self.labels.data = label_data(exploration.curves, chart)
        self._curve_item.label = value(f"multiple scales, order {exploration.order}")

    def pick(self, response: Response) -> None:
        """Show one point (live page)."""
        self.points.data = point_data([response])

    def live(self, document: Document, controls: Sequence[LayoutDOM]) -> None:
        """Put the page into a server's document; it draws a point whenever `pick` gives one."""
        draw = CustomJS(args=self._draw, code=f"{SCRIPT}\ndraw(0)")
        self.figure.tags = [self.points]  # no other model makes it part of the document
        self.points.js_on_change("data", draw)
        document.js_on_event(DocumentReady, draw)  # for a point that came before the browser was ready
        document.add_root(self.layout(controls))

    def html(self, responses: Sequence[Response]) -> str:
        """Return the page as one file that needs no server: a click shows the nearest of ``responses``."""
        self.points.data = point_data(responses)
        if not responses:
            self.facts.text = "There is nothing to click: no point could be integrated in reasonable time."
        nearest = CustomJS(args=self._draw, code=f"{SCRIPT}\ndraw(nearest(cb_obj.x, cb_obj.y))")
        self.figure.js_on_event(Tap, nearest)
        document = Document(title="Stability chart")
        document.add_root(self.layout())
        document.js_on_event(DocumentReady, CustomJS(args=self._draw, code=f"{SCRIPT}\ndraw(fastest())"))
        return file_html(document, INLINE, suppress_callback_warning=True)

    def layout(self, controls: Sequence[LayoutDOM] = ()) -> LayoutDOM:
        """Return the page's root, with ``controls`` under the heading."""
        details = column(self.facts, self._circle, self._wave, width=430)
        body = row(column(self._choice, self.figure, sizing_mode="stretch_width"), details, sizing_mode="stretch_width")
        return column(self.heading, self.message, *controls, body, sizing_mode="stretch_width")

    def _chart(self) -> figure:
        plot = figure(
            name="chart",
            height=540,
            min_width=520,
            sizing_mode="stretch_width",
            tools="pan,box_zoom,wheel_zoom,reset,save",
            active_drag="box_zoom",
            x_range=Range1d(0, 1),
            y_range=Range1d(0, 1),
            x_axis_label="excitation frequency Ω",
            y_axis_label="amplitude ε",
        )
        plot.toolbar.logo = None
        plot.grid.visible = False
        plot.axis.axis_label_text_font_style = "normal"
        self._growth_colours = LinearColorMapper(
            palette=GROWTH_PALETTE, low=0, high=1, low_color=UNDECIDED_GREY, nan_color=(0, 0, 0, 0)
        )
        kind_colours = LinearColorMapper(
            palette=[*KIND_COLOURS.values()], low=0.5, high=3.5, low_color=UNDECIDED_GREY, nan_color=(0, 0, 0, 0)
        )
        frame = {"x": "x", "y": "y", "dw": "dw", "dh": "dh", "source": self.cells}
        growth = plot.image(image="growth", color_mapper=self._growth_colours, **frame)
        kinds = plot.image(image="kind", color_mapper=kind_colours, visible=False, **frame)
        growth_bar = ColorBar(color_mapper=self._growth_colours, width=12, padding=4)
        kind_bar = ColorBar(
            color_mapper=kind_colours,
            ticker=FixedTicker(ticks=[1, 2, 3]),
            major_label_overrides={1: "near +1", 2: "near −1", 3: "complex"},
            width=12,
            padding=4,
            visible=False,
        )
        plot.add_layout(growth_bar, "right")
        plot.add_layout(kind_bar, "right")
        outlines = plot.multi_line("xs", "ys", source=self.outlines, color="color", width="width")
        curves = plot.multi_line("xs", "ys", source=self.curves, color=ORANGE, width=1.8, dash=[6, 4])
        labels = plot.text(
            "x", "y", "text", source=self.labels, color="#222", font_size="13px", align="center", baseline="top",
            background_fill_color="white", background_fill_alpha=0.75, padding=2,
        )  # fmt: skip
        self._marker = plot.scatter(
            [], [], marker="circle_x", size=13, fill_alpha=0, line_color="black", line_width=1.5
        )
        undecided = plot.scatter([np.nan], [np.nan], marker="square", size=9, color=UNDECIDED_GREY)
        self._outline_item = LegendItem(label="Floquet boundary (traced)", renderers=[outlines])
        self._curve_item = LegendItem(label="multiple scales", renderers=[curves])
        plot.add_layout(
            Legend(
                items=[
                    self._outline_item,
                    self._curve_item,
                    LegendItem(label="region labels", renderers=[labels]),
                    LegendItem(label="undecided", renderers=[undecided]),
                ],
                click_policy="hide",
                orientation="horizontal",
                border_line_color=None,
            ),
            "above",
        )
        place = CustomJSHover(args={"cells": self.cells}, code=f"{SCRIPT}\nreturn coordinate(special_vars, format)")
        kind_name = CustomJSHover(
            args={"names": KIND_NAMES}, code="return new Map(names).get(Math.round(value)) ?? 'stable'"
        )
        plot.add_tools(
            HoverTool(
                renderers=[growth, kinds],
                tooltips=[
                    ("Ω", "$x{Omega}"),
                    ("ε", "$y{eps}"),
                    ("growth rate", "@rate{%.5g}"),
                    ("verdict", "@verdict{custom}"),
                    ("error of log|μ|", "@error{%.1e}"),
                ],
                formatters={"$x": place, "$y": place, "@verdict": kind_name, "@rate": "printf", "@error": "printf"},
            )
        )
        for lines, name in ((curves, "theory"), (outlines, "traced")):
            plot.add_tools(HoverTool(renderers=[lines], tooltips=[(name, "@label")], attachment="left"))
        self._choice = RadioButtonGroup(labels=["growth rate", "kind of instability"], active=0, margin=(6, 10, 0, 10))
        self._choice.js_on_change(
            "active",
            CustomJS(
                args={"views": [[growth, growth_bar], [kinds, kind_bar]]},
                code="views.forEach((view, i) => view.forEach((model) => { model.visible = i === cb_obj.active }))",
            ),
        )
        return plot

    def _details(self) -> dict[str, Any]:
        """Build the two small plots and return what the browser needs to draw a point into them."""
        self._circle = figure(
            width=420, height=290, title="multipliers (outside, log radius)", tools="",
            x_range=Range1d(-1.7, 1.7), y_range=Range1d(-1.3, 1.3), toolbar_location=None,
        )  # fmt: skip
        self._circle.axis.visible = False
        self._circle.grid.visible = False
        angle = np.linspace(0, 2 * np.pi, 181)
        x, y = np.cos(angle), np.sin(angle)
        decades = range(2, MAX_CIRCLE_DECADES + 2)
        self._circle.multi_line([k * x for k in decades], [k * y for k in decades], line_color="#ccc")
        self._circle.line(x, y, line_color="#444", line_width=1.2)
        multipliers = ColumnDataSource({"x": [], "y": [], "colour": [], "value": [], "modulus": []}, name="multipliers")
        dots = self._circle.scatter(
            "x", "y", source=multipliers, size=8, color="colour", fill_alpha=0.6, line_width=1.2
        )
        self._circle.add_tools(HoverTool(renderers=[dots], tooltips=[("μ", "@value"), ("|μ|", "@modulus{0.00000}")]))
        self._wave = figure(
            width=420, height=240, title="solution over ten periods", tools="", toolbar_location=None,
            x_range=Range1d(0, SOLUTION_PERIODS), y_range=Range1d(-1, 1),
            x_axis_label="t / T", y_axis_label="amplitude, asinh scale",
        )  # fmt: skip
        self._wave.grid.grid_line_color = "#eee"
        self._wave.axis.axis_label_text_font_style = "normal"
        solution = ColumnDataSource({"t": [], "w": []}, name="solution")
        self._wave.line("t", "w", source=solution, color=BLUE, width=1.3)
        ticker = FixedTicker(ticks=[0])
        self._wave.yaxis.ticker = ticker
        self._wave.ygrid.ticker = ticker
        self._wave.yaxis.formatter = CustomJSTickFormatter(code=f"{SCRIPT}\nreturn amplitudeLabel(tick)")
        return {
            "points": self.points,
            "multipliers": multipliers,
            "solution": solution,
            "marker": self._marker.data_source,
            "ticker": ticker,
            "circle": self._circle,
            "wave": self._wave,
            "chart": self.figure,
            "facts": self.facts,
            "names": KIND_NAMES,
            "colours": [BLUE, ORANGE],
            "periods": SOLUTION_PERIODS,
        }
