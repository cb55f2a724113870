"""The resonances that a region starts from: its kind and its place as eps -> 0 against those of all resonances."""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np

from floquet.boundary import Resonance, trace_boundary
from floquet.regions.outlines import Column, IntervalId, Loop, components, contained, crossings, loops
from floquet.regions.scan import Scan
from floquet.regions.widths import ExpectedTongue

# A lower edge dips to a tip if it falls by more than this part of the range of eps.
MIN_TIP_DEPTH = 0.01
# The centreline is measured this part of the height of a region above its tip.
CHORD_HEIGHT = 0.05
# It is measured higher if that is less than this part of the way down to eps = 0: the centreline moves with eps^2.
MIN_CHORD_LEVERAGE = 0.3
# The place at eps = 0 is known to this many tolerances,
PLACE_TOLERANCES = 2.0
# the width there, and this part of the way to it.
WAY_UNCERTAINTY = 0.5
# A tip below this part of the height of a region is near enough to eps = 0 to tell resonances of one type and order
# apart. From higher ones `trace_boundary` follows them.
MAX_CLEAR_TIP = 0.05

# Resonances whose centres agree to this part of themselves resonate together.
SAME_CENTRE = 1e-7
# So do those whose centres are in the region this far above its tip, as parts of its height.
COMPANION_HEIGHTS = np.array([1 / 64, 1 / 32, 1 / 16])

# A name of a resonance once it is spelled with w for omega, digits and - alone: 2w1, w1+w3, (w3-w1)/2, w2/3.
RESONANCE_NAME = re.compile(r"\(?(\d*)w(\d+)(?:([+-])w(\d+))?\)?(?:/(\d+))?")
SPELLINGS = str.maketrans("₀₁₂₃₄₅₆₇₈₉ω−–", "0123456789w--", " _*{}$\\")


def resonance_named(name: str) -> tuple[int, int, int, str]:
    """Return p >= q, j and type of the resonance that a name means, in any spelling.

    ω₁+ω₃, w1+w3, omega_3 + omega_1 and \\omega_1+\\omega_3 are one; ω₁ is 2ω₁/2.

    Raises
    ------
    ValueError
        If it is the name of no resonance.
    """
    found = RESONANCE_NAME.fullmatch(name.translate(SPELLINGS).casefold().replace("omega", "w"))
    if found is not None:
        factor, one, sign, other, divisor = found.groups()
        p, j = int(one), int(divisor or 1)
        if sign is None and int(factor or 1) > 0 and 2 * j % int(factor or 1) == 0:
            return p, p, 2 * j // int(factor or 1), "sum"
        if sign is not None and factor in ("", "1") and (sign, p) != ("-", int(other)):
            q, p = sorted((p, int(other)))
            return p, q, j, "sum" if sign == "+" else "difference"
    raise ValueError(f"{name!r} is the name of no resonance; write it as 2ω₁, ω₁+ω₃ or (ω₃-ω₁)/2, or with w for ω")


class Naming:
    """Finds the resonances that the regions of a scan start from."""

    def __init__(self, scan: Scan, expected: Sequence[ExpectedTongue]) -> None:
        self.window, self.expected = scan.window, expected
        self.Omega, self.columns = scan.ordered()
        self.component = {one: members for members in components(self.columns) for one in members}
        self.known: dict[int, list[Resonance]] = {}

    def resonances_of(self, c: int, eps: float) -> list[Resonance]:
        """Return the resonances of the region that meets column ``c`` at or just below ``eps``."""
        i = max(i for i, interval in enumerate(self.columns[c]) if interval.low < eps)
        members = self.component[c, i]
        if id(members) not in self.known:
            outlines = loops(self.Omega, self.columns, members, self.window.resolution)
            named = [] if self.window.is_unstable_at_rest else self._named(outlines, tips(self.columns, members))
            self.known[id(members)] = named
        return self.known[id(members)]

    def _named(self, outlines: Sequence[Loop], starts: Sequence[IntervalId]) -> list[Resonance]:
        """Return the resonances below the tips of a region, and those that resonate together with them."""
        found = [one for one in (self._start(outlines, c, i) for c, i in starts) if one is not None]
        bottom = min(self.columns[c][i].low for c, i in starts)
        top = max(loop.eps.max() for loop in outlines)
        probes = bottom + COMPANION_HEIGHTS * (top - bottom)
        for tongue in self.expected:
            one = tongue.resonance
            if one in found or one.j > self.window.member.harmonics or tongue.tip >= self.window.eps_range[1]:
                continue
            is_inside = contained(outlines, np.full(probes.shape, one.centre), probes).all()
            if is_inside or any(abs(one.centre - other.centre) <= SAME_CENTRE * one.centre for other in found):
                found.append(one)
        return sorted(dict.fromkeys(found), key=lambda one: (float(f"{one.centre:.9e}"), one.j, one.p, one.q))

    def _start(self, outlines: Sequence[Loop], c: int, i: int) -> Resonance | None:
        """Return the resonance below the tip of a region in interval ``i`` of column ``c``; None if there is none."""
        tip, Omega = self.columns[c][i], float(self.Omega[c])
        height = tip.high - tip.low
        amplitude = tip.low + min(max(CHORD_HEIGHT * height, MIN_CHORD_LEVERAGE * tip.low), height / 2)
        ends = crossings(outlines, amplitude)
        chords = list(zip(ends[::2], ends[1::2], strict=True))
        chord = min(chords, key=lambda ends: max(ends[0] - Omega, Omega - ends[1]), default=(Omega, Omega))
        way = (Omega - sum(chord) / 2) * tip.low**2 / (amplitude**2 - tip.low**2)
        width = (chord[1] - chord[0]) * tip.low / amplitude  # nothing at a tip at eps = 0
        reach = PLACE_TOLERANCES * self.window.resolution + width + WAY_UNCERTAINTY * abs(way)
        centre = Omega + way
        low, high = min(Omega, centre) - reach, max(Omega, centre) + reach
        fitting = [one for one in self.window.resonances if low <= one.centre <= high and one.kind == tip.low_kind]
        fitting.sort(key=lambda one: (one.sign < 0, one.j, abs(one.centre - centre)))
        rivals = [one for one in fitting if one.j == fitting[0].j and one.type == fitting[0].type]
        if len(rivals) > 1 and tip.low > MAX_CLEAR_TIP * tip.high:
            return next((one for one in rivals if self._is_connected(one, amplitude, chord)), rivals[0])
        return rivals[0] if rivals else None

    def _is_connected(self, resonance: Resonance, amplitude: float, chord: tuple[float, float]) -> bool:
        """Return whether the region of a resonance, followed from eps = 0, arrives at the chord at ``amplitude``."""
        trace = trace_boundary(self.window.family, resonance.centre, amplitude, type=resonance.type, j=resonance.j)
        if (trace.resonance.p, trace.resonance.q) != resonance[:2] or not trace.is_open[0]:
            return False
        lower, upper = np.nan_to_num(trace.lower[0], nan=-np.inf), np.nan_to_num(trace.upper[0], nan=np.inf)
        tolerance = self.window.resolution
        return bool(lower <= chord[1] + tolerance and upper >= chord[0] - tolerance)


def tips(columns: Sequence[Column], members: set[IntervalId]) -> list[IntervalId]:
    """Return the intervals at which the lower edge of a region is lowest: between higher ones, or at an end."""
    height = max(columns[c][i].high for c, i in members)
    lowest: dict[int, IntervalId] = {}
    for c, i in sorted(members, key=lambda one: columns[one[0]][one[1]].low):
        lowest.setdefault(c, (c, i))
    order = sorted(lowest)
    edge = [columns[c][lowest[c][1]].low for c in order]

    def rises(k: int, step: int) -> bool:
        """Whether the edge rises to that side before it falls below its height here."""
        following = edge[k + step :: step] if 0 <= k + step < len(edge) else []
        for low in following:
            if low < edge[k] or (low == edge[k] and step < 0):
                return False
            if low > edge[k] + MIN_TIP_DEPTH * height:
                return True
        return True

    return [lowest[c] for k, c in enumerate(order) if rises(k, -1) and rises(k, 1)]
