"""Rigid-body motion: motion without stiffness that excitation, damping and transport never touch, set apart."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from compare.window import RIGID_FREQUENCY
from periodic import AnyFamily, AnySystem, PeriodicSystem
from periodic.checks import FloatArray
from periodic.system import SYMMETRY_TOLERANCE


@dataclass(frozen=True, eq=False)
class ElasticPart:
    """A family without its rigid-body motions.

    Attributes
    ----------
    family : AnyFamily
    basis : ndarray, shape (n, m)
        The motions that are left, orthogonal to the rigid ones with respect to mass.
    """

    family: AnyFamily
    basis: FloatArray

    def at(self, Omega: float) -> AnySystem:
        """Return the elastic part of the member at Omega."""
        system = self.family.at(Omega)
        assert isinstance(system, PeriodicSystem)  # of first order nothing is set apart
        return _projected(system, self.basis)


def elastic_part(family: AnyFamily, Omega: float) -> tuple[AnyFamily, int]:
    """Return a family without its rigid-body motions, and how many there are.

    A rigid-body motion has no stiffness, and neither damping, gyroscopic coupling nor excitation acts on it or through
    it. It drifts linearly whatever the rest does, which is no instability of the excitation; left in, it makes K
    singular and gives two multipliers that are 1. A family without such motions, or of first order, is returned as it
    is.

    Parameters
    ----------
    family : AnyFamily
    Omega : float
        Where the family is looked at.
    """
    system = family.at(Omega)
    if not isinstance(system, PeriodicSystem):
        return family, 0
    K = system.stiffness
    if np.abs(K - K.T).max() > SYMMETRY_TOLERANCE * np.abs(K).max():
        return family, 0
    scale = np.linalg.inv(np.linalg.cholesky(system.mass)).T  # M-orthonormal columns
    values, vectors = np.linalg.eigh(scale.T @ ((K + K.T) / 2) @ scale)
    free = np.abs(values) <= RIGID_FREQUENCY**2 * np.abs(values).max()
    given = (system.gyroscopic, system.damping, *system.cosine, *system.sine, *(term.matrix for term in system.terms))
    others = [X for X in given if X.any()]
    rigid = scale @ vectors[:, free]
    if not free.any() or free.all() or any(_touched(X, rigid) for X in others):
        return family, 0
    basis = scale @ vectors[:, ~free]
    part = _projected(system, basis) if isinstance(family, PeriodicSystem) else ElasticPart(family, basis)
    return part, int(free.sum())


def _touched(matrix: FloatArray, motions: FloatArray) -> bool:
    """Whether a matrix acts on one of the motions, or through it."""
    size = np.abs(matrix) @ np.abs(motions)
    return any(bool((np.abs(X @ motions) > SYMMETRY_TOLERANCE * size.max()).any()) for X in (matrix, matrix.T))


def _projected(system: PeriodicSystem, basis: FloatArray) -> PeriodicSystem:
    if system.terms:
        return system.restricted(basis)
    n = basis.shape[1]
    G, C, K = (basis.T @ X @ basis for X in (system.gyroscopic, system.damping, system.stiffness))
    excitation = (basis.T @ X @ basis for X in (system.cosine, system.sine))
    return PeriodicSystem(np.eye(n), G, C, K, *excitation)
