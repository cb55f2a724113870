"""The window of excitation frequencies and amplitudes that suits a system, where the user names none."""

from __future__ import annotations

from math import floor, log10

import numpy as np

from periodic import PeriodicSystem, stiffness_alone
from periodic.checks import FloatArray

# Number of lowest modes whose main regions a default window shows.
MODES_SHOWN = 3
# A default eps_max changes the stiffness in the softest direction by this part of itself. Where the stiffness is not
# positive (a Paul trap) it changes by the second number, since it has to be overcome before anything is stable.
STIFFNESS_CHANGE, INDEFINITE_STIFFNESS_CHANGE = 0.5, 5.0
# A frequency below this part of the highest one is that of a rigid-body motion: the square root of rounding.
RIGID_FREQUENCY = 1e-6
# The largest entry of a matrix divided by mass, in 1/time^2 or 1/time, whose square is still a float.
MAX_ENTRY = 1e150


def default_window(system: PeriodicSystem) -> tuple[tuple[float, float], float]:
    """Return a window (Omega_range, eps_max) that shows the main regions of a system's lowest modes.

    From half the lowest natural frequency to a tenth above twice the third; eps up to the value that changes the
    stiffness, in the direction in which that is easiest, by about half (five times where it is not positive).

    Raises
    ------
    ValueError
        If the system does not oscillate without excitation, so that it suggests no window, or its numbers are too
        large.
    """
    scale = np.linalg.inv(np.linalg.cholesky(stiffness_alone(system).mass))
    with np.errstate(over="ignore", invalid="ignore"):
        stiffness, velocity = (
            scale @ matrix @ scale.T for matrix in (system.stiffness, system.gyroscopic + system.damping)
        )
    if not max(np.abs(stiffness).max(), np.abs(velocity).max()) < MAX_ENTRY:
        raise ValueError(f"stiffness or damping, divided by mass, is beyond {MAX_ENTRY:g}; change the units")
    n = system.size
    first_order = np.block([[-velocity, -stiffness], [np.eye(n), np.zeros((n, n))]])
    frequencies = np.sort(np.abs(np.linalg.eigvals(first_order)))[::2]  # they come in pairs
    frequencies = frequencies[frequencies > RIGID_FREQUENCY * frequencies[-1]]
    if frequencies.size == 0:
        raise ValueError("the system does not oscillate without excitation; give the window of Omega and eps yourself")
    shown = frequencies[:MODES_SHOWN]
    return (_rounded(0.5 * shown[0]), _rounded(2.2 * shown[-1])), _default_eps(system, scale, stiffness)


def _default_eps(system: PeriodicSystem, scale: FloatArray, stiffness: FloatArray) -> float:
    values, vectors = np.linalg.eigh(0.5 * (stiffness + stiffness.T))
    size = np.abs(values)
    if not size.any():
        return 1.0
    least = size[size > RIGID_FREQUENCY**2 * size.max()].min()  # a fine mesh spans many decades; what is below is rigid
    soft = scale.T @ vectors / np.sqrt(np.maximum(size, least))
    change = max(float(np.linalg.norm(soft.T @ F @ soft, 2)) for F in (*system.cosine, *system.sine))
    wanted = STIFFNESS_CHANGE if values[0] > 0 else INDEFINITE_STIFFNESS_CHANGE
    return _rounded(wanted / change) if change > 0 else 1.0


def _rounded(value: float) -> float:
    """Return ``value`` to two significant digits."""
    return round(float(value), 1 - floor(log10(value)))
