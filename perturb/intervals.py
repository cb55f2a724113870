"""The unstable interval of a resonant pair among further resonant states, by root-finding."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from periodic.checks import FloatArray
from perturb.expansion import SMALLEST_NORMAL, EffectiveMatrix

# Samples of Omega across the window in which the pair can be unstable. Wider intervals than their spacing are seen
# directly. A narrower one is found because the exponents of the pair change places in it.
INTERVAL_SAMPLES = 81

# Real parts of exponents that coalesce without damping are exact to this part of the largest coupling only, the square
# root of rounding.
COALESCENCE_ROUNDING = 1e-7

# Bisections that take the spacing of the samples down to rounding; and down to the width of the narrowest region that
# stands out from `COALESCENCE_ROUNDING`.
EDGE_BISECTIONS = 48
EXCHANGE_BISECTIONS = 24

# A growing solution belongs to a pair if both states of the pair have at least this part of the squared modulus of
# every other state in it. Where regions merge, a solution may belong to several pairs.
OWN_SHARE = 0.5


class Exponents(NamedTuple):
    """What the exponents of the resonant states say at each point (x, eps)."""

    growth: FloatArray  # largest real part
    share: FloatArray  # of the pair in a growing solution, relative to the strongest other state; 0 if none grows
    above: NDArray[np.bool_]  # the exponent of the first state lies above that of the second


def unstable_intervals(matrix: EffectiveMatrix, eps: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the unstable interval of x = Omega - centre in which a solution of the pair grows.

    The pair is the first two states of ``matrix``. The interval includes the region of another pair that has merged
    with theirs, or that lies closer to it than the samples can tell.

    Parameters
    ----------
    matrix : EffectiveMatrix
    eps : ndarray, shape (k,)

    Returns
    -------
    lower, upper : ndarray, shape (k,)
        NaN if there is none, infinite where it reaches beyond the frequencies at which the states can be in resonance.
        Of several intervals, the one in which the pair has the largest share.
    """
    if not len(eps):
        return eps, eps
    strength = sum(np.abs(eps[:, None, None]) ** n * np.abs(power) for n, power in enumerate(matrix.powers))
    reach = np.sum(strength, axis=-1).max(axis=-1)  # no exponent moves further than this (Gershgorin)
    threshold = COALESCENCE_ROUNDING * reach * (np.diagonal(matrix.powers[0]).real == 0).any()
    steps = np.abs(np.subtract.outer(matrix.states[:, 1], matrix.states[:, 1]))
    window = 3 * reach / steps[0, 1]  # beyond this the pair is out of resonance
    beyond = (
        window + 3 * (reach + np.abs(matrix.detuning).max()) / steps[steps > 0].min()
    )  # and beyond this all states are
    x = np.column_stack([-beyond, np.linspace(-window, window, INTERVAL_SAMPLES, axis=1), beyond])
    at = _exponents(matrix, x, eps[:, None], threshold[:, None])
    x, at = _with_exchanges(matrix, x, eps, threshold, at)

    lower, upper = np.full(len(eps), np.nan), np.full(len(eps), np.nan)
    stable = np.full((2, len(eps)), np.nan)  # next to the lower and to the upper edge
    for k in range(len(eps)):
        unstable = np.concatenate([[False], at.growth[k] > threshold[k], [False]])
        first, stop = np.flatnonzero(unstable[1:] & ~unstable[:-1]), np.flatnonzero(unstable[:-1] & ~unstable[1:])
        share = [float(at.share[k, a:b].max()) for a, b in zip(first, stop, strict=True)]
        if max(share, default=0.0) >= OWN_SHARE:
            a, b = first[np.argmax(share)], stop[np.argmax(share)]
            lower[k], upper[k] = x[k, a], x[k, b - 1]
            stable[0, k] = x[k, a - 1] if a > 0 else -np.inf
            stable[1, k] = x[k, b] if b < x.shape[1] else np.inf
    return _bisect(matrix, eps, threshold, stable[0], lower), _bisect(matrix, eps, threshold, stable[1], upper)


def _with_exchanges(
    matrix: EffectiveMatrix, x: FloatArray, eps: FloatArray, threshold: FloatArray, at: Exponents
) -> tuple[FloatArray, Exponents]:
    """Add to the samples the points at which the exponents of the pair change places and one of them grows."""
    row, left = np.nonzero(at.above[:, :-1] != at.above[:, 1:])
    low, high, above = x[row, left], x[row, left + 1], at.above[row, left]
    found: list[list[float]] = [[] for _ in eps]
    for _ in range(EXCHANGE_BISECTIONS):
        if not len(row):
            break
        middle = 0.5 * (low + high)
        between = _exponents(matrix, middle, eps[row], threshold[row])
        hit = between.share >= OWN_SHARE
        for k, value in zip(row[hit], middle[hit], strict=True):
            found[k].append(value)
        same = between.above == above
        low, high = np.where(same, middle, low), np.where(same, high, middle)
        row, low, high, above = row[~hit], low[~hit], high[~hit], above[~hit]
    added = np.repeat(x[:, :1], max(map(len, found)), axis=1)  # rows with fewer points repeat their first sample
    for k, values in enumerate(found):
        added[k, : len(values)] = values
    extra = _exponents(matrix, added, eps[:, None], threshold[:, None])
    x = np.concatenate([x, added], axis=1)
    order = np.argsort(x, axis=1, kind="stable")
    fields = (np.concatenate(pair, axis=1) for pair in zip(at, extra, strict=True))
    return np.take_along_axis(x, order, 1), Exponents(*(np.take_along_axis(field, order, 1) for field in fields))


def _exponents(matrix: EffectiveMatrix, x: FloatArray, eps: FloatArray, threshold: FloatArray) -> Exponents:
    values, vectors = np.linalg.eig(matrix.at(x, eps))
    size = np.abs(vectors) ** 2  # [..., state, exponent]
    of_level = matrix.same @ size
    others = ~matrix.same[:2].any(axis=0)
    rivals = of_level[..., others, :].max(axis=-2, initial=SMALLEST_NORMAL)
    share = np.where(values.real > threshold[..., None], of_level[..., :2, :].min(axis=-2) / rivals, 0.0)
    strongest = np.argmax(size[..., :2, :], axis=-1)  # the exponent that each state of the pair shares most
    height = np.take_along_axis(values.imag, strongest, axis=-1)
    return Exponents(values.real.max(axis=-1), share.max(axis=-1), height[..., 0] > height[..., 1])


def _bisect(
    matrix: EffectiveMatrix, eps: FloatArray, threshold: FloatArray, stable: FloatArray, unstable: FloatArray
) -> FloatArray:
    """Return the edges between points ``stable`` and ``unstable``; what is not finite stays as it is in ``stable``."""
    edge = stable.copy()
    at = np.isfinite(stable)
    eps, threshold, stable, unstable = eps[at], threshold[at], stable[at], unstable[at]
    for _ in range(EDGE_BISECTIONS if len(eps) else 0):
        middle = 0.5 * (stable + unstable)
        grows = np.linalg.eigvals(matrix.at(middle, eps)).real.max(axis=-1) > threshold
        stable, unstable = np.where(grows, stable, middle), np.where(grows, middle, unstable)
    edge[at] = 0.5 * (stable + unstable)
    return edge
