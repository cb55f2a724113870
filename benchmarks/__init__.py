"""The chart engine against its peers: ``python -m benchmarks``, as ``make benchmark`` runs it. Not part of the wheel.

`methods` sets every peer up at the least cost that meets an error, and times all of them in turn with the chart;
`peers` has their integrators. `general` does the same for other systems than eq. (11). `stages` says where the time of
a chart goes. `scaling` says what larger grids, more workers and a first call cost. `limits` fails if a chart has become
slower. `tables` writes the figures into docs/performance.md.

>>> from benchmarks import chart, grids, plate
>>> chart(plate(12, damping=0.0), *grids(columns=2, rows=3)).kind.shape
(3, 2)
"""

from benchmarks.methods import QUICK_PLAN, Comparison, Plan, Timing, compare_methods
from benchmarks.peers import PEERS, Peer
from benchmarks.subjects import chart, grids, plate

__all__ = ["PEERS", "QUICK_PLAN", "Comparison", "Peer", "Plan", "Timing", "chart", "compare_methods", "grids", "plate"]
