"""Waveforms in ball arithmetic: their Taylor series, means and majorants (docs/certify.md, sections 1 and 2).

Phases are parts of a period, as exact fractions. Between two jumps a waveform is one formula: a Fourier sum or a
polynomial.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from fractions import Fraction
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from flint import arb, arb_poly, fmpq

from periodic import waveforms


class Piece(NamedTuple):
    """sum_k coefficients[k] x^k, where x goes from -1 to 1 between the phases ``start`` and ``end``."""

    start: Fraction
    end: Fraction
    coefficients: tuple[arb, ...]


class Wave(NamedTuple):
    """g = sum_j c_j cos j theta + s_j sin j theta, plus what the pieces give.

    Attributes
    ----------
    harmonics : dict
        (c_j, s_j) at j = 0, 1, ...
    pieces : tuple of Piece
        They follow one another round the period; empty for a Fourier sum.
    rest : float
        Bound on what g leaves out of the function that is meant.
    """

    harmonics: dict[int, tuple[arb, arb]]
    pieces: tuple[Piece, ...]
    rest: float

    def piece_at(self, phase: Fraction) -> tuple[Piece, int]:
        """Return the piece at ``phase`` and by how many periods it is off."""
        for turn in (0, 1):
            for piece in self.pieces:
                if piece.start <= phase + turn <= piece.end:
                    return piece, turn
        raise ValueError(f"phase = {phase} is outside one period")

    def is_constant_at(self, inside: Fraction) -> bool:
        """Return whether g is constant in the segment round the phase ``inside``."""
        if self.pieces and len(_trimmed(self.piece_at(inside)[0].coefficients)) > 1:
            return False
        return not any(self.harmonics.keys() - {0})

    def derivative(self, Omega: arb) -> Wave:
        """Return dg/dt, without jumps; ``rest`` must be zero."""
        turned = {j: (j * Omega * s, -j * Omega * c) for j, (c, s) in self.harmonics.items() if j}
        pieces = []
        for start, end, coefficients in self.pieces:
            slope = Omega / arb.pi() / ball(end - start)
            lower = tuple(k * slope * c for k, c in enumerate(coefficients) if k)
            pieces.append(Piece(start, end, lower or (arb(0),)))
        return Wave(turned, tuple(pieces), 0.0)

    def mean(self) -> arb:
        """Return the mean over a period, without ``rest``."""
        total = self.harmonics.get(0, (arb(0), arb(0)))[0]
        for start, end, coefficients in self.pieces:
            total += ball(end - start) * sum((c / (k + 1) for k, c in enumerate(coefficients) if k % 2 == 0), arb(0))
        return total

    def series(
        self, start: Fraction, length: Fraction, inside: Fraction, order: int, powers: dict[int, list[arb]]
    ) -> list[arb]:
        """Return the Taylor coefficients in s, where the phase is start + length s; at most ``order`` of them.

        Parameters
        ----------
        inside : Fraction
            A phase in the same segment, whose formula holds.
        powers : dict
            (2 pi j length)^i / i! for i < order at j, as by `harmonic_powers`.
        """
        found = [arb(0)] * (order if self.harmonics else 1)
        for j, (c, s) in self.harmonics.items():
            turn = fmpq(2 * j * start.numerator, start.denominator)
            cosine, sine = arb.cos_pi_fmpq(turn), arb.sin_pi_fmpq(turn)
            # every derivative is a quarter turn
            value, slope = c * cosine + s * sine, s * cosine - c * sine
            quarters = (value, slope, -value, -slope)
            for i in range(order if j else 1):
                found[i] += powers[j][i] * quarters[i % 4] if j else value
        if self.pieces:
            piece, turns = self.piece_at(inside)
            width = piece.end - piece.start
            x = 2 * (start + turns - piece.start) / width - 1
            shifted = arb_poly(list(piece.coefficients))(arb_poly([ball(x), ball(2 * length / width)])).coeffs()
            found += [arb(0)] * (min(order, len(shifted)) - len(found))
            for i, term in enumerate(shifted[:order]):
                found[i] += term
        return found

    def value(self, phase: Fraction, inside: Fraction) -> arb:
        """Return g at ``phase`` by the formula that holds at the phase ``inside`` beside it, without ``rest``."""
        return self.series(phase, Fraction(0), inside, 1, {j: [arb(1)] for j in self.harmonics})[0]


class Arithmetic(NamedTuple):
    """What a majorant is evaluated with: numbers to plan with, or balls to prove with."""

    pi: Any
    expm1: Callable[[Any], Any]
    number: Callable[[Any], Any]


FLOATS = Arithmetic(math.pi, np.expm1, float)


def balls() -> Arithmetic:
    """Return the arithmetic of balls, at the working precision."""
    return Arithmetic(arb.pi(), arb.expm1, lambda x: x)


class Majorant(NamedTuple):
    """A function with Taylor coefficients >= 0 that are at least the norms of those of sum_r g_r X_r.

    In a step of the part ``length`` of a period, where s goes from 0 to 1, it is

        constant + sum_j harmonics[j] e^{2 pi j length s} + sum powers[k, slope] (1 + slope length s)^k.

    As |d^i g / ds^i| of a harmonic is at most its amplitude times (2 pi j length)^i, and |x| <= 1 in a piece, it holds
    in each step of a segment.
    """

    constant: arb
    harmonics: dict[int, arb]
    powers: dict[tuple[int, Fraction], arb]

    def integral(self, length: Any, radius: Any, m: Arithmetic) -> Any:
        """Return the integral over s from 0 to ``radius``."""
        total = m.number(self.constant) * radius
        for j, amplitude in self.harmonics.items():
            total = total + m.number(amplitude) / (2 * m.pi * j * length) * m.expm1(2 * m.pi * j * length * radius)
        for (k, slope), amplitude in self.powers.items():
            d = _number(slope, m) * length
            total = total + m.number(amplitude) * ((1 + d * radius) ** (k + 1) - 1) / (d * (k + 1))
        return total

    def increase(self, length: Any, radius: Any, m: Arithmetic) -> Any:
        """Return the value at s = ``radius`` minus the value at s = 0."""
        total = 0 * radius
        for j, amplitude in self.harmonics.items():
            total = total + m.number(amplitude) * m.expm1(2 * m.pi * j * length * radius)
        for (k, slope), amplitude in self.powers.items():
            total = total + m.number(amplitude) * ((1 + _number(slope, m) * length * radius) ** k - 1)
        return total

    def value(self, length: Any, radius: Any, m: Arithmetic) -> Any:
        """Return the value at s = ``radius``."""
        start = sum(map(m.number, (*self.harmonics.values(), *self.powers.values())), m.number(self.constant))
        return start + self.increase(length, radius, m)


def majorant(constant: arb, parts: Iterable[tuple[Wave, arb]], inside: Fraction) -> Majorant:
    """Return the majorant of a constant of norm ``constant`` and waves with matrices of these norms."""
    harmonics: dict[int, arb] = {}
    powers: dict[tuple[int, Fraction], arb] = {}
    for wave, size in parts:
        for j, (c, s) in wave.harmonics.items():
            if j:
                # a ball of zero width has a root, and one round zero its upper end
                amplitude = (c * c + s * s).abs_upper().sqrt()
                harmonics[j] = harmonics.get(j, arb(0)) + size * amplitude
            else:
                constant += size * abs(c)
        if wave.pieces:
            piece, _ = wave.piece_at(inside)
            slope = 2 / (piece.end - piece.start)
            for k, term in enumerate(_trimmed(piece.coefficients)):
                if k:
                    powers[k, slope] = powers.get((k, slope), arb(0)) + size * abs(term)
                else:
                    constant += size * abs(term)
    return Majorant(constant, harmonics, powers)


def wave_of(g: waveforms.Trigonometric | waveforms.Piecewise) -> Wave:
    """Return a waveform with its float64 numbers taken as exact."""
    if isinstance(g, waveforms.Trigonometric):
        pairs = enumerate(zip(g.cosines, g.sines, strict=True))
        return Wave({j: (arb(c), arb(s)) for j, (c, s) in pairs if c or (j and s)}, (), g.rest)
    starts = [Fraction(jump) for jump in g.jumps]
    ends = [*starts[1:], starts[0] + 1]
    pieces = zip(starts, ends, g.pieces, strict=True)
    return Wave({}, tuple(Piece(a, b, tuple(map(arb, piece))) for a, b, piece in pieces), g.rest)


def harmonic_powers(waves: Iterable[Wave], length: Fraction, order: int) -> dict[int, list[arb]]:
    """Return (2 pi j length)^i / i!, i < order, for every harmonic j of the waves."""
    found = {}
    for j in {j for wave in waves for j in wave.harmonics if j}:
        step = 2 * j * arb.pi() * ball(length)
        terms = [arb(1)]
        for i in range(1, order):
            terms.append(terms[-1] * step / i)
        found[j] = terms
    return found


def segments(jumps: Iterable[Fraction]) -> list[tuple[Fraction, Fraction]]:
    """Return the parts of a period, from 0 to 1, between these phases."""
    return list(pairwise(sorted({Fraction(0), Fraction(1), *jumps})))


def ball(x: Fraction) -> arb:
    """Return a fraction as a ball."""
    return arb(fmpq(x.numerator, x.denominator))


def _trimmed(coefficients: tuple[arb, ...]) -> tuple[arb, ...]:
    last = max((k for k, c in enumerate(coefficients) if not c.is_zero()), default=0)
    return coefficients[: last + 1]


def _number(x: Fraction, m: Arithmetic) -> Any:
    return float(x) if m is FLOATS else ball(x)
