"""Memoisation with a bound on the memory that results take."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from functools import wraps
from threading import Lock
from typing import Any, TypeVar

import numpy as np

Result = TypeVar("Result")

MAX_MEMO_BYTES = 2**27  # of all results of one function; beyond that they are forgotten
OBJECT_BYTES = 128  # about what a Python object takes besides its data


def memoized(function: Callable[..., Result]) -> Callable[..., Result]:
    """Return ``function`` with its results kept for the next call with the same arguments.

    `functools.lru_cache` bounds the number of results, this bounds their size: at most `MAX_MEMO_BYTES` together.
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
            if size > MAX_MEMO_BYTES:
                results.clear()
                size = _bytes(result)
            results[arguments] = result
        return result

    return wrapper


def _bytes(result: Any) -> int:
    """Return about how much memory a result takes."""
    if isinstance(result, tuple):
        return sum(_bytes(part) for part in result)
    return int(result.nbytes) + OBJECT_BYTES if isinstance(result, np.ndarray) else OBJECT_BYTES
