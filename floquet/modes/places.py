"""Phases of a period at which solutions are known: to expand them in Fourier series and to interpolate them.

Solutions of a system without jumps are smooth and periodic up to a factor: equally spaced phases serve best. Jumps
divide the period into parts; in each of them Gauss's nodes serve as well.
"""

from __future__ import annotations

from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from periodic import AnySystem, waveforms
from periodic.checks import ComplexArray, FloatArray

# Harmonics of the fastest motion that places have room for beside its own, and for each harmonic of the excitation.
SPARE_HARMONICS, SPARE_FOR_HARMONIC = 24, 8
# Part of the harmonics of the fastest motion by which the bound on its rate may fall short.
RATE_MARGIN = 0.1
# Gauss's nodes in a part of a period: so many for each radian of the fastest phase, and so many more.
NODES_PER_RADIAN, SPARE_NODES = 0.75, 20
# More harmonics than these are refused: the arrays would be too large.
MAX_HARMONICS = 4096


class Places:
    """Phases in a period, as parts of it, between 0 and 1.

    Attributes
    ----------
    phases, weights : ndarray, shape (P,)
        Phases and the weights of the mean over a period.
    order : int
        Highest harmonic of the motion that they resolve.
    parts : list of (float, float, slice)
        Where each smooth part begins and ends, and which phases it has; one without an end if nothing jumps.
    """

    def __init__(self, jumps: tuple[float, ...], order: int) -> None:
        if order > MAX_HARMONICS:
            raise ValueError(
                f"Omega is slow: the fastest motion has the harmonic {order} of it; give a larger Omega, or a system "
                "without its fastest motions"
            )
        self.order = order
        self.smooth = not jumps
        if self.smooth:
            P = 2 ** int(np.ceil(np.log2(2 * order)))
            self.order = P // 2 - 1
            self.phases, self.weights = np.arange(P) / P, np.full(P, 1 / P)
            self.parts = [(0.0, 1.0, slice(0, P))]
            return
        ends = sorted({0.0, 1.0, *jumps})
        phases: list[FloatArray] = []
        weights: list[FloatArray] = []
        self.parts = []
        for a, b in pairwise(ends):
            count = int(np.ceil(NODES_PER_RADIAN * 2 * np.pi * order * (b - a))) + SPARE_NODES
            x, w = np.polynomial.legendre.leggauss(count)
            start = sum(len(part) for part in phases)
            self.parts.append((a, b, slice(start, start + count)))
            phases.append(a + (b - a) * (x + 1) / 2)
            weights.append((b - a) * w / 2)
        self.phases, self.weights = np.concatenate(phases), np.concatenate(weights)

    @cached_property
    def harmonics(self) -> NDArray[np.intp]:
        """The harmonics -order ... order, shape (H,)."""
        return np.arange(-self.order, self.order + 1)

    def coefficients(self, values: ComplexArray) -> ComplexArray:
        """Return c_k of values (P, ...) = sum_k c_k e^{i k theta} for the `harmonics`, shape (H, ...)."""
        if self.smooth:
            return np.asarray(np.fft.fft(values, axis=0)[self.harmonics] / len(values))
        waves = np.exp(-2j * np.pi * np.outer(self.harmonics, self.phases))
        return np.asarray(np.tensordot(waves * self.weights, values, 1))

    def interpolated(self, values: ComplexArray, phases: FloatArray) -> ComplexArray:
        """Return values (P, ...) of a periodic function at other phases (p,), shape (p, ...); after a jump there."""
        if self.smooth:
            waves = np.exp(2j * np.pi * np.outer(phases, self.harmonics))
            return np.asarray(np.tensordot(waves, self.coefficients(values), 1))
        turned = phases % 1.0
        found = np.empty((len(phases), *values.shape[1:]), complex)
        for a, b, here in self.parts:
            inside = (turned >= a) & (turned < b)
            if inside.any():
                found[inside] = _barycentric(self.phases[here], self.weights[here], values[here], turned[inside], a, b)
        return found


def _barycentric(
    nodes: FloatArray, weights: FloatArray, values: ComplexArray, where: FloatArray, a: float, b: float
) -> ComplexArray:
    """Interpolate between Gauss's nodes (H. Wang and S. Xiang, Math. Comp. 81 (2012) 861-877)."""
    x = 2 * (nodes - a) / (b - a) - 1
    factors = (-1.0) ** np.arange(len(nodes)) * np.sqrt((1 - x**2) * weights)
    distance = where[:, None] - nodes
    hit = distance == 0
    distance[hit] = 1.0
    terms = factors / distance
    terms[hit.any(axis=1)] = 0.0
    terms[hit] = 1.0
    return np.asarray(np.tensordot(terms / terms.sum(axis=1, keepdims=True), values, 1))


def jumps_of(system: AnySystem, eps: float) -> tuple[float, ...]:
    """Return the phases at which a waveform of ``system`` jumps, in [0, 1)."""
    waves = [term.waveform for term in system.terms] if eps else []
    return tuple(sorted({jump % 1.0 for wave in waves for jump in wave.jumps}))


def highest_harmonic(system: AnySystem, eps: float) -> int:
    """Return the highest harmonic of the excitation that is a Fourier sum."""
    if not eps:
        return 0
    waves = [term.waveform for term in system.terms]
    return max([len(system.cosine), *(wave.harmonics for wave in waves if isinstance(wave, waveforms.Trigonometric))])


def places_for(system: AnySystem, eps: float, rate: float, Omega: float) -> Places:
    """Return places that resolve motions up to ``rate``, per unit of time."""
    order = (1 + RATE_MARGIN) * rate / Omega + SPARE_HARMONICS + SPARE_FOR_HARMONIC * highest_harmonic(system, eps)
    return Places(jumps_of(system, eps), int(np.ceil(order)))
