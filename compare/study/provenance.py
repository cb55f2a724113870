"""How a report was made: version, date, command and parameters, so that it can be made again."""

from __future__ import annotations

import hashlib
import shlex
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import numpy as np

from beam import MovingBeam
from compare.study.study import Study
from floquet.running import source_hash
from periodic import AnyFamily, FirstOrderSystem
from plate import EdgeLoad, MovingPlate

# Characters of a hash that are printed: enough to tell one state from another.
HASH_CHARACTERS = 12
# Parameters of a plate that it chooses where they are left out.
TERM_NAMES = ("axial_terms", "lateral_terms", "inplane_terms")
# Places across the edge, as parts of the width, at which a load is described.
DESCRIBED_PLACES = np.array([0.0, 0.25, 0.5, 0.75, 1.0])


@dataclass(frozen=True)
class Provenance:
    """How a report was made.

    Attributes
    ----------
    version : str
        Of the program, with the hash of the code that integrates.
    date : str
        Day, time and zone (UTC).
    command : str
        Command line of the process, as a shell takes it.
    parameters : tuple of (str, str)
        Each system's title, and its parameters, window and grid.
    """

    version: str
    date: str
    command: str
    parameters: tuple[tuple[str, str], ...]


def provenance(studies: Sequence[Study]) -> Provenance:
    """Return how the studies of this process were made."""
    try:
        installed = version("floquet-charts")
    except PackageNotFoundError:  # run from its sources
        installed = "not installed"
    return Provenance(
        f"{installed}, code {source_hash()[:HASH_CHARACTERS]}",
        f"{datetime.now(UTC):%Y-%m-%d %H:%M} UTC",
        shlex.join([Path(sys.argv[0]).name, *sys.argv[1:]]),
        tuple(
            (", ".join(filter(None, (study.subject.title, label))), _described(study, family))
            for study in studies
            for label, family in study.subject.systems.items()
        ),
    )


def _described(study: Study, family: AnyFamily) -> str:
    low, high = study.subject.window
    window = f"Ω from {low:g} to {high:g}, ε to {study.subject.eps:g}"
    if isinstance(family, MovingBeam):
        return f"{_numbers(family, {})}; {window}"
    if not isinstance(family, MovingPlate):
        member = family.at(high)
        digest = hashlib.sha256()
        first = isinstance(member, FirstOrderSystem)
        for name in ("constant",) if first else ("mass", "gyroscopic", "damping", "stiffness"):
            digest.update(np.ascontiguousarray(getattr(member, name)).tobytes())
        for name in ("cosine", "sine"):
            digest.update(np.ascontiguousarray(getattr(member, name)).tobytes())
        for term in member.terms:
            digest.update(repr((term.of, term.power, term.waveform)).encode())
            digest.update(np.ascontiguousarray(term.matrix).tobytes())
        size = f"n = {member.size}, {_harmonics(len(member.cosine))}, matrices {digest.hexdigest()[:HASH_CHARACTERS]}"
        return f"{size}; {window}"
    terms = family.terms  # those that were used, also where the plate chose them
    used = dict(zip(TERM_NAMES, (terms.axial, terms.lateral, terms.inplane), strict=True))
    return f"{_numbers(family, used)}; {_load(family.load)}; {window}"


def _numbers(model: MovingPlate | MovingBeam, used: Mapping[str, object]) -> str:
    """Return the parameters of a model that are numbers or words, those of ``used`` as they were used."""
    values = ((field.name, used.get(field.name, getattr(model, field.name))) for field in fields(model))
    return ", ".join(f"{name} = {value}" for name, value in values if isinstance(value, int | float | str | tuple))


def _load(load: EdgeLoad) -> str:
    shape = ", ".join(f"{value:.4g}" for value in load.static(DESCRIBED_PLACES))
    return f"static load over its mean at y/b = 0, ¼, ½, ¾, 1: {shape}; {_harmonics(load.harmonics)}"


def _harmonics(number: int) -> str:
    return "1 harmonic" if number == 1 else f"{number} harmonics"
