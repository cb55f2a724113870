"""Distributions over the edge: piecewise polynomials of y/b, with exact integrals."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from periodic.checks import FloatArray, grid, real_array, real_number
from plate.basis import gauss_legendre, legendre


@dataclass(frozen=True)
class Distribution:
    """A piecewise polynomial of y/b on [0, 1]: its integrals against polynomials are exact, jumps included.

    Distributions can be added, subtracted and multiplied by numbers.

    Parameters
    ----------
    breaks : sequence of float, length p + 1
        0 = y_0 < y_1 < ... < y_p = 1, the ends of the pieces.
    coefficients : sequence of p sequences of float
        Legendre coefficients of each piece: sum_n c_n P_n(xi), xi from -1 to 1 over the piece. Kept as tuples, so
        that distributions compare equal and hash by value.

    Raises
    ------
    ValueError
        If the breaks do not run from 0 to 1, or a piece has no coefficients or one that is not finite.
    """

    breaks: tuple[float, ...]
    coefficients: tuple[tuple[float, ...], ...]

    def __post_init__(self) -> None:
        breaks = _edge_places("breaks", self.breaks)
        try:
            pieces = list(self.coefficients)
        except TypeError:
            raise ValueError(f"coefficients = {self.coefficients!r} is no sequence; give one row a piece") from None
        if len(pieces) != breaks.size - 1:
            raise ValueError(f"coefficients has {len(pieces)} rows; give {breaks.size - 1}, one for each piece")
        rows = []
        for i, piece in enumerate(pieces):
            row = real_array(f"coefficients[{i}]", piece, 1)
            if row.size == 0:
                raise ValueError(f"coefficients[{i}] is empty; give at least the constant term")
            rows.append(tuple(row.tolist()))
        object.__setattr__(self, "breaks", tuple(breaks.tolist()))
        object.__setattr__(self, "coefficients", tuple(rows))

    @classmethod
    def from_samples(cls, y: ArrayLike, f: ArrayLike) -> Distribution:
        """Return the piecewise linear distribution through the points (y, f), as it is: not scaled to mean 1.

        Parameters
        ----------
        y : array_like, shape (p,), p >= 2
            Places y/b, strictly increasing from 0 to 1.
        f : array_like, shape (p,)
            Values there.

        Raises
        ------
        ValueError
            If y does not run from 0 to 1, or f has another shape or an entry that is not finite.
        """
        places = _edge_places("y", y)
        values = real_array("f", f, 1)
        if values.shape != places.shape:
            raise ValueError(f"f has {values.size} values; give {places.size}, one for each y")
        means, half_rises = (values[1:] + values[:-1]) / 2, (values[1:] - values[:-1]) / 2
        return cls(tuple(places), tuple(zip(means, half_rises, strict=True)))

    @property
    def bound(self) -> float:
        """A bound on the mean of the modulus, no more than a few times larger."""
        sizes = (math.fsum(map(abs, row)) for row in self.coefficients)
        return math.fsum(size * width for size, width in zip(sizes, np.diff(self.breaks), strict=True))

    def __call__(self, y: ArrayLike) -> FloatArray:
        """Return the values at y/b (a number or array, from 0 to 1); at a break, those of the piece to its right.

        Raises
        ------
        ValueError
            If y is not numeric or lies outside.
        """
        y = real_array("y", y, None)
        if not ((y >= 0) & (y <= 1)).all():
            raise ValueError(f"y reaches from {y.min():.6g} to {y.max():.6g}; keep within 0 to 1 (y/b)")
        breaks = np.array(self.breaks)
        piece = np.clip(np.searchsorted(breaks, y, side="right") - 1, 0, len(self.coefficients) - 1)
        values = np.empty_like(y)
        for i in range(len(self.coefficients)):
            here = piece == i
            values[here] = self.piece(i, y[here])
        return values

    def piece(self, i: int, y: FloatArray) -> FloatArray:
        """Return the values of the polynomial of piece ``i``, counted from 0, at any y/b."""
        start, end = self.breaks[i : i + 2]
        xi = (2 * y - start - end) / (end - start)
        return np.asarray(np.polynomial.legendre.legval(xi, self.coefficients[i]), dtype=np.float64)

    def __add__(self, other: Distribution) -> Distribution:
        if not isinstance(other, Distribution):
            return NotImplemented
        breaks = np.union1d(self.breaks, other.breaks)
        terms = max(map(len, self.coefficients + other.coefficients))
        # Each piece of the sum is the sum's projection on P_0 .. P_(terms - 1), by a rule that is exact for it.
        xi, weights = gauss_legendre(terms, -1.0, 1.0)
        project = ((np.arange(terms) + 0.5) * np.polynomial.legendre.legvander(xi, terms - 1)).T * weights
        rows = []
        for start, end in pairwise(breaks):
            y = start + (end - start) * (xi + 1) / 2
            rows.append(tuple(project @ (self(y) + other(y))))
        return Distribution(tuple(breaks), tuple(rows))

    def __mul__(self, factor: float) -> Distribution:
        factor = real_number("factor", factor)
        return Distribution(self.breaks, tuple(tuple(factor * c for c in row) for row in self.coefficients))

    __rmul__ = __mul__

    def __sub__(self, other: Distribution) -> Distribution:
        return self + -1 * other

    @property
    def mean(self) -> float:
        """Mean value over the edge."""
        return math.fsum(row[0] * width for row, width in zip(self.coefficients, np.diff(self.breaks), strict=True))

    @property
    def derivative(self) -> Distribution:
        """The derivative inside the pieces; it knows nothing of the jumps between them."""
        pieces = zip(self.coefficients, np.diff(self.breaks), strict=True)
        rows = (tuple(2 / width * np.polynomial.legendre.legder(row)) for row, width in pieces)
        return Distribution(self.breaks, tuple(rows))

    @property
    def jumps(self) -> FloatArray:
        """The value to the right of each break less that to its left, both being 0 beyond the edge, shape (p + 1,)."""
        jumps = np.zeros(len(self.breaks))
        for i, row in enumerate(self.coefficients):
            start, end = np.polynomial.legendre.legval([-1.0, 1.0], row)
            jumps[i] += start
            jumps[i + 1] -= end
        return jumps

    def projection(self, terms: int) -> FloatArray:
        """Return (f, q_l) for the orthonormal Legendre polynomials q_l of `plate.basis`, shape (terms,); exact."""
        total = np.zeros(terms)
        for y, weighted_values in self._gauss_values(terms - 1):
            total += legendre(y, terms).T @ weighted_values
        return total

    def moments(self, terms: int) -> FloatArray:
        """Return (f q_l, q_j), symmetric, shape (terms, terms); exact."""
        total = np.zeros((terms, terms))
        for y, weighted_values in self._gauss_values(2 * terms - 2):
            q = legendre(y, terms)
            total += (q.T * weighted_values) @ q
        return (total + total.T) / 2

    def _gauss_values(self, degree: int) -> Iterator[tuple[FloatArray, FloatArray]]:
        """Yield, piece by piece, nodes and f times weights of a rule exact for f times a polynomial of this degree."""
        for (start, end), row in zip(pairwise(self.breaks), self.coefficients, strict=True):
            xi, weights = gauss_legendre((degree + len(row)) // 2 + 1, -1.0, 1.0)
            values = np.polynomial.legendre.legval(xi, row)
            yield start + (end - start) * (xi + 1) / 2, (end - start) / 2 * weights * values


def _edge_places(name: str, value: ArrayLike) -> FloatArray:
    """Return ``value`` as an increasing array from 0 to 1."""
    places = grid(name, value)
    if places.size < 2 or places[0] != 0 or places[-1] != 1:
        raise ValueError(f"{name} runs from {places[0]:.6g} to {places[-1]:.6g}; it must run from 0 to 1 (y/b)")
    return places
