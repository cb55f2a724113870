"""What the columns of a scan say about a narrow region: the detuning of its two modes, at every amplitude.

A column that meets no region of a resonance still has its two modes, tracked from eps = 0, and their exponents are
smooth in Omega and eps. One scan has columns on both sides of every resonance.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from floquet.engine import Subsystem
from floquet.regions.column import SubsystemColumn
from floquet.regions.scan import OTHER_SUBSYSTEMS, Scan
from floquet.regions.tracking import LogMultipliers, angle_detuning, pair_test_function, track_modes
from floquet.regions.widths import ExpectedTongue, SubsystemModes
from periodic.checks import FloatArray

# Columns are looked at up to this part of their range away from a resonance.
MAX_DISTANCE = 0.1
# Columns that are looked at beyond those that a region passes between, on each side.
EXTRA_COLUMNS = 2
# Dampings are about equal if the balance of `ExpectedTongue` is greater.
EQUAL_DAMPING_BALANCE = 0.95
# Two damped modes are unstable together if their mean decay changes by less than this part of their difference.
MAX_MEAN_CHANGE = 0.5


class WideRegions(NamedTuple):
    """Where wide regions are: ``unstable`` (spans, k) says where the columns on both sides of a span are unstable.

    The spans are those between the columns at ``Omega`` (spans + 1,).
    """

    Omega: FloatArray
    unstable: NDArray[np.bool_]

    def at(self, Omega: FloatArray | float) -> NDArray[np.bool_]:
        """Return the amplitudes at which ``Omega``, a number or one for each amplitude, lies in a wide region."""
        span = np.searchsorted(self.Omega, Omega) - 1
        between = (span >= 0) & (span < len(self.unstable))
        amplitudes = np.arange(self.unstable.shape[1])
        return np.asarray(between & self.unstable[np.clip(span, 0, len(self.unstable) - 1), amplitudes])


class Detuning(NamedTuple):
    """What columns say about an expected tongue, at the increasing frequencies ``Omega`` (columns,).

    ``f`` (columns, k) is that of `pair_test_function`, NaN where it says nothing. ``detuning`` (columns, k) is that of
    `angle_detuning`, positive on the left of the resonance. If dampings are unequal it is 2 sqrt(g - f) with that sign,
    where g is f at the centreline.
    """

    Omega: FloatArray
    f: FloatArray
    detuning: FloatArray
    wide: WideRegions

    def with_column(self, tongue: ExpectedTongue, Omega: float, column: SubsystemColumn, eps: FloatArray) -> Detuning:
        """Return what is said with one more column at the amplitudes ``eps`` (k,)."""
        f, detuning = _measures(tracked(column, tongue.modes, Omega, eps), tongue)
        f[self.wide.at(Omega) & (f > 0)] = np.nan
        at = int(np.searchsorted(self.Omega, Omega))
        new = (np.array([Omega]), f[None], detuning[None])
        parts = [np.concatenate([old[:at], row, old[at:]]) for old, row in zip(self[:3], new, strict=True)]
        return Detuning(parts[0], parts[1], parts[2], self.wide)


def detunings(tongues: Sequence[ExpectedTongue], scan: Scan) -> Iterator[Detuning]:
    """Yield what the columns of a scan say about each tongue."""
    known = {number: _tracked_columns(scan, modes) for number, modes in {id(t.modes): t.modes for t in tongues}.items()}
    for tongue in tongues:
        Omega, unstable, modes = known[id(tongue.modes)]
        both = unstable[1:] & unstable[:-1]
        none = np.zeros((1, both.shape[1]), dtype=bool)
        in_wide = np.concatenate([both, none]) | np.concatenate([none, both])
        distance = MAX_DISTANCE * (Omega[-1] - Omega[0])
        first = int(np.searchsorted(Omega, tongue.resonance.centre - distance))
        last = int(np.searchsorted(Omega, tongue.resonance.centre + distance, side="right"))
        near = slice(first, last)
        near = _around(LogMultipliers(*(part[near] for part in modes)), tongue, Omega[near], first)
        f, detuning = _measures(LogMultipliers(*(part[near] for part in modes)), tongue)
        f[in_wide[near] & (f > 0)] = np.nan  # unstable by whatever the wide region is from
        yield Detuning(Omega[near], f, detuning, WideRegions(Omega[near], both[near.start : near.stop - 1]))


def _tracked_columns(scan: Scan, modes: SubsystemModes) -> tuple[FloatArray, NDArray[np.bool_], LogMultipliers]:
    """Return the columns in which a subsystem was looked at, where they are unstable, and its modes.

    Shapes (columns,), (columns, k) and (columns, k, n).
    """
    eps = scan.window.amplitudes
    first = min(scan.subsystems)
    number = matching_subsystem([one.subsystem for one in scan.subsystems[first].values()], modes, first)
    Omega, unstable, columns = [], [], []
    for w in sorted(scan.subsystems):
        column = scan.subsystems[w].get(number)
        if column is None:
            continue
        rows = [(eps >= one.low) & (eps <= one.high) for one in scan.columns.get(w, [])]
        Omega.append(w)
        unstable.append(np.any(rows, axis=0) if rows else np.zeros(len(eps), dtype=bool))
        columns.append(tracked(column, modes, w, eps))
    return np.array(Omega), np.array(unstable), LogMultipliers(*(np.array(part) for part in zip(*columns, strict=True)))


def matching_subsystem(subsystems: Sequence[Subsystem], modes: SubsystemModes, Omega: float) -> int:
    """Return which of the subsystems of a family at ``Omega`` is the one of ``modes``, which may be from elsewhere."""
    wanted = modes.subsystem.K.diagonal()
    alike = [i for i, subsystem in enumerate(subsystems) if len(subsystem.K) == len(wanted)]
    if not alike:
        raise ValueError(OTHER_SUBSYSTEMS.format(Omega))
    return min(alike, key=lambda i: float(np.abs(subsystems[i].K.diagonal() - wanted).max()))


def tracked(column: SubsystemColumn, modes: SubsystemModes, Omega: float, eps: FloatArray) -> LogMultipliers:
    """Return what a column found, in the order of the modes of the subsystem."""
    conservative = column.subsystem.reciprocal
    return track_modes(column.found, eps, modes.exponents * (2 * np.pi / Omega), conservative)


def _around(found: LogMultipliers, tongue: ExpectedTongue, Omega: FloatArray, start: int) -> slice:
    """Return the columns that a tongue passes between, and some more on both sides, numbered from ``start``."""
    one = tongue.resonance
    detuning = angle_detuning(found, tongue.p, tongue.q, one.j, one.sign)
    left = np.flatnonzero((detuning.min(axis=1) > 0) & (Omega < one.centre))
    right = np.flatnonzero((detuning.max(axis=1) < 0) & (Omega > one.centre))
    first, last = left[-1] if len(left) else 0, right[0] if len(right) else len(Omega) - 1
    return slice(start + max(first - EXTRA_COLUMNS, 0), start + min(last + EXTRA_COLUMNS + 1, len(Omega)))


def _measures(found: LogMultipliers, tongue: ExpectedTongue) -> tuple[FloatArray, FloatArray]:
    """Return ``f`` and ``detuning`` of `Detuning`, (..., k).

    What one of two damped modes gains from the other, the other loses. Where their mean decay changes by as much as the
    difference, one of them is unstable with a third. Two that are unstable together have the same angle if they are
    damped alike. If not, their angles differ by d_0 x / d, where x is the detuning, and d_0 and d are the differences
    of their decay without and with coupling.
    """
    p, q, one = tongue.p, tongue.q, tongue.resonance
    conservative = tongue.modes.subsystem.reciprocal
    f = pair_test_function(found, p, q, one.j, one.sign, conservative)
    detuning = angle_detuning(found, p, q, one.j, one.sign)
    if not conservative and p != q:
        total = found.modulus[..., p] + found.modulus[..., q]
        difference = found.modulus[..., p] - found.modulus[..., q]
        gain, shift = np.abs(difference - difference[..., :1]), np.abs(total - total[..., :1])
        f = np.where((f > 0) & (shift > MAX_MEAN_CHANGE * gain), np.nan, f)
        if tongue.balance < EQUAL_DAMPING_BALANCE:
            with np.errstate(divide="ignore", invalid="ignore"):
                detuning = detuning * tongue.balance * difference / difference[..., :1]
            f = np.where(np.isfinite(detuning), f, np.nan)
    return f, detuning
