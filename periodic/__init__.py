"""The shared definition of a periodic system: data and validation, no method."""

from periodic.system import PeriodicSystem, SystemFamily, member_at

__all__ = ["PeriodicSystem", "SystemFamily", "member_at"]
