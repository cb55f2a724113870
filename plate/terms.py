"""How many trial functions: what may be asked for, and what a plate takes if nothing is said.

A long plate has its lowest modes in a row along x, a wide one (a/b < 1) in a row across, and transport couples waves
along x the more, the longer the plate. The numbers that a plate takes by itself therefore follow the aspect ratio. They
give the six lowest natural frequencies to 0.5 % for f0 = 10 at 0.8 of the divergence speed, from a/b = 0.1 to 10, under
loads spread over the whole edge or half of it (tested). More tension, more speed or higher modes need more: double the
numbers and compare.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from periodic.checks import whole_number

# Most trial functions in one direction, most coordinates, and most in-plane functions in one direction: far more than a
# study needs, few enough that a slip does not fill the memory.
MAX_TRANSVERSE_TERMS = 100
MAX_PLATE_COORDINATES = 1000
MAX_INPLANE_TERMS = 50

# Sines along x and polynomials across y of a square plate, and the power of a/b with which they grow and shrink.
SQUARE_TERMS = (4, 7)
TRANSVERSE_POWER = 0.45
# The smallest numbers for a wide plate (sines) and for a long one (polynomials), the largest number of polynomials.
MIN_DEFAULT_SINES = 2
MAX_DEFAULT_POLYNOMIALS = 14

# In-plane functions in each direction of a square plate, the power of a/b with which those along x grow for a long
# plate, and the power of b/a with which those across y grow for a wide one.
SQUARE_INPLANE_TERMS = 9
LONG_INPLANE_POWER = 0.5
WIDE_INPLANE_POWER = 0.25


class Terms(NamedTuple):
    """Numbers of trial functions.

    Attributes
    ----------
    axial : int
        K, sines along x.
    lateral : int
        L + 1, polynomials in y of degree 0 to L.
    inplane : (int, int)
        M + 1 and N + 1, functions of x and of y in each of the in-plane displacements u and v.
    """

    axial: int
    lateral: int
    inplane: tuple[int, int]

    @property
    def coordinates(self) -> int:
        """Number of transverse coordinates, K (L + 1)."""
        return self.axial * self.lateral


def chosen_terms(axial: Any, lateral: Any, inplane: Any, aspect_ratio: float) -> Terms:
    """Return the numbers given, those of the aspect ratio in place of None.

    Raises
    ------
    ValueError
        If a number is not whole or out of range, or there would be too many coordinates.
    """
    default = default_terms(aspect_ratio)
    terms = Terms(
        default.axial if axial is None else whole_number("axial_terms", axial, least=1, most=MAX_TRANSVERSE_TERMS),
        default.lateral
        if lateral is None
        else whole_number("lateral_terms", lateral, least=1, most=MAX_TRANSVERSE_TERMS),
        default.inplane if inplane is None else _inplane_pair(inplane),
    )
    if terms.coordinates > MAX_PLATE_COORDINATES:
        raise ValueError(
            f"axial_terms * lateral_terms = {terms.coordinates} coordinates; give at most {MAX_PLATE_COORDINATES}"
        )
    return terms


def default_terms(aspect_ratio: float) -> Terms:
    """Return the numbers that a plate takes if none are given."""
    r = aspect_ratio
    sines, polynomials = SQUARE_TERMS
    axial = max(MIN_DEFAULT_SINES, math.ceil(sines * r**TRANSVERSE_POWER))
    lateral = max(polynomials, min(MAX_DEFAULT_POLYNOMIALS, math.ceil(polynomials * r**-TRANSVERSE_POWER)))
    along = math.ceil(SQUARE_INPLANE_TERMS * max(r, 1.0) ** LONG_INPLANE_POWER)
    across = math.ceil(SQUARE_INPLANE_TERMS * min(r, 1.0) ** -WIDE_INPLANE_POWER)
    return Terms(
        min(axial, MAX_TRANSVERSE_TERMS), lateral, (min(along, MAX_INPLANE_TERMS), min(across, MAX_INPLANE_TERMS))
    )


def _inplane_pair(value: Any) -> tuple[int, int]:
    """Return ``value`` as numbers of in-plane trial functions along x and across."""
    try:
        axial, lateral = value
    except (TypeError, ValueError):
        raise ValueError(f"inplane_terms = {value!r} is not a pair; give (axial, lateral), such as (9, 9)") from None
    return (
        whole_number("inplane_terms[0]", axial, least=2, most=MAX_INPLANE_TERMS),
        whole_number("inplane_terms[1]", lateral, least=1, most=MAX_INPLANE_TERMS),
    )
