"""First order of any linear periodic system: published slopes, the closed form of webs, and the theory of eq. (11)."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from periodic import PeriodicSystem
from perturb import TransitionCurve, gyroscopic_modes, transition_curves
from perturb.general import general_transition_curves
from perturb.resonant_pair import ResonantPair
from perturb.resonant_states import ResonantStates
from tests.general_systems import Reference, references_general
from tests.perturb.general.general_oracles import Web
from tests.perturb.perturb_oracles import random_system

SLOPES = [entry for entry in references_general()["entries"] if entry["quantity"] == "first_order_slope"]


def pair(curve: TransitionCurve) -> ResonantPair:
    """The closed form of a resonance by itself."""
    assert isinstance(curve.first, ResonantStates)
    assert isinstance(curve.first.first, ResonantPair)
    return curve.first.first


@pytest.mark.parametrize("entry", SLOPES, ids=lambda entry: entry["id"])
def test_slopes_and_decay_of_the_references(entry: dict[str, Any]) -> None:
    centre, value = entry["centre"], complex(*entry["value"])
    near = (centre * (1 - 1e-6), centre * (1 + 1e-6))
    found = [c for c in general_transition_curves(Reference(entry["system"]), near, 1, (entry["kind"],)) if c.j == 1]
    slopes = [np.sqrt(complex(pair(curve).L)) / abs(pair(curve).detuning.rate) for curve in found]
    # the file takes the two modes in either order, which conjugates L
    errors = [
        min(abs(abs(slope.real) - abs(value.real)) + abs(abs(slope.imag) - abs(value.imag)), 9) for slope in slopes
    ]
    best = int(np.argmin(errors))
    assert errors[best] <= 1e-6 * abs(value) + 1e-12
    curve = found[best]
    assert curve.centre == pytest.approx(centre, rel=1e-10)
    decay = sorted(float(C) / 2 for C in (pair(curve).C_p, pair(curve).C_q))
    assert decay == pytest.approx(sorted([entry["decay_p"], entry["decay_q"]]), abs=1e-10)
    if value.imag == 0 and entry["decay_p"] == entry["decay_q"] and not curve.coincident:
        assert curve.slope == pytest.approx(value.real, rel=1e-6, abs=1e-12)


@pytest.mark.parametrize(("rigidity", "tension"), [(0.64, 0.0), (0.3, 0.7)])
def test_webs_of_pulsating_speed_and_tension_have_the_closed_form(rigidity: float, tension: float) -> None:
    """L = ± omega_p omega_q |w_p^H E_pq conj(w_q)|^2 / 4, E_pq = i (omega_p ∓ omega_q) v1 B + (a - 2 v0 v1) S."""
    web = Web(1.3, rigidity, tension, 4)
    modes = gyroscopic_modes(PeriodicSystem(np.eye(4), 2 * web.v0 * web.B, None, web.K))
    curves = [c for c in transition_curves(web, (1.0, 500.0)) if c.j == 1]
    assert len(curves) == 16
    assert {c.type for c in curves} == {"sum", "difference"}
    for curve in curves:
        sign = 1 if curve.type == "sum" else -1
        omega_p, omega_q = (modes.frequencies[k - 1] for k in (curve.p, curve.q))
        w_p, w_q = (modes.vectors[:, k - 1] for k in (curve.p, curve.q))
        E = 1j * (omega_p - sign * omega_q) * web.v0 * web.B - (2 * web.v0**2 - tension) * web.S
        L = sign * omega_p * omega_q * abs(w_p.conj() @ E @ (w_q.conj() if sign > 0 else w_q)) ** 2 / 4
        assert complex(pair(curve).L) == pytest.approx(L, rel=1e-10, abs=1e-10)
        assert curve.centre == pytest.approx(omega_p + sign * omega_q, rel=1e-12)


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize(
    ("options", "eps"),
    [
        ({"n": 2}, [0.01, 0.05]),
        ({"n": 3, "harmonics": 2}, [0.01, 0.05]),
        ({"n": 2, "symmetric": False}, [0.01, 0.05]),
        ({"n": 2, "damping": 1e-6}, [1e-5, 1e-4]),
    ],
)
@pytest.mark.parametrize("seed", [0, 1])
def test_systems_of_eq_11_give_what_their_own_theory_gives(
    seed: int, options: dict[str, Any], eps: list[float], order: int
) -> None:
    system = random_system(seed, **options)
    window, types = (0.3, 4.0), ("sum", "difference")
    general = {c.resonance[:4]: c for c in general_transition_curves(system, window, order, types)}
    paper = transition_curves(system, window, order)
    assert len(paper) > 2
    for expected in paper:
        curve = general[expected.resonance[:4]]
        assert curve.centre == pytest.approx(expected.centre, rel=1e-10)
        assert curve.coincident == expected.coincident
        assert curve.eps_max == pytest.approx(expected.eps_max, rel=1e-5)
        np.testing.assert_allclose(curve.edges(eps), expected.edges(eps), rtol=1e-9)
        if expected.type == "sum":
            assert curve.slope == pytest.approx(expected.slope, rel=1e-8)
            assert curve.tip == pytest.approx(expected.tip, rel=1e-5)


def test_damping_that_is_not_small_is_exact_in_the_general_theory() -> None:
    """x'' + 2 z x' + (1 + eps cos) x = 0 is a Mathieu equation of stiffness 1 - z^2 for e^{z t} x."""
    z = 0.3
    system = PeriodicSystem([[1.0]], damping=[[2 * z]], stiffness=[[1.0]], cosine=[[1.0]])
    (curve,) = general_transition_curves(system, (1.5, 2.5), 1, ("sum",))
    omega = np.sqrt(1 - z**2)
    assert curve.centre == pytest.approx(2 * omega, rel=1e-14)
    assert curve.tip == pytest.approx(4 * z * omega, rel=1e-10)
