"""Responses and transient growth against SciPy's integrator and against brute force."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.linalg as sla
from scipy.integrate import solve_ivp

from floquet.modes import floquet_modes
from periodic import FirstOrderSystem, PeriodicSystem
from periodic.examples import mathieu
from tests.floquet.general_oracles import coefficient_matrix, dop853, random_first_order, random_second_order


def integrated(system: PeriodicSystem, Omega: float, eps: float, start: np.ndarray, times: np.ndarray) -> np.ndarray:
    def rate(t: float, x: np.ndarray) -> np.ndarray:
        return coefficient_matrix(system, Omega * t, eps) @ x

    return solve_ivp(rate, (0, times[-1]), start, "DOP853", times, rtol=1e-12, atol=1e-13).y.T


@pytest.mark.parametrize("seed", range(3))
def test_response_is_that_of_another_integrator(seed: int) -> None:
    system = random_second_order(seed, 2, kinds=3)
    start = np.random.default_rng(seed).standard_normal(4)
    response = floquet_modes(system, 1.9, 0.3).response(start, 3, samples=16)
    other = integrated(system, 1.9, 0.3, start, response.times)
    np.testing.assert_allclose(response.states, other, atol=1e-9 * np.abs(other).max())
    np.testing.assert_array_equal(response.displacement, response.states[:, 2:])


def test_response_passes_jumps() -> None:
    system = random_first_order(3, 3, pulses=True)
    response = floquet_modes(system, 1.1, 0.4).response([1.0, 0.0, 0.0], 2, samples=5)
    Phi = dop853(system, 1.1, 0.4)
    np.testing.assert_allclose(response.states[[5, 10]], [Phi[:, 0], (Phi @ Phi)[:, 0]], rtol=1e-8, atol=1e-10)


def test_energy_of_a_free_conservative_system_stays() -> None:
    system = PeriodicSystem(np.diag([1.0, 2.0]), [[0.0, 0.7], [-0.7, 0.0]], stiffness=[[3.0, 1.0], [1.0, 2.0]])
    energy = floquet_modes(system, 2.0, 0.0).response([0.3, -0.2, 1.0, 0.5], 4).energy
    assert energy is not None
    np.testing.assert_allclose(energy, energy[0], rtol=1e-12)
    exact = 0.5 * (0.3**2 + 2 * 0.2**2) + 0.5 * np.array([1.0, 0.5]) @ [[3.0, 1.0], [1.0, 2.0]] @ [1.0, 0.5]
    assert abs(energy[0] - exact) < 1e-14


def test_transient_growth_is_that_of_brute_force() -> None:
    """A stable system whose energy grows first: half a million initial values, then the best one improved."""
    system = PeriodicSystem(
        np.eye(2), damping=np.diag([0.1, 0.2]), stiffness=[[1.0, 3.0], [0.0, 4.0]], cosine=[[[0.3, 0.0], [0.2, 0.1]]]
    )
    modes = floquet_modes(system, 2.7, 0.5)
    assert modes.growth_rates.max() < 0
    energy = np.diag([0.5, 0.5, 0.5, 2.0])
    found = modes.transient(6, energy=energy)
    times = np.linspace(0, 6 * modes.period, 6001)
    unit = [integrated(system, 2.7, 0.5, column, times) for column in np.eye(4)]
    Phi = np.stack(unit, axis=2)
    rng = np.random.default_rng(0)
    best, x = 0.0, np.zeros(4)
    coarse = Phi[::20]
    for spread in (None, 0.3, 0.1, 0.03, 0.01, 3e-3, 1e-3, 3e-4, 1e-4):
        tried = rng.standard_normal((4, 500)) if spread is None else x[:, None] + spread * rng.standard_normal((4, 500))
        tried /= np.sqrt(np.einsum("ik,ij,jk->k", tried, energy, tried))
        grown = np.einsum("tik,ij,tjk->tk", coarse @ tried, energy, coarse @ tried)
        k = int(grown.max(axis=0).argmax())
        if grown[:, k].max() > best:
            best, x = float(grown[:, k].max()), tried[:, k]
    fine = np.einsum("ti,ij,tj->t", Phi @ x, energy, Phi @ x)
    assert found.largest > 2
    assert abs(fine.max() / found.largest - 1) < 1e-6
    assert found.largest >= fine.max() * (1 - 1e-9)  # no initial values do better
    assert abs(times[fine.argmax()] - found.time) < 2e-2
    reached = np.einsum("i,ij,j", found.initial, energy, found.initial)
    assert abs(reached - 1) < 1e-12
    at_top = integrated(system, 2.7, 0.5, found.initial, np.array([0.0, found.time]))[-1]
    assert abs(at_top @ energy @ at_top / found.largest - 1) < 1e-7


def test_the_largest_growth_is_found_between_samples() -> None:
    """x' = A x: brute force over times by the exponential."""
    A = np.array([[-0.1, 5.0], [0.0, -0.3]])
    found = floquet_modes(FirstOrderSystem(A), 2.0, 0.0).transient(10, samples=8)

    def growth(t: float) -> float:
        return float(np.linalg.norm(sla.expm(A * t), 2)) ** 2

    middle = max(np.linspace(1, 12, 111), key=growth)
    exact = max(map(growth, np.linspace(middle - 0.1, middle + 0.1, 201)))
    assert abs(found.largest / exact - 1) < 1e-7
    first = found.time_to_reach(10.0)
    assert abs(np.linalg.norm(sla.expm(A * first), 2) ** 2 / 10 - 1) < 0.05
    assert found.time_to_reach(1e9) == np.inf


def test_time_to_grow_tenfold() -> None:
    modes = floquet_modes(mathieu(), 2.0, 0.1)
    mode = modes[0]
    time = modes.time_to_grow(10)
    start, end = mode.motion(0.0), mode.motion(4 * np.pi * np.round(time / (4 * np.pi)))
    factor = np.linalg.norm(end) / np.linalg.norm(start)
    assert abs(np.log(factor) - np.log(10) * 4 * np.pi * np.round(time / (4 * np.pi)) / time) < 1e-9
    assert floquet_modes(mathieu(damping=0.5), 2.0, 0.1).time_to_grow() == np.inf


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda modes: modes.response([1.0], 2), "initial has shape"),
        (lambda modes: modes.response([1.0, 0.0], 0), "periods = 0"),
        (lambda modes: modes.response([1.0, 0.0], 20_000), "fewer periods"),
        (lambda modes: modes.transient(3, energy=[[1.0, 2.0], [2.0, 1.0]]), "energy"),
        (lambda modes: modes.time_to_grow(-1), "factor"),
    ],
)
def test_wrong_arguments_are_named(call, message: str) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(ValueError, match=message):
        call(floquet_modes(mathieu(), 2.0, 0.3))


def test_an_indefinite_stiffness_defines_no_energy() -> None:
    modes = floquet_modes(PeriodicSystem([[1.0]], stiffness=[[-0.1]], cosine=[[[1.0]]]), 2.0, 0.3)
    assert modes.response([0.0, 1.0], 1).energy is None
    with pytest.raises(ValueError, match="energy is not given"):
        modes.transient(2)
