"""`MovingPlate`: the dimensionless parameters of eq. (12), the matrices of eq. (11), and SI units."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from periodic import PeriodicSystem
from periodic.checks import FloatArray, one_of, real_number, whole_number
from plate import checks, transverse
from plate.divergence import divergence_speed
from plate.dynamic import DynamicStress, warn_of_growth
from plate.inplane import InPlaneFrequencies, InPlaneProblem, StressField, inplane_problem
from plate.loads import EdgeLoad
from plate.si import InSI, SIProperties
from plate.stress import MembraneStress, StaticStress, StressModel
from plate.terms import Terms, chosen_terms

INPLANE_MODELS = ("membrane", "static", "dynamic")


@dataclass(frozen=True)
class MovingPlate(InSI):
    """An axially moving viscoelastic plate under periodic edge tension, sections I and II of the paper.

    Simply supported at x = 0 and x = a, free at y = 0 and y = b, moving along x. All quantities are dimensionless
    (eq. (12)): lengths in b, time in sqrt(rho h b^4 / D), D = E h^3 / (12 (1 - nu^2)). `from_si` takes SI units.

    Parameters
    ----------
    aspect_ratio : float
        r = a/b, between 0.001 and 1000.
    speed : float
        V sqrt(rho h b^2 / D), below the divergence speed; a negative speed moves towards -x.
    tension : float
        f0 b^2 / D, static tension per width averaged over the edge; negative is compression. The excitation is
        eps = f1/f0 times f0, so that tension 0 means no excitation at any eps.
    damping : float
        Kelvin–Voigt c sqrt(D / (rho h b^4)) >= 0.
    poisson_ratio : float
        nu, above -1 and at most 0.5.
    thickness_ratio : float
        h/b, between 0 and 1. It matters only for ``inplane="dynamic"``, through the in-plane stiffness 12 (b/h)^2.
    load : EdgeLoad
        Shape of the tension over the edges and in time; uniform and pulsating as cos(Omega t) by default.
    inplane : {"membrane", "static", "dynamic"}
        How the in-plane stress follows from the edge load: "membrane", N_xx = f(y) and N_yy = N_xy = 0; "static", from
        eq. (8) without inertia and transport; "dynamic", from eq. (8) in full, V^2 K_ig in the static stress included.
    axial_terms : int, optional
        K, sines along x.
    lateral_terms : int, optional
        L + 1, polynomials in y of degree 0 to L. The system has n = axial_terms * lateral_terms coordinates.
    inplane_terms : tuple of two int, optional
        M + 1 and N + 1, functions of x and of y in each of u and v, for "static" and "dynamic"; M + 1 >= a/b.
        Numbers left out follow the aspect ratio (`plate.terms`): 4, 7 and (9, 9) for a square plate.
    speed_amplitude : float
        Amplitude of the speed's pulsation for eps = 1, divided by ``speed``: V (1 + eps speed_amplitude cos Omega t).
        The in-plane problem of "dynamic" takes the mean speed.
    load_amplitude : float
        Factor of the load's pulsation; 0 is a steady load.
    derivative : {"partial", "material"}
        Whose rate of strain the damping opposes: d/dt at a place, as in the paper's eq. (1), or d/dt + V d/dx of a
        particle, which adds c V a(w_X, phi) to the stiffness, a(w, phi) being the form of K_oe.
    tension_held_at : float, optional
        Place x/b from 0 to r where the tension is that of the load, for a pulsating speed and "membrane". Elsewhere
        N_xx = f + V' (X - X_0), which accelerates the web along x. If left out, N_xx = f everywhere.
    si : SIProperties, optional
        Set by `from_si`; needed only to return to SI units.

    Raises
    ------
    ValueError
        If a parameter is out of range, the static tension buckles the plate, or the speed reaches the divergence speed.

    Warns
    -----
    InPlaneGrowthWarning
        If in-plane modes of eq. (8) grow at this speed, with ``inplane="dynamic"``.
    """

    aspect_ratio: float = 1.0
    speed: float = 3.0
    tension: float = 10.0
    damping: float = 0.0
    poisson_ratio: float = 0.3
    thickness_ratio: float = 0.01
    load: EdgeLoad = field(default_factory=EdgeLoad.uniform)
    inplane: str = "membrane"
    axial_terms: int | None = None
    lateral_terms: int | None = None
    inplane_terms: tuple[int, int] | None = None
    speed_amplitude: float = 0.0
    load_amplitude: float = 1.0
    derivative: str = "partial"
    tension_held_at: float | None = field(default=None, kw_only=True)
    si: SIProperties | None = field(default=None, kw_only=True, repr=False)

    def __post_init__(self) -> None:
        checked = {
            "aspect_ratio": checks.ratio("aspect_ratio", self.aspect_ratio, checks.ASPECT_RATIO_LIMITS),
            "speed": real_number("speed", self.speed),
            "tension": real_number("tension", self.tension),
            "damping": real_number("damping", self.damping, nonnegative=True),
            "poisson_ratio": checks.poisson_ratio(self.poisson_ratio),
            "thickness_ratio": checks.ratio("thickness_ratio", self.thickness_ratio, checks.THICKNESS_RATIO_LIMITS),
            "inplane": one_of("inplane", self.inplane, INPLANE_MODELS),
            "speed_amplitude": real_number("speed_amplitude", self.speed_amplitude),
            "load_amplitude": real_number("load_amplitude", self.load_amplitude),
            "derivative": one_of("derivative", self.derivative, transverse.PLATE_DERIVATIVES),
            "tension_held_at": checks.held_at(self.tension_held_at, self.aspect_ratio, self.inplane),
        }
        for name, value in checked.items():
            object.__setattr__(self, name, value)
        real_number("tension * load_amplitude", self.tension * self.load_amplitude)
        real_number("(speed * speed_amplitude)^2", self._speed_change * self._speed_change)
        along = self.terms.inplane[0]
        if self.inplane != "membrane" and along < self.aspect_ratio:
            raise ValueError(
                f"inplane_terms[0] = {along} cannot resolve the stress at the ends of a plate of "
                f"aspect_ratio = {self.aspect_ratio!r}; give a number above it, or inplane='membrane'"
            )
        if not isinstance(self.load, EdgeLoad):
            raise ValueError(f"load = {self.load!r} is no EdgeLoad; give one, such as EdgeLoad.uniform()")
        if self.si is not None and not isinstance(self.si, SIProperties):
            raise ValueError(f"si = {self.si!r} is no SIProperties; leave it out, or use MovingPlate.from_si")
        if abs(self.speed) >= self.critical_speed():
            raise ValueError(
                f"speed = {self.speed!r} is not below the divergence speed {self.critical_speed():.10g}, from which on "
                "the plate diverges without excitation (K_o is not positive definite); lower speed or raise tension"
            )
        if self.inplane == "dynamic":
            warn_of_growth(self._inplane_problem, self._wave_speed, self.speed, self.damping)

    @classmethod
    def from_si(
        cls,
        *,
        length: float,
        width: float,
        thickness: float,
        density: float,
        youngs_modulus: float,
        poisson_ratio: float,
        speed: float,
        tension: float,
        damping: float = 0.0,
        **discretisation: Any,
    ) -> MovingPlate:
        """Return the plate with these SI properties; its ``*_unit`` properties lead back.

        Parameters
        ----------
        length, width, thickness : float
            a, b and h in m.
        density : float
            rho in kg/m^3.
        youngs_modulus : float
            E in Pa.
        poisson_ratio : float
            nu.
        speed : float
            V in m/s.
        tension : float
            Static edge tension per width f0 in N/m, averaged over the edge.
        damping : float
            Kelvin–Voigt c of eq. (1) in s.
        **discretisation
            load, inplane, speed_amplitude, axial_terms and so on, all dimensionless, as `MovingPlate` takes them.

        Raises
        ------
        ValueError
            If a property is out of range, or as `MovingPlate`.
        """
        si = SIProperties(width, density, youngs_modulus)
        thickness_ratio = real_number("thickness", thickness, positive=True) / si.width
        nu = checks.poisson_ratio(poisson_ratio)
        time, force_per_width = si.units(thickness_ratio, nu)
        return cls(
            aspect_ratio=real_number("length", length, positive=True) / si.width,
            speed=real_number("speed", speed) * time / si.width,
            tension=real_number("tension", tension) / force_per_width,
            damping=real_number("damping", damping, nonnegative=True) / time,
            poisson_ratio=nu,
            thickness_ratio=thickness_ratio,
            si=si,
            **discretisation,
        )

    @cached_property
    def terms(self) -> Terms:
        """Numbers of trial functions in use: those given, and those of the aspect ratio in place of None."""
        return chosen_terms(self.axial_terms, self.lateral_terms, self.inplane_terms, self.aspect_ratio)

    @cached_property
    def elastic_stiffness(self) -> FloatArray:
        """K_oe of eq. (11), shape (n, n): bending stiffness, and the shape of the Kelvin–Voigt damping c K_oe."""
        return _read_only(transverse.elastic_stiffness(*self._terms, self.aspect_ratio, self.poisson_ratio))

    @cached_property
    def transport_stiffness(self) -> FloatArray:
        """K_og of eq. (11), shape (n, n): V^2 K_og is the stiffness lost to the centripetal acceleration."""
        return _read_only(transverse.transport_stiffness(*self._terms, self.aspect_ratio))

    @cached_property
    def static_stress_stiffness(self) -> FloatArray:
        """F_c0 of eq. (11), shape (n, n): f0 F_c0 is the stiffness given by the static stress."""
        return _read_only(self._stress.static_stiffness(self.speed))

    def critical_speed(self) -> float:
        """Return the divergence speed V_cr, dimensionless.

        The smallest V with K_oe + V^2 K_og + f0 F_c0 singular; ``speed`` does not enter.

        Raises
        ------
        ValueError
            If the static tension buckles the plate at rest.
        """
        return self._critical_speed

    def inplane_frequencies(self) -> InPlaneFrequencies:
        """Return the natural frequencies of in-plane vibration at the plate's speed, undamped, dimensionless.

        Those of the discretised problem (8), whatever ``inplane`` says; the lowest half or so are accurate. The rigid
        translation along x, of frequency 0, is left out.
        """
        mach, subsystems = self.speed / self._wave_speed, self._inplane_problem.subsystems
        return InPlaneFrequencies(*(_read_only(self._wave_speed * part.frequencies_at(mach)) for part in subsystems))

    def at(self, Omega: float) -> PeriodicSystem:
        """Return the system (11) at excitation frequency ``Omega`` (`periodic.SystemFamily`).

        It depends on ``Omega`` with ``inplane="dynamic"``, through the stress, and if the speed pulsates, through V'.

        Parameters
        ----------
        Omega : float
            Excitation frequency >= 0, dimensionless.

        Returns
        -------
        PeriodicSystem
            n = ``terms.coordinates`` coordinates, the load's J harmonics, and further terms if the speed pulsates.

        Raises
        ------
        ValueError
            If ``Omega`` is negative, above 1e100 or no number.

        Warns
        -----
        InPlaneResonanceWarning
            If a harmonic comes near an in-plane resonance.
        """
        Omega = checks.frequency("Omega", Omega)
        steady = self._at_mean_speed(Omega) if self.inplane == "dynamic" else self._steady
        return self._pulsating(steady, Omega) if self._speed_change else steady

    def stress(
        self, Omega: float, harmonic: int, x: ArrayLike | None = None, y: ArrayLike | None = None
    ) -> StressField:
        """Return the in-plane stress of one harmonic on a grid, eqs. (3) and (8), to look at and to judge by.

        Of "static" it is the exact solution, to about 1e-9 of the load, whatever ``inplane_terms`` says; of "dynamic"
        the same and, by eq. (8), what in-plane inertia adds. The matrices F of `at` are those of the trial space (6);
        they converge to the integrals of this stress as ``inplane_terms`` grow.

        On the edges x = 0, a it is what the edges impose. N_xy is infinite where the load jumps there; a large number
        stands for it. At a corner with N_xx = f, N_yy and N_xy are 0 as on the free edge.

        Parameters
        ----------
        Omega : float
            Excitation frequency >= 0, dimensionless; it counts for harmonics of "dynamic" and with ``tension_held_at``.
        harmonic : int
            j from 0 (the static stress, f0 included) to J (the amplitude for eps = 1).
        x, y : array_like, optional
            Places x/b from 0 to r and y/b from 0 to 1, increasing; 41 equally spaced ones each by default.

        Returns
        -------
        StressField
            Multiples of ``tension_unit``, as f0 is.

        Raises
        ------
        ValueError
            If an argument is out of range.
        """
        Omega = checks.frequency("Omega", Omega)
        harmonic = whole_number("harmonic", harmonic, least=0, most=self.load.harmonics)
        X, Y = checks.places("x", x, self.aspect_ratio), checks.places("y", y, 1.0)
        stresses = self._stress.field(harmonic, Omega, X, Y)
        amplitude = self.tension * self.load_amplitude if harmonic else self.tension
        N_xx, N_yy, N_xy = (amplitude * N.T for N in stresses)
        if harmonic == 1 and self.tension_held_at is not None:
            N_xx += 1j * Omega * self._speed_change * (X - self.tension_held_at)  # V' (X - X_0)
        return StressField(X, Y, *(_read_only(N) for N in (N_xx, N_yy, N_xy)))

    @cached_property
    def _steady(self) -> PeriodicSystem:
        return self._at_mean_speed(0.0)

    def _at_mean_speed(self, Omega: float) -> PeriodicSystem:
        F = np.empty((self.load.harmonics, *self._stiffness.shape), dtype=np.complex128)
        for j in range(1, self.load.harmonics + 1):
            F[j - 1] = self.tension * self.load_amplitude * self._stress.stiffness(j, Omega)
        return PeriodicSystem(
            mass=np.eye(self.terms.coordinates),
            gyroscopic=self.speed * self._gyroscopic,
            damping=self.damping * self.elastic_stiffness,
            stiffness=self._stiffness,
            cosine=F.real,
            sine=-F.imag,
        )

    def _pulsating(self, steady: PeriodicSystem, Omega: float) -> PeriodicSystem:
        G, K_og, A = self._gyroscopic, self.transport_stiffness, self._acceleration
        terms = transverse.speed_terms(Omega, self.speed, self._speed_change, G, K_og, A, self._carried)
        M, C, K = steady.mass, steady.damping, steady.stiffness
        return PeriodicSystem(M, steady.gyroscopic, C, K, steady.cosine, steady.sine, terms=terms)

    @cached_property
    def _acceleration(self) -> FloatArray:
        return transverse.acceleration_stiffness(*self._terms, self.aspect_ratio, self.tension_held_at)

    @property
    def _speed_change(self) -> float:
        """V_1, the amplitude of the speed for eps = 1."""
        return self.speed * self.speed_amplitude

    @cached_property
    def _carried(self) -> FloatArray:
        """The stiffness for each speed that the material derivative adds to the damping."""
        if self.derivative == "partial":
            return np.zeros_like(self.elastic_stiffness)
        return self.damping * transverse.carried_bending(*self._terms, self.aspect_ratio, self.poisson_ratio)

    @cached_property
    def _gyroscopic(self) -> FloatArray:
        return transverse.gyroscopic(*self._terms, self.aspect_ratio)

    @cached_property
    def _stiffness(self) -> FloatArray:
        K_oe, K_og, F_c0 = self.elastic_stiffness, self.transport_stiffness, self.static_stress_stiffness
        K = K_oe + self.speed**2 * K_og + self.tension * F_c0
        return K if self.derivative == "partial" else K + self.speed * self._carried

    @cached_property
    def _critical_speed(self) -> float:
        fastest = math.inf
        if self.inplane == "dynamic":
            fastest = self._wave_speed * min(1.0, self._inplane_problem.divergence_speed)
        speed = divergence_speed(
            self.elastic_stiffness, self.transport_stiffness, self._stress.static_stiffness, self.tension, fastest
        )
        if math.isinf(speed):
            raise ValueError(
                f"thickness_ratio = {self.thickness_ratio!r} is too large for tension = {self.tension!r}: the plate "
                f"diverges in its own plane first, at speed {fastest:.6g}; give a thinner plate or less tension"
            )
        return speed

    @cached_property
    def _inplane_problem(self) -> InPlaneProblem:
        return inplane_problem(self.aspect_ratio, self.poisson_ratio, *self.terms.inplane)

    @cached_property
    def _stress(self) -> StressModel:
        match self.inplane:
            case "membrane":
                return MembraneStress(self.load, self.aspect_ratio, *self._terms)
            case "static":
                return StaticStress(self.load, self._inplane_problem, *self._terms)
            case _:
                return DynamicStress(
                    self.load, self._inplane_problem, *self._terms, self._wave_speed, self.speed, self.damping
                )

    @property
    def _wave_speed(self) -> float:
        """C = sqrt(beta) = sqrt(12) b/h, the speed of in-plane stretching waves at nu = 0."""
        return math.sqrt(12) / self.thickness_ratio

    @property
    def _terms(self) -> tuple[int, int]:
        return self.terms.axial, self.terms.lateral


def _read_only(array: NDArray[Any]) -> NDArray[Any]:
    array.setflags(write=False)
    return array
