"""Large and stiff models in their lowest modes: the fast modes cost most and hardly matter to the slow ones."""

from __future__ import annotations

import numpy as np

from periodic import AnyFamily, PeriodicSystem, SparseSystem
from periodic.checks import FloatArray
from periodic.system import SYMMETRY_TOLERANCE
from reduction import reduce_model

# Number of coordinates up to which a system is integrated as it is. With 40 coordinates of a finite-element beam,
# tracing the boundaries of its three lowest modes takes minutes; with 100 it is out of reach.
MAX_WHOLE_SIZE = 24
# But a smaller one, too, is reduced if it has a mode so many times as fast as the excitation: a penalty spring.
STIFF_MODE_OVER_OMEGA = 100.0


def lowest_modes(
    system: AnyFamily | SparseSystem, Omega_range: tuple[float, float], eps: float
) -> tuple[AnyFamily, str]:
    """Return a large or stiff system in its lowest modes, and a sentence that says what was left out.

    A system is returned as it is, with an empty sentence, if it has at most `MAX_WHOLE_SIZE` coordinates and no mode
    beyond `STIFF_MODE_OVER_OMEGA`, if no mode would be left out, or if it cannot be reduced: a family, a system of
    first order, one with unsymmetric or indefinite stiffness.

    Parameters
    ----------
    system : AnyFamily or SparseSystem
    Omega_range : (float, float)
        Window of excitation frequencies.
    eps : float
        Amplitude at which the change of edges is given.

    Raises
    ------
    ValueError
        If a `SparseSystem` cannot be reduced.
    """
    if not isinstance(system, SparseSystem) and not (
        isinstance(system, PeriodicSystem) and _may_be_reduced(system, Omega_range[1])
    ):
        return system, ""
    try:
        model = reduce_model(system, Omega_range)
    except ValueError:
        if isinstance(system, SparseSystem):
            raise
        return system, ""
    kept = len(model.frequencies)
    if kept == system.size:
        return system, ""
    said = f"Integrated are the {kept} lowest of {system.size} modes"
    change = model.change(eps)
    if not np.isfinite(change):
        return model.system, f"{said}; at ε = {eps:g} there is no bound of what the others would change."
    return model.system, (
        f"{said}; the others move edges of regions by {change:.2g} in Ω at most, at ε = {eps:g} "
        "(a bound of second order)."
    )


def _may_be_reduced(system: PeriodicSystem, Omega: float) -> bool:
    """Whether a system is large or stiff, and has modes of mass and stiffness."""
    K: FloatArray = system.stiffness
    if np.abs(K - K.T).max() > SYMMETRY_TOLERANCE * np.abs(K).max():
        return False
    scale = np.linalg.inv(np.linalg.cholesky(system.mass))
    squares = np.linalg.eigvalsh(scale @ K @ scale.T)
    return bool(squares[0] > 0 and (system.size > MAX_WHOLE_SIZE or squares[-1] > (STIFF_MODE_OVER_OMEGA * Omega) ** 2))
