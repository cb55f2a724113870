"""The shared definition of a periodic system: data and validation, no method."""

from periodic.system import PeriodicSystem, SystemFamily

__all__ = ["PeriodicSystem", "SystemFamily"]
