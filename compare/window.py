"""The window of excitation frequencies and amplitudes that suits a system, where the user names none."""

from __future__ import annotations

from math import floor, log10

import numpy as np

from periodic import AnySystem, FirstOrderSystem, PeriodicSystem, Term
from periodic.checks import FloatArray
from periodic.waveforms import Impulses

# Number of lowest modes whose main regions a default window shows.
MODES_SHOWN = 3
# A default eps_max changes the stiffness in the softest direction by this part of itself. Where the stiffness is not
# positive (a Paul trap) it changes by the second number, since it has to be overcome before anything is stable.
STIFFNESS_CHANGE, INDEFINITE_STIFFNESS_CHANGE = 0.5, 5.0
# A frequency below this part of the highest one is that of a rigid-body motion: the square root of rounding.
RIGID_FREQUENCY = 1e-6
# Phases at which a waveform is looked at for its largest value.
WAVEFORM_SAMPLES = 257
# The largest entry of a matrix divided by mass, in 1/time^2 or 1/time, whose square is still a float.
MAX_ENTRY = 1e150


def default_window(system: AnySystem) -> tuple[tuple[float, float], float]:
    """Return a window (Omega_range, eps_max) that shows the main regions of a system's lowest modes.

    From half the lowest natural frequency to a tenth above twice the third; eps up to the value that changes the
    stiffness, in the direction in which that is easiest, by about half (five times where it is not positive). Terms of
    other matrices count by the forces that they exert at the natural frequencies; a system of first order has the
    frequencies of its matrix, and eps changes that by a half.

    Raises
    ------
    ValueError
        If the system does not oscillate without excitation, so that it suggests no window, or its numbers are too
        large.
    """
    if isinstance(system, FirstOrderSystem):
        return _first_order_window(system)
    scale = np.linalg.inv(np.linalg.cholesky(system.mass))
    with np.errstate(over="ignore", invalid="ignore"):
        stiffness, velocity = (
            scale @ matrix @ scale.T for matrix in (system.stiffness, system.gyroscopic + system.damping)
        )
    if not max(np.abs(stiffness).max(), np.abs(velocity).max()) < MAX_ENTRY:
        raise ValueError(f"stiffness or damping, divided by mass, is beyond {MAX_ENTRY:g}; change the units")
    n = system.size
    first_order = np.block([[-velocity, -stiffness], [np.eye(n), np.zeros((n, n))]])
    window = _window(np.sort(np.abs(np.linalg.eigvals(first_order)))[::2])  # they come in pairs
    return window, _default_eps(system, scale, stiffness)


def _window(frequencies: FloatArray) -> tuple[float, float]:
    """Return the window of excitation frequencies, given natural frequencies in ascending order."""
    shown = frequencies[frequencies > RIGID_FREQUENCY * frequencies[-1]][:MODES_SHOWN]
    if shown.size == 0:
        raise ValueError("the system does not oscillate without excitation; give the window of Omega and eps yourself")
    return (_rounded(0.5 * shown[0]), _rounded(2.2 * shown[-1]))


def _first_order_window(system: FirstOrderSystem) -> tuple[tuple[float, float], float]:
    values = np.linalg.eigvals(system.constant)
    turning = np.sort(values.imag[values.imag > 0])
    window = _window(turning if turning.size else np.zeros(1))
    changes = [(float(np.linalg.norm(X, 2)), 1) for X in (*system.cosine, *system.sine)]
    changes += [(_height(term) * float(np.linalg.norm(term.matrix, 2)), term.power) for term in system.terms]
    return window, _eps_that_changes(changes, STIFFNESS_CHANGE * float(np.abs(values).max()))


def _default_eps(system: PeriodicSystem, scale: FloatArray, stiffness: FloatArray) -> float:
    values, vectors = np.linalg.eigh(0.5 * (stiffness + stiffness.T))
    size = np.abs(values)
    if not size.any():
        return 1.0
    least = size[size > RIGID_FREQUENCY**2 * size.max()].min()  # a fine mesh spans many decades; what is below is rigid
    squares = np.maximum(size, least)
    soft = scale.T @ vectors / np.sqrt(squares)
    changes = [(float(np.linalg.norm(soft.T @ F @ soft, 2)), 1) for F in (*system.cosine, *system.sine)]
    rates = {"mass": np.sqrt(squares), "gyroscopic": squares**0.25, "damping": squares**0.25}
    for term in system.terms:
        shape = soft * rates.get(term.of, np.ones(1))
        changes.append((_height(term) * float(np.linalg.norm(shape.T @ term.matrix @ shape, 2)), term.power))
    return _eps_that_changes(changes, STIFFNESS_CHANGE if values[0] > 0 else INDEFINITE_STIFFNESS_CHANGE)


def _height(term: Term) -> float:
    """Return the largest value of a term's waveform; of impulses their sum."""
    if isinstance(term.waveform, Impulses):
        return float(np.abs(term.waveform.weights).sum())
    return float(np.abs(term.waveform.values(np.linspace(0, 2 * np.pi, WAVEFORM_SAMPLES))).max())


def _eps_that_changes(changes: list[tuple[float, int]], wanted: float) -> float:
    """Return the least eps at which one of the changes eps^power change amounts to ``wanted``; 1 if there are none."""
    found = [(wanted / change) ** (1 / power) for change, power in changes if change > 0]
    return _rounded(min(found)) if found else 1.0


def _rounded(value: float) -> float:
    """Return ``value`` to two significant digits."""
    return round(float(value), 1 - floor(log10(value)))
