"""`monodromy` of any linear periodic system: references, another integrator, exact cases, structure, refusals."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import scipy.linalg as sla
from hypothesis import given, settings
from hypothesis import strategies as st

from floquet import Kind, monodromy
from floquet.oracle import is_unstable
from periodic import AnySystem, FirstOrderSystem, PeriodicSystem, Term, waveforms
from periodic.examples import coupled_mathieu, meissner
from periodic.structure import conserved_form, is_reversible, skew_form
from tests.floquet.general_oracles import dop853, random_first_order, random_second_order
from tests.general_systems import Reference, growth_rates
from tests.strategies import seeds

some = settings(max_examples=12, deadline=None)
some_frequencies, some_amplitudes = st.floats(0.6, 4.0), st.floats(-0.9, 0.9)

GROWTH_RATES = growth_rates()
SYSTEMS = sorted({entry["system"] for entry in GROWTH_RATES})
ONE, SKEW = np.eye(2), np.array([[0.0, 1.0], [-1.0, 0.0]])


def relative(found: Any, exact: Any) -> float:
    """Spectral norm of the difference, as `Monodromy.error` measures it."""
    return float(np.linalg.norm(found - exact, 2)) / max(1.0, float(np.linalg.norm(exact, 2)))


@pytest.mark.parametrize("name", SYSTEMS)
def test_growth_rates_of_the_references(name: str) -> None:
    for entry in (one for one in GROWTH_RATES if one["system"] == name):
        family, Omega = Reference(name, entry["eps"]), entry["Omega"]
        found = monodromy(family, Omega, family.amplitude)
        assert found.growth_rate == pytest.approx(entry["value"], abs=1e-12 + 2 * entry["error"]), entry["id"]
        judged = entry["value"] and found.kind != Kind.UNDECIDED
        assert not judged or (found.kind > Kind.STABLE) == (entry["value"] > 0), entry["id"]
        assert is_unstable(family, Omega, family.amplitude) == (entry["value"] > 0), entry["id"]


@some
@given(seeds, st.integers(1, 4), st.booleans(), some_frequencies, some_amplitudes)
def test_second_order_systems_agree_with_dop853(seed: int, n: int, pulses: bool, Omega: float, eps: float) -> None:
    agrees_with_dop853(random_second_order(seed, n, pulses=pulses), Omega, eps)


@some
@given(seeds, st.integers(1, 7), st.booleans(), some_frequencies, some_amplitudes)
def test_first_order_systems_agree_with_dop853(seed: int, n: int, pulses: bool, Omega: float, eps: float) -> None:
    agrees_with_dop853(random_first_order(seed, n, pulses=pulses), Omega, eps)


def agrees_with_dop853(system: AnySystem, Omega: float, eps: float) -> None:
    """The allowance on top of the estimate is for DOP853 itself."""
    found = monodromy(system, Omega, eps)
    difference = relative(found.matrix, dop853(system, Omega, eps))
    assert difference < 1e-9
    assert difference <= 3 * found.error + 5e-11
    assert found.error < 1e-10


@pytest.mark.parametrize("phase", [0.0, 0.3])
def test_a_mass_that_jumps_once_a_period_keeps_its_momentum(phase: float) -> None:
    """A sawtooth has one jump, at t = 0; a rectangular wave two."""
    wave = waveforms.rectangular(0.4, phase) if phase else waveforms.sawtooth()
    system = PeriodicSystem([[1.0]], damping=[[0.1]], stiffness=[[2.0]], terms=[Term("mass", [[1.0]], wave)])
    assert relative(monodromy(system, 1.3, 0.5).matrix, dop853(system, 1.3, 0.5)) < 1e-11


def test_piecewise_constant_systems_are_products_of_exponentials() -> None:
    rng = np.random.default_rng(4)
    A, X, Y = rng.standard_normal((3, 3, 3))
    waves = (waveforms.rectangular(0.3, 0.2), waveforms.rectangular(0.5))
    system = FirstOrderSystem(A, terms=[Term("state", X, waves[0]), Term("state", Y, waves[1], 2)])
    Omega, eps = 1.7, 0.6
    exact = np.eye(3)
    # from 0: X off until 0.2 and from 0.5, Y on until 0.5
    for part, x, y in ((0.2, -1, 1), (0.3, 1, 1), (0.5, -1, -1)):
        exact = sla.expm((A + eps * x * X + eps**2 * y * Y) * part * 2 * np.pi / Omega) @ exact
    found = monodromy(system, Omega, eps)
    assert relative(found.matrix, exact) < 1e-14
    assert found.error < 1e-13


def test_a_rectangular_wave_is_the_limit_of_its_fourier_series() -> None:
    """Meissner's equation by its sum: the error of the growth rate falls with the cube of the number of harmonics."""
    wave = waveforms.rectangular(0.5, -0.25)
    exact = monodromy(PeriodicSystem([[1.0]], stiffness=[[1.0]], terms=[Term("stiffness", [[1.0]], wave)]), 2.0, 0.5)
    gaps = [abs(monodromy(meissner(harmonics=J), 2.0, 0.5).growth_rate - exact.growth_rate) for J in (9, 19, 39)]
    assert np.log2(np.divide(gaps[:-1], gaps[1:])) == pytest.approx([3, 3], abs=0.15)


def test_a_kick_is_the_limit_of_short_pulses() -> None:
    kick = Term("stiffness", [[1.0]], waveforms.impulses([0.4], [1.0]))
    kicked = PeriodicSystem([[1.0]], stiffness=[[1.0]], terms=[kick])
    Omega, eps = 2.1, 0.4
    exact = monodromy(kicked, Omega, eps).growth_rate
    gaps = []
    for width in (0.02, 0.01, 0.005):
        height = Omega / (2 * np.pi * width)  # (1 + g) / 2 is 1 for the part `width` of the period
        wave = Term("stiffness", [[height / 2]], waveforms.rectangular(width, 0.4 - width / 2))
        level = Term("stiffness", [[height / 2]], waveforms.constant())
        pulse = PeriodicSystem([[1.0]], stiffness=[[1.0]], terms=[wave, level])
        gaps.append(abs(monodromy(pulse, Omega, eps).growth_rate - exact))
    assert np.log2(np.divide(gaps[:-1], gaps[1:])) == pytest.approx([1, 1], abs=0.15)


@pytest.mark.parametrize("name", ["beam_v2.0_vf0.8_N4_a0", "string_v0.3_N4", "plate_V3.0_f10.0_r1.0_c0.0"])
def test_an_undamped_accelerating_web_is_hamiltonian(name: str) -> None:
    system = Reference(name, 0.1).at(11.3)
    assert isinstance(system, PeriodicSystem)
    form = conserved_form(system, 11.3, 0.1)
    assert form is not None
    found = monodromy(system, 11.3, 0.1)
    Phi = found.matrix
    assert np.linalg.norm(Phi.T @ form @ Phi - form, 2) <= 1e-12 * np.linalg.norm(Phi, 2) ** 2 * np.linalg.norm(form, 2)
    # without v' B it is not, and grows where it should not
    partial = replace(system, sine=0 * system.sine)
    assert conserved_form(partial, 11.3, 0.1) is None


def test_a_speed_that_jumps_is_hamiltonian_only_with_its_pulse() -> None:
    B, K = np.array([[0.0, -1.0], [1.0, 0.0]]), np.diag([3.0, 5.0])
    wave = waveforms.rectangular(0.5)  # v jumps by -2 at 0.5 and by 2 at 0
    speed = Term("gyroscopic", 2 * B, wave)
    kick = Term("stiffness", B, waveforms.impulses([0.0, 0.5], [2.0, -2.0]))
    whole, partial = (PeriodicSystem(ONE, 2 * B, stiffness=K, terms=terms) for terms in ([speed, kick], [speed]))
    form = conserved_form(whole, 1.9, 0.2)
    assert form is not None
    assert conserved_form(partial, 1.9, 0.2) is None
    Phi = monodromy(whole, 1.9, 0.2).matrix
    np.testing.assert_allclose(Phi.T @ form @ Phi, form, atol=1e-12)
    turned = monodromy(partial, 1.9, 0.2).matrix
    assert np.abs(turned.T @ form @ turned - form).max() > 1e-3


def test_a_periodic_mass_is_hamiltonian_with_its_derivative_as_damping() -> None:
    X = np.array([[0.3, 0.1], [0.1, -0.2]])
    mass = Term("mass", X, waveforms.cosine(1, 0.1))
    rate = Term("damping", -1.7 * X, waveforms.function(lambda theta: np.sin(theta - 0.2 * np.pi)))
    whole = PeriodicSystem(ONE, 0.4 * SKEW, stiffness=np.diag([1.0, 2.0]), terms=[mass, rate])
    form = conserved_form(whole, 1.7, 0.8)
    assert form is not None
    Phi = monodromy(whole, 1.7, 0.8).matrix
    np.testing.assert_allclose(Phi.T @ form @ Phi, form, atol=1e-12)
    assert conserved_form(whole, 1.8, 0.8) is None
    assert conserved_form(PeriodicSystem(ONE, terms=[mass]), 1.7, 0.8) is None


def test_first_order_systems_may_be_hamiltonian() -> None:
    H = [one + one.T for one in np.random.default_rng(1).standard_normal((3, 4, 4))]
    J = np.block([[np.zeros((2, 2)), ONE], [-ONE, np.zeros((2, 2))]])
    T = np.eye(4) + 0.3 * np.random.default_rng(2).standard_normal((4, 4))
    A, *terms = (np.linalg.solve(T, J @ one @ T) for one in H)
    system = FirstOrderSystem(A, terms=[Term("state", X, waveforms.sawtooth(), 2) for X in terms])
    assert skew_form(system, 0.3) is not None
    assert skew_form(FirstOrderSystem(A - 0.01 * np.eye(4)), 0.3) is None
    mu = monodromy(system, 5.0, 0.3).multipliers
    np.testing.assert_allclose(np.sort(np.abs(mu)), np.sort(1 / np.abs(mu)), rtol=1e-9)


@pytest.mark.parametrize("phase", [0.0, 0.13])
def test_circulatory_systems_without_damping_are_reversible(phase: float) -> None:
    X = np.array([[0.0, 1.0], [-1.0, 0.0]])
    even = Term("stiffness", X, waveforms.rectangular(0.3, phase))
    odd = Term("stiffness", X, waveforms.function(lambda theta: np.exp(np.sin(theta) + 0.4 * np.cos(2 * theta) ** 3)))
    skewed = Term("stiffness", X, waveforms.sawtooth())
    K = np.diag([1.0, 4.0])
    for terms, expected in (([even], True), ([even, odd], False), ([even, skewed], False), ([skewed], False)):
        assert is_reversible(PeriodicSystem(ONE, stiffness=K, terms=terms), 0.1) is expected
    assert not is_reversible(PeriodicSystem(ONE, damping=0.1 * ONE, stiffness=K, terms=[even]), 0.1)
    pulse = Term("stiffness", X, waveforms.impulses([phase + 0.15], [1.0]))
    beside = Term("stiffness", X, waveforms.impulses([phase + 0.16], [1.0]))
    assert is_reversible(PeriodicSystem(ONE, stiffness=K, terms=[even, pulse]), 0.1)
    assert not is_reversible(PeriodicSystem(ONE, stiffness=K, terms=[even, beside]), 0.1)
    found = monodromy(PeriodicSystem(ONE, stiffness=K, terms=[even]), 5.3, 0.1)
    assert (found.kind, found.growth_rate) == (Kind.STABLE, 0.0)


def test_what_is_eq_11_at_one_amplitude_is_integrated_as_that() -> None:
    """Powers of eps are numbers at one point; the short form gives the same matrix to the last bit."""
    system = coupled_mathieu()
    F, eps = system.cosine[0], 0.3
    squared = replace(system, cosine=None, sine=None, terms=[Term("stiffness", F, power=2)])
    np.testing.assert_array_equal(monodromy(squared, 2.7, eps).matrix, monodromy(system, 2.7, eps**2).matrix)
    shifted = PeriodicSystem(
        ONE, stiffness=system.stiffness, cosine=F, terms=[Term("damping", ONE, waveforms.constant(), 2)]
    )
    damped = PeriodicSystem(ONE, damping=eps**2 * ONE, stiffness=system.stiffness, cosine=F)
    np.testing.assert_array_equal(monodromy(shifted, 2.7, eps).matrix, monodromy(damped, 2.7, eps).matrix)


def test_rigid_motions_are_set_apart() -> None:
    """Two masses in a ring, coupled by a pulsating dashpot and a spring: their common motion is free."""
    X = np.array([[1.0, -1.0], [-1.0, 1.0]])
    system = PeriodicSystem(ONE, damping=0.1 * X, stiffness=X, terms=[Term("damping", 0.2 * X)])
    found = monodromy(system, 2.0, 0.5)
    assert (found.rigid, found.kind) == (1, Kind.STABLE)
    assert relative(found.matrix, dop853(system, 2.0, 0.5)) < 1e-11
    alone = PeriodicSystem([[1.0]], damping=[[0.2]], stiffness=[[2.0]], terms=[Term("damping", [[0.4]])])
    assert found.growth_rate == pytest.approx(monodromy(alone, 2.0, 0.5).growth_rate, abs=1e-13)


def test_small_multipliers_are_as_right_as_large_ones() -> None:
    """Liouville for the logarithms: the mean trace, however small the smallest multiplier."""
    A = [[0.1, 1.0, 0.0], [-1.0, 0.1, 3.0], [0.0, 0.5, -30.0]]
    system = FirstOrderSystem(A, terms=[Term("state", np.eye(3)[::-1], waveforms.sawtooth())])
    found = monodromy(system, 1.0, 0.8)
    assert np.abs(found.multipliers).min() < 1e-70
    assert found.multiplier_errors.max() < 1e-8
    assert np.log(np.abs(found.multipliers)).sum() == pytest.approx(2 * np.pi * -29.8, abs=1e-9)


def test_a_mass_near_singularity_costs_steps_not_digits() -> None:
    """m = 1 + eps cos t: m^2 x'' + m m' x' + w^2 x = 0 is x_tt + w^2 x = 0 in tau, dtau = dt / m."""
    eps, w, Omega = 0.98, 1.3, 1.0
    system = PeriodicSystem(
        [[1.0]],
        stiffness=[[w * w]],
        terms=[
            Term("mass", [[2.0]]),
            Term("mass", [[0.5]], waveforms.constant(), 2),
            Term("mass", [[0.5]], waveforms.cosine(2), 2),
            Term("damping", [[-Omega]], waveforms.sine()),
            Term("damping", [[-0.5 * Omega]], waveforms.sine(2), 2),
        ],
    )
    found = monodromy(system, Omega, eps)
    angle = w * 2 * np.pi / np.sqrt(1 - eps**2)
    assert found.kind == Kind.STABLE
    assert found.multipliers.real == pytest.approx(2 * [np.cos(angle)], abs=1e-11)


def test_refuses_a_mass_that_becomes_singular() -> None:
    system = PeriodicSystem([[1.0]], stiffness=[[1.0]], terms=[Term("mass", [[1.0]])])
    with pytest.raises(ValueError, match=r"^mass at eps = 1.2 is not positive definite at the phase 0\.[45]"):
        monodromy(system, 2.0, 1.2)
    rises = PeriodicSystem([[1.0]], stiffness=[[1.0]], terms=[Term("mass", [[-1.0]], waveforms.constant())])
    with pytest.raises(ValueError, match=r"^mass"):
        monodromy(rises, 2.0, 1.2)


def test_refuses_what_overflows_or_takes_too_long() -> None:
    with pytest.raises(ValueError, match=r"grows by more than 1e\+150"):
        monodromy(FirstOrderSystem([[100.0]], [[1.0]]), 1.0, 0.1)
    with pytest.raises(ValueError, match=r"^Omega = 1e-09 means"):
        monodromy(FirstOrderSystem(SKEW, ONE), 1e-9, 0.1)
