"""Units of axes: what the numbers of a system are multiplied by, and what stands on the axis."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

# Multiples of an angular frequency in rad/s.
FREQUENCY_UNITS = {"rad/s": 1.0, "Hz": 1 / (2 * np.pi), "rpm": 60 / (2 * np.pi)}


class Units(NamedTuple):
    """Factors of frequencies, growth rates, times and stress resultants, and the units behind their names."""

    frequency: float = 1.0
    rate: float = 1.0
    time: float = 1.0
    stress: float = 1.0
    frequency_unit: str = ""
    rate_unit: str = ""
    time_unit: str = ""
    stress_unit: str = ""

    def label(self, name: str, of: str) -> str:
        """Return ``name`` with the unit of ``of``: "frequency", "rate", "time" or "stress"."""
        unit = getattr(self, f"{of}_unit")
        return f"{name} ({unit})" if unit else name


def units_of(units: Any) -> Units:
    """Return the units that ``units`` names.

    Parameters
    ----------
    units : None, str or plate in SI units
        None: numbers as they are. "Hz", "rpm" or "rad/s": of a system whose unit of time is the second. A plate made by
        ``MovingPlate.from_si``: of its dimensionless numbers, in Hz, s and N/m.

    Raises
    ------
    ValueError
        If it is none of these.
    """
    if units is None:
        return Units()
    if isinstance(units, str) and units in FREQUENCY_UNITS:
        return Units(frequency=FREQUENCY_UNITS[units], frequency_unit=units, rate_unit="1/s", time_unit="s")
    if hasattr(units, "frequency_unit") and hasattr(units, "tension_unit"):
        rate = units.frequency_unit  # raises where the plate has no SI units
        return Units(rate / (2 * np.pi), rate, 1 / rate, units.tension_unit, "Hz", "1/s", "s", "N/m")
    raise ValueError(f"units = {units!r} is not known; give 'Hz', 'rpm', 'rad/s', or a plate made by from_si")


def show_frequency(axes: Axes, units: Any) -> None:
    """Label the horizontal axis of a finished picture, whose numbers stay as they are, in other units of frequency."""
    scale = units_of(units)
    axes.set_xlabel(scale.label("excitation frequency" + ("" if scale.frequency_unit else " Ω"), "frequency"))
    if scale.frequency == 1:
        return
    low, high = axes.get_xlim()
    places = MaxNLocator(steps=[1, 2, 2.5, 5, 10]).tick_values(low * scale.frequency, high * scale.frequency)
    inside = [place for place in places if low * scale.frequency <= place <= high * scale.frequency]
    axes.set_xticks([place / scale.frequency for place in inside], [f"{place:.6g}" for place in inside])
