"""One step of the chart integrator for any linear periodic system."""

from __future__ import annotations

import numpy as np
from numba import njit

from floquet.engine.doubling import doublings, exponential

GAUSS_OFFSET = np.sqrt(3.0) / 6.0  # of the two Gauss points from the middle of a step, in units of its length


@njit(cache=True, nogil=True)
def general_steps(A, powers, harmonics, cosine, sine, h, Omega, theta, eps, P):  # type: ignore[no-untyped-def]
    """Write steps of length ``h`` at the phases ``theta`` and amplitudes ``eps`` (s,) into P (s, N, N).

    V(t) is the Fourier sum of `floquet.engine.general.subsystems.Harmonics`. The step is

        exp(h A) exp(h V + (h^3 / 24) [V, [A, V] - V']),        [X, Y] = X Y - Y X,   V' = dV/dt.

    [A, V] - V' is the commutator of V with the generator A + d/dt of the free motion with running time. A
    transformation with the period of the excitation makes a step of fourth order of it, as in
    `floquet.engine.doubling.step`, whose step is the same for periodic stiffness alone: there [V, V'] vanishes.
    """
    N, R = A.shape[0], powers.size
    E = exponential(h * A)
    V, slope = np.empty((N, N)), np.empty((N, N))
    for i in range(theta.size):
        V[:] = 0.0
        slope[:] = 0.0
        for r in range(R):
            factor, turn = eps[i] ** powers[r], harmonics[r] * theta[i]
            c, s, rate = factor * np.cos(turn), factor * np.sin(turn), harmonics[r] * Omega
            V += c * cosine[r] + s * sine[r]
            slope += rate * (c * sine[r] - s * cosine[r])
        W = np.dot(A, V) - np.dot(V, A) - slope
        P[i] = np.dot(E, exponential(h * V + (h**3 / 24.0) * (np.dot(V, W) - np.dot(W, V))))


@njit(cache=True, nogil=True)
def general_samples(A, powers, harmonics, cosine, sine, h, Omega, largest, plan, scale, work):  # type: ignore[no-untyped-def]
    """Return what `doublings` makes of `general_steps`, in one call."""
    N, s = A.shape[0], plan.theta.size
    P = work[0][: s * N * N].reshape(s, N, N)
    general_steps(A, powers, harmonics, cosine, sine, h, Omega, plan.theta, largest * plan.eps, P)
    return doublings(N, plan, scale, work)


@njit(cache=True, nogil=True)
def stretch(A, X, Y, factors, values, h, mass, constant, P):  # type: ignore[no-untyped-def]
    """Multiply P (N, N) from the left by the motion over one part of a period between jumps.

    Parameters
    ----------
    A : ndarray, shape (N, N)
    X, Y : ndarray, shape (R, N, N)
        Parts of A and of E.
    factors : ndarray, shape (R,)
        eps^power of each.
    values : ndarray, shape (R, steps, 2)
        The waveforms at the two Gauss points of each step.
    h : float
        Length of a step.
    mass, constant : bool
        Whether E depends on time; whether nothing does in this part, so that one exponential is exact.

    Notes
    -----
    The step is that of Magnus of fourth order, exp(h (A1 + A2) / 2 - sqrt(3) h^2 / 12 [A1, A2]) (S. Blanes, F. Casas,
    J. A. Oteo and J. Ros, Physics Reports 470 (2009) 151-238, section 5.1).
    """
    N, R = A.shape[0], factors.size
    steps = values.shape[1]
    both = np.empty((2, N, N))
    E = np.empty((N, N))
    for step in range(1 if constant else steps):
        for k in range(2):
            both[k] = A
            E[:] = 0.0
            for i in range(N):
                E[i, i] = 1.0
            for r in range(R):
                both[k] += factors[r] * values[r, step, k] * X[r]
                if mass:
                    E += factors[r] * values[r, step, k] * Y[r]
            if mass:
                both[k] = np.linalg.solve(E, both[k])
        if constant:
            return np.dot(exponential(h * steps * both[0]), P)
        turned = np.dot(both[0], both[1]) - np.dot(both[1], both[0])
        P = np.dot(exponential(0.5 * h * (both[0] + both[1]) - (np.sqrt(3.0) / 12.0 * h * h) * turned), P)
    return P
