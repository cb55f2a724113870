"""Stability charts over grids of excitation frequency and amplitude.

`stability_chart` cuts a grid into batches of columns, has the engine compute them on all workers, and returns a
`StabilityChart` (`chart`). It keeps finished tiles in a `TileStore`, so that a chart that was stopped can be continued
(`checkpoint`), and lets `monodromy` integrate some cells again as a check (`audit`).

>>> import numpy as np
>>> from floquet.chart import stability_chart
>>> from periodic.examples import mathieu
>>> chart = stability_chart(mathieu(delta=1.0), np.linspace(1.5, 2.5, 5), [0.1, 0.4], n_jobs=1, progress=False, audit=2)
>>> chart.kind.tolist()  # rows are amplitudes, columns are frequencies; see `Kind`
[[0, 0, 2, 0, 0], [0, 0, 2, 0, 0]]
>>> chart.audit.ok
True
"""

from floquet.chart.audit import ChartAudit
from floquet.chart.chart import StabilityChart, stability_chart, task_columns
from floquet.chart.checkpoint import TileStore, code_version, processor

__all__ = ["ChartAudit", "StabilityChart", "TileStore", "code_version", "processor", "stability_chart", "task_columns"]
