"""A system over any two of its parameters: chart, boundaries, files."""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from numpy.typing import ArrayLike

from compare.audit import audit_sentence
from compare.pictures import plane_picture
from floquet import Kind, PlaneBoundary, PlaneChart, Point, plane_chart, trace_plane
from floquet.chart import TileStore

# Boundaries that get a line of text: as many as fit a screen.
MAX_BOUNDARY_LINES = 20


@dataclass(frozen=True, eq=False)
class PlaneExploration:
    """A chart over two parameters with its boundaries; ``traced`` is false if these were not asked for."""

    title: str
    chart: PlaneChart
    boundaries: list[PlaneBoundary]
    traced: bool

    @property
    def remark(self) -> str:
        """What there is to say of the chart: refused and undecided cells, and its audit."""
        chart = self.chart
        undecided = int(((chart.kind == Kind.UNDECIDED) & ~chart.refused).sum())
        doubt = f"{undecided} cells are undecided: their errors allow both verdicts." if undecided else ""
        refused = f"{chart.remark}." if chart.remark else ""
        return " ".join(filter(None, (audit_sentence(chart.audit), doubt, refused)))

    def lines(self) -> list[str]:
        """Return a line of text for each of the longest boundaries, and a last one that counts the others."""
        across, up = self.chart.names
        found = [
            f"{one.label or 'no resonance near'}: {', '.join(_kinds(one))}; {len(one.x)} points, {across} from "
            f"{one.x.min():.6g} to {one.x.max():.6g}, {up} from {one.y.min():.6g} to {one.y.max():.6g}"
            + "".join(
                f"; corner at {across} = {x:.12g}, {up} = {y:.12g}"
                for x, y in zip(one.x[one.corner], one.y[one.corner], strict=True)
            )
            for one in self.boundaries[:MAX_BOUNDARY_LINES]
        ]
        rest = len(self.boundaries) - MAX_BOUNDARY_LINES
        return [*found, f"and {rest} shorter boundaries"] if rest > 0 else found

    def write(self, folder: Path, name: str, *, netcdf: bool = False) -> None:
        """Write ``name``.png, .pdf, -boundaries.json and .npz; with ``netcdf`` also ``name``.nc.

        Raises
        ------
        ValueError
            If ``netcdf`` is asked for without the package xarray.
        """
        figure = plane_picture(self.chart, self.boundaries, title=self.title)
        for suffix in ("png", "pdf"):
            figure.savefig(folder / f"{name}.{suffix}")
        plain = [_plain(one) for one in self.boundaries] if self.traced else None
        (folder / f"{name}-boundaries.json").write_text(json.dumps(plain, ensure_ascii=False), encoding="utf-8")
        self.chart.save(folder / f"{name}.npz")
        if netcdf:
            try:
                data = self.chart.to_xarray()
            except ImportError:
                raise ValueError("NetCDF needs xarray; install it with: pip install 'floquet-charts[xarray]'") from None
            # NetCDF has neither complex numbers nor truth values
            data = data.assign(multiplier_real=data.multiplier.real, multiplier_imag=data.multiplier.imag)
            data = data.assign(refused=data.refused.astype("int8")).drop_vars("multiplier")
            data.to_netcdf(folder / f"{name}.nc", engine="scipy")


def explore_plane(
    make: Callable[[float, float], Point],
    x: tuple[str, ArrayLike],
    y: tuple[str, ArrayLike],
    *,
    trace: bool = True,
    title: str = "",
    n_jobs: int = -1,
    progress: bool = False,
    cache: str | os.PathLike[str] | TileStore | None = None,
) -> PlaneExploration:
    """Integrate a system over two parameters and trace the boundaries; the arguments are those of `plane_chart`.

    Raises
    ------
    ValueError
        As `floquet.plane_chart`.
    """
    chart = plane_chart(make, x, y, n_jobs=n_jobs, progress=progress, cache=cache)
    boundaries = trace_plane(make, chart, progress=progress) if trace else []
    return PlaneExploration(title, chart, boundaries, trace)


def _kinds(boundary: PlaneBoundary) -> list[str]:
    words = {Kind.PLUS_ONE: "at +1", Kind.MINUS_ONE: "at −1", Kind.COMPLEX: "complex pair"}
    return [words[kind] for kind in words if (boundary.kind == kind).any()]


def _plain(boundary: PlaneBoundary) -> dict[str, Any]:
    """Return a boundary as numbers and strings, fit for JSON."""
    arrays = {name: getattr(boundary, name).tolist() for name in ("x", "y", "kind", "corner")}
    return {"label": boundary.label, "closed": boundary.closed, **arrays}
