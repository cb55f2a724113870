"""One plate with one parameter changed: for sweeps, and for the sliders of the live page."""

from __future__ import annotations

import json
from typing import Any

from compare.files import Case, Load, Plate
from periodic.checks import one_of, real_number

# What `varied` changes: numbers of the plate, and for a sweep also the width of the load.
PLATE_NUMBERS = ("speed", "tension", "damping", "aspect_ratio", "poisson_ratio", "thickness_ratio")
SWEEPABLE = (*PLATE_NUMBERS, "width")


def plate_table(case: Case, label: str | None = None) -> tuple[str, Plate]:
    """Return label and complete table of one variant of a case: of the first one if ``label`` is None.

    Raises
    ------
    ValueError
        If no variant has this label, or the case is about a beam.
    """
    if case.beam is not None:
        raise ValueError(f"sweeps and sliders vary a plate, and the case {case.name!r} is about a beam; give a plate's")
    variants = {variant.label: variant for variant in case.variants}
    chosen = case.variants[0].label if label is None else one_of("variant", label, tuple(variants))
    merged = case.plate.model_dump(exclude_none=True, mode="json") | variants[chosen].plate
    return chosen, Plate.model_validate_json(json.dumps(merged))


def varied(plate: Plate, name: str, value: Any) -> Plate:
    """Return the plate table with one entry changed.

    Parameters
    ----------
    plate : Plate
        Table of a case file.
    name : str
        A number of the plate, "width", "waveform" or "harmonics". With "width" the load is spread evenly over that part
        of the edge, about the centre that it had.
    value : float, str or int
        The new value. Whether there is such a plate shows when the table is built.

    Raises
    ------
    ValueError
        If ``name`` is unknown, or a number is not finite.
    """
    one_of("name", name, (*SWEEPABLE, "waveform", "harmonics"))
    if name in PLATE_NUMBERS:
        return plate.model_copy(update={name: real_number(name, value)})
    return plate.model_copy(update={"load": _varied_load(plate.load, name, value)})


def _varied_load(load: Load, name: str, value: Any) -> Load:
    if name != "width":
        return load.model_copy(update={name: value})
    centre = load.parameters.get("centre", 0.5) if load.shape == "partial" else 0.5
    return load.model_copy(
        update={"shape": "partial", "parameters": {"width": real_number("width", value), "centre": centre}}
    )


def current(plate: Plate) -> dict[str, Any]:
    """Return the value of everything that `varied` can change, defaults included."""
    built = plate.build()
    width = plate.load.parameters.get("width", 1.0) if plate.load.shape == "partial" else 1.0
    waveform = plate.load.waveform if isinstance(plate.load.waveform, str) else "custom"
    return {name: getattr(built, name) for name in PLATE_NUMBERS} | {
        "width": width,
        "waveform": waveform,
        "harmonics": built.load.harmonics,
    }
