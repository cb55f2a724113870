"""What the arguments of a plate have to be, each check raising ValueError with argument, value and remedy."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from periodic.checks import FloatArray, grid, real_number, whole_number

# Beyond these a plate is a beam or a string, and the smallest stiffness drowns in the rounding of the largest.
ASPECT_RATIOS = (1e-3, 1e3)
THICKNESS_RATIOS = (0.0, 1.0)

# Its square, times anything of a plate, is still a float.
HIGHEST_FREQUENCY = 1e100

# More trial functions than any study needs; the limits keep a slip from filling the memory.
MOST_TERMS = 100
MOST_COORDINATES = 1000
MOST_INPLANE_TERMS = 50

# Points of a stress field's grid in each direction: steps of a fortieth.
GRID = 41

# A place beyond the end of the plate by this share of its length is on the end: rounding of x/a times r.
PLACE_ROUNDING = 1e-12


def ratio(name: str, value: Any, limits: tuple[float, float]) -> float:
    """Return ``value`` as a float strictly between two limits."""
    number = real_number(name, value, positive=True)
    low, high = limits
    if not low < number < high:
        raise ValueError(f"{name} = {number!r} is no plate's; give one between {low:g} and {high:g}")
    return number


def frequency(name: str, value: Any) -> float:
    """Return ``value`` as an excitation frequency whose square is a float."""
    number = real_number(name, value, nonnegative=True)
    if number > HIGHEST_FREQUENCY:
        raise ValueError(f"{name} = {number!r} is no plate's; give at most {HIGHEST_FREQUENCY:g}")
    return number


def poisson_ratio(value: Any) -> float:
    """Return ``value`` as a Poisson's ratio, above -1 and at most 0.5."""
    nu = real_number("poisson_ratio", value)
    if not -1 < nu <= 0.5:
        raise ValueError(f"poisson_ratio = {nu!r} is out of range; give -1 < nu <= 0.5")
    return nu


def terms(name: str, value: Any) -> int:
    """Return ``value`` as a number of transverse trial functions in one direction."""
    return whole_number(name, value, least=1, most=MOST_TERMS)


def inplane_terms(value: Any) -> tuple[int, int]:
    """Return ``value`` as numbers of in-plane trial functions along x and across."""
    try:
        axial, lateral = value
    except (TypeError, ValueError):
        raise ValueError(f"inplane_terms = {value!r} is not a pair; give (axial, lateral), such as (9, 9)") from None
    return (
        whole_number("inplane_terms[0]", axial, least=2, most=MOST_INPLANE_TERMS),
        whole_number("inplane_terms[1]", lateral, least=1, most=MOST_INPLANE_TERMS),
    )


def places(name: str, value: ArrayLike | None, end: float) -> FloatArray:
    """Return ``value`` as increasing places from 0 to ``end``, shape (k,); equally spaced ones in place of None."""
    found = grid(name, np.linspace(0.0, end, GRID) if value is None else value)
    if found[0] < 0 or found[-1] > end * (1 + PLACE_ROUNDING):
        raise ValueError(f"{name} runs from {found[0]:.6g} to {found[-1]:.6g}; keep within 0 to {end:.6g}")
    found = np.minimum(found, end)
    found.setflags(write=False)
    return found
