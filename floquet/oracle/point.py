"""The monodromy matrix at one point (Omega, eps): plain, accurate, and with its error. The oracle of the charts."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from itertools import accumulate, pairwise
from typing import NamedTuple

import numpy as np
import scipy.linalg as sla

from floquet.kind import Kind
from floquet.oracle.multipliers import combine, spectrum
from floquet.oracle.reduction import Reduction, reduce_system
from floquet.oracle.taylor import LARGEST, OVERFLOWN, UNIT, integrate
from periodic import PeriodicSystem, SystemFamily, member_at
from periodic.checks import ComplexArray, FloatArray, real_number

TOLERANCE = 1e-11
# Length of a step times the rate of the fastest motion. Longer steps need fewer terms in all (8.0 per radian at 4,
# 6.4 at 6, 5.6 at 8), but cancellation between terms as large as exp(6) costs digits.
STEP = 6.0
TERMS = 40  # that a step of this length needs, about
ORDER = 80  # never reached, unless the rate were wrong
HALVINGS = 3  # of the step, while that helps
SEGMENTS = 32  # of a period, at the ends of which growth is measured, with this tolerance
COARSE = 1e-2
PROBES = 8  # solutions that are integrated again with half the step, and with series as long as float64 can use:
FINEST = UNIT / 16
# What a term costs: a call, and 2 floating-point operations an entry at a moderate speed. Longer than this is refused.
SECONDS_A_TERM, SECONDS_A_FLOP, MOST_SECONDS = 2e-6, 1e-10, 300.0


@dataclass(frozen=True, eq=False)
class Monodromy:
    """The monodromy matrix of a system at one (Omega, eps), its multipliers and the verdict.

    Attributes
    ----------
    matrix : ndarray, shape (2n, 2n)
        Phi(T), T = 2 pi / Omega, in the coordinates q = (W', W) of eq. (13).
    multipliers : ndarray of complex, shape (2n,)
        Eigenvalues of ``matrix`` by decreasing modulus. Those of a stable conservative or reversible system are on the
        unit circle.
    growth_rate : float
        max log|mu| / T, per unit of time; 0 for a stable conservative system.
    error : float
        Estimated spectral norm of the error of ``matrix``, divided by max(1, norm of ``matrix``).
    log_modulus_error : float
        Estimated error of max log|mu| = growth_rate T; near a double multiplier of the order of the square root of
        ``error``.
    kind : Kind
        Stable, unstable through a multiplier near +1, near -1 or a complex pair, or undecided.
    """

    matrix: FloatArray
    multipliers: ComplexArray
    growth_rate: float
    error: float
    log_modulus_error: float
    kind: Kind


class PeriodMap(NamedTuple):
    """Monodromy matrix of one subsystem in its energy coordinates, with the estimated Frobenius norms of its errors.

    ``error`` belongs to ``matrix``, ``error_in_q`` to the matrix in (W', W).
    """

    matrix: FloatArray
    error: float
    error_in_q: float


def monodromy(system: SystemFamily, Omega: float, eps: float, *, tolerance: float = TOLERANCE) -> Monodromy:
    """Integrate a periodic system over one period.

    Parameters
    ----------
    system : PeriodicSystem or SystemFamily
        The system, or a family, of which the member at ``Omega`` is taken.
    Omega : float
        Excitation frequency, > 0.
    eps : float
        Excitation amplitude, any sign.
    tolerance : float
        Wanted error of the matrix relative to max(1, its norm), between 1e-15 and 1e-3. Rounding may not allow it:
        ``Monodromy.error`` tells what was achieved.

    Returns
    -------
    Monodromy

    Raises
    ------
    ValueError
        If an argument is of the wrong type, not finite or out of range; if the solution grows by more than a factor of
        1e150 in one period; if the period is so long that the integration would take more than five minutes.

    Notes
    -----
    Taylor series of the solution in steps of equal length (`floquet.oracle.taylor`), each with as many terms as
    it needs. The error estimate is the difference from eight random solutions that are integrated once more with half
    the step, and what rounding in each part of the period amounts to at its end: two integrations may agree by chance.
    Nothing is shared with `stability_chart`.
    """
    Omega = real_number("Omega", Omega, positive=True)
    eps = real_number("eps", eps)
    tolerance = real_number("tolerance", tolerance, positive=True)
    if not 1e-15 <= tolerance <= 1e-3:
        raise ValueError(f"tolerance = {tolerance!r} is out of range; give a number from 1e-15 to 1e-3")
    member = member_at(system, Omega)
    subsystems = reduce_system(member, eps, Omega / (2 * np.pi))
    maps = [period_map(subsystem, Omega, eps, tolerance) for subsystem in subsystems]
    joint = combine(
        [
            spectrum(
                found.matrix,
                found.error,
                reciprocal=subsystem.reciprocal,
                bounded=subsystem.bounded,
                form=subsystem.form,
            )
            for subsystem, found in zip(subsystems, maps, strict=True)
        ]
    )
    matrix = np.sum(
        [subsystem.to_q @ found.matrix @ subsystem.from_q for subsystem, found in zip(subsystems, maps, strict=True)],
        axis=0,
    )
    error = np.linalg.norm([found.error_in_q for found in maps]) / max(1.0, float(np.linalg.norm(matrix, 2)))
    for array in (matrix, joint.multipliers):
        array.setflags(write=False)
    growth_rate = joint.log_modulus * Omega / (2 * np.pi)
    return Monodromy(matrix, joint.multipliers, growth_rate, float(error), joint.error, joint.kind)


@lru_cache(maxsize=16)
def _reduced(system: PeriodicSystem, eps: float, slowest: float) -> list[Reduction]:
    return reduce_system(system, eps, slowest)


def _subsystems(system: PeriodicSystem, Omega: float, eps: float) -> list[Reduction]:
    """Return the subsystems of a system; those of many points by a few reductions, at amplitudes that are powers of
    two.

    Scales and bounds are those of the amplitude that is at least as large.
    """
    above = float(np.copysign(2.0 ** np.ceil(np.log2(abs(eps))), eps)) if eps else 0.0
    scale = eps / above if above else 1.0
    subsystems = []
    for subsystem in _reduced(system, above, 2.0 ** np.floor(np.log2(Omega / (2 * np.pi)))):
        alpha = np.column_stack([subsystem.equations.alpha[:, :1], scale * subsystem.equations.alpha[:, 1:]])
        equations = subsystem.equations._replace(alpha=alpha, beta=scale * subsystem.equations.beta)
        subsystems.append(subsystem._replace(equations=equations))
    return subsystems


def is_unstable(family: SystemFamily, Omega: float, eps: float, modes: int = 0) -> bool:
    """Return whether integration finds instability at a point; the subsystem with so many ``modes`` is looked at first.

    The same series as in `monodromy`, at less than half the cost: their errors are taken to be what they aim at, and
    one unstable subsystem is enough.
    """
    subsystems = _subsystems(member_at(family, Omega), Omega, eps)
    for subsystem in sorted(subsystems, key=lambda subsystem: abs(len(subsystem.equations.w) - modes)):
        start = np.eye(2 * len(subsystem.equations.w))
        Phi = propagate(subsystem, Omega, eps, steps_of_period(subsystem, Omega), TOLERANCE, start)
        error = 10 * TOLERANCE * max(1.0, float(np.linalg.norm(Phi, 2)))
        found = spectrum(Phi, error, reciprocal=subsystem.reciprocal, bounded=subsystem.bounded, form=subsystem.form)
        if found.kind > Kind.STABLE:
            return True
    return False


def period_map(subsystem: Reduction, Omega: float, eps: float, tolerance: float) -> PeriodMap:
    """Integrate one subsystem over one period and estimate the error.

    Raises
    ------
    ValueError
        If the solution overflows or the integration would take too long (``Omega`` and ``eps`` are named).
    """
    m = len(subsystem.equations.w)
    probes, share = _probes(m)
    # norms of the two halves of from_q: how much of a disturbance of q each half of y receives
    receives = np.linalg.norm(np.stack(np.split(subsystem.from_q, 2)), 2, axis=(1, 2))
    steps = steps_of_period(subsystem, Omega)
    best = PeriodMap(np.eye(2 * m), np.inf, np.inf)
    for _ in range(HALVINGS + 1):
        period = _integrate_period(subsystem, Omega, eps, steps, tolerance)
        defect = period.matrix @ probes - propagate(subsystem, Omega, eps, 2 * steps, FINEST, probes)
        halves = np.stack(np.split(defect, 2, axis=1)) / np.sqrt(share)
        reducible = float(np.linalg.norm(halves)) + _at_the_end(period, period.rounding)
        # shorter steps do not help against rounding of the coefficients and what the reduction dropped
        fixed = (UNIT * subsystem.rate + subsystem.neglected) * period.durations
        error = reducible + _at_the_end(period, fixed)
        in_q = np.linalg.norm(subsystem.to_q @ halves, axis=(1, 2)) @ receives
        in_q += _at_the_end(period, period.rounding + fixed, subsystem.to_q, subsystem.from_q)
        if error > 0.5 * best.error:  # rounding rules
            break
        best = PeriodMap(period.matrix, float(error), float(in_q))
        if reducible <= max(tolerance * max(1.0, float(np.linalg.norm(period.matrix, 2))), error - reducible):
            break
        steps *= 2
    return best


class _Period(NamedTuple):
    """One period in S segments.

    ``before`` and ``after`` (S, 2m, 2m) lead from 0 to the beginning of each segment and, good to a few per cent, from
    its end to T. ``rounding`` (S,) are the rounding errors made in each, relative to its initial values;
    ``durations`` (S,) are in time. Both are multiplied by the growth within the segment.
    """

    matrix: FloatArray
    before: FloatArray
    after: FloatArray
    rounding: FloatArray
    durations: FloatArray


def _integrate_period(subsystem: Reduction, Omega: float, eps: float, steps: int, tolerance: float) -> _Period:
    unit = np.eye(2 * len(subsystem.equations.w))
    ends = np.unique(np.linspace(0, steps, SEGMENTS + 1).astype(int)).tolist()
    values, rounding, maps = [unit], [], []
    for segment in pairwise(ends):
        found, error = _integrate(subsystem, Omega, eps, steps, tolerance, values[-1], *segment)
        rounding.append(error / np.linalg.norm(values[-1]))
        values.append(found)
        maps.append(_integrate(subsystem, Omega, eps, steps, COARSE, unit, *segment)[0])
    after = list(accumulate(maps[::-1], np.matmul, initial=unit))
    if not np.abs(after).max() <= LARGEST:
        raise _overflow(Omega, eps)
    growth = np.maximum(1.0, np.linalg.norm(maps, 2, axis=(1, 2)))
    durations = 2 * np.pi / Omega * np.diff(ends) / steps
    return _Period(values[-1], np.array(values[:-1]), np.array(after[-2::-1]), growth * rounding, growth * durations)


def _at_the_end(
    period: _Period, errors: FloatArray, to: FloatArray | None = None, start: FloatArray | None = None
) -> float:
    """Return what relative errors (S,) made in the segments amount to at the end, as a bound of the Frobenius norm.

    A relative error E made at time t arrives as Phi(T, t) E Phi(t, 0). Where growth in one part of a period is undone
    in another, the product of the two norms exceeds that of Phi(T, 0) by orders of magnitude, and only chance would
    show it in the difference of two integrations.
    """
    after = period.after if to is None else to @ period.after
    before = period.before if start is None else period.before @ start
    return float(np.sum(np.linalg.norm(after, 2, axis=(1, 2)) * errors * np.linalg.norm(before, axis=(1, 2))))


def steps_of_period(subsystem: Reduction, Omega: float) -> int:
    """Return the number of equal steps of one period, before any halving.

    Raises
    ------
    ValueError
        If they would take too long.
    """
    m, harmonics = len(subsystem.equations.w), subsystem.equations.alpha.shape[1] - 1
    steps = np.ceil(2 * np.pi * (subsystem.rate / Omega + harmonics) / STEP)
    seconds = steps * TERMS * (SECONDS_A_TERM + 4 * m * subsystem.equations.S.size * SECONDS_A_FLOP)
    if not seconds <= MOST_SECONDS:
        raise ValueError(
            f"Omega = {Omega!r} means {steps:.2g} steps in one period, about {seconds:.2g} s; "
            "give a larger Omega or a smaller eps"
        )
    return int(steps)


def _probes(m: int) -> tuple[FloatArray, int]:
    """Return initial values (2m, columns), half of them in y1 and half in y2, and how many columns stand for each half.

    The squared norm of a matrix times a normally distributed vector is on average its squared Frobenius norm. The
    seed is fixed: a point has the same error estimate in every run.
    """
    if 2 * m <= PROBES:
        return np.eye(2 * m), 1
    share = PROBES // 2
    values = np.random.default_rng(0).standard_normal((2, m, share))
    return np.asarray(sla.block_diag(*values)), share


def propagate(
    subsystem: Reduction, Omega: float, eps: float, steps: int, tolerance: float, start: FloatArray
) -> FloatArray:
    """Return the values after one period of the solutions that begin with the columns of ``start`` (2m, columns)."""
    return _integrate(subsystem, Omega, eps, steps, tolerance, start, 0, steps)[0]


def _integrate(
    subsystem: Reduction,
    Omega: float,
    eps: float,
    steps: int,
    tolerance: float,
    start: FloatArray,
    first: int,
    last: int,
) -> tuple[FloatArray, float]:
    """Return the values that ``start`` at step ``first`` has become at step ``last``, and their rounding errors."""
    m = len(subsystem.equations.w)
    y1, y2 = start[:m].copy(), start[m:].copy()
    local = max(0.1 * tolerance / steps, FINEST)
    status, rounding = integrate(subsystem.equations, Omega, steps, first, last, ORDER, local, y1, y2)
    if status == OVERFLOWN:
        raise _overflow(Omega, eps)
    return np.concatenate([y1, y2]), rounding


def _overflow(Omega: float, eps: float) -> ValueError:
    return ValueError(
        f"eps = {eps!r} at Omega = {Omega!r}: the solution grows by more than {LARGEST:.0e} in one period; "
        "give a smaller eps or a larger Omega"
    )
