"""The systems of references-general.json: independent numbers for general linear periodic systems.

The file was made without this code: its own integrators, checked against SciPy's DOP853, mpmath and closed forms, as
its head says.
"""

from __future__ import annotations

import json
import math
from collections.abc import Collection
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from periodic import AnySystem, FirstOrderSystem, PeriodicSystem, Term, waveforms
from tests.paths import ROOT

MATRICES = {"M": "mass", "K": "stiffness", "A": "state"}


@cache
def references_general() -> dict[str, Any]:
    """Return the file as it is."""
    return dict(json.loads((ROOT / "tests" / "references-general.json").read_text()))


def growth_rates(systems: Collection[str] | None = None) -> list[dict[str, Any]]:
    """Return the entries with a growth rate; those of some systems if any are named."""
    entries = [entry for entry in references_general()["entries"] if entry["quantity"] == "growth_rate"]
    return entries if systems is None else [entry for entry in entries if entry["system"] in systems]


@dataclass(frozen=True)
class Reference:
    """A family of the file, valid at one amplitude: some of them hold terms that are no power of eps."""

    name: str
    eps: float = 1.0

    @property
    def amplitude(self) -> float:
        """The amplitude to integrate at: 1 where the file has eps = 0 and a system that depends on time without it."""
        terms = references_general()["systems"][self.name].get("terms", [])
        without = any(term["trig"] != "const" and not term["eps_power"] for term in terms)
        return 1.0 if without and not self.eps else self.eps

    def at(self, Omega: float) -> AnySystem:
        """Return the system at a frequency."""
        system = references_general()["systems"][self.name]
        return _pieces(system, self.eps) if "pieces" in system else _terms(system, Omega, self.eps)


def _terms(system: dict[str, Any], Omega: float, eps: float) -> AnySystem:
    n = system["n"]
    constant = {name: np.zeros((n, n)) for name in ("mass", "gyroscopic", "damping", "stiffness", "state")}
    terms = []
    for term in system["terms"]:
        X = Omega ** term["Omega_power"] * np.array(term["value"])
        of = {MATRICES[term["matrix"]]: X} if term["matrix"] != "C" else _split(X)
        for name, matrix in of.items() if eps or not term["eps_power"] else ():
            if not term["eps_power"] and term["trig"] == "const":
                constant[name] += matrix
            elif matrix.any():
                wave = {"const": lambda _: waveforms.constant(), "cos": waveforms.cosine, "sin": waveforms.sine}
                g, power = wave[term["trig"]](term["harmonic"]), term["eps_power"]
                # what depends on time without eps has its own amplitude
                terms.append(Term(name, matrix, g, power) if power else Term(name, matrix / (eps or 1.0), g))
    A = constant.pop("state")
    return FirstOrderSystem(A, terms=terms) if system["order"] == 1 else PeriodicSystem(**constant, terms=terms)


def _pieces(system: dict[str, Any], eps: float) -> PeriodicSystem:
    first, *others = system["pieces"]
    n = system["n"]
    terms, start = [], first["fraction"]
    if "K_eps" in first:
        # K_eps = the mean of two pieces + half their difference times a rectangular wave
        (second,) = others
        one, two = np.array(first["K_eps"]), np.array(second["K_eps"])
        assert (first["K"], first["C"]) == (second["K"], second["C"])
        terms.append(Term("stiffness", (one - two) / 2, waveforms.rectangular(start)))
        if (one + two).any():
            terms.append(Term("stiffness", (one + two) / 2, waveforms.constant()))
    for kick in system["kicks"] or []:
        if "velocity_from_position_eps" in kick:
            Q = -np.array(kick["velocity_from_position_eps"])
            terms.append(Term("stiffness", Q, waveforms.impulses([kick["at"]], [1.0])))
        else:
            assert kick["velocity_from_velocity_eps"] == [[1]]
            Q = np.array([[-math.log1p(eps) / eps]])
            terms.append(Term("damping", Q, waveforms.impulses([kick["at"]], [1.0])))
    constant = {"damping": np.array(first["C"], float), "stiffness": np.array(first["K"], float)}
    assert constant["stiffness"].shape == (n, n)
    return PeriodicSystem(np.array(first["M"], float), **constant, terms=terms)


def _split(X: np.ndarray) -> dict[str, np.ndarray]:
    return {"gyroscopic": (X - X.T) / 2, "damping": (X + X.T) / 2}
