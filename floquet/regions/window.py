"""The part of the (Omega, eps) plane that is traced, the system in it, and the grid that is laid over it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from floquet.boundary import MIN_RELATIVE_FREQUENCY, Modes, Resonance, natural_modes, open_types, resonances
from periodic import PeriodicSystem, SystemFamily, member_at
from periodic.checks import FloatArray

# Spans between the columns before any refinement. What is narrower passes between two columns.
BASE_SPANS = 128
# Amplitudes of a column inside the window. Edges are interpolated between two of them.
AMPLITUDES_IN_WINDOW = 80
# Amplitudes of a column below the window. They lead down to the resonances at eps = 0.
AMPLITUDES_BELOW_WINDOW = 64
# Resonances are looked for up to this part of the width of the window to its left and to its right.
RESONANCE_MARGIN = 0.2


@dataclass(frozen=True, eq=False)
class Window:
    """A family of systems over a range of Omega and of eps.

    Attributes
    ----------
    family : PeriodicSystem or SystemFamily
    Omega_range, eps_range : (float, float)
    tolerance : float
        Largest distance of an outline from the true edge, as part of the width and of the height of the window.
    n_jobs : int or None
        Workers.
    spans : int
        Spans between the columns before any refinement.
    """

    family: SystemFamily
    Omega_range: tuple[float, float]
    eps_range: tuple[float, float]
    tolerance: float = 1e-3
    n_jobs: int | None = 1
    spans: int = BASE_SPANS

    @property
    def width(self) -> float:
        """Width in Omega."""
        return self.Omega_range[1] - self.Omega_range[0]

    @property
    def height(self) -> float:
        """Height in eps."""
        return self.eps_range[1] - self.eps_range[0]

    @property
    def spacing(self) -> float:
        """Distance in Omega between two columns before any refinement."""
        return self.width / self.spans

    @property
    def resolution(self) -> float:
        """The tolerance in Omega."""
        return self.tolerance * self.width

    @cached_property
    def amplitudes(self) -> FloatArray:
        """The amplitudes of a column, shape (k,), from eps = 0 upwards: a resonance is known where it starts."""
        bottom, top = self.eps_range
        below = np.linspace(0.0, bottom, AMPLITUDES_BELOW_WINDOW, endpoint=False) if bottom > 0 else np.empty(0)
        return np.concatenate([below, np.linspace(bottom, top, AMPLITUDES_IN_WINDOW)])

    @cached_property
    def member(self) -> PeriodicSystem:
        """The system in the middle of the window."""
        return member_at(self.family, sum(self.Omega_range) / 2, "family")

    @cached_property
    def modes(self) -> Modes:
        """Its modes at eps = 0."""
        return natural_modes(self.member, sum(self.Omega_range) / 2)

    @cached_property
    def is_unstable_at_rest(self) -> bool:
        """Whether the system is unstable without excitation."""
        system = self.member
        acceleration = np.linalg.solve(system.mass, np.hstack([system.stiffness, system.gyroscopic + system.damping]))
        free = np.block([[np.zeros_like(system.mass), np.eye(system.size)], [-acceleration]])
        exponents = np.linalg.eigvals(free)
        return bool(exponents.real.max() > MIN_RELATIVE_FREQUENCY * np.abs(exponents).max())

    @cached_property
    def resonances(self) -> list[Resonance]:
        """The resonances that may open a region in the window or beside it, by increasing order and frequency."""
        margin = RESONANCE_MARGIN * self.width
        around = (self.Omega_range[0] - margin, self.Omega_range[1] + margin)
        return resonances(self.modes, around, open_types(self.member))

    def covers(self, Omega: float) -> bool:
        """Whether ``Omega`` lies in the window."""
        return self.Omega_range[0] <= Omega <= self.Omega_range[1]
