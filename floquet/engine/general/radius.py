"""How fast y' = z X y can grow, |z| = 1: the numerical radius of X, bounded."""

from __future__ import annotations

import math

import numpy as np

from periodic.checks import FloatArray

# Part of the bound by which it may exceed that of the matrix itself, if it follows from that of a like matrix.
MAX_LOOSENESS = 0.03


def numerical_radius(X: FloatArray) -> float:
    """Return a bound on the rate at which y' = z X y makes |y| grow, for any complex z of modulus one.

    It is (|X| + |X^2|^(1/2)) / 2 (F. Kittaneh, Studia Mathematica 158 (2003) 11-17): |X| / 2 for a force that depends
    on places alone, |X| for damping.
    """
    square = X @ X
    return float(np.linalg.norm(X, 2) + (math.sqrt(np.linalg.norm(square, 2)) if square.any() else 0.0)) / 2


class Radii:
    """Bounds for matrices that are given again and again, somewhat changed.

    A matrix c X + D has at most |c| times the radius of X, and the norm of D. So most bounds follow from that of a
    matrix before, and cost no singular values.
    """

    def __init__(self) -> None:
        self._known: dict[object, tuple[FloatArray, float]] = {}

    def bound(self, name: object, X: FloatArray) -> float:
        """Return a bound on the numerical radius of ``X``; ``name`` tells which matrices are alike."""
        if name in self._known:
            Y, radius = self._known[name]
            square = float(np.vdot(Y, Y))
            if X.shape == Y.shape and square > 0:
                factor = float(np.vdot(Y, X)) / square
                rest = float(np.linalg.norm(X - factor * Y))
                if rest <= MAX_LOOSENESS * abs(factor) * radius:
                    return abs(factor) * radius + rest
        found = numerical_radius(X)
        self._known[name] = X, found
        return found
