"""Motions of reduced models followed into the whole ones: the exponents are those of the whole monodromy matrix."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from compare import check_whole_model
from floquet import monodromy
from periodic import SparseSystem, Term, waveforms
from reduction import ReducedModel, reduce_model
from tests.sparse_models import moving_beam, square_plate


def both(model: ReducedModel, Omega: float, eps: float) -> tuple[float, float]:
    """Growth rates of the whole model: by the check, and by its monodromy matrix."""
    check = check_whole_model(model, Omega, eps)
    assert check.converged
    assert check.coordinates > model.size
    assert check.difference > 0
    return check.whole.real, monodromy(model.whole.restricted(np.eye(model.whole.size)), Omega, eps).growth_rate


@pytest.mark.parametrize("speed", [0.0, 2.0])
def test_of_a_beam(speed: float) -> None:
    model = reduce_model(moving_beam(8, speed), (2.0, 40.0))
    mine, exact = both(model, 2 * float(model.frequencies[0]), 4.0)
    assert exact > 0.1
    assert mine == pytest.approx(exact, abs=1e-9)
    reduced = monodromy(model, 2 * float(model.frequencies[0]), 4.0).growth_rate
    assert abs(reduced - exact) > 1e-6  # what was found is not the reduced model's


def test_of_a_damped_system_with_a_square_wave() -> None:
    beam = moving_beam(8, 0.0)
    wave = Term("stiffness", beam.terms[0].matrix, waveforms.rectangular())
    system = SparseSystem(beam.mass, damping=1e-4 * beam.stiffness, stiffness=beam.stiffness, terms=[wave])
    mine, exact = both(reduce_model(system, (2.0, 30.0)), 17.0, 2.0)
    assert mine == pytest.approx(exact, abs=1e-6)  # a square wave's series ends somewhere


def test_a_large_plate_is_looked_at_without_its_monodromy_matrix() -> None:
    model = reduce_model(square_plate(14), (20.0, 60.0))
    check = check_whole_model(model, 39.5, 8.0)
    assert check.converged
    assert check.whole.real > 0.1
    assert check.difference < 1e-2


@pytest.mark.parametrize(
    ("change", "wanted"),
    [({"model": 3}, "model = 3 is no ReducedModel"), ({"Omega": -1.0}, "Omega"), ({"motion": 99}, "motion = 99")],
)
def test_bad_input(change: dict[str, Any], wanted: str) -> None:
    given = {"model": reduce_model(moving_beam(8, 0.0), (2.0, 40.0)), "Omega": 17.0, "eps": 1.0, "motion": 0}
    with pytest.raises(ValueError, match=wanted):
        check_whole_model(**given | change)
