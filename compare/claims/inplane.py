"""The paper's claims on the in-plane problem (section IV on Fig. 3; conclusion 2)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import product

import numpy as np

from compare.claims.evidence import ClaimVerdict, Finding, judged
from compare.claims.quantities import distance, middle, number, regions, width
from compare.claims.survey import ClaimRange, NamedPlate, some
from plate import EdgeLoad, MovingPlate

# Stresses that differ by less than this part of the mean load (root mean square over the plate) are the same stress.
STRESS_TOLERANCE = 0.01
# Widths that differ by less than this part look the same in a figure.
WIDTH_TOLERANCE = 0.02


def stress_equals_linear_load(study: ClaimRange) -> ClaimVerdict:
    """Judge "under linearly distributed load the in-plane stresses equal the load"."""
    loads = {"uniform load": EdgeLoad.uniform(), "load rising from 0.5 to 1.5": EdgeLoad.linear(0.5, 1.5)}
    findings = []
    for nu, r, (load_name, load) in product(study.poisson_ratios, study.aspect_ratios, loads.items()):
        plate = replace(study.plate, aspect_ratio=r, poisson_ratio=nu, load=load, inplane="static")
        name = f"a/b = {r:g}, nu = {nu:g}, {load_name}"
        findings.append(
            Finding(
                f"nu = {nu:g}: stresses",
                number(f"mean error of the stresses, {name}", _stress_error(plate)),
                number(f"{STRESS_TOLERANCE:.0%} of the mean load", STRESS_TOLERANCE),
            )
        )
        findings += _widths(
            f"nu = {nu:g}: widths of regions",
            NamedPlate(f"{name}, stress equal to the load", replace(plate, inplane="membrane")),
            NamedPlate(f"{name}, in-plane problem solved", plate),
            study,
        )
    return judged(
        "Stress equals a linear load",
        "Under a linearly distributed edge load the in-plane stress resultants equal the load (section IV on Fig. 3; "
        "conclusion 2).",
        f"static in-plane problem; a/b = {some(study.aspect_ratios)}; nu = {some(study.poisson_ratios)}; "
        f"V = {study.plate.speed:g}; f0 = {study.plate.tension:g}; loads: {', '.join(loads)}; same within "
        f"{STRESS_TOLERANCE:.0%} (stress, root mean square over the plate) and {WIDTH_TOLERANCE:.0%} (widths)",
        findings,
    )


def inertia_hardly_matters(study: ClaimRange) -> ClaimVerdict:
    """Judge "regions with and without in-plane inertia have almost the same size" for thin plates.

    The paper's case without inertia is the membrane, N_xx = f, which leaves out the Poisson restraint too.
    """
    findings = []
    for h in study.thickness_ratios:
        for without, model in (("in-plane problem without inertia", "static"), ("the paper's N_xx = f", "membrane")):
            for name, plate in _models(study, h):
                findings += _widths(
                    f"h/b = {h:g}, against {without}",
                    NamedPlate(f"{name}, {without}", replace(plate, inplane=model)),
                    NamedPlate(f"{name}, h/b = {h:g}, with inertia", plate),
                    study,
                )
    return judged(
        "In-plane inertia hardly matters",
        "The sizes of unstable regions with and without in-plane inertia are almost the same for a thin plate "
        "(section IV on Fig. 3; conclusion 2).",
        f"{_scope(study)}; the same within {WIDTH_TOLERANCE:.0%}",
        findings,
    )


def inertia_shifts_regions(study: ClaimRange) -> ClaimVerdict:
    """Judge "the positions may be shifted a little due to in-plane inertia", held against the Poisson restraint."""
    findings = []
    for h in study.thickness_ratios:
        for name, plate in _models(study, h):
            with_inertia, static, membrane = (
                regions(f"{name}, {model}", replace(plate, inplane=model), study.eps, modes=study.modes)
                for model in ("dynamic", "static", "membrane")
            )
            for pair, region in with_inertia.items():
                if region.is_open:
                    where = f"{region.curve.label} of {name}"
                    restraint = distance(middle(static[pair]), middle(membrane[pair]), f"shift by restraint, {where}")
                    inertia = distance(middle(region), middle(static[pair]), f"shift by inertia, h/b = {h:g}, {where}")
                    findings.append(Finding(f"h/b = {h:g}: more by inertia than by restraint", restraint, inertia))
    return judged(
        "In-plane inertia shifts the regions",
        "The positions of unstable regions with and without in-plane inertia differ a little due to the effect of that "
        "inertia (section IV on Fig. 3).",
        _scope(study),
        findings,
    )


def _scope(study: ClaimRange) -> str:
    """Return the range of `_models` in words."""
    return (
        f"uniform load; a/b = {some(study.aspect_ratios)}; h/b = {some(study.thickness_ratios)}; V = "
        f"{study.plate.speed:g}; f0 = {study.plate.tension:g}"
    )


def _models(study: ClaimRange, h: float) -> Iterator[NamedPlate]:
    for r in study.aspect_ratios:
        yield NamedPlate(f"a/b = {r:g}", replace(study.plate, aspect_ratio=r, thickness_ratio=h, inplane="dynamic"))


def _widths(group: str, one: NamedPlate, other: NamedPlate, study: ClaimRange) -> list[Finding]:
    """Return the findings that every region has the same width in both plates."""
    here, there = (regions(name, plate, study.eps, modes=study.modes) for name, plate in (one, other))
    return [
        Finding(group, width(here[pair]), width(there[pair]), WIDTH_TOLERANCE) for pair in there if there[pair].is_open
    ]


def _stress_error(plate: MovingPlate) -> float:
    """Return the largest root mean square over the plate of N_xx - f, N_yy and N_xy, per mean load."""
    field = plate.stress(0.0, 0)
    load = plate.tension * plate.load.static(field.y)[:, None]
    return max(float(np.sqrt(np.mean(np.abs(N) ** 2))) for N in (field.N_xx - load, field.N_yy, field.N_xy)) / abs(
        plate.tension
    )
