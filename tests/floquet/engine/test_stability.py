"""From multipliers to verdicts: dominant multiplier, gap, error, and the three answers."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from floquet.engine.stability import (
    DominantMultiplier,
    Stability,
    combine,
    discrepancy,
    dominant_multiplier,
    dominant_of_sums,
    exponent,
    judge,
)
from floquet.kind import Kind

pytestmark = pytest.mark.kernel


@pytest.mark.parametrize("mu", [2.0, -3.0, 1.0001, np.exp(0.3j), 1.5 * np.exp(2.0j), 1e12 * np.exp(1.0j), -1e9])
def test_exponent(mu: Any) -> None:
    found = exponent(complex(mu + 1 / mu), 0.0)
    assert found == pytest.approx((np.log(abs(mu)), abs(np.angle(mu))), rel=1e-7, abs=1e-12)


def test_exponent_of_scaled_sums() -> None:
    # mu = -2^600 does not fit its own square; s and a power of two do
    assert exponent(complex(-1.5), 600.0) == pytest.approx((np.log(1.5) + 600 * np.log(2), np.pi))


def test_dominant() -> None:
    mu = np.array([[0.5, -0.9, 0.1 + 0.2j, 0.1 - 0.2j], [0.8j, -0.8j, 0.3, 0.7]], dtype=complex)
    found = dominant_multiplier(mu, np.array([0.0, 10.0]), np.array([9.0, 0.1]), False)
    assert found.log_modulus == pytest.approx([np.log(0.9), np.log(0.8 * 1024)])
    assert found.angle == pytest.approx([np.pi, np.pi / 2])
    assert found.excess == pytest.approx([10.0, 1.0])
    # relative distance of the dominant one to its nearest neighbour
    assert found.gap == pytest.approx([abs(-0.9 - 0.1 - 0.2j) / 0.9, abs(0.8j - 0.3) / 0.8])


def test_eigenvalues_that_did_not_converge_stop_nothing() -> None:
    mu = np.array([[np.nan, np.nan], [0.5, np.nan]], dtype=complex)
    for found in (
        dominant_multiplier(mu, np.zeros(2), np.ones(2), False),
        dominant_of_sums(mu, np.zeros(2), np.ones(2)),
    ):
        assert np.isfinite(found.excess).all()
        assert judge(found, np.full(2, np.inf), False).kind.tolist() == [Kind.UNDECIDED] * 2


def test_dominant_of_a_reversible_subsystem_looks_at_every_pair() -> None:
    mu = np.exp(1j * np.array([[1.0, -1.0, 2.0, 2.001]]))
    assert dominant_multiplier(mu, np.zeros(1), np.ones(1), True).gap == pytest.approx([0.001], rel=1e-6)


@pytest.mark.parametrize(
    ("mu", "gap"),
    [
        ([np.exp(1j), np.exp(2.5j), np.exp(1.2j)], 2 * np.sin(0.1)),  # all on the circle: the closest two
        ([np.exp(0.05j), np.exp(2j)], 2 * np.sin(0.05)),  # next to +1: the conjugate
        ([np.exp(3.1j), np.exp(2j)], 2 * np.sin(3.1)),  # next to -1
        ([1.2, np.exp(2j)], 2 * np.log(1.2)),  # real: the reciprocal
        ([1.1 * np.exp(1j), 1.1 * np.exp(-1j)], 2 * np.log(1.1)),  # a quadruple
    ],
)
def test_dominant_of_sums(mu: Any, gap: float) -> None:
    mu = np.array([mu], dtype=complex)
    s = np.where(np.abs((mu + 1 / mu).imag) < 1e-15, (mu + 1 / mu).real, mu + 1 / mu)  # of rounding
    found = dominant_of_sums(s, np.zeros(1), np.array([3.0]))
    top = np.abs(mu[0]).argmax()
    assert found.log_modulus == pytest.approx([np.log(np.abs(mu[0]).max())], abs=1e-12)
    assert found.gap == pytest.approx([gap], rel=1e-9)
    assert found.excess == pytest.approx(max(3.0 / max(np.abs(s).max(), 1.0), 1.0))
    if abs(mu[0, top]) > 1.01:
        assert found.angle == pytest.approx([abs(np.angle(mu[0, top]))], abs=1e-9)


def test_discrepancy_is_smooth_where_multipliers_coalesce() -> None:
    # exp(± sqrt(d)) and its perturbation by d -> d + e: the multipliers move by e / (2 sqrt(d)), E by about e
    for d in (1e-2, 1e-4, 1e-6):
        one, other = (np.array([[np.exp(r), np.exp(-r)]], dtype=complex) for r in np.sqrt([d, d + 1e-9]))
        assert discrepancy(one, other)[0] == pytest.approx(1e-9, rel=0.3)


def judged(log_modulus: float, angle: float, gap: float, E: float, conservative: bool) -> Stability:
    return judge(
        DominantMultiplier(*(np.array([x], float) for x in (log_modulus, angle, gap, 1.0))), np.array([E]), conservative
    )


@pytest.mark.parametrize(
    ("log_modulus", "angle", "gap", "conservative", "kind"),
    [
        (0.1, 0.0, 0.2, True, Kind.PLUS_ONE),
        (0.1, np.pi, 0.2, True, Kind.MINUS_ONE),
        (0.1, 1.0, 0.2, True, Kind.COMPLEX),
        (0.0, 1.0, 0.2, True, Kind.STABLE),
        (0.0, 1.0, 1e-6, True, Kind.UNDECIDED),  # two of them may be about to leave the circle
        (1e-7, 0.0, 2e-7, True, Kind.UNDECIDED),
        (-0.1, 1.0, 0.2, False, Kind.STABLE),
        (-1e-11, 1.0, 0.2, False, Kind.UNDECIDED),
        (1e-11, 1.0, 0.2, False, Kind.UNDECIDED),
        (1e-8, 1.0, 0.2, False, Kind.COMPLEX),
        (1e-8, 1.0, 1e-4, False, Kind.UNDECIDED),  # the same, next to another multiplier
        (np.nan, np.nan, np.nan, False, Kind.UNDECIDED),
    ],
)
def test_judge(log_modulus: float, angle: float, gap: float, conservative: bool, kind: Kind) -> None:
    assert judged(log_modulus, angle, gap, 1e-10, conservative).kind[0] == kind


def test_errors() -> None:
    # E / gap, at most sqrt(E), at least E
    for gap, error in ((0.1, 1e-9), (1e-8, 1e-5), (5.0, 1e-10)):
        assert judged(0.1, 1.0, gap, 1e-10, True).error[0] == pytest.approx(error)


def test_combine() -> None:
    def cells(log_modulus: float, error: float, kind: Kind, angle: float = 0.0) -> Stability:
        return Stability(np.array([log_modulus]), np.array([angle]), np.array([error]), np.array([kind], np.int8))

    stable, unstable = cells(-0.5, 1e-3, Kind.STABLE), cells(0.2, 1e-6, Kind.MINUS_ONE, np.pi)
    undecided = cells(0.3, 0.4, Kind.UNDECIDED)
    assert combine([stable, unstable]).kind[0] == Kind.MINUS_ONE
    assert combine([stable, unstable]).log_modulus[0] == 0.2
    assert combine([stable, unstable]).angle[0] == np.pi
    assert combine([stable, undecided]).kind[0] == Kind.UNDECIDED
    both = combine([unstable, undecided])
    assert both.kind[0] == Kind.MINUS_ONE  # unstable, whatever the other does
    # the larger modulus is between 0.2 - 1e-6 and 0.3 + 0.4
    assert both.log_modulus[0] - both.error[0] <= 0.2 - 1e-6
    assert both.log_modulus[0] + both.error[0] >= 0.7 - 1e-12
