"""The paper's claims on the in-plane problem (section IV on Fig. 3; conclusion 2)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import lru_cache
from itertools import product

import numpy as np

from compare.claims.convergence import KEPT_PLATES
from compare.claims.evidence import Finding
from compare.claims.judgement import Instances
from compare.claims.quantities import Region, distance, middle, number, regions, width
from compare.claims.scopes import Scope
from compare.claims.survey import ClaimRange, NamedPlate, linear_loads, some, symmetric_loads
from plate import EdgeLoad, MovingPlate

# Stresses that differ by less than this part of the mean load (root mean square over the plate) are the same stress.
STRESS_TOLERANCE = 0.01
# Widths that differ by less than this part look the same in a figure.
WIDTH_TOLERANCE = 0.02
# Plates up to this h/b are thin.
MAX_THIN_RATIO = 0.01


def stress_equals_linear_load(study: ClaimRange, scope: Scope) -> Instances:
    """Judge "under linearly distributed load the in-plane stresses equal the load"."""
    loads = linear_loads()
    if scope is Scope.WIDER:
        plates = [
            study.model_plate(r, load, name, nu)
            for nu, r, (name, load) in product(study.poisson_ratios, study.aspect_ratios, loads.items())
        ]
        where = (
            f"a/b = {some(study.aspect_ratios)}; nu = {some(study.poisson_ratios)}; V = {study.plate.speed:g}; "
            f"f0 = {study.plate.tension:g}"
        )
    else:
        plates = [plate for name, load in loads.items() for plate in study.figure(1.0, load, name)]
        where = f"square plate, nu = {study.plate.poisson_ratio:g}; {study.figure_scope}"
    findings = []
    for name, plate, load_name in plates:
        nu = f"nu = {plate.poisson_ratio:g}"
        findings.append(
            Finding(
                f"{nu}: stresses",
                number(f"mean error of the stresses, {nu}, {name}", _stress_error(plate)),
                number(f"{STRESS_TOLERANCE:.0%} of the mean load", STRESS_TOLERANCE),
            )
        )
        findings += _widths(
            f"{nu}: widths of regions",
            NamedPlate(f"{nu}, {name}, stress equal to the load", replace(plate, inplane="membrane"), load_name),
            NamedPlate(f"{nu}, {name}, in-plane problem solved", plate, load_name),
            study,
            scope,
        )
    where += (
        f"; static in-plane problem; loads: {', '.join(loads)}; same within {STRESS_TOLERANCE:.0%} (stress, root mean "
        f"square over the plate) and {WIDTH_TOLERANCE:.0%} (widths)"
    )
    return Instances(where, tuple(findings))


def inertia_hardly_matters(study: ClaimRange, scope: Scope) -> Instances:
    """Judge "regions with and without in-plane inertia have almost the same size" for thin plates.

    The paper's case without inertia is the membrane, N_xx = f, which leaves out the Poisson restraint too. The wider
    range asks of inertia alone as well, under partial loads too.
    """
    without = {"membrane": "N_xx = f"}
    loads = {"uniform load": EdgeLoad.uniform()}
    if scope is Scope.WIDER:
        without["static"] = "in-plane problem without inertia"
        loads = symmetric_loads(study)
    findings = []
    for (h, (name, plate, load)), (model, said) in product(_thicknesses(study, scope, loads), without.items()):
        if model == "membrane" and load != "uniform load":
            continue  # the paper takes N_xx = f under linear loads only
        findings += _widths(
            f"h/b = {h:g}, {load}, against {said}",
            NamedPlate(f"{name}, {said}", replace(plate, inplane=model), load),
            NamedPlate(f"{name}, h/b = {h:g}, with inertia", _with_inertia(plate, h), load),
            study,
            scope,
        )
    return Instances(f"{_thickness_scope(study, scope, loads)}; same within {WIDTH_TOLERANCE:.0%}", tuple(findings))


def inertia_shifts_regions(study: ClaimRange, scope: Scope) -> Instances:
    """Judge "the positions may be shifted a little due to in-plane inertia", held against the Poisson restraint."""
    loads = {"uniform load": EdgeLoad.uniform()}
    findings = []
    for h, (name, plate, _) in _thicknesses(study, scope, loads):
        membrane, static, dynamic = (
            _regions(f"{name}, {one.inplane}", one, study, scope)
            for one in (replace(plate, inplane="membrane"), plate, _with_inertia(plate, h))
        )
        for pair, region in dynamic.items():
            if region.is_open:
                where = f"{region.curve.label} of {name}"
                restraint = distance(middle(static[pair]), middle(membrane[pair]), f"shift by restraint, {where}")
                inertia = distance(middle(region), middle(static[pair]), f"shift by inertia, h/b = {h:g}, {where}")
                findings.append(Finding(f"h/b = {h:g}: more by inertia than by restraint", restraint, inertia))
    return Instances(_thickness_scope(study, scope, loads), tuple(findings))


def _thicknesses(study: ClaimRange, scope: Scope, loads: dict[str, EdgeLoad]) -> Iterator[tuple[float, NamedPlate]]:
    """Yield thickness ratios and static plates; the paper speaks of thin ones."""
    if scope is Scope.WIDER:
        for h, (name, load), r in product(study.thickness_ratios, loads.items(), study.aspect_ratios):
            yield h, study.model_plate(r, load, name, study.plate.poisson_ratio)
    else:
        yield from product(_thin(study), study.figure())


def _thin(study: ClaimRange) -> tuple[float, ...]:
    return tuple(h for h in study.thickness_ratios if h <= MAX_THIN_RATIO)


def _thickness_scope(study: ClaimRange, scope: Scope, loads: dict[str, EdgeLoad]) -> str:
    """Return the range of `_thicknesses` in words."""
    if scope is Scope.WIDER:
        return (
            f"loads: {', '.join(loads)}; a/b = {some(study.aspect_ratios)}; h/b = {some(study.thickness_ratios)}; "
            f"V = {study.plate.speed:g}; f0 = {study.plate.tension:g}"
        )
    return f"Fig. 3: square plate; h/b = {some(_thin(study))}; {study.figure_scope}"


@lru_cache(maxsize=KEPT_PLATES)
def _with_inertia(plate: MovingPlate, h: float) -> MovingPlate:
    return replace(plate, inplane="dynamic", thickness_ratio=h)


def _regions(name: str, plate: MovingPlate, study: ClaimRange, scope: Scope) -> dict[tuple[int, int], Region]:
    return regions(name, plate, study.eps, modes=study.modes, literal=scope is Scope.LITERAL)


def _widths(part: str, one: NamedPlate, other: NamedPlate, study: ClaimRange, scope: Scope) -> list[Finding]:
    """Return the findings that every region has the same width in both plates."""
    here, there = (_regions(name, plate, study, scope) for name, plate, _ in (one, other))
    return [
        Finding(part, width(here[pair]), width(there[pair]), WIDTH_TOLERANCE) for pair in there if there[pair].is_open
    ]


def _stress_error(plate: MovingPlate) -> float:
    """Return the largest root mean square over the plate of N_xx - f, N_yy and N_xy, per mean load."""
    field = plate.stress(0.0, 0)
    load = plate.tension * plate.load.static(field.y)[:, None]
    return max(float(np.sqrt(np.mean(np.abs(N) ** 2))) for N in (field.N_xx - load, field.N_yy, field.N_xy)) / abs(
        plate.tension
    )
