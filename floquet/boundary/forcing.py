"""How the excitation acts on a subsystem: its strength at any amplitude, and what it couples to first order."""

from __future__ import annotations

from collections import defaultdict
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

from floquet.boundary.subsystems import AnySubsystem, free_matrix
from floquet.oracle import Subsystem, modulation
from periodic import AnySystem, FirstOrderSystem, excitation, waveforms
from periodic.checks import ComplexArray, FloatArray

# Phases at which the largest value of a waveform is looked for, in each of its pieces or periods of its harmonics.
PHASES_PER_WAVE = 17
# Amplitudes between stations are found to this part of themselves.
GOAL_ROUNDING = 1e-12


class Strength(NamedTuple):
    """Relative change of stiffness by the excitation: the sum of ``sizes[p - 1]`` eps^p.

    Of terms that are no stiffness it is the change of the equations of motion, relative to their fastest rate in each
    coordinate.
    """

    sizes: tuple[float, ...]

    def at(self, eps: float) -> float:
        """Return it at an amplitude."""
        return float(sum(size * eps**power for power, size in enumerate(self.sizes, start=1)))

    def after(self, eps: float, change: float) -> float:
        """Return the amplitude at which it is larger by ``change`` than at ``eps``."""
        first, *higher = self.sizes
        if not any(higher):
            return eps + change / first
        goal = self.at(eps) + change
        # one power alone would need so much, but for rounding
        most = min((goal / size) ** (1 / power) for power, size in enumerate(self.sizes, start=1) if size)
        return float(brentq(lambda x: self.at(x) - goal, eps, (1 + GOAL_ROUNDING) * most, rtol=GOAL_ROUNDING))


def strength_of(system: AnySystem, subsystem: AnySubsystem, Omega: float) -> Strength:
    """Return the strength of the excitation of a subsystem."""
    if isinstance(subsystem, Subsystem):
        return Strength((modulation(subsystem.equations),))
    rates = np.linalg.norm(free_matrix(subsystem), axis=1)
    scale = np.maximum(rates, Omega / (2 * np.pi))
    sizes: defaultdict[int, float] = defaultdict(float)
    for of, g, X, power in excitation(system):
        acting = subsystem.from_q @ _kick(system, of, X) @ subsystem.to_q
        sizes[power] += _largest(g, Omega) * float(np.linalg.norm(acting.real / scale[:, None], 2))
    return Strength(tuple(sizes[power] for power in range(1, max(sizes, default=1) + 1)))


def first_order_parts(system: AnySystem, Omega: float, J: int) -> dict[int, ComplexArray]:
    """Return by harmonics -J ... J what the terms of power 1 add to the matrix of x' = A x, x = (W', W) or the state.

    Terms of the mass act through the acceleration that the system has without excitation. Where the mass jumps, the
    momentum goes on: that is a pulse of the damping.
    """
    total: defaultdict[tuple[int, str], ComplexArray] = defaultdict(
        lambda: np.zeros((system.size, system.size), complex)
    )

    def add(of: str, X: FloatArray, cosines: FloatArray, sines: FloatArray) -> None:
        total[0, of] += cosines[0] * X
        for j in np.flatnonzero((cosines != 0) | (sines != 0)).tolist():
            for sign in (1, -1) if j else ():
                total[sign * j, of] += 0.5 * (cosines[j] - sign * 1j * sines[j]) * X

    for of, g, X, power in excitation(system):
        if power > 1:
            continue
        cosines, sines, _ = g.fourier(J)
        factor = Omega if isinstance(g, waveforms.Impulses) else 1.0
        add(of, X, factor * cosines, factor * sines)
        if of == "mass" and isinstance(g, waveforms.Piecewise):
            steps = [g.value_beside(at, after) - g.value_beside(at, before) for at, before, after in _sides(g)]
            pulses = waveforms.impulses(g.jumps, steps).fourier(J)
            add("damping", X, Omega * pulses[0], Omega * pulses[1])
    found: dict[int, ComplexArray] = {}
    for (h, of), part in total.items():
        if part.any():
            kick = _kick(system, of, part)
            found[h] = found[h] + kick if h in found else kick
    return found


def highest_harmonic(system: AnySystem, limit: int) -> int:
    """Return the highest harmonic of Omega in the excitation; at least ``limit`` where they never end."""
    harmonics = [len(system.cosine)]
    for term in system.terms:
        g = term.waveform
        harmonics.append(g.harmonics if isinstance(g, waveforms.Trigonometric) else limit)
    return max(harmonics)


def _kick(system: AnySystem, of: str, X: FloatArray | ComplexArray) -> ComplexArray:
    """Return what X as a part of one matrix adds to the matrix of x' = A x, to first order, (S, S)."""
    if isinstance(system, FirstOrderSystem):
        return X.astype(complex)
    n = system.size
    found = np.zeros((2 * n, 2 * n), complex)
    if of == "mass":
        moved = np.linalg.solve(system.mass, X)
        velocity, position = system.gyroscopic + system.damping, system.stiffness
        found[:n, :n] = moved @ np.linalg.solve(system.mass, velocity)
        found[:n, n:] = moved @ np.linalg.solve(system.mass, position)
    else:
        column = slice(n, None) if of == "stiffness" else slice(n)
        found[:n, column] = -np.linalg.solve(system.mass, X)
    return found


def _largest(g: waveforms.Waveform, Omega: float) -> float:
    """Return the largest value of a waveform; of pulses the largest rate of their mean, or of one in a period."""
    if isinstance(g, waveforms.Impulses):
        return float(np.abs(g.weights).sum()) * Omega / (2 * np.pi)
    count = g.harmonics + 1 if isinstance(g, waveforms.Trigonometric) else len(g.pieces)
    return float(np.abs(g.values(np.linspace(0, 2 * np.pi, PHASES_PER_WAVE * count))).max())


def _sides(g: waveforms.Piecewise) -> list[tuple[float, float, float]]:
    """Return each jump of a waveform, with a phase inside the piece before it and one inside the piece after it."""
    before = [g.lengths[-1], *g.lengths[:-1]]
    return [(at, at - a / 2, at + b / 2) for at, a, b in zip(g.jumps, before, g.lengths, strict=True)]
