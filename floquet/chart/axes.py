"""The axes of a chart: given as values or as a range, and said in a line."""

from __future__ import annotations

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


def described(names: tuple[str, str], axes: tuple[FloatArray, FloatArray], kinds: NDArray[np.int8]) -> str:
    """Return axes and verdicts of a chart in a line."""
    ends = ", ".join(
        f"{name} {values[0]:.6g} to {values[-1]:.6g} ({values.size})" for name, values in zip(names, axes, strict=True)
    )
    unstable, undecided = (kinds > Kind.STABLE).mean(), (kinds == Kind.UNDECIDED).mean()
    doubt = f", {undecided:.1%} undecided" if undecided else ""
    return f"{ends}: {unstable:.1%} of the cells unstable{doubt}"
