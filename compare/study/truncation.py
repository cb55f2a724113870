"""Large models in their lowest modes: the fast modes cost most and hardly matter to the slow ones."""

from __future__ import annotations

import numpy as np
import scipy.linalg as sla

from periodic import PeriodicSystem, stiffness_alone
from periodic.checks import FloatArray
from periodic.system import SYMMETRY_TOLERANCE
from perturb import gyroscopic_modes, transition_curves

# Number of coordinates up to which a system is integrated as it is. With 40 coordinates of a finite-element beam,
# tracing the boundaries of its three lowest modes takes minutes; with 100 it is out of reach.
MAX_WHOLE_SIZE = 24
# Natural frequency of the highest mode that is kept, over the highest excitation frequency. What the modes beyond add
# to an edge is of second order in eps, and falls with the square of this ratio.
MAX_MODE_OVER_OMEGA = 8.0


def lowest_modes(system: PeriodicSystem, Omega_range: tuple[float, float], eps: float) -> tuple[PeriodicSystem, str]:
    """Return a large system in its lowest modes, and a sentence that says what was left out and what that changes.

    The modes are those of mass and stiffness alone, with natural frequencies up to `MAX_MODE_OVER_OMEGA` times the
    upper end of the window. The system is returned as it is, with an empty sentence, if it has at most
    `MAX_WHOLE_SIZE` coordinates, if no mode lies beyond, or if its stiffness is not symmetric positive definite.

    Parameters
    ----------
    system : PeriodicSystem
    Omega_range : (float, float)
        Window of excitation frequencies.
    eps : float
        Amplitude at which the change of the analytic edges is given.
    """
    K = stiffness_alone(system).stiffness
    if system.size <= MAX_WHOLE_SIZE or np.abs(K - K.T).max() > SYMMETRY_TOLERANCE * np.abs(K).max():
        return system, ""
    squares, modes = sla.eigh((K + K.T) / 2, system.mass)
    kept = int((squares <= (MAX_MODE_OVER_OMEGA * Omega_range[1]) ** 2).sum())
    if squares[0] <= 0 or not 0 < kept < system.size:
        return system, ""
    V = modes[:, :kept]
    mass, gyroscopic, damping = (V.T @ F @ V for F in (system.mass, system.gyroscopic, system.damping))
    stiffness, cosine, sine = np.diag(squares[:kept]), V.T @ system.cosine @ V, V.T @ system.sine @ V
    small = PeriodicSystem(mass, gyroscopic, damping, stiffness, cosine, sine)
    said = f"Integrated are the {kept} lowest of {system.size} modes"
    if gyroscopic_modes(small).decay.min() < 0:  # edges of regions are not what excitation decides then
        return small, f"{said}."
    try:
        change = _change(system, small, Omega_range, eps)
    except ValueError:  # no theory
        return small, f"{said}."
    return small, (
        f"{said}; by theory of second order the others move the edges of regions between these by {change:.2g} of "
        f"their frequency at most, at ε = {eps:g}."
    )


def _change(whole: PeriodicSystem, small: PeriodicSystem, Omega_range: tuple[float, float], eps: float) -> float:
    """Return the largest change of an edge by second-order theory, as part of the frequency."""
    edges: list[dict[tuple[object, ...], FloatArray]] = [
        {
            (curve.p, curve.q, curve.j, curve.type): np.array(curve.edges(eps)) / curve.centre
            for curve in transition_curves(system, Omega_range, order=2)
        }
        for system in (whole, small)
    ]
    changes = [np.abs(edges[0][key] - edge) for key, edge in edges[1].items() if key in edges[0]]
    return float(np.nanmax(np.array(changes), initial=0.0))
