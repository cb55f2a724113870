"""Stability from Floquet multipliers: one point, a chart, the edges of one region, all regions of a window, proofs.

One point, with its error; what is found is a `Kind`:

>>> from floquet import monodromy
>>> from periodic.examples import mathieu
>>> monodromy(mathieu(), Omega=2.0, eps=0.1).kind.name
'MINUS_ONE'

A grid of points:

>>> from floquet import stability_chart
>>> chart = stability_chart(mathieu(), [1.9, 2.0, 2.1], [0.1, 0.3], n_jobs=1, progress=False)
>>> chart.kind.tolist()
[[0, 2, 0], [2, 2, 2]]

Any two parameters, here those of Mathieu's equation, y'' + (a - 2 q cos 2 z) y = 0:

>>> from floquet import Point, plane_chart
>>> def make(a, q):
...     return Point(mathieu(delta=a), Omega=2.0, eps=2 * q)
>>> plane = plane_chart(make, ("a", [0.0, 1.0, 4.0]), ("q", [0.0, 0.5]), n_jobs=1, progress=False)
>>> plane.kind[1].tolist()
[0, 2, 1]
>>> from floquet import trace_plane
>>> [boundary.label for boundary in trace_plane(make, plane, orders=0, progress=False)]
['2ω₁', '2ω₁/2']

The edges of the region near a frequency, and every region of a window:

>>> from floquet import trace_boundary, trace_regions
>>> trace = trace_boundary(mathieu(), near=2.0, eps=[0.1])
>>> print(f"{trace.lower[0]:.4f} to {trace.upper[0]:.4f}")
1.9497 to 2.0497
>>> [region.label for region in trace_regions(mathieu(), (0.8, 2.5), (0.0, 0.3), progress=False)]
['2ω₁/2', '2ω₁']

How the system moves at a point:

>>> from floquet import floquet_modes
>>> growing = floquet_modes(mathieu(), Omega=2.0, eps=0.1)[0]
>>> print(f"at frequency {growing.frequency:.3f}, damping ratio {growing.damping_ratio:.4f}")
at frequency 1.000, damping ratio -0.0250

Rooms, each using those below it: `regions` and `plane`; `chart` and `boundary`; `modes`; `engine`, `oracle` and
`certified`, which share no code and check each other; `running`; `kind`. `floquet.certified` proves verdicts and needs
python-flint; its `prove_chart` proves whole charts.
"""

from typing import Any

from floquet.boundary import BoundaryTrace, trace_boundary
from floquet.chart import PlaneChart, Point, StabilityChart, plane_chart, stability_chart
from floquet.kind import Kind
from floquet.modes import FloquetModes, floquet_modes
from floquet.oracle import Monodromy, monodromy
from floquet.plane import PlaneBoundary, trace_plane
from floquet.regions import Region, Regions, trace_regions

__all__ = [
    "BoundaryTrace",
    "FloquetModes",
    "Kind",
    "Monodromy",
    "PlaneBoundary",
    "PlaneChart",
    "Point",
    "ProvedChart",
    "Region",
    "Regions",
    "StabilityChart",
    "floquet_modes",
    "monodromy",
    "plane_chart",
    "prove_chart",
    "stability_chart",
    "trace_boundary",
    "trace_plane",
    "trace_regions",
]


def __getattr__(name: str) -> Any:
    if name in ("ProvedChart", "prove_chart"):  # they need python-flint, an extra
        from floquet import certified

        return getattr(certified, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
