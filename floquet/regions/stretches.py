"""Narrow regions and wide ones put together: branches, cut where they meet a wide region, and what they belong to."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from floquet.regions.outlines import Loop
from floquet.regions.tongues import Tongue
from periodic.checks import FloatArray

# Corners on each side of a narrow region.
CORNERS = 64
# Points between two levels among which a branch is cut.
CUTS = 16


class Branch(NamedTuple):
    """A stretch of a narrow region outside all wide ones; ``parent`` is the number of the wide region that it ends in,
    None if it ends in none."""

    tongue: Tongue
    loop: Loop
    parent: int | None


Contains = Callable[[FloatArray, FloatArray], NDArray[np.bool_]]


def branches(tongues: Sequence[Tongue], wide: Sequence[Contains], window: tuple[float, float]) -> list[Branch]:
    """Return the stretches of narrow regions that lie in the window and outside the wide regions."""
    found: list[Branch] = []
    levels = [_levels(tongue) for tongue in tongues]
    seen = [np.array([eps, np.clip(lower, *window), np.clip(upper, *window)]) for eps, lower, upper in levels]
    homes = _homes(seen, wide)
    for tongue, (eps, lower, upper), inside, home in zip(tongues, levels, seen, homes, strict=True):
        met = (upper >= window[0]) & (lower <= window[1])
        home, free = np.where(met, home, -1), met & (home < 0)
        steps = np.flatnonzero(np.diff(np.concatenate([[False], free, [False]]).astype(int)))
        for start, stop in zip(steps[::2], steps[1::2], strict=True):
            before = int(home[start - 1]) if start > 0 else -1
            after = int(home[stop]) if stop < len(eps) else -1
            sides = np.array([eps[start:stop], lower[start:stop], upper[start:stop]])
            for parent, inner, outer, end in ((before, start, start - 1, 0), (after, stop - 1, stop, 1)):
                if parent >= 0:
                    corner = _cut(inside, inner, outer, wide[parent])
                    sides = np.insert(sides, 0 if end == 0 else sides.shape[1], corner, axis=1)
            if sides.shape[1] > 1:
                parent = after if after >= 0 else before
                found.append(Branch(tongue, _loop(tongue, sides, window), parent if parent >= 0 else None))
    return found


def _levels(tongue: Tongue) -> FloatArray:
    """Return amplitudes and edges (3, CORNERS) of a narrow region."""
    eps = np.linspace(tongue.eps[0], tongue.eps[-1], CORNERS)
    eps[int(np.abs(eps - tongue.witness[1])[1:-1].argmin()) + 1] = tongue.witness[1]
    eps.sort()
    return np.array([eps, np.interp(eps, tongue.eps, tongue.lower), np.interp(eps, tongue.eps, tongue.upper)])


def _homes(levels: Sequence[FloatArray], wide: Sequence[Contains]) -> list[NDArray[np.int_]]:
    """Return the numbers of the wide regions that the middles of the levels lie in, -1 for none."""
    if not levels:
        return []
    eps, lower, upper = np.concatenate(levels, axis=1)
    home = np.full(len(eps), -1)
    for number, contains in enumerate(wide):
        home[contains((lower + upper) / 2, eps)] = number
    return np.split(home, np.cumsum([part.shape[1] for part in levels])[:-1])


def _cut(levels: FloatArray, inner: int, outer: int, contains: Contains) -> FloatArray:
    """Return the level (3,) at which the middle enters a wide region, between one outside and one inside."""
    part = np.linspace(0, 1, CUTS + 1)
    between = levels[:, [inner]] + part * (levels[:, [outer]] - levels[:, [inner]])
    inside = contains((between[1] + between[2]) / 2, between[0])
    return np.asarray(between[:, int(inside.argmax()) if inside.any() else -1])


def _loop(tongue: Tongue, sides: FloatArray, window: tuple[float, float]) -> Loop:
    """Return the outline, counterclockwise, from amplitudes and edges (3, k)."""
    eps, lower, upper = sides
    Omega = np.clip(np.concatenate([upper, lower[::-1]]), *window)
    kind = np.full(len(Omega), tongue.name.kind, dtype=np.int8)
    loop = Loop(Omega, np.concatenate([eps, eps[::-1]]), kind)
    for array in loop:
        array.setflags(write=False)
    return loop
