"""Takes systems apart into general subsystems, members of a family one after the other.

What the members have in common is found once: bases of the subsystems, modes, rates and bounds on growth. Each of these
is kept from the member before if it holds for this one, too, which costs less than to find it again.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import lru_cache
from typing import NamedTuple

import numpy as np
import scipy.linalg as sla

from floquet.engine.coordinates import CYCLES_PER_LEAST_CYCLE, is_rigid, least_frequency
from floquet.engine.decoupling import COUPLING_TOLERANCE, invariant_subspaces
from floquet.engine.general import fourier
from floquet.engine.general.fourier import Sums
from floquet.engine.general.radius import Radii
from floquet.engine.general.subsystems import GeneralSubsystem, Harmonics, Part, Parts
from periodic import AnySystem, FirstOrderSystem, PeriodicSystem, Term, excitation
from periodic.checks import FloatArray
from periodic.structure import STRUCTURE_DEFECT, conserved_form, is_reversible, skew_form
from periodic.system import ROUNDING_LEFT
from periodic.terms import SYMMETRY
from periodic.waveforms import Trigonometric, Waveform

# Amplitudes at which the structure of a system is looked for: what holds at such numbers holds at all.
GENERIC_AMPLITUDES = (0.618034, 0.271828)
CONSTANT = ("gyroscopic", "damping", "stiffness")


def general_subsystems(systems: Sequence[AnySystem], Omega: FloatArray) -> list[Parts]:
    """Return the independent subsystems of each system, whose matrices are those at the frequency ``Omega``.

    The systems are members of a family at neighbouring frequencies; one may be given several times.
    """
    if all(system is systems[0] for system in systems) and not _depends_on_frequency(systems[0]):
        return [_known_parts(systems[0], CYCLES_PER_LEAST_CYCLE * least_frequency(w)) for w in Omega.tolist()]
    members = Members()
    return [members.parts(system, w) for system, w in zip(systems, Omega.tolist(), strict=True)]


@lru_cache(maxsize=64)
def _known_parts(system: AnySystem, Omega: float) -> Parts:
    return Members().parts(system, Omega)


def _depends_on_frequency(system: AnySystem) -> bool:
    """Return whether the derivative of a matrix with respect to time enters, which is all that goes with Omega.

    (The least frequency of a coordinate goes with it, too, but in powers of two.)
    """
    return any(term.of in ("mass", "gyroscopic") for term in system.terms)


class _Bases(NamedTuple):
    """Bases of independent subsystems, orthonormal with respect to the mass, and where each is in all of them."""

    mass: FloatArray
    whole: FloatArray
    places: list[slice]

    def suit(self, mass: FloatArray, matrices: FloatArray) -> bool:
        """Return whether other ``matrices`` (p, n, n) keep the same subspaces."""
        if mass.shape != self.mass.shape or not np.array_equal(mass, self.mass):
            return False
        coupled = np.abs(self.whole.T @ matrices @ self.whole)
        sizes = np.linalg.norm(coupled, axis=(1, 2))
        for place in self.places:
            coupled[:, place, place] = 0.0
        return bool((coupled <= COUPLING_TOLERANCE * sizes[:, None, None]).all())


class _Modes(NamedTuple):
    """The modes of a subsystem without gyroscopic forces, ``V`` (n, b), and the matrices that made them."""

    basis: FloatArray
    stiffness: FloatArray
    V: FloatArray


class _Excited(NamedTuple):
    """What depends on eps in one second-order subsystem: of which matrix, waveform, matrix (b, b), power."""

    of: str
    waveform: Waveform
    X: FloatArray
    power: int


class Members:
    """Takes members of a family apart, one after the other."""

    def __init__(self) -> None:
        self.radii = Radii()
        self.bases: _Bases | None = None
        self.modes: dict[int, _Modes] = {}
        self.free: dict[int, tuple[FloatArray, float]] = {}
        self.canonical: dict[int, bool] = {}

    def parts(self, system: AnySystem, Omega: float) -> Parts:
        """Return the independent subsystems of the next member."""
        if isinstance(system, FirstOrderSystem):
            return Parts(tuple(self._first_order(system)), 0)
        excited = [_Excited(*each) for each in excitation(system)]
        matrices = np.array([*(getattr(system, of) for of in CONSTANT), *(each.X for each in excited)])
        bases = self._independent(system.mass, matrices)
        elastic = [(i, V) for i, V in enumerate(bases) if not is_rigid(matrices, V)]
        rigid = system.size - sum(V.shape[1] for _, V in elastic)
        return Parts(tuple(self._second_order(i, system, V, excited, matrices, Omega) for i, V in elastic), rigid)

    def _independent(self, mass: FloatArray, matrices: FloatArray) -> list[FloatArray]:
        """Return bases of the independent subsystems: those of the member before, if they are its own."""
        if self.bases is None or not self.bases.suit(mass, matrices):
            inverse = sla.solve_triangular(np.linalg.cholesky(mass), np.eye(len(mass)), lower=True)
            found = [inverse.T @ X for X in invariant_subspaces(inverse @ matrices @ inverse.T)]
            ends = np.cumsum([V.shape[1] for V in found]).tolist()
            places = [slice(end - V.shape[1], end) for V, end in zip(found, ends, strict=True)]
            self.bases = _Bases(mass, np.hstack(found), places)
        return [self.bases.whole[:, place] for place in self.bases.places]

    def _second_order(
        self,
        i: int,
        system: PeriodicSystem,
        basis: FloatArray,
        excited: list[_Excited],
        matrices: FloatArray,
        Omega: float,
    ) -> GeneralSubsystem:
        """Return the subsystem W = V r in energy coordinates, y = (w r, r'), or in canonical ones."""
        V = self._modes_of(i, system, basis)
        names = [*CONSTANT, *(each.of for each in excited)]
        G, C, K, *others = _inside(V, matrices, names)
        inside = [each._replace(X=X) for each, X in zip(excited, others, strict=True) if X.any()]
        w = np.maximum(np.sqrt(np.abs(np.diag(K))), least_frequency(Omega))
        rate = self._rate(i, G, C, K, w)
        if all(isinstance(each.waveform, Trigonometric) and each.of != "mass" for each in inside):
            return self._smooth(i, system, V, (G, C, K), inside, w, rate, Omega)
        return self._jumping(i, system, V, (G, C, K), inside, w, rate, Omega)

    def _modes_of(self, i: int, system: PeriodicSystem, basis: FloatArray) -> FloatArray:
        known, K = self.modes.get(i), system.stiffness
        if known is None or not (np.array_equal(known.basis, basis) and np.array_equal(known.stiffness, K)):
            inside = basis.T @ K @ basis
            # with respect to the mass once more: the first time an ill-conditioned mass matrix costs digits
            V = basis @ sla.eigh(inside + inside.T, basis.T @ system.mass @ basis)[1]
            known = self.modes[i] = _Modes(basis, K, V)
        return known.V

    def _rate(self, i: int, G: FloatArray, C: FloatArray, K: FloatArray, w: FloatArray) -> float:
        """Return the largest modulus of an eigenvalue of the free motion."""
        matrices = np.array([G, C, K])
        known = self.free.get(i)
        if known is None or not np.array_equal(known[0], matrices):
            free = _energy(fourier.constant(G), fourier.constant(C), fourier.constant(K), w)[0, 0].real
            known = self.free[i] = matrices, float(np.abs(np.linalg.eigvals(free)).max())
        return known[1]

    def _smooth(
        self,
        i: int,
        system: PeriodicSystem,
        V: FloatArray,
        free: tuple[FloatArray, FloatArray, FloatArray],
        excited: list[_Excited],
        w: FloatArray,
        rate: float,
        Omega: float,
    ) -> GeneralSubsystem:
        found = {of: [fourier.constant(X)] for of, X in zip(CONSTANT, free, strict=True)}
        for each in excited:
            assert isinstance(each.waveform, Trigonometric)
            found[each.of].append(fourier.waves(each.power, each.waveform, each.X))
        G, C, K = (fourier.total(found[of]) for of in CONSTANT)
        hamiltonian = _is_hamiltonian(G, C, K, Omega)
        reversible = not hamiltonian and _is_reversible(system, V, free)
        energy = _energy(G, C, K, w)
        canonical = _canonical(G, C, K, w, Omega, symplectic=hamiltonian) if hamiltonian or len(G) > 1 else None
        if canonical is not None and (hamiltonian or self._is_better(i, canonical, energy)):
            return self._with_harmonics((i, True), canonical, rate, hamiltonian, reversible)
        return self._with_harmonics((i, False), energy, rate, hamiltonian, reversible)

    def _is_better(self, i: int, canonical: Sums, energy: Sums) -> bool:
        """Return whether canonical coordinates have the smaller bounds; all members get those of the first."""
        if i not in self.canonical:
            one, other = self._strength((i, True), canonical), self._strength((i, False), energy)
            self.canonical[i] = bool(one.sum() < other.sum())
        return self.canonical[i]

    def _strength(self, name: tuple[int, bool], sums: Sums) -> FloatArray:
        """Return the strengths of the harmonics of a sum; see `Harmonics`."""
        return np.array(
            [
                np.hypot(self.radii.bound((name, key, 0), Z.real), self.radii.bound((name, key, 1), Z.imag))
                for key, Z in sorted(sums.items())
                if key[0] and Z.any()
            ]
        )

    def _with_harmonics(
        self, name: tuple[int, bool], sums: Sums, rate: float, symplectic: bool, reversible: bool
    ) -> GeneralSubsystem:
        keys = sorted(key for key, Z in sums.items() if key[0] and Z.any())
        A = np.ascontiguousarray(sums[0, 0].real)
        matrices = np.array([sums[key] for key in keys]).reshape(-1, *A.shape)
        powers, harmonics = np.array(keys, dtype=float).reshape(-1, 2).T
        cosine, sine = np.ascontiguousarray(matrices.real), -np.ascontiguousarray(matrices.imag)
        strength = self._strength(name, sums)
        smooth = Harmonics(np.ascontiguousarray(powers), np.ascontiguousarray(harmonics), cosine, sine, strength)
        return GeneralSubsystem(A, smooth, (), rate, symplectic, reversible)

    def _jumping(
        self,
        i: int,
        system: PeriodicSystem,
        V: FloatArray,
        free: tuple[FloatArray, FloatArray, FloatArray],
        excited: list[_Excited],
        w: FloatArray,
        rate: float,
        Omega: float,
    ) -> GeneralSubsystem:
        hamiltonian = _conserves_a_form(system, V, free, excited, Omega)
        # where the momentum is that of a constant mass and a constant gyroscopic matrix, its coordinates do not jump
        symplectic = hamiltonian and all(each.of == "stiffness" for each in excited)
        reversible = not symplectic and (hamiltonian or _is_reversible(system, V, free))
        G, C, K = map(fourier.constant, free)
        A = (_canonical(G, C, K, w, Omega, symplectic=True) if symplectic else _energy(G, C, K, w))[0, 0].real
        left, right = (1 / np.sqrt(w), 1 / np.sqrt(w)) if symplectic else (np.ones(len(w)), 1 / w)
        zero, b = np.zeros(A.shape), len(w)
        parts = []
        for number, each in enumerate(excited):
            acting, moving = zero.copy(), zero
            if each.of == "mass":
                moving = zero.copy()
                moving[b:, b:] = each.X
            elif each.of == "stiffness":
                acting[b:, :b] = -left[:, None] * each.X * right
            else:
                acting[b:, b:] = -each.X
            radius = self.radii.bound((i, symplectic, number), acting)
            parts.append(Part(each.power, each.waveform, acting, moving, radius))
        return GeneralSubsystem(np.ascontiguousarray(A), None, tuple(parts), rate, symplectic, reversible)

    def _first_order(self, system: FirstOrderSystem) -> Iterator[GeneralSubsystem]:
        parts = [(waveform, power) for _, waveform, _, power in excitation(system)]
        matrices = np.array([system.constant, *(X for _, _, X, _ in excitation(system))])
        for i, V in enumerate(self._independent(np.eye(system.size), matrices)):
            inside = V.T @ matrices @ V
            scale = np.diag(sla.matrix_balance(np.abs(inside).sum(axis=0), permute=False, separate=False)[1])
            A, *others = inside * scale / scale[:, None]
            acting = [(g, p, X) for (g, p), X in zip(parts, others, strict=True) if X.any()]
            small = FirstOrderSystem(A, terms=[Term("state", X, g, p) for g, p, X in acting])
            reversible = skew_form(small, GENERIC_AMPLITUDES[0]) is not None
            rate = float(np.abs(np.linalg.eigvals(A)).max())
            if all(isinstance(g, Trigonometric) for g, _, _ in acting):
                waves = (fourier.waves(p, g, X) for g, p, X in acting if isinstance(g, Trigonometric))
                sums = fourier.total([fourier.constant(A), *waves])
                yield self._with_harmonics((i, False), sums, rate, symplectic=False, reversible=reversible)
            else:
                found = (
                    Part(p, g, X, np.zeros_like(X), self.radii.bound((i, number), X))
                    for number, (g, p, X) in enumerate(acting)
                )
                yield GeneralSubsystem(A, None, tuple(found), rate, symplectic=False, reversible=reversible)


def _inside(V: FloatArray, matrices: FloatArray, names: Sequence[str]) -> FloatArray:
    """Return the matrices (p, n, n) of the motions V r, (p, b, b), as `PeriodicSystem.restricted` does."""
    found = V.T @ matrices @ V
    largest, cancelled = np.abs(matrices).max(axis=(1, 2), keepdims=True), np.abs(V).sum(axis=0)
    found[np.abs(found) <= ROUNDING_LEFT * largest * np.outer(cancelled, cancelled)] = 0.0
    signs = np.array([SYMMETRY[of] for of in names])[:, None, None]
    return np.where(signs == 0, found, (found + signs * found.transpose(0, 2, 1)) / 2)


def _energy(G: Sums, C: Sums, K: Sums, w: FloatArray) -> Sums:
    """Return y' for y = (w r, r'), in which the free conservative motion is a rotation and damping shrinks |y|."""
    drag = fourier.total((G, C))
    still = fourier.constant(np.zeros((len(w), len(w))))
    return fourier.blocks(
        still, fourier.constant(np.diag(w)), fourier.scaled(K, -1.0, 1 / w), fourier.scaled(drag, -1.0, 1.0)
    )


def _canonical(G: Sums, C: Sums, K: Sums, w: FloatArray, Omega: float, *, symplectic: bool) -> Sums:
    """Return y' for y = (w^1/2 r, w^-1/2 p) with p = r' + G(t) r / 2.

    Then r' = p - G r / 2 and p' = -(G / 2 + C) p - [K - G' / 2 - (G / 2 + C) G / 2] r. Without damping, and with K of
    which the skew part is G' / 2, the motion is ``symplectic``: what rounding leaves of an asymmetry is dropped.
    """
    root = np.sqrt(w)
    half = fourier.scaled(G, 0.5, 1.0)
    drag = fourier.total((half, C))
    taken = fourier.total((fourier.derivative(half, Omega), fourier.product(drag, half)))
    force = fourier.total((K, fourier.scaled(taken, -1.0, 1.0)))
    if symplectic:
        force = {key: (Z + Z.T) / 2 for key, Z in force.items()}
    return fourier.blocks(
        fourier.scaled(half, -root, 1 / root),
        fourier.constant(np.diag(w)),
        fourier.scaled(force, -1 / root, 1 / root),
        fourier.scaled(drag, -1 / root, root),
    )


def _is_hamiltonian(G: Sums, C: Sums, K: Sums, Omega: float) -> bool:
    """Return whether there is no damping, and the skew part of the stiffness is half the derivative of G."""
    turning = fourier.derivative(G, Omega)
    size = max(_largest(K), _largest(turning))
    skew = fourier.total(({key: Z - Z.T for key, Z in K.items()}, fourier.scaled(turning, -1.0, 1.0)))
    return _largest(C) <= STRUCTURE_DEFECT * _largest(G) and _largest(skew) <= STRUCTURE_DEFECT * size


def _largest(sums: Sums) -> float:
    return max((float(np.abs(Z).max()) for Z in sums.values()), default=0.0)


def _conserves_a_form(
    system: PeriodicSystem,
    V: FloatArray,
    free: tuple[FloatArray, FloatArray, FloatArray],
    excited: Sequence[_Excited],
    Omega: float,
) -> bool:
    """Return whether a subsystem with jumps is Hamiltonian."""
    if all(each.of == "stiffness" for each in excited):
        G, C, K = map(fourier.constant, free)
        return _is_hamiltonian(G, C, K, Omega) and all(
            np.abs(each.X - each.X.T).max() <= STRUCTURE_DEFECT * np.abs(each.X).max() for each in excited
        )
    small = system.restricted(V)
    return all(conserved_form(small, Omega, eps) is not None for eps in GENERIC_AMPLITUDES)


def _is_reversible(system: PeriodicSystem, V: FloatArray, free: tuple[FloatArray, FloatArray, FloatArray]) -> bool:
    """Return whether a subsystem is even in time about some instant."""
    G, C, _ = free
    if G.any() or C.any():
        return False
    small = system.restricted(V)
    return all(is_reversible(small, eps) for eps in GENERIC_AMPLITUDES)
