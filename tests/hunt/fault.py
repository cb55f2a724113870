"""What a deliberate fault is."""

from __future__ import annotations

from typing import NamedTuple


class Fault(NamedTuple):
    """``name`` says what is wrong in ``file`` once ``old`` reads ``new``; ``tests`` below tests/ must find it.

    ``old`` must be in the file exactly once. ``compiled`` faults are in functions that Numba compiles into others, so
    that they need a compilation from scratch.
    """

    name: str
    file: str
    old: str
    new: str
    tests: str
    compiled: bool = False
