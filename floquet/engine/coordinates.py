"""From a `PeriodicSystem` to first-order equations, in coordinates in which the free motion is nearly a rotation."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np
import scipy.linalg as sla

from floquet.engine.decoupling import invariant_subspaces
from periodic import PeriodicSystem, stiffness_alone
from periodic.checks import FloatArray

# Asymmetry of a matrix, and damping of a subsystem, that counts as rounding from assembling the matrices: as a part of
# the largest entry. What is left of a rigid motion by a matrix, as a part of the sums that cancel.
STRUCTURE_ROUNDING = 1e-13

# Cycles of the excitation in one of the least frequency, which serves as a scale where there is little stiffness.
CYCLES_PER_LEAST_CYCLE = 50


@dataclass(frozen=True, eq=False)
class Subsystem:
    """An independent subsystem in modal coordinates r: r'' + (G + C) r' + (K + eps F(t)) r = 0.

    Attributes
    ----------
    basis : ndarray, shape (n, b)
        W = basis r. The basis is orthonormal with respect to the mass, and the symmetric part of ``K`` is diagonal.
    G, C, K : ndarray, shape (b, b)
    Fc, Fs : ndarray, shape (J, b, b)
    rate : float
        Largest modulus of an eigenvalue of the free motion.
    modulation : float
        Bound on the norm of F(t).
    symplectic : bool
        Without damping and with symmetric stiffness: the subsystem is a Hamiltonian system.
    reversible : bool
        Without terms in r' and with excitation even in time: with mu also 1/mu is a multiplier.
    """

    basis: FloatArray
    G: FloatArray
    C: FloatArray
    K: FloatArray
    Fc: FloatArray
    Fs: FloatArray
    rate: float
    modulation: float
    symplectic: bool
    reversible: bool

    @property
    def states(self) -> int:
        """Number of states."""
        return 2 * len(self.K)

    def fastest(self, Omega: float, largest: float) -> float:
        """Return the rate of the fastest motion: of the system at its stiffest, or of the excitation."""
        return max(math.sqrt(self.rate**2 + largest * self.modulation), len(self.Fc) * Omega)

    @property
    def reciprocal(self) -> bool:
        """Whether with mu also 1 / conj(mu) is a multiplier."""
        return self.symplectic or self.reversible


class Equations(NamedTuple):
    """y' = A y - eps [[0, 0], [diag(left) F(t) diag(right), 0]] y, with ``A`` (2b, 2b), ``left`` and ``right`` (b,).

    ``strength[j - 1]`` bounds the rate at which harmonic j makes |y| grow when eps = 1.
    """

    A: FloatArray
    left: FloatArray
    right: FloatArray
    strength: tuple[float, ...]


@lru_cache(maxsize=8)  # most families have one system for all frequencies
def subsystems(system: PeriodicSystem) -> tuple[Subsystem, ...]:
    """Return the independent subsystems of ``system`` without its rigid motions; none if there is nothing else."""
    stiffness_alone(system)
    inverse = sla.solve_triangular(np.linalg.cholesky(system.mass), np.eye(system.size), lower=True)
    constant = np.array([system.gyroscopic, system.damping, system.stiffness])
    matrices = np.concatenate([constant, system.cosine, system.sine])
    bases = invariant_subspaces(inverse @ matrices @ inverse.T)
    return tuple(_subsystem(system, matrices, inverse.T @ X) for X in bases if not is_rigid(matrices, inverse.T @ X))


def rigid_motions(system: PeriodicSystem) -> int:
    """Return the number of rigid motions of ``system``: nothing restores, damps, turns or excites them.

    Such a motion drifts linearly: its multiplier 1 is double, with one eigenvector. It acts on no other motion, so that
    the others can be judged without it.
    """
    return system.size - sum(len(subsystem.K) for subsystem in subsystems(system))


def is_rigid(matrices: FloatArray, V: FloatArray) -> bool:
    """Return whether none of ``matrices`` (p, n, n) acts on an independent motion ``V`` (n, 1), but for rounding.

    Rounding is measured against the sums that cancel, not against the largest entry: a soft spring beside a stiff one
    is a spring.
    """
    if V.shape[1] > 1:
        return False
    acting, cancelled = np.abs(V.T @ matrices @ V), np.abs(V).T @ np.abs(matrices) @ np.abs(V)
    return bool((acting <= STRUCTURE_ROUNDING * cancelled).all())


def _subsystem(system: PeriodicSystem, matrices: FloatArray, V: FloatArray) -> Subsystem:
    K = V.T @ system.stiffness @ V
    V = V @ sla.eigh(K + K.T)[1]
    # once more, now that V is nearly orthonormal: the first time an ill-conditioned mass matrix costs digits
    V = V @ sla.solve_triangular(np.linalg.cholesky(V.T @ system.mass @ V), np.eye(V.shape[1]), lower=True).T
    G, C, K, *F = V.T @ matrices @ V
    G, C = (G - G.T) / 2, (C + C.T) / 2
    symmetric = all(np.abs(S - S.T).max() <= STRUCTURE_ROUNDING * np.abs(S).max() for S in matrices[2:])
    if symmetric:
        K, F = (K + K.T) / 2, [(S + S.T) / 2 for S in F]
    Fc, Fs = np.array(F[: system.harmonics]), np.array(F[system.harmonics :])
    damped = np.abs(C).max() > STRUCTURE_ROUNDING * np.linalg.norm(system.damping, 2)
    free = np.block([[np.zeros_like(K), np.eye(len(K))], [-K, -G - C]])
    return Subsystem(
        V,
        G,
        C,
        K,
        Fc,
        Fs,
        rate=float(np.abs(np.linalg.eigvals(free)).max()),
        modulation=float(np.linalg.norm(F, axis=(1, 2)).sum()),
        symplectic=symmetric and not damped,
        reversible=not damped and not G.any() and not Fs.any(),
    )


def least_frequency(Omega: float) -> float:
    """Return the power of two that serves as the least frequency of a coordinate in columns near ``Omega``."""
    return 2.0 ** math.floor(math.log2(Omega / CYCLES_PER_LEAST_CYCLE))


@lru_cache(maxsize=64)
def equations(subsystem: Subsystem, least: float) -> Equations:
    """Return the first-order equations of ``subsystem``.

    The frequencies w are the square roots of the moduli of the stiffnesses, but at least ``least``. In the energy
    coordinates y = (w r, r') the free conservative motion is a rotation, and damping only shrinks |y|. A symplectic
    subsystem has the canonical coordinates y = (w^1/2 r, w^-1/2 (r' + G r / 2)), which differ by the scaling and the
    gyroscopic term.
    """
    b = len(subsystem.K)
    w = np.maximum(np.sqrt(np.abs(np.diag(subsystem.K))), least)
    sqrt_w = np.sqrt(w)
    scaled = np.concatenate([subsystem.Fc, subsystem.Fs]) / np.outer(sqrt_w, sqrt_w)
    cosine, sine = np.linalg.norm(scaled, 2, axis=(1, 2)).reshape(2, -1)
    strength = tuple((np.hypot(cosine, sine) / 2).tolist())
    if not subsystem.symplectic:
        A = np.block([[np.zeros((b, b)), np.diag(w)], [-subsystem.K / w, -subsystem.G - subsystem.C]])
        return Equations(A, np.ones(b), 1 / w, strength)
    half = subsystem.G / 2
    stiffness = subsystem.K - half @ half
    A = np.block(
        [
            [-sqrt_w[:, None] * half / sqrt_w, np.diag(w)],
            [-stiffness / np.outer(sqrt_w, sqrt_w), -half / sqrt_w[:, None] * sqrt_w],
        ]
    )
    return Equations(A, 1 / sqrt_w, 1 / sqrt_w, strength)
