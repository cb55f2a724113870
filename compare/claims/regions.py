"""The paper's claims on which regions exist and how they compare (section IV on Fig. 2; conclusion 1; eq. (24))."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise, product

import numpy as np

from compare.claims.evidence import Finding
from compare.claims.judgement import Instances
from compare.claims.quantities import distance, middle, number, part_of, regions, width
from compare.claims.scopes import Scope
from compare.claims.survey import ClaimRange, skew_loads, some, symmetric_loads
from perturb import gyroscopic_modes
from plate import EdgeLoad, MovingPlate

UNIFORM = {"uniform load": EdgeLoad.uniform()}
NOTHING = number("nothing", 0.0)
# Symmetric and antisymmetric functions are coupled by less than this part of the load: rounding.
SYMMETRIC_LOAD_TOLERANCE = 1e-9
# A region whose middle leaves its starting frequency by less than this part of the half width looks straight in a
# figure.
MAX_RELATIVE_BEND = 0.01


def nothing_elsewhere(study: ClaimRange, scope: Scope) -> Instances:
    """Judge "away from j Omega = omega_p ± omega_q nothing grows" (eq. (24)) where 2 Omega = omega_p + omega_q."""
    said, plates = study.plates(scope, UNIFORM)
    if scope is Scope.LITERAL:
        return Instances(said, (), "to first order, eq. (24), nothing is in resonance there")
    findings = []
    for (name, elastic, _), damping, eps in product(plates, (0.0, study.dampings[-1]), study.amplitudes):
        plate = replace(elastic, damping=damping)
        found = regions(f"{name}, c = {damping:g}", plate, eps, modes=study.modes, order=2, interaction=2)
        findings += [Finding(f"c = {damping:g}, eps = {eps:g}", width(region), NOTHING) for region in found.values()]
    said = f"{said}; 2Ω near ω_p+ω_q; c = 0, {study.dampings[-1]:g}; eps = {some(study.amplitudes)}"
    return Instances(said, tuple(findings))


def no_difference_regions(study: ClaimRange, scope: Scope) -> Instances:
    """Judge "combination resonances of the difference type do not exist"."""
    said, plates = study.plates(scope, symmetric_loads(study) | skew_loads())
    literal = scope is Scope.LITERAL
    findings = [
        Finding(load, width(region), NOTHING)
        for name, plate, load in plates
        for region in regions(name, plate, study.eps, modes=study.modes, type="difference", literal=literal).values()
    ]
    return Instances(said, tuple(findings))


def boundaries_are_straight(study: ClaimRange, scope: Scope) -> Instances:
    """Judge "every stability boundary is a line because the problem is linear".

    Straight boundaries about a fixed frequency keep the middle of the region there. Theory is of second order here,
    since to first order the elastic boundaries are straight by construction.
    """
    said, plates = study.plates(scope, UNIFORM)
    if scope is Scope.LITERAL:
        return Instances(said, (), "eq. (25) at c = 0 draws lines")
    findings = []
    for (name, plate, _), eps in product(plates, study.amplitudes):
        for region in regions(name, plate, eps, modes=study.modes, order=2).values():
            if region.is_open:
                shift = distance(middle(region), number("its start", region.curve.centre), f"bend of {region.name}")
                allowed = part_of(width(region), MAX_RELATIVE_BEND / 2, f"{MAX_RELATIVE_BEND:.0%} of its half width")
                findings.append(Finding(f"straight up to eps = {eps:g}", shift, allowed))
    return Instances(f"{said}; elastic; open regions; eps = {some(study.amplitudes)}", tuple(findings))


def higher_regions_smaller(study: ClaimRange, scope: Scope) -> Instances:
    """Judge "unstable regions become smaller with higher main resonances"."""
    said, plates = study.plates(scope, symmetric_loads(study))
    findings = []
    for name, plate, _ in plates:
        found = regions(name, plate, study.eps, modes=study.modes, literal=scope is Scope.LITERAL)
        for n, m in pairwise(range(1, study.modes + 1)):
            part = f"a/b = {plate.aspect_ratio:g}: 2ω{m} below 2ω{n}"
            findings.append(Finding(part, width(found[m, m]), width(found[n, n])))
    return Instances(said, tuple(findings))


def first_and_third_combine_most(study: ClaimRange, scope: Scope) -> Instances:
    """Judge "the region of modes 1 + 3 is larger than those of 1 + 2 and 2 + 3", said to follow from symmetry."""
    said, plates = study.plates(scope, symmetric_loads(study) | skew_loads())
    findings = []
    for name, plate, _ in plates:
        found = regions(name, plate, study.eps, modes=3, literal=scope is Scope.LITERAL)
        part = _symmetry(plate)
        findings += [
            Finding(part, width(found[pair]), width(found[1, 3]))
            for pair in ((1, 2), (2, 3))
            if found[pair].is_open or found[1, 3].is_open
        ]
    return Instances(f"{said}; unless both regions are closed", tuple(findings))


def combination_regions_smaller(study: ClaimRange, scope: Scope) -> Instances:
    """Judge "regions of combination resonances are generally (much) smaller than those of main resonances".

    Every open combination region is compared with every main one of the same plate; those that symmetry closes are left
    out, since they are smaller for another reason.
    """
    said, plates = study.plates(scope, symmetric_loads(study) | skew_loads())
    findings = []
    for name, plate, _ in plates:
        found = regions(name, plate, study.eps, modes=study.modes, literal=scope is Scope.LITERAL)
        combinations = [region for (p, q), region in found.items() if p != q and region.is_open]
        mains = [region for (p, q), region in found.items() if p == q]
        findings += [
            Finding(f"a/b = {plate.aspect_ratio:g}: below {main.curve.label}", width(region), width(main))
            for region, main in product(combinations, mains)
        ]
    return Instances(f"{said}; open combination regions", tuple(findings))


def _symmetry(plate: MovingPlate) -> str:
    """Name what the paper's reason rests on: load and modes symmetric or antisymmetric about the mid-line."""
    system = plate.at(0.0)
    antisymmetric = np.arange(system.size) % plate.terms.lateral % 2 == 1  # odd polynomials across the plate
    if (
        np.abs(system.cosine[:, antisymmetric][:, :, ~antisymmetric]).max()
        > SYMMETRIC_LOAD_TOLERANCE * np.abs(system.cosine).max()
    ):
        return "load not symmetric about the mid-line"
    w = gyroscopic_modes(system).vectors[:, :3]
    odd = np.linalg.norm(w[antisymmetric], axis=0) > np.linalg.norm(w[~antisymmetric], axis=0)
    if odd.tolist() == [False, True, False]:
        return "symmetric load; modes 1, 3 symmetric, mode 2 antisymmetric"
    return "symmetric load; modes in another order"
