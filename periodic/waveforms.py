"""Waveforms: how one coefficient goes with time, as a function g of the phase theta = Omega t with period 2 pi.

Three kinds of data hold them all. A `Trigonometric` waveform is a finite Fourier sum, a `Piecewise` one consists of
polynomials between its jumps, and `Impulses` are Dirac pulses. The functions make them: `constant`, `cosine`, `sine`,
`rectangular`, `triangle`, `sawtooth`, `samples`, `function`, `impulses`. Phases and duty are parts of a period.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from periodic.checks import FloatArray, real_array, real_number, whole_number
from periodic.fitting import MAX_WAVEFORM_HARMONICS, SERIES_ROUNDING, called, fourier_sum, polynomials, sampled_sum

# Samples describe a waveform if the last third of the harmonics that they hold adds up to less than this part of the
# largest sample.
MAX_SAMPLED_REST = 1e-3
# Part of the largest value by which a function may differ between one period and the next.
PERIOD_TOLERANCE = 1e-9


@dataclass(frozen=True)
class Trigonometric:
    """g(theta) = sum_j cosines[j] cos j theta + sines[j] sin j theta, j = 0, 1, ...

    Attributes
    ----------
    cosines, sines : tuple of float
        Of equal length; ``cosines[0]`` is the mean, ``sines[0]`` is zero.
    rest : float
        Bound on |g - what was meant| where the sum stands for a function; zero if it is exact.
    """

    cosines: tuple[float, ...]
    sines: tuple[float, ...]
    rest: float = 0.0

    @property
    def jumps(self) -> tuple[float, ...]:
        """Phases, as parts of a period, where another formula begins: none."""
        return ()

    @property
    def harmonics(self) -> int:
        """The highest harmonic."""
        return len(self.cosines) - 1

    def values(self, theta: ArrayLike) -> FloatArray:
        """Return g at the phases ``theta``, in radians."""
        turned = np.multiply.outer(np.asarray(theta, dtype=float), np.arange(len(self.cosines)))
        return np.asarray(np.cos(turned) @ np.array(self.cosines) + np.sin(turned) @ np.array(self.sines))

    def value_beside(self, phase: float, inside: float) -> float:
        """Return g at ``phase``, a part of a period, by the formula that holds at the phase ``inside``."""
        return float(self.values(2 * np.pi * phase))

    def derivative(self, theta: ArrayLike) -> FloatArray:
        """Return dg/dtheta at the phases ``theta``, in radians."""
        j = np.arange(len(self.cosines))
        turned = np.multiply.outer(np.asarray(theta, dtype=float), j)
        return np.asarray(np.cos(turned) @ (j * np.array(self.sines)) - np.sin(turned) @ (j * np.array(self.cosines)))

    def fourier(self, J: int) -> tuple[FloatArray, FloatArray, float]:
        """Return the coefficients of cos j theta and sin j theta, j = 0..J, and a bound on |g| of what they leave out.

        Raises
        ------
        ValueError
            If ``J`` is no whole number >= 0.
        """
        J = whole_number("J", J, least=0)
        c, s = np.zeros(J + 1), np.zeros(J + 1)
        kept = min(J + 1, len(self.cosines))
        c[:kept], s[:kept] = self.cosines[:kept], self.sines[:kept]
        return c, s, float(np.hypot(self.cosines[kept:], self.sines[kept:]).sum()) + self.rest


@dataclass(frozen=True)
class Piecewise:
    """Polynomials between phases at which another formula begins.

    Attributes
    ----------
    jumps : tuple of float
        Increasing phases in [0, 1), as parts of a period. Piece i reaches from ``jumps[i]`` to the next, the last one
        round the end of the period to the first.
    pieces : tuple of tuple of float
        Coefficients c_0, c_1, ... of each piece, g = sum_k c_k x^k, where x goes from -1 to 1 over the piece.
    rest : float
        Bound on |g - what was meant| where the polynomials stand for a function; zero if they are exact.
    """

    jumps: tuple[float, ...]
    pieces: tuple[tuple[float, ...], ...]
    rest: float = 0.0
    lengths: tuple[float, ...] = field(init=False, compare=False, repr=False)

    def __post_init__(self) -> None:
        ends = [*self.jumps[1:], self.jumps[0] + 1]
        object.__setattr__(self, "lengths", tuple(b - a for a, b in zip(self.jumps, ends, strict=True)))

    @property
    def is_constant_between_jumps(self) -> bool:
        """Whether every piece is a constant."""
        return all(not any(piece[1:]) for piece in self.pieces)

    def values(self, theta: ArrayLike) -> FloatArray:
        """Return g at the phases ``theta``, in radians; at a jump the value after it."""
        return self._evaluate(theta, 0)

    def derivative(self, theta: ArrayLike) -> FloatArray:
        """Return dg/dtheta at the phases ``theta``, in radians; at a jump the value after it."""
        return self._evaluate(theta, 1)

    def value_beside(self, phase: float, inside: float) -> float:
        """Return g at ``phase``, a part of a period, by the formula that holds at the phase ``inside``."""
        piece, x, slope = self.piece_at(2 * np.pi * inside)
        return float(np.polynomial.polynomial.polyval(x + slope * 2 * np.pi * (phase - inside), np.array(piece)))

    def piece_at(self, theta: float) -> tuple[tuple[float, ...], float, float]:
        """Return the coefficients of the piece at ``theta``, the x of ``theta`` in it, and dx/dtheta."""
        place = (theta / (2 * math.pi) - self.jumps[0]) % 1.0 + self.jumps[0]
        i = max(int(np.searchsorted(self.jumps, place, side="right")) - 1, 0)
        return self.pieces[i], 2 * (place - self.jumps[i]) / self.lengths[i] - 1, 1 / (math.pi * self.lengths[i])

    def fourier(self, J: int) -> tuple[FloatArray, FloatArray, float]:
        """Return the coefficients of cos j theta and sin j theta, j = 0..J, and a bound on the root mean square of
        what they leave out.

        The bound follows from the total variation of g, or, if g has no jump, of its derivative: coefficient j is at
        most V / (pi j), or V' / (pi j^2).

        Raises
        ------
        ValueError
            If ``J`` is no whole number from 0 to 4096.
        """
        J = whole_number("J", J, least=0, most=MAX_WAVEFORM_HARMONICS)
        total = np.zeros(J + 1, complex)
        j = np.arange(J + 1)
        for start, length, piece in zip(self.jumps, self.lengths, self.pieces, strict=True):
            x, weights = np.polynomial.legendre.leggauss(int(math.pi * J * length) + len(piece) + 16)
            phase = start + length * (x + 1) / 2
            wave = np.exp(-2j * np.pi * np.outer(j, phase))
            total += wave @ (weights * np.polynomial.polynomial.polyval(x, np.array(piece))) * (length / 2)
        total[1:] *= 2
        return total.real, np.where(j > 0, -total.imag, 0.0), self._left_out(J)

    def _left_out(self, J: int) -> float:
        x = np.array([-1.0, 1.0])
        polynomials = [np.polynomial.Polynomial(piece) for piece in self.pieces]
        bounds = []
        for order in (0, 1):  # of the derivative whose variation is taken
            slopes = [(math.pi * length) ** -order for length in self.lengths]
            parts = [slope * one.deriv(order) for slope, one in zip(slopes, polynomials, strict=True)]
            ends = [part(x) for part in parts]
            steps = [abs(after[0] - before[1]) for before, after in zip(ends, [*ends[1:], ends[0]], strict=True)]
            inside = sum(float(np.abs(part.deriv().coef).sum()) for part in parts) * 2
            bound = (inside + sum(steps)) / math.pi
            # sum over j > J of j^-2 is below 1 / J, that of j^-4 below 1 / (3 J^3)
            tail = 1 / max(J, 0.5) if order == 0 else 1 / (3 * max(J, 0.5) ** 3)
            bounds.append(bound * math.sqrt(tail / 2))
            if order == 0 and max(steps) > SERIES_ROUNDING * max(abs(end).max() for end in ends):
                break
        return min(bounds) + self.rest

    def _evaluate(self, theta: ArrayLike, order: int) -> FloatArray:
        phase = np.asarray(theta, dtype=float) / (2 * math.pi)
        place = np.atleast_1d((phase - self.jumps[0]) % 1.0 + self.jumps[0])
        where = np.maximum(np.searchsorted(self.jumps, place, side="right") - 1, 0)
        found = np.empty(place.shape)
        for i, (start, length, piece) in enumerate(zip(self.jumps, self.lengths, self.pieces, strict=True)):
            here = where == i
            x = 2 * (place[here] - start) / length - 1
            found[here] = np.polynomial.Polynomial(piece).deriv(order)(x) * (math.pi * length) ** -order
        return found.reshape(phase.shape)


@dataclass(frozen=True)
class Impulses:
    """g = sum_k weights[k] sum_n delta(t - (phases[k] + n) T): pulses in time t, each of area ``weights[k]``.

    They act as jumps of the state. The Fourier coefficients of pulses grow with Omega and never end; there are no
    values. ``phases`` are increasing parts of a period in [0, 1).
    """

    phases: tuple[float, ...]
    weights: tuple[float, ...]

    @property
    def jumps(self) -> tuple[float, ...]:
        """Phases of the pulses, as parts of a period."""
        return self.phases

    def fourier(self, J: int) -> tuple[FloatArray, FloatArray, float]:
        """Return the coefficients of cos j theta and sin j theta, j = 0..J, divided by Omega; what they leave out is
        not bounded.

        Raises
        ------
        ValueError
            If ``J`` is no whole number >= 0.
        """
        j = np.arange(whole_number("J", J, least=0) + 1)
        total = np.exp(-2j * np.pi * np.outer(j, self.phases)) @ np.array(self.weights) / (2 * np.pi)
        total[1:] *= 2
        return total.real, np.where(j > 0, -total.imag, 0.0), math.inf


Waveform = Trigonometric | Piecewise | Impulses


def constant() -> Trigonometric:
    """Return g = 1, for a part that grows with eps and does not depend on time."""
    return Trigonometric((1.0,), (0.0,))


def cosine(j: int = 1, phase: float = 0.0) -> Trigonometric:
    """Return g = cos(j (theta - 2 pi phase)): the crest is at ``phase``, a part of the period of the excitation."""
    j = whole_number("j", j, least=1, most=MAX_WAVEFORM_HARMONICS)
    c, s = _unit_circle(j * real_number("phase", phase))
    return Trigonometric((*(j * [0.0]), c), (*(j * [0.0]), s))


def sine(j: int = 1) -> Trigonometric:
    """Return g = sin j theta."""
    j = whole_number("j", j, least=1, most=MAX_WAVEFORM_HARMONICS)
    return Trigonometric((j + 1) * (0.0,), (*(j * [0.0]), 1.0))


def rectangular(duty: float = 0.5, phase: float = 0.0) -> Piecewise:
    """Return g = 1 during the part ``duty`` of the period that begins at ``phase``, and -1 during the rest."""
    duty = real_number("duty", duty)
    if not 0 < duty < 1:
        raise ValueError(f"duty = {duty!r} is out of range; give a part of the period between 0 and 1")
    phase = real_number("phase", phase)
    return _piecewise([phase, phase + duty], [(1.0,), (-1.0,)])


def triangle() -> Piecewise:
    """Return g that falls from 1 at theta = 0 to -1 at pi and rises again, in straight lines."""
    return Piecewise((0.0, 0.5), ((0.0, -1.0), (0.0, 1.0)))


def sawtooth() -> Piecewise:
    """Return g that rises from -1 at theta = 0 to 1 at 2 pi in a straight line and jumps back."""
    return Piecewise((0.0,), ((0.0, 1.0),))


def samples(values: ArrayLike) -> Trigonometric:
    """Return the trigonometric interpolant of equally spaced samples of one period, the first at theta = 0.

    Raises
    ------
    ValueError
        If there are fewer than three, or too few: the last third of the harmonics is what tells how much the samples
        miss, and it has to be below a thousandth of the largest sample.
    """
    array = real_array("values", values, 1)
    N = len(array)
    if N < 3:
        raise ValueError(f"values has {N} entries; give at least three samples of one period")
    size = float(np.abs(array).max())
    found = sampled_sum(array)
    if found.rest > MAX_SAMPLED_REST * size:
        raise ValueError(
            f"values has {N} entries, too few: the last third of their harmonics adds up to {found.rest:.2g}, the "
            f"largest sample is {size:.2g}; give more samples, or, if the waveform jumps, rectangular or function"
        )
    return Trigonometric(*found)


def function(g: Callable[[float], float], jumps: Sequence[float] = ()) -> Trigonometric | Piecewise:
    """Return the waveform of any function g(theta) of period 2 pi, to rounding.

    Parameters
    ----------
    g : callable
        Takes theta in radians, gives a number.
    jumps : sequence of float
        Phases, as parts of a period, where g or one of its derivatives jumps.

    Raises
    ------
    ValueError
        If g does not have the period 2 pi, gives no finite number, or is not smooth between ``jumps``.
    """
    if not callable(g):
        raise ValueError(f"g = {g!r} is not callable; give a function of theta")
    places = sorted({place % 1.0 for place in real_array("jumps", np.asarray(jumps, dtype=float), 1).tolist()})
    probes = 2 * np.pi * (np.arange(32) + 1 / math.pi) / 32
    probes = probes[np.abs((probes / (2 * np.pi))[:, None] - np.array([*places, -1.0])).min(axis=1) > PERIOD_TOLERANCE]
    here = called(g, probes)
    size = float(np.abs(here).max())
    defect = np.abs(called(g, probes + 2 * np.pi) - here)
    if defect.max() > PERIOD_TOLERANCE * size:
        theta = float(probes[defect.argmax()])
        raise ValueError(
            f"g has no period 2 pi: g({theta:.6g}) = {here[defect.argmax()]:.6g}, but one period later "
            f"{g(theta + 2 * math.pi):.6g}; give a function of theta = Omega t, periodic with 2 pi"
        )
    return _piecewise(*polynomials(g, places)) if places else Trigonometric(*fourier_sum(g))


def impulses(phases: ArrayLike = (0.0,), weights: ArrayLike = (1.0,)) -> Impulses:
    """Return Dirac pulses in time of area ``weights`` at ``phases``, which are parts of a period.

    Raises
    ------
    ValueError
        If the two have different lengths, or there is none.
    """
    at = real_array("phases", np.atleast_1d(np.asarray(phases)), 1)
    areas = real_array("weights", np.atleast_1d(np.asarray(weights)), 1)
    if at.size == 0 or at.shape != areas.shape:
        raise ValueError(f"weights has shape {areas.shape} and phases {at.shape}; give one weight for each phase")
    at %= 1.0
    distinct = np.unique(at)
    return Impulses(tuple(distinct.tolist()), tuple(float(areas[at == one].sum()) for one in distinct))


def _unit_circle(turns: float) -> tuple[float, float]:
    """Return cosine and sine of 2 pi ``turns``, exact at quarter turns."""
    quarters = round(4 * turns)
    angle = 2 * math.pi * (turns - quarters / 4)
    c, s = math.cos(angle), math.sin(angle)
    return ((c, s), (-s, c), (-c, -s), (s, -c))[quarters % 4]


def _piecewise(starts: Sequence[float], pieces: Sequence[tuple[float, ...]], rest: float = 0.0) -> Piecewise:
    order = sorted(range(len(starts)), key=lambda i: starts[i] % 1.0)
    return Piecewise(tuple(starts[i] % 1.0 for i in order), tuple(pieces[i] for i in order), rest)
