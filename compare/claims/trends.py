"""The paper's claims on what width of load, aspect ratio and damping do (section IV on Figs. 4-6; conclusions 3-5)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise, product

from compare.claims.evidence import ClaimVerdict, Finding, judged
from compare.claims.quantities import Quantity, Region, distance, middle, regions, width
from compare.claims.survey import ClaimRange, NamedPlate, middle_part, part_name, some
from plate import MovingPlate

# A region whose middle moves by less than this part of its frequency has stayed in place, to the eye.
POSITION_SHIFT_TOLERANCE = 0.002


def narrower_load_shrinks(study: ClaimRange) -> ClaimVerdict:
    """Judge "as a symmetric load gets narrower, unstable regions shrink and move down"."""
    findings = []
    for r, speed in product(study.aspect_ratios, study.speeds):
        plates = [_plate(study, r, speed, share) for share in study.widths]
        findings += _trend(plates, study)
    return judged(
        "A narrower load shrinks the regions",
        "As a symmetric edge load becomes narrower at the same total, unstable regions generally become smaller and "
        "shift towards lower frequency (section IV on Fig. 4; conclusion 3).",
        _scope(study),
        findings,
    )


def longer_plate_shrinks(study: ClaimRange) -> ClaimVerdict:
    """Judge "as the aspect ratio increases, all regions shrink, move down and get closer"."""
    findings = []
    for share, speed in product(study.widths, study.speeds):
        plates = [_plate(study, r, speed, share) for r in study.aspect_ratios]
        findings += _trend(plates, study)
        spread = [_spread(*plate, study) for plate in plates]
        findings += [Finding("regions get closer", later, sooner) for sooner, later in pairwise(spread)]
    return judged(
        "A longer plate shrinks the regions",
        "As the aspect ratio increases, all unstable regions reduce in size, shift towards lower frequency and get "
        "closer (section IV on Fig. 5; conclusion 4).",
        f"{_scope(study)}, numbered by frequency",
        findings,
    )


def damping_shrinks(study: ClaimRange) -> ClaimVerdict:
    """Judge "damping shrinks every region, in place, and is favourable to stability"."""
    findings = []
    for name, plate in study.survey({"uniform load": study.plate.load}):
        elastic = regions(f"{name}, c = 0", plate, study.eps, modes=study.modes)
        for c in study.dampings:
            damped = regions(f"{name}, c = {c:g}", replace(plate, damping=c), study.eps, modes=study.modes)
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
    return judged(
        "Damping shrinks the regions",
        "Internal damping makes all unstable regions shrink upwards at the same location, some vanish, and so it "
        "favours stability (section IV on Fig. 6; conclusion 5).",
        f"{study.scope}; uniform load; c = {some(study.dampings)}; eps = {study.eps:g}",
        findings,
    )


def _scope(study: ClaimRange) -> str:
    """Return the range of `_plate` in words."""
    return (
        f"a/b = {some(study.aspect_ratios)}; V = {some(study.speeds)}; f0 = {study.plate.tension:g}; loaded part "
        f"{some(study.widths)}; modes 1 to {study.modes}"
    )


def _plate(study: ClaimRange, r: float, speed: float, share: float) -> NamedPlate:
    """Return the plate of this aspect ratio and speed under a load on this part of the edge."""
    plate = replace(study.plate, aspect_ratio=r, speed=speed, load=middle_part(share))
    return NamedPlate(f"a/b = {r:g}, V = {speed:g}, {part_name(share)}", plate)


def _trend(plates: Sequence[NamedPlate], study: ClaimRange) -> list[Finding]:
    """Return the findings that each region is smaller and lower than in the plate before."""
    found = [regions(name, plate, study.eps, modes=study.modes) for name, plate in plates]
    findings = []
    for before, after in pairwise(found):
        for pair, region in after.items():
            label = region.curve.label
            if region.is_open or before[pair].is_open:
                findings.append(Finding(f"{label} shrinks", width(region), width(before[pair])))
            if region.is_open and before[pair].is_open:
                findings.append(Finding(f"{label} moves down", middle(region), middle(before[pair])))
    return findings


def _spread(name: str, plate: MovingPlate, study: ClaimRange) -> Quantity:
    """Return the distance of the highest main region from the lowest."""
    found = regions(name, plate, study.eps, modes=study.modes)
    low, high = middle(found[1, 1]), middle(found[study.modes, study.modes])
    return distance(high, low, f"distance from 2ω₁ to 2ω{study.modes} of {name}")


def _type(region: Region) -> str:
    return "main" if region.curve.p == region.curve.q else "combination"
