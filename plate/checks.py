"""Checks of the arguments of a plate. Each raises ValueError with argument, value and remedy."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from periodic.checks import FloatArray, grid, real_number

# Limits of a/b and of h/b. Beyond those of a/b the smallest stiffness is lost in the rounding of the largest.
ASPECT_RATIO_LIMITS = (1e-3, 1e3)
THICKNESS_RATIO_LIMITS = (0.0, 1.0)

# Largest excitation frequency, dimensionless: its square times any parameter of a plate is still a float.
MAX_FREQUENCY = 1e100

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


def held_at(value: Any, aspect_ratio: float, inplane: str) -> float | None:
    """Return ``value`` as a place from 0 to a/b where the tension of an accelerating web is prescribed, or None."""
    if value is None:
        return None
    place = real_number("tension_held_at", value)
    if not 0 <= place <= aspect_ratio:
        raise ValueError(
            f"tension_held_at = {place!r} is out of range; give a place from 0 to {aspect_ratio:g}, or None"
        )
    if inplane != "membrane":
        raise ValueError(
            f"tension_held_at = {place!r} is for inplane='membrane': the in-plane problem of {inplane!r} takes the "
            "same load at both ends; leave it out, or take 'membrane'"
        )
    return place


def places(name: str, value: ArrayLike | None, end: float) -> FloatArray:
    """Return ``value`` as increasing places from 0 to ``end``, shape (k,); equally spaced ones in place of None."""
    found = grid(name, np.linspace(0.0, end, STRESS_GRID_POINTS) if value is None else value)
    if found[0] < 0 or found[-1] > end * (1 + POSITION_TOLERANCE):
        raise ValueError(f"{name} runs from {found[0]:.6g} to {found[-1]:.6g}; keep within 0 to {end:.6g}")
    found = np.minimum(found, end)
    found.setflags(write=False)
    return found
