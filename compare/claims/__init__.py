"""The paper's claims, each decided by computation over a stated range of parameters.

A claim is a function of a range of parameters. It breaks what the paper says into instances, decides each by theory,
repeats the telling ones by integration and returns a verdict; the rule is in `compare.claims.evidence`:

>>> from compare.claims import CLAIMS, QUICK_RANGE, judge_claims
>>> [claim.__name__ for claim in CLAIMS][:2]
['nothing_elsewhere', 'no_difference_regions']
>>> QUICK_RANGE.aspect_ratios
(1.0, 2.0)

``judge_claims(quick=True)`` judges all of them over that range. `survey` makes the plates of a range, `quantities` the
widths and places of their regions, `regions`, `inplane` and `trends` hold the claims themselves.
"""

from __future__ import annotations

from collections.abc import Callable

from tqdm import tqdm

from compare.claims.evidence import ClaimVerdict, Traced, Verdict
from compare.claims.inplane import inertia_hardly_matters, inertia_shifts_regions, stress_equals_linear_load
from compare.claims.quantities import Measured
from compare.claims.regions import (
    boundaries_are_straight,
    combination_regions_smaller,
    first_and_third_combine_most,
    higher_regions_smaller,
    no_difference_regions,
    nothing_elsewhere,
)
from compare.claims.survey import QUICK_RANGE, ClaimRange
from compare.claims.trends import damping_shrinks, longer_plate_shrinks, narrower_load_shrinks
from floquet.running import gather

__all__ = ["CLAIMS", "QUICK_RANGE", "ClaimRange", "ClaimVerdict", "Measured", "Traced", "Verdict", "judge_claims"]

# In the order of the paper.
CLAIMS: tuple[Callable[[ClaimRange], ClaimVerdict], ...] = (
    nothing_elsewhere,
    no_difference_regions,
    boundaries_are_straight,
    higher_regions_smaller,
    first_and_third_combine_most,
    combination_regions_smaller,
    stress_equals_linear_load,
    inertia_hardly_matters,
    inertia_shifts_regions,
    narrower_load_shrinks,
    longer_plate_shrinks,
    damping_shrinks,
)


def judge_claims(*, n_jobs: int = -1, progress: bool = False, quick: bool = False) -> list[ClaimVerdict]:
    """Judge every claim of the paper.

    Parameters
    ----------
    n_jobs : int
        Claims judged at once, as in `floquet.stability_chart`.
    progress : bool
        Show a progress bar.
    quick : bool
        Judge over a smaller range of parameters (`compare.claims.survey.QUICK_RANGE`).

    Returns
    -------
    list of ClaimVerdict
        In the order of the paper.
    """
    study = QUICK_RANGE if quick else ClaimRange()
    tasks = [(claim, study) for claim in CLAIMS]
    with tqdm(desc="claims", total=len(tasks), unit="claim", disable=not progress) as bar:
        return gather(_judged, tasks, n_jobs, bar)


def _judged(claim: Callable[[ClaimRange], ClaimVerdict], study: ClaimRange) -> ClaimVerdict:
    return claim(study)
