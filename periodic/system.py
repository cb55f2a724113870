"""The one definition that every other package shares: a linear system of second order with periodic coefficients."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from periodic.checks import FloatArray, is_positive_definite, real_array
from periodic.terms import (
    SYMMETRY,
    SYMMETRY_TOLERANCE,
    Term,
    absorb,
    checked_terms,
    harmonics,
    square,
    sum_of,
    symmetric,
)
from periodic.waveforms import Trigonometric

__all__ = ["SYMMETRY_TOLERANCE", "PeriodicSystem", "check_mass"]

# An entry of a matrix in another basis is rounding below this part of the sums that cancel in it.
ROUNDING_LEFT = 1e-15
# The lowest eigenvalue of the mass is looked at in so many phases of the fastest harmonic, and so many times closer
# around its minimum.
MASS_SAMPLES, MASS_ZOOMS = 33, 3
# Part of the constant mass below which the mass counts as singular, and part of a piece that ends are moved inwards.
MASS_INSET = 1e-12


@dataclass(frozen=True, eq=False)
class PeriodicSystem:
    """M W'' + (G + C) W' + (K + eps sum_j [F_cj cos(j Omega t) + F_sj sin(j Omega t)]) W = 0, and further terms.

    The form of eq. (11) of Young, Huang and Chiu; any linear system with periodic stiffness has it. ``terms`` add
    eps^power g(Omega t) X to any of the four matrices. Arrays are copied, checked and made read-only. The units may be
    any that are consistent.

    Parameters
    ----------
    mass : array_like, shape (n, n)
        M, symmetric positive definite.
    gyroscopic : array_like, shape (n, n), optional
        G, skew-symmetric. The plate's V G_o.
    damping : array_like, shape (n, n), optional
        C, symmetric. The plate's c K_oe.
    stiffness : array_like, shape (n, n), optional
        K, any real matrix. The plate's K_o.
    cosine : array_like, shape (J, n, n) or (n, n), optional
        F_cj for j = 1..J, any real matrices. The plate's f0 F_cj.
    sine : array_like, shape (J, n, n) or (n, n), optional
        F_sj for j = 1..J.
    terms : iterable of Term
        Further parts of the matrices. Harmonics of the stiffness with power 1 are added to ``cosine`` and ``sine``.

    Matrices that are left out are zero.

    Attributes
    ----------
    size : int
        n, the number of coordinates.
    harmonics : int
        J, the number of matrices in ``cosine`` and in ``sine``, at least 1.
    terms : tuple of Term
        Those that ``cosine`` and ``sine`` do not hold; empty if only the stiffness depends on time, as in eq. (11).

    Raises
    ------
    ValueError
        If a matrix has the wrong shape, type or symmetry, mass is not positive definite, or an entry is not finite.

    Notes
    -----
    Where the mass jumps, the momentum M W' goes on; where a gyroscopic matrix or a speed jumps, give the pulse of the
    stiffness that belongs to it as a term. A mass matrix that is singular because coordinates have no mass:
    `periodic.massless`.
    """

    mass: FloatArray
    gyroscopic: FloatArray
    damping: FloatArray
    stiffness: FloatArray
    cosine: FloatArray
    sine: FloatArray
    terms: tuple[Term, ...]

    def __init__(
        self,
        mass: ArrayLike,
        gyroscopic: ArrayLike | None = None,
        damping: ArrayLike | None = None,
        stiffness: ArrayLike | None = None,
        cosine: ArrayLike | None = None,
        sine: ArrayLike | None = None,
        *,
        terms: Iterable[Term] = (),
    ) -> None:
        M = real_array("mass", mass, 2)
        n = M.shape[0]
        M = symmetric("mass", square("mass", M, n), 1)
        if not is_positive_definite(M):
            lowest = float(np.linalg.eigvalsh(M)[0])
            raise ValueError(
                f"mass has the lowest eigenvalue {lowest:.6g}; give a positive definite matrix, "
                "or take coordinates without mass out with periodic.massless"
            )
        G = symmetric("gyroscopic", _matrix("gyroscopic", gyroscopic, n), -1)
        C = symmetric("damping", _matrix("damping", damping, n), 1)
        K = _matrix("stiffness", stiffness, n)
        Fc = None if cosine is None else harmonics("cosine", cosine, n)
        Fs = None if sine is None else harmonics("sine", sine, n)
        if Fc is not None and Fs is not None and Fs.shape != Fc.shape:
            raise ValueError(f"sine has shape {Fs.shape}; give the shape of cosine, {Fc.shape}")
        checked = checked_terms(terms, n, ("mass", "gyroscopic", "damping", "stiffness"))
        Fc, Fs, rest = absorb(Fc, Fs, checked, n, "stiffness")
        arrays = {"mass": M, "gyroscopic": G, "damping": C, "stiffness": K, "cosine": Fc, "sine": Fs}
        for name, array in arrays.items():
            array.setflags(write=False)
            object.__setattr__(self, name, array)
        object.__setattr__(self, "terms", rest)

    @property
    def size(self) -> int:
        """Number of coordinates n."""
        return int(self.mass.shape[0])

    @property
    def harmonics(self) -> int:
        """Number of harmonics J."""
        return int(self.cosine.shape[0])

    def at(self, Omega: float) -> PeriodicSystem:
        """Return the system itself: its matrices do not depend on the frequency (`SystemFamily`)."""
        return self

    def restricted(self, basis: FloatArray) -> PeriodicSystem:
        """Return the system of the motions W = basis @ q, ``basis`` of shape (n, m).

        What rounding leaves of a matrix that does not act on them is dropped.
        """

        def inside(X: FloatArray, sign: int) -> FloatArray:
            found = basis.T @ X @ basis
            largest = np.abs(X).max(axis=(-2, -1), keepdims=True, initial=0.0)
            cancelled = np.abs(basis).sum(axis=0)
            found = np.where(np.abs(found) <= ROUNDING_LEFT * largest * np.outer(cancelled, cancelled), 0.0, found)
            return np.asarray((found + sign * found.T) / 2 if sign else found)

        M, G, C, K = (inside(getattr(self, of), SYMMETRY[of]) for of in ("mass", "gyroscopic", "damping", "stiffness"))
        terms = [Term(t.of, inside(t.matrix, SYMMETRY[t.of]), t.waveform, t.power) for t in self.terms]
        return PeriodicSystem(M, G, C, K, inside(self.cosine, 0), inside(self.sine, 0), terms=terms)

    def matrices(self, theta: ArrayLike, eps: float) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """Return M, G, C and K with all their terms at the phases ``theta`` = Omega t, without pulses.

        Each has the shape ``(*theta.shape, n, n)``.
        """
        phases = np.asarray(theta, dtype=float)
        turned = np.multiply.outer(phases, np.arange(1, self.harmonics + 1))
        excitation = np.tensordot(np.cos(turned), self.cosine, 1) + np.tensordot(np.sin(turned), self.sine, 1)
        M, G, C, K = (
            getattr(self, of) + sum_of(self.terms, of, phases, eps, self.size)
            for of in ("mass", "gyroscopic", "damping", "stiffness")
        )
        return M, G, C, K + eps * excitation


def check_mass(system: PeriodicSystem, eps: float) -> None:
    """Refuse a mass matrix that is not positive definite throughout the period.

    Raises
    ------
    ValueError
        With the phase at which it is not.
    """
    waves = [term.waveform for term in system.terms if term.of == "mass"]
    if not waves:
        return
    jumps = sorted({0.0, 1.0, *(jump for wave in waves for jump in wave.jumps)})
    harmonics = max([1, *(wave.harmonics for wave in waves if isinstance(wave, Trigonometric))])
    inverse = np.linalg.inv(np.linalg.cholesky(system.mass))
    x = (1 - np.cos(np.linspace(0, np.pi, MASS_SAMPLES * harmonics))) / 2
    for a, b in pairwise(jumps):
        inset = MASS_INSET * (b - a)  # ends belong to the piece on this side
        phases = np.clip(a + (b - a) * x, a + inset, b - inset)
        for _ in range(MASS_ZOOMS):
            masses = system.mass + sum_of(system.terms, "mass", 2 * np.pi * phases, eps, system.size)
            lowest = np.linalg.eigvalsh(inverse @ masses @ inverse.T)[:, 0]
            i = int(lowest.argmin())
            if lowest[i] <= MASS_INSET:
                raise ValueError(
                    f"mass at eps = {eps!r} is not positive definite at the phase {phases[i]:.6g} of the period "
                    f"(theta = {2 * np.pi * phases[i]:.6g}); give a smaller eps"
                )
            phases = np.linspace(phases[max(i - 1, 0)], phases[min(i + 1, len(phases) - 1)], MASS_SAMPLES)


def _matrix(name: str, value: ArrayLike | None, n: int) -> FloatArray:
    if value is None:
        return np.zeros((n, n))
    array = real_array(name, value, 2)
    if array.shape != (n, n):
        raise ValueError(f"{name} has shape {array.shape}; give ({n}, {n}), as mass has")
    return array
