"""One general subsystem over one period, as a product of factors: steps, exponentials and jumps.

Between phases at which a function changes its formula or a pulse falls, steps are Taylor series (`series`); where all
coefficients are constant there, exponentials. At such a phase the momentum E y goes on, but for pulses:
y -> exp(E^-1 P) E^-1 E_before y, with E just after the phase. The period begins just after t = 0.
"""

from __future__ import annotations

from functools import reduce
from itertools import pairwise
from typing import NamedTuple

import numpy as np
import scipy.linalg as sla

from floquet.oracle.general.coefficients import Coefficients
from floquet.oracle.general.series import series_step
from floquet.oracle.general.splitting import GeneralSubsystem
from floquet.oracle.period import (
    FINEST_SERIES_TOLERANCE,
    MAX_SECONDS,
    MAX_STEP_HALVINGS,
    MAX_TAYLOR_TERMS,
    RADIANS_PER_STEP,
    SECONDS_PER_FLOP,
    SECONDS_PER_TERM,
    SEGMENTS_PER_PERIOD,
    TERMS_PER_STEP,
    WORTHWHILE_REDUCTION,
    PeriodMap,
    overflow,
)
from floquet.oracle.products import ProductEigenvalues, product_eigenvalues
from floquet.oracle.taylor import MACHINE_EPSILON, MAX_SOLUTION
from periodic.checks import FloatArray

# Phases of each segment at which the rate of the motion is looked at.
RATE_SAMPLES = 9
# A step whose series does not end is halved at most so many times, one half at a time.
MAX_LOCAL_HALVINGS = 12
# Rounding errors of an exponential or a jump, as a multiple of the roundings of its norm.
EXPONENTIAL_ROUNDINGS = 4
# Factors into which a period is gathered where small multipliers are wanted.
MAX_FACTORS = 256


class Factor(NamedTuple):
    """The matrix (N, N) of one part of a period, its rounding error (Frobenius norm) and its duration in time."""

    matrix: FloatArray
    rounding: float
    duration: float


class Passage(NamedTuple):
    """The period map of a general subsystem, and what its multipliers are worked out from.

    Attributes
    ----------
    map : PeriodMap
    factors : list of Factor
    rate : float
        Bound on the rate of the motion, per unit of time.
    """

    map: PeriodMap
    factors: list[Factor]
    rate: float


def passage(subsystem: GeneralSubsystem, Omega: float, eps: float, tolerance: float) -> Passage:
    """Integrate one subsystem over one period and estimate the error.

    Raises
    ------
    ValueError
        If the solution overflows or the integration would take too long; the message names ``Omega`` and ``eps``.
    """
    rates = _rates(subsystem.coefficients)
    rate = max(rates)
    refinement, best = 1, None
    coarse = _product(_factors(subsystem.coefficients, Omega, eps, rates, refinement), Omega, eps)
    to_q, from_q = subsystem.to_q, subsystem.from_q
    for _ in range(MAX_STEP_HALVINGS + 1):
        refinement *= 2
        factors = _factors(subsystem.coefficients, Omega, eps, rates, refinement)
        matrix = _product(factors, Omega, eps)
        defect = matrix - coarse
        groups = _gathered(factors, SEGMENTS_PER_PERIOD)
        known = MACHINE_EPSILON * rate + subsystem.coefficients.unknown
        rounding, fixed = (_at_the_end(groups, part) for part in ((1.0, 0.0), (0.0, known)))
        reducible = float(np.linalg.norm(defect)) + rounding
        error = reducible + fixed
        in_q = float(np.linalg.norm(to_q @ defect @ from_q)) + _at_the_end(groups, (1.0, known), to_q, from_q)
        if best is not None and error > WORTHWHILE_REDUCTION * best.map.error:  # rounding is what is left
            break
        best = Passage(PeriodMap(matrix, error, in_q), factors, rate)
        if reducible <= max(tolerance * max(1.0, float(np.linalg.norm(matrix, 2))), error - reducible):
            break
        coarse = matrix
    assert best is not None
    return best


def period_matrix(subsystem: GeneralSubsystem, Omega: float, eps: float) -> FloatArray:
    """Integrate one subsystem over one period once, as accurately as the series go, without a measured error.

    Raises
    ------
    ValueError
        As `passage`.
    """
    c = subsystem.coefficients
    return _product(_factors(c, Omega, eps, _rates(c), 1), Omega, eps)


def multipliers_of(found: Passage, unknown: float) -> ProductEigenvalues:
    """Return the multipliers from the factors, small ones as accurate as large ones."""
    return product_eigenvalues(*_with_errors(_gathered(found.factors, MAX_FACTORS), found.rate, unknown))


class Parts(NamedTuple):
    """Matrices (p, N, N) of parts of a period and their errors (p,), as `product_eigenvalues` takes them."""

    matrices: FloatArray
    rounding: FloatArray
    systematic: FloatArray


def _with_errors(groups: list[Factor], rate: float, unknown: float) -> Parts:
    systematic = np.array([group.duration * (MACHINE_EPSILON * rate + unknown) for group in groups])
    return Parts(
        np.array([group.matrix for group in groups]), np.array([group.rounding for group in groups]), systematic
    )


def largest_rate(subsystem: GeneralSubsystem) -> float:
    """Return a bound on the rate of the motion at any time, per unit of time."""
    return max(_rates(subsystem.coefficients))


def _rates(c: Coefficients) -> list[float]:
    """Return the largest norm of E^-1 A in each segment, per unit of time."""
    rates = []
    for a, b in c.segments():
        count = max(RATE_SAMPLES, int(np.ceil(RATE_SAMPLES * c.harmonics * (b - a))))
        pairs = (c.at(phase, (a + b) / 2) for phase in np.linspace(a, b, count))
        rates.append(max(float(np.linalg.norm(np.linalg.solve(E, A), 2)) for E, A in pairs))
    return rates


def _factors(c: Coefficients, Omega: float, eps: float, rates: list[float], refinement: int) -> list[Factor]:
    period = 2 * np.pi / Omega
    segments = c.segments()
    exact = c.is_constant_between_jumps
    counts = [
        int(np.ceil((b - a) * (period * rate + (0 if exact else 2 * np.pi * c.harmonics)) / RADIANS_PER_STEP)) or 1
        for (a, b), rate in zip(segments, rates, strict=True)
    ]
    _refuse_long(c, Omega, sum(counts) * refinement)
    found: list[Factor] = []
    for (a, b), count, rate in zip(segments, counts, rates, strict=True):
        found += _smooth_part(c, Omega, eps, a, b, count * refinement, rate)
        if c.pieces or c.pulses:
            found += _jump(c, segments, b)
    return found


def _smooth_part(
    c: Coefficients, Omega: float, eps: float, a: float, b: float, steps: int, rate: float
) -> list[Factor]:
    """Return the factors of so many equal steps from one phase to another, no jump between them."""
    inside = (a + b) / 2
    found: list[Factor] = []
    if c.is_constant_between_jumps:
        E, A = c.at(inside, inside)
        h = 2 * np.pi / Omega * (b - a) / steps
        matrix = sla.expm(np.linalg.solve(E, A) * h)
        size = EXPONENTIAL_ROUNDINGS * float(np.linalg.norm(matrix)) * max(1.0, rate * h)
        return [Factor(matrix, MACHINE_EPSILON * size, h)] * steps
    ends = a + (b - a) * np.arange(steps + 1) / steps
    for start, end in pairwise(ends):
        _append_step(found, c, Omega, eps, float(start), float(end), inside, MAX_LOCAL_HALVINGS)
    return found


def factors_between(subsystem: GeneralSubsystem, Omega: float, eps: float, phases: FloatArray) -> Parts:
    """Integrate one subsystem from each of some phases to the next, as accurately as float64 allows.

    Parameters
    ----------
    subsystem : GeneralSubsystem
    Omega, eps : float
    phases : ndarray, shape (p + 1,)
        Increasing, as parts of a period; they may go on into the next one. At a phase where something jumps, the
        solution just after the jump is meant.

    Returns
    -------
    Parts
        p of them.

    Raises
    ------
    ValueError
        As `passage`.
    """
    c = subsystem.coefficients
    segments, rates = c.segments(), _rates(c)
    jumping = bool(c.pieces or c.pulses)
    harmonics = 0 if c.is_constant_between_jumps else c.harmonics
    radians = 2 * np.pi * (max(rates) / Omega + harmonics) * np.diff(phases)
    _refuse_long(c, Omega, int(np.ceil(2 * radians / RADIANS_PER_STEP).sum()))
    turn = int(np.floor(phases[0]))
    place = float(phases[0]) - turn
    found = []
    for last in phases[1:].tolist():
        parts: list[Factor] = []
        while place + turn < last:
            number = next(i for i, (_, end) in enumerate(segments) if place < end)
            end = segments[number][1]
            reached = end + turn <= last
            b = end if reached else last - turn
            span = 2 * np.pi * (rates[number] / Omega + harmonics) * (b - place)
            steps = int(np.ceil(2 * span / RADIANS_PER_STEP)) or 1  # shorter than those of the map: they round less
            parts += _smooth_part(c, Omega, eps, place, b, steps, rates[number])
            if jumping and reached:
                parts += _jump(c, segments, b)
            turn, place = (turn + 1, 0.0) if reached and end == 1.0 else (turn, b)
        found.append(parts[0] if len(parts) == 1 else _gathered(parts, 1)[0])
    return _with_errors(found, max(rates), c.unknown)


def _append_step(
    found: list[Factor], c: Coefficients, Omega: float, eps: float, start: float, end: float, inside: float, left: int
) -> None:
    """Append the factors of a step between two phases; of its halves, where the series does not end."""
    N, length = len(c.constant), end - start
    h = 2 * np.pi / Omega * length
    f = c.series(start, length, inside, MAX_TAYLOR_TERMS)
    rows = [h * c.constant, *(h * c.A)]
    moving = c.mass_moves
    if moving:
        E = np.eye(N) + np.tensordot(f[:, 0], c.E, 1)
        rows = list(np.linalg.solve(E, np.array([*rows, *(-c.E)])))
    S = np.ascontiguousarray(np.hstack(rows))
    reverse = np.ascontiguousarray(f[:, ::-1])
    matrix, relative, size = series_step(S, moving, reverse, FINEST_SERIES_TOLERANCE, np.eye(N))
    if relative <= FINEST_SERIES_TOLERANCE:
        found.append(Factor(matrix, MACHINE_EPSILON * float(size), h))
        return
    if not left:
        raise ValueError(
            f"eps = {eps!r} at Omega = {Omega!r}: the motion near the phase {start:.6g} of the period is too fast to "
            "integrate; give a smaller eps"
        )
    middle = (start + end) / 2
    _append_step(found, c, Omega, eps, start, middle, inside, left - 1)
    _append_step(found, c, Omega, eps, middle, end, inside, left - 1)


def _jump(c: Coefficients, segments: list[tuple[float, float]], phase: float) -> list[Factor]:
    """Return the factor of what happens at the end ``phase`` of a segment; none if nothing does."""
    starts = [a for a, _ in segments]
    before = segments[[b for _, b in segments].index(phase)]
    after = segments[starts.index(phase % 1.0)]
    matrix: FloatArray = np.eye(len(c.constant))
    E = matrix
    if c.mass_moves:
        E = c.at(after[0], sum(after) / 2)[0]
        matrix = np.asarray(np.linalg.solve(E, c.at(phase, sum(before) / 2)[0]), dtype=np.float64)
    pulses = [P for place, P in c.pulses if place == phase % 1.0]
    if pulses:
        kick: FloatArray = sla.expm(np.linalg.solve(E, reduce(np.add, pulses)))
        matrix = kick @ matrix
    if (matrix == np.eye(len(matrix))).all():
        return []
    return [Factor(matrix, EXPONENTIAL_ROUNDINGS * MACHINE_EPSILON * float(np.linalg.norm(matrix)), 0.0)]


def _refuse_long(c: Coefficients, Omega: float, steps: int) -> None:
    N, products = len(c.constant), 1 + len(c.A) * (2 if c.mass_moves else 1)
    seconds = steps * TERMS_PER_STEP * (products * SECONDS_PER_TERM + 2 * products * N**3 * SECONDS_PER_FLOP)
    if not seconds <= MAX_SECONDS:
        raise ValueError(
            f"Omega = {Omega!r} means {steps:.2g} steps in one period, about {seconds:.2g} s; "
            "give a larger Omega or a smaller eps"
        )


def _product(factors: list[Factor], Omega: float, eps: float) -> FloatArray:
    matrix = np.eye(len(factors[0].matrix))
    for factor in factors:
        matrix = factor.matrix @ matrix
        if not np.abs(matrix).max() <= MAX_SOLUTION:
            raise overflow(Omega, eps)
    return matrix


def _gathered(factors: list[Factor], most: int) -> list[Factor]:
    """Return the factors multiplied together in at most ``most`` groups; errors grow with the largest partial product
    of their group."""
    groups = []
    for part in np.array_split(np.arange(len(factors)), min(most, len(factors))):
        matrix, growth, rounding, duration = np.eye(len(factors[0].matrix)), 1.0, 0.0, 0.0
        for i in part:
            matrix = factors[i].matrix @ matrix
            growth = max(growth, float(np.linalg.norm(matrix, 2)))
            rounding += factors[i].rounding
            duration += factors[i].duration
        groups.append(Factor(matrix, growth * rounding, growth * duration))
    return groups


def _at_the_end(
    groups: list[Factor], weights: tuple[float, float], to: FloatArray | None = None, start: FloatArray | None = None
) -> float:
    """Return what errors made in the groups amount to at the end: ``weights`` times rounding and duration."""
    N = len(groups[0].matrix)
    before = [np.eye(N) if start is None else start]
    for group in groups[:-1]:
        before.append(group.matrix @ before[-1])
    after = [np.eye(N) if to is None else to]
    for group in groups[:0:-1]:
        after.append(after[-1] @ group.matrix)
    return sum(
        float(np.linalg.norm(b)) * float(np.linalg.norm(a, 2)) * (weights[0] * g.rounding + weights[1] * g.duration)
        for b, a, g in zip(before, reversed(after), groups, strict=True)
    )
