"""One BLAS thread while a chart is computed."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from threading import Lock
from typing import Any

from threadpoolctl import ThreadpoolController

_lock = Lock()
_users: list[None] = []
_limits: list[Any] = []


@contextmanager
def single_blas_thread() -> Iterator[None]:
    """Hold BLAS to one thread: the cores belong to the workers, and rounding must not depend on the number of threads.

    The limit holds for the whole process, so the first worker sets it and the last one lifts it.
    """
    with _lock:
        if not _users:
            _limits.append(_controller().limit(limits=1, user_api="blas"))
        _users.append(None)
    try:
        yield
    finally:
        with _lock:
            _users.pop()
            if not _users:
                _limits.pop().restore_original_limits()


@cache
def _controller() -> ThreadpoolController:
    """Return the BLAS libraries of this process; looking for them takes as long as a column of a chart."""
    return ThreadpoolController()
