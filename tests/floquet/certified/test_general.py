"""Proofs for any linear periodic system: exact solutions, independent numbers, other integrators."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

from beam import MovingBeam
from floquet import Kind, monodromy
from periodic import AnySystem, FirstOrderSystem, PeriodicSystem, Term, waveforms
from periodic.waveforms import Piecewise, Trigonometric, Waveform
from plate import MovingPlate
from tests.floquet.certified.certified_oracles import contains, largest_radius, middle
from tests.floquet.general_oracles import dop853, random_first_order, random_second_order
from tests.general_systems import Reference, growth_rates
from tests.sparing import all_but

flint = pytest.importorskip("flint", reason="python-flint, the extra certify, is not installed")
from flint import arb, arb_mat, ctx  # noqa: E402

from floquet.certified import ProvedVerdict, certified_growth, certified_monodromy, enclosure  # noqa: E402
from floquet.certified.steps import Plan  # noqa: E402

STABLE, UNSTABLE = ProvedVerdict.STABLE, ProvedVerdict.UNSTABLE
# Systems of the reference file whose proof takes more than two seconds a point.
LARGE = {
    entry["system"] for entry in growth_rates() if entry["system"].startswith(("plate", "ground", "string_tension"))
}


def oscillator(*terms: Term, stiffness: float = 1.0, damping: float = 0.0) -> PeriodicSystem:
    return PeriodicSystem([[1.0]], damping=[[damping]], stiffness=[[stiffness]], terms=terms)


# Exact solutions


@pytest.mark.parametrize(("duty", "phase"), [(0.5, 0.0), (0.25, 0.0), (0.375, 0.75)])
@pytest.mark.parametrize("bits", [64, 256])
def test_rectangular_wave_is_two_oscillators(duty: float, phase: float, bits: int) -> None:
    """Meissner: x'' + (4 +- 3) x = 0; cosines and sines in closed form."""
    system = oscillator(Term("stiffness", [[3.0]], waveforms.rectangular(duty, phase)), stiffness=4.0)
    found = certified_monodromy(system, 1.5, 1.0, bits=bits)
    with ctx.workprec(bits + 100):
        T = 2 * arb.pi() / arb(1.5)

        def part(stiffness: int, share: float) -> arb_mat:
            w = arb(stiffness).sqrt()
            angle = w * T * arb(share)
            return arb_mat([[angle.cos(), -w * angle.sin()], [angle.sin() / w, angle.cos()]])

        end = phase + duty
        first = [(1, phase), (7, duty), (1, 1 - end)] if end <= 1 else [(7, end - 1), (1, 1 - duty), (7, 1 - phase)]
        exact = arb_mat([[1, 0], [0, 1]])
        for stiffness, share in first:
            exact = part(stiffness, share) * exact
        assert contains(found, exact)
    assert largest_radius(found) < 2.0 ** (30 - bits)


def test_pulses_kick_the_velocity() -> None:
    """x'' + x = -0.5 x at the phase 1/4, x' -> e^{-0.25} x' at the phase 0, which is the end."""
    system = oscillator(
        Term("stiffness", [[1.0]], waveforms.impulses([0.25], [1.0])),
        Term("damping", [[0.5]], waveforms.impulses([0.0], [1.0])),
    )
    found = certified_monodromy(system, 0.75, 0.5)
    with ctx.workprec(300):
        T = 2 * arb.pi() / arb(0.75)

        def turn(angle: arb) -> arb_mat:
            return arb_mat([[angle.cos(), -angle.sin()], [angle.sin(), angle.cos()]])

        exact = arb_mat([[arb(-0.25).exp(), 0], [0, 1]]) * turn(3 * T / 4) * arb_mat([[1, -0.5], [0, 1]]) * turn(T / 4)
        assert contains(found, exact)


def falling_mass() -> tuple[PeriodicSystem, float]:
    """(1 - x / 4) u' = 5 u, x from -1 to 1 over the period: the Taylor coefficients of u have one sign.

    The momentum goes on where the mass jumps back from 3/4 to 5/4.
    """
    terms = [Term("mass", [[-0.25]], waveforms.sawtooth())]
    return PeriodicSystem([[1.0]], damping=[[-5.0]], terms=terms), 8.0


def exact_growth_of_falling_mass() -> arb:
    """From u' / u = 5 / (1 - x / 4), dt = T / 2 dx."""
    return (5 * arb.pi() / 8 * 4 * (arb(5) / 3).log()).exp() * 3 / 5


@pytest.mark.parametrize("bits", [64, 256])
def test_momentum_goes_on_where_the_mass_jumps(bits: int) -> None:
    found = certified_monodromy(*falling_mass(), 1.0, bits=bits)
    with ctx.workprec(400):
        assert found[0, 0].contains(exact_growth_of_falling_mass())
    assert largest_radius(found) < 2.0 ** (40 - bits)


@pytest.mark.parametrize("order", [6, 20])
@pytest.mark.parametrize("radius", [1.25, 1.9])
def test_remainder_bounds_what_a_moving_mass_leaves_out(
    monkeypatch: pytest.MonkeyPatch, order: int, radius: float
) -> None:
    monkeypatch.setattr(enclosure, "plan_of", lambda *_: Plan(1, order, arb(radius)))
    found = certified_monodromy(*falling_mass(), 1.0)
    with ctx.workprec(300):
        exact = exact_growth_of_falling_mass()
        assert found[0, 0].contains(exact)
        assert not found[0, 0].mid().contains(exact)


@pytest.mark.parametrize(
    ("wave", "mean"),
    [
        (waveforms.cosine(), 0.0),
        (waveforms.rectangular(0.75), 0.5),
        (waveforms.sawtooth(), 0.0),
        (Piecewise((0.25, 0.5), ((1.0, 2.0, 3.0), (0.5, 0.0, -0.75))), 0.25 * 2.0 + 0.75 * 0.25),
        (waveforms.impulses([0.0, 0.3], [2.0, -1.0]), 1.5 / (2 * np.pi)),
    ],
)
def test_one_state_grows_with_the_mean(wave: Waveform, mean: float) -> None:
    found = certified_growth(FirstOrderSystem([[-0.125]], terms=[Term("state", [[0.5]], wave, power=2)]), 1.5, -0.5)
    exact = -0.125 + 0.125 * mean
    assert found.lower - 1e-16 <= exact <= found.upper + 1e-16
    assert found.upper - found.lower < 1e-15
    assert found.verdict is (STABLE if exact < 0 else UNSTABLE)


@pytest.mark.parametrize("wave", [waveforms.cosine(), waveforms.rectangular(0.5), waveforms.sawtooth()])
def test_one_state_without_mean_growth_is_bounded(wave: Waveform) -> None:
    found = certified_growth(FirstOrderSystem([[0.0]], terms=[Term("state", [[1.0]], wave)]), 1.5, 0.5)
    assert (found.lower, found.upper, found.verdict) == (0, 0, STABLE)


@pytest.mark.parametrize("seed", range(3))
def test_periodic_coordinates_leave_the_exponents(seed: int) -> None:
    """x = R(theta) y, y' = B y with R a rotation by theta: A = Omega R' R^T + R B R^T, whose harmonics end at 2."""
    B = np.random.default_rng(seed).integers(-8, 8, (2, 2)) / 4.0
    J, Omega = np.array([[0.0, -1.0], [1.0, 0.0]]), 1.5
    mean, skew = (B + J @ B @ J.T) / 2, (B - J @ B @ J.T) / 2  # R (.) R^T leaves one part and turns the other twice
    system = FirstOrderSystem(mean + Omega * J, [0 * J, skew], [0 * J, (J @ skew - skew @ J) / 2])
    found = certified_growth(system, Omega, 1.0)
    exact = float(np.linalg.eigvals(B).real.max())
    assert found.lower - 1e-14 <= exact <= found.upper + 1e-14
    assert found.verdict is (UNSTABLE if exact > 0 else STABLE)


# Waveforms that are known within a bound


@pytest.mark.parametrize("of", ["stiffness", "damping", "gyroscopic", "mass"])
@pytest.mark.parametrize("kind", ["sum", "pieces"])
def test_every_function_within_the_rest_is_enclosed(of: str, kind: str) -> None:
    rest = 1e-5
    shapes = {"gyroscopic": [[0.0, 1.0], [-1.0, 0.0]]}
    X = 0.3 * np.array(shapes.get(of, [[1.0, 0.5], [0.5, 2.0]]))
    loose: Any = Trigonometric((0.0, 1.0), (0.0, 0.0)) if kind == "sum" else waveforms.triangle()
    member: Any = (
        Trigonometric((0.0, 1.0, 0.0, 0.7 * rest), (0.0, 0.0, 0.0, 0.7 * rest))
        if kind == "sum"
        else Piecewise(loose.jumps, tuple((piece[0] + 0.9 * rest, *piece[1:]) for piece in loose.pieces))
    )

    def system(wave: Any) -> PeriodicSystem:
        return PeriodicSystem(
            np.eye(2), damping=0.1 * np.eye(2), stiffness=np.diag([1.0, 5.0]), terms=[Term(of, X, wave, power=2)]
        )

    enclosed = certified_monodromy(system(replace(loose, rest=rest)), 1.5, 0.75)
    other = certified_monodromy(system(member), 1.5, 0.75)
    assert contains(enclosed, other.mid())
    assert not contains(certified_monodromy(system(loose), 1.5, 0.75), other.mid())
    assert largest_radius(enclosed) < 1e4 * rest


def test_functions_are_proved_with_their_rest() -> None:
    wave = waveforms.function(lambda theta: np.exp(np.cos(theta)))
    system = oscillator(Term("stiffness", [[1.0]], wave), damping=0.0625)
    found = certified_growth(system, 2.5, 0.5)
    point = monodromy(system, 2.5, 0.5)
    assert found.verdict is UNSTABLE
    assert "rest" in found.reason
    assert 0 < found.upper - found.lower < 1e-11
    assert found.lower - 1e-13 < point.growth_rate < found.upper + 1e-13
    # no precision helps where the waveform itself is uncertain
    loose = replace(wave, rest=0.1)
    assert certified_growth(oscillator(Term("stiffness", [[1.0]], loose)), 2.3, 0.1).bits == 128


# Structure


SKEW = np.array([[0.0, 1.0], [-1.0, 0.0]])


@pytest.mark.parametrize("Omega", [16.3, 20.0, 40.0])
def test_pulsating_speed_is_hamiltonian_and_says_what_was_changed(Omega: float) -> None:
    """K - K^T = G' contains Omega, which float64 numbers cannot hold exactly."""
    for family in (MovingBeam(0.6, 0.8), MovingPlate(axial_terms=2, lateral_terms=2, speed_amplitude=0.3)):
        found = certified_growth(family, Omega, 0.1)
        point = monodromy(family, Omega, 0.1)
        assert found.verdict is {Kind.STABLE: STABLE}.get(point.kind, UNSTABLE)
        assert 0 < found.change < 1e-14
        assert "G'" in found.reason


def test_speed_without_its_acceleration_is_not_hamiltonian() -> None:
    """The same beam without v' B: whatever holds multipliers on the circle is gone."""
    beam = MovingBeam(0.6, 0.8, terms=2).at(20.0)
    without = PeriodicSystem(
        beam.mass, beam.gyroscopic, stiffness=beam.stiffness, cosine=beam.cosine[0], terms=beam.terms
    )
    found = certified_growth(without, 20.0, 0.1)
    assert found.verdict is not STABLE
    assert found.change == 0


@pytest.mark.parametrize("weight", [1.0, 0.5])
def test_a_jump_of_speed_needs_its_pulse(weight: float) -> None:
    """2 v B jumps by 2: the skew pulse of the stiffness is half of that. With another one it is not Hamiltonian."""
    terms = [
        Term("gyroscopic", SKEW, waveforms.rectangular(0.25)),
        Term("stiffness", weight * SKEW, waveforms.impulses([0.0, 0.25], [1.0, -1.0])),
    ]
    found = certified_growth(PeriodicSystem(np.eye(2), stiffness=np.diag([1.0, 5.0]), terms=terms), 3.1, 0.2)
    assert (found.verdict is STABLE) == (weight == 1.0)


def random_hamiltonian(seed: int) -> tuple[PeriodicSystem, float, float]:
    """C = M', K - K^T = G', and the pulses that belong to jumps of G."""
    rng = np.random.default_rng(seed)
    n, Omega, eps = int(rng.integers(1, 4)), float(rng.uniform(0.8, 6)), float(rng.uniform(0.05, 0.4))

    def matrix(size: float, sign: int) -> np.ndarray:
        X = size * rng.normal(size=(n, n))
        return X + sign * X.T

    B, X, Y, M = rng.normal(size=(n, n)), matrix(0.5, -1), matrix(0.5, -1), matrix(0.1, 1)
    terms = [
        Term("stiffness", matrix(0.5, 1), waveforms.cosine(1, float(rng.random()))),
        Term("stiffness", matrix(0.5, 1), waveforms.triangle()),
        Term("gyroscopic", X, waveforms.cosine(2)),
        Term("stiffness", -Omega * X, waveforms.sine(2)),
        Term("gyroscopic", Y, waveforms.rectangular(0.3)),
        Term("stiffness", Y, waveforms.impulses([0, 0.3], [1.0, -1.0])),
        Term("mass", M, waveforms.cosine()),
        Term("damping", -Omega * M, waveforms.sine()),
        Term("mass", matrix(0.1, 1), waveforms.rectangular(0.4)),
    ]
    kept = [term for term, with_it in zip(terms, [1, 1, *np.repeat(rng.random(3) < 0.6, 2), 1], strict=True) if with_it]
    return PeriodicSystem(np.eye(n), matrix(0.5, -1), stiffness=B @ B.T + n * np.eye(n), terms=kept), Omega, eps


@pytest.mark.parametrize("seed", range(12))
def test_random_hamiltonian_systems(seed: int) -> None:
    """What `monodromy` finds bounded is proved bounded, and nothing else."""
    system, Omega, eps = random_hamiltonian(seed)
    found = certified_growth(system, Omega, eps, max_bits=128, progress=False)
    point = monodromy(system, Omega, eps)
    period = 2 * np.pi / Omega
    assert (
        period * max(found.lower - point.growth_rate, point.growth_rate - found.upper) < 3e-13 + point.log_modulus_error
    )
    assert found.verdict is (STABLE if point.kind is Kind.STABLE else UNSTABLE)


@pytest.mark.parametrize("asymmetry", [0.0, 1e-30])
def test_even_functions_are_reversible(asymmetry: float) -> None:
    """A mass, even about the phase 0 or 1/4, and a circulatory stiffness; a sine beside a cosine takes it away."""
    M, K = np.array([[0.3, 0.1], [0.1, 0.2]]), np.array([[1.0, 0.25], [0.0, 5.0]])
    terms = [Term("mass", M, waveforms.cosine()), Term("stiffness", 0.1 * K, waveforms.triangle())]
    terms += [Term("stiffness", asymmetry * K, waveforms.sine())] if asymmetry else []
    found = certified_growth(PeriodicSystem(np.eye(2), stiffness=K, terms=terms), 4.1, 0.3)
    assert (found.verdict is STABLE) == (asymmetry == 0)


def test_first_order_forms_are_found_exactly() -> None:
    """x'' + ... in two states keeps an area; a rotation in three keeps a length; 1e-300 takes both away."""
    oscillating = [[0.0, 1.0], [-1.0, 0.0]], [[0.0, 0.0], [1.0, 0.0]]
    turning = (
        [[0.0, 1.0, 0.0], [-1.0, 0.0, 0.5], [0.0, -0.5, 0.0]],
        [[0.0, 0.0, 0.2], [0.0, 0.0, 1.0], [-0.2, -1.0, 0.0]],
    )
    for constant, harmonic in (oscillating, turning):
        assert certified_growth(FirstOrderSystem(constant, harmonic), 1.7, 0.3).verdict is STABLE
        nearly = np.array(constant) + 1e-300 * np.diag([1.0] + (len(constant) - 1) * [0.0])
        assert certified_growth(FirstOrderSystem(nearly, harmonic), 1.7, 0.3, max_bits=128).verdict is not STABLE


def test_equal_multipliers_of_a_rotation_are_bounded() -> None:
    """Twice the same rotation in four states, mixed: no multiplier is simple, but a length is kept."""
    Q = np.array([[1.0, 1, 1, 1], [1, -1, 1, -1], [1, 1, -1, -1], [1, -1, -1, 1]]) / 2
    twice = Q @ np.kron(np.eye(2), SKEW) @ Q.T
    system = FirstOrderSystem(twice, twice)
    assert certified_growth(system, 1.7, 0.3).verdict is STABLE


# Independent numbers


def check_references(entries: list[dict[str, Any]]) -> None:
    for entry in entries:
        family = Reference(entry["system"], entry["eps"])
        found = certified_growth(family, entry["Omega"], family.amplitude, max_bits=128, progress=False)
        error = max(entry.get("error") or 0.0, 1e-12)
        assert found.lower - error <= entry["value"] <= found.upper + error
        assert found.upper - found.lower < 1e-12


@pytest.mark.parametrize("name", sorted({entry["system"] for entry in growth_rates()} - LARGE))
def test_reference_growth_rates_are_enclosed(name: str) -> None:
    check_references(growth_rates([name])[:2])


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted({entry["system"] for entry in growth_rates()}))
def test_all_reference_growth_rates_are_enclosed(name: str) -> None:
    check_references(growth_rates([name]))


def random_system(seed: int) -> tuple[AnySystem, float, float]:
    rng = np.random.default_rng(seed)
    make = random_first_order if rng.random() < 0.4 else random_second_order
    system = make(seed, int(rng.integers(1, 4)), pulses=bool(rng.random() < 0.4))
    return system, float(rng.uniform(0.7, 4)), float(rng.uniform(-0.8, 0.8))


def check_against_monodromy(seed: int) -> None:
    system, Omega, eps = random_system(seed)
    found = certified_growth(system, Omega, eps, max_bits=128, progress=False)
    point = monodromy(system, Omega, eps)
    period = 2 * np.pi / Omega
    miss = period * max(found.lower - point.growth_rate, point.growth_rate - found.upper)
    assert miss < 3 * point.log_modulus_error + 1e-13
    if point.kind is not Kind.UNDECIDED:
        assert found.verdict is (STABLE if point.kind is Kind.STABLE else UNSTABLE)
    assert found.upper - found.lower < 1e-7  # a rest of 1e-14 times what growth and coordinates make of it


@pytest.mark.parametrize("seed", all_but([9, 13], range(20)))
def test_random_systems(seed: int) -> None:
    check_against_monodromy(seed)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(20, 200))
def test_many_random_systems(seed: int) -> None:
    check_against_monodromy(seed)


@pytest.mark.parametrize("seed", all_but([302, 304], range(300, 306)))
def test_monodromy_agrees_with_dop853(seed: int) -> None:
    system, Omega, eps = random_system(seed)
    found = middle(certified_monodromy(system, Omega, eps))
    np.testing.assert_allclose(found, dop853(system, Omega, eps), atol=1e-8 * np.abs(found).max())


@pytest.mark.parametrize("seed", [400, 401, 402])
def test_more_bits_stay_within_fewer(seed: int) -> None:
    rng = np.random.default_rng(seed)
    terms = [
        Term(of, X, wave, int(rng.integers(1, 3)))
        for of, X in (("mass", [[0.2, 0.1], [0.1, 0.1]]), ("damping", np.eye(2)), ("gyroscopic", SKEW))
        for wave in (waveforms.rectangular(0.3, 0.9), waveforms.cosine(2, 0.1), waveforms.sawtooth())
    ]
    system = PeriodicSystem(np.eye(2), stiffness=np.diag([1.0, 3.0]), terms=terms)
    coarse, fine = (certified_monodromy(system, 1.3, 0.2, bits=bits) for bits in (64, 192))
    assert contains(coarse, fine.mid())


def test_a_mass_that_becomes_singular_is_refused_with_the_phase() -> None:
    system = PeriodicSystem([[1.0]], stiffness=[[1.0]], terms=[Term("mass", [[1.0]], waveforms.cosine())])
    with pytest.raises(ValueError, match="phase"):
        certified_growth(system, 1.0, 1.25)
    assert certified_growth(system, 1.0, 0.9, max_bits=128).lower >= 0


def test_segments_meet_at_exact_phases() -> None:
    """0.1 + 0.2 is not 0.3: the jump of a wave lies where its float64 number is."""
    from floquet.certified.reading import equation_of

    terms = [
        Term("stiffness", [[1.0]], waveforms.rectangular(0.2, 0.1)),
        Term("damping", [[1.0]], waveforms.rectangular(0.3)),
    ]
    segments = equation_of(oscillator(*terms), 1.0, 0.1).segments()
    assert [a for a, _ in segments] == [0, Fraction(0.1), Fraction(0.3), Fraction(0.1 + 0.2)]
