"""Boundaries of stability over any two parameters.

`trace_plane` goes over the sides of a `PlaneChart`. It finds where boundaries cross them (`crossings`), by functions of
the multipliers that change their sign at an edge (`looking`), and looks for regions that are narrower than a cell where
the system without excitation is in resonance (`resonant`). It joins the crossings to lines (`joining`), solves for
their corners and names them (`trace`).

>>> import numpy as np
>>> from floquet.chart import Point, plane_chart
>>> from floquet.plane import trace_plane
>>> from periodic.examples import mathieu
>>> def make(a, q):  # y'' + (a - 2 q cos 2 z) y = 0
...     return Point(mathieu(delta=a), Omega=2.0, eps=2 * q)
>>> chart = plane_chart(make, ("a", np.linspace(0.1, 2, 6)), ("q", [0.1, 0.3, 0.5]), n_jobs=1, progress=False)
>>> left, right = trace_plane(make, chart, progress=False)
>>> left.label, right.label, [f"{a:.6f}" for a in left.x]
('2ω₁', '2ω₁', ['0.898766', '0.860000', '0.689166', '0.480000', '0.470654'])
"""

from floquet.plane.trace import PlaneBoundary, trace_plane

__all__ = ["PlaneBoundary", "trace_plane"]
