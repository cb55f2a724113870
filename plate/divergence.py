"""The divergence speed, at which K_oe + V^2 K_og + f0 F_c0 of eq. (11) becomes singular."""

from __future__ import annotations

import math
from collections.abc import Callable

from scipy.linalg import LinAlgError, eigh

from periodic.checks import FloatArray

# With in-plane inertia the divergence speed converges by a factor of about f0 (h/b)^2 / 12 an iteration.
MOST_ITERATIONS = 50

# Relative change of V_cr^2 at which its iteration stops.
SPEED_TOLERANCE = 1e-14


def divergence_speed(
    K_oe: FloatArray, K_og: FloatArray, F_c0: Callable[[float], FloatArray], tension: float, fastest: float
) -> float:
    """Return V_cr; infinity if there is none below ``fastest``.

    Parameters
    ----------
    K_oe, K_og : ndarray, shape (n, n)
        Bending stiffness, positive definite, and transport stiffness, negative definite.
    F_c0 : callable
        Returns the static stress stiffness at a transport speed, shape (n, n).
    tension : float
        f0.
    fastest : float
        Speed of in-plane waves, beyond which F_c0 has no meaning; infinite if F_c0 does not depend on the speed.

    Raises
    ------
    ValueError
        If the static tension buckles the plate at rest.
    """
    # Where F_c0 depends on the speed, V_cr^2 is a fixed point. Else the second turn agrees.
    square = 0.0
    for _ in range(MOST_ITERATIONS):
        stress_stiffness = F_c0(math.sqrt(square))
        try:
            # 1/V^2 as the largest eigenvalue keeps its accuracy beside the stiff lateral bending of a long plate.
            inverse = eigh(-K_og, K_oe + tension * stress_stiffness, eigvals_only=True)
        except LinAlgError:
            if square > 0:  # a stress near the speed of in-plane waves, not the tension at rest
                break
            raise ValueError(_buckled(K_oe, stress_stiffness, tension)) from None
        previous, square = square, float(1 / inverse[-1])
        if abs(square - previous) <= SPEED_TOLERANCE * square:
            return math.sqrt(square)
        if square >= fastest**2:
            break
    return math.inf


def _buckled(K_oe: FloatArray, F_c0: FloatArray, tension: float) -> str:
    # K_oe + f0 F_c0 is singular where -1/f0 is an eigenvalue of the pencil (F_c0, K_oe).
    inverse = eigh(F_c0, K_oe, eigvals_only=True)
    limit = -1 / (inverse[-1] if tension < 0 else inverse[0])
    return (
        f"tension = {tension!r} buckles the plate at rest, as every tension beyond {limit:.10g} does; "
        "give one nearer zero"
    )
