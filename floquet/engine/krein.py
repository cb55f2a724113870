"""A second look at cells of a conservative subsystem that the gaps between multipliers leave undecided.

Multipliers leave the unit circle only by meeting. The error E of a cell allows two multipliers to meet if they are
less than a few sqrt(E) apart, but close multipliers need not be about to meet. Near a meeting their eigenvectors become
parallel; far from it each multiplier moves in proportion to the error of the matrix. Krein's form tells how far. For an
eigenvector v of a symplectic matrix, J v is the left eigenvector, so that the condition number of mu is 1 / |v^H J v|
for |v| = 1 (V. A. Yakubovich and V. M. Starzhinskii, Linear Differential Equations with Periodic Coefficients, 1975,
chapter III). It is one for a rotation, and infinite where two multipliers of opposite sign meet and off the circle.
Eigenvectors would take too long for every cell of a chart, but not for these few.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from periodic.checks import FloatArray

# Shift of a multiplier, as a part of its distance to the nearest other, within which the two do not meet.
MAX_SHIFT_PART = 0.1


def held_apart(Phi: FloatArray, E: FloatArray) -> NDArray[np.bool_]:
    """Return whether the multipliers of symplectic matrices (k, 2n, 2n) are on the unit circle and cannot meet, (k,).

    ``E`` (k,) bounds the products of shift and gap. 2n multipliers are typically pi / n apart, so that the shifts are
    E n / pi times the condition number.
    """
    n = Phi.shape[1] // 2
    mu, V = np.linalg.eig(Phi)
    condition = 1 / np.maximum(2 * np.abs((V[:, :n].conj() * V[:, n:]).sum(axis=1).imag), np.finfo(float).tiny)
    distances = np.abs(mu[:, :, None] - mu[:, None, :])
    distances[:, np.arange(2 * n), np.arange(2 * n)] = np.inf
    with np.errstate(over="ignore"):  # off the circle the condition is infinite
        shifts = condition * (E * max(n / np.pi, 1))[:, None]
    return np.asarray((shifts <= MAX_SHIFT_PART * distances.min(axis=2)).all(axis=1))
