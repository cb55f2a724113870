"""`MovingBeam`: an axially moving tensioned beam or string with pulsating speed and tension."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from beam import matrices
from periodic import PeriodicSystem, Term, waveforms
from periodic.checks import FloatArray, one_of, real_number, whole_number

BEAM_DERIVATIVES = ("partial", "material", "strong")
# Most sines: far more than a study needs, few enough that a slip does not fill the memory.
MAX_BEAM_TERMS = 400
# Largest parameter and largest frequency, dimensionless: products of them are still floats.
MAX_BEAM_PARAMETER = 1e30
MAX_BEAM_FREQUENCY = 1e100


@dataclass(frozen=True)
class MovingBeam:
    """An axially moving beam under tension, pinned at x = 0 and x = 1; at zero rigidity a string.

    w_tt + 2 v w_xt + v' w_x + (v^2 - T) w_xx + vf^2 (1 + alpha d/dt) w_xxxx + delta w_t = 0 with

        v = speed (1 + eps speed_amplitude cos Omega t)      T = 1 + eps tension_amplitude cos Omega t

    All quantities are dimensionless: lengths in the span L, time in L sqrt(rho A / P), speeds in sqrt(P / (rho A)), P
    being the mean tension, rho A the mass per length.

    Parameters
    ----------
    speed : float
        Mean transport speed, below `critical_speed`; a negative one moves towards -x. During a part of each period the
        beam may be faster.
    flexural_rigidity : float
        vf^2 = E I / (P L^2) >= 0; 0 is the string.
    damping : float
        Kelvin–Voigt alpha >= 0, the viscosity of the material divided by its modulus, in the unit of time.
    terms : int
        n, sines along x.
    speed_amplitude : float
        Amplitude of the speed's pulsation for eps = 1, divided by the mean speed.
    tension_amplitude : float
        Amplitude of the tension's pulsation for eps = 1, divided by the mean tension.
    derivative : {"partial", "material", "strong"}
        Whose rate of strain the damping opposes. "partial": d/dt at a place, as in the paper's eq. (1). "material":
        d/dt + v d/dx of a particle, which adds alpha vf^2 v (w_xxx, phi_xx) to the stiffness, skew. "strong": the same
        derivative in Galerkin's method on the differential equation, alpha vf^2 v (w_xxxxx, phi), not skew. Sines
        leave a moment at the supports there, which "material" holds at zero on the average.
    viscous_damping : float
        delta >= 0, drag of the surroundings for each mass and speed at a place; the one damping that a string has.
    tension_held_at : float, optional
        Place x0 from 0 to 1 where the tension is T. The tension elsewhere, T + v' (x - x0), accelerates the beam along
        x. If left out, it is T everywhere.

    Raises
    ------
    ValueError
        If a parameter is out of range, the speed reaches the divergence speed, or damping is given to a string.

    Notes
    -----
    Without damping the system is Hamiltonian, whatever speed and tension do: the skew term v' of the stiffness, which
    grows with Omega, belongs to it. The frequencies of a string are multiples of one: see docs/beam.md before you
    trust a truncated one.

    Sources: J. A. Wickert, C. D. Mote, J. Appl. Mech. 57 (1990) 738 (constant speed); H. R. Öz, M. Pakdemirli, J. Sound
    Vib. 227 (1999) 239, and L.-Q. Chen, X.-D. Yang, J. Sound Vib. 284 (2005) 879 (pulsating speed); E. M.
    Mockensturm, J. Guo, J. Appl. Mech. 72 (2005) 374 (material derivative).
    """

    speed: float
    flexural_rigidity: float
    damping: float = 0.0
    terms: int = 4
    speed_amplitude: float = 1.0
    tension_amplitude: float = 0.0
    derivative: str = "partial"
    viscous_damping: float = field(default=0.0, kw_only=True)
    tension_held_at: float | None = field(default=None, kw_only=True)

    def __post_init__(self) -> None:
        for name in ("speed", "speed_amplitude", "tension_amplitude"):
            object.__setattr__(self, name, _parameter(name, getattr(self, name)))
        for name in ("flexural_rigidity", "damping", "viscous_damping"):
            object.__setattr__(self, name, _parameter(name, getattr(self, name), nonnegative=True))
        object.__setattr__(self, "terms", whole_number("terms", self.terms, least=1, most=MAX_BEAM_TERMS))
        one_of("derivative", self.derivative, BEAM_DERIVATIVES)
        if self.tension_held_at is not None:
            place = real_number("tension_held_at", self.tension_held_at)
            if not 0 <= place <= 1:
                raise ValueError(f"tension_held_at = {place!r} is out of range; give a place from 0 to 1, or None")
            object.__setattr__(self, "tension_held_at", place)
        if self.damping and not self.flexural_rigidity:
            raise ValueError(
                f"damping = {self.damping!r} acts through bending, and a string of flexural_rigidity = 0 does not "
                "resist bending; give viscous_damping, or a rigidity"
            )
        if abs(self.speed) >= self.critical_speed():
            raise ValueError(
                f"speed = {self.speed!r} is not below the divergence speed {self.critical_speed():.10g}, from which on "
                "the beam diverges without excitation; give a lower speed or more flexural_rigidity"
            )

    def critical_speed(self) -> float:
        """Return the divergence speed sqrt(1 + pi^2 vf^2), at which the stiffness of the undamped beam is singular.

        It is exact, whatever ``terms`` says; ``speed`` does not enter.
        """
        return math.sqrt(1 + math.pi**2 * self.flexural_rigidity)

    def at(self, Omega: float) -> PeriodicSystem:
        """Return the system at excitation frequency ``Omega`` (`periodic.SystemFamily`).

        It depends on ``Omega`` if the speed pulsates, through v'.

        Parameters
        ----------
        Omega : float
            Excitation frequency >= 0, dimensionless.

        Returns
        -------
        PeriodicSystem
            ``terms`` coordinates, one harmonic, and, if the speed pulsates, further terms with eps and eps^2.

        Raises
        ------
        ValueError
            If ``Omega`` is negative, above 1e100 or no number.
        """
        Omega = real_number("Omega", Omega, nonnegative=True)
        if Omega > MAX_BEAM_FREQUENCY:
            raise ValueError(f"Omega = {Omega!r} is no beam's; give at most {MAX_BEAM_FREQUENCY:g}")
        return self._system_at(Omega) if self._speed_change else self._system

    @cached_property
    def _system(self) -> PeriodicSystem:
        return self._system_at(0.0)

    def _system_at(self, Omega: float) -> PeriodicSystem:
        n, v = self.terms, self.speed
        B, S, bending = matrices.transport(n), matrices.tension(n), matrices.bending(n)
        one = np.eye(n)
        return PeriodicSystem(
            mass=one,
            gyroscopic=2 * v * B,
            damping=self.damping * self.flexural_rigidity * bending + self.viscous_damping * one,
            stiffness=(1 - v**2) * S + self.flexural_rigidity * bending + v * self._carried,
            cosine=self.tension_amplitude * S,
            terms=self._speed_terms(Omega, B, S) if self._speed_change else (),
        )

    def _speed_terms(self, Omega: float, B: FloatArray, S: FloatArray) -> list[Term]:
        """Return what eps v1 cos Omega t, added to the speed v0, adds to the system."""
        v0, v1 = self.speed, self._speed_change
        acceleration = (
            B if self.tension_held_at is None else B + matrices.inertial_tension(len(B), self.tension_held_at)
        )
        return [
            Term("gyroscopic", 2 * v1 * B, waveforms.cosine()),
            Term("stiffness", v1 * self._carried - 2 * v0 * v1 * S, waveforms.cosine()),
            Term("stiffness", -Omega * v1 * acceleration, waveforms.sine()),  # v' = - eps v1 Omega sin Omega t
            # - v^2 S has - eps^2 v1^2 cos^2 Omega t S
            Term("stiffness", -(v1**2) / 2 * S, waveforms.constant(), power=2),
            Term("stiffness", -(v1**2) / 2 * S, waveforms.cosine(2), power=2),
        ]

    @property
    def _speed_change(self) -> float:
        """v1, the amplitude of the speed for eps = 1."""
        return self.speed * self.speed_amplitude

    @cached_property
    def _carried(self) -> FloatArray:
        """The stiffness for each speed that the material derivative adds to the damping."""
        match self.derivative:
            case "material":
                W = matrices.carried_bending(self.terms)
            case "strong":
                W = matrices.carried_bending_strong(self.terms)
            case _:
                return np.zeros((self.terms, self.terms))
        return self.damping * self.flexural_rigidity * W


def _parameter(name: str, value: float, nonnegative: bool = False) -> float:
    number = real_number(name, value, nonnegative=nonnegative)
    if abs(number) > MAX_BEAM_PARAMETER:
        raise ValueError(f"{name} = {number!r} is no beam's; give at most {MAX_BEAM_PARAMETER:g}")
    return number
