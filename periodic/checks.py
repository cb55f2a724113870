"""Checks of arguments that every room needs, each raising ValueError with argument, value and remedy."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

# Coordinates up to which a sparse matrix may stand for a dense one.
MAX_DENSE_COORDINATES = 2000

FloatArray = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]


def real_number(name: str, value: Any, *, positive: bool = False, nonnegative: bool = False) -> float:
    """Return ``value`` as a finite float.

    Raises
    ------
    ValueError
        If ``value`` is no real number, is NaN or infinite, or has the wrong sign.
    """
    wanted = "a positive number" if positive else "a number >= 0" if nonnegative else "a finite real number"
    try:
        raw = np.asarray(value)
        if raw.ndim != 0 or raw.dtype.kind not in "fiuO":  # O: Python's own number types, such as Fraction
            raise TypeError
        number = float(value)
    except (TypeError, ValueError, OverflowError):
        raise ValueError(f"{name} = {value!r} is not a number; give {wanted}") from None
    if not math.isfinite(number) or (positive and number <= 0) or (nonnegative and number < 0):
        raise ValueError(f"{name} = {number!r} is out of range; give {wanted}")
    return number


def whole_number(name: str, value: Any, *, least: int, most: int | None = None) -> int:
    """Return ``value`` as an int between ``least`` and ``most``.

    Raises
    ------
    ValueError
        If ``value`` is not a whole number or lies outside.
    """
    wanted = f"a whole number >= {least}" if most is None else f"a whole number from {least} to {most}"
    if isinstance(value, bool | np.bool_) or not isinstance(value, int | np.integer):
        raise ValueError(f"{name} = {value!r} is not a whole number; give {wanted}")
    if value < least or (most is not None and value > most):
        raise ValueError(f"{name} = {value!r} is out of range; give {wanted}")
    return int(value)


def workers(name: str, value: Any) -> int | None:
    """Return a number of joblib workers: 1, 2, ..., -1 for all cores, or None for what ``parallel_config`` says.

    Raises
    ------
    ValueError
        If ``value`` is none of these.
    """
    if value is None:
        return None
    number = whole_number(name, value, least=-1)
    if number == 0:
        raise ValueError(f"{name} = 0 is out of range; give 1, 2, ..., -1 for all cores, or None")
    return number


def one_of(name: str, value: Any, choices: tuple[Any, ...]) -> Any:
    """Return ``value`` if it is one of ``choices``.

    Raises
    ------
    ValueError
        If it is not.
    """
    if not any(type(value) is type(choice) and value == choice for choice in choices):
        raise ValueError(f"{name} = {value!r} is not known; give one of {', '.join(map(repr, choices))}")
    return value


def real_array(name: str, value: ArrayLike, ndim: int | None) -> FloatArray:
    """Return a fresh C-contiguous float64 copy of ``value`` with ``ndim`` axes (None: any) and finite entries.

    Raises
    ------
    ValueError
        If ``value`` is not numeric, is complex, has another number of axes, or holds NaN or infinity.
    """
    raw = _numeric(name, value)
    if ndim is not None and raw.ndim != ndim:
        raise ValueError(f"{name} has shape {raw.shape}; give an array with {ndim} axes")
    array = np.array(raw, dtype=np.float64, order="C")
    if not np.isfinite(array).all():
        where = tuple(int(i) for i in np.argwhere(~np.isfinite(array))[0])
        raise ValueError(f"{name} has the entry {array[where]} at {where}; every entry must be finite")
    return array


def points(Omega: ArrayLike, eps: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Return frequencies and amplitudes as float64 arrays of the same shape.

    Raises
    ------
    ValueError
        As `real_array`, or if the shapes do not broadcast together.
    """
    frequency, amplitude = real_array("Omega", Omega, None), real_array("eps", eps, None)
    try:
        frequency, amplitude = np.broadcast_arrays(frequency, amplitude)
    except ValueError:
        raise ValueError(
            f"Omega has shape {frequency.shape} and eps {amplitude.shape}; give shapes that broadcast together"
        ) from None
    return frequency, amplitude


def grid(name: str, value: ArrayLike, *, positive: bool = False) -> FloatArray:
    """Return ``value`` as a read-only, non-empty, strictly increasing 1-d array (a scalar becomes one point).

    Raises
    ------
    ValueError
        As `real_array`, or if empty, not strictly increasing, or (``positive``) not above zero.
    """
    array = real_array(name, np.atleast_1d(_numeric(name, value)), 1)
    if array.size == 0:
        raise ValueError(f"{name} is empty; give at least one value")
    if (np.diff(array) <= 0).any():
        raise ValueError(f"{name} is not strictly increasing; sort it and remove repeated values")
    if positive and array[0] <= 0:
        raise ValueError(f"{name} starts at {float(array[0])!r}; every value must be positive")
    array.setflags(write=False)
    return array


def interval(name: str, value: Any, *, nonnegative: bool = False) -> tuple[float, float]:
    """Return ``value`` as (low, high) with low < high.

    Raises
    ------
    ValueError
        If it is not a pair of finite numbers in increasing order.
    """
    try:
        low, high = value
    except (TypeError, ValueError):
        raise ValueError(f"{name} = {value!r} is not a pair; give (low, high)") from None
    low = real_number(f"{name}[0]", low, nonnegative=nonnegative)
    high = real_number(f"{name}[1]", high, nonnegative=nonnegative)
    if low >= high:
        raise ValueError(f"{name} = ({low!r}, {high!r}) is empty; give low < high")
    return low, high


def is_positive_definite(matrix: FloatArray) -> bool:
    """Whether a symmetric matrix is positive definite beyond rounding, whatever the units of its coordinates."""
    diagonal = np.diagonal(matrix)
    if (diagonal <= 0).any():
        return False
    scale = 1.0 / np.sqrt(diagonal)  # brings every coordinate to one unit, so that their mixture hides no direction
    lowest = np.linalg.eigvalsh(matrix * scale[:, None] * scale)[0]
    return bool(lowest > len(matrix) * np.finfo(float).eps)


def is_sparse(value: Any) -> bool:
    """Whether ``value`` is a sparse matrix of SciPy, known by its methods: this room needs NumPy alone."""
    return hasattr(value, "tocsr") and hasattr(value, "toarray")


def _numeric(name: str, value: Any) -> NDArray[Any]:
    """Return ``value``, sparse or not, as an array of real numbers; its own memory where it is one already."""
    if is_sparse(value):
        if max(value.shape) > MAX_DENSE_COORDINATES:
            raise ValueError(
                f"{name} is sparse with shape {tuple(value.shape)}; give a model of so many coordinates as a "
                "periodic.SparseSystem, and reduce it with reduction.reduce_model"
            )
        value = value.toarray()
    try:
        raw = np.asarray(value)
    except ValueError:
        raise ValueError(f"{name} is ragged; give rows of equal length") from None
    if raw.dtype.kind not in "fiu":
        raise ValueError(f"{name} has entries of type {raw.dtype}; give real numbers")
    return raw
