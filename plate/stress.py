"""Models of the in-plane stress: "membrane" and "static". The third, "dynamic", is in `plate.dynamic`."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Protocol

import numpy as np

from periodic.checks import ComplexArray, FloatArray
from plate.distribution import Distribution
from plate.inplane import InPlaneProblem
from plate.levy import static_stresses
from plate.loads import EdgeLoad
from plate.transverse import NumericArray, membrane_stiffness


class StressModel(Protocol):
    """What a model of the in-plane stress must provide to `plate.MovingPlate`; all stresses are per unit tension."""

    def static_stiffness(self, speed: float) -> FloatArray:
        """Return F_c0 of eq. (11) at transport speed V, shape (n, n)."""
        ...

    def stiffness(self, harmonic: int, Omega: float) -> ComplexArray:
        """Return F_cj - i F_sj of eq. (11), the amplitude of e^{i j Omega t}, for j >= 1, shape (n, n)."""
        ...

    def field(self, harmonic: int, Omega: float, X: FloatArray, Y: FloatArray) -> ComplexArray:
        """Return the amplitudes of N_xx, N_yy, N_xy, j >= 0, on an increasing grid, shape (3, X.size, Y.size)."""
        ...


@dataclass(frozen=True)
class MembraneStress:
    """N_xx = f(y), N_yy = N_xy = 0: the paper's stress where it neglects in-plane inertia.

    Parameters
    ----------
    load : EdgeLoad
        The edge load.
    r : float
        Aspect ratio.
    K, lateral : int
        Transverse trial functions along x and across y.
    """

    load: EdgeLoad
    r: float
    K: int
    lateral: int

    def static_stiffness(self, speed: float) -> FloatArray:
        """Return F_c0, the same at every speed."""
        return self._stiffness(self.load.static)

    def stiffness(self, harmonic: int, Omega: float) -> ComplexArray:
        """Return F_cj - i F_sj, the same at every Omega."""
        f_c, f_s = self.load.harmonic(harmonic)
        return self._stiffness(f_c) - 1j * self._stiffness(f_s)

    def field(self, harmonic: int, Omega: float, X: FloatArray, Y: FloatArray) -> ComplexArray:
        """Return the stresses, the same at every Omega and X."""
        f_c, f_s = self.load.harmonic(harmonic)
        stresses = np.zeros((3, X.size, Y.size), dtype=np.complex128)
        stresses[0] = f_c(Y) - 1j * f_s(Y)
        return stresses

    def _stiffness(self, load: Distribution) -> FloatArray:
        return membrane_stiffness(load, self.K, self.lateral, self.r)


@dataclass(frozen=True)
class StaticStress:
    """The stress of eq. (8) without inertia and transport: elastic equilibrium at every instant.

    F comes from the trial space (6). Its stress oscillates about the true one beside corners and jumps of the load, but
    the integrals in F converge well. ``field`` is the true stress, from `plate.levy`.

    Kelvin–Voigt damping does not enter: the strains carry the factor 1 / (1 + i w c) and the stresses 1 + i w c.

    Parameters
    ----------
    load : EdgeLoad
        The edge load.
    problem : InPlaneProblem
        The in-plane problem.
    K, lateral : int
        Transverse trial functions along x and across y.
    """

    load: EdgeLoad
    problem: InPlaneProblem
    K: int
    lateral: int

    def static_stiffness(self, speed: float) -> FloatArray:
        """Return F_c0, the same at every speed."""
        return static_amplitude(self, 0).real

    def stiffness(self, harmonic: int, Omega: float) -> ComplexArray:
        """Return F_cj - i F_sj, the same at every Omega."""
        return static_amplitude(self, harmonic)

    def field(self, harmonic: int, Omega: float, X: FloatArray, Y: FloatArray) -> ComplexArray:
        """Return the exact stresses, the same at every Omega."""
        f_c, f_s = self.load.harmonic(harmonic)
        r, nu = self.problem.r, self.problem.nu
        stresses = static_stresses(f_c, r, nu, X, Y).astype(np.complex128)
        if f_s != 0 * f_s:
            stresses -= 1j * static_stresses(f_s, r, nu, X, Y)
        return stresses

    def _stiffness(self, coefficients: NumericArray) -> NumericArray:
        return self.problem.stress_stiffness(coefficients, self.K, self.lateral)

    @cached_property
    def forces(self) -> list[ComplexArray]:
        """Edge forces of f_cj - i f_sj for j = 0 to J, as from `InPlaneProblem.force`."""
        pairs = (self.load.harmonic(j) for j in range(self.load.harmonics + 1))
        return [self.problem.force(f_c) - 1j * self.problem.force(f_s) for f_c, f_s in pairs]


@lru_cache(maxsize=8)
def static_amplitude(model: StaticStress, harmonic: int) -> ComplexArray:
    """Return F_cj - i F_sj of a model, kept because plates that differ in speed or tension alone share it."""
    coefficients = model.problem.static_response(model.forces[harmonic])
    F = model.problem.stress_stiffness(coefficients, model.K, model.lateral)
    F.setflags(write=False)
    return F
