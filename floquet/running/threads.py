"""One BLAS thread while a chart is computed."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from threading import Lock
from typing import Any

import threadpoolctl

_lock = Lock()
_users: list[None] = []
_limits: list[Any] = []


@contextmanager
def single_blas_thread() -> Iterator[None]:
    """Hold BLAS to one thread: workers use the cores, and rounding must not depend on the number of threads.

    The limit holds for the whole process. The first worker sets it, and the last one lifts it.
    """
    with _lock:
        if not _users:
            _free_control()
            _limits.append(_controller().limit(limits=1, user_api="blas"))
        _users.append(None)
    try:
        yield
    finally:
        with _lock:
            _users.pop()
            if not _users:
                _free_control()
                _limits.pop().restore_original_limits()
                _free_control()


@cache
def _controller() -> threadpoolctl.ThreadpoolController:
    """Return the control of the BLAS libraries of this process; to find them takes as long as a column of a chart."""
    return threadpoolctl.ThreadpoolController()


def _free_control() -> None:
    """Let any thread change the number of BLAS threads.

    Since version 3.8, threadpoolctl obeys only the first thread that did so, and silently ignores all others.
    """
    clear = getattr(threadpoolctl.OpenBLASController, "clear_controlling_thread", None)
    if clear is not None:
        clear(force=True)
