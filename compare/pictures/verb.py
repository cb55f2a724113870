"""One verb for all pictures of one thing: `plot`."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes

from compare.pictures.answers import draw_proved, draw_regions, draw_response, draw_transient
from compare.pictures.fields import draw_deflection, draw_stress, stress_figure
from compare.pictures.layers import draw_curves, draw_growth, draw_traces
from compare.pictures.planes import draw_boundaries, name_axes_of_plane
from compare.pictures.schematic import draw_plate
from compare.pictures.spectra import draw_campbell, draw_mode, draw_multipliers
from compare.pictures.style import STYLE, Picture, new_figure
from compare.pictures.units import Units, units_of
from floquet import BoundaryTrace, Monodromy, PlaneBoundary, PlaneChart, Region, StabilityChart
from floquet.modes import FloquetMode, FloquetModes, ModeLine, Response, TransientGrowth
from perturb import TransitionCurve
from plate import MovingPlate, StressField

# Highest eps of transition curves that end nowhere, in a picture of curves alone.
CURVES_EPS = 0.5


def plot(
    x: Any,
    ax: Axes | None = None,
    *,
    units: Any = None,
    plate: MovingPlate | None = None,
    parameter: str = "parameter",
    modes: int | None = None,
) -> Any:
    """Draw anything that can be drawn.

    Parameters
    ----------
    x : object
        A `StabilityChart`, `PlaneChart` or `ProvedChart`; a `Region`, `BoundaryTrace`, `PlaneBoundary` or
        `TransitionCurve`, or a list of them; `Monodromy` or `FloquetModes` (multipliers); `FloquetMode` (harmonics;
        with ``plate`` its deflection); `ModeLine` (Campbell diagram); `Response`; `TransientGrowth`; `StressField`;
        `MovingPlate`.
    ax : matplotlib Axes, optional
        Where to draw. A stress field takes three.
    units : "Hz", "rpm", "rad/s" or a plate in SI units, optional
        Of frequencies, times and stresses; as they are if left out (`compare.pictures.units`).
    plate : MovingPlate, optional
        The plate whose mode is drawn.
    parameter : str
        What the values of a `ModeLine` are.
    modes : int, optional
        Number of lowest modes in a Campbell diagram; six if left out.

    Returns
    -------
    Picture or list of artists
        Without ``ax`` a figure, which shows itself as the value of a notebook's cell; with ``ax`` what was drawn.

    Raises
    ------
    ValueError
        If ``x`` is nothing that can be drawn, or ``units`` are not known.
    """
    scale = units_of(units)
    if isinstance(x, MovingPlate):
        if ax is not None:
            raise ValueError("ax was given, but the drawing of a plate is a figure of its own; leave ax out")
        return draw_plate(x)
    with mpl.rc_context(STYLE):
        if isinstance(x, StressField):
            return _stress(x, ax, scale)
        if isinstance(x, ModeLine) and ax is None:
            figure = new_figure((7.0, 5.4))
            above, below = figure.subplots(2, 1, sharex=True, height_ratios=(3, 2))
            draw_campbell(above, below, x, scale, parameter, modes)
            return figure
        draw, size = _painter(x, scale, plate, parameter, modes)
        if ax is not None:
            return draw(ax)
        figure = new_figure(size)
        draw(figure.add_subplot())
        return figure


def _painter(
    x: Any, units: Units, plate: MovingPlate | None, parameter: str, modes: int | None
) -> tuple[Callable[[Axes], list[Any]], tuple[float, float]]:
    """Return what draws ``x`` on axes, and the size of a figure of its own."""
    if isinstance(x, StabilityChart):
        return lambda ax: _chart(ax, x, units), (7.0, 4.2)
    if isinstance(x, PlaneChart):
        return lambda ax: _plane(ax, x), (7.0, 4.2)
    if hasattr(x, "proved_fraction"):  # a ProvedChart, whose class needs python-flint
        return lambda ax: _proved(ax, x, units), (7.0, 4.8)
    if isinstance(x, Monodromy | FloquetModes):
        return lambda ax: draw_multipliers(ax, x.multipliers), (4.6, 4.6)
    if isinstance(x, FloquetMode):
        if plate is not None:
            return lambda ax: draw_deflection(ax, x, plate), (5.0, 3.6)
        return lambda ax: draw_mode(ax, x, units), (6.0, 3.6)
    if isinstance(x, ModeLine):
        return lambda ax: draw_campbell(ax, None, x, units, parameter, modes), (7.0, 4.2)
    if isinstance(x, Response):
        return lambda ax: draw_response(ax, x, units), (7.0, 3.6)
    if isinstance(x, TransientGrowth):
        return lambda ax: draw_transient(ax, x, units), (6.0, 3.6)
    several = list(x) if isinstance(x, Sequence) and not isinstance(x, str) else [x]
    if several:
        if all(isinstance(one, PlaneBoundary) for one in several):
            return lambda ax: draw_boundaries(ax, several), (7.0, 4.2)
        for kind in (Region, BoundaryTrace, TransitionCurve):
            if all(isinstance(one, kind) for one in several):
                return lambda ax: _edges(ax, several, units), (7.0, 4.2)
    raise ValueError(
        f"x = {x!r} cannot be drawn; give a chart, regions, traces, curves, multipliers, modes, a line of modes, a "
        "response, a stress field or a plate"
    )


def _chart(axes: Axes, chart: StabilityChart, units: Units) -> list[Any]:
    before = len(axes.collections)
    draw_growth(axes, chart, colour_bar=True, frequency=units.frequency, rate=units.rate, rate_unit=units.rate_unit)
    axes.set_xlim(chart.Omega[0] * units.frequency, chart.Omega[-1] * units.frequency)
    axes.set_ylim(chart.eps[0], chart.eps[-1])
    _name_axes(axes, units)
    return list(axes.collections[before:])


def _plane(axes: Axes, chart: PlaneChart) -> list[Any]:
    before = len(axes.collections)
    draw_growth(axes, chart, colour_bar=True)
    axes.set_xlim(chart.x[0], chart.x[-1])
    axes.set_ylim(chart.y[0], chart.y[-1])
    name_axes_of_plane(axes, chart.names)
    return list(axes.collections[before:])


def _proved(axes: Axes, chart: Any, units: Units) -> list[Any]:
    drawn = draw_proved(axes, chart, frequency=units.frequency)
    _name_axes(axes, units)
    return drawn


def _edges(axes: Axes, several: list[Any], units: Units) -> list[Any]:
    """Draw regions, traces or curves, whichever they are."""
    fresh = not axes.has_data()
    before = len(axes.get_children())
    if isinstance(several[0], Region):
        if fresh:
            corners = np.concatenate([loop.Omega for one in several for loop in one.outlines]) * units.frequency
            axes.set_xlim(corners.min(), corners.max())
            axes.set_ylim(top=max(float(loop.eps.max()) for one in several for loop in one.outlines))
        draw_regions(axes, several, frequency=units.frequency)
    elif isinstance(several[0], BoundaryTrace):
        draw_traces(axes, several, fill=True, frequency=units.frequency)
    else:
        lowest = min(one.tip for one in several)
        top = 2 * lowest if CURVES_EPS < 2 * lowest < np.inf else CURVES_EPS
        draw_curves(axes, several, top, frequency=units.frequency)
    if fresh:
        axes.set_ylim(bottom=0)
        _name_axes(axes, units)
    return list(axes.get_children()[before - len(axes.get_children()) :])


def _name_axes(axes: Axes, units: Units) -> None:
    axes.set_xlabel(units.label("excitation frequency" + ("" if units.frequency_unit else " Ω"), "frequency"))
    axes.set_ylabel("amplitude ε")


def _stress(field: StressField, ax: Any, units: Units) -> Any:
    if ax is not None:
        axes = list(np.ravel(ax))
        if len(axes) != 3:
            raise ValueError(f"ax has {len(axes)} axes; a stress field needs three, for N_xx, N_yy and N_xy")
        return draw_stress(axes, field, units)
    figure: Picture = stress_figure(field)
    along = figure.get_figwidth() > figure.get_figheight()
    draw_stress(list(figure.subplots(*((1, 3) if along else (3, 1)))), field, units)
    return figure
