"""Where a plane crosses a resonance: the detuning of the system without excitation changes its sign between cells."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator
from itertools import combinations_with_replacement
from typing import NamedTuple

import numpy as np

from floquet.boundary import natural_modes
from floquet.chart import PlaneChart, Point, key_of
from floquet.kind import Kind
from periodic.checks import FloatArray


class Resonant(NamedTuple):
    """Where, in cells of the row or column number ``line``, a detuning is zero: ``at``, which is after cell ``place``.

    A region of ``kind`` may be near there.
    """

    line: int
    along_row: bool
    place: int
    at: float
    kind: Kind


def resonant_lines(make: Callable[[float, float], Point], chart: PlaneChart, orders: int) -> Iterator[Resonant]:
    """Yield the places where a row or a column crosses a resonance j Omega = omega_p ± omega_q with j up to ``orders``.

    Modes are numbered by frequency in every cell. Where two change places nothing is yielded that is not looked at.
    """
    omega, together = _frequencies(make, chart)
    n = omega.shape[2]
    for q, p in combinations_with_replacement(range(n), 2):
        for sign in (1, -1) if p != q else (1,):
            for j in range(1, orders + 1):
                kind = Kind.COMPLEX if p != q else Kind.PLUS_ONE if j % 2 == 0 else Kind.MINUS_ONE
                detuning = j * chart.Omega - omega[:, :, p] - sign * omega[:, :, q]
                detuning[(chart.eps == 0) | ~(together[:, :, p] == together[:, :, q])] = np.nan
                for along_row, table in ((True, detuning), (False, detuning.T)):
                    for line, place in np.argwhere(table[:, 1:] * table[:, :-1] < 0).tolist():
                        before, after = table[line, place : place + 2]
                        yield Resonant(line, along_row, place, place + float(before / (before - after)), kind)


def _frequencies(make: Callable[[float, float], Point], chart: PlaneChart) -> tuple[FloatArray, FloatArray]:
    """Return the frequencies of the modes in each cell by increasing size, and the subsystem of each, (k, m, n).

    NaN where there are fewer, or no system.
    """
    known: dict[Hashable, tuple[FloatArray, FloatArray]] = {}
    cells = []
    for i, j in np.ndindex(*chart.kind.shape):
        if chart.refused[i, j]:
            cells.append((np.zeros(0), np.zeros(0)))
            continue
        point = make(float(chart.x[j]), float(chart.y[i]))
        key = key_of(point.member)
        if key not in known:
            modes = natural_modes(point.member, point.Omega)
            known[key] = modes.exponents.imag, modes.subsystem.astype(float)
        cells.append(known[key])
    n = max((len(omega) for omega, _ in cells), default=0)
    tables = np.full((2, len(cells), n), np.nan)
    for c, pair in enumerate(cells):
        for table, values in zip(tables, pair, strict=True):
            table[c, : len(values)] = values
    return tables[0].reshape(*chart.kind.shape, n), tables[1].reshape(*chart.kind.shape, n)
