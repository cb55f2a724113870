"""Sensitivities against differences of what is computed at neighbouring parameters, and against formulas."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq, minimize_scalar

from floquet import monodromy, trace_boundary
from floquet.modes import edge_sensitivity, exponent_sensitivities, floquet_modes, tip_sensitivity
from periodic import FirstOrderSystem, PeriodicSystem, Term, waveforms
from periodic.examples import coupled_mathieu, mathieu
from tests.sparing import all_but

PLACES, WEIGHTS = (-2, -1, 1, 2), (1 / 12, -8 / 12, 8 / 12, -1 / 12)


def random_question(seed: int) -> tuple[Callable[[float], Any], float]:
    """A random system with a random parameter: a matrix, a waveform, the place of a jump, Omega, eps; and a value."""
    rng = np.random.default_rng(seed)
    n = int(rng.integers(1, 4))

    def matrix(size: float, sign: int = 0) -> np.ndarray:
        X = size * rng.standard_normal((n, n))
        return (X + sign * X.T) / 2 if sign else X

    Omega, eps, value = rng.uniform(0.8, 3), rng.uniform(0.1, 0.6), rng.uniform(0.25, 0.75)
    B = matrix(0.7)
    M, G, C = np.eye(n) + 0.2 * B @ B.T, matrix(0.5, -1), 0.05 * np.eye(n) + matrix(0.05, 1)
    K, F, S, D, N = matrix(1.0, 1) + 3 * np.eye(n), matrix(1.0), matrix(1.0), matrix(0.3, 1), matrix(0.2, 1)
    what = ("stiffness", "damping", "excitation", "mass", "Omega", "eps", "duty", "impulses", "first order")[seed % 9]

    def make(p: float) -> Any:
        terms = []
        if what == "duty":
            terms = [
                Term("stiffness", F, waveforms.rectangular(p, 0.1)),
                Term("mass", N, waveforms.rectangular(p, 0.1)),
            ]
        if what == "mass":
            terms = [Term("mass", p * N, waveforms.cosine(2))]
        if what == "impulses":
            terms = [Term("stiffness", F, waveforms.impulses([0.0, p], [0.5, p]))]
        if what == "first order":
            return FirstOrderSystem(-0.3 * np.eye(n) + B + p * D, [F], terms=[Term("state", S, waveforms.sawtooth())])
        system = PeriodicSystem(
            M, G, C + (p * D if what == "damping" else 0), K + (p * F if what == "stiffness" else 0),
            [F, p * S if what == "excitation" else 0 * S], terms=terms,
        )  # fmt: skip
        return system, Omega + (p if what == "Omega" else 0), eps * (p if what == "eps" else 1)

    if what == "first order":
        return lambda p: (make(p), Omega, eps), value
    return make, value


def difference(make: Callable[[float], Any], value: float, h: float = 2e-4) -> np.ndarray:
    """Derivatives of the exponents by differences of fourth order; each matched with the nearest one."""
    here = floquet_modes(*make(value)).exponents
    total = np.zeros(len(here), complex)
    for place, weight in zip(PLACES, WEIGHTS, strict=True):
        modes = floquet_modes(*make(value + place * h))
        for i, exponent in enumerate(here):
            turns = np.rint((exponent - modes.exponents).imag / modes.Omega)
            on_branch = modes.exponents + 1j * turns * modes.Omega
            total[i] += weight * on_branch[np.abs(on_branch - exponent).argmin()]
    return total / h


@pytest.mark.parametrize("seed", all_but(range(6, 18), range(18)))
def test_sensitivities_of_random_exponents_are_differences(seed: int) -> None:
    make, value = random_question(seed)
    found = exponent_sensitivities(make, value)
    if found.clusters:
        pytest.skip("multipliers meet: their means are tested below")
    expected = difference(make, value)
    np.testing.assert_allclose(found.exponents, expected, rtol=1e-6, atol=1e-6 * (1 + np.abs(expected).max()))
    np.testing.assert_array_equal(found.growth_rates, found.exponents.real)


def test_damping_of_free_oscillators_by_hand() -> None:
    """lambda = -c/2 + i sqrt(k - c^2 / 4): exact derivatives."""
    found = exponent_sensitivities(
        lambda k: PeriodicSystem([[1.0]], damping=[[0.2]], stiffness=[[k]]), 2.0, Omega=1.1, eps=0.0
    )
    exact = 1j / (2 * np.sqrt(2 - 0.01))
    np.testing.assert_allclose(found.exponents, [exact, exact.conjugate()], rtol=1e-10)


def test_where_multipliers_meet_the_mean_has_a_derivative() -> None:
    """On an edge two multipliers are -1: none has a derivative, their mean growth rate is -c/2 for any damping c."""
    traced = trace_boundary(mathieu(), 2.0, [0.3]).lower[0]  # to 1e-10: not near enough for multipliers that meet
    near = (1 - 1e-6) * traced, (1 + 1e-6) * traced
    edge = brentq(lambda Omega: np.trace(monodromy(mathieu(), Omega, 0.3).matrix) + 2, *near, xtol=1e-15, rtol=1e-15)
    found = exponent_sensitivities(
        lambda c: PeriodicSystem([[1.0]], damping=[[c]], stiffness=[[1.0]], cosine=[[[1.0]]]), 0.0, Omega=edge, eps=0.3
    )
    assert found.clusters == ((0, 1),)
    np.testing.assert_allclose(found.growth_rates, -0.5, atol=1e-6)


def test_equal_exponents_of_symmetric_coordinates_have_a_mean() -> None:
    """A round shaft: k1 grows, k2 does not; the mean of the two is a half of a single one's derivative."""
    found = exponent_sensitivities(
        lambda k: PeriodicSystem(np.eye(2), damping=0.1 * np.eye(2), stiffness=np.diag([k, 1.0])), 1.0, Omega=2.7, eps=0
    )
    assert [len(cluster) for cluster in found.clusters] == [2, 2]
    exact = 0.5j / (2 * np.sqrt(1 - 0.0025))
    np.testing.assert_allclose(found.exponents, np.where(found.modes.frequencies > 0, exact, -exact), rtol=1e-8)


def _oscillators(k: float, c: float = 0.0) -> PeriodicSystem:
    return PeriodicSystem(
        np.eye(2), damping=c * np.eye(2), stiffness=np.diag([k, 5.0]), cosine=[[[1.0, 0.5], [0.5, 1.0]]]
    )


@pytest.mark.parametrize("damping", [0.0, 0.02])
@pytest.mark.parametrize("near", [2.0, 1 + np.sqrt(5)])
@pytest.mark.parametrize("side", ["lower", "upper"])
def test_sensitivities_of_edges_are_differences_of_traces(damping: float, near: float, side: str) -> None:
    def edge(k: float) -> float:
        centre = near if near == 2.0 else 1.0 + np.sqrt(5)
        return float(getattr(trace_boundary(_oscillators(k, damping), centre, [0.3]), side)[0])

    h = 1e-3
    expected = sum(weight * edge(1 + place * h) for place, weight in zip(PLACES, WEIGHTS, strict=True)) / h
    found = edge_sensitivity(lambda k: _oscillators(k, damping), 1.0, edge(1.0), 0.3)
    assert abs(found - expected) < 1e-6 * max(1, abs(expected))


def _tip(c: float) -> tuple[float, float]:
    """Where the growth rate of Mathieu's first region is zero and largest in Omega, by nested searches."""

    def best(eps: float) -> tuple[float, float]:
        def loss(Omega: float) -> float:
            return -monodromy(mathieu(damping=c), Omega, eps).growth_rate

        found = minimize_scalar(loss, bracket=(1.97, 1.99, 2.01), options={"xtol": 1e-7})
        return float(found.x), -float(found.fun)

    eps = float(brentq(lambda eps: best(eps)[1], 2 * c * 0.9, 2 * c * 1.1, xtol=1e-12))
    return best(eps)[0], eps


def test_sensitivity_of_a_tip_is_the_difference_of_tips() -> None:
    """The tip of Mathieu's first region is near eps = 2 c."""
    c, h = 0.1, 2e-3
    expected = (_tip(c + h)[1] - _tip(c - h)[1]) / (2 * h)
    found = tip_sensitivity(lambda c: mathieu(damping=c), c, *_tip(c))
    assert abs(found - expected) < 1e-5 * abs(expected)
    assert 1.9 < found < 2.1


def test_points_that_are_no_edges_are_refused() -> None:
    with pytest.raises(ValueError, match="on no edge"):
        edge_sensitivity(lambda c: mathieu(damping=c), 0.1, 1.5, 0.1)
    with pytest.raises(ValueError, match=r"eps = 0\.0"):
        tip_sensitivity(lambda c: mathieu(damping=c), 0.1, 2.0, 0.0)
    with pytest.raises(ValueError, match="on no edge"):
        tip_sensitivity(lambda c: mathieu(damping=c), 0.0, 2.0, 0.1)
    with pytest.raises(ValueError, match="make = 3"):
        exponent_sensitivities(3, 0.1)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="do not say where"):
        exponent_sensitivities(lambda c: coupled_mathieu(), 0.1)
