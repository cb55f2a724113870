"""Any linear periodic system as one equation in ball arithmetic (docs/certify.md, section 1)."""

from __future__ import annotations

import math
from fractions import Fraction
from functools import reduce
from itertools import chain
from typing import NamedTuple

import numpy as np
from flint import arb, arb_mat

from floquet.certified.waves import Wave, segments
from periodic.checks import FloatArray


class Part(NamedTuple):
    """A wave and its matrices in E, A and B; None where it has none."""

    wave: Wave
    E: arb_mat | None
    A: arb_mat | None
    B: arb_mat | None

    def matrix(self, name: str) -> arb_mat | None:
        """Return E, A or B."""
        return {"E": self.E, "A": self.A, "B": self.B}[name]


class Equation(NamedTuple):
    """E u' = A u + B v, v' = scale u for the state z = (u, v) of a second-order system; E u' = A u for u alone.

    E = I + ..., A and B are constants and parts that depend on time. The state of the system is ``to_state`` z: any
    nonsingular matrix there, and any positive scale, leave the multipliers alone; these make norms small in any units.

    Attributes
    ----------
    to_state : flint.arb_mat, shape (N, N)
    scale : flint.arb
        Per unit of time; zero, as B is, if there is no v.
    Omega : flint.arb
    A, B : flint.arb_mat
        The constant parts.
    parts : list of Part
    pulses : dict
        At phases, as parts of a period, the matrices P (N, N) of pulses: E z' = ... + P delta(t) z.
    form : flint.arb_mat or None
        J with Phi^T J Phi = J, regular: skew, or symmetric.
    skew : bool
        Whether it is skew.
    reciprocal : bool
        Proved: with mu, 1 / conj(mu) is a multiplier.
    mean_growth : flint.arb or None
        Mean of log|mu| / T over all multipliers, by Liouville's formula, if E is constant.
    change : float
        By how much the matrices were changed to make the system exactly Hamiltonian, as a part of their largest entry.
    """

    to_state: arb_mat
    scale: arb
    Omega: arb
    A: arb_mat
    B: arb_mat
    parts: list[Part]
    pulses: dict[Fraction, arb_mat]
    form: arb_mat | None
    skew: bool
    reciprocal: bool
    mean_growth: arb | None
    change: float

    @property
    def states(self) -> int:
        """N."""
        return int(self.to_state.nrows())

    @property
    def is_second_order(self) -> bool:
        """Whether there is a v."""
        return bool(self.scale > 0)

    @property
    def period(self) -> arb:
        """T."""
        return 2 * arb.pi() / self.Omega

    @property
    def moves(self) -> bool:
        """Whether E depends on time."""
        return any(part.E is not None for part in self.parts)

    @property
    def rate(self) -> arb:
        """A power of two near the fastest rate, per unit of time."""
        if self.is_second_order:
            return self.scale
        return arb(2) ** math.frexp(float(norm(self.A)) or 1.0)[1]

    @property
    def is_constant(self) -> bool:
        """Whether nothing depends on time."""
        return not self.parts and not self.pulses

    @property
    def has_rest(self) -> bool:
        """Whether some waveform stands for others within a bound."""
        return any(part.wave.rest for part in self.parts)

    def segments(self) -> list[tuple[Fraction, Fraction]]:
        """Return the parts of a period, from 0 to 1, in which no formula changes and no pulse falls."""
        starts = [piece.start for part in self.parts for piece in part.wave.pieces]
        return segments([*starts, *self.pulses])

    def matrices(self, phase: Fraction, inside: Fraction) -> tuple[arb_mat, arb_mat, arb_mat]:
        """Return E, A and B at a phase, by the formulas that hold at the phase ``inside`` beside it."""
        E, A, B = identity(self.A.nrows()), self.A, self.B
        for part in self.parts:
            value = part.wave.value(phase, inside)
            E = E if part.E is None else E + part.E * value
            A = A if part.A is None else A + part.A * value
            B = B if part.B is None else B + part.B * value
        return E, A, B

    def loose_mass(self, phase: Fraction, inside: Fraction) -> arb_mat:
        """Return E at a phase with what its waveforms leave out."""
        unknown = sum((norm(part.E) * part.wave.rest for part in self.parts if part.E is not None), arb(0))
        return self.matrices(phase, inside)[0] + around_zero(self.A.nrows(), unknown)


def norm(matrix: arb_mat) -> arb:
    """Largest absolute row sum."""
    rows = [sum(map(abs, row), arb(0)) for row in matrix.tolist()]
    return reduce(arb.max, rows)


def block_matrix(rows: list[list[arb_mat]]) -> arb_mat:
    """Return the matrix that consists of these matrices, row by row."""
    return arb_mat([list(chain(*parts)) for row in rows for parts in zip(*(one.tolist() for one in row), strict=True)])


def exact(matrix: FloatArray) -> arb_mat:
    """Return a matrix of float64 numbers, without rounding."""
    return arb_mat(matrix.tolist())


def around_zero(size: int, radius: arb) -> arb_mat:
    """Return the square matrix of balls about zero."""
    return arb_mat(size, size, [radius.abs_upper() * arb(0, 1)] * size**2)


def identity(size: int) -> arb_mat:
    """Return I."""
    return exact(np.eye(size))
