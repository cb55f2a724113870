"""`agreement` of systems with any terms, of first order, with jumps; of pulsating webs to both orders of theory."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
import pytest

from beam import MovingBeam
from compare import Outcome, agreement
from periodic import AnyFamily, FirstOrderSystem, PeriodicSystem, Term, waveforms
from plate import MovingPlate

BANDS = {1: 0.1, 2: 0.15}


def damped_gyroscopic(seed: int) -> PeriodicSystem:
    """Stiffness and mass that pulsate out of step, and a harmonic that goes with eps^2."""
    rng = np.random.default_rng(seed)
    S = [X + X.T for X in rng.standard_normal((3, 2, 2))]
    terms = [
        Term("stiffness", 0.3 * S[0]),
        Term("mass", 0.1 * S[1], waveforms.sine()),
        Term("stiffness", 0.3 * S[2], waveforms.cosine(2), power=2),
    ]
    damping = 0.004 * np.diag(rng.uniform(0.5, 1.5, 2))
    G = 0.4 * np.array([[0, 1], [-1, 0]])
    return PeriodicSystem(np.eye(2), G, damping, np.diag([1.0, rng.uniform(1.5, 2.2)]), terms=terms)


PLATE = MovingPlate(speed_amplitude=1.0, load_amplitude=0.0, axial_terms=2, lateral_terms=2)
SUBJECTS: dict[str, tuple[AnyFamily, tuple[float, float]]] = {
    "beam": (MovingBeam(2.0, 0.64), (9.0, 12.0)),
    "string": (MovingBeam(0.3, 0.0, terms=3), (5.0, 7.0)),
    "plate": (PLATE, (17.0, 22.0)),
    "damped gyroscopic 0": (damped_gyroscopic(0), (1.9, 3.9)),
    "damped gyroscopic 1": (damped_gyroscopic(1), (1.7, 3.9)),
}


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("name", SUBJECTS)
def test_the_gap_falls_by_the_order_of_the_theory(name: str, order: Literal[1, 2]) -> None:
    family, window = SUBJECTS[name]
    modes = 1 if name in ("beam", "string", "plate") else 2
    found = agreement(family, window, order=order, modes=modes, types=("sum",), n_jobs=1)
    assert found
    assert [one.label for one in found if one.outcome is not Outcome.AGREES] == []
    orders = np.array([one.order for one in found if one.j == 1])
    assert np.abs(orders - (order + 1)).min() <= BANDS[order]


CIRCULATING = np.array([[0, 1, 0.2], [-1, -0.02, 0.1], [0.1, 0, -0.5]])
OTHERS: dict[str, tuple[Any, tuple[float, float]]] = {
    "first order, three states": (
        FirstOrderSystem(CIRCULATING, terms=[Term("state", [[0, 0, 0], [0.5, 0.1, 0], [0, 0, 0.2]])]),
        (1.5, 2.5),
    ),
    "a square wave": (
        PeriodicSystem(
            [[1.0]], damping=[[0.01]], stiffness=[[1.0]], terms=[Term("stiffness", [[1.0]], waveforms.rectangular(0.4))]
        ),
        (0.8, 2.5),
    ),
}


@pytest.mark.parametrize("name", OTHERS)
def test_first_order_systems_and_jumps(name: str) -> None:
    found = agreement(*OTHERS[name], n_jobs=1)
    assert found
    assert all(one.outcome is Outcome.AGREES for one in found)


def test_what_is_unstable_without_excitation_is_not_compared() -> None:
    fed = PeriodicSystem(
        np.eye(2), damping=np.diag([-0.06, 0.06]), stiffness=np.diag([1, 0.6]), cosine=[[1, 0.5], [0.5, 1]]
    )
    found = agreement(fed, (1.5, 2.5), n_jobs=1)
    assert found
    assert all(one.outcome is Outcome.NOT_COMPARED for one in found)
    assert all("unstable (see perturb.general.stable_windows)" in one.reason for one in found)
