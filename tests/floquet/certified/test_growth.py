"""Certified growth rates and verdicts: exact boundaries, other systems with the same answer, bad input."""

from __future__ import annotations

import importlib
import sys
from typing import Any

import numpy as np
import pytest
from scipy.special import mathieu_a, mathieu_b

from periodic import PeriodicSystem
from periodic.examples import coupled_mathieu, gyroscopic_rotor, mathieu, meissner
from tests.floquet.certified.certified_oracles import OMEGA, random_system, whittaker_hill

flint = pytest.importorskip("flint", reason="python-flint, the extra certify, is not installed")
from flint import arb, ctx  # noqa: E402

from floquet.certified import (  # noqa: E402
    CertifiedGrowth,
    ProvedVerdict,
    certified_growth,
    certified_monodromy,
    growth,
    spectrum,
)

# Verdicts


@pytest.mark.parametrize("q", [0.1, 0.7, 2.0, 5.0])
@pytest.mark.parametrize("order", [1, 2, 3])
def test_mathieu_boundaries(order: int, q: float) -> None:
    """DLMF 28.2(v), 28.17: with delta = a, Omega = 2, eps = 2 q, stable from a_{n-1} to b_n, unstable from b_n to a_n.

    The third region at q = 0.1 is 3e-5 wide, thirty times the distance to its edges.
    """
    lower, upper = sorted((float(mathieu_a(order, q)), float(mathieu_b(order, q))))
    for edge, inwards in ((lower, 1e-6), (upper, -1e-6)):
        inside = certified_growth(mathieu(edge + inwards), 2.0, 2 * q)
        outside = certified_growth(mathieu(edge - inwards), 2.0, 2 * q)
        assert (inside.verdict, outside.verdict) == (ProvedVerdict.UNSTABLE, ProvedVerdict.STABLE)
        assert 0 < inside.lower <= inside.upper < inside.lower * (1 + 1e-12)
        assert outside.lower == outside.upper == 0


@pytest.mark.parametrize(("Omega", "eps"), [(2.0, 0.3), (1.9, 0.5), (1.0, 0.4), (3.0, 0.3)])
def test_damping_shifts_mathieus_growth(Omega: float, eps: float) -> None:
    """x = e^{-d t / 2} y with delta - d^2 / 4 for delta: exact, also in float64 for d = 1/4."""
    damped = certified_growth(mathieu(1.0, damping=0.25), Omega, eps)
    undamped = certified_growth(mathieu(1.0 - 1 / 64), Omega, eps)
    assert damped.lower <= undamped.upper - 0.125
    assert damped.upper >= undamped.lower - 0.125
    assert damped.verdict is (ProvedVerdict.UNSTABLE if undamped.lower > 0.125 else ProvedVerdict.STABLE)


def overlap(a: CertifiedGrowth, b: CertifiedGrowth) -> bool:
    return a.verdict is b.verdict and max(a.lower, b.lower) <= min(a.upper, b.upper)


@pytest.mark.parametrize(("Omega", "eps"), [(4.0, 0.5), (3.7, 0.5), (2.0, 1.0), (1.3, 2.0)])
@pytest.mark.parametrize("spin", [0.0, 0.5, 3.0])
def test_round_rotor_is_mathieu(spin: float, Omega: float, eps: float) -> None:
    rotor = certified_growth(gyroscopic_rotor((16.0 / 4, 16.0 / 4), spin), Omega, eps)
    assert overlap(rotor, certified_growth(mathieu(4.0), Omega, eps))


@pytest.mark.parametrize(("Omega", "eps"), [(2.0, 0.3), (2.3, 0.3), (1.0, 0.6), (1.05, 0.1), (2.0 + 0.15, 0.3)])
def test_equal_coupled_oscillators_are_mathieu_twice(Omega: float, eps: float) -> None:
    """x1 + x2 and x1 - x2 have the same multipliers: all double, all definite, so no two can be told apart."""
    coupled = certified_growth(coupled_mathieu(frequencies=(1.0, 1.0)), Omega, eps)
    assert overlap(coupled, certified_growth(mathieu(1.0), Omega, eps))


@pytest.mark.parametrize(("kind", "inside", "outside"), [("sum", 2.7, 0.7), ("difference", 0.7, 2.7)])
def test_combination_resonance(kind: str, inside: float, outside: float) -> None:
    system = coupled_mathieu(kind)
    assert certified_growth(system, inside, 0.2).verdict is ProvedVerdict.UNSTABLE
    assert certified_growth(system, outside, 0.2).verdict is ProvedVerdict.STABLE


@pytest.mark.parametrize("seed", range(12))
def test_both_proofs_of_stability_agree(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Simple multipliers on the circle, and a definite invariant form: each decides what the other does."""
    system = random_system(seed, 3, conservative=True)
    Omega, eps = 1.0 + 0.2 * seed, 0.8
    simple = certified_growth(system, Omega, eps)
    monkeypatch.setattr(growth, "on_unit_circle", lambda discs: False)
    assert overlap(certified_growth(system, Omega, eps), simple)


def test_a_definite_form_is_found_only_where_there_is_one(monkeypatch: pytest.MonkeyPatch) -> None:
    """The proof by an invariant form does not rest on the discs: without them, unstable points stay undecided."""
    monkeypatch.setattr(growth, "largest_modulus", lambda discs: (arb(0), arb(10)))
    monkeypatch.setattr(growth, "on_unit_circle", lambda discs: False)
    for Omega, verdict in ((1.9, ProvedVerdict.UNDECIDED), (2.3, ProvedVerdict.STABLE)):
        assert certified_growth(mathieu(), Omega, 0.3, max_bits=128).verdict is verdict


def discs_of(*discs: tuple[complex, float]) -> spectrum.Discs:
    centres = [flint.acb(centre.real, centre.imag) for centre, _ in discs]
    return spectrum.Discs(centres, [arb(radius) for _, radius in discs], flint.acb_mat(0, 0))


def test_touching_discs_share_their_multipliers() -> None:
    """Both of two overlapping discs' multipliers may be in either disc."""
    lower, upper = spectrum.largest_modulus(discs_of((2 + 0j, 0.25), (1.5 + 0j, 1.0), (0.75j, 0.125)))
    assert (float(lower), float(upper)) == (0.625, 2.5)
    lower, upper = spectrum.largest_modulus(discs_of((2 + 0j, 0.25), (-1.5 + 0j, 1.0)))
    assert (float(lower), float(upper)) == (1.75, 2.5)


def test_only_a_disc_that_reflects_into_itself_is_on_the_circle() -> None:
    assert spectrum.on_unit_circle(discs_of((0.6 + 0.8j, 0.01), (0.6 - 0.8j, 0.01)))
    assert not spectrum.on_unit_circle(discs_of((1.1 + 0j, 0.05), (1 / 1.1 + 0j, 0.05)))
    assert not spectrum.on_unit_circle(discs_of((0.6 + 0.8j, 0.01), (0.6 + 0.805j, 0.01)))
    assert not spectrum.on_unit_circle(discs_of((0.01 + 0j, 0.02), (5.0 + 0j, 0.02)))


@pytest.mark.parametrize("phase", ["cosine", "sine"])
@pytest.mark.parametrize("kappa", [0.25, 0.5, 1.5])
def test_a_boundary_is_undecided(kappa: float, phase: str) -> None:
    """u = exp(-kappa cos Omega t) has the period T: mu = 1 is double, defective, and on a boundary exactly."""
    found = certified_growth(whittaker_hill(kappa, phase=phase), OMEGA, 1.0)
    assert found.verdict is ProvedVerdict.UNDECIDED
    assert found.lower == 0
    assert 0 <= found.upper < 1e-60


def test_defective_multiplier_off_the_circle() -> None:
    """The same with decay: the rate is the decay exactly, however ill-conditioned the eigenvectors."""
    found = certified_growth(whittaker_hill(0.5, 0.25, 0.125), OMEGA, 1.0)
    assert found.verdict is ProvedVerdict.STABLE
    assert -0.125 - 1e-10 < found.lower <= -0.125 <= found.upper < -0.125 + 1e-10
    assert certified_growth(whittaker_hill(0.5, 0.25, -0.125), OMEGA, 1.0).verdict is ProvedVerdict.UNSTABLE


def test_precision_is_raised_until_decided() -> None:
    """At Omega = 2 omega the growth rate is eps / (4 omega) (1 + O(eps^2)); 1e-60 is far beyond 128 bits."""
    found = certified_growth(mathieu(), 2.0, 1e-60)
    assert found.verdict is ProvedVerdict.UNSTABLE
    assert found.bits > 128
    assert found.lower <= 0.25e-60 * (1 + 1e-12)
    assert found.upper >= 0.25e-60 * (1 - 1e-12)
    assert found.upper < found.lower * (1 + 1e-9)
    assert certified_growth(mathieu(), 2.0, 1e-60, max_bits=128).verdict is ProvedVerdict.UNDECIDED


@pytest.mark.parametrize("Omega", [2.0, 1.0, 3.4, 2.7, 0.7])
def test_without_excitation_no_frequency_is_special(Omega: float) -> None:
    for system in (mathieu(), coupled_mathieu(), gyroscopic_rotor(), meissner()):
        found = certified_growth(system, Omega, 0.0)
        assert (found.lower, found.upper, found.verdict) == (0, 0, ProvedVerdict.STABLE)


def test_free_motion_is_undecided() -> None:
    """x'' = 0 grows, though not exponentially: neither word fits."""
    found = certified_growth(mathieu(0.0), 1.0, 0.0)
    assert found.verdict is ProvedVerdict.UNDECIDED
    assert found.lower == 0
    assert found.upper < 1e-60


def test_partial_damping() -> None:
    """Uncoupled parts, one damped: the other neither grows nor decays. Coupling lets both decay, or else one grow.

    That damping in one part makes the other grow over wide ranges of Omega is no error: DOP853 gives 6.6367e-4 at 3.5.
    """
    system = coupled_mathieu(damping=(0.1, 0.0))
    found = certified_growth(system, 5.0, 0.0)
    assert (found.lower, found.upper, found.verdict) == (0, 0, ProvedVerdict.STABLE)
    assert certified_growth(system, 0.7, 0.5).upper < -0.02
    assert certified_growth(system, 3.5, 0.5).lower == pytest.approx(6.63665438745e-4, rel=1e-9)


@pytest.mark.parametrize("turning", [0.0, 0.2])
@pytest.mark.parametrize("asymmetry", [0.0, 1e-60, 1e-30, np.spacing(0.3)])
def test_asymmetry_takes_the_certificate_away(turning: float, asymmetry: float) -> None:
    """Neither symmetric nor, for the sine or for G, reversible: whatever holds nearly does not hold."""
    K, G = np.array([[1.0, asymmetry], [0.0, 2.0]]), np.array([[0.0, turning], [-turning, 0.0]])
    F = np.array([[1.0, 0.7], [0.7, 0.5]])
    sine = [0.0 * F, np.diag([0.3, 0.0])]
    for excitation in ([[F, F], None], [[F, F], sine]):
        found = certified_growth(PeriodicSystem(np.eye(2), G, np.zeros((2, 2)), K, *excitation), 5.0, 0.1)
        # without G and sines the system runs backwards as it runs forwards, symmetric or not
        if asymmetry == 0 or (turning == 0 and excitation[1] is None):
            assert found.verdict is ProvedVerdict.STABLE
        else:
            assert found.verdict is ProvedVerdict.UNSTABLE
            assert 0 < found.lower <= found.upper < asymmetry


def test_undecided_for_want_of_symmetry_says_so() -> None:
    """An asymmetry that not even the highest precision sees."""
    G = np.array([[0.0, 0.2], [-0.2, 0.0]])
    system = PeriodicSystem(np.eye(2), G, np.zeros((2, 2)), [[1.0, 1e-300], [0.0, 2.0]], [np.eye(2)])
    found = certified_growth(system, 5.0, 0.1)
    assert found.verdict is ProvedVerdict.UNDECIDED
    assert "symmetric" in found.reason
    assert found.upper < 1e-100


@pytest.mark.parametrize("seed", range(4))
def test_units_of_coordinates_do_not_matter(seed: int) -> None:
    """W = S V with powers of two in S, exact in float64, over twenty-four orders of magnitude."""
    system = random_system(seed, 3)
    S = np.diag([2.0**-40, 1.0, 2.0**40])
    matrices = (system.mass, system.gyroscopic, system.damping, system.stiffness, system.cosine, system.sine)
    scaled = PeriodicSystem(*(S @ matrix @ S for matrix in matrices))
    assert overlap(certified_growth(scaled, 1.9, 0.5), certified_growth(system, 1.9, 0.5))


@pytest.mark.parametrize("seed", range(4))
def test_unit_of_time_scales_the_growth_rate(seed: int) -> None:
    system = random_system(seed, 3)
    faster = PeriodicSystem(
        system.mass,
        1024 * system.gyroscopic,
        1024 * system.damping,
        1024**2 * system.stiffness,
        1024**2 * system.cosine,
        1024**2 * system.sine,
    )
    slow, fast = certified_growth(system, 1.9, 0.5), certified_growth(faster, 1024 * 1.9, 0.5)
    assert max(1024 * slow.lower, fast.lower) <= min(1024 * slow.upper, fast.upper)
    assert slow.verdict is fast.verdict


def test_family_is_asked_at_the_frequency() -> None:
    class Family:
        def at(self, Omega: float) -> PeriodicSystem:
            return mathieu(Omega**2 / 4)

    for Omega in (1.0, 3.0):
        assert certified_growth(Family(), Omega, 0.1).verdict is ProvedVerdict.UNSTABLE


def test_working_precision_is_given_back() -> None:
    before = ctx.prec
    certified_growth(mathieu(), 1.9, 0.3)
    certified_monodromy(mathieu(), 1.9, 0.3, bits=256)
    with pytest.raises(ValueError, match="Omega"):
        certified_growth(mathieu(), 1e-9, 0.3)
    assert ctx.prec == before


# Wrong input


@pytest.mark.parametrize(
    ("arguments", "fault"),
    [
        ((None, 1.0, 0.1), "family"),
        ((np.eye(2), 1.0, 0.1), "family"),
        ((mathieu(), 0.0, 0.1), "Omega"),
        ((mathieu(), -1.0, 0.1), "Omega"),
        ((mathieu(), np.nan, 0.1), "Omega"),
        ((mathieu(), np.inf, 0.1), "Omega"),
        ((mathieu(), "1", 0.1), "Omega"),
        ((mathieu(), [1.0], 0.1), "Omega"),
        ((mathieu(), 1.0, np.nan), "eps"),
        ((mathieu(), 1.0, None), "eps"),
        ((mathieu(), 1.0, 1j), "eps"),
        ((mathieu(), 1e-12, 0.1), "higher Omega"),
        ((mathieu(), 5e-324, 0.1), "higher Omega"),
        ((mathieu(), 1.0, 1e300), "steps"),
        ((mathieu(1e300), 1.0, 0.1), "steps"),
        ((random_system(0, 30), 0.001, 0.1), "fewer coordinates"),
        ((PeriodicSystem([[1e-200]], [[0]], [[0]], [[1e200]], [[[1]]]), 1.0, 0.1), "units"),
    ],
)
def test_wrong_arguments(arguments: tuple[Any, ...], fault: str) -> None:
    for function in (certified_growth, certified_monodromy):
        with pytest.raises(ValueError, match=fault):
            function(*arguments)


def test_wrong_family() -> None:
    class Wrong:
        def at(self, Omega: float) -> str:
            return "plate"

    with pytest.raises(ValueError, match="must give a PeriodicSystem"):
        certified_growth(Wrong(), 1.0, 0.1)  # type: ignore[arg-type]


@pytest.mark.parametrize("bits", [63, 4096, 128.0, "128", None, True])
def test_wrong_precision(bits: Any) -> None:
    with pytest.raises(ValueError, match="bits"):
        certified_monodromy(mathieu(), 1.0, 0.1, bits=bits)
    with pytest.raises(ValueError, match="max_bits"):
        certified_growth(mathieu(), 1.0, 0.1, max_bits=bits)


@pytest.mark.parametrize(("Omega", "eps"), [(1e300, 0.3), (1.0, 1e-300), (1e12, 5e-324), (1e150, -1e290)])
def test_extreme_numbers_are_no_trouble(Omega: float, eps: float) -> None:
    found = certified_growth(mathieu(), Omega, eps)
    assert 0 <= found.lower <= found.upper < Omega * 1e-70


def test_missing_flint_names_the_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "flint", None)
    monkeypatch.delitem(sys.modules, "floquet.certified")
    with pytest.raises(ImportError, match=r"floquet-charts\[certify\]"):
        importlib.import_module("floquet.certified")
