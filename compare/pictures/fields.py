"""Pictures of the plate: stress over it, its deflection in a mode, still and moving."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.animation import FuncAnimation
from matplotlib.axes import Axes
from numpy.typing import NDArray

from compare.pictures.style import GREY, Picture, new_figure
from compare.pictures.units import Units
from floquet.modes import FloquetMode
from periodic.checks import FloatArray
from plate import MovingPlate, StressField, deflection

# Points of a drawn field along the plate and across it, and contours of each sign.
FIELD_POINTS, CONTOURS = (61, 41), 5
# Pictures of an animation, for one swing of the strongest harmonic.
FRAMES = 36


def draw_stress(axes: list[Axes], field: StressField, units: Units) -> list[object]:
    """Draw N_xx, N_yy and N_xy, each on its own axes with its own scale: blue is compression, red is tension."""
    drawn: list[object] = []
    for one, name in zip(axes, ("N_xx", "N_yy", "N_xy"), strict=True):
        values = getattr(field, name).real * units.stress
        inside = values[1:-1, 1:-1] if min(values.shape) > 2 else values
        largest = float(np.abs(inside).max()) or 1.0  # a jump of the load makes N_xy infinite on the edge
        drawn.append(_signed(one, field.x, field.y, values, largest, units.label(name, "stress")))
        one.set_title(f"{name} inside: {inside.min():.3g} to {inside.max():.3g}", loc="left")
    return drawn


def draw_deflection(axes: Axes, mode: FloquetMode, plate: MovingPlate, t: float = 0.0) -> list[object]:
    """Draw the deflection of a plate in a mode at one time, the largest one of a swing scaled to one."""
    x, y, shapes, largest = _swing(mode, plate, np.array([t]))
    drawn = _signed(axes, x, y, shapes[0] / largest, 1.0, "deflection")
    axes.set_title(f"frequency {abs(mode.frequency):.4g}, growth rate {mode.growth_rate:.4g}", loc="left")
    return [drawn]


def animate(mode: FloquetMode, plate: MovingPlate, *, frames: int = FRAMES, growing: bool = False) -> FuncAnimation:
    """Return the moving deflection of a plate in a mode, over one swing of its strongest harmonic.

    Parameters
    ----------
    mode : FloquetMode
        One of ``floquet_modes(plate, ...)``.
    plate : MovingPlate
    frames : int
        Number of pictures.
    growing : bool
        Whether it grows and decays as the exponent says; otherwise its size is kept.

    Returns
    -------
    matplotlib.animation.FuncAnimation
        ``save("mode.gif", writer="pillow")`` writes it, ``to_jshtml()`` makes a page of it, which a notebook shows.
    """
    swing = 2 * np.pi / (abs(mode.frequency) or mode.Omega)
    times = np.arange(frames) * swing / frames
    x, y, shapes, largest = _swing(mode, plate, times, growing)
    figure = new_figure((4.8, 3.2))
    axes = figure.add_subplot()
    mesh = _signed(axes, x, y, shapes[0] / largest, 1.0, "deflection")
    title = axes.set_title("", loc="left")

    def show(k: int) -> list[Any]:
        mesh.set_array(shapes[k] / largest)
        title.set_text(f"t = {times[k]:.3g}")
        return [mesh, title]

    return FuncAnimation(figure, show, frames=frames, interval=60)


def _swing(
    mode: FloquetMode, plate: MovingPlate, times: FloatArray, growing: bool = False
) -> tuple[FloatArray, FloatArray, FloatArray, float]:
    """Return x, y, the deflections at ``times`` (k, y, x), and the largest one within a swing."""
    terms, r = plate.terms, plate.aspect_ratio
    n = terms.axial * terms.lateral
    if mode.coefficients.shape[1] != 2 * n:
        raise ValueError(
            f"mode has {mode.coefficients.shape[1]} states, the plate {2 * n}; give a mode of floquet_modes(plate, ...)"
        )
    x, y = np.linspace(0, r, FIELD_POINTS[0]), np.linspace(0, 1, FIELD_POINTS[1])

    def shapes(when: FloatArray) -> NDArray[np.float64]:
        rate = mode.exponent if growing else 1j * mode.frequency
        W = mode.periodic(when)[:, n:] * np.exp(rate * when)[:, None]
        return deflection(W, terms.axial, terms.lateral, r, x, y).real

    whole = np.linspace(0, 2 * np.pi / (abs(mode.frequency) or mode.Omega), FRAMES, endpoint=False)
    return x, y, shapes(times), float(np.abs(shapes(whole)).max()) or 1.0


def _signed(axes: Axes, x: FloatArray, y: FloatArray, values: FloatArray, largest: float, label: str) -> Any:
    """Draw a field of either sign with lines of equal value: solid above zero, dashed below."""
    mesh = axes.pcolormesh(x, y, values, cmap="RdBu_r", vmin=-largest, vmax=largest, shading="gouraud", rasterized=True)
    levels = np.linspace(-largest, largest, 2 * CONTOURS + 2)
    inside = levels[(levels > values.min()) & (levels < values.max())]
    if inside.size and np.ptp(values) > 1e-9 * largest:
        axes.contour(x, y, values, levels=inside, colors=GREY, linewidths=0.6)
    axes.set_aspect("equal")
    axes.set_xlabel("x/b")
    axes.set_ylabel("y/b")
    bar = axes.figure.colorbar(mesh, ax=axes, pad=0.02, shrink=0.8)
    bar.set_label(label)
    bar.outline.set_visible(False)
    return mesh


def stress_figure(field: StressField) -> Picture:
    """Return a figure with room for three stresses, side by side or, of a long plate, one above the other."""
    long = float(np.ptp(field.x)) > 1.5 * float(np.ptp(field.y))
    return new_figure((5.0, 6.0) if long else (10.5, 3.2))
