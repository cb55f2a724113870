"""How the cross sections of a beam turn: with the axis, as statics demands, or as they please."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from beam import matrices
from periodic.checks import FloatArray


@dataclass(frozen=True)
class Section:
    """The coordinates of a beam, and the matrices of deflection w and angle psi of the sections in them.

    A slender beam has psi = w_x. With shear, but without rotary inertia, the angle is in equilibrium at any time,
    vf^2 psi_xx + s (w_x - psi) = 0. In both cases the coordinates are those of w. With shear and rotary inertia they
    are those of w, then those of psi.

    Parameters
    ----------
    terms : int
        n, functions of w.
    flexural_rigidity : float
        vf^2.
    shear_flexibility : float
        1 / s; 0 if sections stay at right angles to the axis.
    rotary_inertia : float
        r^2.
    """

    terms: int
    flexural_rigidity: float
    shear_flexibility: float
    rotary_inertia: float

    @cached_property
    def _deflection(self) -> FloatArray:
        """w from the coordinates, shape (n, N)."""
        n = self.terms
        return np.eye(n, 2 * n + 1) if self._turns_freely else np.eye(n)

    @cached_property
    def _angle(self) -> FloatArray:
        """Psi from the coordinates, shape (n + 1, N)."""
        n = self.terms
        if self._turns_freely:
            return np.eye(n + 1, 2 * n + 1, n)
        shear = 1 + self.shear_flexibility * self.flexural_rigidity * matrices.wavenumbers(n) ** 2
        return matrices.slope(n) / shear

    @cached_property
    def _shear(self) -> FloatArray:
        """w_x - psi from the coordinates, shape (n + 1, N)."""
        return matrices.slope(self.terms) @ self._deflection - self._angle

    @property
    def _turns_freely(self) -> bool:
        return bool(self.shear_flexibility and self.rotary_inertia)

    def deflected(self, matrix: FloatArray) -> FloatArray:
        """Return a matrix of w (n, n) in the coordinates, shape (N, N)."""
        return self._deflection.T @ matrix @ self._deflection

    def turned(self, matrix: FloatArray) -> FloatArray:
        """Return rotary inertia times a matrix of psi (n + 1, n + 1) in the coordinates, shape (N, N)."""
        return self.rotary_inertia * (self._angle.T @ matrix @ self._angle)

    def strained(self, bending: FloatArray, shearing: FloatArray) -> FloatArray:
        """Return vf^2 times a matrix of psi, plus s times one of w_x - psi, in the coordinates, shape (N, N)."""
        found = self.flexural_rigidity * (self._angle.T @ bending @ self._angle)
        if self.shear_flexibility:
            found += self._shear.T @ shearing @ self._shear / self.shear_flexibility
        return found

    def inertia(self) -> FloatArray:
        """Return the mass."""
        return self.deflected(np.eye(self.terms)) + self.turned(np.eye(self.terms + 1))

    def gyroscopic(self) -> FloatArray:
        """Return what the speed adds to the gyroscopic matrix, for each unit of it."""
        R = matrices.rotation_transport(self.terms)
        return self.deflected(2 * matrices.transport(self.terms)) + self.turned(R - R.T)

    def acceleration(self) -> FloatArray:
        """Return what the rate of the speed adds to the stiffness, for each unit of it."""
        return self.deflected(matrices.transport(self.terms)) + self.turned(matrices.rotation_transport(self.terms))

    def centrifugal(self) -> FloatArray:
        """Return what the square of the speed takes from the stiffness, for each unit of it."""
        return self.deflected(matrices.tension(self.terms)) + self.turned(matrices.curvature(self.terms))
