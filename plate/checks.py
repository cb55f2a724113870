"""Checks of the arguments of a plate. Each raises ValueError with argument, value and remedy."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from periodic.checks import FloatArray, grid, real_number, whole_number

# Limits of a/b and of h/b. Beyond those of a/b the smallest stiffness is lost in the rounding of the largest.
ASPECT_RATIO_LIMITS = (1e-3, 1e3)
THICKNESS_RATIO_LIMITS = (0.0, 1.0)

# Largest excitation frequency, dimensionless: its square times any parameter of a plate is still a float.
MAX_FREQUENCY = 1e100

# Most trial functions in one direction, most coordinates, and most in-plane functions in one direction: far more than a
# study needs, few enough that a slip does not fill the memory.
MAX_TRANSVERSE_TERMS = 100
MAX_PLATE_COORDINATES = 1000
MAX_INPLANE_TERMS = 50

# Points in each direction of the default grid of a stress field.
STRESS_GRID_POINTS = 41

# A position beyond the end of the plate by at most this part of its length is taken as the end.
POSITION_TOLERANCE = 1e-12


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
    if number > MAX_FREQUENCY:
        raise ValueError(f"{name} = {number!r} is no plate's; give at most {MAX_FREQUENCY:g}")
    return number


def poisson_ratio(value: Any) -> float:
    """Return ``value`` as a Poisson's ratio, above -1 and at most 0.5."""
    nu = real_number("poisson_ratio", value)
    if not -1 < nu <= 0.5:
        raise ValueError(f"poisson_ratio = {nu!r} is out of range; give -1 < nu <= 0.5")
    return nu


def terms(name: str, value: Any) -> int:
    """Return ``value`` as a number of transverse trial functions in one direction."""
    return whole_number(name, value, least=1, most=MAX_TRANSVERSE_TERMS)


def inplane_terms(value: Any) -> tuple[int, int]:
    """Return ``value`` as numbers of in-plane trial functions along x and across."""
    try:
        axial, lateral = value
    except (TypeError, ValueError):
        raise ValueError(f"inplane_terms = {value!r} is not a pair; give (axial, lateral), such as (9, 9)") from None
    return (
        whole_number("inplane_terms[0]", axial, least=2, most=MAX_INPLANE_TERMS),
        whole_number("inplane_terms[1]", lateral, least=1, most=MAX_INPLANE_TERMS),
    )


def places(name: str, value: ArrayLike | None, end: float) -> FloatArray:
    """Return ``value`` as increasing places from 0 to ``end``, shape (k,); equally spaced ones in place of None."""
    found = grid(name, np.linspace(0.0, end, STRESS_GRID_POINTS) if value is None else value)
    if found[0] < 0 or found[-1] > end * (1 + POSITION_TOLERANCE):
        raise ValueError(f"{name} runs from {found[0]:.6g} to {found[-1]:.6g}; keep within 0 to {end:.6g}")
    found = np.minimum(found, end)
    found.setflags(write=False)
    return found
