"""Your own system from a Python file, for what no file of matrices holds: jumps, functions, parameters."""

from __future__ import annotations

import runpy
from collections.abc import Callable
from pathlib import Path
from typing import Any, cast

from periodic import AnyFamily, SparseSystem, any_member_at

# The function that a file defines.
FUNCTION = "system"
# A family is asked for its member at this frequency, to see whether it has any.
FREQUENCY_TRIED = 1.0


def run_python_file(path: Path) -> AnyFamily | SparseSystem:
    """Execute a file and return what its function ``system()`` returns: a system, or a family such as a plate.

    Raises
    ------
    ValueError
        If it cannot be read or executed, has no such function, the function fails, or returns no system or family.
    """
    function = python_function(path)
    try:
        found = function()
    except (Exception, SystemExit) as error:
        hint = "; its parameters need defaults" if "missing" in str(error) and isinstance(error, TypeError) else ""
        raise ValueError(f"{path}: {FUNCTION}() failed ({_what(error)}){hint}") from error
    if isinstance(found, SparseSystem):
        return found
    try:
        any_member_at(found, FREQUENCY_TRIED, f"what {FUNCTION}() returned")
    except Exception as error:
        raise ValueError(f"{path}: {error}") from error
    return found


def python_function(path: Path) -> Callable[..., Any]:
    """Execute a file and return its function ``system``.

    Raises
    ------
    ValueError
        If it cannot be read or executed, or has no such function.
    """
    if not path.is_file():
        raise ValueError(f"{path}: it is no file")
    try:
        made = runpy.run_path(str(path))
    except (Exception, SystemExit) as error:
        raise ValueError(f"{path}: cannot be executed ({_what(error)})") from error
    function = made.get(FUNCTION)
    if not callable(function):
        raise ValueError(f"{path}: has no function {FUNCTION}(); define one that returns a PeriodicSystem")
    return cast(Callable[..., Any], function)


def _what(error: BaseException) -> str:
    return f"{type(error).__name__}: {error}"
