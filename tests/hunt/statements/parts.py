"""Parts of a system that nothing couples, found anew and as fine as can be."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy.linalg as sla
from numpy.typing import NDArray
from scipy.sparse.csgraph import connected_components

from periodic import PeriodicSystem

Array = NDArray[np.float64]

# Couplings below this part of the largest entry of a matrix are rounding.
ROUNDING_OF_COUPLINGS = 1e-12
# Two frequencies that agree to this part are the same.
SAME_FREQUENCY = 1e-6
# Motion slower than this part of the fastest does not oscillate.
SLOWEST_OSCILLATION = 1e-6


class Part(NamedTuple):
    """An invariant part with mass 1: velocity ``D`` (G + C), stiffness ``K``, excitation ``F`` (2 J, m, m), cosines
    first; ``G`` alone."""

    G: Array
    C: Array
    K: Array
    F: Array

    def damped(self, factor: float) -> Part:
        """Return the part with ``factor`` times its damping."""
        return self._replace(C=factor * self.C)

    @property
    def exponents(self) -> NDArray[np.complex128]:
        """Exponents without excitation of the motions that oscillate, imaginary parts positive and increasing."""
        m = len(self.K)
        free = np.block([[np.zeros((m, m)), np.eye(m)], [-self.K, -self.G - self.C]])
        values = np.linalg.eigvals(free)
        values = values[values.imag > SLOWEST_OSCILLATION * np.abs(values).max()]
        return values[np.argsort(values.imag)]

    def holds(self, *frequencies: float) -> bool:
        """Whether the part has different modes of all these frequencies."""
        mine = self.exponents.imag
        alike = [frozenset(np.flatnonzero(np.abs(mine - one) <= SAME_FREQUENCY * one).tolist()) for one in frequencies]
        return all(len(one) >= alike.count(one) for one in alike) and all(alike)


def frequencies(parts: list[Part]) -> Array:
    """Return the frequencies of all parts without excitation, increasing."""
    return np.sort(np.concatenate([part.exponents.imag for part in parts])) if parts else np.zeros(0)


def parts_of(system: PeriodicSystem) -> list[Part]:
    """Return the parts of a system, rigid motions left out.

    Eigenvectors of a random symmetric combination of all matrices span every part; copies of one part may stay
    together.
    """
    scale = sla.inv(np.linalg.cholesky(system.mass))
    constant = [scale @ X @ scale.T for X in (system.gyroscopic, system.damping, system.stiffness)]
    excitation = [scale @ X @ scale.T for X in (*system.cosine, *system.sine)]
    matrices = [X / np.abs(X).max() for X in (*constant, *excitation) if X.any()]
    n = system.size
    if not matrices:
        return []
    random = np.random.default_rng(1)
    mix = sum(random.uniform(1, 2) * (X + X.T) + random.uniform(1, 2) * (X @ X.T + X.T @ X) for X in matrices)
    Q = np.linalg.eigh(mix)[1]
    turned = np.array([Q.T @ X @ Q for X in matrices])
    coupled = (np.abs(turned) > ROUNDING_OF_COUPLINGS).any(axis=0)
    label = connected_components(coupled, directed=False)[1]
    found = []
    for number in range(label.max() + 1):
        inside = label == number
        if not coupled[np.ix_(inside, inside)].any():
            continue  # rigid
        basis = Q[:, inside]
        G, C, K = (basis.T @ X @ basis for X in constant)
        found.append(Part(G, C, K, np.array([basis.T @ X @ basis for X in excitation]).reshape(-1, *K.shape)))
    assert sum(len(part.K) for part in found) <= n
    return found
