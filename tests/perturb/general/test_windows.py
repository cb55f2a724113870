"""Windows in which excitation stabilises, against published ends and multipliers."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import brentq

from floquet import monodromy
from periodic import PeriodicSystem
from perturb.general import second_order_growth, stable_windows
from tests.general_systems import Reference, references_general
from tests.perturb.perturb_oracles import fitted_order

STABILISATION = {
    (entry["system"], entry["eps"]): entry["value"]
    for entry in references_general()["entries"]
    if entry["quantity"] == "stabilisation_Omega"
}


@pytest.mark.parametrize("name", ["kapitza_c0.0", "kapitza_c0.1"])
def test_a_shaken_pivot_holds_up_a_pendulum(name: str) -> None:
    """The relative gap to the exact end is of second order."""
    gaps, amplitudes = [], (0.05, 0.1)
    for eps in amplitudes:
        (window,) = stable_windows(Reference(name, eps), (1.3 / eps, 1.5 / eps), eps)
        assert window.upper == np.inf
        gaps.append(abs(window.lower / STABILISATION[name, eps] - 1))
    assert gaps[1] < 0.01
    assert fitted_order(np.array(amplitudes), np.array(gaps)) == pytest.approx(2, abs=0.1)


def self_excited() -> PeriodicSystem:
    """Two masses on a chain; the flow feeds the first, a damper sits between them, the first spring pulsates."""
    M, C, K = np.diag([1.0, 0.5]), [[0.0, -0.06], [-0.06, 0.06]], [[1.6, -0.6], [-0.6, 0.6]]
    return PeriodicSystem(M, damping=C, stiffness=K, cosine=[[1.0, 0.0], [0.0, 0.0]])


def test_an_anti_resonance_stabilises_around_the_difference_of_frequencies() -> None:
    system, eps = self_excited(), 0.2
    assert monodromy(system, 0.78, 0.0).growth_rate > 1e-3
    (window,) = stable_windows(system, (0.7, 0.9), eps)
    M, K = system.mass, system.stiffness
    omega = np.sqrt(np.sort(np.linalg.eigvals(np.linalg.solve(M, K)).real))
    assert window.lower < omega[1] - omega[0] < window.upper
    for end in window:
        exact = brentq(lambda Omega: monodromy(system, Omega, eps).growth_rate, end - 0.01, end + 0.01, xtol=1e-9)
        assert end == pytest.approx(exact, abs=0.02 * (window.upper - window.lower))


def test_the_growth_rate_has_an_error_of_third_order() -> None:
    system, Omega = self_excited(), 0.9
    amplitudes = np.array([0.05, 0.1, 0.2])
    gaps = [
        abs(second_order_growth(system, Omega, eps) - monodromy(system, Omega, eps).growth_rate) for eps in amplitudes
    ]
    assert fitted_order(amplitudes, np.array(gaps)) > 2.85


def test_a_stable_system_has_no_such_windows() -> None:
    system = PeriodicSystem([[1.0]], damping=[[0.1]], stiffness=[[1.0]], cosine=[[1.0]])
    with pytest.raises(ValueError, match=r"^family is stable without excitation"):
        stable_windows(system, (1.0, 3.0), 0.1)
