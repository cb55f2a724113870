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

# A growing solution belongs to the pair if the squared moduli of both its states are at least this part of that of
# every other state. Where regions merge, a solution may belong to several pairs.
SHARE = 0.5

# Stands for zero in a quotient.
TINY = np.finfo(float).tiny


class Exponents(NamedTuple):
    """What the exponents of a block say at each x."""

    growth: FloatArray  # largest real part
    share: FloatArray  # of the pair in a growing solution, relative to the strongest other state; 0 if none grows
    above: NDArray[np.bool_]  # the exponent of the first state lies above that of the second


def block_interval(block: EffectiveBlock, eps: float) -> tuple[float, float]:
    """Return the unstable interval of x = Omega - centre in which a solution of the pair grows.

    The pair are the first two states of ``block``. A region of another pair that has merged with theirs is part of the
    interval.

    Returns
    -------
    lower, upper : float
        NaN if there is none; infinite where it reaches the end of the window in which the pair can be in resonance.
        Of several intervals the one in which the pair has the largest share.
    """
    strength = np.abs(block.powers[0]) + abs(eps) * np.abs(block.powers[1]) + eps**2 * np.abs(block.powers[2])
    reach = float(strength.sum(axis=1).max())  # no exponent moves further than this (Gershgorin)
    if reach == 0:
        return np.nan, np.nan
    threshold = COALESCENCE * reach if (np.diagonal(block.powers[0]).real == 0).any() else 0.0
    steps = np.abs(np.subtract.outer(block.states[:, 1], block.states[:, 1]))
    window = 3 * reach / steps[steps > 0].min()
    x = np.linspace(-window, window, SAMPLES)
    x = np.sort(np.concatenate([x, _exchanges(block, x, eps, threshold)]))

    at = _exponents(block, x, eps, threshold)
    unstable = np.concatenate([[False], at.growth > threshold, [False]])
    first, stop = np.flatnonzero(unstable[1:] & ~unstable[:-1]), np.flatnonzero(unstable[:-1] & ~unstable[1:])
    share = [float(at.share[a:b].max()) for a, b in zip(first, stop, strict=True)]
    if max(share, default=0.0) < SHARE:
        return np.nan, np.nan
    chosen = int(np.argmax(share))
    a, b = first[chosen], stop[chosen]
    lower = -np.inf if a == 0 else _bisect(block, eps, threshold, stable=x[a - 1], unstable=x[a])
    upper = np.inf if b == len(x) else _bisect(block, eps, threshold, stable=x[b], unstable=x[b - 1])
    return lower, upper


def _exchanges(block: EffectiveBlock, x: FloatArray, eps: float, threshold: float) -> FloatArray:
    """Return points between those of ``x`` at which the exponents of the pair change places and one of them grows."""
    above = _exponents(block, x, eps, threshold).above
    left = np.flatnonzero(above[:-1] != above[1:])
    low, high, found = x[left], x[left + 1], np.full(len(left), np.nan)
    for _ in range(BISECTIONS if len(left) else 0):
        middle = 0.5 * (low + high)
        at = _exponents(block, middle, eps, threshold)
        found = np.where(at.share >= SHARE, middle, found)
        same = at.above == above[left]
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    return found[~np.isnan(found)]


def _exponents(block: EffectiveBlock, x: FloatArray, eps: float, threshold: float) -> Exponents:
    values, vectors = np.linalg.eig(block.matrix(x, np.full_like(x, eps)))
    size = np.abs(vectors) ** 2  # [..., state, exponent]
    of_level = block.same @ size
    others = ~block.same[:2].any(axis=0)
    share = of_level[:, :2].min(axis=1) / np.maximum(of_level[:, others].max(axis=1, initial=0.0), TINY)
    strongest = np.argmax(size[:, :2], axis=-1)  # the exponent each state of the pair takes part in most
    height = np.take_along_axis(values.imag, strongest, axis=-1)
    return Exponents(
        growth=values.real.max(axis=-1),
        share=np.where(values.real > threshold, share, 0.0).max(axis=-1),
        above=height[:, 0] > height[:, 1],
    )


def _bisect(block: EffectiveBlock, eps: float, threshold: float, stable: float, unstable: float) -> float:
    for _ in range(BISECTIONS):
        middle = 0.5 * (stable + unstable)
        growth = np.linalg.eigvals(block.matrix(np.array(middle), np.array(eps))).real.max()
        stable, unstable = (stable, middle) if growth > threshold else (middle, unstable)
    return 0.5 * (stable + unstable)
