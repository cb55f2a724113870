"""Modes tracked along a column from eps = 0, where it is known which is which, and what they say about instability.

Multipliers are computed amplitude by amplitude, in no order. Along eps the angles of the modes are smooth. They stay
smooth where two of them meet in a region that is much narrower in eps than the distance between two amplitudes. So the
angle of a mode is extrapolated from the last amplitudes, and the angles found at the next one are assigned in the order
of the extrapolated ones.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from floquet.engine import ReciprocalSums, Spectra, exponent
from periodic.checks import ComplexArray, FloatArray

# Multipliers of a conservative system have left the unit circle if log|mu| is larger.
UNIT_CIRCLE_TOLERANCE = 1e-6
# Growth of a conservative system is clear, though the edge is near, if log|mu| is larger.
MIN_CLEAR_GROWTH = 1e-4
# Two modes that are unstable together have one angle. They are told apart by this part of their last free movement.
PRESUMED_MOVEMENT = 1e-3
# Extrapolation begins anew where the angle found differs by more than this, in rad.
MAX_EXTRAPOLATION_ERROR = 0.3
# Modes that decay by a factor of more than exp(MAX_TRACKED_DECAY) in one period are not tracked.
MAX_TRACKED_DECAY = 8.0
# Most unstable multipliers at two neighbouring amplitudes whose angles differ by more, in rad, are those of two pairs.
MAX_ANGLE_DIFFERENCE = 0.5
# Halvings that find an edge between two amplitudes.
EDGE_HALVINGS = 40


class LogMultipliers(NamedTuple):
    """log mu of the n modes of a subsystem at k amplitudes, arrays (k, n).

    ``angle`` is the imaginary part. ``modulus`` is the real part. A mode with two real multipliers has their mean for
    ``modulus`` and half their difference for ``half_difference``, which is 0 for all others.
    """

    angle: FloatArray
    modulus: FloatArray
    half_difference: FloatArray


def log_multipliers(found: Spectra) -> LogMultipliers:
    """Return log mu of the modes of a subsystem from all of its multipliers, angles in [0, pi]."""
    if isinstance(found, ReciprocalSums):
        return log_multipliers_symplectic(found.sums, found.exponents)
    return log_multipliers_general(found.mu, found.exponents)


@njit(cache=True, nogil=True)
def log_multipliers_symplectic(s: ComplexArray, powers: FloatArray) -> LogMultipliers:
    """Return log mu of the modes of a symplectic subsystem with mu + 1/mu = 2^powers[c] s[c, i], angles in [0, pi]."""
    k, n = s.shape
    angle, modulus, half_difference = np.zeros((k, n)), np.zeros((k, n)), np.zeros((k, n))
    for c in range(k):
        for i in range(n):
            u, angle[c, i] = exponent(s[c, i], powers[c])
            if s[c, i].imag == 0.0:
                half_difference[c, i] = u
            else:
                modulus[c, i] = np.copysign(u, s[c, i].imag)
    return LogMultipliers(angle, modulus, half_difference)


@njit(cache=True, nogil=True)
def log_multipliers_general(mu: ComplexArray, powers: FloatArray) -> LogMultipliers:
    """Return log mu of the modes of any subsystem with multipliers 2^powers[c] mu[c, i], mu (k, 2n), angles in [0, pi].

    Of the real multipliers of one sign the two largest are taken for those of one mode, the next two for another. A
    mode that is damped out has two multipliers that are zero and is left out: its entries are zero.
    """
    k, n = mu.shape[0], mu.shape[1] // 2
    angle, modulus, half_difference = np.zeros((k, n)), np.zeros((k, n)), np.zeros((k, n))
    for c in range(k):
        shift, used = powers[c] * np.log(2.0), 0
        for sign in (1.0, -1.0):
            real = np.sort(np.array([np.log(abs(z)) for z in mu[c] if z.imag == 0.0 and z.real * sign > 0]))
            for i in range(real.size // 2):
                if used < n:
                    low, high = real[real.size - 2 - 2 * i], real[real.size - 1 - 2 * i]
                    modulus[c, used], half_difference[c, used] = shift + (low + high) / 2, (high - low) / 2
                    angle[c, used] = 0.0 if sign > 0 else np.pi
                    used += 1
        for z in mu[c]:
            if z.imag > 0.0 and used < n:
                modulus[c, used], angle[c, used] = shift + np.log(abs(z)), np.angle(z)
                used += 1
    return LogMultipliers(angle, modulus, half_difference)


@njit(cache=True, nogil=True)
def _nearest(
    angle: FloatArray, modulus: FloatArray, alive: NDArray[np.intp], angles: FloatArray, moduli: FloatArray
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return the modes ``alive`` and the number found for each, the nearest pair first.

    They are expected at ``modulus`` + i ``angle``.
    """
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
def track_modes(found: LogMultipliers, eps: FloatArray, start: ComplexArray, conservative: bool) -> LogMultipliers:
    """Return ``found`` sorted into modes, with angles that are continuous along eps.

    ``start`` (n,) are their log mu at eps[0] = 0. The multipliers of modes that are damped out within a period are
    rounding; these modes are left as they start.
    """
    k, n = found.angle.shape
    alive = np.flatnonzero(start.real > -MAX_TRACKED_DECAY)
    angle, modulus, half_difference = np.zeros((k, n)), np.zeros((k, n)), np.zeros((k, n))
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
                expected[i] = angle[c - 1, i] + PRESUMED_MOVEMENT * rate[i]
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
            angle[c, i], modulus[c, i], half_difference[c, i] = best, found.modulus[c, f], found.half_difference[c, f]
            locked = half_difference[c, i] > 0.0 or (conservative and abs(modulus[c, i]) > UNIT_CIRCLE_TOLERANCE)
            free[i] = 0 if locked or abs(best - expected[i]) > MAX_EXTRAPOLATION_ERROR else free[i] + 1
    return LogMultipliers(angle, modulus, half_difference)


def angle_detuning(found: LogMultipliers, p: int, q: int, j: int, sign: int) -> FloatArray:
    """Return the detuning from the resonance j Omega = omega_p ± omega_q as an angle in one period, (...).

    It falls through zero where Omega rises through the resonance.
    """
    return np.asarray(found.angle[..., p] + sign * found.angle[..., q] - 2 * np.pi * j)


def pair_test_function(found: LogMultipliers, p: int, q: int, j: int, sign: int, conservative: bool) -> FloatArray:
    """Return f (...) of the resonance j Omega = omega_p ± omega_q, positive where its two modes are unstable together.

    ``found`` is that of `track_modes`, with arrays (..., n). ``p`` and ``q`` are numbers of modes from 0, ``sign`` is 1
    or -1. f is analytic where the two multipliers coalesce, like that of `floquet.boundary.pair.instability`, but is
    made of logarithms. It is NaN where one of the modes is unstable with another one.
    """
    modulus, half_difference = found.modulus, found.half_difference
    detuning = angle_detuning(found, p, q, j, sign)
    total = modulus[..., p] + modulus[..., q]
    elsewhere = np.abs(detuning) > np.pi  # two that are unstable by another resonance
    if p == q:
        elsewhere &= half_difference[..., p] > 0
        f = half_difference[..., p] ** 2 - detuning**2 / 4 - total**2 / 4
        return np.where(elsewhere | (conservative & (np.abs(total) > UNIT_CIRCLE_TOLERANCE)), np.nan, f)
    difference = modulus[..., p] - modulus[..., q]
    if conservative:
        together = np.abs(difference) > UNIT_CIRCLE_TOLERANCE
        f = np.where(together, difference**2, -(detuning**2)) / 4
        elsewhere = (elsewhere & together) | (np.abs(total) > UNIT_CIRCLE_TOLERANCE)
    else:
        with np.errstate(divide="ignore", invalid="ignore"):
            skew = difference * detuning / 2 / total
        f = (difference**2 - detuning**2) / 4 + skew**2 - total**2 / 4
        elsewhere &= f > 0
    return np.where(elsewhere | (half_difference[..., p] > 0) | (half_difference[..., q] > 0), np.nan, f)


@njit(cache=True, nogil=True)
def strongest_pair(found: LogMultipliers) -> tuple[FloatArray, FloatArray]:
    """Return f of the most unstable pair at every amplitude, (k,), and its mark, (k,).

    f is that of `pair_test_function` if all modes decay alike: m (m + 2 delta) for the growth m and the mean decay
    delta, which the pair keeps. The mark is the angle, shifted by 2 pi where the multipliers are real. Marks of one
    region differ little between neighbouring amplitudes and columns, those of two regions in general differ by more.
    """
    angle, modulus, half_difference = found
    f, mark = np.zeros(len(angle)), np.zeros(len(angle))
    for c in range(len(angle)):
        first = int((modulus[c] + half_difference[c]).argmax())
        growth = modulus[c, first] + half_difference[c, first]
        f[c] = growth * (growth - 2 * modulus[c].mean())
        mark[c] = 2 * np.pi + 2 * angle[c, first] if half_difference[c, first] > 0.0 else angle[c, first]
    return f, mark


@njit(cache=True, nogil=True)
def _strongest(found: LogMultipliers, c: int) -> tuple[float, bool]:
    """Return the angle of the most unstable multiplier at amplitude number ``c``, and whether it is real."""
    angle, modulus, half_difference = found
    first = int((modulus[c] + half_difference[c]).argmax())
    return angle[c, first], half_difference[c, first] > 0.0


@njit(cache=True, nogil=True)
def _f_at(found: LogMultipliers, c: int, at: float, single: bool, conservative: bool) -> tuple[float, float]:
    """Return f and the mean angle, at amplitude number ``c``, of the pair of multipliers that is nearest to an angle.

    ``single`` means those of one mode. A negative ``at`` stands for the most unstable pair.
    """
    angle, modulus, half_difference = found
    first = int((modulus[c] + half_difference[c]).argmax()) if at < 0.0 else int(np.abs(angle[c] - at).argmin())
    if single:
        off = angle[c, first] - at if at >= 0.0 else 0.0
        apart = half_difference[c, first] if abs(off) < MAX_ANGLE_DIFFERENCE else 0.0  # else real, but of other sign
        return apart**2 - off**2 - modulus[c, first] ** 2, angle[c, first]
    distance = np.abs(angle[c] - (angle[c, first] if at < 0.0 else at))
    distance[first] = np.inf
    second = int(distance.argmin())
    total, detuning = modulus[c, first] + modulus[c, second], angle[c, first] - angle[c, second]
    difference = modulus[c, first] - modulus[c, second]
    f = (difference**2 - detuning**2 - total**2) / 4
    if not conservative and total != 0.0:
        f += (difference * detuning / 2 / total) ** 2
    return f, (angle[c, first] + angle[c, second]) / 2


@njit(cache=True, nogil=True)
def edge_between(
    found: LogMultipliers, eps: FloatArray, outside: int, inside: int, further: int, conservative: bool
) -> tuple[float, float]:
    """Return the edge of a region between two neighbouring amplitudes, number ``outside`` and number ``inside`` it.

    It is the zero of a parabola through the test function f of the pair that is most unstable at ``inside``. The third
    amplitude is ``further`` inside; if that is ``inside`` itself, a straight line is taken. Where f does not change its
    sign the edge is taken to be halfway. The second number is by how much the edge may be off.
    """
    at, single = _strongest(found, inside)
    f_inside, centre = _f_at(found, inside, -1.0, single, conservative)
    at = at if single else centre
    f_further, _ = _f_at(found, further, at if single else -1.0, single, conservative)
    f_outside, _ = _f_at(found, outside, at, single, conservative)
    b, a = eps[inside], eps[outside]
    met = conservative and -(MIN_CLEAR_GROWTH**2) < f_outside < UNIT_CIRCLE_TOLERANCE  # at ``outside`` itself
    if met:
        return a, 0.0
    if not (f_inside > 0.0 and f_outside < 0.0):
        return (a + b) / 2, abs(b - a) / 2
    # inwards from outside: f = f_outside + slope x + bend x (x - 1), x = 1 at ``inside``
    slope, bend = f_inside - f_outside, 0.0
    if further != inside:
        x = (eps[further] - a) / (b - a)
        bend = (f_further - f_outside - slope * x) / (x * (x - 1))
    low, high = 0.0, 1.0
    for _ in range(EDGE_HALVINGS):
        x = (low + high) / 2
        if f_outside + slope * x + bend * x * (x - 1) > 0.0:
            high = x
        else:
            low = x
    x = (low + high) / 2
    faint = conservative and f_inside < MIN_CLEAR_GROWTH**2  # nearer to the edge nothing would be seen
    return a + x * (b - a), 0.0 if faint else abs(x + f_outside / slope) * abs(b - a)


@njit(cache=True, nogil=True)
def may_have_gap(found: LogMultipliers, eps: FloatArray, c: int, first: int, last: int, conservative: bool) -> bool:
    """Whether the system may be stable between the amplitudes number ``c`` and c + 1, both of them unstable.

    The amplitudes from number ``first`` to ``last`` are unstable. If the most unstable pairs are two, there may be a
    gap unless one of them is unstable at both. If they are one, there may be a gap if f falls towards it from both
    sides and straight lines are at zero before they meet: f falls to an edge like a parabola.
    """
    (at, single), (at_next, single_next) = _strongest(found, c), _strongest(found, c + 1)
    f, centre = _f_at(found, c, -1.0, single, conservative)
    f_next, centre_next = _f_at(found, c + 1, -1.0, single_next, conservative)
    if single != single_next or abs(at - at_next) > MAX_ANGLE_DIFFERENCE:
        ends = _f_at(found, c + 1, at if single else centre, single, conservative)[0] < 0.0
        begins = _f_at(found, c, at_next if single_next else centre_next, single_next, conservative)[0] < 0.0
        return ends and begins
    if c == first or c + 1 == last:
        return False
    before, _ = _f_at(found, c - 1, at if single else -1.0, single, conservative)
    after, _ = _f_at(found, c + 2, at_next if single else -1.0, single, conservative)
    if not (before > f > 0.0 and after > f_next > 0.0):
        return False
    end = eps[c] + f * (eps[c] - eps[c - 1]) / (before - f)
    begin = eps[c + 1] - f_next * (eps[c + 2] - eps[c + 1]) / (after - f_next)
    return end < begin
