"""The drawing of a plate shows the plate that it was given."""

from __future__ import annotations

import pytest
from matplotlib.figure import Figure
from matplotlib.text import Annotation

from compare.pictures import draw_plate
from plate import EdgeLoad, MovingPlate


def _arrows(figure: Figure) -> list[tuple[float, float]]:
    """Return where every arrow of the load ends and starts, along x."""
    notes = [text for text in figure.axes[0].texts if isinstance(text, Annotation)]
    return [(note.xy[0], note.xyann[0]) for note in notes if note.xy[1] == note.xyann[1] and note.xy[1] >= 0]


def test_a_load_pulls_outwards_where_it_is() -> None:
    figure = draw_plate(MovingPlate(load=EdgeLoad.partial(0.5), inplane="static"))
    arrows = [(tip, start) for tip, start in _arrows(figure) if start in (0.0, 1.0)]
    assert len(arrows) == 8  # of nine places on an edge, the four from 1/4 on to below 3/4
    assert all((tip < 0) == (start == 0) for tip, start in arrows)


def test_compression_pushes_inwards() -> None:
    arrows = _arrows(draw_plate(MovingPlate(speed=0.0, tension=-3.0)))
    assert sum(tip == 0.0 for tip, _ in arrows) == 9


@pytest.mark.parametrize("speed", [2.0, -2.0])
def test_the_motion_points_where_the_plate_moves(speed: float) -> None:
    figure = draw_plate(MovingPlate(speed=speed, tension=0.0, load=EdgeLoad.linear(0, 2)))
    [(tip, start)] = [arrow for arrow in _arrows(figure) if 0 < arrow[0] < 1]
    assert (tip > start) == (speed > 0)


def test_a_plate_out_of_proportion_is_said_to_be() -> None:
    assert "not to scale" in draw_plate(MovingPlate(aspect_ratio=8.0, speed=0.0)).axes[0].get_title(loc="left")
    assert "not to scale" not in draw_plate(MovingPlate(aspect_ratio=2.0, speed=0.0)).axes[0].get_title(loc="left")
