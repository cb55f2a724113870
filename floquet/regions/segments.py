"""Tongues and wide regions put together: tongues are cut where they enter a wide region, which then goes on in them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from floquet.regions.outlines import Loop, area, closed, crossings
from floquet.regions.tongues import Tongue
from floquet.regions.window import Window
from periodic.checks import FloatArray

# Corners on each side of a tongue.
CORNERS = 64
# Points between two amplitudes among which a tongue is cut.
CUTS = 16


class Segment(NamedTuple):
    """A part of a tongue outside all wide regions.

    ``wide`` is the number of the wide region that it ends in, None if it ends in none.
    """

    tongue: Tongue
    loop: Loop
    wide: int | None


Contains = Callable[[FloatArray, FloatArray], NDArray[np.bool_]]


def segments(tongues: Sequence[Tongue], wide: Sequence[Contains], window: Window) -> list[Segment]:
    """Return the segments of tongues that lie in the window and outside the wide regions."""
    found: list[Segment] = []
    left, right = window.Omega_range
    amplitudes = [_sampled(tongue) for tongue in tongues]
    shown = [
        np.array([eps, np.clip(lower, left, right), np.clip(upper, left, right)]) for eps, lower, upper in amplitudes
    ]
    owners = _owners(shown, wide)
    for tongue, (eps, lower, upper), part, owner in zip(tongues, amplitudes, shown, owners, strict=True):
        met = (upper >= left) & (lower <= right)
        owner, free = np.where(met, owner, -1), met & (owner < 0)
        changes = np.flatnonzero(np.diff(np.concatenate([[False], free, [False]]).astype(int)))
        for start, stop in zip(changes[::2], changes[1::2], strict=True):
            before = int(owner[start - 1]) if start > 0 else -1
            after = int(owner[stop]) if stop < len(eps) else -1
            sides = np.array([eps[start:stop], lower[start:stop], upper[start:stop]])
            for number, inner, outer, end in ((before, start, start - 1, 0), (after, stop - 1, stop, 1)):
                if number >= 0:
                    corner = _cut(part, inner, outer, wide[number])
                    sides = np.insert(sides, 0 if end == 0 else sides.shape[1], corner, axis=1)
            if sides.shape[1] > 1:
                number = after if after >= 0 else before
                found.append(Segment(tongue, _loop(tongue, sides, window), number if number >= 0 else None))
    return found


def _sampled(tongue: Tongue) -> FloatArray:
    """Return amplitudes and edges (3, CORNERS) of a tongue."""
    eps = np.linspace(tongue.eps[0], tongue.eps[-1], CORNERS)
    eps[int(np.abs(eps - tongue.witness[1])[1:-1].argmin()) + 1] = tongue.witness[1]
    eps.sort()
    return np.array([eps, np.interp(eps, tongue.eps, tongue.lower), np.interp(eps, tongue.eps, tongue.upper)])


def _owners(amplitudes: Sequence[FloatArray], wide: Sequence[Contains]) -> list[NDArray[np.int_]]:
    """Return the numbers of the wide regions that the centrelines lie in at the amplitudes, -1 for none."""
    if not amplitudes:
        return []
    eps, lower, upper = np.concatenate(amplitudes, axis=1)
    owner = np.full(len(eps), -1)
    for number, contains in enumerate(wide):
        owner[contains((lower + upper) / 2, eps)] = number
    return np.split(owner, np.cumsum([part.shape[1] for part in amplitudes])[:-1])


def _cut(amplitudes: FloatArray, inner: int, outer: int, contains: Contains) -> FloatArray:
    """Return the amplitude (3,) at which the centreline enters a wide region, between one outside and one inside."""
    part = np.linspace(0, 1, CUTS + 1)
    between = amplitudes[:, [inner]] + part * (amplitudes[:, [outer]] - amplitudes[:, [inner]])
    inside = contains((between[1] + between[2]) / 2, between[0])
    return np.asarray(between[:, int(inside.argmax()) if inside.any() else -1])


def _loop(tongue: Tongue, sides: FloatArray, window: Window) -> Loop:
    """Return the outline, counterclockwise, from amplitudes and edges (3, k)."""
    eps, lower, upper = sides
    Omega = np.clip(np.concatenate([upper, lower[::-1]]), *window.Omega_range)
    return closed(Omega, np.concatenate([eps, eps[::-1]]), np.full(len(Omega), tongue.resonance.kind))


def intervals(outlines: Sequence[Loop], amplitude: float) -> FloatArray:
    """Return the intervals of Omega, shape (m, 2), in which the row ``amplitude`` lies inside the outlines of a region.

    Islands run clockwise; outlines that run counterclockwise may overlap.
    """
    ends: list[tuple[float, int]] = []
    for loop in outlines:
        turn = -1 if area(loop.Omega, loop.eps) < 0 else 1
        ends += [(x, turn * (-1) ** number) for number, x in enumerate(crossings([loop], amplitude))]
    ends.sort()
    inside = np.cumsum([step for _, step in ends]) > 0  # to the right of each end
    changes = np.flatnonzero(np.diff(inside, prepend=False))
    return np.array([ends[i][0] for i in changes]).reshape(-1, 2)
