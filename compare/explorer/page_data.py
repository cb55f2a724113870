"""What the explorer's page shows, as plain columns for its sources, without Bokeh."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from compare.explorer.outlines import FAINT_COLOUR, FAINT_POINTS, closed, is_narrow
from compare.explorer.responses import Response
from floquet import Kind, Region, StabilityChart
from perturb import TransitionCurve

UNEXPLAINED = "no resonance explains it"
# Points of an analytic curve.
PAGE_CURVE_POINTS = 121
# Width of a label and least width of a region that gets one, as parts of the window. Regions that find no place on so
# many lines get none: the curve under the pointer tells its name.
LABEL_PART, MIN_LABELLED_PART, LABEL_LINES = 0.065, 1 / 400, 4


def cell_data(chart: StabilityChart | None) -> dict[str, Any]:
    """Return the images of a chart. Cells are centred on its grid points; stable ones are transparent."""
    names = ("growth", "kind", "rate", "verdict", "error")
    if chart is None:
        return {name: [] for name in (*names, "x", "y", "dw", "dh")}
    unstable, undecided = chart.kind > Kind.STABLE, chart.kind == Kind.UNDECIDED
    growth = np.where(unstable, chart.growth_rate, np.where(undecided, -1.0, np.nan))
    kind = np.where(unstable | undecided, chart.kind, np.nan)
    arrays = (growth, kind, chart.growth_rate, chart.kind, chart.error)
    images = {name: [np.asarray(array, np.float32)] for name, array in zip(names, arrays, strict=True)}
    (x, dw), (y, dh) = _extent(chart.Omega), _extent(chart.eps)
    return {**images, "x": [x], "y": [y], "dw": [dw], "dh": [dh]}


def _extent(grid: NDArray[np.float64]) -> tuple[float, float]:
    step = float(grid[-1] - grid[0]) / (grid.size - 1)
    return float(grid[0]) - step / 2, step * grid.size


def curve_data(curves: Sequence[TransitionCurve], chart: StabilityChart) -> dict[str, Any]:
    """Return both edges of every analytic region, interrupted where it is closed."""
    eps_max = float(chart.eps[-1])
    # more of them near each tip, where a damped region turns
    share = np.linspace(0, 1, PAGE_CURVE_POINTS) ** 2
    xs, ys, names = [], [], []
    for curve in curves:
        start = curve.tip if 0 < curve.tip < eps_max else 0.0
        eps = start + (eps_max - start) * share
        for edge in curve.edges(eps):
            xs.append(np.where(np.isfinite(edge), edge, np.nan))
            ys.append(eps)
            names.append(curve.label)
    return {"xs": xs, "ys": ys, "label": names}


def outline_data(regions: Sequence[Region], chart: StabilityChart) -> dict[str, Any]:
    """Return every outline of the traced regions, closed, with the region's label; narrow ones are faint."""
    pairs = [(region.label or UNEXPLAINED, loop) for region in regions for loop in region.outlines]
    narrow = [is_narrow(loop, chart.Omega) for _, loop in pairs]
    return {
        "xs": [closed(loop.Omega) for _, loop in pairs],
        "ys": [closed(loop.eps) for _, loop in pairs],
        "label": [label for label, _ in pairs],
        "color": [FAINT_COLOUR if faint else "black" for faint in narrow],
        "width": [2 * FAINT_POINTS if faint else 1.2 for faint in narrow],
    }


def label_data(curves: Sequence[TransitionCurve], chart: StabilityChart) -> dict[str, Any]:
    """Place the labels of the widest regions at the top of the chart, on lines, so that none overlaps another."""
    low, high, bottom, top = (float(grid[end]) for grid in (chart.Omega, chart.eps) for end in (0, -1))
    room = LABEL_PART * (high - low)
    seen = []
    for curve in curves:
        lower, upper = curve.edges(top)
        if low < curve.centre < high and upper - lower > MIN_LABELLED_PART * (high - low):
            seen.append((min(float(upper), high) - max(float(lower), low), curve))
    placed: list[tuple[int, float, float, str]] = []
    for _, curve in sorted(seen, key=lambda pair: -pair[0]):
        half = 0.5 * room * max(1.0, len(curve.label) / 5)
        place = min(max(curve.centre, low + half), high - half)
        for line in range(LABEL_LINES):
            if all(abs(place - x) > half + other for at, x, other, _ in placed if at == line):
                placed.append((line, place, half, curve.label))
                break
    return {
        "x": [x for _, x, _, _ in placed],
        "y": [top - (top - bottom) * (0.015 + 0.05 * line) for line, *_ in placed],
        "text": [label for *_, label in placed],
    }


def point_data(responses: Sequence[Response]) -> dict[str, Any]:
    """Return one row for each response; multipliers and waves as rows of a matrix."""

    def matrix(values: list[NDArray[np.float64]], dtype: type[np.floating]) -> NDArray[Any]:
        return np.array(values, dtype) if values else np.empty((0, 0), dtype)

    return {
        "Omega": np.array([r.Omega for r in responses]),
        "eps": np.array([r.eps for r in responses]),
        "rate": np.array([r.growth_rate for r in responses]),
        "error": np.array([r.error for r in responses]),
        "kind": np.array([int(r.kind) for r in responses], np.int32),
        "coordinate": np.array([r.coordinate + 1 for r in responses], np.int32),
        "mu_re": np.array([r.mu.real for r in responses]),
        "mu_im": np.array([r.mu.imag for r in responses]),
        "re": matrix([r.multipliers.real for r in responses], np.float64),
        "im": matrix([r.multipliers.imag for r in responses], np.float64),
        "wave_re": matrix([r.wave.real for r in responses], np.float32),
        "wave_im": matrix([r.wave.imag for r in responses], np.float32),
    }
