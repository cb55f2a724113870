"""The paper's claims on what width of load, aspect ratio and damping do (section IV on Figs. 4-6; conclusions 3-5)."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from itertools import pairwise, product

from compare.claims.evidence import Finding
from compare.claims.judgement import Instances
from compare.claims.quantities import Quantity, Region, distance, middle, regions, width
from compare.claims.scopes import Scope
from compare.claims.survey import FIGURE_WIDTH, ClaimRange, NamedPlate, middle_part, part_name, some
from plate import MovingPlate

# A region whose middle moves by less than this part of its frequency has stayed in place, to the eye.
POSITION_SHIFT_TOLERANCE = 0.002


def narrower_load_shrinks(study: ClaimRange, scope: Scope) -> Instances:
    """Judge "as a symmetric load gets narrower, unstable regions shrink and move down"."""
    if scope is Scope.WIDER:
        all_series = [
            [study.series_plate(r, speed, share) for share in study.widths]
            for r, speed in product(study.aspect_ratios, study.speeds)
        ]
        said = _series_scope(study)
    else:
        all_series = [
            [study.figure_plate(f0, 1.0, middle_part(share), part_name(share)) for share in (1.0, FIGURE_WIDTH)]
            for f0 in study.figure_tensions
        ]
        said = f"Fig. 4: square plate; {study.figure_scope}"
    return Instances(said, tuple(_trends(all_series, study, scope)))


def longer_plate_shrinks(study: ClaimRange, scope: Scope) -> Instances:
    """Judge "as the aspect ratio increases, all regions shrink, move down and get closer"."""
    if scope is Scope.WIDER:
        all_series = [
            [study.series_plate(r, speed, share) for r in study.aspect_ratios]
            for share, speed in product(study.widths, study.speeds)
        ]
        said = _series_scope(study)
    else:
        load, name = middle_part(FIGURE_WIDTH), part_name(FIGURE_WIDTH)
        all_series = [
            [study.figure_plate(f0, r, load, name) for r in study.figure_aspect_ratios] for f0 in study.figure_tensions
        ]
        said = f"Fig. 5: a/b = {some(study.figure_aspect_ratios)}, {name}; {study.figure_scope}"
    findings = _trends(all_series, study, scope)
    for series in all_series:
        spread = [_spread(plate, study, scope) for plate in series]
        findings += [Finding("regions get closer", later, sooner) for sooner, later in pairwise(spread)]
    return Instances(f"{said}; regions numbered by frequency", tuple(findings))


def damping_shrinks(study: ClaimRange, scope: Scope) -> Instances:
    """Judge "damping shrinks every region, in place, and is favourable to stability"."""
    said, plates = study.plates(scope, {"uniform load": study.plate.load})
    findings = []
    for name, plate, _ in plates:
        elastic = _regions(f"{name}, c = 0", plate, study, scope)
        for c in study.dampings:
            damped = _regions(f"{name}, c = {c:g}", replace(plate, damping=c), study, scope)
            for pair, region in elastic.items():
                if not region.is_open:
                    continue
                findings.append(Finding(f"{_type(region)} regions shrink", width(damped[pair]), width(region)))
                if damped[pair].is_open:
                    findings.append(
                        Finding(
                            "regions stay in place",
                            middle(damped[pair]),
                            middle(region),
                            tolerance=POSITION_SHIFT_TOLERANCE,
                        )
                    )
    said = said.replace("Fig. 2", "Figs. 2 and 6")
    return Instances(f"{said}; c = {some(study.dampings)}; eps = {study.eps:g}", tuple(findings))


def _series_scope(study: ClaimRange) -> str:
    """Return the range of `ClaimRange.series_plate` in words."""
    return (
        f"a/b = {some(study.aspect_ratios)}; V = {some(study.speeds)}; f0 = {study.plate.tension:g}; loaded part "
        f"{some(study.widths)}"
    )


def _regions(name: str, plate: MovingPlate, study: ClaimRange, scope: Scope) -> dict[tuple[int, int], Region]:
    return regions(name, plate, study.eps, modes=study.modes, literal=scope is Scope.LITERAL)


def _trends(all_series: Iterable[Sequence[NamedPlate]], study: ClaimRange, scope: Scope) -> list[Finding]:
    """Return the findings that each region is smaller and lower than in the plate before."""
    findings = []
    for series in all_series:
        found = [_regions(name, plate, study, scope) for name, plate, _ in series]
        for before, after in pairwise(found):
            for pair, region in after.items():
                label = region.curve.label
                if region.is_open or before[pair].is_open:
                    findings.append(Finding(f"{label} shrinks", width(region), width(before[pair])))
                if region.is_open and before[pair].is_open:
                    findings.append(Finding(f"{label} moves down", middle(region), middle(before[pair])))
    return findings


def _spread(named: NamedPlate, study: ClaimRange, scope: Scope) -> Quantity:
    """Return the distance of the highest main region from the lowest."""
    found = _regions(named.name, named.plate, study, scope)
    low, high = middle(found[1, 1]), middle(found[study.modes, study.modes])
    return distance(high, low, f"distance from 2ω₁ to 2ω{study.modes} of {named.name}")


def _type(region: Region) -> str:
    return "main" if region.curve.p == region.curve.q else "combination"
