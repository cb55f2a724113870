"""One sentence when Numba begins to compile, which takes a while and would be silent."""

from __future__ import annotations

from functools import cache
from typing import Any

from numba.core import event

COMPILING = "compiling the integrator, once for this version on this machine: this may take a minute or two"


class _Announcement(event.Listener):
    """Says once that something is being compiled. What Numba loads from its cache is not compiled."""

    def __init__(self) -> None:
        self._said = False

    def on_start(self, event: Any) -> None:
        if not self._said:
            self._said = True
            print(COMPILING, flush=True)

    def on_end(self, event: Any) -> None:
        """Say nothing: results follow."""


@cache
def announce_compilation() -> None:
    """Say it when a kernel is compiled in this process, once, however often this is called."""
    event.register("numba:compile", _Announcement())
