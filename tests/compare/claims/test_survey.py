"""The plates of the survey: terms that suffice, the curve of the tick that survives, and eq. (25) as printed."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from compare.claims import ClaimRange, figure_speed
from compare.claims.convergence import FREQUENCY_TOLERANCE, SLOPE_TOLERANCE, converged, terms_left
from compare.claims.literal import VANISHING_EPS_OVER_TIP, literal_edges, slightly_damped
from compare.claims.quantities import regions, width
from perturb import gyroscopic_modes, transition_curves
from plate import EdgeLoad, MovingPlate

# Far more terms than any plate of the survey takes.
FINE = {"axial_terms": 16, "lateral_terms": 12, "inplane_terms": (25, 21)}


def _numbers(plate: MovingPlate) -> tuple[Any, Any]:
    omega = gyroscopic_modes(plate.at(0.0)).frequencies[:3]
    curves = transition_curves(plate, (0.0, 2.001 * omega[2]), types=("sum",))
    slopes = {(c.q, c.p): c.slope for c in curves if c.j == 1 and c.p <= 3}
    return np.array([plate.critical_speed(), *omega]), np.array([slopes[pair] for pair in sorted(slopes)])


@pytest.mark.parametrize(
    ("r", "tension", "fraction", "load"),
    [
        (3.0, 50.0, 0.9, EdgeLoad.partial(0.5)),
        (1.0, 50.0, 0.35, EdgeLoad.partial(0.5, centre=0.25)),
        (2.0, 50.0, 0.7, EdgeLoad.partial(0.5)),
    ],
)
def test_terms_suffice_against_many_more(r: float, tension: float, fraction: float, load: EdgeLoad) -> None:
    # With the terms of a square plate (4 x 7) the first of these has omega_2 wrong by 9 % and a speed of .923 V_cr.
    still = MovingPlate(aspect_ratio=r, tension=tension, speed=0.0, load=load, inplane="static")
    found = converged(still, fraction, 3)
    frequencies, slopes = _numbers(found.plate)
    fine = replace(still, **FINE)
    right_frequencies, right_slopes = _numbers(replace(fine, speed=fraction * fine.critical_speed()))
    # One refinement tells most of what is left: twice the tolerance bounds all of it.
    np.testing.assert_allclose(frequencies, right_frequencies, rtol=2 * FREQUENCY_TOLERANCE)
    least = 0.01 * right_slopes.max()
    assert (np.abs(slopes - right_slopes) <= 2 * SLOPE_TOLERANCE * np.maximum(right_slopes, least)).all()
    assert found.frequency_change < FREQUENCY_TOLERANCE
    assert found.slope_change < SLOPE_TOLERANCE
    assert found.plate.speed == pytest.approx(fraction * found.plate.critical_speed(), rel=1e-12)


def test_terms_that_are_given_are_kept_and_said() -> None:
    given = MovingPlate(axial_terms=2, lateral_terms=3, inplane_terms=(4, 4))
    assert converged(given, None, 2).plate == given
    assert terms_left([converged(given, None, 2)]) == "terms of the plates as given"
    chosen = converged(MovingPlate(inplane="static"), None, 3)
    assert "largest changes left" in terms_left([chosen])


def test_every_figure_has_the_tick_that_survives() -> None:
    study = ClaimRange()
    for f0 in study.figure_tensions:
        speed = figure_speed(study.plate, f0, study.modes)
        plate = MovingPlate(inplane="static", tension=f0, speed=speed, **FINE)
        assert 2 * gyroscopic_modes(plate.at(0.0)).frequencies[2] == pytest.approx(71.0, abs=0.02)
    with pytest.raises(ValueError, match=r"^f0 = -9.3 leaves no speed"):
        figure_speed(study.plate, -9.3, study.modes)


def test_what_the_surviving_captions_cut_off_the_curve() -> None:
    """Fig. 5 has plates of a/b = 2 and, it seems, 3 below divergence; Fig. 4 has a region of modes 1 + 3."""
    study, half = ClaimRange(), EdgeLoad.partial(0.5)

    def exists(f0: float, r: float) -> bool:
        plate = MovingPlate(inplane="static", tension=f0, speed=0.0, load=half, aspect_ratio=r)
        return figure_speed(study.plate, f0, study.modes) < plate.critical_speed()

    assert [exists(f0, 2.0) for f0 in (4.0, 4.5)] == [False, True]
    assert [exists(f0, 3.0) for f0 in (6.5, 7.0)] == [False, True]

    def first_and_third(f0: float) -> float:
        plate = MovingPlate(
            inplane="static", tension=f0, speed=figure_speed(study.plate, f0, study.modes), load=half, axial_terms=8
        )
        return width(regions("", plate, 0.05, modes=3)[1, 3]).predicted

    assert first_and_third(35.0) > 0.1
    assert first_and_third(38.0) == 0.0


def test_literal_edges_are_those_of_eq_25(references: dict[str, Any]) -> None:
    plate = MovingPlate(axial_terms=14, lateral_terms=10)
    [curve] = [c for c in transition_curves(plate, (44.0, 46.0), types=("sum",)) if (c.p, c.q, c.j) == (3, 1, 1)]
    expected = float(references["first_order_membrane"]["a/b=1 V=3 f0=10"]["1+3"]["paper25_alpha0"])
    lower, upper = literal_edges(plate, curve.resonance, 0.1)
    assert (upper - lower) / 0.2 == pytest.approx(expected, rel=1e-4)
    # with damping (25) and the damped theory are the same
    damped = replace(plate, damping=1e-6)
    [same] = [c for c in transition_curves(damped, (44.0, 46.0), types=("sum",)) if (c.p, c.q, c.j) == (3, 1, 1)]
    np.testing.assert_allclose(literal_edges(damped, curve.resonance, 0.1), same.edges(0.1), rtol=1e-9)
    assert np.isnan(literal_edges(replace(plate, damping=1.0), curve.resonance, 0.1)).all()
    tip = 0.1 / VANISHING_EPS_OVER_TIP
    small = slightly_damped(plate, curve.resonance, 0.1)
    [tiny] = [c for c in transition_curves(small, (44.0, 46.0), types=("sum",)) if (c.p, c.q, c.j) == (3, 1, 1)]
    assert tiny.tip == pytest.approx(tip, rel=1e-6)


def test_integration_with_little_damping_finds_the_literal_width() -> None:
    plate = MovingPlate(inplane="static", axial_terms=3, lateral_terms=5, inplane_terms=(6, 6))
    undamped, literal = (regions("", plate, 0.02, modes=3, literal=literal)[1, 3] for literal in (False, True))
    assert width(literal).predicted > 1.5 * width(undamped).predicted
    for region in (undamped, literal):
        assert width(region).measured().value == pytest.approx(width(region).predicted, rel=0.02)
