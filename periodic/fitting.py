"""Functions and samples as Fourier sums and as polynomials between jumps, with a bound on the rest."""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from periodic.checks import FloatArray, real_number

# Harmonics that a waveform may have.
MAX_WAVEFORM_HARMONICS = 4096
# Part of the largest value below which the end of a series is rounding.
SERIES_ROUNDING = 4e-15
# Degree of the polynomials that a function is replaced with between its jumps, and how often a piece is halved.
PIECE_DEGREE, MAX_PIECE_HALVINGS = 15, 12


class Sum(NamedTuple):
    """Coefficients of cos j theta and sin j theta, j = 0, 1, ..., and a bound on what they leave out."""

    cosines: tuple[float, ...]
    sines: tuple[float, ...]
    rest: float


class Pieces(NamedTuple):
    """Where pieces begin, as parts of a period, their coefficients in x from -1 to 1, and a bound on the rest."""

    starts: list[float]
    pieces: list[tuple[float, ...]]
    rest: float


def called(g: Callable[[float], float], theta: FloatArray) -> FloatArray:
    """Return g at the phases ``theta``, in radians."""
    return np.array([real_number(f"g({one:.6g})", g(one)) for one in theta.tolist()])


def _interpolant(values: FloatArray) -> tuple[FloatArray, FloatArray]:
    N = len(values)
    c = np.fft.rfft(values) / N
    c[1:] *= 2
    if N % 2 == 0:
        c[-1] /= 2
    sines = -c.imag
    sines[0] = 0.0
    return c.real, sines


def _sampled_rest(cosines: FloatArray, sines: FloatArray) -> float:
    """Return what the last third of the harmonics adds up to: the ones that the samples miss are taken to be less."""
    first = max(1, (2 * len(cosines)) // 3)
    return float(np.hypot(cosines[first:], sines[first:]).sum())


def sampled_sum(values: FloatArray) -> Sum:
    """Return the trigonometric interpolant of equally spaced samples (N,) of one period."""
    cosines, sines = _interpolant(values)
    rest = _sampled_rest(cosines, sines)
    return Sum(*_trimmed(cosines, sines, SERIES_ROUNDING * float(np.abs(values).max())), rest)


def _trimmed(cosines: FloatArray, sines: FloatArray, floor: float) -> tuple[tuple[float, ...], tuple[float, ...]]:
    cosines, sines = (np.where(np.abs(x) > floor / 16, x, 0.0) for x in (cosines, sines))
    last = int(np.flatnonzero(np.append(1.0, np.hypot(cosines, sines)[1:])).max())
    return tuple(cosines[: last + 1].tolist()), tuple(sines[: last + 1].tolist())


def fourier_sum(g: Callable[[float], float]) -> Sum:
    """Return a smooth function of period 2 pi as a Fourier sum, to rounding.

    Raises
    ------
    ValueError
        If the sum would be too long.
    """
    N = 32
    while N <= 2 * MAX_WAVEFORM_HARMONICS:
        values = called(g, 2 * np.pi * np.arange(N) / N)
        size = float(np.abs(values).max())
        cosines, sines = _interpolant(values)
        rest = float(np.hypot(cosines, sines)[(2 * len(cosines)) // 3 :].max())
        if rest <= SERIES_ROUNDING * size:
            return Sum(*_trimmed(cosines, sines, SERIES_ROUNDING * size), rest=SERIES_ROUNDING * size)
        N *= 2
    raise ValueError(
        f"g is not smooth: harmonics up to {MAX_WAVEFORM_HARMONICS} leave {rest:.2g} of {size:.2g}; "
        "name in jumps where it or a derivative jumps"
    )


def polynomials(g: Callable[[float], float], places: list[float]) -> Pieces:
    """Return a function that is smooth between ``places``, parts of a period, as polynomials, to rounding.

    Raises
    ------
    ValueError
        If it is not smooth there.
    """
    x = np.cos((2 * np.arange(PIECE_DEGREE + 1) + 1) * np.pi / (2 * (PIECE_DEGREE + 1)))
    to_series = np.linalg.inv(np.polynomial.chebyshev.chebvander(x, PIECE_DEGREE))
    spans = [(a, b, 0) for a, b in pairwise([*places, places[0] + 1])]
    starts, pieces, size, rest = [], [], 0.0, 0.0
    while spans:
        a, b, halvings = spans.pop()
        values = called(g, 2 * np.pi * (a + (b - a) * (x + 1) / 2))
        series = to_series @ (values - values[0])  # of a constant nothing is left, not even rounding
        series[0] += values[0]
        size = max(size, float(np.abs(values).max()))
        tail = float(np.abs(series[-3:]).max())
        if tail > SERIES_ROUNDING * size:
            if halvings == MAX_PIECE_HALVINGS:
                raise ValueError(
                    f"g is not smooth near theta = {2 * math.pi * (a + b) / 2:.9g}; "
                    "name in jumps where it or a derivative jumps"
                )
            middle = (a + b) / 2
            spans += [(a, middle, halvings + 1), (middle, b, halvings + 1)]
            continue
        rest = max(rest, SERIES_ROUNDING * size)
        while len(series) > 1 and abs(series[-1]) <= SERIES_ROUNDING * size / 16:
            series = series[:-1]
        starts.append(a)
        pieces.append(tuple(np.polynomial.chebyshev.cheb2poly(series).tolist()))
    return Pieces(starts, pieces, rest)
