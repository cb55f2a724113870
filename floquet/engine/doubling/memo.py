"""Results kept for the next call with the same arguments, as long as they do not take too much memory."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from functools import wraps
from threading import Lock
from typing import Any, TypeVar

import numpy as np

Result = TypeVar("Result")

MOST_BYTES = 2**27  # of all results of a function; then it starts again with none


def kept(function: Callable[..., Result]) -> Callable[..., Result]:
    """Return ``function`` with its results kept; `functools.lru_cache` would count them, whatever their size.

    Arguments are positional and hashable; results are None, arrays, or tuples of these.
    """
    results: dict[tuple[Hashable, ...], Result] = {}
    lock, size = Lock(), 0

    @wraps(function)
    def wrapper(*arguments: Hashable) -> Result:
        nonlocal size
        try:
            return results[arguments]
        except KeyError:
            result = function(*arguments)
        with lock:
            size += _bytes(result)
            if size > MOST_BYTES:
                results.clear()
                size = _bytes(result)
            results[arguments] = result
        return result

    return wrapper


def _bytes(result: Any) -> int:
    """Return the memory that a result takes, a little for anything but an array."""
    if isinstance(result, tuple):
        return sum(_bytes(part) for part in result)
    return int(result.nbytes) + 128 if isinstance(result, np.ndarray) else 128
