"""Any linear periodic system as independent subsystems y' = [A + V(t)] y, V of first order in eps and more.

Smooth coefficients with constant mass are Fourier sums with matrices (`Harmonics`). Everything else, coefficients with
jumps, pulses, a mass that depends on time, is a sum of waveforms times matrices (`Part`).
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import NamedTuple

import numpy as np
import scipy.linalg as sla

from floquet.engine.coordinates import is_rigid, least_frequency
from floquet.engine.decoupling import invariant_subspaces
from periodic import AnySystem, FirstOrderSystem, PeriodicSystem, Term, check_mass, excitation, waveforms
from periodic.checks import FloatArray
from periodic.structure import conserved_form, is_reversible, skew_form
from periodic.waveforms import Impulses, Piecewise, Trigonometric, Waveform

# Amplitudes at which the structure of a system is looked for: what holds at such numbers holds at all.
GENERIC_AMPLITUDES = (0.618034, 0.271828)


class Part(NamedTuple):
    """eps^power g(Omega t) times a matrix (N, N), as a part of A and, with a mass, as a part of E in E y' = A y."""

    power: int
    waveform: Waveform
    A: FloatArray
    E: FloatArray


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
    parts : tuple of Part
        What depends on eps.
    smooth : Harmonics or None
        The same as Fourier sums, if there are no jumps, no pulses and no parts of E.
    rate : float
        Largest modulus of an eigenvalue of the free motion.
    symplectic : bool
        Whether the motion is symplectic in these coordinates, the first half being places and the second momenta.
    reversible : bool
        Whether with mu also 1 / conj(mu) is a multiplier although it is not ``symplectic``.
    """

    A: FloatArray
    parts: tuple[Part, ...]
    smooth: Harmonics | None
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
        return max([1, *(p.waveform.harmonics for p in self.parts if isinstance(p.waveform, Trigonometric))])


class Parts(NamedTuple):
    """The independent subsystems of a general system, and the number of its rigid motions."""

    subsystems: tuple[GeneralSubsystem, ...]
    rigid: int


@lru_cache(maxsize=64)
def general_subsystems(system: AnySystem, Omega: float) -> Parts:
    """Return the independent subsystems of ``system``, whose matrices are those at ``Omega``."""
    if isinstance(system, FirstOrderSystem):
        return Parts(tuple(_first_order(system)), 0)
    inverse = sla.solve_triangular(np.linalg.cholesky(system.mass), np.eye(system.size), lower=True)
    constant = [system.gyroscopic, system.damping, system.stiffness]
    matrices = np.array([*constant, *system.cosine, *system.sine, *(term.matrix for term in system.terms)])
    bases = [inverse.T @ X for X in invariant_subspaces(inverse @ matrices @ inverse.T)]
    elastic = [V for V in bases if not is_rigid(matrices, V)]
    rigid = system.size - sum(V.shape[1] for V in elastic)
    return Parts(tuple(_second_order(system, V, Omega) for V in elastic), rigid)


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


def _second_order(system: PeriodicSystem, V: FloatArray, Omega: float) -> GeneralSubsystem:
    """Return the subsystem W = V r in energy coordinates, y = (w r, r'), or in canonical ones."""
    K = V.T @ system.stiffness @ V
    V = V @ sla.eigh(K + K.T, V.T @ system.mass @ V)[1]
    b = V.shape[1]
    projected = system.restricted(V)
    w = np.maximum(np.sqrt(np.abs(np.diag(projected.stiffness))), least_frequency(Omega))
    hamiltonian = all(conserved_form(projected, Omega, eps) is not None for eps in GENERIC_AMPLITUDES)
    pulses = any(isinstance(term.waveform, Impulses) for term in system.terms)
    smooth = not pulses and all(isinstance(term.waveform, Trigonometric) and term.of != "mass" for term in system.terms)
    drag, force = projected.gyroscopic + projected.damping, projected.stiffness
    free = np.block([[np.zeros((b, b)), np.diag(w)], [-force / w, -drag]])
    rate = float(np.abs(np.linalg.eigvals(free)).max())
    if hamiltonian and smooth:
        A, found = _canonical(projected, w)
        return _subsystem(A, found, rate, symplectic=True, reversible=False)
    zero, empty = np.zeros((b, b)), np.zeros((2 * b, 2 * b))

    def lower(left: FloatArray, right: FloatArray) -> FloatArray:
        return np.block([[zero, zero], [left, right]])

    parts = []
    for of, waveform, X, power in excitation(projected):
        if of == "mass":
            parts.append(Part(power, waveform, empty, lower(zero, X)))
        else:
            parts.append(Part(power, waveform, lower(-X / w, zero) if of == "stiffness" else lower(zero, -X), empty))
    reversible = hamiltonian or all(is_reversible(projected, eps) for eps in GENERIC_AMPLITUDES)
    return _subsystem(free, parts, rate, symplectic=False, reversible=reversible)


def _canonical(system: PeriodicSystem, w: FloatArray) -> tuple[FloatArray, list[Part]]:
    """Return A and the parts of a Hamiltonian system of unit mass in y = (w^1/2 r, w^-1/2 (r' + G(t) r / 2)).

    Then r' = p - G r / 2 and p' = - (S - G^2 / 4) r - G p / 2, where S is the symmetric part of the stiffness.
    """
    b = len(w)
    sqrt_w, zero = np.sqrt(w), np.zeros((b, b))
    Sums = list[tuple[int, Waveform, FloatArray]]
    G: Sums = [(0, waveforms.constant(), system.gyroscopic)]
    S: Sums = [(0, waveforms.constant(), system.stiffness)]
    for of, waveform, X, power in excitation(system):
        if of == "gyroscopic":
            G.append((power, waveform, X))
        elif of == "stiffness":
            S.append((power, waveform, X))
    parts: Sums = []
    for power, g, X in S:
        force = -(X + X.T) / 2 / np.outer(sqrt_w, sqrt_w)
        parts.append((power, g, np.block([[zero, zero], [force, zero]])))
    for power, g, X in G:
        here, there = (scale[:, None] * X / 2 / scale for scale in (sqrt_w, 1 / sqrt_w))
        parts.append((power, g, np.block([[-here, zero], [zero, -there]])))
    for p, g, X in G:
        for q, h, Y in G:
            square = (X @ Y / 4) / np.outer(sqrt_w, sqrt_w)
            parts.append((p + q, _product(g, h), np.block([[zero, zero], [square, zero]])))
    A = np.block([[zero, np.diag(w)], [zero, zero]]) + sum(X for power, _, X in parts if not power)
    return A, [Part(power, g, X, np.zeros_like(X)) for power, g, X in parts if power]


def _product(g: Waveform, h: Waveform) -> Trigonometric:
    """Return the product of two Fourier sums."""
    assert isinstance(g, Trigonometric)
    assert isinstance(h, Trigonometric)
    one, other = (np.array(x.cosines) - 1j * np.array(x.sines) for x in (g, h))
    total = np.zeros(len(one) + len(other) - 1, complex)
    # Re(a e^{ij}) Re(b e^{ik}) = Re(a b e^{i(j+k)} + a conj(b) e^{i(j-k)}) / 2
    for j, a in enumerate(one):
        for k, b in enumerate(other):
            total[j + k] += a * b / 2
            if j >= k:
                total[j - k] += a * np.conj(b) / 2
            else:
                total[k - j] += np.conj(a) * b / 2
    sines = -total.imag
    sines[0] = 0.0
    return Trigonometric(tuple(total.real.tolist()), tuple(sines.tolist()), g.rest + h.rest)


def _first_order(system: FirstOrderSystem) -> Iterator[GeneralSubsystem]:
    parts = [(waveform, X, power) for _, waveform, X, power in excitation(system)]
    matrices = np.array([system.constant, *(X for _, X, _ in parts)])
    for V in invariant_subspaces(matrices):
        inside = V.T @ matrices @ V
        scale = np.diag(sla.matrix_balance(np.abs(inside).sum(axis=0), permute=False, separate=False)[1])
        A, *others = inside * scale / scale[:, None]
        found = [Part(p, g, X, np.zeros_like(X)) for (g, _, p), X in zip(parts, others, strict=True)]
        small = FirstOrderSystem(A, terms=[Term("state", X, g, p) for (g, _, p), X in zip(parts, others, strict=True)])
        reversible = skew_form(small, GENERIC_AMPLITUDES[0]) is not None
        rate = float(np.abs(np.linalg.eigvals(A)).max())
        yield _subsystem(A, found, rate, symplectic=False, reversible=reversible)


def _subsystem(
    A: FloatArray, parts: Iterable[Part], rate: float, *, symplectic: bool, reversible: bool
) -> GeneralSubsystem:
    parts = tuple(part for part in parts if part.A.any() or part.E.any())
    smooth = all(isinstance(part.waveform, Trigonometric) and not part.E.any() for part in parts)
    return GeneralSubsystem(A, parts, _harmonics(parts, len(A)) if smooth else None, rate, symplectic, reversible)


def _harmonics(parts: Iterable[Part], N: int) -> Harmonics:
    """Return the parts as one Fourier sum for each power of eps."""
    found: dict[tuple[int, int], FloatArray] = {}
    for part in parts:
        assert isinstance(part.waveform, Trigonometric)
        for j, (c, s) in enumerate(zip(part.waveform.cosines, part.waveform.sines, strict=True)):
            if c or s:
                sums = found.setdefault((part.power, j), np.zeros((2, N, N)))
                sums += np.multiply.outer((c, s), part.A)
    keys = sorted(key for key, sums in found.items() if sums.any())
    matrices = np.array([found[key] for key in keys]).reshape(-1, 2, N, N)
    strength = np.array([math.hypot(*map(numerical_radius, pair)) for pair in matrices])
    powers, harmonics = np.array(keys, dtype=float).reshape(-1, 2).T
    cosine, sine = np.ascontiguousarray(matrices.transpose(1, 0, 2, 3))
    return Harmonics(powers, harmonics, cosine, sine, strength)


@lru_cache(maxsize=256)
def largest_value(waveform: Waveform) -> float:
    """Return a bound on |g|; of pulses, on their areas."""
    if isinstance(waveform, Trigonometric):
        return float(np.hypot(waveform.cosines, waveform.sines).sum())
    if isinstance(waveform, Piecewise):
        return max(float(np.abs(piece).sum()) for piece in waveform.pieces)
    return float(np.abs(waveform.weights).sum())


def numerical_radius(X: FloatArray) -> float:
    """Return a bound on the rate at which y' = z X y makes |y| grow, for any complex z of modulus one.

    It is half of |X| + |X^2|^(1/2) at most (F. Kittaneh, Studia Mathematica 158 (2003) 11-17): |X| / 2 for a force that
    depends on places alone, |X| for damping.
    """
    # the Frobenius norm is larger than that of Kittaneh's bound, but costs nothing
    return float(np.linalg.norm(X, 2) + math.sqrt(np.linalg.norm(X @ X))) / 2
