"""Monodromy matrices cell by cell: one fourth-order splitting step after the other, nothing shared between cells."""

from __future__ import annotations

import numpy as np
import scipy.linalg as sla
from numba import njit
from numpy.typing import NDArray

from periodic import PeriodicSystem
from periodic.checks import FloatArray

STEPS_PER_CYCLE = 64  # of the fastest oscillation: error of log|mu| about 1e-8 on the moving plate


@njit(cache=True, nogil=True)
def monodromy_matrix(flow: FloatArray, h: float, Fc: FloatArray, Fs: FloatArray, eps: float, steps: int) -> FloatArray:
    """Multiply ``steps`` steps, each a kick followed by the exact flow of the constant part; state (W, W')."""
    J, n = Fc.shape[0], Fc.shape[1]
    Phi = np.eye(2 * n)
    for step in range(steps):
        theta = 2.0 * np.pi * step / steps
        F = np.zeros((n, n))
        for j in range(J):
            F += eps * (np.cos((j + 1) * theta) * Fc[j] + np.sin((j + 1) * theta) * Fs[j])
        # the velocity changes by -h F W; the h^3 term (Takahashi and Imada 1984) makes the step fourth order
        Phi[n:] += np.dot(-h * F + (h**3 / 12.0) * np.dot(F, F), Phi[:n])
        Phi = np.dot(flow, Phi)
    return Phi


def direct_multipliers(
    system: PeriodicSystem, Omega: float, eps: FloatArray
) -> tuple[NDArray[np.complex128], FloatArray]:
    """Return the multipliers (k, 2n) of one column and the error of max log|mu| (k,), from N and 2 N steps."""
    n, T = system.size, 2 * np.pi / Omega
    L = np.linalg.cholesky(system.mass)

    def normalised(S: FloatArray) -> FloatArray:
        return np.linalg.solve(L, np.linalg.solve(L, S).T).T.copy()

    D, K = normalised(system.gyroscopic + system.damping), normalised(system.stiffness)
    Fc = np.array([normalised(F) for F in system.cosine])
    Fs = np.array([normalised(F) for F in system.sine])
    A = np.block([[np.zeros((n, n)), np.eye(n)], [-K, -D]])
    forcing = np.abs(eps).max() * (np.linalg.norm(Fc, 2, axis=(1, 2)) + np.linalg.norm(Fs, 2, axis=(1, 2))).sum()
    fastest = max(np.sqrt(np.abs(np.linalg.eigvals(A)).max() ** 2 + forcing), system.harmonics * Omega)
    steps = max(32, int(np.ceil(STEPS_PER_CYCLE * fastest / Omega)))
    coarse, fine = (
        np.array([np.linalg.eigvals(monodromy_matrix(sla.expm(T / N * A), T / N, Fc, Fs, e, N)) for e in eps])
        for N in (steps, 2 * steps)
    )
    difference = np.log(np.abs(fine).max(axis=1)) - np.log(np.abs(coarse).max(axis=1))
    return fine, np.abs(difference) + 1e-15 * steps
