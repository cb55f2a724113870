"""The tongues to be expected: of each resonance the width of its region, to the lowest orders in eps.

In coordinates that make the free motion diagonal, y' = Lambda y + eps sum_k G_k e^{i k Omega t} y. A solution y =
e^{lambda t} sum_h a_h e^{i h Omega t} obeys

    (lambda + i h Omega - Lambda) a_h = eps sum_k G_k a_{h-k}.

At j Omega = omega_p ± omega_q two states have the same lambda: mode p with h = 0, and mode q or its conjugate with h =
-j. Start from one of them, leave both out, and divide m - 1 times: that leads to what arrives at the other with eps^m.
The product of both ways is the square of the largest growth rate. The region is 4 / j times its root wide.

These widths only say where to look. They fail where eps is large, and where a third state is near.
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

# Orders in eps that are summed beyond the order j of the resonance: the lowest may vanish by a symmetry.
EXTRA_ORDERS = 2
# Divisors are not taken smaller than this part of Omega.
MIN_DIVISOR = 1e-3
# No width is smaller, in units of Omega.
MIN_WIDTH = 1e-30
# A decay rate below this part of the fastest rate is the rounding of a mode without damping.
MIN_DECAY = 1e-12
# A region counts as closed by damping if its growth were too small even when multiplied by this.
GROWTH_SAFETY = 2.0
# Eigenvectors of the free motion with a larger condition number are parallel but for rounding.
MAX_EIGENVECTOR_CONDITION = 1e6
# Damping, as part of the fastest rate, that sets parallel eigenvectors apart.
SEPARATING_DAMPING = 1e-5


class SubsystemModes(NamedTuple):
    """A subsystem with its b modes at eps = 0, by increasing frequency.

    ``exponents`` (b,) have imaginary parts >= 0. ``numbers`` (b,) are those of the modes in the whole system, from 1; 0
    for what does not oscillate.
    """

    subsystem: Subsystem
    exponents: ComplexArray
    numbers: NDArray[np.intp]


class ExpectedTongue(NamedTuple):
    """A resonance with the estimated ``width`` in Omega of its region at ``eps``, but for what damping closes.

    ``p`` and ``q`` are the numbers of its modes in the subsystem ``modes``, from 0. Unequal dampings delta_p, delta_q
    make a region wider by the factor 1 / ``balance``, balance^2 = 4 delta_p delta_q / (delta_p + delta_q)^2: with a
    rate gamma of the coupling and a detuning x, growth ceases where gamma^2 = delta_p delta_q + (balance x / 2)^2 (V.
    V. Bolotin, Nonconservative Problems of the Theory of Elastic Stability, 1963).
    """

    resonance: Resonance
    modes: SubsystemModes
    p: int
    q: int
    eps: float
    width: float
    balance: float = 1.0

    @property
    def tip(self) -> float:
        """The amplitude at which the region begins: 0 if one of the modes is not damped."""
        decay = self.modes.exponents.real[[self.p, self.q]].prod() * (self.modes.exponents.real[self.p] < 0)
        rate = self.width * self.balance * self.resonance.j / 4
        if self.modes.subsystem.reciprocal or decay <= 0:
            return 0.0
        return float(self.eps * (np.sqrt(decay) / max(rate, MIN_WIDTH)) ** (1 / self.resonance.j))

    def eps_of_width(self, width: float) -> float:
        """Return the amplitude up to which the region is not wider than ``width``, at most ``eps``."""
        return self.eps * min(1.0, (width / max(self.width, MIN_WIDTH)) ** (1 / self.resonance.j))


def modes_of_subsystems(system: PeriodicSystem, modes: Modes, least: float) -> list[SubsystemModes]:
    """Return the subsystems of a system and which of its ``modes`` are theirs; ``least`` is that of `equations`.

    The exponents are those of the subsystem's own equations. So what `track_modes` starts from is what the columns show
    at eps = 0, to the last bit.
    """
    parts = subsystems(system)
    shapes = system.mass @ modes.vectors[system.size :]
    inside = np.array([np.linalg.norm(part.basis.T @ shapes, axis=0) for part in parts])
    inside /= np.maximum(inside.max(axis=0), np.finfo(float).tiny)
    # each subsystem has at most as many modes as coordinates; those of one frequency may have mixed
    seats = np.repeat(np.arange(len(parts)), [len(part.K) for part in parts])
    mode, seat = linear_sum_assignment(-(inside[seats].T ** 2))
    owner = np.full(len(modes.exponents), -1)
    owner[mode] = seats[seat]
    found = []
    for number, part in enumerate(parts):
        values = np.linalg.eigvals(equations(part, least).A)
        values = values[values.imag > MIN_RELATIVE_FREQUENCY * part.rate]
        own = np.flatnonzero(owner == number) + 1
        count = min(len(values), len(own))  # a mode that hardly oscillates may be found by one of the two alone
        values, own = values[np.argsort(values.imag)][len(values) - count :], own[len(own) - count :]
        none = np.zeros(len(part.K) - count, dtype=np.intp)
        found.append(SubsystemModes(part, np.concatenate([none, values]), np.concatenate([none, own])))
    return found


def expected_tongues(
    system: PeriodicSystem, modes: Modes, resonances: Sequence[Resonance], eps: float
) -> list[ExpectedTongue]:
    """Return the regions that damping may leave open at the amplitude ``eps``, the widest first."""
    if not resonances:
        return []
    least = least_frequency(min(one.centre for one in resonances))
    found = []
    for part in modes_of_subsystems(system, modes, least):
        local = {number: place for place, number in enumerate(part.numbers.tolist()) if number > 0}
        for j in sorted({one.j for one in resonances}):
            some = [one for one in resonances if one.j == j and one.p in local and one.q in local]
            if not some:
                continue
            first = part.exponents[[local[one.p] for one in some]]
            second = part.exponents[[local[one.q] for one in some]]
            second = np.where([one.type == "sum" for one in some], second.conj(), second)
            centres = np.array([one.centre for one in some])
            growth = coupling_rates(part.subsystem, least, first, second, j, centres, eps)
            damping = np.sqrt(np.maximum(first.real * second.real, 0.0))
            is_open = np.isfinite(growth) & (GROWTH_SAFETY * growth > damping)
            found += [
                ExpectedTongue(
                    one, part, local[one.p], local[one.q], eps, float(4 / j * rate / balance), float(balance)
                )
                for one, rate, keep, balance in zip(
                    some, growth, is_open, _balance(part.subsystem, first, second), strict=True
                )
                if keep
            ]
    return sorted(found, key=lambda tongue: -tongue.width)


def _balance(subsystem: Subsystem, first: ComplexArray, second: ComplexArray) -> FloatArray:
    """Return the ``balance`` of `ExpectedTongue`, 1 where a mode is not damped."""
    slightest = -MIN_DECAY * subsystem.rate
    damped = (first.real < slightest) & (second.real < slightest) & (not subsystem.reciprocal)
    product, total = first.real * second.real, first.real + second.real
    return np.asarray(np.where(damped, 2 * np.sqrt(np.abs(product)) / np.where(damped, -total, 1.0), 1.0))


def coupling_rates(
    subsystem: Subsystem, least: float, first: ComplexArray, second: ComplexArray, j: int, Omega: FloatArray, eps: float
) -> FloatArray:
    """Return the largest growth rates (count,), but for damping, of resonances of order ``j`` at ``eps``.

    ``first`` and ``second`` (count,) are the exponents of the two states. They differ by i j Omega at the frequencies
    ``Omega`` (count,). ``least`` is that of `equations`.
    """
    y, b = equations(subsystem, least), len(subsystem.K)
    Lambda, V = np.linalg.eig(y.A)
    if np.linalg.cond(V) > MAX_EIGENVECTOR_CONDITION:  # a critically damped or free mode has a single eigenvector
        Lambda, V = np.linalg.eig(y.A - SEPARATING_DAMPING * subsystem.rate * np.diag(np.repeat([0.0, 1.0], b)))
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
    """Return what arrives at ``end`` in harmonic ``j`` from ``start`` in harmonic 0: moduli, summed over the orders."""
    harmonics = np.arange(min(j, 0) - EXTRA_ORDERS, max(j, 0) + EXTRA_ORDERS + 1)
    count, zero, target, each = len(harmonics), -harmonics[0], j - harmonics[0], np.arange(len(start))
    Omega = Omega[:, None, None]
    divisor = Lambda[start][:, None, None] + 1j * harmonics[:, None] * Omega - Lambda
    divisor = np.where(np.abs(divisor) < MIN_DIVISOR * Omega, MIN_DIVISOR * Omega, divisor)
    a = np.zeros_like(divisor)
    a[each, zero, start] = 1
    total, orders, widest = np.zeros(len(start)), abs(j) + EXTRA_ORDERS, max(G, default=0)
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
