"""The axes of a chart: given as values or as a range, said in a line, and the shape of all that is over them."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from floquet.kind import Kind
from periodic.checks import FloatArray, interval


def spread(name: str, values: Any, count: int) -> Any:
    """Return ``count`` values from the first to the second of a tuple of two; all else as it is.

    Raises
    ------
    ValueError
        As `periodic.checks.interval`.
    """
    if isinstance(values, tuple) and len(values) == 2:
        return np.linspace(*interval(name, values), count)
    return values


def hold_cells(chart: Any, names: Iterable[str], shape: tuple[int, ...], like: str) -> None:
    """Make the attributes ``names`` of a frozen chart read-only arrays of one ``shape``, that of its axes.

    Raises
    ------
    ValueError
        If one has another shape; ``like`` says where the right one is from.
    """
    for name in names:
        array = np.asarray(getattr(chart, name))
        if array.shape != shape:
            raise ValueError(f"{name} has shape {array.shape}; give {shape}, as {like}")
        object.__setattr__(chart, name, array)
        array.setflags(write=False)


def described(names: tuple[str, str], axes: tuple[FloatArray, FloatArray], kinds: NDArray[np.int8]) -> str:
    """Return axes and verdicts of a chart in a line."""
    ends = ", ".join(
        f"{name} {values[0]:.6g} to {values[-1]:.6g} ({values.size})" for name, values in zip(names, axes, strict=True)
    )
    unstable, undecided = (kinds > Kind.STABLE).mean(), (kinds == Kind.UNDECIDED).mean()
    doubt = f", {undecided:.1%} undecided" if undecided else ""
    return f"{ends}: {unstable:.1%} of the cells unstable{doubt}"
