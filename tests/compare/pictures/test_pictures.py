"""Pictures: labels that can be read, and lines that show what was traced."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from matplotlib.text import Text

from compare.pictures import Layer, draw_traces, new_figure, overlay, region_panels, variant_panels
from compare.pictures.labels import _spread
from floquet import StabilityChart, stability_chart, trace_boundary
from periodic import PeriodicSystem
from periodic.examples import coupled_mathieu, mathieu
from perturb import transition_curves

EPS = np.array([0.1, 0.2, 0.3])


def _layer(system: PeriodicSystem, label: str = "") -> Layer:
    chart = stability_chart(system, np.linspace(1.5, 4.0, 12), np.linspace(0, 0.3, 4), n_jobs=1, progress=False)
    curves = transition_curves(system, (1.5, 4.0), 1, ("sum",))
    return Layer(label, chart, [(curve, trace_boundary(system, curve.centre, EPS)) for curve in curves])


@pytest.fixture(scope="module")
def layer() -> Layer:
    return _layer(coupled_mathieu())


@pytest.fixture(scope="module")
def damped() -> Layer:
    return _layer(coupled_mathieu(damping=(0.002, 0.01)), "damped")


@settings(deadline=None, max_examples=50)
@given(st.lists(st.floats(0, 400), min_size=1, max_size=8), st.floats(10, 50))
def test_labels_stand_apart_in_order_and_inside(wanted: list[float], spacing: float) -> None:
    places = _spread(sorted(wanted), spacing, 400.0)
    rounding = 1e-9 * 400
    assert (np.diff(places) >= spacing - rounding).all()
    assert places[0] >= -rounding
    assert places[-1] <= 400 + rounding


def test_labels_that_have_room_stay_where_they_are() -> None:
    assert _spread([100, 200, 300], 50, 400) == [100, 200, 300]
    assert _spread([199, 201], 50, 400) == [175, 225]


def test_labels_do_not_overlap_in_a_crowded_picture() -> None:
    n = 4  # modes: 16 resonances
    system = PeriodicSystem(
        np.eye(n), np.zeros((n, n)), np.zeros((n, n)), np.diag(np.linspace(1, 2, n)), [np.ones((n, n))]
    )
    chart = StabilityChart(
        np.linspace(1.5, 4, 3), EPS, *(np.zeros((3, 3), kind) for kind in (float, complex, np.int8, float))
    )
    figure = overlay(chart, transition_curves(system, (1.5, 4.0)))
    figure.canvas.draw()
    # Text.get_window_extent leaves out the line that leads from an annotation to its region
    boxes = sorted((Text.get_window_extent(label) for label in figure.axes[0].texts), key=lambda box: box.x0)
    assert len(boxes) > 3
    assert all(left.x1 <= right.x0 for left, right in pairwise(boxes))


def test_the_widest_regions_are_named_first(layer: Layer) -> None:
    figure = overlay(layer.chart, [curve for curve, _ in layer.panels], [trace for _, trace in layer.panels])
    assert "ω₁+ω₂" in {text.get_text() for text in figure.axes[0].texts}


def test_traced_regions_are_named_before_wider_ones() -> None:
    # Twenty-four main regions, the narrowest of which was looked at closely.
    n = 24
    zero = np.zeros((n, n))
    system = PeriodicSystem(
        np.eye(n), zero, zero, np.diag(np.linspace(1, 2, n) ** 2), [np.diag(np.linspace(1, 0.1, n))]
    )
    chart = stability_chart(system, np.linspace(1.5, 4.5, 4), [0.0, 0.3], audit=0, progress=False)
    curves = [curve for curve in transition_curves(system, (1.5, 4.5), 1, ("sum",)) if curve.p == curve.q]
    traced = trace_boundary(system, curves[-1].centre, np.array([0.1, 0.3]))
    labels = [{text.get_text() for text in overlay(chart, curves, traces).axes[0].texts} for traces in ([], [traced])]
    assert curves[-1].label not in labels[0]
    assert curves[-1].label in labels[1]
    assert len(labels[0]) == len(labels[1]) < n


def test_a_region_that_leans_into_the_window_is_named(layer: Layer) -> None:
    Omega = layer.chart.Omega
    curves = [curve for curve, _ in layer.panels if curve.p != curve.q]
    beside = curves[0].centre + 0.02  # most of the right half of ω₁+ω₂ is in the window, its centre is not
    part = stability_chart(coupled_mathieu(), np.linspace(beside, Omega[-1], 8), [0.0, 0.3], n_jobs=1, progress=False)
    (label,) = overlay(part, curves).axes[0].texts
    assert label.get_text() == "ω₁+ω₂"
    assert beside < label.xy[0] < curves[0].edges(0.3)[1]  # type: ignore[attr-defined]
    far = stability_chart(coupled_mathieu(), np.linspace(beside + 0.5, 4.0, 8), [0.0, 0.3], n_jobs=1, progress=False)
    assert not overlay(far, curves).axes[0].texts


def test_a_line_skips_what_could_not_be_followed_and_breaks_where_closed(layer: Layer) -> None:
    trace = next(trace for curve, trace in layer.panels if curve.p != curve.q)
    gap = replace(trace, upper=np.array([trace.upper[0], np.nan, trace.upper[2]]))
    closed = replace(gap, lower=gap.upper, kind=np.array([3, 0, 3], dtype=np.int8))
    axes = new_figure((3, 3)).add_subplot()
    draw_traces(axes, [gap, closed], fill=True)
    lengths = [len(line.get_xdata()) for line in axes.lines]
    breaks = [int(np.isnan(line.get_xdata()).sum()) for line in axes.lines]
    assert lengths == [3, 2, 3, 3]
    assert breaks == [0, 0, 1, 1]


def test_a_line_ends_where_another_region_takes_over() -> None:
    # at eps = 0.45 omega_1 + omega_2 has merged with 2 omega_1: its own part begins between their centres
    zero, one = np.zeros((2, 2)), np.eye(2)
    system = PeriodicSystem(one, zero, zero, np.diag([1.0, 1.5]), [[[1.0, 0.5], [0.5, 1.0]]])
    trace = trace_boundary(system, 1 + np.sqrt(1.5), [0.4, 0.45])
    assert trace.lower[1] < 2.0
    axes = new_figure((3, 3)).add_subplot()
    draw_traces(axes, [trace], fill=True)
    lower, _ = (np.asarray(line.get_xdata()) for line in axes.lines)
    assert 2.0 < lower[1] < 1 + np.sqrt(1.5)
    assert lower[0] == trace.lower[0]


def test_every_variant_is_in_the_legend_and_in_every_panel(layer: Layer, damped: Layer) -> None:
    figure = region_panels([Layer("elastic", layer.chart, layer.panels), damped], title="both")
    names = [text.get_text() for text in figure.legends[0].get_texts()]
    assert names == ["elastic", "Floquet boundary (traced)", "damped", "multiple scales"]
    panels = [axes for axes in figure.axes if axes.get_title(loc="left")]
    assert len(panels) == len(layer.panels)
    for axes in panels:
        colours = {line.get_color() for line in axes.lines}
        # theory lies black on the traced edges; where there are none it has the colour of its system
        assert len(colours - {"black"}) == 2
        is_open = any(
            trace.is_open.any()
            for curve, trace in (*layer.panels, *damped.panels)
            if curve.label in axes.get_title(loc="left")
        )
        assert ("black" in colours) == is_open


def test_one_panel_a_system(layer: Layer, damped: Layer) -> None:
    figure = variant_panels([Layer("elastic", layer.chart, layer.panels), damped])
    assert [axes.get_title(loc="left") for axes in figure.axes] == ["(a)  elastic", "(b)  damped"]


def test_nothing_to_draw_is_refused() -> None:
    with pytest.raises(ValueError, match="chart is None"):
        overlay(None, [])


def test_a_notebook_shows_a_picture() -> None:
    picture = overlay(None, [], [trace_boundary(mathieu(), near=2.0, eps=[0.1, 0.2])])
    assert picture._repr_png_().startswith(b"\x89PNG")
