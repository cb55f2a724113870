"""The monodromy matrix of one subsystem as a product of matrices of moderate condition.

The matrix of a whole period says nothing about solutions that decay below the rounding of those that grow. In short
parts of the period all solutions are of similar size.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from floquet.oracle.period import FINEST_SERIES_TOLERANCE, integrate_steps, probe_solutions, steps_of_period
from floquet.oracle.products import ProductEigenvalues, product_eigenvalues
from floquet.oracle.reduction import Subsystem
from floquet.oracle.taylor import MACHINE_EPSILON
from periodic.checks import FloatArray

# Number of parts of a period: at first, and at most. A solution that float64 can hold at the end of a period shrinks by
# less than 1e-5 in the average of 64 parts, so that rounding leaves enough of it.
FIRST_PARTS, MAX_PARTS = 64, 256
# Steps are shorter than those of the period map by this factor: series with smaller terms round less.
STEP_REFINEMENT = 2


def accurate_multipliers(subsystem: Subsystem, Omega: float, eps: float, tolerance: float) -> ProductEigenvalues:
    """Return the multipliers of one subsystem, small ones as accurate as large ones.

    The period is cut into twice as many parts until the errors, relative to the moduli, are below ``tolerance``.

    Raises
    ------
    ValueError
        If the solution overflows or the integration would take too long; the message names ``Omega`` and ``eps``.
    """
    parts = FIRST_PARTS
    while True:
        found = product_eigenvalues(*period_factors(subsystem, Omega, eps, parts))
        parts *= 2
        if found.errors[found.values != 0].max(initial=0.0) <= tolerance or parts > MAX_PARTS:
            return found


def period_factors(
    subsystem: Subsystem, Omega: float, eps: float, parts: int
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Integrate one subsystem over ``parts`` of a period, as accurately as float64 allows.

    Returns
    -------
    factors : ndarray, shape (parts, 2m, 2m)
        In energy coordinates, y(T) = factors[-1] @ ... @ factors[0] @ y(0).
    rounding, systematic : ndarray, shape (parts,)
        Estimated Frobenius norms of their errors: of the integration, and of the equations, which are the same in all.

    Raises
    ------
    ValueError
        If the solution overflows or the integration would take too long; the message names ``Omega`` and ``eps``.
    """
    m = len(subsystem.equations.w)
    unit = np.eye(2 * m)
    start, share = probe_solutions(m)
    steps = max(STEP_REFINEMENT * steps_of_period(subsystem, Omega), parts)
    ends = np.linspace(0, steps, parts + 1).astype(int).tolist()
    factors, roundings, systematic = [], [], []
    for first, last in pairwise(ends):
        factor, rounding = integrate_steps(subsystem, Omega, eps, steps, FINEST_SERIES_TOLERANCE, unit, first, last)
        again, _ = integrate_steps(
            subsystem, Omega, eps, 2 * steps, FINEST_SERIES_TOLERANCE, start, 2 * first, 2 * last
        )
        growth = max(1.0, float(np.linalg.norm(factor, 2)))
        duration = 2 * np.pi / Omega * (last - first) / steps
        defect = float(np.linalg.norm(factor @ start - again)) / np.sqrt(share)
        factors.append(factor)
        roundings.append(defect + growth * rounding)
        systematic.append(growth * duration * (MACHINE_EPSILON * subsystem.rate + subsystem.neglected))
    return np.array(factors), np.array(roundings), np.array(systematic)
