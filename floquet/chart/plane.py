"""Stability charts over any two parameters of a system."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from floquet.chart.audit import ChartAudit
from floquet.chart.axes import described, hold_cells, spread
from floquet.chart.checkpoint import TileStore
from floquet.chart.filling import CELL_ARRAYS, audited, checked_options, filled
from floquet.chart.grouping import Column, Lines, columns, shared_lines
from floquet.chart.point import Point
from floquet.chart.saving import data_set, load_arrays, save_arrays
from floquet.engine import rigid_motions, steps_needed
from periodic import AnySystem, any_member_at
from periodic.checks import ComplexArray, FloatArray, grid

# Values of a parameter that is asked for by a range.
VALUES_IN_RANGE = 128


@dataclass(frozen=True, eq=False, repr=False)
class PlaneChart:
    """Growth rate, dominant multiplier and verdict over two parameters; made by `plane_chart`.

    Attributes
    ----------
    names : (str, str)
        What the two parameters are called, x first.
    x : ndarray, shape (m,)
    y : ndarray, shape (k,)
    Omega, eps : ndarray, shape (k, m)
        Frequency and amplitude of the excitation in each cell, in the units of the system and dimensionless.
    growth_rate, multiplier, kind, error : ndarray, shape (k, m)
        As in `StabilityChart`.
    refused : bool ndarray, shape (k, m)
        Where there is no system, because its parameters were refused. Such a cell has no verdict: its ``kind`` is
        UNDECIDED, everything else is NaN.
    remark : str
        How many cells were refused, the first of them and why; empty if none.
    audit : ChartAudit or None
        Some of the cells, integrated again by `monodromy`.
    rigid : int
        Largest number of rigid motions at the ends and in the middle of the plane; see `StabilityChart`.

    Raises
    ------
    ValueError
        If the shapes do not fit, or an axis is not strictly increasing.
    """

    names: tuple[str, str]
    x: FloatArray
    y: FloatArray
    Omega: FloatArray
    eps: FloatArray
    growth_rate: FloatArray
    multiplier: ComplexArray
    kind: NDArray[np.int8]
    error: FloatArray
    refused: NDArray[np.bool_]
    remark: str = ""
    audit: ChartAudit | None = None
    rigid: int = 0

    def __post_init__(self) -> None:
        object.__setattr__(self, "x", grid(self.names[0], self.x))
        object.__setattr__(self, "y", grid(self.names[1], self.y))
        like = f"{self.names[1]} and {self.names[0]}"
        hold_cells(self, ("Omega", "eps", *CELL_ARRAYS, "refused"), (self.y.size, self.x.size), like)

    def __repr__(self) -> str:
        refused = f", {self.refused.mean():.1%} refused" if self.refused.any() else ""
        return f"PlaneChart({described(self.names, (self.x, self.y), self.kind[~self.refused])}{refused})"

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the chart to the .npz file ``path``, which is replaced only once the new file is complete.

        Raises
        ------
        ValueError
            If ``path`` is not a path.
        OSError
            If the file cannot be written.
        """
        names = ("names", "x", "y", "Omega", "eps", *CELL_ARRAYS, "refused", "remark", "rigid")
        save_arrays(path, {name: getattr(self, name) for name in names}, self.audit)

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> PlaneChart:
        """Return the chart that `save` wrote to ``path``.

        Raises
        ------
        OSError
            If there is no such file.
        ValueError
            If ``path`` is not a path, or the file is not a chart of a plane.
        """

        def made(arrays: Mapping[str, NDArray[Any]], audit: ChartAudit | None) -> PlaneChart:
            cells = {name: arrays[name] for name in ("x", "y", "Omega", "eps", *CELL_ARRAYS, "refused")}
            x, y = arrays["names"].tolist()
            return cls((x, y), **cells, remark=str(arrays["remark"]), audit=audit, rigid=int(arrays["rigid"]))

        return load_arrays(path, made)

    def to_xarray(self) -> Any:
        """Return the chart as an `xarray.Dataset` with the dimensions (y, x) under their names.

        Raises
        ------
        ImportError
            If xarray is not installed.
        """
        names = [name for name in ("Omega", "eps", *CELL_ARRAYS, "refused") if name not in self.names]
        cells = {name: getattr(self, name) for name in names}
        across, up = self.names
        return data_set(cells, (up, across), {across: self.x, up: self.y}, rigid=self.rigid, remark=self.remark)


def plane_chart(
    make: Callable[[float, float], Point],
    x: tuple[str, ArrayLike],
    y: tuple[str, ArrayLike],
    *,
    n_jobs: int | None = -1,
    progress: bool | None = None,
    audit: int = 16,
    cache: str | os.PathLike[str] | TileStore | None = None,
) -> PlaneChart:
    """Integrate a periodic system at every point of a grid over any two parameters and return its stability chart.

    Parameters
    ----------
    make : callable
        ``make(x, y)`` returns the `Point` at these parameters, always the same one; it raises ValueError where there is
        no system, as for a web above its divergence speed.
    x, y : (str, array_like)
        Name and values of each parameter; the values are strictly increasing. A tuple of two is a range: 128 values
        from the first to the second. A list of two is two values.
    n_jobs, progress, audit, cache
        As in `stability_chart`.

    Returns
    -------
    PlaneChart

    Raises
    ------
    ValueError
        If an argument has the wrong type or value; if ``make`` returns no `Point`, or refuses all cells; if a period
        needs too many steps; if ``cache`` cannot be written to.

    Notes
    -----
    ``make`` is called in the main process, about once for each cell. It may build what it needs anew every time, or
    keep what is dear to build, with `functools.cache` for example. What neighbouring cells share is found out, and
    computed once: cells of one system at one Omega are one column along eps, as in `stability_chart`, and so are cells
    of systems that are equal but for the size of their excitation. Planes that have such columns along one axis are as
    fast; with one amplitude for each system and Omega a cell costs as much as a short column. See docs/planes.md.
    """
    if not callable(make):
        raise ValueError(f"make = {make!r} cannot be called; give a function of two parameters that returns a Point")
    (across, x_values), (up, y_values) = _axis("x", x), _axis("y", y)
    if across == up:
        raise ValueError(f"x and y are both called {up!r}; give two names")
    options = checked_options(n_jobs, progress, audit, cache)
    plane = _Plane(make, (across, up), (x_values, y_values))
    lines = shared_lines(plane.shape, plane.point)
    measured = plane.measured(lines)
    steps = max(steps_needed([c.system.at(c.Omega)], np.array([c.Omega]), c.eps) for c in measured)
    Omega, eps = np.full(plane.shape, np.nan), np.full(plane.shape, np.nan)

    def noted(i: int, j: int) -> Point | None:
        found = plane.point(i, j, note=True)
        if found is not None:
            Omega[i, j], eps[i, j] = found.Omega, found.eps
        return found

    def again(i: int, j: int) -> tuple[AnySystem, float, float]:
        found = plane.point(i, j)
        assert found is not None  # it was there before
        return found.member, found.Omega, found.eps

    unit = "row" if lines.along_rows else "column"
    cells = filled(plane.shape, lines.tasks(noted), steps, options, lines=lines.number, unit=unit)
    return PlaneChart(
        plane.names,
        x_values,
        y_values,
        Omega,
        eps,
        **cells._asdict(),
        refused=np.isnan(Omega),
        remark=plane.remark,
        audit=audited(cells, Omega, again, options),
        rigid=max(rigid_motions(c.system.at(c.Omega), c.Omega) for c in measured),
    )


class _Plane:
    """The cells of a plane, and which of them were refused."""

    def __init__(
        self, make: Callable[[float, float], Point], names: tuple[str, str], axes: tuple[FloatArray, FloatArray]
    ) -> None:
        self.make, self.names = make, names
        self.x, self.y = (axis.tolist() for axis in axes)
        self.shape = (len(self.y), len(self.x))
        self.refused, self.first = 0, ""

    def at(self, i: int, j: int) -> str:
        """Say where a cell is."""
        return f"{self.names[0]} = {self.x[j]!r}, {self.names[1]} = {self.y[i]!r}"

    def point(self, i: int, j: int, *, note: bool = False) -> Point | None:
        """Return the point of a cell; None if it is refused, which is noted on request."""
        try:
            found = self.make(self.x[j], self.y[i])
        except ValueError as error:
            if note:
                self.refused += 1
                self.first = self.first or f"{self.at(i, j)}: {error}"
            return None
        if not isinstance(found, Point):
            raise ValueError(f"make gave {found!r} at {self.at(i, j)}; it must give a Point(system, Omega, eps)")
        any_member_at(found.system, found.Omega, "system")
        return found

    @property
    def remark(self) -> str:
        """How many cells were refused, and why the first of them was."""
        if not self.refused:
            return ""
        return f"{self.refused} of {self.shape[0] * self.shape[1]} cells are no system, first {self.first}"

    def measured(self, lines: Lines) -> list[Column]:
        """Return the columns at which the steps are measured: at the ends and in the middle of lines like these.

        Where these are refused, the first cell that is not.
        """
        across, along = lines.number, self.shape[lines.along_rows]
        found = []
        for line in _ends(across):
            whole = lines.cells(line)
            ends = [whole[k] for k in _ends(along)]
            here = columns(ends, self.shape[1], self.point)
            if len(here) == 1 and here[0].eps.size > 1:  # a column along eps
                here = columns(whole, self.shape[1], self.point)
            found += here
        if found:
            return found
        for i, j in product(*map(range, self.shape)):
            if here := columns([(i, j)], self.shape[1], lambda i, j: self.point(i, j, note=True)):
                self.refused, self.first = 0, ""
                return here
        raise ValueError(f"make refuses all {self.refused} cells, first {self.first}")


def _ends(count: int) -> list[int]:
    return np.unique([0, count // 2, count - 1]).tolist()


def _axis(name: str, value: Any) -> tuple[str, FloatArray]:
    """Return name and values of an axis."""
    if not isinstance(value, tuple | list) or len(value) != 2 or not isinstance(value[0], str):
        raise ValueError(f'{name} = {value!r} is no axis; give a name and values, as in ("a", [0.0, 0.5, 1.0])')
    if not value[0] or value[0] in (*CELL_ARRAYS, "refused"):
        raise ValueError(f"{name} is called {value[0]!r}; give the parameter another name")
    where = f"{name} ({value[0]})"
    return value[0], grid(where, spread(where, value[1], VALUES_IN_RANGE))
