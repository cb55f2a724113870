"""Characteristic exponents of every mode, followed along a column from eps = 0, where it is known which is which.

Multipliers are computed cell by cell and in no order. Along eps their angles are smooth, even where two of them meet in
a region of instability much narrower than the distance between two amplitudes: what a mode does is extrapolated from
the last cells, and the angles that were found go to the modes in the order of those that were expected.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from floquet.engine import ReciprocalSums, Spectra, exponent
from periodic.checks import ComplexArray, FloatArray

# Multipliers of a conservative system this far from the unit circle, in log|mu|, have left it.
ROUNDING = 1e-6
# While two modes are unstable together both have one angle; this part of how each moved before tells them apart.
LEAN = 1e-3
# An angle that is this far from the one expected makes extrapolation begin anew.
SURPRISE = 0.3
# Modes that decay by a factor of more than exp(DEAD) in one period are not followed.
DEAD = 8.0


class Exponents(NamedTuple):
    """log mu of n modes in k cells of a subsystem, arrays (k, n).

    ``angle`` is the imaginary part, continuous along eps. ``modulus`` is the real part, or the mean of both for a mode
    whose two multipliers are real; ``split`` is half their difference, 0 elsewhere.
    """

    angle: FloatArray
    modulus: FloatArray
    split: FloatArray


@njit(cache=True, nogil=True)
def modes_symplectic(s: ComplexArray, exponents: FloatArray) -> Exponents:
    """Return the exponents of the modes of a symplectic subsystem with mu + 1/mu = 2^exponents[c] s[c, i], angles in
    [0, pi]."""
    k, n = s.shape
    angle, modulus, split = np.zeros((k, n)), np.zeros((k, n)), np.zeros((k, n))
    for c in range(k):
        for i in range(n):
            u, angle[c, i] = exponent(s[c, i], exponents[c])
            if s[c, i].imag == 0.0:
                split[c, i] = u
            else:
                modulus[c, i] = np.copysign(u, s[c, i].imag)
    return Exponents(angle, modulus, split)


def modes_of(found: Spectra) -> Exponents:
    """Return the exponents of the modes of a subsystem from all of its multipliers."""
    if isinstance(found, ReciprocalSums):
        return modes_symplectic(found.sums, found.exponents)
    return modes(found.mu, found.exponents)


@njit(cache=True, nogil=True)
def modes(mu: ComplexArray, exponents: FloatArray) -> Exponents:
    """Return the exponents of the modes of any subsystem from its multipliers 2^exponents[c] mu[c, i], mu of shape (k,
    2n), angles in [0, pi].

    Of the real multipliers of one sign the two largest are taken for those of one mode, the next two for another. Two
    that are zero, of a mode that is damped out, leave zeros.
    """
    k, n = mu.shape[0], mu.shape[1] // 2
    angle, modulus, split = np.zeros((k, n)), np.zeros((k, n)), np.zeros((k, n))
    for c in range(k):
        shift, used = exponents[c] * np.log(2.0), 0
        for sign in (1.0, -1.0):
            real = np.sort(np.array([np.log(abs(z)) for z in mu[c] if z.imag == 0.0 and z.real * sign > 0]))
            for i in range(real.size // 2):
                if used < n:
                    low, high = real[real.size - 2 - 2 * i], real[real.size - 1 - 2 * i]
                    modulus[c, used], split[c, used] = shift + (low + high) / 2, (high - low) / 2
                    angle[c, used] = 0.0 if sign > 0 else np.pi
                    used += 1
        for z in mu[c]:
            if z.imag > 0.0 and used < n:
                modulus[c, used], angle[c, used] = shift + np.log(abs(z)), np.angle(z)
                used += 1
    return Exponents(angle, modulus, split)


@njit(cache=True, nogil=True)
def _nearest(
    angle: FloatArray, modulus: FloatArray, alive: NDArray[np.intp], angles: FloatArray, moduli: FloatArray
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return the modes ``alive``, expected at ``angle`` + i ``modulus``, and what was found for each: the nearest pair
    first."""
    count, n = alive.size, angles.size
    distance = np.empty((count, n))
    for a in range(count):
        distance[a] = (angles - angle[alive[a]]) ** 2 + (moduli - modulus[alive[a]]) ** 2
    order, ranks = np.empty(count, np.intp), np.empty(count, np.intp)
    for r in range(count):
        best = int(distance.argmin())
        a, f = best // n, best % n
        order[r], ranks[r] = alive[a], f
        distance[a, :], distance[:, f] = np.inf, np.inf
    return order, ranks


@njit(cache=True, nogil=True)
def follow(found: Exponents, eps: FloatArray, start: ComplexArray, conservative: bool) -> Exponents:
    """Return ``found`` sorted into modes, whose log mu at the first amplitude, eps[0] = 0, are ``start`` (n,).

    Modes that are damped out within a period have no multipliers but rounding, and are left as they start.
    """
    k, n = found.angle.shape
    alive = np.flatnonzero(start.real > -DEAD)
    angle, modulus, split = np.zeros((k, n)), np.zeros((k, n)), np.zeros((k, n))
    angle[:], modulus[:] = start.imag, start.real
    expected, rate, free = start.imag.copy(), np.zeros(n), np.full(n, 3)
    for c in range(k):
        for i in alive:
            if c > 2 and free[i] > 2:
                x, x0, x1, x2 = eps[c], eps[c - 3], eps[c - 2], eps[c - 1]
                expected[i] = angle[c - 3, i] * ((x - x1) * (x - x2) / ((x0 - x1) * (x0 - x2)))
                expected[i] += angle[c - 2, i] * ((x - x0) * (x - x2) / ((x1 - x0) * (x1 - x2)))
                expected[i] += angle[c - 1, i] * ((x - x0) * (x - x1) / ((x2 - x0) * (x2 - x1)))
                rate[i] = expected[i] - angle[c - 1, i]
            elif c == 2:  # shifts begin with eps^2
                expected[i] = angle[0, i] + (angle[1, i] - angle[0, i]) * (eps[2] / eps[1]) ** 2
            elif c > 0:  # not far from where it was, to the side to which it moved when it was free
                expected[i] = angle[c - 1, i] + LEAN * rate[i]
        folded = np.abs((expected + np.pi) % (2 * np.pi) - np.pi)
        if conservative:
            order, ranks = alive[np.argsort(folded[alive])], np.argsort(found.angle[c])
        else:
            order, ranks = _nearest(folded, modulus[max(c - 1, 0)], alive, found.angle[c], found.modulus[c])
        for r in range(alive.size):
            i, f = order[r], ranks[r]
            theta = found.angle[c, f]
            turns = 2 * np.pi * np.round(expected[i] / (2 * np.pi))
            best = turns + theta
            for other in (turns - theta, turns + theta - 2 * np.pi, turns - theta + 2 * np.pi):
                if abs(other - expected[i]) < abs(best - expected[i]):
                    best = other
            angle[c, i], modulus[c, i], split[c, i] = best, found.modulus[c, f], found.split[c, f]
            locked = split[c, i] > 0.0 or (conservative and abs(modulus[c, i]) > ROUNDING)
            free[i] = 0 if locked or abs(best - expected[i]) > SURPRISE else free[i] + 1
    return Exponents(angle, modulus, split)


def distance(found: Exponents, p: int, q: int, j: int, sign: int) -> FloatArray:
    """Return by how much the angles of two modes miss the resonance j Omega = omega_p ± omega_q, (...), with a sign:
    falling through zero where Omega goes through the resonance."""
    return np.asarray(found.angle[..., p] + sign * found.angle[..., q] - 2 * np.pi * j)


def test_function(found: Exponents, p: int, q: int, j: int, sign: int, conservative: bool) -> FloatArray:
    """Return f (...) of the resonance j Omega = omega_p ± omega_q, positive where the two are unstable; the arrays of
    ``found`` are (..., n).

    ``p`` and ``q`` are numbers of modes from 0, ``found`` is that of `follow`, and ``sign`` is 1 or -1. f is that of
    `floquet.boundary.pair.instability`, from logarithms: analytic where the two coalesce. NaN where one of the modes is
    unstable with another one.
    """
    modulus, split = found.modulus, found.split
    apart = distance(found, p, q, j, sign)
    total = modulus[..., p] + modulus[..., q]
    elsewhere = np.abs(apart) > np.pi  # two that are unstable by another resonance
    if p == q:
        elsewhere &= split[..., p] > 0
        f = split[..., p] ** 2 - apart**2 / 4 - total**2 / 4
        return np.where(elsewhere | (conservative & (np.abs(total) > ROUNDING)), np.nan, f)
    difference = modulus[..., p] - modulus[..., q]
    if conservative:
        together = np.abs(difference) > ROUNDING
        f = np.where(together, difference**2, -(apart**2)) / 4
        elsewhere = (elsewhere & together) | (np.abs(total) > ROUNDING)
    else:
        with np.errstate(divide="ignore", invalid="ignore"):
            skew = difference * apart / 2 / total
        f = (difference**2 - apart**2) / 4 + skew**2 - total**2 / 4
        elsewhere &= f > 0
    return np.where(elsewhere | (split[..., p] > 0) | (split[..., q] > 0), np.nan, f)


@njit(cache=True, nogil=True)
def leading(found: Exponents) -> tuple[FloatArray, FloatArray]:
    """Return f of the most unstable pair in every cell, (k,), and its mark, (k,): marks of one region differ little
    between neighbouring cells, those of two regions in general by more.

    f is that of `test_function` if all modes decay alike: m (m + 2 delta) for the growth m and the mean decay delta,
    which the pair keeps. The mark is the angle, set apart where the multipliers are real.
    """
    angle, modulus, split = found
    f, mark = np.zeros(len(angle)), np.zeros(len(angle))
    for c in range(len(angle)):
        first = int((modulus[c] + split[c]).argmax())
        growth = modulus[c, first] + split[c, first]
        f[c] = growth * (growth - 2 * modulus[c].mean())
        mark[c] = 2 * np.pi + 2 * angle[c, first] if split[c, first] > 0.0 else angle[c, first]
    return f, mark


@njit(cache=True, nogil=True)
def edge(found: Exponents, eps: FloatArray, outside: int, inside: int, further: int, conservative: bool) -> float:
    """Return where between two neighbouring amplitudes, ``outside`` and ``inside`` a region, its edge is.

    At a zero of the parabola through the test function f of the most unstable pair at both and at ``further`` inside,
    of the straight line if ``further`` is ``inside``; halfway if f does not change its sign.
    """
    angle, modulus, split = found
    top = int((modulus[inside] + split[inside]).argmax())
    single = split[inside, top] > 0.0
    values = np.zeros(3)
    at = angle[inside, top]
    for r in range(3):
        c = (inside, further, outside)[r]
        first = int((modulus[c] + split[c]).argmax()) if r < 2 else int(np.abs(angle[c] - at).argmin())
        if single:
            total, apart = 2 * modulus[c, first], 2 * (angle[c, first] - at)
            values[r] = split[c, first] ** 2 - apart**2 / 4 - total**2 / 4
        else:
            distance = np.abs(angle[c] - (angle[c, first] if r < 2 else at))
            distance[first] = np.inf
            second = int(distance.argmin())
            total, apart = modulus[c, first] + modulus[c, second], angle[c, first] - angle[c, second]
            difference = modulus[c, first] - modulus[c, second]
            values[r] = (difference**2 - apart**2 - total**2) / 4
            if not conservative and total != 0.0:
                values[r] += (difference * apart / 2 / total) ** 2
            if r == 0:
                at = (angle[c, first] + angle[c, second]) / 2
    b, a = eps[inside], eps[outside]
    if not (values[0] > 0.0 and values[2] < 0.0):
        met = conservative and 0.0 <= values[2] < ROUNDING  # at ``outside`` itself, but for rounding
        return a if met else (a + b) / 2
    # inwards from outside: f = values[2] + slope x + bend x (x - 1), x = 1 at ``inside``
    slope, bend = values[0] - values[2], 0.0
    if further != inside:
        x = (eps[further] - a) / (b - a)
        bend = (values[1] - values[2] - slope * x) / (x * (x - 1))
    low, high = 0.0, 1.0
    for _ in range(40):
        x = (low + high) / 2
        if values[2] + slope * x + bend * x * (x - 1) > 0.0:
            high = x
        else:
            low = x
    return a + (low + high) / 2 * (b - a)
