"""`MovingBeam`: an axially moving tensioned beam or string with pulsating speed and tension."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from beam import matrices
from beam.section import Section
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

    That is the slender beam (Euler, Bernoulli). With ``shear_rigidity`` or ``rotary_inertia`` the cross sections turn
    by an angle psi of their own (Timoshenko), d_t being d/dt + v d/dx:

        d_t d_t w - T w_xx - s (1 + alpha d/dt) (w_x - psi)_x + delta w_t = 0
        r^2 d_t d_t psi - vf^2 (1 + alpha d/dt) psi_xx - s (1 + alpha d/dt) (w_x - psi) = 0

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
        n, sines along x. A Timoshenko beam has n + 1 cosines for the angle besides.
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
    shear_rigidity : float, optional
        s = k G A / P > 0, the resistance to shear (k: factor of the cross section's shape). If left out, sections stay
        at right angles to the axis.
    rotary_inertia : float
        r^2 = I / (A L^2) >= 0, the radius of gyration of the cross section over the span, squared. At 0 the angle of a
        section follows the deflection without delay.
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
    grows with Omega, belongs to it. Sections carry angular momentum through the supports; the equations are the weak
    form, in which the moment there meets that flow in the mean. The frequencies of a string are multiples of one: see
    docs/beam.md before you trust a truncated one.

    Sources: J. A. Wickert, C. D. Mote, J. Appl. Mech. 57 (1990) 738 (constant speed); H. R. Öz, M. Pakdemirli, J. Sound
    Vib. 227 (1999) 239, and L.-Q. Chen, X.-D. Yang, J. Sound Vib. 284 (2005) 879 (pulsating speed); E. M.
    Mockensturm, J. Guo, J. Appl. Mech. 72 (2005) 374 (material derivative); S. P. Timoshenko, Phil. Mag. 41 (1921) 744
    (shear and rotary inertia).
    """

    speed: float
    flexural_rigidity: float
    damping: float = 0.0
    terms: int = 4
    speed_amplitude: float = 1.0
    tension_amplitude: float = 0.0
    derivative: str = "partial"
    viscous_damping: float = field(default=0.0, kw_only=True)
    shear_rigidity: float | None = field(default=None, kw_only=True)
    rotary_inertia: float = field(default=0.0, kw_only=True)
    tension_held_at: float | None = field(default=None, kw_only=True)

    def __post_init__(self) -> None:
        for name in ("speed", "speed_amplitude", "tension_amplitude"):
            object.__setattr__(self, name, _parameter(name, getattr(self, name)))
        for name in ("flexural_rigidity", "damping", "viscous_damping", "rotary_inertia"):
            object.__setattr__(self, name, _parameter(name, getattr(self, name), nonnegative=True))
        if self.shear_rigidity is not None:
            object.__setattr__(self, "shear_rigidity", _parameter("shear_rigidity", self.shear_rigidity, positive=True))
        object.__setattr__(self, "terms", whole_number("terms", self.terms, least=1, most=MAX_BEAM_TERMS))
        one_of("derivative", self.derivative, BEAM_DERIVATIVES)
        if self.tension_held_at is not None:
            place = real_number("tension_held_at", self.tension_held_at)
            if not 0 <= place <= 1:
                raise ValueError(f"tension_held_at = {place!r} is out of range; give a place from 0 to 1, or None")
            object.__setattr__(self, "tension_held_at", place)
        for name in ("shear_rigidity", "rotary_inertia"):
            if getattr(self, name) and not self.flexural_rigidity:
                raise ValueError(
                    f"{name} = {getattr(self, name)!r} belongs to cross sections that turn, and a string of "
                    "flexural_rigidity = 0 has none; leave it out, or give a rigidity"
                )
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
        """Return the divergence speed, at which the stiffness of the undamped beam is singular.

        It is exact, whatever ``terms`` says; ``speed`` does not enter. A slender beam diverges as sin pi x at
        sqrt(1 + pi^2 vf^2). One whose sections have more inertia than stiffness does so in the shortest waves, which is
        the other limit taken.
        """
        return math.sqrt(min(self._divergence(1.0), self._divergence(0.0)))

    def _divergence(self, part: float) -> float:
        """Return v^2 at which a wave of length 2 / k diverges, ``part`` being 1 / k^2.

        (1 - v^2) (vf^2 - r^2 v^2 + s / q^2) + s (vf^2 - r^2 v^2) = 0 with q = k pi, divided by s.
        """
        a, r, e, f = part / math.pi**2, self.rotary_inertia, self.flexural_rigidity, self._shear_flexibility
        # c2 x^2 - c1 x + c0 = 0: both roots are positive, and the smaller one is the first
        c2, c1, c0 = f * r, f * (r + e) + a + r, (1 + f) * e + a
        return 2 * c0 / (c1 + math.sqrt(max(c1**2 - 4 * c2 * c0, 0.0))) if c1 else math.inf

    @property
    def _shear_flexibility(self) -> float:
        """1 / s."""
        return 0.0 if self.shear_rigidity is None else 1 / self.shear_rigidity

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
        section, v = self._section, self.speed
        elastic, drag = self._elastic, self.viscous_damping * section.deflected(np.eye(self.terms))
        return PeriodicSystem(
            mass=section.inertia(),
            gyroscopic=v * section.gyroscopic(),
            damping=self.damping * elastic + drag,
            stiffness=self._tension - v**2 * section.centrifugal() + elastic + v * self._carried,
            cosine=self.tension_amplitude * self._tension,
            terms=self._speed_terms(Omega) if self._speed_change else (),
        )

    def _speed_terms(self, Omega: float) -> list[Term]:
        """Return what eps v1 cos Omega t, added to the speed v0, adds to the system."""
        v0, v1, section = self.speed, self._speed_change, self._section
        S = section.centrifugal()
        acceleration = section.acceleration()
        if self.tension_held_at is not None:
            acceleration = acceleration + section.deflected(matrices.inertial_tension(self.terms, self.tension_held_at))
        return [
            Term("gyroscopic", v1 * section.gyroscopic(), waveforms.cosine()),
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
    def _section(self) -> Section:
        return Section(self.terms, self.flexural_rigidity, self._shear_flexibility, self.rotary_inertia)

    @cached_property
    def _tension(self) -> FloatArray:
        return self._section.deflected(matrices.tension(self.terms))

    @cached_property
    def _elastic(self) -> FloatArray:
        """The stiffness of bending and shear."""
        return self._section.strained(matrices.curvature(self.terms), np.eye(self.terms + 1))

    @cached_property
    def _carried(self) -> FloatArray:
        """The stiffness for each speed that the material derivative adds to the damping."""
        if self.derivative == "partial":
            return np.zeros_like(self._elastic)
        weak = self.derivative == "material"
        carried = matrices.carried_curvature if weak else matrices.carried_curvature_strong
        return self.damping * self._section.strained(carried(self.terms), matrices.rotation_transport(self.terms))


def _parameter(name: str, value: float, nonnegative: bool = False, positive: bool = False) -> float:
    number = real_number(name, value, nonnegative=nonnegative, positive=positive)
    if abs(number) > MAX_BEAM_PARAMETER:
        raise ValueError(f"{name} = {number!r} is no beam's; give at most {MAX_BEAM_PARAMETER:g}")
    return number
