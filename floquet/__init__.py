"""Stability from Floquet multipliers: one point, charts, and boundaries by root-finding."""

from floquet.boundary import BoundaryTrace, trace_boundary
from floquet.chart import StabilityChart, stability_chart
from floquet.kind import Kind
from floquet.oracle import Monodromy, monodromy
from floquet.regions import Region, trace_regions

__all__ = [
    "BoundaryTrace",
    "Kind",
    "Monodromy",
    "Region",
    "StabilityChart",
    "monodromy",
    "stability_chart",
    "trace_boundary",
    "trace_regions",
]
