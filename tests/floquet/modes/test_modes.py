"""Floquet modes against exact ones and against Fourier series of solutions that SciPy integrated."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.special import mathieu_a, mathieu_b, mathieu_cem, mathieu_sem

from floquet import monodromy
from floquet.modes import FloquetModes, floquet_modes
from periodic import AnySystem, FirstOrderSystem, PeriodicSystem, Term, waveforms
from periodic.examples import coupled_mathieu, mathieu
from plate import MovingPlate
from tests.floquet.general_oracles import coefficient_matrix, random_first_order, random_second_order

TURN = np.array([[0.0, -1.0], [1.0, 0.0]])


def turning(B: np.ndarray, Omega: float) -> FirstOrderSystem:
    """x = Q z, where Q turns by Omega t and z' = B z (Lyapunov's transformation): Q' Q^-1 + Q B Q^-1."""
    even, odd = (B - TURN @ B @ TURN) / 2, (B + TURN @ B @ TURN) / 2
    return FirstOrderSystem(Omega * TURN + even, [0 * odd, odd], [0 * odd, TURN @ odd])


@pytest.mark.parametrize("seed", range(4))
def test_modes_of_a_lyapunov_transformable_system_are_exact(seed: int) -> None:
    rng = np.random.default_rng(seed)
    B, Omega = rng.standard_normal((2, 2)), rng.uniform(0.5, 2)
    values, vectors = np.linalg.eig(B)
    modes = floquet_modes(turning(B, Omega), Omega, 1.0)
    times = np.linspace(0, 2 * np.pi / Omega, 7)
    c, s = np.cos(Omega * times), np.sin(Omega * times)
    Q = np.array([[c, -s], [s, c]]).transpose(2, 0, 1)
    for mode in modes:
        shift = (mode.exponent - values) / (1j * Omega)  # a whole number for the vector that is meant
        i = int(np.abs(shift - np.rint(shift.real)).argmin())
        k = int(np.rint(shift[i].real))
        assert abs(mode.exponent - values[i] - 1j * k * Omega) < 1e-11 * abs(Omega + abs(values[i]))
        exact = (Q @ vectors[:, i]) * np.exp(-1j * k * Omega * times)[:, None]
        found = mode.periodic(times)
        factor = np.vdot(exact, found) / np.vdot(exact, exact)
        np.testing.assert_allclose(found, factor * exact, atol=1e-10 * np.abs(found).max())
        # only the harmonics -1 and 1 of Q: counted from the branch
        shares = dict(zip(mode.harmonics.tolist(), mode.participation, strict=True))
        assert abs(shares[-1 - k] + shares[1 - k] - 1) < 1e-12
        assert k in (-1, 1)
        assert shares[0] >= 0.5 - 1e-9


@pytest.mark.parametrize("m", [1, 2, 3])
def test_modes_on_the_edges_of_mathieu_s_regions_are_mathieu_functions(m: int) -> None:
    q = 1.3
    for a, function in ((mathieu_a(m, q), mathieu_cem), (mathieu_b(m, q), mathieu_sem)):
        # y'' + (a - 2 q cos 2 x) y = 0
        modes = floquet_modes(PeriodicSystem([[1.0]], stiffness=[[a]], cosine=[[[-2 * q]]]), 2.0, 1.0)
        assert modes.clusters == ((0, 1),)
        np.testing.assert_allclose(modes.multipliers, (-1.0) ** m, atol=1e-6)  # a double one: half of the digits
        times = np.linspace(0, np.pi, 9)
        found = modes[0].periodic(times)[:, 1] * np.exp(1j * modes[0].frequency * times)
        exact = np.array([function(m, q, np.degrees(t))[0] for t in times])
        factor = np.vdot(exact, found) / np.vdot(exact, exact)
        np.testing.assert_allclose(found, factor * exact, atol=1e-8 * np.abs(found).max())


def series_by_dop853(system: AnySystem, modes: FloquetModes, number: int, eps: float, P: int = 256) -> np.ndarray:
    """Fourier coefficients of e^{-lambda t} x(t), x integrated by DOP853 from the eigenvector of its own monodromy
    matrix whose multiplier is nearest."""
    Omega = modes.Omega
    T = 2 * np.pi / Omega

    def rate(t: float, x: np.ndarray, N: int) -> np.ndarray:
        return (coefficient_matrix(system, Omega * t, eps) @ x.reshape(-1, N)).ravel()

    N = len(coefficient_matrix(system, 0.1, eps))
    tight = {"method": "DOP853", "rtol": 1e-13, "atol": 1e-14}
    Phi = solve_ivp(rate, (0, T), np.eye(N).ravel(), args=(N,), **tight).y[:, -1].reshape(N, N)
    mu, vectors = np.linalg.eig(Phi)
    i = int(np.abs(mu - modes[number].multiplier).argmin())
    times = np.arange(P) * T / P
    path = solve_ivp(rate, (0, T), vectors[:, i].astype(complex), t_eval=times, args=(1,), **tight).y
    lam = np.log(mu[i]) / T
    lam += 1j * Omega * np.rint((modes[number].exponent - lam).imag / Omega)
    assert abs(lam - modes[number].exponent) < 1e-9 * (1 + abs(lam))
    return np.fft.fft(path * np.exp(-lam * times), axis=1).T / P


SMOOTH = [
    *(random_second_order(seed, 2, kinds=3) for seed in range(3)),
    *(random_first_order(seed, 3, kinds=3) for seed in range(3)),
    coupled_mathieu(damping=(0.01, 0.02)),
]


@pytest.mark.parametrize("system", SMOOTH)
def test_modes_agree_with_fourier_series_of_integrated_solutions(system: AnySystem) -> None:
    modes = floquet_modes(system, 1.7, 0.4)
    for number, mode in enumerate(modes):
        if abs(mode.multiplier) < 1e-2 * abs(modes.multipliers[0]):
            continue  # DOP853's own eigenvector is no better
        other = series_by_dop853(system, modes, number, 0.4)
        K = int(min(mode.harmonics[-1], 60))
        other = other[np.arange(-K, K + 1)]
        found = mode.coefficients[np.abs(mode.harmonics) <= K]
        factor = np.vdot(other, found) / np.vdot(other, other)
        np.testing.assert_allclose(found, factor * other, atol=1e-8 * np.abs(found).max())


@pytest.mark.parametrize("jumping", [False, True])
@pytest.mark.parametrize("seed", range(3))
def test_every_mode_of_any_system_satisfies_its_equation(seed: int, jumping: bool) -> None:
    """p' + lambda p = A p, by differences of the interpolated mode."""
    system = random_second_order(seed, 3, kinds=7 if jumping else 3, pulses=jumping)
    Omega, eps = 1.3, 0.5
    modes = floquet_modes(system, Omega, eps)
    T, h = 2 * np.pi / Omega, 1e-3
    jumps = np.array([jump for term in system.terms for jump in term.waveform.jumps] or [-9.0])
    times = (np.arange(20) + 0.37) * T / 20
    times = times[np.abs(times[:, None] / T - jumps).min(axis=1) > 4 * h]
    for mode in modes:
        values = [mode.motion(times + place * h) for place in (-2, -1, 1, 2)]
        slope = (values[0] - 8 * values[1] + 8 * values[2] - values[3]) / (12 * h)
        exact = np.array(
            [coefficient_matrix(system, Omega * t, eps) @ x for t, x in zip(times, mode.motion(times), strict=True)]
        )
        np.testing.assert_allclose(slope, exact, atol=1e-8 * np.abs(exact).max())
        np.testing.assert_allclose(mode.periodic(times + T), mode.periodic(times), atol=1e-12 * np.abs(exact).max())


@pytest.mark.parametrize(
    "system",
    [
        random_second_order(5, 3),
        random_first_order(5, 5, pulses=True),
        PeriodicSystem([[1.0]], stiffness=[[1.0]], terms=[Term("stiffness", [[0.5]], waveforms.rectangular(0.3))]),
        MovingPlate(axial_terms=2, lateral_terms=3, damping=0.001),
    ],
)
def test_participations_sum_to_one_and_little_is_left_out(system: AnySystem) -> None:
    modes = floquet_modes(system, 20.0 if isinstance(system, MovingPlate) else 1.1, 0.4)
    np.testing.assert_allclose(modes.participation.sum(axis=1), 1.0, atol=1e-14)
    assert max(mode.left_out for mode in modes) < 1e-4  # kinks and jumps have long series
    assert (modes.participation.argmax(axis=1) - len(modes.harmonics) // 2 == 0).mean() > 0.4


def test_all_multipliers_are_right_however_small() -> None:
    plate = MovingPlate(axial_terms=3, lateral_terms=3, damping=0.03)
    modes = floquet_modes(plate, 12.0, 0.3)
    expected = np.sort(np.log(np.abs(monodromy(plate, 12.0, 0.3).multipliers)))
    assert expected[0] < -100
    np.testing.assert_allclose(np.sort(modes.growth_rates * modes.period), expected, rtol=1e-9, atol=1e-9)


def test_exponents_of_multipliers_below_all_floats() -> None:
    """Two uncoupled oscillators, one of them damped so that e^{lambda T} = 1e-700: exact."""
    system = PeriodicSystem(np.eye(2), damping=np.diag([0.02, 40.0]), stiffness=np.diag([1.0, 4000.0]))
    modes = floquet_modes(system, 2 * np.pi / 80, 0.3)
    exact = [-0.01 + 1j * np.sqrt(1 - 1e-4), -20 + 1j * np.sqrt(3600)]
    np.testing.assert_allclose(modes.exponents[[0, 2]], exact, rtol=1e-12)
    assert modes.multipliers[2] == 0
    np.testing.assert_allclose(modes.damping_ratios[[0, 2]], [0.01, 20 / np.sqrt(4000)], rtol=1e-12)


def test_the_branch_is_that_of_the_strongest_harmonic() -> None:
    """At small eps exponents are those of the free system, far beyond what the angle of a multiplier tells."""
    system = PeriodicSystem(np.eye(2), stiffness=np.diag([1.0, 90.0]), cosine=[np.ones((2, 2))])
    frequencies = floquet_modes(system, 0.77, 1e-4).frequencies
    np.testing.assert_allclose(np.sort(np.abs(frequencies)), [1, 1, np.sqrt(90), np.sqrt(90)], rtol=1e-6)


def test_left_modes_are_biorthogonal() -> None:
    modes = floquet_modes(random_second_order(7, 3), 1.2, 0.5)
    left = np.array([modes.left(i) for i in range(len(modes))])
    np.testing.assert_allclose(left @ np.array([mode.periodic(0.0) for mode in modes]).T, np.eye(6), atol=1e-9)


def test_rigid_motions_are_left_out() -> None:
    two = PeriodicSystem(np.eye(2), stiffness=[[1.0, -1.0], [-1.0, 1.0]], cosine=[[[1.0, -1.0], [-1.0, 1.0]]])
    modes = floquet_modes(two, 2.2, 0.2)
    assert (modes.rigid, len(modes)) == (1, 2)
    response = modes.response([1.0, 1.0, 0.0, 0.0], 2)  # a common velocity
    np.testing.assert_allclose(response.displacement, response.times[:, None] * [1.0, 1.0], atol=1e-12)


def test_a_representation_fits_a_screen() -> None:
    text = repr(floquet_modes(mathieu(), 2.0, 0.1))
    assert "growth rate" in text
    assert max(map(len, text.splitlines())) <= 80
    assert len(text.splitlines()) <= 24


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((None, 1.0, 0.1), "no system"),
        ((mathieu(), -1.0, 0.1), r"Omega = -1\.0"),
        ((mathieu(), 1.0, np.nan), "eps = nan"),
        ((mathieu(), 1e-5, 0.1), "Omega"),
    ],
)
def test_wrong_arguments_are_named(arguments: tuple, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        floquet_modes(*arguments)
