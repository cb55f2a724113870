"""What the columns of a scan say about narrow resonances: by how much these are missed, at every amplitude.

A column that meets no region of a resonance still has its two modes, followed from eps = 0, and their exponents are
smooth in Omega and eps. One scan has columns on both sides of every resonance.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from floquet.engine import Subsystem
from floquet.regions.exponents import Exponents, distance, follow, test_function
from floquet.regions.scan import OTHER_PARTS, Modes, Scan
from floquet.regions.widths import Candidate, Home
from periodic.checks import FloatArray

# Columns are looked at up to this part of their range away from a resonance.
AWAY = 0.1
# Columns beyond those that a region passes between.
BESIDE = 2
# Dampings are about equal if the balance of `Candidate` is greater.
BALANCED = 0.95
# Two damped modes are unstable together if their mean decay changes by less than this part of their difference.
ALONE = 0.5


class Wide(NamedTuple):
    """Where wide regions are: at the levels ``met`` (slabs, k) the columns on both sides of a slab are unstable.

    The slabs are those between the columns at ``Omega`` (slabs + 1,).
    """

    Omega: FloatArray
    met: NDArray[np.bool_]

    def at(self, Omega: FloatArray | float) -> NDArray[np.bool_]:
        """Return the levels at which ``Omega``, a number or one for each level, lies in a wide region."""
        slab = np.searchsorted(self.Omega, Omega) - 1
        between = (slab >= 0) & (slab < len(self.met))
        return np.asarray(between & self.met[np.clip(slab, 0, len(self.met) - 1), np.arange(self.met.shape[1])])


class Nodes(NamedTuple):
    """What columns say about a candidate, at the increasing frequencies ``Omega`` (columns,).

    ``f`` (columns, k) is that of `test_function`, NaN where it says nothing. ``apart`` (columns, k) has the sign of the
    distance to the resonance, positive on its left. If dampings are unequal it is 2 sqrt(g - f), where g is f in the
    middle of the region.
    """

    Omega: FloatArray
    f: FloatArray
    apart: FloatArray
    wide: Wide

    def with_column(self, candidate: Candidate, Omega: float, column: Modes, eps: FloatArray) -> Nodes:
        """Return the nodes and one more, from the modes of a column at the amplitudes ``eps`` (k,)."""
        f, apart = _measures(followed(column, candidate.home, Omega, eps), candidate)
        f[self.wide.at(Omega) & (f > 0)] = np.nan
        at = int(np.searchsorted(self.Omega, Omega))
        new = (np.array([Omega]), f[None], apart[None])
        parts = [np.concatenate([old[:at], row, old[at:]]) for old, row in zip(self[:3], new, strict=True)]
        return Nodes(parts[0], parts[1], parts[2], self.wide)


def scan_nodes(candidates: Sequence[Candidate], scan: Scan) -> Iterator[Nodes]:
    """Yield what the columns of a scan say about each candidate."""
    known = {number: _followed(scan, home) for number, home in {id(one.home): one.home for one in candidates}.items()}
    for one in candidates:
        Omega, unstable, modes = known[id(one.home)]
        both = unstable[1:] & unstable[:-1]
        none = np.zeros((1, len(scan.eps)), dtype=bool)
        met = np.concatenate([both, none]) | np.concatenate([none, both])
        reach = AWAY * (Omega[-1] - Omega[0])
        first = int(np.searchsorted(Omega, one.name.centre - reach))
        last = int(np.searchsorted(Omega, one.name.centre + reach, side="right"))
        near = slice(first, last)
        near = _beside(Exponents(*(part[near] for part in modes)), one, Omega[near], first)
        f, apart = _measures(Exponents(*(part[near] for part in modes)), one)
        f[met[near] & (f > 0)] = np.nan  # unstable by whatever the wide region is from
        yield Nodes(Omega[near], f, apart, Wide(Omega[near], both[near.start : near.stop - 1]))


def _followed(scan: Scan, home: Home) -> tuple[FloatArray, NDArray[np.bool_], Exponents]:
    """Return the columns of a scan in which a home was looked at, where they are unstable (columns, k), and the modes
    of the home, arrays (columns, k, n)."""
    first = min(scan.modes)
    number = home_of([one.subsystem for one in scan.modes[first].values()], home, first)
    Omega, unstable, columns = [], [], []
    for w in sorted(scan.modes):
        column = scan.modes[w].get(number)
        if column is None:
            continue
        rows = [(scan.eps >= one.low) & (scan.eps <= one.high) for one in scan.columns.get(w, [])]
        Omega.append(w)
        unstable.append(np.any(rows, axis=0) if rows else np.zeros(len(scan.eps), dtype=bool))
        columns.append(followed(column, home, w, scan.eps))
    return np.array(Omega), np.array(unstable), Exponents(*(np.array(part) for part in zip(*columns, strict=True)))


def home_of(subsystems: Sequence[Subsystem], home: Home, Omega: float) -> int:
    """Return which of the subsystems of a family at ``Omega`` is the home of a candidate at its frequency."""
    wanted = home.subsystem.K.diagonal()
    alike = [i for i, subsystem in enumerate(subsystems) if len(subsystem.K) == len(wanted)]
    if not alike:
        raise ValueError(OTHER_PARTS.format(Omega))
    return min(alike, key=lambda i: float(np.abs(subsystems[i].K.diagonal() - wanted).max()))


def followed(column: Modes, home: Home, Omega: float, eps: FloatArray) -> Exponents:
    """Return the modes of a column in the order of those of the home."""
    conservative = column.subsystem.reciprocal
    return follow(column.found, eps, home.exponents * (2 * np.pi / Omega), conservative)


def _beside(found: Exponents, candidate: Candidate, Omega: FloatArray, start: int) -> slice:
    """Return the columns that a candidate passes between, and some more on both sides; they are numbered from
    ``start``."""
    name = candidate.name
    apart = distance(found, candidate.p, candidate.q, name.j, name.sign)
    left = np.flatnonzero((apart.min(axis=1) > 0) & (Omega < name.centre))
    right = np.flatnonzero((apart.max(axis=1) < 0) & (Omega > name.centre))
    first, last = left[-1] if len(left) else 0, right[0] if len(right) else len(Omega) - 1
    return slice(start + max(first - BESIDE, 0), start + min(last + BESIDE + 1, len(Omega)))


def _measures(found: Exponents, candidate: Candidate) -> tuple[FloatArray, FloatArray]:
    """Return ``f`` and ``apart`` of `Nodes`, (..., k).

    What one of two damped modes gains from the other, the other loses: where their mean decay changes by as much as the
    difference, one of them is unstable with a third. Two that are unstable together have the same angle, but for
    unequal damping: for a detuning x, and differences of decay d_0 without and d with coupling, their angles differ by
    d_0 x / d.
    """
    p, q, name, subsystem = candidate.p, candidate.q, candidate.name, candidate.home.subsystem
    conservative = subsystem.reciprocal
    f = test_function(found, p, q, name.j, name.sign, conservative)
    apart = distance(found, p, q, name.j, name.sign)
    if not conservative and p != q:
        total = found.modulus[..., p] + found.modulus[..., q]
        difference = found.modulus[..., p] - found.modulus[..., q]
        gain, shift = np.abs(difference - difference[..., :1]), np.abs(total - total[..., :1])
        f = np.where((f > 0) & (shift > ALONE * gain), np.nan, f)
        if candidate.balance < BALANCED:
            with np.errstate(divide="ignore", invalid="ignore"):
                apart = apart * candidate.balance * difference / difference[..., :1]
            f = np.where(np.isfinite(apart), f, np.nan)
    return f, apart
