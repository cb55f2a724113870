"""What the cells of a plane share: which of them are one column along eps, and which columns make a batch.

Only what is really the same is shared: the same system, or one that is equal but for the size of its excitation, which
is an amplitude by another name; the same Omega; the same amplitudes. Nothing is assumed of how a system goes with the
parameters of the plane.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Hashable, Iterator, Sequence
from itertools import product
from typing import NamedTuple, cast

import numpy as np
from numpy.typing import NDArray

from floquet.chart.checkpoint import add_array, add_system
from floquet.chart.filling import Batch, Task, task_columns
from floquet.chart.point import Point
from periodic import AnyFamily, FirstOrderSystem, PeriodicSystem
from periodic.checks import FloatArray

# Decimals to which excitations are compared, in units of their largest entry: their sizes differ by rounding.
EXCITATION_DECIMALS = 13
# Makes the point of the cell in a row and a column; None where there is no system.
MakePoint = Callable[[int, int], Point | None]


class Column(NamedTuple):
    """Cells of one system at one frequency.

    ``cells`` are numbers of cells in the whole plane, row by row, and ``rows`` (as many) the places of their amplitudes
    in ``eps``, which is strictly increasing.
    """

    system: AnyFamily
    Omega: float
    eps: FloatArray
    cells: NDArray[np.intp]
    rows: NDArray[np.intp]


class Lines(NamedTuple):
    """The lines of a plane along which most is shared: its rows or its columns."""

    shape: tuple[int, int]
    along_rows: bool

    @property
    def number(self) -> int:
        """Number of lines."""
        return self.shape[0] if self.along_rows else self.shape[1]

    def cells(self, line: int) -> list[tuple[int, int]]:
        """Return row and column of each cell of a line."""
        if self.along_rows:
            return [(line, j) for j in range(self.shape[1])]
        return [(i, line) for i in range(self.shape[0])]

    def tasks(self, make: MakePoint) -> Iterator[Task]:
        """Yield the tasks that compute the plane."""
        for lines in task_columns(self.number):
            here = range(lines.start, lines.stop)
            groups = batches(columns([cell for line in here for cell in self.cells(line)], self.shape[1], make))
            places, sources, done = [], [], 0
            computed = []
            for group in groups:
                eps = group[0].eps
                Omega = np.array([column.Omega for column in group])
                computed.append(Batch([column.system.at(column.Omega) for column in group], Omega, eps))
                for i, column in enumerate(group):
                    places.append(column.cells)
                    sources.append(done + column.rows * len(group) + i)
                done += len(group) * len(eps)
            if computed:
                yield Task(computed, np.concatenate(places), np.concatenate(sources), len(here))


def shared_lines(shape: tuple[int, int], make: MakePoint) -> Lines:
    """Return the lines along which cells share most, from the cells at the ends and in the middle of both axes."""
    rows, columns = ([0, count // 2, count - 1] for count in shape)
    known = {cell: make(*cell) for cell in product(rows, columns)}
    down = sum(_shared([known[i, j] for i in rows]) for j in columns)
    across = sum(_shared([known[i, j] for j in columns]) for i in rows)
    return Lines(shape, along_rows=across > down)


def _shared(points: Sequence[Point | None]) -> int:
    """Return 2 if points are on one column along eps, 1 if they have one system, else 0."""
    there = [point for point in points if point is not None]
    keys = {_shape_and_size(point.system)[0] for point in there}
    if len(there) < 2 or len(keys) > 1:
        return 0
    return 2 if len({point.Omega for point in there}) == 1 else 1


def key_of(system: AnyFamily) -> Hashable:
    """Return what equal systems, or equal families, have in common."""
    if isinstance(system, PeriodicSystem | FirstOrderSystem):
        digest = hashlib.sha256()
        add_system(digest, system)
        return digest.digest()
    try:
        hash(system)
    except TypeError:
        return id(system)
    return cast(Hashable, system)


def _shape_and_size(system: AnyFamily) -> tuple[Hashable, float]:
    """Return what systems have in common that differ only in the size of their excitation, and that size."""
    if not isinstance(system, PeriodicSystem | FirstOrderSystem) or any(term.power != 1 for term in system.terms):
        return key_of(system), 1.0
    excited = [system.cosine, system.sine, *(term.matrix for term in system.terms)]
    size = max((float(X.flat[np.abs(X).argmax()]) for X in excited), key=abs)
    if size == 0:
        return key_of(system), 1.0
    digest = hashlib.sha256(repr([(term.of, term.waveform) for term in system.terms]).encode())
    for name, array in vars(system).items():
        if name not in ("cosine", "sine", "terms"):
            add_array(digest, array)
    for X in excited:
        add_array(digest, np.round(X / size, EXCITATION_DECIMALS) + 0.0)  # one zero, not two
    return (type(system), digest.digest()), size


def columns(cells: Sequence[tuple[int, int]], width: int, make: MakePoint) -> list[Column]:
    """Return the columns along eps that some cells of a plane of ``width`` columns belong to."""
    first: dict[Hashable, tuple[AnyFamily, float]] = {}
    found: dict[tuple[Hashable, float], list[tuple[float, int]]] = {}
    last: AnyFamily | None = None
    key: Hashable = None
    size = 1.0
    for i, j in cells:
        point = make(i, j)
        if point is None:
            continue
        if point.system is not last:
            last = point.system
            key, size = _shape_and_size(last)
            first.setdefault(key, (last, size))
        amplitude = point.eps * (size / first[key][1])
        found.setdefault((key, point.Omega), []).append((amplitude, i * width + j))
    made = []
    for (key, Omega), members in found.items():
        amplitudes, places = zip(*members, strict=True)
        eps, rows = np.unique(np.array(amplitudes), return_inverse=True)
        made.append(Column(first[key][0], Omega, eps, np.array(places, np.intp), rows.astype(np.intp)))
    return made


def batches(columns: Sequence[Column]) -> list[list[Column]]:
    """Return columns of the same system and amplitudes together, by frequency."""
    found: dict[tuple[int, bytes], list[Column]] = {}
    for column in columns:
        found.setdefault((id(column.system), column.eps.tobytes()), []).append(column)
    return [sorted(group, key=lambda column: column.Omega) for group in found.values()]
