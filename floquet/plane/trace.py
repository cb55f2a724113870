"""Boundaries of stability in a plane of two parameters, from its chart."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from itertools import product
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import root
from tqdm import tqdm

from floquet.boundary import Resonance, natural_modes, resonances
from floquet.chart import PlaneChart, Point
from floquet.kind import Kind
from floquet.plane.crossings import Crossing, around, between, within
from floquet.plane.joining import Corner, joined, lines
from floquet.plane.looking import Look, look
from floquet.plane.resonant import Resonant, resonant_lines
from periodic import PeriodicSystem
from periodic.checks import FloatArray, one_of, whole_number

# A corner is accepted so far from the box of the two crossings beside it, in cells: it is in the same square.
CORNER_REACH = 1.0
# Cells on both sides of a resonance that are looked at: its region moves with the square of the amplitude.
CELLS_BESIDE = 2
# States up to which a region is searched for beside the place of its resonance.
MAX_SEARCHED_STATES = 8
# Crossings of one line that are the same, in cells: two resonances may lead to one region.
SAME_CROSSING = 1e-8
# Relative accuracy to which a corner is found.
CORNER_TOLERANCE = 1e-13
# A boundary is named by a resonance that is no further, in Omega, from its points of lowest amplitude.
MAX_NAME_DISTANCE = 0.1
# Of two resonances, the one of higher order is taken if it is this many times nearer for each step in order.
NAME_ORDER_PREFERENCE = 10.0
# Points of a boundary that are asked for its name.
NAMED_POINTS = 5
# Points that are kept, for neighbouring squares to use again.
MAX_KEPT_LOOKS = 200_000


@dataclass(frozen=True, eq=False)
class PlaneBoundary:
    """A boundary between stable and unstable points of a plane.

    Attributes
    ----------
    x, y : ndarray, shape (k,)
        Its points, in order: where it crosses the lines of the chart, and its corners between them.
    kind : int8 ndarray, shape (k,)
        The `Kind` of instability on its unstable side.
    corner : bool ndarray, shape (k,)
        Where two boundaries cross, and the line changes from one to the other.
    closed : bool
        Whether the last point is joined to the first.
    label : str
        The resonance of the same kind, of the system without excitation, that most of its points of lowest amplitude
        are nearest to; empty if none is within 10 %. One of order j counts as 10^(j - 1) times as far.
    """

    x: FloatArray
    y: FloatArray
    kind: NDArray[np.int8]
    corner: NDArray[np.bool_]
    closed: bool
    label: str


class _Node(NamedTuple):
    """A crossing: number ``number`` on the side of the grid that leaves cell (i, j) along a row or a column."""

    i: int
    j: int
    along_row: bool
    number: int


def trace_plane(
    make: Callable[[float, float], Point],
    chart: PlaneChart,
    *,
    orders: int = 1,
    progress: bool | None = None,
) -> list[PlaneBoundary]:
    """Return the boundaries of stability in a plane.

    Parameters
    ----------
    make : callable
        As in `plane_chart`, which made the chart with it.
    chart : PlaneChart
        Says where to look: between neighbouring cells with different verdicts, and near resonances.
    orders : int
        Regions that are narrower than a cell are looked for at the resonances j Omega = omega_p ± omega_q with j up to
        this number; 0 for none.
    progress : bool or None
        Whether to show a progress bar; None shows it on a terminal only.

    Returns
    -------
    list of PlaneBoundary
        The longest first.

    Raises
    ------
    ValueError
        If an argument has the wrong type or value.

    Notes
    -----
    On every line between two neighbouring cells of which one is stable and the other is not, a function that is
    analytic at the edge is taken to zero by Brent's method, to 1e-10 of their distance. Where none changes its sign, as
    at a tip on the line itself, the verdict is halved, which sees growth by a factor of exp(1e-6) in one period of a
    conservative system. Between two cells that are unstable in different ways a stable gap is looked for likewise.
    Undecided cells count as stable: they lie on a boundary. What is narrower than a cell is found where it contains the
    place, between two stable cells, at which a detuning without excitation is zero; of systems of up to eight states
    also if it is within two cells beside. What has moved further with the amplitude is not found. Corners, where
    boundaries of different kinds cross, are solved for both at once. Lines end at refused cells and at the border of
    the chart.
    """
    if not isinstance(chart, PlaneChart):
        raise ValueError(f"chart = {chart!r} is no chart of a plane; give what plane_chart returns")
    orders = whole_number("orders", orders, least=0)
    one_of("progress", progress, (True, False, None))
    tracer = _Tracer(make, chart)
    with tqdm(total=chart.kind.size, unit="cell", disable=None if progress is None else not progress) as bar:
        for cell in product(*map(range, chart.kind.shape)):
            tracer.cross(*cell)
            bar.update()
    if orders:
        for resonant in resonant_lines(make, chart, orders):
            tracer.cross_narrow(resonant)
    return sorted(tracer.boundaries(), key=lambda one: -len(one.x))


class _Tracer:
    """Finds the crossings of all sides of a grid, and joins them."""

    def __init__(self, make: Callable[[float, float], Point], chart: PlaneChart) -> None:
        self.make, self.chart = make, chart
        self.crossings: dict[tuple[int, int, bool], list[Crossing]] = {}
        self.narrow: dict[tuple[int, bool], list[float]] = defaultdict(list)
        self.looks: dict[tuple[float, float], Look] = {}

    def look(self, x: float, y: float) -> Look:
        """Return what is at a point."""
        if (x, y) not in self.looks:
            if len(self.looks) > MAX_KEPT_LOOKS:
                self.looks.clear()
            self.looks[x, y] = look(self.make(x, y))
        return self.looks[x, y]

    def place(self, i: float, j: float) -> tuple[float, float]:
        """Return the point at a place in units of cells."""
        x, y = self.chart.x, self.chart.y
        return float(np.interp(j, np.arange(len(x)), x)), float(np.interp(i, np.arange(len(y)), y))

    def cross(self, i: int, j: int) -> None:
        """Find the crossings of the two sides that leave a cell upwards in i and in j."""
        rows, columns = self.chart.kind.shape
        for along_row, k, m in ((True, i, j + 1), (False, i + 1, j)):
            if k == rows or m == columns or self.chart.refused[[i, k], [j, m]].any():
                continue
            kinds = self.chart.kind[[i, k], [j, m]].clip(min=0)
            if kinds[0] != kinds[1]:
                self._between((i, j, along_row))

    def cross_narrow(self, resonant: Resonant) -> None:
        """Find the crossings of a narrow region near a resonance, along one row or column."""
        line, along_row, kind = resonant.line, resonant.along_row, resonant.kind
        cells = (slice(None), line) if not along_row else (line, slice(None))
        outside = np.flatnonzero(self.chart.refused[cells] | (self.chart.kind[cells] > Kind.STABLE))
        before = outside[outside <= resonant.place].max(initial=-1)
        after = outside[outside > resonant.place].min(initial=self.chart.refused[cells].size)
        first = max(before + 1, resonant.place - CELLS_BESIDE)
        places = range(first, min(after, resonant.place + 2 + CELLS_BESIDE))
        if resonant.place not in places or resonant.place + 1 not in places:  # wide enough to be seen
            return

        def at(position: float) -> Look:
            return self.look(*(self.place(line, position) if along_row else self.place(position, line)))

        try:
            found = around(at, resonant.place, resonant.at, resonant.place + 1.0)
            if not found and self.states(line, places[0], along_row) <= MAX_SEARCHED_STATES:
                found = within(at, [float(p) for p in places], kind)
        except ValueError:  # there is no system in between, or it cannot be integrated
            return
        for crossing in found:
            if any(abs(crossing.at - other) <= SAME_CROSSING for other in self.narrow[line, along_row]):
                return
        self.narrow[line, along_row] += [crossing.at for crossing in found]
        for crossing in found:
            side = int(np.floor(crossing.at))
            key = (line, side, True) if along_row else (side, line, False)
            here = self.crossings.setdefault(key, [])
            here.append(crossing._replace(at=crossing.at - side))
            here.sort()

    def states(self, line: int, place: int, along_row: bool) -> int:
        """Return the number of states of the system in a cell of a row or column."""
        member = self.make(*self.place(*((line, place) if along_row else (place, line)))).member
        return member.size * (2 if isinstance(member, PeriodicSystem) else 1)

    def _between(self, side: tuple[int, int, bool]) -> None:
        """Find the crossings of a side between two cells of different kinds."""
        i, j, along_row = side

        def at(part: float) -> Look:
            return self.look(*(self.place(i, j + part) if along_row else self.place(i + part, j)))

        with suppress(ValueError):  # there is no system in between, or it cannot be integrated
            self.crossings[side] = between(at, 0.0, 1.0)

    def boundaries(self) -> Iterator[PlaneBoundary]:
        """Yield the lines that the crossings make."""
        pairs: list[tuple[_Node, _Node]] = []
        for i, j in product(*(range(count - 1) for count in self.chart.kind.shape)):
            pairs += self._square(i, j)
        for nodes, closed in lines(pairs):
            yield self._line(nodes, closed)

    def _square(self, i: int, j: int) -> list[tuple[_Node, _Node]]:
        """Return which crossings round a square of four cells are joined."""
        if self.chart.refused[i : i + 2, j : j + 2].any():
            return []
        corners = []
        for k, m, along_row, forward in (
            (i, j, True, True),
            (i, j + 1, False, True),
            (i + 1, j, True, False),
            (i, j, False, False),
        ):
            here = list(enumerate(self.crossings.get((k, m, along_row), [])))
            for number, crossing in here if forward else here[::-1]:
                node = _Node(k, m, along_row, number)
                corners.append(Corner(node, crossing.kind, crossing.ahead == forward))
        alternating = all(
            one.begins != other.begins for one, other in zip(corners, corners[1:] + corners[:1], strict=True)
        )
        if len(corners) % 2 or not alternating:  # a side could not be looked at
            return []
        return joined(corners, lambda kind, nodes: self._connected(i, j, kind, nodes))  # type: ignore[return-value,arg-type]

    def _connected(self, i: int, j: int, kind: Kind, nodes: Sequence[_Node]) -> bool:
        """Return whether regions that reach into a square at some crossings are connected: whether it is unstable
        between them, or beside there along the row or the column."""
        places = np.array([self._position(node) for node in nodes])
        row, column = places.mean(axis=0).tolist()

        def along_row(at: float) -> Look:
            return self.look(*self.place(row, at))

        def along_column(at: float) -> Look:
            return self.look(*self.place(at, column))

        try:
            if along_row(column).kind > Kind.STABLE:
                return True
            return bool(within(along_row, (j, column, j + 1.0), kind) or within(along_column, (i, row, i + 1.0), kind))
        except ValueError:  # there is no system in between, or it cannot be integrated
            return False

    def _line(self, nodes: list[_Node], closed: bool) -> PlaneBoundary:
        """Return a boundary through some crossings, with its corners."""
        points = [self._point(node) for node in nodes]
        kinds = [self.crossings[node[:3]][node.number].kind for node in nodes]
        found: list[tuple[float, float, Kind, bool]] = []
        for k, (point, kind) in enumerate(zip(points, kinds, strict=True)):
            found.append((*point, kind, False))
            following = (k + 1) % len(nodes)
            if (following or closed) and kinds[following] != kind:
                corner = self._corner(point, points[following], (kind, kinds[following]))
                if corner is not None:
                    found.append((*corner, kind, True))
        x, y, kind_array, corner_array = (np.array(part) for part in zip(*found, strict=True))
        label = self._label(x, y, kind_array)
        return PlaneBoundary(x, y, kind_array.astype(np.int8), corner_array, closed, label)

    def _point(self, node: _Node) -> tuple[float, float]:
        return self.place(*self._position(node))

    def _position(self, node: _Node) -> tuple[float, float]:
        """Return row and column of a crossing."""
        at = self.crossings[node[:3]][node.number].at
        return (node.i, node.j + at) if node.along_row else (node.i + at, node.j)

    def _corner(
        self, one: tuple[float, float], other: tuple[float, float], kinds: tuple[Kind, Kind]
    ) -> tuple[float, float] | None:
        """Return where two boundaries of different kinds cross, near two of their points; None if they do not."""
        start, unit = np.array(one), np.array([np.ptp(self.chart.x), np.ptp(self.chart.y)])
        unit = unit / np.array([len(self.chart.x) - 1, len(self.chart.y) - 1])

        def values(shift: FloatArray) -> list[float]:
            here = self.look(*(start + shift * unit).tolist())
            return [min(here.of(kind), key=abs) for kind in kinds]

        try:
            found = root(values, (np.array(other) - start) / unit / 2, tol=CORNER_TOLERANCE)
        except ValueError:
            return None
        x, y = (start + found.x * unit).tolist()
        low, high = np.minimum(one, other) - CORNER_REACH * unit, np.maximum(one, other) + CORNER_REACH * unit
        close = max(map(abs, values(found.x))) < 1e-9
        return (x, y) if close and (low <= (x, y)).all() and ((x, y) <= high).all() else None

    def _label(self, x: FloatArray, y: FloatArray, kind: NDArray[np.integer]) -> str:
        """Return the resonances that the points of lowest amplitude are nearest to."""
        chart = self.chart
        amplitude = np.array([abs(self.make(float(a), float(b)).eps) for a, b in zip(x, y, strict=True)])
        step = np.ptp(np.abs(chart.eps[~chart.refused])) / max(chart.kind.shape)
        lowest = np.flatnonzero(amplitude <= amplitude.min() + step)
        names: Counter[str] = Counter()
        for k in lowest[np.unique(np.linspace(0, len(lowest) - 1, NAMED_POINTS).astype(int))]:
            point = self.make(float(x[k]), float(y[k]))
            modes = natural_modes(point.member, point.Omega)
            around = ((1 - MAX_NAME_DISTANCE) * point.Omega, (1 + MAX_NAME_DISTANCE) * point.Omega)
            fitting = [one for one in resonances(modes, around) if one.kind == kind[k]]
            if fitting:
                names[min(fitting, key=partial(_distance, point.Omega)).label] += 1
        return names.most_common(1)[0][0] if names else ""


def _distance(Omega: float, resonance: Resonance) -> float:
    return abs(resonance.centre - Omega) * NAME_ORDER_PREFERENCE ** (resonance.j - 1)
