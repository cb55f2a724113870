"""Stability from Floquet multipliers: one point, charts, and boundaries by root-finding."""

from floquet.monodromy import Monodromy, monodromy
from floquet.multipliers import Kind

__all__ = ["Kind", "Monodromy", "monodromy"]
