"""Second order of any linear periodic system: gaps against edges found on the multipliers, and what is refused."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from scipy.optimize import brentq

from floquet import monodromy
from periodic import FirstOrderSystem, PeriodicSystem, Term, waveforms
from perturb import TransitionCurve, transition_curves
from tests.general_systems import Reference, references_general
from tests.perturb.general.general_oracles import with_terms
from tests.perturb.perturb_oracles import fitted_order

EPS = (0.003, 0.009)
# damping goes down with eps, as multiple scales orders it
DAMPING = 0.02


def theory(seed: int, label: str, eps: float, order: int) -> TransitionCurve:
    curves = transition_curves(with_terms(seed, DAMPING * eps), (1.5, 4.0), order, ("sum",))
    return next(curve for curve in curves if curve.label == label)


@cache
def integrated(seed: int, label: str, eps: float) -> tuple[float, ...]:
    """Edges from the largest multiplier."""
    lower, upper = (float(edge) for edge in theory(seed, label, eps, 2).edges(eps))
    system, reach = with_terms(seed, DAMPING * eps), 0.05 * (upper - lower)
    rate = [lambda Omega: monodromy(system, Omega, eps).growth_rate]
    return tuple(float(brentq(rate[0], edge - reach, edge + reach, xtol=1e-12)) for edge in (lower, upper))


@pytest.mark.parametrize(("order", "expected", "band"), [(1, 2.0, 0.1), (2, 3.0, 0.15)])
@pytest.mark.parametrize("label", ["2ω₁", "ω₁+ω₂"])
@pytest.mark.parametrize("seed", [0, 1])
def test_gap_to_integrated_edges_has_its_order(seed: int, label: str, order: int, expected: float, band: float) -> None:
    gaps = [np.subtract(theory(seed, label, eps, order).edges(eps), integrated(seed, label, eps)) for eps in EPS]
    assert fitted_order(np.array(EPS), np.abs(gaps).max(axis=1)) == pytest.approx(expected, abs=band)


@pytest.mark.parametrize(
    ("name", "eps", "label", "part"),
    [
        ("mems_a0.1", 0.2, "2ω₁", 1e-3),
        ("pipe_u2.0_b0.5", 0.05, "ω₁+ω₂", 1e-3),
        ("sls3_a", 0.2, "2ω₁", 1e-3),
        ("meissner_d0.3_c0_zero", 0.1, "2ω₁", 1e-3),
        ("kick1_z0.0", 0.1, "2ω₁", 2e-3),
        ("circulatory_difference_a", 0.2, "ω₂−ω₁", 1e-3),
        ("beam_material_weak_v1.0", 0.1, "2ω₁", 1e-3),
        ("string_v0.3_N4", 0.05, "2ω₁", 1e-3),
    ],
)
def test_edges_of_the_references_to_second_order(name: str, eps: float, label: str, part: float) -> None:
    """Gap of both edges as a part of the width, where that was measured to be a fraction of ``part``."""
    entries = [
        entry
        for entry in references_general()["entries"]
        if entry["quantity"] == "edges" and entry["system"] == name and entry["eps"] == eps
    ]
    widths = []
    for entry in entries:
        lower, upper = entry["value"].values() if "lower" in entry["value"] else entry["value"]["all"]
        middle = 0.5 * (lower + upper)
        for curve in transition_curves(Reference(name, eps), (0.95 * middle, 1.05 * middle), 2):
            if curve.label == label:
                gap = np.abs(np.subtract(curve.edges(eps), (lower, upper))).max()
                widths.append(float(gap) / (upper - lower))
    assert min(widths) < part


def test_direct_second_harmonics_compete_with_two_interactions() -> None:
    """(1 + eps cos)^2 has eps^2 cos 2 theta: with it and without it the region of 2 Omega = 2 omega differs."""
    pull = Term("stiffness", [[-0.2]], waveforms.cosine())
    squares = [Term("stiffness", [[-0.05]], g, 2) for g in (waveforms.constant(), waveforms.cosine(2))]
    both, once = (PeriodicSystem([[1.0]], stiffness=[[0.9]], terms=terms) for terms in ([pull, *squares], [pull]))
    widths = []
    for family in (both, once):
        (curve,) = [c for c in transition_curves(family, (0.8, 1.1), 2) if c.j == 2]
        lower, upper = curve.edges(0.3)
        widths.append(float(upper - lower))
        assert widths[-1] > 1e-4
        for edge, side in ((lower, -1), (upper, 1)):
            inside, outside = (monodromy(family, edge - side * step, 0.3).growth_rate for step in (2e-4, -2e-4))
            assert inside > 1e-4
            assert outside < 1e-6
    assert max(widths) > 1.5 * min(widths)


def test_a_real_eigenvalue_resonates_with_a_mode_and_its_conjugate() -> None:
    """Omega = omega_1 joins x_3 (decay d) to both: three states, exact to first order."""
    d, c = 0.02, 0.01
    A = np.array([[-c, 1.0, 0.0], [-1.0, -c, 0.0], [0.0, 0.0, -d]])
    push = np.zeros((3, 3))
    push[0, 2] = push[2, 0] = 1.0
    system = FirstOrderSystem(A, cosine=push)
    (curve,) = transition_curves(system, (0.9, 1.1))
    assert curve.centre == pytest.approx(1.0, abs=1e-12)
    for Omega, eps in ((1.0, 0.05), (1.01, 0.08)):
        exact = monodromy(system, Omega, eps).growth_rate
        assert float(curve.growth_rate(Omega, eps)) == pytest.approx(exact, abs=eps**2)
    assert float(curve.growth_rate(1.0, 0.08)) > 0.005


def test_jumping_mass_keeps_the_momentum() -> None:
    system = PeriodicSystem([[1.0]], stiffness=[[1.0]], terms=[Term("mass", [[1.0]], waveforms.rectangular())])
    (curve,) = transition_curves(system, (1.8, 2.2), 2)
    eps = 0.05
    lower, upper = (float(edge) for edge in curve.edges(eps))
    inside, width = 0.5 * (lower + upper), upper - lower
    assert width > 0.01
    for edge, side in ((lower, -1), (upper, 1)):
        found = brentq(
            lambda x: monodromy(system, x, eps).growth_rate - 1e-6, inside, edge + side * 0.3 * width, xtol=1e-10
        )
        assert found == pytest.approx(edge, abs=0.01 * width)


def test_a_mode_that_grows_by_itself_has_no_tip() -> None:
    system = PeriodicSystem([[1.0]], damping=[[-0.02]], stiffness=[[1.0]], cosine=[[1.0]])
    (curve,) = transition_curves(system, (1.8, 2.2))
    assert curve.tip == 0
    assert float(curve.growth_rate(2.0, 0.0)) == pytest.approx(0.01, rel=1e-12)


@pytest.mark.parametrize(
    "system",
    [
        FirstOrderSystem([[-0.1, 1.0, 0.0], [0.0, -0.1, 0.0], [0.0, 0.0, -1.0]], cosine=np.ones((3, 3))),
        PeriodicSystem(np.eye(2), stiffness=[[1.0, 1.0], [0.0, 1.0]], cosine=np.eye(2)),
        PeriodicSystem([[1.0]], damping=[[2.0]], stiffness=[[1.0]], terms=[Term("damping", [[1.0]])]),
    ],
)
def test_defective_eigenvalues_are_refused(system: PeriodicSystem | FirstOrderSystem) -> None:
    with pytest.raises(ValueError, match="defective"):
        transition_curves(system, (0.1, 3.0))
