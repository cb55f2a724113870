"""What a cell of a chart says: dominant multiplier, its error, and stable, unstable or undecided."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from floquet.multipliers import Kind
from periodic.checks import FloatArray

ANGLE_TOLERANCE = 1e-6  # a dominant multiplier this close to the real axis counts as real


class Cells(NamedTuple):
    """Results of the cells of one column, each of shape (k,)."""

    log_modulus: FloatArray  # log|mu| of the dominant multiplier
    direction: NDArray[np.complex128]  # mu / |mu|, imaginary part >= 0
    error: FloatArray  # estimated error of log_modulus


def dominant(multipliers: NDArray[np.complex128], error: FloatArray) -> Cells:
    """Return the multiplier of largest modulus in each row of ``multipliers`` (k, 2n)."""
    largest = np.take_along_axis(multipliers, np.abs(multipliers).argmax(axis=1)[:, None], axis=1)[:, 0]
    modulus = np.abs(largest)
    mu = largest / modulus
    return Cells(np.log(modulus), mu.real + 1j * np.abs(mu.imag), error)


def judge(cells: Cells) -> NDArray[np.int8]:
    """Return the `Kind` of every cell: unstable where log|mu| exceeds its error, else stable."""
    angle = np.arccos(np.clip(cells.direction.real, -1, 1))
    unstable = np.where(
        angle <= ANGLE_TOLERANCE,
        Kind.PLUS_ONE,
        np.where(angle >= np.pi - ANGLE_TOLERANCE, Kind.MINUS_ONE, Kind.COMPLEX),
    )
    return np.where(cells.log_modulus > cells.error, unstable, Kind.STABLE).astype(np.int8)
