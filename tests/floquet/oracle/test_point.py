"""`monodromy`: the identities of the theory, another integrator, exact solutions, honest errors, clear refusals."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
import scipy.linalg as sla
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from floquet import Kind, monodromy
from periodic import PeriodicSystem
from periodic.checks import FloatArray
from periodic.examples import coupled_mathieu, gyroscopic_rotor, mathieu, meissner
from tests.floquet.oracle_systems import dop853, first_order, random_system
from tests.strategies import amplitudes, frequencies, systems

some = settings(max_examples=25, deadline=None)


def relative(found: FloatArray, exact: FloatArray) -> float:
    """Spectral norm of the difference, as `Monodromy.error` measures it."""
    return float(np.linalg.norm(found - exact, 2)) / max(1.0, float(np.linalg.norm(exact, 2)))


@some
@given(systems(), frequencies)
def test_without_excitation_it_is_the_exponential(system: PeriodicSystem, Omega: float) -> None:
    found = monodromy(system, Omega, 0.0)
    A = 2 * np.pi / Omega * first_order(system, Omega, 0.0, 0.0)
    # of a small argument, then squared: with norm 6, expm of SciPy 1.17 is off by 5e-13 (against 40 digits)
    exact = np.linalg.matrix_power(sla.expm(A / 64), 64)
    assert relative(found.matrix, exact) <= 3 * found.error + 1e-13


@some
@given(systems(), frequencies, amplitudes)
def test_agrees_with_dop853(system: PeriodicSystem, Omega: float, eps: float) -> None:
    found = monodromy(system, Omega, eps)
    difference = relative(found.matrix, dop853(system, Omega, eps))
    assert difference < 1e-8
    # honest: the allowance on top of the estimate is for DOP853 itself, which loses digits where the motion grows
    assert difference <= 3 * found.error + 5e-11
    # growth in mid-period amplifies rounding: 1e-11 is not reached everywhere
    assert found.error < 1e-10


@some
@given(systems(), frequencies, amplitudes)
def test_liouville(system: PeriodicSystem, Omega: float, eps: float) -> None:
    found = monodromy(system, Omega, eps)
    # relative error of a determinant: that of the matrix times the norm of the inverse
    sizes = np.linalg.svd(found.matrix, compute_uv=False)
    tolerance = 20 * max(1.0, sizes[0]) / max(sizes[-1], 1e-99) * (found.error + 1e-15)
    assume(tolerance < 1e-3)  # else the determinant of the matrix is noise
    sign, log_determinant = np.linalg.slogdet(found.matrix)
    exact = -2 * np.pi / Omega * np.trace(np.linalg.solve(system.mass, system.damping))
    assert sign == 1
    assert log_determinant == pytest.approx(exact, abs=tolerance)


@some
@given(systems(), frequencies, amplitudes)
def test_liouville_holds_for_the_multipliers_however_small(system: PeriodicSystem, Omega: float, eps: float) -> None:
    found = monodromy(system, Omega, eps)
    exact = -2 * np.pi / Omega * np.trace(np.linalg.solve(system.mass, system.damping))
    # near multiple multipliers the errors are large, but cancel in the product
    tolerance = 3 * float(found.multiplier_errors.sum()) + 1e-12
    assert np.log(np.abs(found.multipliers)).sum() == pytest.approx(exact, abs=tolerance)


@some
@given(
    systems().filter(lambda s: not s.damping.any() and (s.stiffness == s.stiffness.T).all()), frequencies, amplitudes
)
def test_conservative_systems_are_symplectic(system: PeriodicSystem, Omega: float, eps: float) -> None:
    found = monodromy(system, Omega, eps)
    M, G, zero = system.mass, system.gyroscopic, np.zeros_like(system.mass)
    # dx ^ dp with p = M W' + G W / 2, in terms of q = (W', W)
    form = np.block([[zero, -M], [M, G]])
    Phi = found.matrix
    size = np.linalg.norm(Phi, 2) ** 2 * np.linalg.norm(form, 2)
    assert np.linalg.norm(Phi.T @ form @ Phi - form, 2) <= 3 * size * (found.error + 1e-15)


@some
@given(st.integers(0, 10**6), st.integers(1, 4), frequencies, amplitudes)
def test_reciprocal_pairs(seed: int, n: int, Omega: float, eps: float) -> None:
    found = monodromy(random_system(seed, n, 2), Omega, eps)
    mu, errors = found.multipliers, found.multiplier_errors
    assume(errors.max() < 1e-6)  # else some are multiple, and not known to so many digits
    for one, error in zip(mu, errors, strict=True):
        assert np.abs(mu * one.conj() - 1).min() <= 3 * (error + errors.max()) + 1e-13


@some
@given(st.integers(0, 10**6), st.integers(1, 4), st.booleans(), frequencies, amplitudes)
def test_sign_of_a_single_cosine_does_not_matter(seed: int, n: int, symmetric: bool, Omega: float, eps: float) -> None:
    s = random_system(seed, n, symmetric=symmetric, damping=0.1)
    one = PeriodicSystem(s.mass, s.gyroscopic, s.damping, s.stiffness, s.cosine)
    plus, minus = monodromy(one, Omega, eps), monodromy(one, Omega, -eps)
    # a shift of time by half a period: the matrices are similar, not equal
    tolerance = 10 * (plus.log_modulus_error + minus.log_modulus_error) * Omega / (2 * np.pi)
    assert plus.growth_rate == pytest.approx(minus.growth_rate, abs=tolerance)
    for power in (1, 2, 3):
        traces = [np.trace(np.linalg.matrix_power(m.matrix, power)) for m in (plus, minus)]
        size = float(np.linalg.norm(plus.matrix, 2))
        assert traces[0] == pytest.approx(traces[1], abs=1e-10 * size**power * s.size)


@some
@given(systems(), frequencies, amplitudes)
def test_coordinates_do_not_matter(system: PeriodicSystem, Omega: float, eps: float) -> None:
    n = system.size
    T = np.eye(n) + 0.3 * np.random.default_rng(n).standard_normal((n, n)) / n
    arrays = (system.mass, system.gyroscopic, system.damping, system.stiffness, system.cosine, system.sine)
    changed = PeriodicSystem(*[T.T @ S @ T for S in arrays])
    one, other = monodromy(system, Omega, eps), monodromy(changed, Omega, eps)
    both = sla.block_diag(T, T)
    size = 1 + float(np.linalg.norm(one.matrix))
    assert both @ other.matrix == pytest.approx(one.matrix @ both, abs=1e-10 * size)
    tolerance = 10 * (one.log_modulus_error + other.log_modulus_error) * Omega / (2 * np.pi)
    assert one.growth_rate == pytest.approx(other.growth_rate, abs=tolerance, rel=1e-15)


@pytest.mark.parametrize("eps", [0.3, 1.5, -4.0])
def test_meissner_discriminant(eps: float) -> None:
    # piecewise constant stiffness has a closed form; its Fourier series, cut at J, differs by O(1 / J^2) in the trace
    delta, Omega = 1.2, 1.7
    u, v = (np.pi * np.emath.sqrt(delta + s * eps) / Omega for s in (1, -1))
    exact = (2 * np.cos(u) * np.cos(v) - (u / v + v / u) * np.sin(u) * np.sin(v)).real
    errors = [np.trace(monodromy(meissner(delta, harmonics=J), Omega, eps).matrix) - exact for J in (9, 81)]
    assert abs(errors[1]) < abs(errors[0]) / 20
    assert abs(errors[1]) < 2e-3 * abs(exact)


def test_round_rotor_is_mathieu() -> None:
    k, spin, Omega, eps = 4.0, 0.5, 3.9, 1.0
    rotor = monodromy(gyroscopic_rotor((k, k), spin), Omega, eps)
    plain = monodromy(mathieu(k), Omega, eps)
    turn = np.exp(1j * spin * 2 * np.pi / Omega)
    expected = np.concatenate([plain.multipliers * turn, plain.multipliers / turn])
    assert np.poly(rotor.multipliers) == pytest.approx(np.poly(expected), abs=1e-11)
    assert plain.kind == Kind.MINUS_ONE
    assert rotor.kind == Kind.COMPLEX
    assert rotor.growth_rate == pytest.approx(plain.growth_rate, abs=1e-11)


def test_damping_shifts_mathieu_exactly() -> None:
    # x = y exp(-c t / 2) turns x'' + c x' + (delta + c^2/4 + eps cos) x = 0 into the undamped equation
    delta, c, Omega, eps = 1.0, 0.3, 1.9, 0.8
    damped = monodromy(mathieu(delta + c**2 / 4, c), Omega, eps)
    plain = monodromy(mathieu(delta), Omega, eps)
    assert damped.multipliers == pytest.approx(plain.multipliers * np.exp(-c * np.pi / Omega), abs=1e-12)


@pytest.mark.parametrize("eps", [0.0, 0.4])
def test_paul_trap(eps: float) -> None:
    # negative stiffness: a saddle without excitation; a strong fast one stabilises it (Paul, Nobel lecture 1989)
    trap = mathieu(-0.05)
    assert monodromy(trap, 2.0, eps).kind == Kind.PLUS_ONE
    assert monodromy(trap, 2.0, 1.0).kind == Kind.STABLE


def test_free_motion() -> None:
    # no stiffness at all: x grows linearly, both multipliers are one and defective; nothing else is left to judge
    free = PeriodicSystem([[2.0]], [[0.0]], [[0.0]], [[0.0]], [[[0.0]]])
    found = monodromy(free, 0.5, 1.0)
    assert found.matrix == pytest.approx(np.array([[1.0, 0.0], [4 * np.pi, 1.0]]), abs=1e-13)
    assert (found.kind, found.rigid, found.growth_rate) == (Kind.STABLE, 1, 0.0)
    assert found.multipliers == pytest.approx([1.0, 1.0], abs=0)


@pytest.mark.parametrize("Omega", [1e-3, 1e6])
def test_extreme_frequencies(Omega: float) -> None:
    # far below resonance the phase is that of slowly varying stiffness, far above it that of the mean
    system, eps = mathieu(1.0), 0.5
    found = monodromy(system, Omega, eps)
    assert relative(found.matrix, dop853(system, Omega, eps)) < 1e-8 if Omega > 1 else found.kind == Kind.STABLE
    assert found.error < 1e-11
    if Omega < 1:
        # WKB: the phase in one period is the integral of sqrt(1 + eps cos)
        theta = 2 * np.pi * np.arange(4096) / 4096
        phase = np.sqrt(1 + eps * np.cos(theta)).mean() * 2 * np.pi / Omega
        assert np.trace(found.matrix) == pytest.approx(2 * np.cos(phase), abs=1e-3)


def test_large_amplitude_and_growth() -> None:
    # eps = 10 at a low frequency: multipliers like exp(100); the growth is that of the same system by DOP853
    system, Omega, eps = coupled_mathieu("sum"), 0.15, 10.0
    found = monodromy(system, Omega, eps)
    assert found.kind == Kind.PLUS_ONE
    log_modulus = found.growth_rate * 2 * np.pi / Omega
    assert log_modulus > 50
    exact = np.log(np.abs(np.linalg.eigvals(dop853(system, Omega, eps))).max())
    assert log_modulus == pytest.approx(exact, abs=1e-9)


def test_a_hundred_coordinates() -> None:
    # a chain with fixed ends under pulsating tension: every mode is a Mathieu equation
    n, Omega, eps = 100, 1.0, 0.2
    K = 2 * np.eye(n) - np.eye(n, k=1) - np.eye(n, k=-1)
    rotation = sla.qr(np.random.default_rng(0).standard_normal((n, n)))[0]  # hides the structure
    K = rotation.T @ K @ rotation
    K = (K + K.T) / 2
    found = monodromy(PeriodicSystem(np.eye(n), np.zeros((n, n)), np.zeros((n, n)), K, K[None]), Omega, eps)
    omega2 = 4 * np.sin(np.pi * np.arange(1, n + 1) / (2 * n + 2)) ** 2
    single = [PeriodicSystem([[1.0]], [[0.0]], [[0.0]], [[w]], [[[w]]]) for w in omega2]
    traces = sum(np.trace(monodromy(s, Omega, eps).matrix) for s in single)
    assert np.trace(found.matrix) == pytest.approx(traces, abs=1e-9)
    rates = [monodromy(s, Omega, eps).growth_rate for s in single]
    assert found.growth_rate == pytest.approx(max(rates), abs=1e-9)


@pytest.mark.parametrize("tolerance", [1e-4, 1e-7, 1e-10])
def test_tolerance_is_kept_and_estimated(tolerance: float) -> None:
    for seed in range(15):
        system = random_system(seed, 1 + seed % 5, 1 + seed % 3, symmetric=seed % 2 == 0, damping=0.1 * (seed % 3))
        exact = monodromy(system, 0.9, 1.0)
        loose = monodromy(system, 0.9, 1.0, tolerance=tolerance)
        true = relative(loose.matrix, exact.matrix)
        assert loose.error <= tolerance
        assert true <= 3 * loose.error + 1e-13
        if true > 1e-11:  # below, what counts is rounding, which the estimate bounds generously
            assert loose.error < 1e4 * true


def test_result_is_consistent_and_frozen() -> None:
    found = monodromy(random_system(3, 3, 2, damping=0.2), 1.3, 0.9)
    assert found.matrix.shape == (6, 6)
    assert found.multipliers.shape == (6,)
    moduli = np.abs(found.multipliers)
    assert (np.diff(moduli) <= 1e-15 * moduli[0]).all()
    assert found.growth_rate == pytest.approx(math.log(moduli[0]) * 1.3 / (2 * np.pi), abs=1e-14)
    mu = np.linalg.eigvals(found.matrix)
    assert np.poly(mu) == pytest.approx(np.poly(found.multipliers), rel=1e-10, abs=1e-10)
    for array in (found.matrix, found.multipliers, found.multiplier_errors):
        assert not array.flags.writeable
    with pytest.raises(AttributeError):
        found.error = 0.0  # type: ignore[misc]


def test_same_input_gives_the_same_bits() -> None:
    system = random_system(4, 5, 2)
    one, two = (monodromy(system, 1.1, 0.7) for _ in range(2))
    assert (one.matrix == two.matrix).all()
    assert one.error == two.error


def test_family_is_taken_at_its_frequency() -> None:
    class Family:
        def at(self, Omega: float) -> PeriodicSystem:
            return mathieu(Omega**2)

    assert monodromy(Family(), 2.0, 0.1).matrix == pytest.approx(monodromy(mathieu(4.0), 2.0, 0.1).matrix, abs=0)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"system": None}, "system = None is no system"),
        ({"system": PeriodicSystem}, "is no system"),
        ({"Omega": 0.0}, "Omega = 0.0 is out of range; give a positive number"),
        ({"Omega": -1}, "Omega = -1"),
        ({"Omega": math.nan}, "Omega = nan"),
        ({"Omega": "2"}, "Omega = '2' is not a number"),
        ({"Omega": [2.0]}, "Omega = "),
        ({"eps": math.inf}, "eps = inf"),
        ({"eps": None}, "eps = None"),
        ({"eps": 1j}, "eps = 1j"),
        ({"tolerance": 0.0}, "tolerance = 0.0"),
        ({"tolerance": 0.1}, "tolerance = 0.1 is out of range"),
        ({"Omega": 1e-9}, "give a larger Omega"),
        ({"Omega": 1e-3, "eps": 10.0}, "grows by more than 1e"),
    ],
)
def test_bad_arguments(arguments: dict[str, Any], message: str) -> None:
    given_: dict[str, Any] = {"system": mathieu(), "Omega": 2.0, "eps": 0.1} | arguments
    with pytest.raises(ValueError, match=message):
        monodromy(**given_)


def test_family_that_gives_no_system() -> None:
    class Family:
        def at(self, Omega: float) -> FloatArray:
            return np.eye(2)

    with pytest.raises(ValueError, match="it must give a PeriodicSystem"):
        monodromy(Family(), 2.0, 0.1)  # type: ignore[arg-type]
