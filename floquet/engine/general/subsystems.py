"""Any linear periodic system as independent subsystems y' = [A + V(t)] y, V of first order in eps and more.

Smooth coefficients with constant mass are Fourier sums with matrices (`Harmonics`). Everything else, coefficients with
jumps, pulses, a mass that depends on time, is a sum of waveforms times matrices (`Part`). `members` makes them.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import NamedTuple

import numpy as np

from periodic import PeriodicSystem, check_mass
from periodic.checks import FloatArray
from periodic.waveforms import Impulses, Piecewise, Trigonometric, Waveform


class Part(NamedTuple):
    """eps^power g(Omega t) times a matrix (N, N), as a part of A and, with a mass, as a part of E in E y' = A y.

    ``radius`` bounds the rate at which y' = z A y makes |y| grow, |z| = 1.
    """

    power: int
    waveform: Waveform
    A: FloatArray
    E: FloatArray
    radius: float


class Harmonics(NamedTuple):
    """V = sum_r eps^powers[r] (cosine[r] cos j_r theta + sine[r] sin j_r theta), j = harmonics, matrices (R, N, N).

    ``strength[r]`` bounds the rate at which the part r makes |y| grow when eps = 1.
    """

    powers: FloatArray
    harmonics: FloatArray
    cosine: FloatArray
    sine: FloatArray
    strength: FloatArray


@dataclass(frozen=True, eq=False)
class GeneralSubsystem:
    """An independent subsystem of a general system at one frequency.

    Attributes
    ----------
    A : ndarray, shape (N, N)
        Its free motion, y' = A y.
    smooth : Harmonics or None
        What depends on eps, if there are no jumps, no pulses and no parts of E.
    parts : tuple of Part
        What depends on eps, if there are.
    rate : float
        Largest modulus of an eigenvalue of the free motion.
    symplectic : bool
        Whether the motion is symplectic in these coordinates, the first half being places and the second momenta.
    reversible : bool
        Whether with mu also 1 / conj(mu) is a multiplier although it is not ``symplectic``.
    """

    A: FloatArray
    smooth: Harmonics | None
    parts: tuple[Part, ...]
    rate: float
    symplectic: bool
    reversible: bool

    @property
    def reciprocal(self) -> bool:
        """Whether with mu also 1 / conj(mu) is a multiplier."""
        return self.symplectic or self.reversible

    @property
    def states(self) -> int:
        """Number of states N."""
        return len(self.A)

    def fastest(self, Omega: float, largest: float) -> float:
        """Return a bound on the rate of the motion up to the amplitude ``largest``, or that of the excitation."""
        growth = sum(rate * largest**power for power, rate in self.rates)
        return max(self.rate + growth, self.highest_harmonic * Omega)

    @cached_property
    def rates(self) -> list[tuple[int, float]]:
        """Power of eps of each part but for pulses, and a bound on the growth or on the norm that it brings."""
        if self.smooth is not None:
            return list(zip(map(int, self.smooth.powers), self.smooth.strength.tolist(), strict=True))
        return [
            (part.power, float(np.linalg.norm(part.A, 2)) * largest_value(part.waveform))
            for part in self.parts
            if not isinstance(part.waveform, Impulses)
        ]

    @property
    def highest_harmonic(self) -> int:
        """The highest harmonic of a Fourier sum."""
        if self.smooth is not None:
            return int(self.smooth.harmonics.max(initial=1))
        return max([1, *(p.waveform.harmonics for p in self.parts if isinstance(p.waveform, Trigonometric))])


class Parts(NamedTuple):
    """The independent subsystems of a general system, and the number of its rigid motions."""

    subsystems: tuple[GeneralSubsystem, ...]
    rigid: int


@lru_cache(maxsize=8)
def refuse_singular_mass(system: PeriodicSystem, amplitudes: bytes) -> None:
    """Refuse a mass that becomes singular at one of the amplitudes (an increasing array of floats as bytes).

    Raises
    ------
    ValueError
        With the amplitude and the phase.
    """
    powers = {term.power for term in system.terms if term.of == "mass"}
    eps = np.frombuffer(amplitudes)
    # the lowest eigenvalue of M_0 + eps X is concave in eps: with power one the ends tell
    for amplitude in eps if powers - {1} else {eps[0], eps[-1]}:
        check_mass(system, float(amplitude))


@lru_cache(maxsize=256)
def largest_value(waveform: Waveform) -> float:
    """Return a bound on |g|; of pulses, on their areas."""
    if isinstance(waveform, Trigonometric):
        return float(np.hypot(waveform.cosines, waveform.sines).sum())
    if isinstance(waveform, Piecewise):
        return max(float(np.abs(piece).sum()) for piece in waveform.pieces)
    return float(np.abs(waveform.weights).sum())
