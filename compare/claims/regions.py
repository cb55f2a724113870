"""The paper's claims on which regions exist and how they compare (section IV on Fig. 2; conclusion 1; eq. (24))."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise, product

import numpy as np

from compare.claims.evidence import ClaimVerdict, Finding, judged
from compare.claims.quantities import distance, middle, number, part_of, regions, width
from compare.claims.survey import ClaimRange, skew_loads, some, symmetric_loads
from perturb import gyroscopic_modes
from plate import MovingPlate

NOTHING = number("nothing", 0.0)
# Symmetric and antisymmetric functions are coupled by less than this part of the load: rounding.
SYMMETRIC_LOAD_TOLERANCE = 1e-9
# A region whose middle leaves its starting frequency by less than this part of the half width looks straight in a
# figure.
MAX_RELATIVE_BEND = 0.01


def no_difference_regions(study: ClaimRange) -> ClaimVerdict:
    """Judge "combination resonances of the difference type do not exist"."""
    loads = symmetric_loads(study) | skew_loads()

    def of(group: str, name: str, plate: MovingPlate) -> list[Finding]:
        found = regions(name, plate, study.eps, modes=study.modes, type="difference")
        return [Finding(group, width(region), NOTHING) for region in found.values()]

    findings = [
        finding
        for load_name, load in loads.items()
        for name, plate in study.survey({load_name: load})
        for finding in of(load_name, name, plate)
    ]
    return judged(
        "No difference-type regions",
        "Combination resonances of the difference type do not exist (abstract; section IV on Fig. 2; conclusion 1).",
        f"{study.scope}; loads: {', '.join(loads)}",
        findings,
        also=of("", *study.base()),
    )


def combination_regions_smaller(study: ClaimRange) -> ClaimVerdict:
    """Judge "regions of combination resonances are generally (much) smaller than those of main resonances"."""
    loads = symmetric_loads(study) | skew_loads()
    findings = []
    for name, plate in study.survey(loads):
        found = regions(name, plate, study.eps, modes=study.modes)
        mains = [width(region) for (p, q), region in found.items() if p == q]
        combinations = [width(region) for (p, q), region in found.items() if p != q]
        largest = max(combinations, key=lambda quantity: quantity.predicted)
        for which, pick in (("every", min), ("the largest", max)):
            main = pick(mains, key=lambda quantity: quantity.predicted)
            findings.append(Finding(f"a/b = {plate.aspect_ratio:g}: smaller than {which} main region", largest, main))
    return judged(
        "Combination regions are smaller than main ones",
        "Regions at main resonances are generally (much) larger than those at sum-type combination resonances "
        "(section IV on Fig. 2; conclusion 1).",
        f"{study.scope}; loads: {', '.join(loads)}",
        findings,
    )


def higher_regions_smaller(study: ClaimRange) -> ClaimVerdict:
    """Judge "unstable regions become smaller with higher main resonances"."""
    loads = symmetric_loads(study)
    findings = []
    for name, plate in study.survey(loads):
        found = regions(name, plate, study.eps, modes=study.modes)
        for n, m in pairwise(range(1, study.modes + 1)):
            group = f"a/b = {plate.aspect_ratio:g}: 2ω{m} below 2ω{n}"
            findings.append(Finding(group, width(found[m, m]), width(found[n, n])))
    return judged(
        "Higher main regions are smaller",
        "Unstable regions become smaller with higher main resonances (section IV on Fig. 2).",
        f"{study.scope}; loads: {', '.join(loads)}",
        findings,
    )


def first_and_third_combine_most(study: ClaimRange) -> ClaimVerdict:
    """Judge "the region of modes 1 + 3 is larger than those of 1 + 2 and 2 + 3", said to follow from symmetry."""
    loads = symmetric_loads(study) | skew_loads()
    findings = []
    for name, plate in study.survey(loads):
        found = regions(name, plate, study.eps, modes=3)
        group = _symmetry(plate)
        findings += [Finding(group, width(found[pair]), width(found[1, 3])) for pair in ((1, 2), (2, 3))]
    return judged(
        "Modes 1 and 3 combine most",
        "The region at ω₁+ω₃ is larger than those at ω₁+ω₂ and ω₂+ω₃, since modes 1 and 3 are symmetric and mode 2 is "
        "antisymmetric (section IV on Fig. 2).",
        f"{study.scope}; loads: {', '.join(loads)}",
        findings,
    )


def boundaries_are_straight(study: ClaimRange) -> ClaimVerdict:
    """Judge "every stability boundary is a line because the problem is linear".

    Straight boundaries about a fixed frequency keep the middle of the region there. Theory is of second order here,
    since to first order the elastic boundaries are straight by construction.
    """
    name, plate = study.base()
    findings = []
    for eps in study.amplitudes:
        for region in regions(name, plate, eps, modes=study.modes, order=2).values():
            if region.is_open:
                shift = distance(middle(region), number("its start", region.curve.centre), f"bend of {region.name}")
                allowed = part_of(width(region), MAX_RELATIVE_BEND / 2, f"{MAX_RELATIVE_BEND:.0%} of its half width")
                findings.append(Finding(f"straight up to eps = {eps:g}", shift, allowed))
    return judged(
        "Boundaries are straight lines",
        "Every stability boundary is a line because the problem is linear and the approximation is of first order "
        "(section IV on Fig. 2).",
        f"{name}, elastic; open regions of modes 1 to {study.modes}; eps = {some(study.amplitudes)}",
        findings,
    )


def nothing_elsewhere(study: ClaimRange) -> ClaimVerdict:
    """Judge "away from j Omega = omega_p ± omega_q nothing grows" (eq. (24)) where 2 Omega = omega_p + omega_q."""
    name, elastic = study.base()
    findings = []
    for damping, eps in product((0.0, *study.dampings), study.amplitudes):
        where = f"c = {damping:g}, eps = {eps:g}"
        plate = replace(elastic, damping=damping)
        found = regions(f"{name}, c = {damping:g}", plate, eps, modes=study.modes, order=2, interaction=2)
        findings += [Finding(where, width(region), NOTHING) for region in found.values()]
    return judged(
        "Nothing grows elsewhere",
        "With j Ω away from every ω_p ± ω_q the system is always stable (section III A, eq. (24)).",
        f"{name}; 2Ω near ω_p+ω_q of modes 1 to {study.modes}; c = 0, {some(study.dampings)}; "
        f"eps = {some(study.amplitudes)}",
        findings,
    )


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
