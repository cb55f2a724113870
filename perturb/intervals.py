"""Unstable intervals of several states that resonate together, by root-finding on their exponents."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from periodic.checks import FloatArray
from perturb.effective_matrix import SMALLEST_NORMAL, EffectiveMatrix

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


# Couplings of two resonances that differ by less than this part are equally strong.
EQUAL_STRENGTH = 1e-6


class Pair(NamedTuple):
    """Two states of an effective matrix that make a resonance: their places in it, and the numbers of their modes."""

    first: int
    second: int
    p: int
    q: int

    @property
    def is_main(self) -> bool:
        """Whether the resonance is one 2 omega_p."""
        return self.p == self.q


class Exponents(NamedTuple):
    """What the exponents of the resonant states say at each point (x, eps)."""

    growing: NDArray[np.intp]  # number of growing solutions
    share: FloatArray  # [..., pair]: of the pair in a growing solution, over the strongest other state; 0 if none grows
    above: NDArray[np.bool_]  # the exponent of the first state of the first pair lies above that of the second


class Search:
    """The search for the unstable intervals of one effective matrix at several eps.

    Parameters
    ----------
    matrix : EffectiveMatrix
    pairs : sequence of Pair
        The resonances that the states make; the first one is the resonance whose region is sought.
    eps : ndarray, shape (k,)
    """

    def __init__(self, matrix: EffectiveMatrix, pairs: Sequence[Pair], eps: FloatArray) -> None:
        self._matrix = matrix
        self._pairs = pairs
        self._eps = eps
        steady = np.diagonal(matrix.coefficients.get((0, 0), np.zeros((1, 1)))).real
        self._reach = np.sum(matrix.strength(eps), axis=-1).max(axis=-1)  # no exponent moves further (Gershgorin)
        self._threshold = COALESCENCE_ROUNDING * self._reach * (steady == 0).any()

    def intervals(self, whole: bool) -> tuple[FloatArray, FloatArray]:
        """Return the region of the first pair in x = Omega - centre at each eps.

        Where the regions of several resonances have merged, it is that of all of them. But resonances that coincide,
        nearer to each other than the region is wide, share it out unless ``whole`` is set: the first in line has all of
        it, the next the part in which a second solution grows as well, and so on. A main resonance 2 omega_p comes
        before a combination, a stronger coupling before a weaker one. (If the coupling of a repeated frequency is
        diagonal in some coordinates, these are the regions of the uncoupled modes.)

        Returns
        -------
        lower, upper : ndarray, shape (k,)
            NaN if there is none, infinite where it reaches beyond the frequencies at which the states can be in
            resonance. Of several intervals, the one in which the pair has the largest share.
        """
        lower, upper = np.full(self._eps.shape, np.nan), np.full(self._eps.shape, np.nan)
        if not len(self._eps):
            return lower, upper
        x, at = self._samples()
        level = np.ones(len(self._eps), dtype=np.intp)
        outside = np.full((2, len(self._eps)), np.nan)  # stable points next to the lower and to the upper edge
        for k in range(len(self._eps)):
            found = self._own_run(k, x[k], at.growing[k], at.share[k], whole)
            if found is None:
                continue
            level[k], a, b = found
            lower[k], upper[k] = x[k, a], x[k, b - 1]
            outside[0, k] = x[k, a - 1] if a > 0 else -np.inf
            outside[1, k] = x[k, b] if b < x.shape[1] else np.inf
        return self._edge(outside[0], lower, level), self._edge(outside[1], upper, level)

    def _samples(self) -> tuple[FloatArray, Exponents]:
        """Return sampled x, shape (k, s), and the exponents there."""
        matrix = self._matrix
        rates = np.abs(np.subtract.outer(matrix.rate, matrix.rate))
        window = 3 * self._reach / rates[0, 1]  # beyond this the pair is out of resonance
        # and beyond this all states are
        beyond = window + 3 * (self._reach + np.abs(matrix.detuning).max()) / rates[rates > 0].min()
        x = np.column_stack([-beyond, np.linspace(-window, window, INTERVAL_SAMPLES, axis=1), beyond])
        return self._with_exchanges(x, self._exponents(x, self._eps[:, None], self._threshold[:, None]))

    def _own_run(
        self, k: int, x: FloatArray, growing: NDArray[np.intp], share: FloatArray, whole: bool
    ) -> tuple[int, int, int] | None:
        """Return how many solutions grow in the region of the first pair, and its first and last + 1 sample."""
        runs = _runs(growing >= 1)
        if not runs:
            return None
        shares = np.array([share[a:b].max(axis=0) for a, b in runs])
        places, halves = self._pair_regions(k)
        run = int(np.argmax(shares[:, 0]))
        if shares[run, 0] < OWN_SHARE:
            around = [(a, b) for a, b in runs if x[a] <= places[0] <= x[b - 1]]
            return (1, *around[0]) if around and whole else None
        a, b = runs[run]
        merged = [i for i in range(len(self._pairs)) if shares[:, i].argmax() == run and shares[run, i] >= OWN_SHARE]
        strength = np.round(halves / max(halves.max(), SMALLEST_NORMAL) / EQUAL_STRENGTH)
        line = sorted(merged, key=lambda i: (not self._pairs[i].is_main, -strength[i], self._pairs[i][2:]))
        leader = line[0]
        if whole or leader == 0 or abs(places[0] - places[leader]) > halves[leader]:
            return 1, a, b
        before = line[: line.index(0)]
        level = 1 + sum(1 if self._pairs[i].is_main else 2 for i in before)
        inner = [(a + c, a + d) for c, d in _runs(growing[a:b] >= level)]
        if not inner:
            return None
        c, d = min(inner, key=lambda ends: abs(0.5 * (x[ends[0]] + x[ends[1] - 1]) - places[0]))
        return level, c, d

    def _pair_regions(self, k: int) -> tuple[FloatArray, FloatArray]:
        """Return the centre in x and the half width that each pair would have alone."""
        matrix = self._matrix
        H = matrix.at(np.array(0.0), self._eps[k])
        first, second = (np.array([pair[i] for pair in self._pairs]) for i in (0, 1))
        rate = matrix.rate[second] - matrix.rate[first]
        places = (matrix.detuning[first] - matrix.detuning[second]) / rate
        return places, 2 * np.sqrt(np.abs(H[first, second] * H[second, first])) / np.abs(rate)

    def _with_exchanges(self, x: FloatArray, at: Exponents) -> tuple[FloatArray, Exponents]:
        """Add to the samples points at which the exponents of the first pair change places and one of them grows."""
        row, left = np.nonzero(at.above[:, :-1] != at.above[:, 1:])
        low, high, above = x[row, left], x[row, left + 1], at.above[row, left]
        found: list[list[float]] = [[] for _ in self._eps]
        for _ in range(EXCHANGE_BISECTIONS):
            if not len(row):
                break
            middle = 0.5 * (low + high)
            between = self._exponents(middle, self._eps[row], self._threshold[row])
            hit = between.share[..., 0] >= OWN_SHARE
            for k, value in zip(row[hit], middle[hit], strict=True):
                found[k].append(value)
            same = between.above == above
            low, high = np.where(same, middle, low), np.where(same, high, middle)
            row, low, high, above = row[~hit], low[~hit], high[~hit], above[~hit]
        added = np.repeat(x[:, :1], max(map(len, found)), axis=1)  # rows with fewer points repeat their first sample
        for k, values in enumerate(found):
            added[k, : len(values)] = values
        extra = self._exponents(added, self._eps[:, None], self._threshold[:, None])
        x = np.concatenate([x, added], axis=1)
        order = np.argsort(x, axis=1, kind="stable")
        every = Exponents(*(np.concatenate(both, axis=1) for both in zip(at, extra, strict=True)))
        return np.take_along_axis(x, order, 1), Exponents(
            np.take_along_axis(every.growing, order, 1),
            np.take_along_axis(every.share, order[..., None], 1),
            np.take_along_axis(every.above, order, 1),
        )

    def _exponents(self, x: FloatArray, eps: FloatArray, threshold: FloatArray) -> Exponents:
        values, vectors = np.linalg.eig(self._matrix.at(x, eps))
        size = np.abs(vectors) ** 2  # [..., state, exponent]
        grows = values.real > threshold[..., None]
        same = self._matrix.same
        of_level = same @ size
        share = np.zeros((*values.shape[:-1], len(self._pairs)))
        for i, (first, second, _, _) in enumerate(self._pairs):
            others = ~same[[first, second]].any(axis=0)
            rivals = of_level[..., others, :].max(axis=-2, initial=SMALLEST_NORMAL)
            own = np.minimum(of_level[..., first, :], of_level[..., second, :])
            share[..., i] = np.where(grows, own / rivals, 0.0).max(axis=-1)
        pair = size[..., list(self._pairs[0][:2]), :]
        strongest = np.argmax(pair, axis=-1)  # the exponent that each state of the first pair shares most
        height = np.take_along_axis(values.imag, strongest, axis=-1)
        return Exponents(grows.sum(axis=-1), share, height[..., 0] > height[..., 1])

    def _edge(self, stable: FloatArray, unstable: FloatArray, level: NDArray[np.intp]) -> FloatArray:
        """Return the edges between points ``stable``, where fewer than ``level`` solutions grow, and ``unstable``.

        What is not finite stays as it is in ``stable``.
        """
        edge = stable.copy()
        at = np.isfinite(stable)
        eps, threshold, level = self._eps[at], self._threshold[at], level[at]
        stable, unstable = stable[at], unstable[at]
        for _ in range(EDGE_BISECTIONS if len(eps) else 0):
            middle = 0.5 * (stable + unstable)
            values = np.linalg.eigvals(self._matrix.at(middle, eps)).real
            grows = (values > threshold[:, None]).sum(axis=-1) >= level
            stable, unstable = np.where(grows, stable, middle), np.where(grows, middle, unstable)
        edge[at] = 0.5 * (stable + unstable)
        return edge


def _runs(inside: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """Return first and last + 1 index of each run of True."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], inside, [False]]).astype(int)))
    return [(int(a), int(b)) for a, b in edges.reshape(-1, 2)]
