"""Why a region was taken together with others, or not compared, on plates where theory by pairs of modes misleads."""

from __future__ import annotations

from dataclasses import replace

from compare import Basis, Outcome, agreement
from plate import EdgeLoad, MovingPlate
from plate.distribution import Distribution


def test_tensioned_webs_with_internal_resonance_agree_and_say_with_what() -> None:
    # a tensioned web is nearly a string: omega_7 = 3 omega_1, so that omega_7 - omega_1 lies at 2 omega_1
    web = MovingPlate(aspect_ratio=2, speed=60, tension=2e4, axial_terms=6, lateral_terms=3)
    verdicts = {one.label: one for one in agreement(web, (364.0, 369.0), modes=3, types=("sum",))}
    for label, other in (("2ω₁", "ω₇−ω₁"), ("2ω₂", "ω₈−ω₂"), ("2ω₃", "ω₉−ω₃")):
        assert verdicts[label].agrees, verdicts[label].reason
        assert verdicts[label].basis is Basis.EDGES
        assert other in verdicts[label].coincident
    assert verdicts["ω₁+ω₃"].outcome is not Outcome.DISAGREES
    assert verdicts["ω₁+ω₃"].coincident


def test_a_tip_that_first_and_second_order_see_elsewhere_is_named() -> None:
    # integration finds nothing at eps = 0.3, three times the tip by first order
    load = EdgeLoad.uniform().with_waveform({1: (1, 0), 2: (0.3, Distribution.from_samples([0, 1], [-1, 1]))})
    still = MovingPlate(
        speed=0.0,
        aspect_ratio=3,
        tension=10,
        poisson_ratio=0.49,
        inplane="static",
        damping=1e-3,
        load=load,
        axial_terms=3,
        lateral_terms=2,
    )
    plate = replace(still, speed=0.7 * still.critical_speed())
    (half,) = (one for one in agreement(plate, (6.2, 6.26)) if one.label == "2ω₃/2")
    assert (half.outcome, half.basis) == (Outcome.NOT_COMPARED, Basis.DAMPED)
    assert "eps = 0.09621, second order at 0.4955" in half.reason
