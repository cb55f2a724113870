"""Interpolation in phase and in amplitude: how many samples an entire function needs, and the weights they get."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike

from periodic.checks import FloatArray

# Half-widths eta of strips in the complex plane that `degree` tries, for a single harmonic.
STRIP_WIDTHS = np.geomspace(0.02, 40, 80)


@lru_cache(maxsize=4096)
def degree(x: tuple[float, ...], tolerance: float) -> int:
    """Return the degree beyond which the Fourier coefficients of exp(sum_j x_j cos j z) are below ``tolerance``.

    In the strip |Im z| <= eta the function is at most exp(sum_j x_j cosh j eta). Its coefficient of degree q is
    therefore at most exp(-q eta) times that, for every eta (L. N. Trefethen, Approximation Theory and Approximation
    Practice, 2013, chapter 8). The same holds for the Chebyshev coefficients of exp(x_1 z).
    """
    j = np.arange(1, len(x) + 1)
    eta = STRIP_WIDTHS / len(x)
    bound = np.array(x) @ np.cosh(np.outer(j, eta)) + math.log(2 / tolerance)
    return int(np.ceil((bound / eta).min())) - 1


@lru_cache(maxsize=256)
def chebyshev_points(m: int) -> FloatArray:
    """Return the m zeros of the Chebyshev polynomial T_m."""
    points = np.cos((2 * np.arange(m) + 1) * np.pi / (2 * m))
    points.setflags(write=False)
    return points


def chebyshev_weights(m: int, x: ArrayLike) -> FloatArray:
    """Return the matrix (len(x), m) that takes values at the m Chebyshev points to their interpolant at x."""
    order = np.arange(m)
    coefficients = np.cos(np.outer(order, np.arccos(chebyshev_points(m)))) * (2 / m)
    coefficients[0] /= 2
    return np.cos(np.outer(np.arccos(np.clip(x, -1, 1)), order)) @ coefficients


def trigonometric_weights(p: int, theta: ArrayLike) -> FloatArray:
    """Return the matrix (len(theta), p) that takes values at the phases 2 pi i / p to their interpolant at theta.

    p is odd.
    """
    half = np.asarray(theta)[:, None] / 2 - np.pi * np.arange(p) / p
    half -= np.pi * np.round(half / np.pi)  # the kernel has this period; now it is 0 / 0 only at 0
    with np.errstate(invalid="ignore"):
        # Dirichlet's kernel, 1 + 2 cos 2 half + ... + 2 cos (p - 1) half, in closed form
        return np.where(half == 0, 1.0, np.sin(p * half) / (p * np.sin(half)))


def exact_for_constants(weights: FloatArray) -> FloatArray:
    """Return ``weights`` (wanted, samples) with rows that sum to one: the largest weight of each row is corrected.

    A step is so short that most of it is the same for all phases and amplitudes. Errors of the sums would add up from
    step to step.
    """
    if weights.size:
        rows, largest = np.arange(len(weights)), np.abs(weights).argmax(axis=1)
        weights[rows, largest] -= weights.sum(axis=1) - 1
    return weights
