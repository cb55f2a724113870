"""The equations of motion in the modal basis, near a frequency Omega_0: what multiple scales expands.

The complex modal basis has the states nu = 1..n for Z_nu and n+1..2n for the conjugates, with Z^H A Z = 1 and the
frequency of a conjugate negative. With q = e^{lambda t} sum_h sum_nu a_nu^h Z_nu e^{i h Omega t} the equations are

    lambda a_nu^h = i (omega_nu - h Omega) a_nu^h + sum of terms eps^m x^k V^{(l)} a^{h-l},     x = Omega - Omega_0.

The terms are damping, excitation, and what changes with Omega: all of them are small, and x counts like eps. V^{(l)}
for the excitation is - E^{(l)}, and for damping - Gamma.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from periodic import PeriodicSystem, SystemFamily, member_at
from periodic.checks import ComplexArray, FloatArray
from perturb.coupling import amplitude, is_symmetric, projection
from perturb.modes import GyroscopicModes, gyroscopic_modes
from perturb.resonance import Resonance

# Step, as a part of Omega, for derivatives of matrices that depend on Omega: its square, and rounding divided by it,
# stay far below the third-order terms left out.
DERIVATIVE_STEP = 1e-4

# Entries of a difference of matrices below this part of the matrices themselves are rounding.
DIFFERENCE_ROUNDING = 1e-14


class Term(NamedTuple):
    """eps^power x^drift e^{i harmonic Omega t} V; ``order`` counts eps, x and damping as one each."""

    order: int
    power: int
    drift: int
    harmonic: int
    V: ComplexArray


@dataclass(frozen=True, eq=False)
class ModalEquations:
    """The equations of all states near one frequency.

    Attributes
    ----------
    omega : ndarray, shape (2n,)
        Signed frequencies of the states.
    terms : tuple of Term
        With matrices of shape (2n, 2n).
    harmonics : int
        J, the number of harmonics of the excitation.
    conservative : bool
        No damping, and symmetric excitation matrices.
    """

    omega: FloatArray
    terms: tuple[Term, ...]
    harmonics: int
    conservative: bool

    def states(self, resonance: Resonance) -> list[tuple[int, int]]:
        """Return the two states (nu, h), nu from 0, that make a resonance."""
        partner = resonance.q - 1 + (len(self.omega) // 2 if resonance.type == "sum" else 0)
        return [(resonance.p - 1, 0), (partner, -resonance.j)]

    @cached_property
    def excitation(self) -> FloatArray:
        """Moduli of the first-order couplings by the excitation, shape (2J + 1, 2n, 2n), harmonics -J..J."""
        size = np.zeros((2 * self.harmonics + 1, len(self.omega), len(self.omega)))
        for term in self.terms:
            if term.order == term.power == 1:
                size[self.harmonics + term.harmonic] += np.abs(term.V)
        return size

    @cached_property
    def steady(self) -> FloatArray:
        """Moduli of the couplings by damping, shape (2n, 2n)."""
        return self._sizes(0, 0)

    @cached_property
    def moving(self) -> FloatArray:
        """Moduli of the couplings per x by what changes with Omega, shape (2n, 2n)."""
        return self._sizes(0, 1)

    def _sizes(self, power: int, drift: int) -> FloatArray:
        size = np.zeros((len(self.omega), len(self.omega)))
        for term in self.terms:
            if (term.order, term.power, term.drift) == (1, power, drift):
                size += np.abs(term.V)
        return size

    @cached_property
    def strongest(self) -> FloatArray:
        """Largest modulus among all couplings of a state by the excitation, shape (2n,)."""
        size = self.excitation.max(axis=0)
        return np.maximum(size.max(axis=0), size.max(axis=1))

    @cached_property
    def softness(self) -> FloatArray:
        """Part of its energy that the excitation moves in a mode, per eps: largest sum_j |w_nu^H E_j w_mu|, (2n,)."""
        size = self.excitation.sum(axis=0) / np.abs(self.omega)[:, None]
        return 2 * size.max(axis=1)


class Expansion:
    """The modal equations of a family at any frequency, computed when a resonance asks for them.

    Parameters
    ----------
    family : SystemFamily
    modes : GyroscopicModes, optional
        Of a family whose mass, gyroscopic, damping and stiffness matrices are the same at all frequencies. Without
        them, each frequency has its own modes.
    """

    def __init__(self, family: SystemFamily, modes: GyroscopicModes | None) -> None:
        self.family = family
        self.modes = modes
        self._latest: tuple[PeriodicSystem, tuple[Term, ...], ModalEquations] | None = None

    def modes_at(self, Omega: float) -> GyroscopicModes:
        """Return the modes of the member at Omega."""
        return self.modes or gyroscopic_modes(member_at(self.family, Omega, "family"))

    def equations(self, centre: float, order: int) -> ModalEquations:
        """Return the modal equations near ``centre``, with all terms of orders up to ``order``."""
        system = member_at(self.family, centre, "family")
        drift: tuple[Term, ...] = ()
        modes = self.modes_at(centre)
        if order == 2 or self.modes is None:
            step = DERIVATIVE_STEP * centre
            below, above = (member_at(self.family, centre + side * step, "family") for side in (-1, 1))
            drift = () if same_matrices(below, above) else _drift(modes, below, system, above, step)
        if self._latest is None or drift or self._latest[1] or not same_matrices(self._latest[0], system):
            self._latest = system, drift, modal_equations(modes, system, drift)
        return self._latest[2]


def modal_equations(modes: GyroscopicModes, system: PeriodicSystem, drift: tuple[Term, ...] = ()) -> ModalEquations:
    """Return the modal equations of ``system`` in the basis ``modes``, with the terms ``drift`` added."""
    omega = np.concatenate([modes.frequencies, -modes.frequencies])
    w = np.concatenate([modes.vectors, modes.vectors.conj()], axis=1) / np.sqrt(2)
    terms = []
    if system.damping.any():
        Gamma = omega[:, None] * projection(w, system.damping.astype(complex), w) * omega
        terms.append(Term(1, 0, 0, 0, -Gamma))
    conservative = not system.damping.any()
    for j in range(1, system.harmonics + 1):
        E_j = amplitude(system, j)
        upward = projection(w, E_j, w)
        downward = upward.conj().T if is_symmetric(E_j) else projection(w, E_j.conj(), w)
        terms.append(Term(1, 1, 0, j, 0.5j * omega[:, None] * upward))
        terms.append(Term(1, 1, 0, -j, 0.5j * omega[:, None] * downward))
        conservative = conservative and is_symmetric(E_j)
    return ModalEquations(omega, (*terms, *drift), system.harmonics, conservative)


def same_matrices(a: PeriodicSystem, b: PeriodicSystem) -> bool:
    """Whether two members of a family are equal."""
    return a is b or (same_modes(a, b) and np.array_equal(a.cosine, b.cosine) and np.array_equal(a.sine, b.sine))


def same_modes(a: PeriodicSystem, b: PeriodicSystem) -> bool:
    """Whether two members of a family are equal but for their excitation."""
    names = ("mass", "gyroscopic", "damping", "stiffness")
    return a is b or all(np.array_equal(getattr(a, name), getattr(b, name)) for name in names)


def _drift(
    modes: GyroscopicModes, below: PeriodicSystem, here: PeriodicSystem, above: PeriodicSystem, step: float
) -> tuple[Term, ...]:
    """Return the terms by which the equations change with x, up to second order."""
    zero = np.zeros_like(here.mass)
    Z = np.concatenate([modes.states, modes.states.conj()], axis=1) / np.sqrt(2)
    A = np.block([[here.mass, zero], [zero, here.stiffness]])
    left = Z.conj().T @ A

    def term(order: int, power: int, drift: int, harmonic: int, change: ComplexArray, whole: ComplexArray) -> Term:
        V, size = left @ change @ Z, np.abs(left @ whole @ Z).max()
        significant = np.abs(V) > DIFFERENCE_ROUNDING * size
        return Term(order, power, drift, harmonic, np.asarray(np.where(significant, V, 0) / step**drift, dtype=complex))

    terms = []
    if not same_modes(below, above):
        free = [_free_motion(system) for system in (below, here, above)]
        damping = [_damping(system) for system in (below, here, above)]
        terms += [
            term(1, 0, 1, 0, 0.5 * (free[2] - free[0]), free[1]),
            term(2, 0, 2, 0, 0.5 * (free[2] + free[0]) - free[1], free[1]),
            term(2, 0, 1, 0, 0.5 * (damping[2] - damping[0]), damping[1]),
        ]
    for j in range(1, here.harmonics + 1):
        force, change = _force(here, j), 0.5 * (_force(above, j) - _force(below, j))
        terms += [term(2, 1, 1, j, change, force), term(2, 1, 1, -j, change.conj(), force.conj())]
    return tuple(term for term in terms if term.V.any())


def _free_motion(system: PeriodicSystem) -> ComplexArray:
    """Return the matrix of q' = ... without damping and excitation, q = (W', W)."""
    n, zero = system.size, np.zeros_like(system.mass)
    pushes = np.linalg.solve(system.mass, np.concatenate([system.gyroscopic, system.stiffness], axis=1))
    return np.block([[-pushes[:, :n], -pushes[:, n:]], [np.eye(n), zero]]).astype(complex)


def _damping(system: PeriodicSystem) -> ComplexArray:
    zero = np.zeros_like(system.mass)
    return np.block([[-np.linalg.solve(system.mass, system.damping), zero], [zero, zero]]).astype(complex)


def _force(system: PeriodicSystem, j: int) -> ComplexArray:
    """Return the part of the equations for q = (W', W) that goes with e^{i j Omega t}, per eps."""
    zero = np.zeros_like(system.mass)
    return np.block([[zero, -0.5 * np.linalg.solve(system.mass, amplitude(system, j))], [zero, zero]])
