"""The way from dimensionless to SI units, eq. (12)."""

from __future__ import annotations

import math
from dataclasses import dataclass

from periodic.checks import real_number


@dataclass(frozen=True)
class SIProperties:
    """What a dimensionless plate does not know about itself: its width and material in SI units.

    Parameters
    ----------
    width : float
        b in m.
    density : float
        rho in kg/m^3.
    youngs_modulus : float
        E in Pa.

    Raises
    ------
    ValueError
        If a property is not a positive number.
    """

    width: float
    density: float
    youngs_modulus: float

    def __post_init__(self) -> None:
        for name in ("width", "density", "youngs_modulus"):
            object.__setattr__(self, name, real_number(name, getattr(self, name), positive=True))

    def units(self, thickness_ratio: float, nu: float) -> tuple[float, float]:
        """Return the units of time, sqrt(rho h b^4 / D) in s, and of tension, D / b^2 in N/m, of eq. (12)."""
        h, b2 = thickness_ratio * self.width, self.width * self.width
        D = real_number("bending stiffness", self.youngs_modulus * h * h * h / (12 * (1 - nu**2)), positive=True)
        time = real_number("time unit", math.sqrt(self.density * h / D) * b2, positive=True)
        return time, real_number("tension unit", D / b2, positive=True)
