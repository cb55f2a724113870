"""One step of the chart integrator for any linear periodic system."""

from __future__ import annotations

import numpy as np
from numba import njit

from floquet.engine.doubling import RESCALING_NORM, cancellation, doublings, multiply
from floquet.engine.general.exponential import WORK_MATRICES, exponential_into

GAUSS_OFFSET = np.sqrt(3.0) / 6.0  # of the two Gauss points from the middle of a step, in units of its length
MAX_UNSCALED_POWER = np.log2(RESCALING_NORM)  # of two, by which a product need not be scaled
STEPS_TOGETHER = 32  # of which the matrices are put together by one product


@njit(cache=True, nogil=True)
def general_steps(A, powers, harmonics, cosine, sine, h, Omega, theta, eps, P):  # type: ignore[no-untyped-def]
    """Write steps of length ``h`` at the phases ``theta`` and amplitudes ``eps`` (s,) into P (s, N, N).

    V(t) is the Fourier sum of `floquet.engine.general.subsystems.Harmonics`. The step is

        exp(h A) exp(h V + (h^3 / 24) [V, [A, V] - V']),        [X, Y] = X Y - Y X,   V' = dV/dt.

    [A, V] - V' is the commutator of V with the generator A + d/dt of the free motion with running time. A
    transformation with the period of the excitation makes a step of fourth order of it, as in
    `floquet.engine.doubling.step`, whose step is the same for periodic stiffness alone: there [V, V'] vanishes.
    """
    N, R, s = A.shape[0], powers.size, theta.size
    # V and [A, V] - V' are combinations of these matrices
    parts, moved = np.empty((2 * R, N, N)), np.empty((2 * R, N, N))
    for r in range(R):
        parts[r], parts[R + r] = cosine[r], sine[r]
    for r in range(2 * R):
        moved[r] = np.dot(A, parts[r]) - np.dot(parts[r], A)
    flat, flat_moved = parts.reshape(2 * R, N * N), moved.reshape(2 * R, N * N)
    work = np.empty((WORK_MATRICES + 2, N, N))
    free, excited = WORK_MATRICES, WORK_MATRICES + 1  # places of the two factors of a step
    work[0] = h * A
    exponential_into(work, work, free)
    amounts, rates = np.empty((STEPS_TOGETHER, 2 * R)), np.empty((STEPS_TOGETHER, 2 * R))
    both = np.empty((2 * STEPS_TOGETHER, N, N))
    first, second = both[:STEPS_TOGETHER].reshape(-1, N * N), both[STEPS_TOGETHER:].reshape(-1, N * N)
    for start in range(0, s, STEPS_TOGETHER):
        count = min(STEPS_TOGETHER, s - start)
        for i in range(count):
            for r in range(R):
                factor, turn = eps[start + i] ** powers[r], harmonics[r] * theta[start + i]
                on_cosine, on_sine, rate = factor * np.cos(turn), factor * np.sin(turn), harmonics[r] * Omega
                amounts[i, r], amounts[i, R + r] = on_cosine, on_sine
                rates[i, r], rates[i, R + r] = -rate * on_sine, rate * on_cosine
        np.dot(amounts[:count], flat, first[:count])
        second[:count] = np.dot(amounts[:count], flat_moved) - np.dot(rates[:count], flat)
        for i in range(count):
            V, W = i, STEPS_TOGETHER + i
            multiply(both, W, V, work, 0)
            multiply(both, V, W, work, 1)
            work[0] = h * both[V] + h**3 / 24.0 * (work[0] - work[1])
            exponential_into(work, work, excited)
            multiply(work, excited, free, P, start + i)


@njit(cache=True, nogil=True)
def general_samples(A, powers, harmonics, cosine, sine, h, Omega, largest, plan, scale, work):  # type: ignore[no-untyped-def]
    """Return what `doublings` makes of `general_steps`, in one call."""
    N, s = A.shape[0], plan.theta.size
    P = work[0][: s * N * N].reshape(s, N, N)
    general_steps(A, powers, harmonics, cosine, sine, h, Omega, plan.theta, largest * plan.eps, P)
    return doublings(N, plan, scale, work)


@njit(cache=True, nogil=True)
def period_products(A, X, Y, factors, values, ends, lengths, mass, constant, jumps, jump_of):  # type: ignore[no-untyped-def]
    """Return the monodromy matrices at k amplitudes, from jump to jump, by stretches between which nothing jumps.

    Parameters
    ----------
    A : ndarray, shape (N, N)
    X, Y : ndarray, shape (R, N, N)
        Parts of A and of E.
    factors : ndarray, shape (k, R)
        eps^power of each.
    values : ndarray, shape (steps, 2, R)
        The waveforms at the two Gauss points of each step.
    ends : int ndarray, shape (stretches,)
        Number of steps up to the end of each stretch.
    lengths : ndarray, shape (stretches,)
        Length of the steps of each.
    mass, constant : bool
        Whether E depends on time; whether nothing does within the stretches, so that exponentials are exact.
    jumps : ndarray, shape (k, jumps, N, N)
    jump_of : int ndarray, shape (stretches,)
        Which jump follows each stretch; -1 for none.

    Returns
    -------
    products : ndarray, shape (k, N, N)
    exponents : ndarray, shape (k,)
        The products are to be multiplied by 2^exponents.
    losses : ndarray, shape (k,)
        Factors by which cancellation has magnified rounding errors.

    Notes
    -----
    The step is that of Magnus of fourth order, exp(h (A1 + A2) / 2 - sqrt(3) h^2 / 12 [A1, A2]) (S. Blanes, F. Casas,
    J. A. Oteo and J. Ros, Physics Reports 470 (2009) 151-238, section 5.1).
    """
    k, N, R, stretches = factors.shape[0], A.shape[0], factors.shape[1], ends.size
    products, exponents, losses = np.empty((k, N, N)), np.zeros(k), np.ones(k)
    both, work, grown = np.empty((2, N, N)), np.empty((WORK_MATRICES + 1, N, N)), WORK_MATRICES
    for a in range(k):
        product = np.eye(N)
        part, before = np.eye(N), 0
        for i in range(stretches):
            first = 0 if i == 0 else ends[i - 1]
            again = constant and i > 0 and lengths[i] == lengths[i - 1] and ends[i] - first == ends[i - 1] - before
            for r in range(R):
                again = again and values[first, 0, r] == values[before, 0, r]
            before = first
            if not again:
                part = np.eye(N)
                for step in range(first, first + 1 if constant else ends[i]):
                    for q in range(1 if constant else 2):
                        coefficients(A, X, Y, factors[a], values[step, q], mass, both[q])
                    if constant:
                        work[0] = lengths[i] * (ends[i] - first) * both[0]
                        exponential_into(work, work, grown)
                        part[:] = work[grown]
                    else:
                        h = lengths[i]
                        multiply(both, 1, 0, work, 0)
                        multiply(both, 0, 1, work, 1)
                        turned = work[0] - work[1]
                        work[0] = 0.5 * h * (both[0] + both[1]) - (np.sqrt(3.0) / 12.0 * h * h) * turned
                        exponential_into(work, work, grown)
                        part = np.dot(work[grown], part)
            last = part
            if jump_of[i] >= 0:
                last = np.dot(jumps[a, jump_of[i]], part)
            following = np.dot(last, product)
            losses[a] = max(losses[a], cancellation(last, product, following))
            product = following
            size = np.abs(product).max()
            if size > 0.0:
                shift = np.floor(np.log2(size))
                product = product * 2.0**-shift
                exponents[a] += shift
        if abs(exponents[a]) <= MAX_UNSCALED_POWER:
            product = product * 2.0 ** exponents[a]
            exponents[a] = 0.0
        products[a] = product
    return products, exponents, losses


@njit(cache=True, nogil=True)
def coefficients(A, X, Y, factors, values, mass, out):  # type: ignore[no-untyped-def]
    """Write E^-1 A with all their parts into ``out`` (N, N)."""
    N = A.shape[0]
    out[:] = A
    for r in range(factors.size):
        weight = factors[r] * values[r]
        for i in range(N):
            for j in range(N):
                out[i, j] += weight * X[r, i, j]
    if mass:
        E = np.eye(N)
        for r in range(factors.size):
            E += factors[r] * values[r] * Y[r]
        out[:] = np.linalg.solve(E, out)
