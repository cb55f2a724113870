"""One verb draws everything: what is drawn has the numbers of what was computed."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from compare import animate, overlay, plot
from compare.pictures import ORANGE, Picture, new_figure
from floquet import floquet_modes, monodromy, stability_chart, trace_boundary, trace_regions
from floquet.modes import follow_modes
from periodic import PeriodicSystem
from periodic.examples import mathieu
from perturb import transition_curves
from plate import EdgeLoad, MovingPlate

PLATE = MovingPlate(axial_terms=2, lateral_terms=3, load=EdgeLoad.partial(0.5), inplane="static", inplane_terms=(5, 5))
CHART = stability_chart(mathieu(), np.linspace(1.5, 2.5, 11), np.linspace(0, 0.4, 5), n_jobs=1, progress=False)


def _regions() -> Any:
    return trace_regions(mathieu(), (1.5, 2.5), (0.0, 0.4), n_jobs=1, progress=False)


def _line() -> Any:
    """Locked onto Omega / 2 from stiffness 1 on, and not at 0.8, where the modes are a pair."""

    def make(k: float) -> PeriodicSystem:
        return PeriodicSystem(
            np.eye(2), damping=0.01 * np.eye(2), stiffness=np.diag([k, 5.0]), cosine=[np.ones((2, 2))]
        )

    return follow_modes(make, [0.8, 1.0, 1.05], Omega=2.0, eps=0.1, progress=False)


THINGS: dict[str, Callable[[], Any]] = {
    "chart": lambda: CHART,
    "regions": _regions,
    "region": lambda: _regions()[0],
    "trace": lambda: trace_boundary(mathieu(), 2.0, [0.1, 0.2]),
    "curves": lambda: transition_curves(mathieu(), (1.5, 2.5)),
    "monodromy": lambda: monodromy(mathieu(), 2.0, 0.1),
    "modes": lambda: floquet_modes(mathieu(), 2.0, 0.1),
    "mode": lambda: floquet_modes(mathieu(), 2.0, 0.1)[0],
    "line": _line,
    "response": lambda: floquet_modes(mathieu(), 2.0, 0.1).response([0.0, 1.0], 3),
    "transient": lambda: floquet_modes(mathieu(), 2.0, 0.1).transient(3),
    "stress": lambda: PLATE.stress(0.0, 0),
    "plate": lambda: PLATE,
}


@pytest.mark.parametrize("name", THINGS)
def test_everything_has_a_picture_that_shows_itself(name: str) -> None:
    thing = THINGS[name]()
    figure = plot(thing)
    assert isinstance(figure, Picture)
    assert figure._repr_png_().startswith(b"\x89PNG")
    assert all(text for axes in figure.axes if axes.axison for text in [axes.get_ylabel()])
    if name in ("stress", "plate"):
        return
    axes = new_figure((4, 3)).add_subplot()
    drawn = plot(thing, ax=axes)
    assert drawn
    assert all(artist in axes.get_children() for artist in drawn)


def test_multipliers_outside_the_circle_stand_out() -> None:
    modes = floquet_modes(mathieu(), 2.0, 0.1)
    axes = plot(modes).axes[0]
    inside, outside = axes.lines[2:]
    np.testing.assert_allclose(outside.get_xdata() + 1j * outside.get_ydata(), modes.multipliers[:1])
    np.testing.assert_allclose(inside.get_xdata() + 1j * inside.get_ydata(), modes.multipliers[1:])
    assert outside.get_color() == ORANGE
    assert axes.get_xlabel() == "Re μ"


def test_a_campbell_diagram_has_frequencies_excitation_lines_and_all_growth() -> None:
    line = _line()
    above, below = plot(line, parameter="damping", modes=2).axes
    curves = [artist for artist in above.lines if str(artist.get_label()).startswith("mode")]
    drawn = np.sort(np.array([artist.get_ydata() for artist in curves]), axis=0)
    positive = np.sort(line.frequencies[:, line.frequencies[0] >= 0].T, axis=0)[:2]
    np.testing.assert_allclose(drawn, np.abs(positive))
    assert any(np.allclose(artist.get_ydata(), 2.0) for artist in above.lines)  # Omega
    ratios = np.concatenate([artist.get_ydata() for artist in below.lines if len(artist.get_ydata()) == 3])
    # the growing one of a locked pair is drawn, whichever of the two has been followed
    assert np.nanmin(ratios) == line.damping_ratios.min() < 0
    assert any(artist.get_color() == ORANGE for artist in above.lines)


def test_shares_of_a_mode_are_drawn_over_frequencies_in_hertz() -> None:
    mode = floquet_modes(mathieu(), 2.0, 0.1)[0]
    axes = plot(mode, units="Hz").axes[0]
    (dots,) = axes.lines
    np.testing.assert_allclose(dots.get_xdata()[0] * 2 * np.pi, 1.0)
    assert abs(sum(dots.get_ydata()) - 1) < 2e-4
    assert axes.get_xlabel() == "frequency (Hz)"


def test_si_units_are_those_of_the_plate() -> None:
    web = MovingPlate.from_si(
        length=0.1, width=1.0, thickness=1e-4, density=800.0, youngs_modulus=1e9, poisson_ratio=0.3, speed=10.0,
        tension=500.0, axial_terms=1, lateral_terms=2,
    )  # fmt: skip
    axes = plot(web.stress(0.0, 0), units=web).axes[0]
    assert axes.get_title(loc="left") == "N_xx inside: 500 to 500"
    chart = plot(CHART, units=web).axes[0]
    np.testing.assert_allclose(chart.get_xlim(), np.array([1.5, 2.5]) * web.frequency_unit / (2 * np.pi))
    with pytest.raises(ValueError, match="no SI units"):
        plot(CHART, units=PLATE)


def test_traced_regions_lie_over_a_chart() -> None:
    regions = _regions()
    axes = overlay(CHART, [], regions).axes[0]
    loop = regions[0].outlines[0]
    np.testing.assert_array_equal(np.asarray(axes.lines[0].get_xdata())[:-1], loop.Omega)
    assert regions[0].label in {text.get_text() for text in axes.texts}
    overlay(None, [], regions)


def test_the_deflection_of_a_mode_satisfies_the_supports_and_moves(tmp_path: Path) -> None:
    mode = floquet_modes(PLATE, 18.6, 0.3)[0]
    mesh = plot(mode, plate=PLATE).axes[0].collections[0]
    values = np.asarray(mesh.get_array()).reshape(41, 61)
    assert np.abs(values[:, [0, -1]]).max() < 1e-12  # simply supported edges
    assert 0.5 < np.abs(values).max() <= 1 + 1e-9
    animate(mode, PLATE, frames=4).save(tmp_path / "mode.gif", writer="pillow")
    with Image.open(tmp_path / "mode.gif") as moving:
        assert getattr(moving, "n_frames") == 4  # noqa: B009
    with pytest.raises(ValueError, match="the plate 56"):
        plot(mode, plate=MovingPlate())


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: plot(3), "x = 3 cannot be drawn"),
        (lambda: plot([]), "cannot be drawn"),
        (lambda: plot(CHART, units="miles"), "units = 'miles'"),
        (lambda: plot(PLATE, ax=new_figure((3, 3)).add_subplot()), "leave ax out"),
        (lambda: plot(PLATE.stress(0.0, 0), ax=new_figure((3, 3)).add_subplot()), "needs three"),
    ],
)
def test_what_cannot_be_drawn_is_said(call: Callable[[], Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        call()
