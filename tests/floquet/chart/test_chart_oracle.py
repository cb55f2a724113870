"""Charts against other integrators on random cells: no false verdict, honest errors, and the trap of too few steps."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.linalg as sla
from scipy.integrate import solve_ivp

import floquet.engine.multipliers
from floquet import Kind, monodromy, stability_chart
from floquet.engine import MIN_STEPS_PER_CYCLE, chart_batch
from floquet.engine.column import MEASUREMENT_REACH, _measured
from floquet.engine.eigen.hessenberg import eigenvalues
from floquet.engine.steps import measured_amplitudes
from periodic import PeriodicSystem
from periodic.checks import ComplexArray, FloatArray
from periodic.examples import coupled_mathieu, gyroscopic_rotor, mathieu
from plate import EdgeLoad, MovingPlate
from tests.floquet.oracle_systems import random_system
from tests.sparing import all_but

# Error of the multipliers of DOP853 with rtol = 1e-10, and what becomes of it where two of them coalesce
DOP853_ERROR = 1e-8
DOP853_COALESCED = 1e-4

STANDARD = MovingPlate(load=EdgeLoad.partial(0.5), inplane="static").at(40.0)
DAMPED = MovingPlate(load=EdgeLoad.partial(0.5), inplane="static", damping=0.002).at(40.0)


def log_modulus(system: PeriodicSystem, Omega: float, eps: float) -> float:
    """log|mu| of the dominant multiplier by SciPy's DOP853."""
    n = system.size
    constant, *varying = (
        np.linalg.solve(system.mass, S)
        for S in (np.hstack([system.stiffness, system.gyroscopic + system.damping]), *system.cosine, *system.sine)
    )

    def rate(t: float, y: FloatArray) -> FloatArray:
        Y = y.reshape(2 * n, 2 * n)
        acceleration = -constant @ Y
        for j in range(system.harmonics):
            phase = (j + 1) * Omega * t
            S = np.cos(phase) * varying[j] + np.sin(phase) * varying[system.harmonics + j]
            acceleration -= eps * S @ Y[:n]
        return np.vstack([Y[n:], acceleration]).ravel()

    # displacements in units that make the energy a sum of squares: else the error of stiff modes is weighed wrongly
    end = solve_ivp(rate, (0, 2 * np.pi / Omega), np.eye(2 * n).ravel(), method="DOP853", rtol=1e-10, atol=1e-11)
    return float(np.log(np.abs(np.linalg.eigvals(end.y[:, -1].reshape(2 * n, 2 * n))).max()))


def assert_no_false_verdict(system: PeriodicSystem, Omega: FloatArray, eps: FloatArray, cells: int, seed: int) -> int:
    """Integrate ``cells`` random cells of a chart once more; return how many of them are decided."""
    chart = stability_chart(system, Omega, eps, audit=0, progress=False)
    rng = np.random.default_rng(seed)
    decided = 0
    for i, j in zip(rng.integers(len(eps), size=cells), rng.integers(len(Omega), size=cells), strict=True):
        found = chart.growth_rate[i, j] * 2 * np.pi / Omega[j]
        exact = log_modulus(system, Omega[j], eps[i])
        where = f"Omega = {Omega[j]}, eps = {eps[i]}: {found} +- {chart.error[i, j]}, DOP853 {exact}"
        assert abs(found - exact) <= 3 * chart.error[i, j] + DOP853_COALESCED, where
        if chart.kind[i, j] > Kind.STABLE:
            assert exact > 0, where
            assert abs(found - exact) <= 3 * chart.error[i, j] + DOP853_ERROR / min(found, 1), where
        elif chart.kind[i, j] == Kind.STABLE:
            assert exact < (0 if system.damping.any() else DOP853_COALESCED), where
        decided += chart.kind[i, j] >= 0
    return decided


def plate_grid(rng: np.random.Generator) -> tuple[FloatArray, FloatArray]:
    return np.sort(rng.uniform(18, 85, 40)), np.sort(rng.uniform(0, 1.5, 40))


def random_grid(rng: np.random.Generator) -> tuple[FloatArray, FloatArray]:
    return np.sort(rng.uniform(0.5, 6, 12)), np.sort(rng.uniform(-1.5, 1.5, 12))


@pytest.mark.parametrize("system", all_but([STANDARD], [STANDARD, DAMPED]), ids=["elastic", "damped"])
def test_no_false_verdict_on_the_plate(system: PeriodicSystem) -> None:
    cells = 15
    assert assert_no_false_verdict(system, *plate_grid(np.random.default_rng(1)), cells, 2) >= cells - 2


@pytest.mark.parametrize("seed", all_but([1, 2, 5], range(6)))
def test_no_false_verdict_on_random_systems(seed: int) -> None:
    system = random_system(seed, 2 + seed % 3, 1 + seed % 2, damping=0.1 * (seed % 2))
    cells = 25
    assert assert_no_false_verdict(system, *random_grid(np.random.default_rng(seed)), cells, seed) >= cells - 2


@pytest.mark.slow
@pytest.mark.parametrize("part", range(5))
def test_no_false_verdict_on_two_thousand_cells(part: int) -> None:
    rng = np.random.default_rng(100 + part)
    decided = assert_no_false_verdict(STANDARD, *plate_grid(rng), 200, part)
    for seed in range(10):
        system = random_system(
            1000 * part + seed, 1 + seed % 5, 1 + seed % 3, symmetric=seed % 4 > 0, damping=0.1 * (seed % 2)
        )
        decided += assert_no_false_verdict(system, *random_grid(rng), 20, seed)
    assert decided >= 390


def honest(system: PeriodicSystem, Omega: FloatArray, eps: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the errors of a chart and their estimates, after checking that none is more than three times larger."""
    chart = stability_chart(system, Omega, eps, audit=0, progress=False)
    errors, estimates = [], []
    for j, w in enumerate(chart.Omega):
        for i in range(0, len(chart.eps), 3):
            exact = monodromy(system, float(w), float(chart.eps[i]))
            error = abs(chart.growth_rate[i, j] - exact.growth_rate) * 2 * np.pi / w
            # where `monodromy` itself is not better, nothing is learnt
            if exact.log_modulus_error < 0.3 * chart.error[i, j]:
                assert error <= 3 * chart.error[i, j] + 1e-13, (w, chart.eps[i])
                errors.append(error)
                estimates.append(chart.error[i, j])
    return np.array(errors), np.array(estimates)


CASES = {
    "elastic plate": (STANDARD, (20, 80), (0, 1)),
    "damped plate": (DAMPED, (20, 80), (0, 1)),
    "Mathieu": (mathieu(), (0.4, 5), (0, 5)),
    "trap": (mathieu(-0.1), (0.5, 5), (0, 5)),
    "sum": (coupled_mathieu("sum"), (0.5, 5), (0, 1)),
    "difference": (coupled_mathieu("difference"), (0.5, 5), (0, 1)),
    "rotor": (gyroscopic_rotor(), (0.5, 5), (0, 1)),
    "random": (random_system(41, 4, 3), (0.4, 5), (-1, 1)),
    "random damped": (random_system(42, 4, 3, damping=0.2), (0.4, 5), (-1, 1)),
    "random unsymmetric": (random_system(43, 4, 2, symmetric=False, damping=0.2), (0.4, 5), (-1, 1)),
}
PLATES = ["elastic plate", "damped plate"]


@pytest.mark.parametrize("case", all_but(PLATES, CASES))
def test_errors_are_honest(case: str) -> None:
    system, Omega, eps = CASES[case]
    errors, estimates = honest(system, np.linspace(*Omega, 7), np.linspace(*eps, 25))
    assert len(errors) >= 30
    # not absurdly pessimistic: a conservative stable cell is exact, hence the 1e-13
    assert np.median(estimates / (errors + 1e-13)) < 1e4


@pytest.mark.parametrize("case", all_but(PLATES[:1], CASES))
def test_errors_of_columns_that_share_a_measurement_are_honest(case: str) -> None:
    system, (low, _), eps = CASES[case]
    errors, _ = honest(system, np.linspace(low, 1.08 * low, 8), np.linspace(*eps, 25))
    assert len(errors) >= 30


@pytest.mark.parametrize(
    ("system", "Omega", "eps"),
    [
        (mathieu(6.19), 2.0, 30.0),  # first found: errors four times the estimate between two measured amplitudes
        (mathieu(1.36), 0.94, 15.0),
        (mathieu(-0.7), 3.43, 18.0),
        (mathieu(3.0, 0.1), 1.7, 25.0),
        (random_system(7, 1, 3), 1.3, 15.0),
        (coupled_mathieu("sum", (1.0, 1.4)), 1.7, 8.0),
    ],
    ids=["first found", "slow", "trap", "damped", "three harmonics", "coupled"],
)
def test_errors_at_large_amplitudes_are_below_their_estimates(system: PeriodicSystem, Omega: float, eps: float) -> None:
    found = stability_chart(system, [Omega], np.linspace(0, eps, 101), audit=0, progress=False)
    compared = 0
    for i in range(2, 101, 4):
        exact = monodromy(system, Omega, float(found.eps[i]))
        if exact.log_modulus_error < 0.3 * found.error[i, 0]:
            error = abs(found.growth_rate[i, 0] - exact.growth_rate) * 2 * np.pi / Omega
            assert error <= found.error[i, 0] + 1e-13, found.eps[i]
            compared += 1
    assert compared >= 15


def test_measured_amplitudes() -> None:
    assert measured_amplitudes(np.zeros(1)) == [0]
    assert measured_amplitudes(np.array([0.0, 0.5])) == [1]
    assert measured_amplitudes(np.linspace(0, 1, 102)) == [1, 21, 41, 61, 81, 101]
    assert measured_amplitudes(np.linspace(-1, 1, 5)) == [0, 1, 3, 4]


def test_measured_columns() -> None:
    assert _measured(np.array([3.0])) == [0]
    assert _measured(np.linspace(1, 1.09, 8)) == [0, 7]
    assert _measured(np.linspace(1, 8, 8)) == list(range(8))
    Omega = np.linspace(1, 1.4, 8)
    found = _measured(Omega)
    assert found[0] == 0
    assert found[-1] == 7
    assert len(found) < 8
    for w in Omega:
        assert (np.abs(Omega[found] / w - 1) <= MEASUREMENT_REACH).any()


def test_error_where_the_multiplier_is_small_in_a_large_matrix() -> None:
    # between two tongues |mu| falls from 13 to 1.2 within one step of eps, the norm and its error do not
    system = random_system(811504540, 1, symmetric=False)
    chart = stability_chart(system, [0.9964078170023314], np.linspace(0, 1, 10), audit=0, progress=False)
    exact = monodromy(system, chart.Omega[0], chart.eps[8])
    error = abs(chart.growth_rate[8, 0] - exact.growth_rate) * 2 * np.pi / chart.Omega[0]
    assert error > 10 * exact.log_modulus_error
    assert error < chart.error[8, 0]


def test_an_eigenvalue_that_does_not_converge_leaves_its_cell_undecided(monkeypatch: pytest.MonkeyPatch) -> None:
    def lacking(samples: FloatArray, weights: FloatArray) -> ComplexArray:
        mu = eigenvalues(samples, weights)
        mu[3, 1] = np.nan
        return mu

    monkeypatch.setattr(floquet.engine.multipliers, "eigenvalues", lacking)
    chart = stability_chart(mathieu(1.0, 0.1), [1.3], np.linspace(0, 0.5, 12), audit=0, progress=False)
    assert chart.kind[3, 0] == Kind.UNDECIDED
    assert (np.delete(chart.kind[:, 0], 3) == Kind.STABLE).all()


def test_step_size_resonance() -> None:
    """With too few steps the fast modes are in resonance with the steps, not with the excitation, and look unstable."""
    system = MovingPlate(axial_terms=3, lateral_terms=4).at(40.0)
    Omega, eps = np.linspace(40, 75, 36), np.linspace(0, 1, 9)
    chart = stability_chart(system, Omega, eps, audit=0, progress=False)
    period = 2 * np.pi / Omega
    few = chart_batch([system] * len(Omega), Omega, eps, 1.0)
    # the trap is real: with one or two steps in a cycle of the fastest mode, log|mu| is off by 0.1 in stable cells ...
    wrong = np.abs(few.growth_rate - chart.growth_rate) * period
    assert wrong[chart.kind == Kind.STABLE].max() > 0.1
    # ... and the rule keeps out of it, by a factor that leaves the resonance far behind
    assert MIN_STEPS_PER_CYCLE >= 8
    enough = chart_batch([system] * len(Omega), Omega, eps, MIN_STEPS_PER_CYCLE)
    right = np.abs(enough.growth_rate - chart.growth_rate) * period
    assert (right <= 3 * (enough.error + chart.error) + 1e-13).all()
    assert right.max() < 1e-5
    sample = [(0, 3), (4, 17), (8, 30), (8, 5), (6, 11)]
    for i, j in sample:
        exact = monodromy(system, float(Omega[j]), float(eps[i])).growth_rate
        assert abs(chart.growth_rate[i, j] - exact) * period[j] <= 3 * chart.error[i, j] + 1e-13


def test_fast_modes_far_above_the_excitation() -> None:
    # the fast mode must be resolved although nothing happens to it: stiffness ratio 1e6
    system = PeriodicSystem(
        np.eye(2), np.zeros((2, 2)), np.zeros((2, 2)), np.diag([1.0, 1e6]), [[[1.0, 1.0], [1.0, 1e3]]]
    )
    Omega, eps = np.linspace(1.7, 2.3, 7), np.linspace(0, 0.36, 5)
    chart = stability_chart(system, Omega, eps, audit=0, progress=False)
    for j in range(len(Omega)):
        exact = monodromy(system, float(Omega[j]), float(eps[4]))
        assert abs(chart.growth_rate[4, j] - exact.growth_rate) * 2 * np.pi / Omega[j] <= 3 * chart.error[4, j] + 1e-13
    # the region of the slow mode, and no other: Omega = 2 ± eps / 2 to first order
    assert (chart.kind[4] > 0).tolist() == [False, False, True, True, True, False, False]


def test_uniform_tension_makes_every_mode_a_mathieu_equation() -> None:
    # K diagonal in the modes and F = K: mode m is x'' + omega_m^2 (1 + eps cos) x = 0, whose chart is known by itself
    n = 4
    rotation = sla.qr(np.random.default_rng(0).standard_normal((n, n)))[0]
    omega2 = np.array([1.0, 2.1, 3.7, 5.9])
    K = rotation.T @ np.diag(omega2) @ rotation
    K = (K + K.T) / 2
    together = PeriodicSystem(np.eye(n), np.zeros((n, n)), np.zeros((n, n)), K, [K])
    Omega, eps = np.linspace(1.0, 5.0, 23), np.linspace(0, 0.6, 7)
    chart = stability_chart(together, Omega, eps, audit=0, progress=False)
    single = [PeriodicSystem([[1.0]], [[0.0]], [[0.0]], [[w]], [[[w]]]) for w in omega2]
    alone = [stability_chart(system, Omega, eps, audit=0, progress=False) for system in single]
    expected = np.max([one.growth_rate for one in alone], axis=0)
    allowed = (chart.error + np.max([one.error for one in alone], axis=0)) * Omega / (2 * np.pi)
    assert (np.abs(chart.growth_rate - expected) <= 3 * allowed + 1e-13).all()
