"""Case files: which system, which window, which regions; TOML in, checked Python out."""

from __future__ import annotations

import json
import math
import tomllib
from importlib.resources import files
from pathlib import Path
from typing import Annotated, Any, Literal, TypeVar

from pydantic import BaseModel, ConfigDict, Field, PlainValidator, PositiveInt, ValidationError, model_validator

from beam import MovingBeam
from compare.files.quantities import SI_KEYS, plate_in_si, si_properties
from compare.files.spelling import did_you_mean
from plate import EdgeLoad, MovingPlate

_T = TypeVar("_T", bound=BaseModel)
FiniteFloat = Annotated[float, Field(allow_inf_nan=False)]


def _amount(value: Any) -> float | str | None:
    if value is None or isinstance(value, str):
        return value
    if isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value):
        return float(value)
    raise ValueError("give a finite number, or a text with a unit")


# Dimensionless as a number, or a text with any unit.
Amount = Annotated[Any, PlainValidator(_amount)]
# Columns or rows of a chart. More than any screen has; a slip of the pen does not fill the memory.
MAX_CHART_POINTS = 10_000
Points = Annotated[int, Field(ge=2, le=MAX_CHART_POINTS)]
# The names of result files begin with it; without a slash, these stay in their folder.
FileName = Annotated[str, Field(pattern=r"^[^/\\\x00-\x1f]*$", max_length=100)]

# Pairs of modes, from 1, whose regions the paper shows: those of its three lowest modes.
STANDARD_REGIONS = [(1, 1), (2, 2), (3, 3), (1, 2), (1, 3), (2, 3)]
# Variants of a case: the pictures have as many colours that every reader can tell apart.
MAX_VARIANTS = 4


class _Table(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)


class Load(_Table):
    """Distribution over the edge and waveform in time of the excitation, eqs. (7) and (29)."""

    shape: Literal["uniform", "linear", "partial", "parabolic", "cosine", "samples"] = "uniform"
    parameters: dict[str, FiniteFloat | list[FiniteFloat]] = {}
    waveform: Literal["cosine", "square", "triangle", "sawtooth"] | dict[int, tuple[FiniteFloat, FiniteFloat]] = (
        "cosine"
    )
    harmonics: PositiveInt = 1

    def build(self) -> EdgeLoad:
        """Return the load. Raises ValueError for parameters that the shape does not take."""
        make = EdgeLoad.from_samples if self.shape == "samples" else getattr(EdgeLoad, self.shape)
        try:
            load = make(**self.parameters)
        except TypeError as error:
            raise ValueError(f"shape = {self.shape!r} does not take these parameters: {error}") from None
        if isinstance(self.waveform, str):
            return load.with_waveform(self.waveform, harmonics=self.harmonics)
        return load.with_waveform(self.waveform)


class Plate(_Table):
    """The arguments of `plate.MovingPlate`, or SI properties; what is left out keeps that class's default."""

    length: str | None = None
    width: str | None = None
    thickness: str | None = None
    density: str | None = None
    areal_density: str | None = None
    youngs_modulus: str | None = None
    length_m: FiniteFloat | None = None
    width_m: FiniteFloat | None = None
    thickness_m: FiniteFloat | None = None
    density_kg_per_m3: FiniteFloat | None = None
    areal_density_kg_per_m2: FiniteFloat | None = None
    youngs_modulus_Pa: FiniteFloat | None = None
    speed_m_per_s: FiniteFloat | None = None
    tension_N_per_m: FiniteFloat | None = None
    damping_s: FiniteFloat | None = None
    aspect_ratio: FiniteFloat | None = None
    speed: Amount = None
    tension: Amount = None
    damping: Amount = None
    poisson_ratio: FiniteFloat | None = None
    thickness_ratio: FiniteFloat | None = None
    inplane: Literal["membrane", "static", "dynamic"] | None = None
    axial_terms: PositiveInt | None = None
    lateral_terms: PositiveInt | None = None
    inplane_terms: tuple[int, int] | None = None
    speed_amplitude: FiniteFloat | None = None
    load_amplitude: FiniteFloat | None = None
    derivative: Literal["partial", "material"] | None = None
    load: Load = Load()

    def build(self) -> MovingPlate:
        """Return the plate. Raises ValueError as `plate.MovingPlate` does."""
        given: dict[str, Any] = self.model_dump(exclude_none=True, exclude={"load"})
        properties = si_properties(given)
        if not properties:
            return MovingPlate(**given, load=self.load.build())
        keys = {*SI_KEYS, *(key for key, _ in SI_KEYS.values())}
        others = {"poisson_ratio": MovingPlate.poisson_ratio} | {k: v for k, v in given.items() if k not in keys}
        return plate_in_si(properties, others | {"load": self.load.build()})


class Beam(_Table):
    """The arguments of `beam.MovingBeam`; what is left out keeps that class's default."""

    speed: FiniteFloat
    flexural_rigidity: FiniteFloat
    damping: FiniteFloat | None = None
    terms: PositiveInt | None = None
    speed_amplitude: FiniteFloat | None = None
    tension_amplitude: FiniteFloat | None = None
    derivative: Literal["partial", "material", "strong"] | None = None
    viscous_damping: FiniteFloat | None = None

    def build(self) -> MovingBeam:
        """Return the beam. Raises ValueError as `beam.MovingBeam` does."""
        return MovingBeam(**self.model_dump(exclude_none=True))


class Chart(_Table):
    """Window and resolution of the wide chart."""

    Omega: tuple[FiniteFloat, FiniteFloat] = (5.0, 90.0)
    Omega_Hz: tuple[FiniteFloat, FiniteFloat] | None = None
    eps: Annotated[float, Field(gt=0, allow_inf_nan=False)] = 0.4
    points: tuple[Points, Points] = (256, 128)

    @model_validator(mode="after")
    def _ordered(self) -> Chart:
        name, window = ("Omega", self.Omega) if self.Omega_Hz is None else ("Omega_Hz", self.Omega_Hz)
        if not 0 < window[0] < window[1]:
            raise ValueError(f"{name} = {list(window)} is no window; give 0 < low < high")
        if self.Omega_Hz is not None and "Omega" in self.model_fields_set:
            raise ValueError("Omega and Omega_Hz say the same; keep one")
        return self


class Variant(_Table):
    """One of the systems that a case compares: the case's plate or beam with some entries replaced."""

    label: str
    plate: dict[str, Any] = {}
    beam: dict[str, Any] = {}


class Case(_Table):
    """One figure: a plate or a beam in one or more variants, a window, and the regions to look at closely."""

    name: FileName = ""
    title: str
    compare: Literal["within", "beside"] = "within"
    plate: Plate = Plate()
    beam: Beam | None = None
    chart: Chart = Chart()
    regions: Annotated[list[tuple[PositiveInt, PositiveInt]], Field(min_length=1)] = STANDARD_REGIONS
    variants: list[Variant] = [Variant(label="")]

    @model_validator(mode="after")
    def _of_one_model(self) -> Case:
        of_plates = "plate" in self.model_fields_set or any(variant.plate for variant in self.variants)
        if self.beam is not None and of_plates:
            raise ValueError("the case has tables for a plate and for a beam; a case is about one of them")
        if self.beam is None and any(variant.beam for variant in self.variants):
            raise ValueError("a variant changes the beam, but the case has no [beam]; add it")
        return self

    @model_validator(mode="after")
    def _distinct(self) -> Case:
        labels = [variant.label for variant in self.variants]
        if not 1 <= len(labels) <= MAX_VARIANTS or len(set(labels)) < len(labels):
            raise ValueError(f"variants have the labels {labels}; give 1 to {MAX_VARIANTS}, each with its own label")
        return self

    def systems(self) -> dict[str, MovingPlate | MovingBeam]:
        """Return each variant's plate or beam under its label.

        Raises
        ------
        ValueError
            If a variant's table has an unknown key or a value out of range, or its system has fewer modes than
            ``regions`` names; the message names the variant.
        """
        return {variant.label: self._system(variant) for variant in self.variants}

    def plates(self, what: str) -> dict[str, MovingPlate]:
        """Return each variant's plate under its label, for ``what``, which is about plates.

        Raises
        ------
        ValueError
            As `systems`, or if the case is about a beam.
        """
        if self.beam is not None:
            raise ValueError(f"{what} is about plates, and the case {self.name!r} is about a beam; give a plate's case")
        return {label: system for label, system in self.systems().items() if isinstance(system, MovingPlate)}

    @property
    def units(self) -> MovingPlate | None:
        """The plate whose SI units the results are in; None if the case is dimensionless."""
        first = next(iter(self.systems().values()))
        return first if isinstance(first, MovingPlate) and first.si is not None else None

    @property
    def window(self) -> tuple[float, float]:
        """Excitation frequencies of the chart, in the units of the system's matrices.

        Raises
        ------
        ValueError
            If they are given in Hz and the plate is not in SI units.
        """
        if self.chart.Omega_Hz is None:
            return self.chart.Omega
        if self.units is None:
            raise ValueError("[chart] Omega_Hz needs a plate in SI units; give its length_m and so on, or Omega")
        low, high = (2 * math.pi * frequency / self.units.frequency_unit for frequency in self.chart.Omega_Hz)
        return low, high

    def _system(self, variant: Variant) -> MovingPlate | MovingBeam:
        model = "plate" if self.beam is None else "beam"
        changes: dict[str, Any] = getattr(variant, model)
        where = f"[variants.{model}] of {variant.label!r}" if changes else f"[{model}]"
        table = self.plate if self.beam is None else self.beam
        merged = table.model_dump(exclude_none=True, mode="json") | changes
        try:
            system = _strictly(type(table), merged).build()
        except ValidationError as error:
            raise ValueError(_explain(error, where, type(table))) from None
        except ValueError as error:
            raise ValueError(f"{where}: {error}") from None
        count = system.terms.coordinates if isinstance(system, MovingPlate) else system.terms
        highest = max(map(max, self.regions))
        if highest > count:
            raise ValueError(f"regions names mode {highest}, but the {model} of {where} has {count} modes only")
        return system


def shipped_cases() -> list[Path]:
    """Return the case files that come with the package, sorted by name."""
    return sorted(Path(str(file)) for file in files("floquet_cases").iterdir() if file.name.endswith(".toml"))


def load_case(path: str | Path) -> Case:
    """Read a case file.

    Parameters
    ----------
    path : str or Path
        A TOML file, whose tables and keys docs/cases.md lists; or the name of a shipped case, such as "fig4".

    Returns
    -------
    Case
        Checked, its ``name`` the file's stem. Every variant's system has been built once.

    Raises
    ------
    ValueError
        If the file cannot be read, is not TOML, or a key is unknown, missing or out of range; the message names file,
        table and key.
    """
    path = _found(Path(path))
    try:
        data = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        shipped = [case.stem for case in shipped_cases()]
        remedy = f"give the path of a case file, or the name of one that is shipped: {', '.join(shipped)}"
        suggestion = did_you_mean(str(path), shipped)
        raise ValueError(f"{path}: cannot be read ({error.strerror}); {remedy}{suggestion}") from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise ValueError(f"{path}: not a TOML file: {error}") from None
    try:
        case = _strictly(Case, {"name": path.stem} | data)
        _ = case.systems(), case.window
    except ValidationError as error:
        raise ValueError(_explain(error, str(path), Case)) from None
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None
    return case


def _strictly(model: type[_T], data: dict[str, Any]) -> _T:
    """Validate by pydantic's rules for JSON: arrays become tuples, but no text becomes a number."""
    return model.model_validate_json(json.dumps(data, default=str))


def _found(path: Path) -> Path:
    """Return the shipped case of a bare name that is no file here; all else as it is."""
    if path.exists() or path.suffix or path.parent != Path():
        return path
    return next((case for case in shipped_cases() if case.stem == path.name), path)


def _explain(error: ValidationError, where: str, model: type[BaseModel]) -> str:
    """Return one line for each fault of a ``model``: file, [table], key, what is wrong and what was given."""
    tables: dict[str, type[BaseModel]] = {
        "plate": Plate,
        "beam": Beam,
        "load": Load,
        "chart": Chart,
        "variants": Variant,
    }
    lines = []
    for fault in error.errors(include_url=False):
        place = [str(step) for step in fault["loc"]]
        table = f"[{'.'.join(place[:-1])}] " if place[:-1] else ""
        key = place[-1] if place else "file"
        if fault["type"] == "extra_forbidden":
            name = next((step for step in reversed(place[:-1]) if step in tables), None)
            known = (model if name is None else tables[name]).model_fields
            what = f"unknown key; remove it or mend its spelling{did_you_mean(place[-1], known)}"
        elif fault["type"] == "missing":
            what = "missing; add it"
        elif fault["type"] == "value_error":  # one of ours, which says what was given
            what = str(fault["ctx"]["error"])
        else:
            what = f"{fault['msg']} (given: {fault['input']!r})"
        lines.append(f"{where}: {table}{key}: {what}")
    return "\n".join(lines)
