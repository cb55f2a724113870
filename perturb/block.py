"""The unstable interval of a pair of states inside a larger block of near-resonant states, by root-finding."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from periodic.checks import FloatArray
from perturb.expansion import EffectiveBlock

# Samples of Omega across the window in which the pair can be unstable. Intervals wider than the spacing are seen
# directly, narrower ones because the exponents of the pair change places in them.
SAMPLES = 161

# Where two exponents of an undamped block coalesce, their real parts are exact to the square root of rounding only.
COALESCENCE = 1e-7

# Bisections that take the spacing of the samples down to rounding.
BISECTIONS = 48

# A growing solution belongs to the pair if no other level takes part more than its two, up to so much for ties.
TIE = 0.99


class Exponents(NamedTuple):
    """What the exponents of a block say at each x."""

    growth: FloatArray  # largest real part
    shared: NDArray[np.bool_]  # the fastest growing solution belongs to the pair
    above: NDArray[np.bool_]  # the exponent of the first state lies above that of the second


def block_interval(block: EffectiveBlock, eps: float) -> tuple[float, float]:
    """Return the interval of x = Omega - centre in which the first two states of ``block`` are unstable together.

    Returns
    -------
    lower, upper : float
        NaN if there is none; infinite where it reaches the end of the window in which the pair can be in resonance.
        Where several belong to the pair, the one with the fastest growth.
    """
    strength = np.abs(block.powers[0]) + abs(eps) * np.abs(block.powers[1]) + eps**2 * np.abs(block.powers[2])
    reach = float(strength.sum(axis=1).max())  # no exponent moves further than this (Gershgorin)
    if reach == 0:
        return np.nan, np.nan
    threshold = COALESCENCE * reach if (np.diagonal(block.powers[0]).real == 0).any() else 0.0
    window = 3 * reach / abs(block.states[0, 1] - block.states[1, 1])
    x = np.linspace(-window, window, SAMPLES)
    x = np.sort(np.concatenate([x, _exchanges(block, x, eps, threshold)]))

    at = _exponents(block, x, eps)
    unstable = np.concatenate([[False], at.growth > threshold, [False]])
    first, stop = np.flatnonzero(unstable[1:] & ~unstable[:-1]), np.flatnonzero(unstable[:-1] & ~unstable[1:])
    own = [(a, b) for a, b in zip(first, stop, strict=True) if at.shared[a:b].any()]
    if not own:
        return np.nan, np.nan
    a, b = max(own, key=lambda run: at.growth[slice(*run)].max())
    lower = -np.inf if a == 0 else _bisect(block, eps, threshold, stable=x[a - 1], unstable=x[a])
    upper = np.inf if b == len(x) else _bisect(block, eps, threshold, stable=x[b], unstable=x[b - 1])
    return lower, upper


def _exchanges(block: EffectiveBlock, x: FloatArray, eps: float, threshold: float) -> FloatArray:
    """Return unstable points between stable neighbours in ``x``, where the exponents of the pair change places."""
    at = _exponents(block, x, eps)
    stable = at.growth <= threshold
    left = np.flatnonzero(stable[:-1] & stable[1:] & (at.above[:-1] != at.above[1:]))
    low, high, found = x[left], x[left + 1], np.full(len(left), np.nan)
    for _ in range(BISECTIONS if len(left) else 0):
        middle = 0.5 * (low + high)
        between = _exponents(block, middle, eps)
        found = np.where(between.growth > threshold, middle, found)
        same = between.above == at.above[left]
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    return found[~np.isnan(found)]


def _exponents(block: EffectiveBlock, x: FloatArray, eps: float) -> Exponents:
    values, vectors = np.linalg.eig(block.matrix(x, np.full_like(x, eps)))
    share = np.abs(vectors) ** 2  # [..., state, exponent]
    fastest = np.argmax(values.real, axis=-1)
    of_fastest = np.take_along_axis(share, fastest[:, None, None], axis=-1)[..., 0] @ block.same
    others = ~block.same[:, :2].any(axis=1)
    strongest = np.argmax(share[:, :2], axis=-1)  # the exponent each state of the pair takes part in most
    height = np.take_along_axis(values.imag, strongest, axis=-1)
    return Exponents(
        growth=values.real.max(axis=-1),
        shared=of_fastest[:, :2].min(axis=-1) >= TIE * of_fastest[:, others].max(axis=-1, initial=0.0),
        above=height[:, 0] > height[:, 1],
    )


def _bisect(block: EffectiveBlock, eps: float, threshold: float, stable: float, unstable: float) -> float:
    for _ in range(BISECTIONS):
        middle = 0.5 * (stable + unstable)
        growth = np.linalg.eigvals(block.matrix(np.array(middle), np.array(eps))).real.max()
        stable, unstable = (stable, middle) if growth > threshold else (middle, unstable)
    return 0.5 * (stable + unstable)
