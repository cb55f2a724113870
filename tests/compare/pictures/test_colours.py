"""Unstable cells look unstable: every shade of growth stands out from white, and faster growth is darker."""

from __future__ import annotations

import numpy as np
from matplotlib.colors import to_rgb

from compare.pictures import GROWTH_PALETTE, ORANGE, UNDECIDED_GREY

MIN_CONTRAST_TO_WHITE = 3.0  # of graphical objects, WCAG 2.1, 1.4.11


def luminance(colour: str) -> float:
    """Return the relative luminance of WCAG 2.1."""
    parts = np.array(to_rgb(colour))
    linear = np.where(parts <= 0.04045, parts / 12.92, ((parts + 0.055) / 1.055) ** 2.4)
    return float(linear @ [0.2126, 0.7152, 0.0722])


def contrast(one: str, other: str) -> float:
    dark, light = sorted((luminance(one), luminance(other)))
    return (light + 0.05) / (dark + 0.05)


def test_contrast_is_that_of_wcag() -> None:
    assert contrast("black", "white") == 21.0


def test_no_shade_of_growth_looks_stable() -> None:
    assert min(contrast(colour, "white") for colour in GROWTH_PALETTE) >= MIN_CONTRAST_TO_WHITE
    assert contrast(UNDECIDED_GREY, "white") > 1.7


def test_faster_growth_is_darker() -> None:
    shades = [luminance(colour) for colour in GROWTH_PALETTE]
    assert (np.diff(shades) <= 0).all()
    assert shades[0] > 4 * shades[-1]


def test_curves_differ_from_every_shade_in_colour() -> None:
    red = np.array([to_rgb(colour)[0] - to_rgb(colour)[2] for colour in GROWTH_PALETTE])
    assert (red < 0).all()  # all shades are bluish
    assert to_rgb(ORANGE)[0] - to_rgb(ORANGE)[2] > 0.5
