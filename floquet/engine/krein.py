"""A second look at cells of a conservative subsystem that the gaps between multipliers leave undecided.

Multipliers leave the unit circle only by meeting, and the error E of a cell allows those to meet that are less than a
few sqrt(E) apart. But they need not be about to: near a meeting their eigenvectors become parallel, and far from it
each multiplier moves in proportion to the error of the matrix. How far follows from Krein's form. For an eigenvector v
of a symplectic matrix J v is the left one, so that the condition number of mu is 1 / |v^H J v| for |v| = 1 (V. A.
Yakubovich and V. M. Starzhinskii, Linear Differential Equations with Periodic Coefficients, 1975, chapter III): one for
a rotation, infinite where two of opposite sign meet, and off the circle. Eigenvectors are too dear for every cell of a
chart, but not for these few.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from periodic.checks import FloatArray

# A multiplier that stays within this part of the way to the nearest other does not meet it.
PART_OF_THE_WAY = 0.1


def held_apart(Phi: FloatArray, E: FloatArray) -> NDArray[np.bool_]:
    """Return whether the multipliers of symplectic matrices (k, 2n, 2n) are on the unit circle and cannot meet, (k,).

    ``E`` (k,) is what shifts of multipliers, times the gaps to their neighbours, may amount to. Typically 2n of them
    are pi / n apart, so that the shifts are E n / pi, times the condition number.
    """
    n = Phi.shape[1] // 2
    mu, V = np.linalg.eig(Phi)
    condition = 1 / np.maximum(2 * np.abs((V[:, :n].conj() * V[:, n:]).sum(axis=1).imag), np.finfo(float).tiny)
    distances = np.abs(mu[:, :, None] - mu[:, None, :])
    distances[:, np.arange(2 * n), np.arange(2 * n)] = np.inf
    with np.errstate(over="ignore"):  # off the circle the condition is infinite
        shifts = condition * (E * max(n / np.pi, 1))[:, None]
    return np.asarray((shifts <= PART_OF_THE_WAY * distances.min(axis=2)).all(axis=1))
