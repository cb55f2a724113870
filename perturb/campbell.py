"""Resonances of a family whose modes depend on Omega: where its Campbell diagram meets the lines j Omega.

The frequencies omega_n(Omega) of the members are followed through the range, and j Omega = omega_p ± omega_q is solved
for Omega. There may be no solution, one or several; one at which the two sides touch is found as well.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from periodic import PeriodicSystem, SystemFamily, member_at
from periodic.checks import ComplexArray, FloatArray
from perturb.expansion import DERIVATIVE_STEP
from perturb.modes import GyroscopicModes, gyroscopic_modes
from perturb.resonance import Resonance

# The range is divided until frequencies halfway between two points are where those points say they are, to this part
# of the highest one; a cubic through both points and slopes then shows every crossing.
INTERPOLATION_ERROR = 1e-4
FIRST_POINTS = 17
MAX_POINTS = 1025

# Two sides that come this close, as a part of Omega, and turn away again touch.
TOUCHING = 1e-9


@dataclass(frozen=True, eq=False)
class CampbellPoint:
    """Frequencies of the member at Omega, shape (n,), and their derivatives."""

    Omega: float
    frequencies: FloatArray
    slopes: FloatArray


def campbell_resonances(
    family: SystemFamily, multiples: Sequence[int], Omega_range: tuple[float, float], types: Sequence[str]
) -> list[Resonance]:
    """Return all resonances with centre in the range, by increasing centre; one for each solution.

    Parameters
    ----------
    family : SystemFamily
        With symmetric positive definite stiffness throughout the range.
    multiples : sequence of int
        The j.
    Omega_range : (low, high)
    types : sequence of {"sum", "difference"}

    Raises
    ------
    ValueError
        If a member of the range has no modes (`gyroscopic_modes`), or its frequencies change too fast to be followed.
    """
    diagram = campbell_diagram(family, Omega_range)
    Omega = np.array([point.Omega for point in diagram])
    omega, slopes = (np.array([getattr(point, name) for point in diagram]) for name in ("frequencies", "slopes"))
    found = []
    for type in types:
        sign = 1 if type == "sum" else -1
        for p, q in zip(*np.tril_indices(omega.shape[1], 0 if sign > 0 else -1), strict=True):
            for j in multiples:
                gap = _Gap(family, int(p), int(q), j, sign)
                values = j * Omega - omega[:, p] - sign * omega[:, q]
                derivatives = j - slopes[:, p] - sign * slopes[:, q]
                centres = gap.zeros(Omega, values, derivatives)
                found += [Resonance(int(p) + 1, int(q) + 1, j, type, centre) for centre in centres]
    return sorted(found, key=lambda resonance: resonance.centre)


def campbell_diagram(family: SystemFamily, Omega_range: tuple[float, float]) -> list[CampbellPoint]:
    """Return points of the Campbell diagram, close enough together for a cubic through neighbours."""
    low, high = Omega_range
    points = [campbell_point(family, Omega) for Omega in np.linspace(low, high, FIRST_POINTS).tolist()]
    k = 0
    while k < len(points) - 1:
        a, b = points[k], points[k + 1]
        middle = campbell_point(family, 0.5 * (a.Omega + b.Omega))
        guess = 0.5 * (a.frequencies + b.frequencies) + (b.Omega - a.Omega) / 8 * (a.slopes - b.slopes)
        if np.abs(guess - middle.frequencies).max() <= INTERPOLATION_ERROR * middle.frequencies[-1]:
            k += 1
            continue
        points.insert(k + 1, middle)
        if len(points) > MAX_POINTS:
            raise ValueError(
                f"family has frequencies that change too fast with Omega near {middle.Omega:.6g}; give a narrower "
                "Omega_range"
            )
    return points


def campbell_point(family: SystemFamily, Omega: float) -> CampbellPoint:
    """Return the frequencies of the member at Omega and their derivatives."""
    modes = gyroscopic_modes(member_at(family, Omega, "family"))
    low, high = Omega * (1 - DERIVATIVE_STEP), Omega * (1 + DERIVATIVE_STEP) or DERIVATIVE_STEP
    slopes = frequency_slopes(modes, member_at(family, low, "family"), member_at(family, high, "family"), high - low)
    return CampbellPoint(Omega, modes.frequencies, slopes)


def frequency_slopes(
    modes: GyroscopicModes, below: PeriodicSystem, above: PeriodicSystem, distance: float
) -> FloatArray:
    """Return d omega_n / d Omega, shape (n,), from the members at two frequencies, ``distance`` apart."""
    w, omega = modes.vectors, modes.frequencies

    def form(name: str) -> ComplexArray:
        change = (getattr(above, name) - getattr(below, name)) / distance
        return (w.conj() * (change @ w)).sum(axis=0)

    # w^H (- omega^2 M + i omega G + K) w = 0, and w^H (omega^2 M + K) w = 2
    return 0.5 * omega * (-(omega**2) * form("mass") + 1j * omega * form("gyroscopic") + form("stiffness")).real


@dataclass(frozen=True, eq=False)
class _Gap:
    """j Omega - (omega_p ± omega_q) as a function of Omega (p, q from 0)."""

    family: SystemFamily
    p: int
    q: int
    j: int
    sign: int

    def value(self, Omega: float) -> float:
        omega = gyroscopic_modes(member_at(self.family, Omega, "family")).frequencies
        return float(self.j * Omega - omega[self.p] - self.sign * omega[self.q])

    def slope(self, Omega: float) -> float:
        slopes = campbell_point(self.family, Omega).slopes
        return float(self.j - slopes[self.p] - self.sign * slopes[self.q])

    def zeros(self, Omega: FloatArray, values: FloatArray, slopes: FloatArray) -> list[float]:
        """Return all zeros, from values and slopes at the points ``Omega`` of a diagram."""
        found = Omega[values == 0].tolist()
        for k in np.flatnonzero(values[:-1] * values[1:] < 0):
            found.append(self._zero(Omega[k], Omega[k + 1]))
        turns = (values[:-1] * values[1:] > 0) & (values[:-1] * slopes[:-1] < 0) & (values[1:] * slopes[1:] > 0)
        for k in np.flatnonzero(turns):
            found += self._zeros_around_a_turn(Omega[k], Omega[k + 1], values[k])
        return found

    def _zeros_around_a_turn(self, low: float, high: float, value: float) -> list[float]:
        """Return the zeros between two points with values of one sign, between which the gap turns towards zero."""
        turn = float(brentq(self.slope, low, high, xtol=TOUCHING * high))
        nearest = self.value(turn)
        if abs(nearest) <= TOUCHING * turn:
            return [turn]
        return [self._zero(low, turn), self._zero(turn, high)] if nearest * value < 0 else []

    def _zero(self, low: float, high: float) -> float:
        return float(brentq(self.value, low, high, xtol=1e-15 * high, rtol=1e-14))
