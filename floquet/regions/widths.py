"""Where narrow regions of instability are to be looked for: the width of each resonance to the lowest orders in eps.

With y = e^{lambda t} sum_h a_h e^{i h Omega t} in coordinates that make the free motion diagonal, y' = Lambda y + eps
sum_k G_k e^{i k Omega t} y says

    (lambda + i h Omega - Lambda) a_h = eps sum_k G_k a_{h-k}.

At j Omega = omega_p ± omega_q the states (mode p, h = 0) and (mode q or its conjugate, h = -j) have the same lambda.
Starting from one of them and leaving both out, m - 1 divisions lead to what arrives at the other with eps^m. The
product of both ways is the square of the largest growth rate, and the region is 4 / j times its root wide.

The figures only say where to look. They fail where eps is large, and where a third state is near.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from floquet.boundary import MIN_RELATIVE_FREQUENCY, Modes, Resonance
from floquet.engine import Subsystem, equations, least_frequency, subsystems
from periodic import PeriodicSystem
from periodic.checks import ComplexArray, FloatArray

# Orders in eps beyond the number j of the resonance: the lowest may vanish by a symmetry.
FURTHER = 2
# Denominators are not taken smaller than this part of Omega.
NEAREST = 1e-3
# A decay rate below this part of the fastest rate is the rounding of a mode without damping.
NO_DECAY = 1e-12
# How much wider than estimated a region may be, or how much less damped, to be looked for all the same.
DOUBT = 2.0
# Eigenvectors of the free motion with a larger condition number are parallel but for rounding. This part of the fastest
# rate, as damping, sets them apart.
PARALLEL, NUDGE = 1e6, 1e-5


class Home(NamedTuple):
    """A subsystem with the exponents of its b modes without excitation, by increasing frequency, imaginary parts >= 0,
    and their numbers in the whole system, from 1; 0 for what does not oscillate."""

    subsystem: Subsystem
    exponents: ComplexArray
    numbers: NDArray[np.intp]


class Candidate(NamedTuple):
    """A resonance of modes p and q (numbers from 0) of a home, with an estimate of its width in Omega at ``eps``, but
    for what damping takes away.

    Unequal damping delta_p, delta_q makes a region wider by the factor 1 / ``balance``, balance^2 = 4 delta_p delta_q /
    (delta_p + delta_q)^2: growth ceases where gamma^2 = delta_p delta_q + (balance x / 2)^2 for a rate gamma of the
    coupling and a detuning x (V. V. Bolotin, Nonconservative Problems of the Theory of Elastic Stability, 1963).
    """

    name: Resonance
    home: Home
    p: int
    q: int
    eps: float
    width: float
    balance: float = 1.0


def homes(system: PeriodicSystem, modes: Modes, least: float) -> list[Home]:
    """Return the subsystems of a system and which of its ``modes`` are theirs; ``least`` is that of `equations`.

    The exponents are those of the subsystem's own equations: what `follow` starts from is what its columns show at
    eps = 0, to the last bit.
    """
    parts = subsystems(system)
    shapes = system.mass @ modes.vectors[system.size :]
    inside = np.array([np.linalg.norm(part.basis.T @ shapes, axis=0) for part in parts])
    inside /= np.maximum(inside.max(axis=0), np.finfo(float).tiny)
    # each subsystem has at most as many modes as coordinates; those of one frequency may have mixed
    places = np.repeat(np.arange(len(parts)), [len(part.K) for part in parts])
    mode, place = linear_sum_assignment(-(inside[places].T ** 2))
    owner = np.full(len(modes.exponents), -1)
    owner[mode] = places[place]
    found = []
    for number, part in enumerate(parts):
        values = np.linalg.eigvals(equations(part, least).A)
        values = values[values.imag > MIN_RELATIVE_FREQUENCY * part.rate]
        own = np.flatnonzero(owner == number) + 1
        count = min(len(values), len(own))  # a mode that hardly oscillates may be found by one of the two alone
        values, own = values[np.argsort(values.imag)][len(values) - count :], own[len(own) - count :]
        none = np.zeros(len(part.K) - count, dtype=np.intp)
        found.append(Home(part, np.concatenate([none, values]), np.concatenate([none, own])))
    return found


def candidates(system: PeriodicSystem, modes: Modes, names: Sequence[Resonance], eps: float) -> list[Candidate]:
    """Return the resonances that damping may leave open at the amplitude ``eps``, the widest first."""
    if not names:
        return []
    least = least_frequency(min(name.centre for name in names))
    found = []
    for home in homes(system, modes, least):
        own = {number: place for place, number in enumerate(home.numbers.tolist()) if number > 0}
        for j in sorted({name.j for name in names}):
            some = [name for name in names if name.j == j and name.p in own and name.q in own]
            if not some:
                continue
            first = home.exponents[[own[name.p] for name in some]]
            second = home.exponents[[own[name.q] for name in some]]
            second = np.where([name.type == "sum" for name in some], second.conj(), second)
            centres = np.array([name.centre for name in some])
            growth = couplings(home.subsystem, least, first, second, j, centres, eps)
            is_open = np.isfinite(growth) & (DOUBT * growth > np.sqrt(np.maximum(first.real * second.real, 0.0)))
            found += [
                Candidate(name, home, own[name.p], own[name.q], eps, float(4 / j * rate / balance), float(balance))
                for name, rate, keep, balance in zip(
                    some, growth, is_open, _balance(home.subsystem, first, second), strict=True
                )
                if keep
            ]
    return sorted(found, key=lambda candidate: -candidate.width)


def _balance(subsystem: Subsystem, first: ComplexArray, second: ComplexArray) -> FloatArray:
    """Return the ``balance`` of `Candidate`, 1 where a mode is not damped."""
    slightest = -NO_DECAY * subsystem.rate
    damped = (first.real < slightest) & (second.real < slightest) & (not subsystem.reciprocal)
    product, total = first.real * second.real, first.real + second.real
    return np.asarray(np.where(damped, 2 * np.sqrt(np.abs(product)) / np.where(damped, -total, 1.0), 1.0))


def couplings(
    subsystem: Subsystem, least: float, first: ComplexArray, second: ComplexArray, j: int, Omega: FloatArray, eps: float
) -> FloatArray:
    """Return the largest growth rates (count,), but for damping, of some resonances of number ``j`` at ``eps``.

    ``first`` and ``second`` (count,) are the exponents of the two states, ``Omega`` (count,) the frequencies at which
    they differ by i j Omega; ``least`` is that of `equations`.
    """
    y, b = equations(subsystem, least), len(subsystem.K)
    Lambda, V = np.linalg.eig(y.A)
    if np.linalg.cond(V) > PARALLEL:  # a mode is critically damped, or free, and has a single eigenvector
        Lambda, V = np.linalg.eig(y.A - NUDGE * subsystem.rate * np.diag(np.repeat([0.0, 1.0], b)))
    G = {}
    for k, (Fc, Fs) in enumerate(zip(subsystem.Fc, subsystem.Fs, strict=True), 1):
        for sign in (1, -1):
            kick = np.zeros((2 * b, 2 * b), complex)
            kick[b:, :b] = -y.left[:, None] * (Fc - sign * 1j * Fs) / 2 * y.right
            G[sign * k] = np.linalg.solve(V, kick @ V)
    start, end = (np.abs(Lambda - state[:, None]).argmin(axis=1) for state in (first, second))
    forward = _arriving(Lambda, G, start, end, -j, Omega, eps)
    return np.asarray(np.sqrt(forward * _arriving(Lambda, G, end, start, j, Omega, eps)))


def _arriving(
    Lambda: ComplexArray,
    G: dict[int, ComplexArray],
    start: NDArray[np.intp],
    end: NDArray[np.intp],
    j: int,
    Omega: FloatArray,
    eps: float,
) -> FloatArray:
    """Return the moduli, summed over the orders, of what arrives at ``end`` in harmonic ``j`` from ``start`` in 0."""
    harmonics = np.arange(min(j, 0) - FURTHER, max(j, 0) + FURTHER + 1)
    count, zero, target, each = len(harmonics), -harmonics[0], j - harmonics[0], np.arange(len(start))
    Omega = Omega[:, None, None]
    divisor = Lambda[start][:, None, None] + 1j * harmonics[:, None] * Omega - Lambda
    divisor = np.where(np.abs(divisor) < NEAREST * Omega, NEAREST * Omega, divisor)
    a = np.zeros_like(divisor)
    a[each, zero, start] = 1
    total, orders, widest = np.zeros(len(start)), abs(j) + FURTHER, max(G, default=0)
    for order in range(1, orders + 1):
        # harmonics that can have been reached, and from which the end can be
        left = (orders - order) * widest
        low = max(zero - order * widest, target - left, 0)
        high = min(zero + order * widest, target + left, count - 1)
        arrived = np.zeros_like(a)
        for k, matrix in G.items():
            first, last = max(low, k), min(high, count - 1 + k)
            if first <= last:
                arrived[:, first : last + 1] += eps * (a[:, first - k : last + 1 - k] @ matrix.T)
        total += np.abs(arrived[each, target, end])
        a = np.zeros_like(a)
        a[:, low : high + 1] = arrived[:, low : high + 1] / divisor[:, low : high + 1]
        a[each, zero, start] = a[each, target, end] = 0
    return total
