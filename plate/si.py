"""The way from dimensionless to SI units, eq. (12)."""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass

from periodic.checks import real_number

# Rubber has a thousand times as much. A smaller modulus was probably given in GPa or MPa.
SOFTEST_MODULUS = 1e4


class SoftMaterialWarning(UserWarning):
    """A modulus so small that it was probably given in another unit."""


@dataclass(frozen=True)
class SIProperties:
    """What a dimensionless plate does not know about itself: its width and material in SI units.

    Warns with `SoftMaterialWarning` of a modulus that was probably not given in Pa.

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
        if self.youngs_modulus < SOFTEST_MODULUS:
            warnings.warn(
                f"youngs_modulus = {self.youngs_modulus!r} Pa is that of a jelly; give it in Pa: steel has 206e9",
                SoftMaterialWarning,
                stacklevel=3,
            )

    def units(self, thickness_ratio: float, nu: float) -> tuple[float, float]:
        """Return the units of time, sqrt(rho h b^4 / D) in s, and of tension, D / b^2 in N/m, of eq. (12)."""
        h, b2 = thickness_ratio * self.width, self.width * self.width
        D = real_number("bending stiffness", self.youngs_modulus * h * h * h / (12 * (1 - nu**2)), positive=True)
        time = real_number("time unit", math.sqrt(self.density * h / D) * b2, positive=True)
        return time, real_number("tension unit", D / b2, positive=True)


class InSI:
    """What leads a model with a width, a thickness and an ``si`` from dimensionless to SI units."""

    si: SIProperties | None
    thickness_ratio: float
    poisson_ratio: float

    @property
    def length_unit(self) -> float:
        """Length in m of one unit: b."""
        return self._si.width

    @property
    def time_unit(self) -> float:
        """Time in s of one unit, sqrt(rho h b^4 / D); also the unit of ``damping``."""
        return self._si.units(self.thickness_ratio, self.poisson_ratio)[0]

    @property
    def frequency_unit(self) -> float:
        """Angular frequency in rad/s of one unit; also the unit of growth rates in 1/s."""
        return 1 / self.time_unit

    @property
    def speed_unit(self) -> float:
        """Speed in m/s of one unit."""
        return self.length_unit / self.time_unit

    @property
    def tension_unit(self) -> float:
        """Force per width in N/m of one unit, D / b^2; also the unit of stress resultants."""
        return self._si.units(self.thickness_ratio, self.poisson_ratio)[1]

    @property
    def _si(self) -> SIProperties:
        if self.si is None:
            raise ValueError("this plate has no SI units; build it with MovingPlate.from_si")
        return self.si
