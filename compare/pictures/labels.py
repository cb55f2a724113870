"""The names of regions above a picture, side by side."""

from __future__ import annotations

from collections.abc import Collection, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from compare.pictures.style import GREY
from perturb import TransitionCurve

# Width of a character and least space between two labels, in points.
CHARACTER_POINTS, LABEL_GAP_POINTS = 5.6, 8.0
# Width at the top of the window, as part of the window, below which a region is not seen.
MIN_VISIBLE_WIDTH = 1 / 400


def label_regions(
    figure: Figure, axes: Axes, curves: Sequence[TransitionCurve], eps_max: float, first: Collection[float] = ()
) -> None:
    """Write the resonance above the upper edge, of as many regions as there is room for.

    Those that start at one of the frequencies ``first`` come first, then the widest ones.
    """
    figure.draw_without_rendering()  # only the layout knows how wide the axes are
    low, high = axes.get_xlim()
    width_points = axes.get_window_extent().width * 72 / axes.figure.dpi
    places = {curve: _where_seen(curve, low, high, eps_max) for curve in curves}
    inside = [curve for curve in curves if np.isfinite(places[curve])]
    spacing = CHARACTER_POINTS * max((len(curve.label) for curve in inside), default=0) + LABEL_GAP_POINTS
    width = {curve: float(np.nan_to_num(np.subtract(*reversed(curve.edges(eps_max))))) for curve in inside}
    inside.sort(key=lambda curve: (curve.centre not in first, -width[curve]))
    seen = sorted(inside[: int(width_points / spacing)], key=places.__getitem__)
    wanted = [(places[curve] - low) / (high - low) * width_points for curve in seen]
    for curve, place in zip(seen, _spread(wanted, spacing, width_points), strict=True):
        axes.annotate(
            curve.label,
            xy=(places[curve], eps_max),
            xytext=(low + place / width_points * (high - low), eps_max * 1.045),
            ha="center",
            va="bottom",
            fontsize=8.5,
            annotation_clip=False,
            # from below the label, so that none runs through another
            arrowprops={"arrowstyle": "-", "lw": 0.5, "color": GREY, "shrinkA": 0, "shrinkB": 0, "relpos": (0.5, 0.0)},
        )


def _where_seen(curve: TransitionCurve, low: float, high: float, eps_max: float) -> float:
    """Return where a region starts or, if that is outside, the middle of what leans into the window; NaN if nothing."""
    if low < curve.centre < high:
        return curve.centre
    lower, upper = curve.edges(eps_max)
    left, right = max(float(lower), low), min(float(upper), high)
    return (left + right) / 2 if right - left > MIN_VISIBLE_WIDTH * (high - low) else float("nan")


def is_visible(axes: Axes, curve: TransitionCurve, eps_max: float) -> bool:
    """Whether the region is wide enough to be seen."""
    low, high = axes.get_xlim()
    lower, upper = curve.edges(eps_max)
    return bool(upper - lower > MIN_VISIBLE_WIDTH * (high - low))


def _spread(wanted: Sequence[float], spacing: float, room: float) -> list[float]:
    """Move sorted positions apart to at least ``spacing``, each cluster about its mean, all between 0 and ``room``."""
    clusters: list[list[float]] = []
    for position in wanted:
        clusters.append([position])
        while len(clusters) > 1:
            left, right = clusters[-2], clusters[-1]
            reach = spacing * (len(left) + len(right)) / 2
            if np.mean(right) - np.mean(left) >= reach:
                break
            clusters[-2:] = [left + right]
    apart = [
        float(np.mean(cluster)) + spacing * (index - (len(cluster) - 1) / 2)
        for cluster in clusters
        for index in range(len(cluster))
    ]
    last = len(apart) - 1
    return [min(max(place, i * spacing), room - (last - i) * spacing) for i, place in enumerate(apart)]
