"""Which resonance a region of instability starts from: its kind and its place as eps -> 0 against all resonances."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from floquet.boundary import Resonance, trace_boundary
from floquet.regions.outlines import Column, Loop, Place, components, crossings, loops
from periodic import SystemFamily
from periodic.checks import FloatArray

# A dip of the lower edge by less than this part of the range of eps is no foot.
PROMINENCE = 0.01
# The middle of a region is measured this part of its height above its foot, or this part of the way down to eps = 0 if
# that is more: the way the middle goes is like eps^2.
LEVEL, LEVER = 0.05, 0.3
# The place at eps = 0 is known to this many tolerances, the width there, and this part of the way to it.
TOLERANCES, DOUBT = 2.0, 0.5
# A foot below this part of the height is near enough to eps = 0 to tell two resonances of one kind and order apart;
# from higher ones they are followed by `trace_boundary`.
SURE = 0.05


class Namer:
    """Finds the resonances that regions start from, given the columns from eps = 0 upwards."""

    def __init__(
        self,
        family: SystemFamily,
        Omega: FloatArray,
        columns: Sequence[Column],
        names: Sequence[Resonance],
        tolerance: float,
    ) -> None:
        self.family, self.Omega, self.columns, self.names, self.tolerance = family, Omega, columns, names, tolerance
        self.homes = {place: places for places in components(columns) for place in places}
        self.known: dict[int, list[Resonance]] = {}

    def names_of(self, c: int, eps: float) -> list[Resonance]:
        """Return the resonances that the region starts from that column ``c`` meets at or below ``eps``."""
        i = max(i for i, interval in enumerate(self.columns[c]) if interval.low < eps)
        places = self.homes[c, i]
        if id(places) not in self.known:
            outlines = loops(self.Omega, self.columns, places, self.tolerance)
            named = [self._start(outlines, c, i) for c, i in feet(self.columns, places)]
            self.known[id(places)] = list(dict.fromkeys(name for name in named if name is not None))
        return self.known[id(places)]

    def _start(self, outlines: Sequence[Loop], c: int, i: int) -> Resonance | None:
        """Return the resonance below the foot of a region in interval ``i`` of column ``c``; None if there is none."""
        foot, Omega = self.columns[c][i], float(self.Omega[c])
        beside = [interval for column in self.columns[max(c - 1, 0) : c + 2] for interval in column]
        if sum(interval.low == 0.0 for interval in beside) > 1:
            return None  # not at one frequency: unstable without excitation
        height = foot.high - foot.low
        level = foot.low + min(max(LEVEL * height, LEVER * foot.low), height / 2)
        ends = crossings(outlines, level)
        chords = list(zip(ends[::2], ends[1::2], strict=True))
        chord = min(chords, key=lambda ends: max(ends[0] - Omega, Omega - ends[1]), default=(Omega, Omega))
        way = (Omega - sum(chord) / 2) * foot.low**2 / (level**2 - foot.low**2)
        width = (chord[1] - chord[0]) * foot.low / level  # nothing at a foot at eps = 0
        reach = TOLERANCES * self.tolerance + width + DOUBT * abs(way)
        centre = Omega + way
        low, high = min(Omega, centre) - reach, max(Omega, centre) + reach
        fitting = [n for n in self.names if low <= n.centre <= high and n.kind == foot.low_kind]
        fitting.sort(key=lambda n: (n.sign < 0, n.j, abs(n.centre - centre)))
        rivals = [n for n in fitting if n.j == fitting[0].j and n.type == fitting[0].type]
        if len(rivals) > 1 and foot.low > SURE * foot.high:
            return next((n for n in rivals if self._is_connected(n, level, chord)), rivals[0])
        return rivals[0] if rivals else None

    def _is_connected(self, name: Resonance, level: float, chord: tuple[float, float]) -> bool:
        """Return whether the region of a resonance, followed from eps = 0, arrives at the chord at ``level``."""
        trace = trace_boundary(self.family, name.centre, level, type=name.type, j=name.j)
        if (trace.resonance.p, trace.resonance.q) != name[:2] or not trace.is_open[0]:
            return False
        lower, upper = np.nan_to_num(trace.lower[0], nan=-np.inf), np.nan_to_num(trace.upper[0], nan=np.inf)
        return bool(lower <= chord[1] + self.tolerance and upper >= chord[0] - self.tolerance)


def feet(columns: Sequence[Column], places: set[Place]) -> list[Place]:
    """Return the intervals at which the lower edge of a region is lowest: between higher ones, or at an end."""
    height = max(columns[c][i].high for c, i in places)
    lowest: dict[int, Place] = {}
    for c, i in sorted(places, key=lambda place: columns[place[0]][place[1]].low):
        lowest.setdefault(c, (c, i))
    order = sorted(lowest)
    depth = [columns[c][lowest[c][1]].low for c in order]

    def ends(k: int, step: int) -> bool:
        """Whether the edge rises to that side before it falls below its height here."""
        following = depth[k + step :: step] if 0 <= k + step < len(depth) else []
        for low in following:
            if low < depth[k] or (low == depth[k] and step < 0):
                return False
            if low > depth[k] + PROMINENCE * height:
                return True
        return True

    return [lowest[c] for k, c in enumerate(order) if ends(k, -1) and ends(k, 1)]
