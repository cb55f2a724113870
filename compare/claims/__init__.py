"""The paper's claims, each decided by computation in three scopes.

A claim is a function of a range of parameters and a scope: the paper's own figures, the same by eq. (25) as printed,
and a wider range. It breaks what the paper says into instances, decides each by theory, and repeats the telling ones by
integration. The verdict follows from how many instances hold; the rule is in `compare.claims.judgement`:

>>> from compare.claims import CLAIMS, QUICK_RANGE, Scope, verdict_of
>>> [claim.name for claim in CLAIMS][:2]
['Nothing grows elsewhere', 'No difference-type regions']
>>> [str(scope) for scope in Scope]
["paper's figures", 'figures by (25) as printed', 'wider range']
>>> print(verdict_of(19, 20))
mostly holds
>>> QUICK_RANGE.aspect_ratios
(1.0, 2.0)

``judge_claims(quick=True)`` judges all of them over that range. `survey` makes the plates, `convergence` chooses their
terms, `quantities` has the widths and places of their regions, `evidence` compares these by theory and by integration;
`regions`, `inplane` and `trends` hold the claims themselves.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

from tqdm import tqdm

from compare.claims.convergence import converged, terms_left
from compare.claims.evidence import Finding, Traced, trace_telling
from compare.claims.inplane import inertia_hardly_matters, inertia_shifts_regions, stress_equals_linear_load
from compare.claims.judgement import (
    MOSTLY_SHARE,
    PARTLY_SHARE,
    ClaimVerdict,
    Instances,
    Judgement,
    Verdict,
    verdict_of,
)
from compare.claims.quantities import Measured
from compare.claims.regions import (
    boundaries_are_straight,
    combination_regions_smaller,
    first_and_third_combine_most,
    higher_regions_smaller,
    no_difference_regions,
    nothing_elsewhere,
)
from compare.claims.scopes import Scope
from compare.claims.survey import QUICK_RANGE, SURVIVING_TICK, ClaimRange, figure_speed
from compare.claims.trends import damping_shrinks, longer_plate_shrinks, narrower_load_shrinks
from floquet.running import gather

__all__ = [
    "CLAIMS",
    "MOSTLY_SHARE",
    "PARTLY_SHARE",
    "QUICK_RANGE",
    "SURVIVING_TICK",
    "Claim",
    "ClaimRange",
    "ClaimVerdict",
    "Finding",
    "Instances",
    "Judgement",
    "Measured",
    "Scope",
    "Traced",
    "Verdict",
    "figure_speed",
    "judge",
    "judge_claims",
    "verdict_of",
]


class Claim(NamedTuple):
    """A sentence of the paper that can be tested.

    Attributes
    ----------
    name : str
        Short name.
    statement : str
        What the paper says, in our words, and where.
    instances : callable
        Takes a `ClaimRange` and a `Scope` and returns `Instances`.
    """

    name: str
    statement: str
    instances: Callable[[ClaimRange, Scope], Instances]


# In the order of the paper.
CLAIMS = (
    Claim(
        "Nothing grows elsewhere",
        "With j Ω away from every ω_p ± ω_q the system is always stable (section III A, eq. (24)).",
        nothing_elsewhere,
    ),
    Claim(
        "No difference-type regions",
        "Combination resonances of the difference type do not exist (abstract; section IV on Fig. 2; conclusion 1).",
        no_difference_regions,
    ),
    Claim(
        "Boundaries are straight lines",
        "Every stability boundary is a line because the problem is linear and the approximation is of first order "
        "(section IV on Fig. 2).",
        boundaries_are_straight,
    ),
    Claim(
        "Higher main regions are smaller",
        "Unstable regions become smaller with higher main resonances (section IV on Fig. 2).",
        higher_regions_smaller,
    ),
    Claim(
        "Modes 1 and 3 combine most",
        "The region at ω₁+ω₃ is larger than those at ω₁+ω₂ and ω₂+ω₃, since modes 1 and 3 are symmetric and mode 2 is "
        "antisymmetric (section IV on Fig. 2).",
        first_and_third_combine_most,
    ),
    Claim(
        "Combination regions are smaller than main ones",
        "Regions at main resonances are generally (much) larger than those at sum-type combination resonances "
        "(section IV on Fig. 2; conclusion 1).",
        combination_regions_smaller,
    ),
    Claim(
        "Stress equals a linear load",
        "Under a linearly distributed edge load the in-plane stress resultants equal the load (section IV on Fig. 3; "
        "conclusion 2).",
        stress_equals_linear_load,
    ),
    Claim(
        "In-plane inertia hardly matters",
        "The sizes of unstable regions with and without in-plane inertia are almost the same for a thin plate "
        "(section IV on Fig. 3; conclusion 2).",
        inertia_hardly_matters,
    ),
    Claim(
        "In-plane inertia shifts the regions",
        "The positions of unstable regions with and without in-plane inertia differ a little due to the effect of that "
        "inertia (section IV on Fig. 3).",
        inertia_shifts_regions,
    ),
    Claim(
        "A narrower load shrinks the regions",
        "As a symmetric edge load becomes narrower at the same total, unstable regions generally become smaller and "
        "shift towards lower frequency (section IV on Fig. 4; conclusion 3).",
        narrower_load_shrinks,
    ),
    Claim(
        "A longer plate shrinks the regions",
        "As the aspect ratio increases, all unstable regions reduce in size, shift towards lower frequency and get "
        "closer (section IV on Fig. 5; conclusion 4).",
        longer_plate_shrinks,
    ),
    Claim(
        "Damping shrinks the regions",
        "Internal damping makes all unstable regions shrink upwards at the same location, some vanish, and so it "
        "favours stability (section IV on Fig. 6; conclusion 5).",
        damping_shrinks,
    ),
)


def judge_claims(*, n_jobs: int = -1, progress: bool = False, quick: bool = False) -> list[ClaimVerdict]:
    """Judge every claim of the paper.

    Parameters
    ----------
    n_jobs : int
        Workers, as in `floquet.stability_chart`.
    progress : bool
        Show progress bars.
    quick : bool
        Judge over a smaller range of parameters (`compare.claims.survey.QUICK_RANGE`).

    Returns
    -------
    list of ClaimVerdict
        In the order of the paper.
    """
    return judge(CLAIMS, QUICK_RANGE if quick else ClaimRange(), n_jobs=n_jobs, progress=progress)


def judge(
    claims: tuple[Claim, ...], study: ClaimRange, *, n_jobs: int = 1, progress: bool = False
) -> list[ClaimVerdict]:
    """Judge some claims over a range of parameters, in every scope.

    Each plate and each region is computed once, whichever claims look at it.
    """
    requests = study.requests()
    with tqdm(desc="claims: plates", total=len(requests), unit="plate", disable=not progress) as bar:
        plates = gather(converged, [(*request, study.modes) for request in requests], n_jobs, bar)
    left = terms_left(plates)
    places = [(claim, scope) for claim in claims for scope in Scope]
    with tqdm(desc="claims: theory", total=len(places), unit="scope", disable=not progress) as bar:
        found: list[Instances] = gather(_instances, [(claim, study, scope) for claim, scope in places], n_jobs, bar)
    traced = trace_telling([instances.findings for instances in found], n_jobs, progress)
    judged = [
        Judgement(scope, replace(instances, where=f"{instances.where}; {left}"), tuple(checks))
        for (_, scope), instances, checks in zip(places, found, traced, strict=True)
    ]
    width = len(Scope)
    return [
        ClaimVerdict(claim.name, claim.statement, tuple(judged[width * i : width * (i + 1)]))
        for i, claim in enumerate(claims)
    ]


def _instances(claim: Claim, study: ClaimRange, scope: Scope) -> Instances:
    return claim.instances(study, scope)
