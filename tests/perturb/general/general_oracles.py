"""Random systems with terms in every matrix, and webs of pulsating speed, for the tests of perturb.general."""

from __future__ import annotations

import numpy as np

from periodic import PeriodicSystem, Term, waveforms
from tests.perturb.perturb_oracles import random_system


def with_terms(seed: int, damping: float) -> PeriodicSystem:
    """A random damped gyroscopic system of two coordinates with terms in M, C, G and K, of eps and eps^2."""
    system, rng = random_system(seed, n=2, damping=damping), np.random.default_rng(seed + 100)

    def random(sign: int) -> np.ndarray:
        X = rng.normal(size=(2, 2))
        return np.asarray(X + sign * X.T)

    terms = [
        Term("damping", 0.2 * random(1), waveforms.cosine()),
        Term("gyroscopic", 0.5 * random(-1), waveforms.sine()),
        Term("mass", 0.5 * random(1), waveforms.cosine(1, 0.1)),
        Term("stiffness", random(1), waveforms.cosine(2), 2),
        Term("mass", random(1), waveforms.constant(), 2),
        Term("damping", 0.1 * random(1), waveforms.sine(2), 2),
    ]
    constant = (system.mass, system.gyroscopic, system.damping, system.stiffness)
    return PeriodicSystem(*constant, system.cosine, system.sine, terms=terms)


def sine_matrices(n: int) -> tuple[np.ndarray, np.ndarray]:
    """B and S of unit-normalised sines: (w_x, phi) and (w_x, phi_x)."""
    k = np.arange(1, n + 1)
    row, column = np.meshgrid(k, k, indexing="ij")
    odd = (row + column) % 2 == 1
    B = np.divide(4.0 * row * column, row**2 - column**2, out=np.zeros((n, n)), where=odd)
    return B, np.diag((k * np.pi) ** 2)


class Web:
    """A tensioned beam moving at v0 (1 + eps cos Omega t) while its tension is 1 + eps a cos Omega t."""

    def __init__(self, v0: float, rigidity: float, tension: float, n: int) -> None:
        self.v0, self.tension = v0, tension
        self.B, self.S = sine_matrices(n)
        self.K = (1 - v0**2) * self.S + rigidity * self.S @ self.S

    def at(self, Omega: float) -> PeriodicSystem:
        v, B, S = self.v0, self.B, self.S
        terms = [
            Term("gyroscopic", 2 * v * B, waveforms.cosine()),
            Term("stiffness", -2 * v**2 * S + self.tension * S, waveforms.cosine()),
            Term("stiffness", -Omega * v * B, waveforms.sine()),
            Term("stiffness", -0.5 * v**2 * S, waveforms.constant(), 2),
            Term("stiffness", -0.5 * v**2 * S, waveforms.cosine(2), 2),
        ]
        return PeriodicSystem(np.eye(len(B)), 2 * v * B, None, self.K, terms=terms)
