"""Equation (25) as it is printed: with a damping that may vanish, but was there.

    j Omega = omega_p + omega_q ± (eps/2) (c_p + c_q) sqrt(L / (c_p c_q) - alpha^2),    c = eps alpha

At alpha = 0 it does not give the curve of the undamped plate, ± eps sqrt(L): regions of two modes that are damped
unequally are wider by (c_p + c_q) / (2 sqrt(c_p c_q)). It treats every resonance by itself.
"""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

import numpy as np

from compare.claims.convergence import KEPT_PLATES
from periodic.checks import FloatArray
from perturb import Resonance, gyroscopic_modes, transition_curves
from plate import MovingPlate

# Vanishing damping is integrated as damping whose tip lies so many times below eps: a region is then as wide as eq.
# (25) says at c = 0, to a part of 1 / (2 * 30^2).
VANISHING_EPS_OVER_TIP = 30.0


def literal_edges(plate: MovingPlate, resonance: Resonance, eps: float) -> tuple[float, float]:
    """Return the lower and upper edge of a region by eq. (25); NaN where it is closed.

    For a plate without damping those of damping that vanishes.
    """
    slope, tip = _literal(replace(plate, damping=0.0) if plate.damping else plate, resonance)
    excess = eps**2 - (plate.damping * tip) ** 2 if slope else -1.0
    half = slope * float(np.sqrt(excess)) if excess >= 0 else np.nan
    return resonance.centre - half, resonance.centre + half


def slightly_damped(plate: MovingPlate, resonance: Resonance, eps: float) -> MovingPlate:
    """Return the plate with damping whose tip lies far below ``eps``; as it is if that changes nothing."""
    if plate.damping or resonance.p == resonance.q:
        return plate  # damping of one mode alone widens nothing
    slope, tip = _literal(plate, resonance)
    if not slope:
        return plate
    return replace(plate, damping=eps / (VANISHING_EPS_OVER_TIP * tip))


@lru_cache(maxsize=KEPT_PLATES)
def _literal(plate: MovingPlate, resonance: Resonance) -> tuple[float, float]:
    """Return the slope of eq. (25) at c = 0, and the tip at c = 1, of a region of an undamped plate."""
    frequencies, decay = _modes(plate)
    slope = _slopes(plate, resonance.type, 2.001 * float(frequencies[resonance.p - 1]))[resonance[:4]]
    c_p, c_q = decay[resonance.p - 1], decay[resonance.q - 1]
    return slope, float((c_p + c_q) / (2 * slope)) if slope else np.inf


@lru_cache(maxsize=KEPT_PLATES)
def _modes(plate: MovingPlate) -> tuple[FloatArray, FloatArray]:
    """Return frequencies and the decay coefficients of eq. (26a)."""
    modes = gyroscopic_modes(plate.at(0.0))
    return modes.frequencies, modes.decay_coefficients(plate.elastic_stiffness)


@lru_cache(maxsize=KEPT_PLATES)
def _slopes(plate: MovingPlate, type: str, highest: float) -> dict[tuple[int, int, int, str], float]:
    """Return the slopes of eq. (25) at c = 0 by p, q, j and type."""
    curves = transition_curves(plate, (0.0, highest), types=(type,), vanishing_damping=plate.elastic_stiffness)
    return {curve.resonance[:4]: curve.slope for curve in curves}
