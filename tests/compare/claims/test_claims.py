"""The paper's claims: that computation decides them, not the program text, and known instances of each."""

from __future__ import annotations

import json
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from compare.claims import CLAIMS, Claim, ClaimRange, Judgement, Scope, Verdict, judge
from compare.claims.quantities import regions, width
from compare.claims.survey import middle_part
from plate import MovingPlate

# A plate of 3 x 5 coordinates and few variations: what a claim says of it is computed in a second or two.
SMALL = ClaimRange(
    plate=MovingPlate(inplane="static", axial_terms=3, lateral_terms=5, inplane_terms=(6, 6)),
    figure_tensions=(10.0,),
    figure_aspect_ratios=(1.0, 2.0),
    aspect_ratios=(1.0, 2.0),
    widths=(1.0, 0.5),
    speed_fractions=(0.7,),
    speeds=(3.0,),
    tensions=(10.0,),
    thickness_ratios=(0.01,),
    dampings=(1e-5,),
    amplitudes=(0.0025, 0.4),
)
SQUARE = replace(SMALL, aspect_ratios=(1.0,))
CLAIM = {claim.name: claim for claim in CLAIMS}


def _wider(name: str, study: ClaimRange) -> Judgement:
    [verdict] = judge((CLAIM[name],), study)
    return verdict.of(Scope.WIDER)


def test_widths_are_twice_eps_times_the_reference_slopes(references: dict[str, Any]) -> None:
    # The slopes of the references have all digits; four sines leave about 1 % in those of modes 1 + 3 and 3 + 3.
    for part, name in ((1.0, "B uniform edge load, in-plane v=0"), (0.5, "C middle-half edge load 2f0, in-plane v=0")):
        slopes = references[f"static: {name}"]["a/b=1 V=3 f0=10"]["sqrtL"]
        found = regions("", MovingPlate(inplane="static", load=middle_part(part)), 0.05, modes=3)
        for (p, q), region in found.items():
            expected = 2 * 0.05 * float(slopes[f"{p}+{q}"])
            assert width(region).predicted == pytest.approx(expected, rel=0.015, abs=1e-9)


def test_regions_that_overlap_do_not_stand_alone() -> None:
    plate = MovingPlate(inplane="static")
    assert regions("", plate, 0.05, modes=3)[1, 1].stands_alone
    assert not regions("", plate, 3.0, modes=3)[1, 1].stands_alone


def test_a_soft_plate_is_not_held_against_theory_beyond_its_range() -> None:
    # At .97 of the divergence speed eps = .05 moves the square of omega_1 by far more than 30 %.
    still = MovingPlate(inplane="static", speed=0.0)
    soft = replace(still, speed=0.97 * still.critical_speed())
    found = regions("", soft, 0.05, modes=3)
    assert not found[1, 1].stands_alone
    assert found[3, 3].stands_alone


@pytest.mark.filterwarnings("ignore::plate.InPlaneGrowthWarning")  # known of the small plate
@pytest.mark.parametrize("claim", CLAIMS, ids=lambda claim: claim.name)
def test_every_claim_is_decided_on_a_small_plate(claim: Claim) -> None:
    [verdict] = judge((claim,), SMALL)
    assert verdict.is_decided
    assert "section" in verdict.statement
    assert [judgement.scope for judgement in verdict.judgements] == list(Scope)
    for judgement in verdict.judgements:
        assert bool(judgement.findings) != bool(judgement.instances.by_construction)
        assert judgement.traced or judgement.instances.by_construction
    json.dumps(verdict.to_dict(), allow_nan=False)


def test_the_verdict_on_higher_regions_depends_on_the_plate() -> None:
    assert _wider("Higher main regions are smaller", SQUARE).verdict is Verdict.HOLDS
    assert _wider("Higher main regions are smaller", SMALL).verdict is Verdict.PARTLY


def test_the_verdict_on_linear_loads_depends_on_poissons_ratio() -> None:
    name = "Stress equals a linear load"
    assert _wider(name, replace(SMALL, poisson_ratios=(0.0,))).verdict is Verdict.HOLDS
    assert _wider(name, replace(SMALL, poisson_ratios=(0.3,))).parts["nu = 0.3: stresses"] == (0, 4)


def test_the_verdict_on_damping_depends_on_its_size() -> None:
    # c = 1e-5 leaves eps = 0.05 well above the tip of 1 + 3, where damping widens it; c = 1e-3 closes 1 + 3.
    widened = _wider("Damping shrinks the regions", SQUARE)
    assert widened.parts["combination regions shrink"] == (0, 1)
    assert _wider("Damping shrinks the regions", replace(SQUARE, dampings=(1e-3,))).verdict is Verdict.HOLDS


def test_damping_shrinks_what_eq_25_draws_without_damping() -> None:
    # The elastic curve of (25) at c = 0 is the widest of all, so that its authors saw every region shrink.
    [verdict] = judge((CLAIM["Damping shrinks the regions"],), SQUARE)
    assert verdict.of(Scope.PAPER).verdict is not Verdict.HOLDS
    assert verdict.of(Scope.LITERAL).verdict is Verdict.HOLDS
    assert verdict.is_decided


def test_the_counter_example_of_narrower_loads_is_the_known_one(references: dict[str, Any]) -> None:
    [check] = _wider("A narrower load shrinks the regions", SQUARE).counter_examples
    slopes = [
        float(references[f"static: {name}"]["a/b=1 V=3 f0=10"]["sqrtL"]["1+3"])
        for name in ("C middle-half edge load 2f0, in-plane v=0", "B uniform edge load, in-plane v=0")
    ]
    # Three sines and five polynomials: a few per cent; the two differ by a factor of five.
    np.testing.assert_allclose([check.left.value, check.right.value], 2 * SMALL.eps * np.array(slopes), rtol=0.1)


def test_a_skew_load_opens_what_symmetry_closes() -> None:
    parts = _wider("Modes 1 and 3 combine most", SQUARE).parts
    assert parts["symmetric load; modes 1, 3 symmetric, mode 2 antisymmetric"] == (4, 4)
    held, total = parts["load not symmetric about the mid-line"]
    assert held < total


def test_inertia_is_judged_under_partial_loads_too() -> None:
    # 2 omega_3 on the middle half: -1.54 % at h/b = .01 with 9 x 9 in-plane functions, within the 2 % that a figure
    # shows; it grows with the square of h/b.
    study = replace(SQUARE, plate=MovingPlate(inplane="static"), thickness_ratios=(0.01, 0.02))
    findings = [
        finding
        for finding in CLAIM["In-plane inertia hardly matters"].instances(study, Scope.WIDER).findings
        if "middle" in finding.part and "2ω₃" in finding.left.name
    ]
    thin, thicker = (1 - finding.right.predicted / finding.left.predicted for finding in findings)
    static, dynamic = (
        regions("", MovingPlate(inplane=inplane, load=middle_part(0.5)), 0.05, modes=3)[3, 3]
        for inplane in ("static", "dynamic")
    )
    assert abs(thin) == pytest.approx(abs(1 - width(dynamic).predicted / width(static).predicted), rel=0.05)
    assert 0.012 < abs(thin) < 0.02 < abs(thicker)
    assert thicker / thin == pytest.approx(4, rel=0.1)


def test_difference_regions_would_be_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    # A theory that mistakes sums for differences must not pass as "no difference-type regions".
    from perturb import TransitionCurve

    def opened(self: TransitionCurve, eps: float) -> tuple[float, float]:
        return self.centre - eps, self.centre + eps

    monkeypatch.setattr(TransitionCurve, "edges", opened)
    judgement = _wider("No difference-type regions", replace(SQUARE, eps=0.0625))  # an eps of its own: no cache
    assert judgement.verdict is Verdict.FAILS
    assert not judgement.is_decided
