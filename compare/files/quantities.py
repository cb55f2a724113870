"""Plates in SI units: keys that name their unit, and quantities written with any unit. Units end at this border."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from typing import Any

from plate import MovingPlate

# What a plate in SI units is made of: argument of `MovingPlate.from_si`, its key in a case file, its unit.
SI_KEYS = {
    "length": ("length_m", "m"),
    "width": ("width_m", "m"),
    "thickness": ("thickness_m", "m"),
    "density": ("density_kg_per_m3", "kg/m^3"),
    "areal_density": ("areal_density_kg_per_m2", "kg/m^2"),
    "youngs_modulus": ("youngs_modulus_Pa", "Pa"),
    "speed": ("speed_m_per_s", "m/s"),
    "tension": ("tension_N_per_m", "N/m"),
    "damping": ("damping_s", "s"),
}
# Those that a plate cannot do without; of the two densities one.
REQUIRED = ("length", "width", "thickness", "youngs_modulus", "speed", "tension")
# Dimensionless keys that say the same.
DIMENSIONLESS = ("aspect_ratio", "thickness_ratio", "speed", "tension", "damping")


def si_properties(table: Mapping[str, Any]) -> dict[str, float]:
    """Return the SI properties of a plate's table as numbers in SI units; empty if it is dimensionless.

    A property is a number under the key that names its unit (``length_m = 0.1``), or a text with any unit
    (``length = "10 cm"``).

    Raises
    ------
    ValueError
        If a property is given twice, is missing, has another dimension, or stands beside dimensionless ones.
    """
    found: dict[str, float] = {}
    for name, (key, unit) in SI_KEYS.items():
        text = table.get(name) if isinstance(table.get(name), str) else None
        if table.get(key) is not None and text is not None:
            raise ValueError(f"{key} and {name} say the same; keep one")
        if table.get(key) is not None:
            found[name] = table[key]
        elif text is not None:
            found[name] = in_unit(name, text, unit)
    if not found:
        return {}
    for key in DIMENSIONLESS:
        if table.get(key) is not None and not isinstance(table[key], str):
            raise ValueError(f"{key} is dimensionless and {_key(next(iter(found)))} is in SI units; give all in one")
    if ("density" in found) == ("areal_density" in found):
        raise ValueError(f"give one of {_key('density')} and {_key('areal_density')}")
    missing = [_key(name) for name in REQUIRED if name not in found]
    if missing:
        raise ValueError(f"{missing[0]} is missing; a plate in SI units needs it")
    if "areal_density" in found:
        found["density"] = found.pop("areal_density") / found["thickness"]
    return found


def plate_in_si(properties: Mapping[str, float], others: Mapping[str, Any]) -> MovingPlate:
    """Return the plate with these SI properties."""
    return MovingPlate.from_si(**properties, **others)


def in_unit(name: str, text: str, unit: str) -> float:
    """Return a quantity such as "10 cm" in another unit.

    Raises
    ------
    ValueError
        If pint is not installed, or the text is no quantity of that dimension.
    """
    try:
        registry = _registry()
    except ImportError:
        raise ValueError(
            f"{name} = {text!r} has a unit, which needs pint: pip install 'floquet-charts[units]'; "
            f"or give {_key(name)} as a number"
        ) from None
    try:
        return float(registry(text).to(unit).magnitude)
    except Exception as error:  # pint raises errors of many types for what it cannot read
        raise ValueError(f"{name} = {text!r} is no quantity in {unit} ({error}); give one") from None


@cache
def _registry() -> Any:
    """Return pint's table of units, which takes half a second to make."""
    import pint

    return pint.UnitRegistry()


def _key(name: str) -> str:
    return SI_KEYS[name][0]
