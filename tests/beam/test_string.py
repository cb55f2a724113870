"""The string with pulsating speed against its exact solution by characteristics, and what truncation does to it."""

from __future__ import annotations

import numpy as np
import pytest

from beam import MovingBeam
from tests.beam.beam_oracles import ExactString, carried, free_modes, fundamental


def test_motion_is_the_exact_one() -> None:
    v0, Omega, eps, time = 0.4, 2.0, 0.5, 3.0  # three to four reflections at each end
    exact = ExactString(v0, Omega, eps)
    x = np.linspace(0.05, 0.95, 19)
    w = np.array([exact.w(place, time) for place in x])
    errors = []
    for n in (8, 16, 32):
        start = np.zeros((2 * n, 1))
        start[n] = 1 / np.sqrt(2)  # w = sin pi x at rest
        system = MovingBeam(v0, 0.0, terms=n).at(Omega)
        W = carried(system, Omega, eps, time, start)[n:, 0]
        errors.append(np.abs(np.sqrt(2) * np.sin(np.pi * np.outer(x, np.arange(1, n + 1))) @ W - w).max())
    assert errors[2] < 1e-3  # without v' B, or with half of it: 0.08
    assert errors[0] > 10 * errors[1] > 50 * errors[2]


@pytest.mark.parametrize(("p", "q"), [(1, 1), (1, 2), (2, 2), (1, 3)])
def test_first_order_slopes(p: int, q: int) -> None:
    # isolated pair, theory-general.md: v0 |sin((p + q) pi (1 - v0) / 2)| 2 sqrt(p q) / (p + q)
    v0 = 0.3
    beam = MovingBeam(v0, 0.0, terms=24)
    omega, w = free_modes(beam.at(0.0))
    system = beam.at(omega[p - 1] + omega[q - 1])  # v' counts at the frequency of the resonance
    (velocity,) = (term.matrix for term in system.terms if term.of == "gyroscopic")
    # the amplitude of e^{i Omega t} as it acts on conj(w_q) e^{-i omega_q t}
    E = system.cosine[0] - 1j * system.sine[0] - 1j * omega[q - 1] * velocity
    slope = np.sqrt(omega[p - 1] * omega[q - 1]) * abs(w[:, p - 1].conj() @ E @ w[:, q - 1].conj()) / 2
    expected = v0 * abs(np.sin((p + q) * np.pi * (1 - v0) / 2)) * 2 * np.sqrt(p * q) / (p + q)
    assert slope == pytest.approx(expected, rel=3e-4)


def test_the_continuum_is_unstable_where_no_truncation_is() -> None:
    # Omega = w_1 = w_2 - w_1 = ...: energy climbs the ladder of all modes, at 2 eps v0 |sin(pi (1 - v0) / 2)|
    v0, eps = 0.3, 0.05
    Omega = np.pi * (1 - v0**2)
    period = 2 * np.pi / Omega
    exact = ExactString(v0, Omega, eps)
    energies = [exact.energy(periods * period, places=200) for periods in (23, 46)]
    rate = np.log(energies[1] / energies[0]) / (23 * period)
    assert rate == pytest.approx(2 * eps * v0 * abs(np.sin(np.pi * (1 - v0) / 2)), rel=0.05)
    for n in (2, 4, 6):
        Phi = fundamental(MovingBeam(v0, 0.0, terms=n).at(Omega), Omega, eps, period)
        assert np.abs(np.linalg.eigvals(Phi)).max() < 1 + 1e-9
