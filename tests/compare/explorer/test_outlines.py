"""Outlines of traced regions: which are drawn faintly, and that the legend says so."""

from __future__ import annotations

import numpy as np
import pytest

from compare import overlay
from compare.explorer.outlines import FAINT_COLOUR, draw_outlines, is_narrow
from floquet import Kind, stability_chart, trace_regions
from floquet.regions import Loop, largest_width
from periodic.examples import mathieu
from perturb import transition_curves


def tongue(width: float) -> Loop:
    corners = np.array([2.0 - width / 2, 2.0 + width / 2, 2.0]), np.array([1.0, 1.0, 0.0])
    return Loop(*corners, np.full(3, 2, dtype=np.int8))


@pytest.mark.parametrize(("width", "narrow"), [(0.1, False), (0.02, False), (0.009, True), (1e-6, True)])
def test_what_is_narrower_than_a_line(width: float, narrow: bool) -> None:
    assert is_narrow(tongue(width), np.array([1.0, 4.0])) == narrow


def test_a_hole_and_a_branch_count_as_they_should() -> None:
    def box(left: float, right: float, low: float, high: float) -> Loop:
        corners = np.array([left, right, right, left]), np.array([low, low, high, high])
        return Loop(*corners, np.full(4, 2, dtype=np.int8))

    hole, branch = box(1.0, 2.0, 1.0, 3.0), box(1.0, 1.5, 0.0, 1.0)
    assert largest_width([box(0.0, 4.0, 1.0, 3.0), hole, branch], 32) == 2.0


def test_narrow_regions_are_faint_and_the_legend_says_so() -> None:
    chart = stability_chart(mathieu(), np.linspace(0.3, 2.5, 24), np.linspace(0, 0.4, 12), audit=0, progress=False)
    figure = overlay(chart, [])
    regions = trace_regions(mathieu(), (0.3, 2.5), (0.0, 0.4), progress=False)
    before = len(figure.axes[0].lines)
    draw_outlines(figure, chart, regions)
    colours = [line.get_color() for line in figure.axes[0].lines[before:]]
    assert colours.count("black") >= 2  # tongues of order 1 and 2
    assert FAINT_COLOUR in colours
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert labels == ["unstable by integration", "Floquet boundary (traced)", "traced, narrower than a line"]


def test_the_longest_legend_fits_the_picture() -> None:
    chart = stability_chart(mathieu(), np.linspace(0.3, 2.5, 24), np.linspace(0, 0.4, 12), audit=0, progress=False)
    chart.kind.setflags(write=True)
    chart.kind[0, 0] = Kind.UNDECIDED
    figure = overlay(chart, transition_curves(mathieu(), (0.3, 2.5)))
    draw_outlines(figure, chart, trace_regions(mathieu(), (0.3, 2.5), (0.0, 0.4), progress=False))
    figure.draw_without_rendering()
    assert len(figure.legends[0].get_texts()) == 5
    legend, whole = figure.legends[0].get_window_extent(), figure.bbox
    assert whole.x0 <= legend.x0
    assert legend.x1 <= whole.x1
