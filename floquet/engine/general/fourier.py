"""Fourier sums with matrices as coefficients, by powers of eps.

A sum is a dictionary from (power, harmonic) to a complex matrix Z: it is the sum of eps^power Re(Z exp(i j theta)).
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from periodic.checks import ComplexArray, FloatArray
from periodic.waveforms import Trigonometric

Sums = dict[tuple[int, int], ComplexArray]


def constant(X: FloatArray) -> Sums:
    """Return the sum that is ``X`` at all times and amplitudes."""
    return {(0, 0): X.astype(complex)}


def waves(power: int, waveform: Trigonometric, X: FloatArray) -> Sums:
    """Return eps^power g(theta) X."""
    coefficients = zip(waveform.cosines, waveform.sines, strict=True)
    return {(power, j): np.asarray((c - 1j * s) * X) for j, (c, s) in enumerate(coefficients) if c or s}


def total(sums: Iterable[Sums]) -> Sums:
    """Return the sum of sums."""
    found: Sums = {}
    for one in sums:
        for key, Z in one.items():
            found[key] = found[key] + Z if key in found else Z
    return found


def scaled(one: Sums, left: FloatArray | float, right: FloatArray | float) -> Sums:
    """Return diag(left) X diag(right) for ``one`` X; a number stands for equal entries."""
    column = np.asarray(left).reshape(-1, 1)
    return {key: column * Z * right for key, Z in one.items()}


def derivative(one: Sums, Omega: float) -> Sums:
    """Return the derivative with respect to time."""
    return {(power, j): 1j * j * Omega * Z for (power, j), Z in one.items() if j}


def product(one: Sums, other: Sums) -> Sums:
    """Return the product of two sums.

    Re(X e^ij) Re(Y e^ik) = Re(X Y e^i(j + k) + X conj(Y) e^i(j - k)) / 2.
    """
    found = []
    for (p, j), X in one.items():
        for (q, k), Y in other.items():
            across = X @ Y.conj() if j > k else X.conj() @ Y
            if j == k:
                across = across.real.astype(complex)
            found.append({(p + q, j + k): X @ Y / 2})
            found.append({(p + q, abs(j - k)): across / 2})
    # a mean is real
    return {key: Z if key[1] else Z.real.astype(complex) for key, Z in total(found).items()}


def blocks(here: Sums, across: Sums, back: Sums, there: Sums) -> Sums:
    """Return the sum [[here, across], [back, there]] of matrices twice as large."""
    quarters = {(0, 0): here, (0, 1): across, (1, 0): back, (1, 1): there}
    found: Sums = {}
    for (row, column), part in quarters.items():
        for key, Z in part.items():
            b = len(Z)
            whole = found.setdefault(key, np.zeros((2 * b, 2 * b), complex))
            whole[row * b : (row + 1) * b, column * b : (column + 1) * b] = Z
    return found
