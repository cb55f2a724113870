"""Pictures of modes: multipliers, participation of harmonics, Campbell diagrams."""

from __future__ import annotations

from itertools import count

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Circle

from compare.pictures.style import BLUE, GREEN, GREY, ORANGE, PURPLE
from compare.pictures.units import Units
from floquet.modes import FloquetMode, FloquetModes, ModeLine
from periodic.checks import ComplexArray

# Harmonics with a share below this are not drawn.
MIN_SHOWN_SHARE = 1e-4
# Growth over a period above which a mode counts as growing in a picture.
MIN_SHOWN_GROWTH = 1e-9
# Lines and their dashes, so that neither colour alone nor order tells curves apart.
LINES = [(colour, dash) for dash in ("-", (0, (5, 2)), (0, (1, 1.2))) for colour in (BLUE, GREEN, PURPLE, "black")]
# Excitation lines j Omega in a Campbell diagram, and modes that are drawn where nobody says how many.
EXCITATION_LINES, MODES_DRAWN = 4, 6
# Multipliers are drawn up to this modulus, larger ones on the frame.
ROOM = 0.25


def draw_multipliers(axes: Axes, multipliers: ComplexArray) -> list[object]:
    """Draw multipliers in the complex plane with the unit circle: crosses outside are unstable, dots are not."""
    circle = axes.add_patch(Circle((0, 0), 1, fill=False, edgecolor=GREY, lw=1.0))
    axes.axhline(0, color=GREY, lw=0.5)
    axes.axvline(0, color=GREY, lw=0.5)
    outside = np.abs(multipliers) > 1 + MIN_SHOWN_GROWTH
    stable = axes.plot(multipliers[~outside].real, multipliers[~outside].imag, "o", ms=4, color=BLUE, mfc="none")
    growing = axes.plot(multipliers[outside].real, multipliers[outside].imag, "X", ms=7, color=ORANGE, mec="white")
    reach = float(np.abs(multipliers).max(initial=1.0)) * (1 + ROOM)
    axes.set_xlim(-reach, reach)
    axes.set_ylim(-reach, reach)
    axes.set_aspect("equal")
    axes.set_xlabel("Re μ")
    axes.set_ylabel("Im μ")
    axes.set_title(f"{int(outside.sum())} of {len(multipliers)} multipliers outside the unit circle", loc="left")
    return [circle, *stable, *growing]


def draw_modes(axes: Axes, modes: FloquetModes) -> list[object]:
    """Draw the multipliers of modes."""
    return draw_multipliers(axes, modes.multipliers)


def draw_mode(axes: Axes, mode: FloquetMode, units: Units) -> list[object]:
    """Draw the share of each harmonic of a mode over its frequency, the strongest ones with their shares."""
    shown = np.flatnonzero(mode.participation >= MIN_SHOWN_SHARE)
    frequencies = np.abs(mode.frequency + mode.harmonics[shown] * mode.Omega) * units.frequency
    joined: dict[float, float] = {}
    for frequency, share in zip(np.round(frequencies, 9), mode.participation[shown], strict=True):
        joined[float(frequency)] = joined.get(float(frequency), 0.0) + float(share)
    places, shares = np.array(list(joined)), np.array(list(joined.values()))
    stems = axes.vlines(places, MIN_SHOWN_SHARE / 2, shares, color=BLUE, lw=2)
    dots = axes.plot(places, shares, "o", color=BLUE, ms=4)
    for i in np.argsort(-shares)[:3]:
        axes.annotate(f"{shares[i]:.2g}", (places[i], shares[i]), (0, 4), textcoords="offset points", ha="center")
    axes.set_yscale("log")
    axes.set_ylim(MIN_SHOWN_SHARE / 2, 3)
    axes.set_xlim(0, float(places.max()) * 1.12)
    axes.set_xlabel(units.label("frequency", "frequency"))
    axes.set_ylabel("share of the motion")
    axes.set_title(
        f"growth rate {mode.growth_rate * units.rate:.4g}, damping ratio {mode.damping_ratio:.4g}", loc="left"
    )
    return [stems, *dots]


def draw_campbell(
    axes: Axes, damping: Axes | None, line: ModeLine, units: Units, parameter: str, modes: int | None
) -> list[object]:
    """Draw frequencies, and damping ratios on a second axes, of the lowest modes over a parameter.

    Dashed grey lines are the excitation, j Omega. A mode that grows is drawn thick and orange where it does. A complex
    mode and its conjugate are one line; where they lock onto the excitation, one of them grows more than the other, and
    both damping ratios are drawn.
    """
    start = line.frequencies[0]
    upper = np.flatnonzero(start >= 0)
    chosen = upper[np.argsort(start[upper], kind="stable")][: MODES_DRAWN if modes is None else modes]
    drawn: list[object] = []
    top = float(line.frequencies[:, chosen].max(initial=0.0)) * units.frequency * 1.08
    for j in count(1):
        excitation = j * line.Omega * units.frequency
        if j > EXCITATION_LINES or excitation.min() > top:
            break
        drawn += axes.plot(line.values, excitation, color=GREY, lw=0.8, ls=(0, (6, 3)), zorder=1)
        axes.annotate(
            "Ω" if j == 1 else f"{j}Ω", (line.values[-1], excitation[-1]), (3, 0), textcoords="offset points",
            va="center", color=GREY, annotation_clip=True,
        )  # fmt: skip
    growing = line.growth_rates * (2 * np.pi / line.Omega)[:, None] > MIN_SHOWN_GROWTH
    any_grows = False
    for number, i in enumerate(chosen):
        colour, dash = LINES[number % len(LINES)]
        partner = _partner(line, int(i))
        frequency = np.abs(line.frequencies[:, i]) * units.frequency
        drawn += axes.plot(line.values, frequency, color=colour, ls=dash, lw=1.3, label=f"mode {number + 1}", zorder=3)
        unstable = growing[:, i] | growing[:, partner]
        any_grows |= bool(unstable.any())
        if unstable.any():
            hot = np.where(unstable, frequency, np.nan)
            drawn += axes.plot(line.values, hot, color=ORANGE, lw=4, alpha=0.6, zorder=2, solid_capstyle="butt")
        if damping is not None:
            for one in {int(i), partner}:
                ratio = line.damping_ratios[:, one]
                drawn += damping.plot(line.values, ratio, color=colour, ls=dash, lw=1.3, zorder=3)
                hot = np.where(growing[:, one], ratio, np.nan)
                drawn += damping.plot(line.values, hot, color=ORANGE, lw=4, alpha=0.6, zorder=2, solid_capstyle="butt")
    axes.set_xlim(line.values[0], line.values[-1])
    axes.set_ylim(0, top)
    axes.set_ylabel(units.label("frequency", "frequency"))
    (axes if damping is None else damping).set_xlabel(parameter)
    if damping is not None:
        damping.axhline(0, color=GREY, lw=0.6)
        damping.set_ylabel("damping ratio")
        damping.set_xlim(line.values[0], line.values[-1])
    handles, _ = axes.get_legend_handles_labels()
    if any_grows:
        handles.append(Line2D([], [], color=ORANGE, lw=4, alpha=0.6, label="grows"))
    axes.figure.legend(handles=handles, loc="outside lower center", ncols=4)
    return drawn


def _partner(line: ModeLine, i: int) -> int:
    """Return the number of the conjugate of mode ``i`` at the first value: itself if its multiplier is real."""
    apart = line.exponents[0] - line.exponents[0, i].conj()
    apart -= 1j * line.Omega[0] * np.rint(apart.imag / line.Omega[0])
    apart[i] *= 1 - MIN_SHOWN_GROWTH  # of equal ones itself
    return int(np.abs(apart).argmin())
