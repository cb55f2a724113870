"""Stability charts over grids of excitation frequency and amplitude, or of any two parameters.

`stability_chart` returns a `StabilityChart` over Omega and eps (`chart`). `plane_chart` takes any two parameters and a
function that makes a `Point` of them; it finds out what neighbouring cells share (`grouping`) and returns a
`PlaneChart` (`plane`). Both have the engine compute batches of columns on all workers (`filling`), keep finished tiles
in a `TileStore`, so that a chart that was stopped can be continued (`checkpoint`), and let `monodromy` integrate some
cells again as a check (`audit`).

>>> import numpy as np
>>> from floquet.chart import stability_chart
>>> from periodic.examples import mathieu
>>> chart = stability_chart(mathieu(delta=1.0), np.linspace(1.5, 2.5, 5), [0.1, 0.4], n_jobs=1, progress=False, audit=2)
>>> chart.kind.tolist()  # rows are amplitudes, columns are frequencies; see `Kind`
[[0, 0, 2, 0, 0], [0, 0, 2, 0, 0]]
>>> chart.audit.ok
True

Mathieu's equation in its usual parameters, y'' + (a - 2 q cos 2 z) y = 0:

>>> from floquet.chart import Point, plane_chart
>>> def make(a, q):
...     return Point(mathieu(delta=a), Omega=2.0, eps=2 * q)
>>> plane_chart(make, ("a", [0.5, 0.9, 2.5]), ("q", [0.0, 0.4]), n_jobs=1, progress=False, audit=0)
PlaneChart(a 0.5 to 2.5 (3), q 0 to 0.4 (2): 16.7% of the cells unstable)
"""

from floquet.chart.audit import ChartAudit
from floquet.chart.chart import StabilityChart, stability_chart
from floquet.chart.checkpoint import TileStore, code_version, processor
from floquet.chart.filling import task_columns
from floquet.chart.grouping import key_of
from floquet.chart.plane import PlaneChart, plane_chart
from floquet.chart.point import Point

__all__ = [
    "ChartAudit",
    "PlaneChart",
    "Point",
    "StabilityChart",
    "TileStore",
    "code_version",
    "key_of",
    "plane_chart",
    "processor",
    "stability_chart",
    "task_columns",
]
