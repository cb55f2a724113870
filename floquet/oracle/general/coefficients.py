"""The coefficients of E(t) y' = A(t) y as functions of time: their values and their Taylor series."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from floquet.oracle.taylor import MACHINE_EPSILON
from periodic import waveforms
from periodic.checks import FloatArray


class Part(NamedTuple):
    """g(theta) times a matrix, as a part of A (N, N) and as a part of E (N, N)."""

    waveform: waveforms.Waveform
    A: FloatArray
    E: FloatArray


class Coefficients(NamedTuple):
    """E(t) = I + sum_r f_r E_r and A(t) = A_0 + sum_r f_r A_r with f = mix @ (Fourier sums, then polynomials).

    Attributes
    ----------
    constant : ndarray, shape (N, N)
        A_0, per unit of time.
    A, E : ndarray, shape (R, N, N)
    mix : ndarray, shape (R, F)
    alpha, beta : ndarray, shape (F1, J + 1)
        Fourier coefficients of the first F1 functions.
    pieces : tuple of Piecewise
        The other functions.
    pulses : tuple of (float, ndarray)
        Phase, as a part of a period, and the matrix P (N, N) of E y' = A y + P delta(t) y.
    unknown : float
        Bound on the norm of what the functions leave out of A and E.
    """

    constant: FloatArray
    A: FloatArray
    E: FloatArray
    mix: FloatArray
    alpha: FloatArray
    beta: FloatArray
    pieces: tuple[waveforms.Piecewise, ...]
    pulses: tuple[tuple[float, FloatArray], ...]
    unknown: float

    @property
    def harmonics(self) -> int:
        """The highest harmonic of a Fourier sum."""
        return self.alpha.shape[1] - 1

    @property
    def mass_moves(self) -> bool:
        """Whether E depends on time."""
        return bool(self.E.any())

    @property
    def is_constant_between_jumps(self) -> bool:
        """Whether A and E are constant between the ends of `segments`."""
        moving = self.alpha[:, 1:].any() or self.beta[:, 1:].any()
        return not moving and all(one.is_constant_between_jumps for one in self.pieces)

    def segments(self) -> list[tuple[float, float]]:
        """Return the parts of a period, from 0 to 1, in which no function changes its formula and no pulse falls."""
        jumps = {0.0, 1.0, *(jump for one in self.pieces for jump in one.jumps), *(phase for phase, _ in self.pulses)}
        return list(pairwise(sorted(jumps)))

    def series(self, start: float, length: float, inside: float, order: int) -> FloatArray:
        """Return the Taylor coefficients length^i f_r^(i) / i! at the phase ``start``, (R, order).

        Phases are parts of a period; ``inside`` is one in the same segment, whose formula holds.
        """
        j = np.arange(self.harmonics + 1)
        turn = 2 * np.pi * ((j * start) % 1.0)
        found = np.zeros((self.mix.shape[1], order))
        first = len(self.alpha)
        if first:
            c, s = np.cos(turn), np.sin(turn)
            i = np.arange(order)
            powers = np.outer(2 * np.pi * length / np.maximum(i, 1), j)
            powers[0] = 1.0
            powers = np.cumprod(powers, axis=0)
            # differentiation turns the phase by a quarter
            found[:first] = self.alpha @ (powers * np.array([c, -s, -c, s])[i % 4]).T
            found[:first] += self.beta @ (powers * np.array([s, c, -s, -c])[i % 4]).T
        for row, one in enumerate(self.pieces, start=first):
            piece, x, slope = one.piece_at(2 * np.pi * inside)
            slope *= 2 * np.pi
            inner = np.polynomial.Polynomial([x + slope * (start - inside), slope * length])
            shifted = np.polynomial.Polynomial(piece)(inner).coef
            kept = min(order, len(shifted))
            found[row, :kept] = shifted[:kept]
        return self.mix @ found

    def at(self, phase: float, inside: float) -> tuple[FloatArray, FloatArray]:
        """Return E and A (N, N) at a phase; ``inside`` as in `series`."""
        f = self.series(phase, 0.0, inside, 1)[:, 0]
        return np.eye(len(self.constant)) + np.tensordot(f, self.E, 1), self.constant + np.tensordot(f, self.A, 1)


def coefficients(constant: FloatArray, parts: Sequence[Part]) -> Coefficients:
    """Return the coefficients with the constant part ``constant`` (N, N) of A; pulses have no part in E.

    Functions that share their matrices up to factors are joined: R is the rank of the span of the matrices.
    """
    N = len(constant)
    functions: dict[waveforms.Waveform, FloatArray] = {}
    pulses, unknown = [], 0.0
    for part in parts:
        g = part.waveform
        if isinstance(g, waveforms.Impulses):
            pulses += [(phase, weight * part.A) for phase, weight in zip(g.phases, g.weights, strict=True)]
            continue
        unknown += g.rest * float(np.linalg.norm(part.A, 2) + np.linalg.norm(part.E, 2))
        functions[g] = functions.get(g, 0) + np.stack([part.A, part.E])
    sums = [g for g in functions if isinstance(g, waveforms.Trigonometric)]
    pieces = [g for g in functions if isinstance(g, waveforms.Piecewise)]
    J = max([0, *(g.harmonics for g in sums)])
    alpha, beta = np.zeros((len(sums), J + 1)), np.zeros((len(sums), J + 1))
    for row, g in enumerate(sums):
        alpha[row, : g.harmonics + 1], beta[row, : g.harmonics + 1] = g.cosines, g.sines
    ordered: list[waveforms.Waveform] = [*sums, *pieces]
    stack = np.array([functions[g] for g in ordered]).reshape(len(functions), 2 * N * N)
    mix = np.eye(len(functions))
    if len(functions):
        weights, sizes, basis = np.linalg.svd(stack, full_matrices=False)
        rank = max(1, int((sizes > MACHINE_EPSILON * sizes[0]).sum()))
        if rank < len(functions):
            mix, stack = (weights * sizes)[:, :rank].T, basis[:rank]
    A, E = stack.reshape(len(mix), 2, N, N).transpose(1, 0, 2, 3)
    return Coefficients(
        constant,
        np.ascontiguousarray(A),
        np.ascontiguousarray(E),
        mix,
        alpha,
        beta,
        tuple(pieces),
        tuple(pulses),
        unknown,
    )
