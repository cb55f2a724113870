"""The "dynamic" stress model: eq. (8) in full, at hundreds of frequencies.

A chart asks for F of eq. (11) at each of its Omega. Between in-plane resonances the response to the edge load is an
analytic function of frequency. A few responses, taken at Chebyshev nodes, therefore span all others to rounding (a
Galerkin reduced basis). The residual of eq. (8) in the energy norm tells the error of each answer. Where it is too
large (beside resonances, beyond the last node) the full system is solved instead. The basis depends on the plate alone,
so that results do not depend on the order of the questions.
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from periodic.checks import ComplexArray, FloatArray
from plate.inplane import InPlaneProblem, InPlaneSubsystem
from plate.stress import StaticStress
from plate.transverse import NumericArray

# Largest kappa = w / C that the basis spans. The lowest stretching resonance of a square plate is at 2.6.
MAX_BASIS_KAPPA = 5.0

# Number of frequencies at which responses are taken: residuals are then near rounding, except beside resonances.
BASIS_FREQUENCIES = 20

# Largest accepted residual of eq. (8), as a part of the edge force in the energy norm; F is about as accurate.
MAX_RELATIVE_RESIDUAL = 1e-10

# Singular values of the responses below this part of the largest one are rounding.
BASIS_RANK_TOLERANCE = 1e-13

# An in-plane response of this many times the static one (in the energy norm) is called resonant. A single mode shows it
# within a tenth of its frequency.
RESONANT_AMPLIFICATION = 5.0


class InPlaneResonanceWarning(UserWarning):
    """A harmonic of the excitation comes near an in-plane resonance of the plate."""


class InPlaneGrowthWarning(UserWarning):
    """In-plane modes of eq. (8) grow at the speed of the plate."""


def warn_of_growth(problem: InPlaneProblem, wave_speed: float, speed: float, damping: float) -> None:
    """Warn if in-plane modes grow at speed V: the response that `DynamicStress` takes is steady, and ignores them."""
    exponent = wave_speed * problem.growth(speed / wave_speed, damping * wave_speed)
    if exponent:
        warnings.warn(
            f"at speed = {speed:.6g}, {abs(speed) / wave_speed:.3g} of the in-plane wave speed, in-plane modes of eq. "
            f"(8) grow, the fastest at the rate {exponent.real:.3g} with frequency {abs(exponent.imag):.6g}; the plate "
            "takes the steady in-plane response all the same. Growth that rises with inplane_terms belongs to the "
            "discretisation: give a thinner plate, a lower speed, fewer inplane_terms or inplane='static'",
            InPlaneGrowthWarning,
            stacklevel=4,  # whoever builds the plate
        )


@dataclass(frozen=True)
class DynamicStress(StaticStress):
    """The stress of eq. (8) in full, as a model of `plate.stress.StressModel`.

    Parameters
    ----------
    load, problem, K, lateral
        As `StaticStress`.
    wave_speed : float
        C = sqrt(beta).
    speed : float
        V.
    damping : float
        c.
    """

    wave_speed: float
    speed: float
    damping: float

    def static_stiffness(self, speed: float) -> FloatArray:
        """Return F_c0 at transport speed V."""
        return self._stiffness(self.problem.response(self.forces[0], 0.0, speed / self.wave_speed, 0.0)).real

    def field(self, harmonic: int, Omega: float, X: FloatArray, Y: FloatArray) -> ComplexArray:
        """Return the stresses at frequency j Omega: the exact static ones and what inertia and transport add.

        That part is smooth, and it is taken from the trial space (6), by the full system.
        """
        force = self.forces[harmonic]
        added = self.problem.response(force, *self._at(harmonic * Omega)) - self.problem.static_response(force)
        return super().field(harmonic, Omega, X, Y) + self.problem.stresses(added, X, Y)

    def stiffness(self, harmonic: int, Omega: float) -> ComplexArray:
        """Return F_cj - i F_sj at frequency j Omega.

        Warns
        -----
        InPlaneResonanceWarning
            If j Omega is near an in-plane resonance that the load excites.
        """
        kappa, mach, loss = self._at(harmonic * Omega)
        n = self.K * self.lateral
        F = np.zeros((n, n), dtype=np.complex128)
        for basis in self._bases:
            subsystem, static = basis.subsystem, basis.static[harmonic]
            z, residual = basis.solve(static, kappa, mach, loss)
            if residual <= MAX_RELATIVE_RESIDUAL * np.linalg.norm(static):
                F += np.tensordot(z, basis.stiffness, axes=1)
            else:
                z = subsystem.solve(static, kappa, mach, loss)
                F += self._stiffness(subsystem.shapes @ z)
            if np.linalg.norm(z) * abs(1 + 1j * loss) > RESONANT_AMPLIFICATION * np.linalg.norm(static):
                frequencies = subsystem.frequencies_at(abs(mach))
                resonance = self.wave_speed * frequencies[np.argmin(np.abs(frequencies - kappa))]
                warnings.warn(
                    f"harmonic {harmonic} of the excitation comes near the in-plane natural frequency {resonance:.6g} "
                    f"(Omega = {resonance / harmonic:.6g}); the in-plane stress is more than "
                    f"{RESONANT_AMPLIFICATION:g} times the static one and has resonances of its own",
                    InPlaneResonanceWarning,
                    stacklevel=4,  # the caller of MovingPlate.at
                )
        return (1 + 1j * loss) * F

    def _at(self, w: float) -> tuple[float, float, float]:
        """Return w/C, V/C and w c."""
        return w / self.wave_speed, self.speed / self.wave_speed, w * self.damping

    @cached_property
    def _bases(self) -> list[ReducedBasis]:
        """A basis for each lateral symmetry that the load excites."""
        kappas = MAX_BASIS_KAPPA * np.sin(np.pi * (np.arange(BASIS_FREQUENCIES) + 0.5) / (2 * BASIS_FREQUENCIES)) ** 2
        bases = []
        for subsystem in self.problem.subsystems:
            static = np.array(self.forces) @ subsystem.shapes
            if not (np.abs(static[1:]) ** 2).any():  # no load, or one whose squares underflow
                continue
            loads = np.concatenate([static[1:].real, static[1:].imag]).T
            responses = [subsystem.solve(loads, *self._at(kappa * self.wave_speed)) for kappa in kappas]
            Q = _real_span(np.hstack(responses))
            stiffness = self._stiffness((subsystem.shapes @ Q).T)
            terms = np.stack([Q, subsystem.inertia @ Q, subsystem.gyroscopic @ Q, subsystem.transport @ Q])
            bases.append(ReducedBasis(subsystem, static, Q, terms, Q.T @ terms, stiffness))
        return bases


@dataclass(frozen=True, eq=False)
class ReducedBasis:
    """A few directions that span the responses of one `InPlaneSubsystem`.

    Parameters
    ----------
    subsystem : InPlaneSubsystem
        The full equations.
    static : ndarray of complex, shape (J + 1, N)
        Static responses to the edge loads f_cj - i f_sj, j = 0 to J.
    directions : ndarray, shape (N, R)
        Orthonormal columns Q, in the subsystem's energy coordinates.
    terms : ndarray, shape (4, N, R)
        The terms of eq. (8) applied to Q: K_ie = I, M_i, G_i and K_ig.
    reduced : ndarray, shape (4, R, R)
        Q^T times these.
    stiffness : ndarray, shape (R, n, n)
        F of the stresses of each direction.
    """

    subsystem: InPlaneSubsystem
    static: ComplexArray
    directions: FloatArray
    terms: FloatArray
    reduced: FloatArray
    stiffness: FloatArray

    def solve(self, static: ComplexArray, kappa: float, mach: float, loss: float) -> tuple[NumericArray, float]:
        """Return the weights of the directions by Galerkin's method, and the norm of the residual of eq. (8)."""
        factors = np.array([1 + 1j * loss, -(kappa**2), 1j * kappa * mach, mach**2])
        weights = np.linalg.solve(np.tensordot(factors, self.reduced, axes=1), self.directions.T @ static)
        residual = factors @ (self.terms @ weights) - static
        return weights, float(np.linalg.norm(residual))


def _real_span(vectors: ComplexArray) -> FloatArray:
    """Return an orthonormal basis of the real and imaginary parts of the columns, whatever their lengths."""
    lengths = np.linalg.norm(vectors, axis=0)
    unit = vectors[:, lengths > 0] / lengths[lengths > 0]
    U, singular, _ = np.linalg.svd(np.hstack([unit.real, unit.imag]), full_matrices=False)
    return U[:, singular > BASIS_RANK_TOLERANCE * singular[0]]
