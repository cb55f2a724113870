"""Monodromy matrices of a general subsystem at one frequency and many amplitudes, as samples to interpolate between."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import lru_cache, reduce
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from floquet.engine.doubling import (
    Piece,
    Sampler,
    Scale,
    Schedule,
    Workspace,
    chebyshev_points,
    chebyshev_weights,
    combination_norms,
    degree,
    exponential,
    growth_bounds,
    in_lanes,
    quantised,
)
from floquet.engine.general.step import GAUSS_OFFSET, general_samples, period_products
from floquet.engine.general.subsystems import GeneralSubsystem, Harmonics, largest_value
from periodic.checks import FloatArray
from periodic.waveforms import Impulses, Piecewise, Waveform

# Parts of a period whose products are examined for cancellation.
WATCHED_PARTS = 8
# Amplitudes at which a mass that depends on time is sampled at first; they are doubled until the series in eps ends.
FIRST_MASS_SAMPLES = 9


class SmoothSampler(Sampler):
    """Samples a subsystem with Fourier sums and constant mass: by doubling, as `Sampler` does for stiffness alone."""

    def __init__(self, subsystem: GeneralSubsystem, smooth: Harmonics, Omega: float, work: Workspace) -> None:
        self.subsystem, self.smooth, self.work = subsystem, smooth, work  # type: ignore[assignment]
        self.size, self.Omega = subsystem.states, Omega
        self.period = 2 * math.pi / Omega
        lower = smooth.powers - smooth.harmonics
        self.graded = bool(((lower >= 0) & (lower % 2 == 0)).all() and (smooth.powers > 1).any())

    def growth(self, largest: float) -> tuple[float, ...]:
        """Return bounds on the logarithm of the growth in one period by each harmonic, at the amplitude ``largest``.

        If the subsystem is graded, by each power of eps, which then has no higher harmonics.
        """
        sizes = self.smooth.strength * largest**self.smooth.powers
        number = (self.smooth.powers if self.graded else self.smooth.harmonics).astype(int)
        strength = np.zeros(max(number.max(initial=1), 1))
        np.add.at(strength, number[number > 0] - 1, sizes[number > 0])
        return growth_bounds(tuple(strength.tolist()), self.period)

    def growth_across(self, low: float, high: float) -> tuple[float, ...]:
        """Return the growth in one period between the middle and the ends of some amplitudes, by powers of eps."""
        found = _growth_across(self.smooth.powers, self.smooth.strength * self.period, low, high)
        # what grows with eps at all phases alike counts as a power of its own: samples are on a grid
        return found if self.graded or self.smooth.harmonics.all() else (*found, 0.0)

    def _sample(self, plan: Schedule, largest: float, L: int, scale: Scale) -> FloatArray:
        work = self.work.arrays(plan.max_matrices * self.size**2)
        h = self.period / 2**L
        return general_samples(self.subsystem.A, *self.smooth[:4], h, self.Omega, largest, plan, scale, work)  # type: ignore[attr-defined]


class JumpSampler:
    """Samples any subsystem, from jump to jump: exponentials where all is constant there, steps where it is not.

    The matrices are interpolated in eps, in which they are entire; with a mass that depends on time they are only
    analytic, and the number of samples is measured.
    """

    def __init__(self, subsystem: GeneralSubsystem, Omega: float) -> None:
        self.subsystem, self.Omega, self.period = subsystem, Omega, 2 * math.pi / Omega
        self.steady = [part for part in subsystem.parts if not isinstance(part.waveform, Impulses)]
        self.pulses = [part for part in subsystem.parts if isinstance(part.waveform, Impulses)]
        spans = [*(self.period for _ in self.steady), *(1.0 for _ in self.pulses)]
        self.sizes = np.array(
            [
                span * part.radius * largest_value(part.waveform)
                for span, part in zip(spans, (*self.steady, *self.pulses), strict=True)
            ]
        )
        self.mass = any(part.E.any() for part in subsystem.parts)
        N = subsystem.states
        self.X = np.array([part.A for part in self.steady]).reshape(-1, N, N)
        self.Y = np.array([part.E for part in self.steady]).reshape(-1, N, N)
        self.powers = np.array([float(part.power) for part in self.steady])
        self.jumps = tuple(sorted({jump for part in subsystem.parts for jump in part.waveform.jumps}))

    def pieces(self, eps: FloatArray, L: int, tolerance: float) -> Iterator[Piece]:
        """Yield pieces that together cover ``eps``; where steps are needed, from about 2^L steps a period."""
        stack = [slice(0, len(eps))]
        while stack:
            cells = stack.pop()
            piece = self._interpolated(eps[cells], L, tolerance)
            if piece is None and cells.stop - cells.start > 1:
                middle = cells.start + (cells.stop - cells.start) // 2
                stack += [slice(middle, cells.stop), slice(cells.start, middle)]
                continue
            yield (piece or self._direct(eps[cells], L))._replace(cells=cells)

    def matrices(self, eps: FloatArray, L: int, tolerance: float) -> FloatArray:
        """Return the monodromy matrices at a few amplitudes, (k, N, N), whose growth is within the range of floats."""
        found, scale = self._monodromies(eps, L)
        return found * np.exp2(scale.exponents)[:, None, None]

    def _interpolated(self, eps: FloatArray, L: int, tolerance: float) -> Piece | None:
        """Return a piece with samples at Chebyshev points; None if they would be too many, or are too unequal."""
        middle, radius = (eps[-1] + eps[0]) / 2, (eps[-1] - eps[0]) / 2
        count = FIRST_MASS_SAMPLES if self.mass else self._count(eps, tolerance)
        while count < len(eps):
            points = chebyshev_points(count)
            samples, scale = self._monodromies(middle + radius * points, L)
            top = float(scale.exponents.max())
            samples *= np.exp2(np.maximum(scale.exponents - top, -1000.0))[:, None, None]
            if not self.mass or _has_ended(samples, tolerance):
                weights = in_lanes(chebyshev_weights(count, (eps - middle) / radius))
                norms, alike = combination_norms(samples, weights)
                if not alike:
                    return None
                whole = Scale(np.full(len(eps), top), np.full(len(eps), scale.losses.max()))
                return Piece(slice(0), samples, weights, whole, norms[: len(eps)])
            count = 2 * count - 1
        return None

    def _direct(self, eps: FloatArray, L: int) -> Piece:
        samples, scale = self._monodromies(eps, L)
        weights = in_lanes(np.eye(len(eps)))
        return Piece(slice(0), samples, weights, scale, combination_norms(samples, weights)[0][: len(eps)])

    def _count(self, eps: FloatArray, tolerance: float) -> int:
        """Return how many samples in eps are enough."""
        parts = (*self.steady, *self.pulses)
        powers = np.array([part.power for part in parts])
        return degree(_growth_across(powers, self.sizes, float(eps[0]), float(eps[-1])), tolerance) + 1

    def _monodromies(self, eps: FloatArray, L: int) -> tuple[FloatArray, Scale]:
        """Return the monodromy matrices at the amplitudes ``eps``, (k, N, N), and their scales."""
        plan = _stretches(tuple(part.waveform for part in self.steady), self.jumps, L)
        N, kinds = self.subsystem.states, len(self.jumps) if self.mass or self.pulses else 0
        jumps = np.array([self._jump(float(one), phase) for one in eps for phase in self.jumps[:kinds]])
        products, *scale = period_products(
            self.subsystem.A,
            self.X,
            self.Y,
            eps[:, None] ** self.powers,
            plan.values,
            plan.ends,
            self.period * plan.lengths,
            self.mass,
            plan.constant,
            jumps.reshape(len(eps), kinds, N, N),
            plan.jump_of if kinds else np.full_like(plan.jump_of, -1),
        )
        return products, Scale(*scale)

    def _jump(self, eps: float, phase: float) -> FloatArray:
        """Return the matrix of what happens at a phase: momenta go on, and pulses turn the state by an exponential."""
        jump: FloatArray = np.eye(self.subsystem.states)
        after = jump
        if self.mass:
            ends = [0.0, *(x for x in self.jumps if x), 1.0]
            end = phase or 1.0
            last, following = max(x for x in ends if x < end), min(x for x in ends if x > phase)
            before, after = self._mass(eps, end, (last + end) / 2), self._mass(eps, phase, (phase + following) / 2)
            jump = np.asarray(np.linalg.solve(after, before), dtype=np.float64)
        kicks = [
            eps**part.power * weight * part.A
            for part in self.pulses
            if isinstance(part.waveform, Impulses)
            for where, weight in zip(part.waveform.phases, part.waveform.weights, strict=True)
            if where == phase
        ]
        if kicks:
            kick: FloatArray = np.asarray(np.linalg.solve(after, reduce(np.add, kicks)), dtype=np.float64)
            jump = exponential(kick) @ jump
        return jump

    def _mass(self, eps: float, phase: float, inside: float) -> FloatArray:
        """Return E at a phase, by the formulas that hold at the phase ``inside``."""
        total = np.eye(self.subsystem.states)
        for part in self.steady:
            if part.E.any():
                assert not isinstance(part.waveform, Impulses)  # there are none in the mass
                total += eps**part.power * part.waveform.value_beside(phase, inside) * part.E
        return total


def general_sampler(subsystem: GeneralSubsystem, Omega: float, work: Workspace) -> SmoothSampler | JumpSampler:
    """Return the sampler of a general subsystem."""
    if subsystem.smooth is not None:
        return SmoothSampler(subsystem, subsystem.smooth, Omega, work)
    return JumpSampler(subsystem, Omega)


def _growth_across(powers: FloatArray, sizes: FloatArray, low: float, high: float) -> tuple[float, ...]:
    """Return the growth between the middle m and the ends m ± r of a range of amplitudes, by powers of z in m + r z.

    (m + r z)^p is the sum of binomials (p, q) m^(p - q) r^q z^q.
    """
    middle, radius = abs(high + low) / 2, (high - low) / 2
    found = np.zeros(int(max(powers.max(initial=1), 1)))
    for power, size in zip(powers.astype(int).tolist(), sizes.tolist(), strict=True):
        for q in range(1, power + 1):
            found[q - 1] += size * math.comb(power, q) * middle ** (power - q) * radius**q
    return tuple(map(quantised, found.tolist()))


def _has_ended(samples: FloatArray, tolerance: float) -> bool:
    """Return whether the last Chebyshev coefficients of samples (m, N, N) are below ``tolerance``."""
    m = len(samples)
    order = np.arange(m - 2, m)
    coefficients = np.cos(np.outer(order, np.arccos(chebyshev_points(m)))) * (2 / m)
    last = np.tensordot(coefficients, samples, 1)
    return bool(np.linalg.norm(last, axis=(1, 2)).max() <= tolerance * np.linalg.norm(samples, axis=(1, 2)).min())


class Stretches(NamedTuple):
    """The parts of a period between jumps, cut further so that cancellation shows; see `period_products`.

    ``lengths`` are parts of a period, ``jump_of`` tells which of the jumps follows each.
    """

    values: FloatArray
    ends: NDArray[np.int64]
    lengths: FloatArray
    jump_of: NDArray[np.int64]
    constant: bool


@lru_cache(maxsize=64)
def _stretches(waves: tuple[Waveform, ...], jumps: tuple[float, ...], L: int) -> Stretches:
    """Return the stretches of a period of about 2^L steps, one for each where all is constant."""
    constant = all(
        wave.is_constant_between_jumps if isinstance(wave, Piecewise) else wave.fourier(0)[2] == 0 for wave in waves
    )
    phases, ends, lengths, jump_of = [], [], [], []
    for a, b in pairwise(sorted({0.0, 1.0, *jumps})):
        count = max(1, math.ceil((b - a) * WATCHED_PARTS))
        for i in range(count):
            width = (b - a) / count
            steps = 1 if constant else max(1, math.ceil(width * 2**L))
            middles = a + i * width + width * (np.arange(steps) + 0.5) / steps
            offset = GAUSS_OFFSET * width / steps
            phases.append(np.stack([middles - offset, middles + offset], axis=1))
            ends.append(steps)
            lengths.append(width / steps)
            jump_of.append(jumps.index(b % 1.0) if i == count - 1 and b % 1.0 in jumps else -1)
    theta = 2 * np.pi * np.concatenate(phases)
    values = np.array([wave.values(theta) for wave in waves if not isinstance(wave, Impulses)])
    values = values.reshape(len(waves), *theta.shape)
    return Stretches(
        np.ascontiguousarray(values.transpose(1, 2, 0)),
        np.cumsum(ends),
        np.array(lengths),
        np.array(jump_of, dtype=np.int64),
        constant,
    )
