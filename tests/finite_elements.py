"""Finite-element models as users bring them: many coordinates, and modes far above any window."""

from __future__ import annotations

import numpy as np

from periodic import PeriodicSystem


def column(elements: int, *, force: float = 1.0, damping: float = 1e-5) -> PeriodicSystem:
    """Return a cantilever column under the axial force ``force + eps cos(Omega t)``, two coordinates an element.

    Length, mass and bending stiffness are one; cubic elements. Damping is that part of the bending stiffness.
    """
    h = 1.0 / elements
    l = np.array([1.0, h, 1.0, h])
    mass = h / 420 * np.array([[156, 22, 54, -13], [22, 4, 13, -3], [54, 13, 156, -22], [-13, -3, -22, 4]])
    bending = np.array([[12, 6, -12, 6], [6, 4, -6, 2], [-12, -6, 12, -6], [6, 2, -6, 4]]) / h**3
    axial = np.array([[36, 3, -36, 3], [3, 4, -3, -1], [-36, -3, 36, -3], [3, -1, -3, 4]]) / (30 * h)
    M, K, S = np.zeros((3, 2 * elements + 2, 2 * elements + 2))
    for e in range(elements):
        at = slice(2 * e, 2 * e + 4)
        for whole, part in ((M, mass), (K, bending), (S, axial)):
            whole[at, at] += part * np.outer(l, l)
    M, K, S = M[2:, 2:], K[2:, 2:], S[2:, 2:]  # clamped at the first node
    return PeriodicSystem(M, np.zeros_like(M), damping * K, K - force * S, [-S])
