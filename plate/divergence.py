"""The divergence speed, at which K_oe + V^2 K_og + f0 F_c0 of eq. (11) becomes singular."""

from __future__ import annotations

import math
from collections.abc import Callable

from scipy.linalg import LinAlgError, eigh
from scipy.optimize import brentq

from periodic.checks import FloatArray

# The search ends this part below ``fastest``, where F_c0 is singular.
SINGULAR_SPEED_MARGIN = 1e-9


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
        Speed at which F_c0 becomes singular, or infinity if it does not depend on the speed.

    Raises
    ------
    ValueError
        If the static tension buckles the plate at rest.
    """

    def inverse_square(speed: float) -> float:
        """Return 1 / V_cr^2 under the static stress at ``speed``."""
        # the largest eigenvalue stays accurate beside the stiff lateral bending of a long plate, the smallest would not
        return float(eigh(-K_og, K_oe + tension * F_c0(speed), eigvals_only=True)[-1])

    def excess(speed: float) -> float:
        """Return (V / V_cr)^2 - 1, but at most 1, under the static stress at the speed V itself."""
        try:
            return min(speed**2 * inverse_square(speed) - 1, 1.0)
        except LinAlgError:  # a stress near the speed of in-plane waves, not the tension at rest
            return 1.0

    try:
        at_rest = 1 / math.sqrt(inverse_square(0.0))
    except LinAlgError:
        raise ValueError(_buckled(K_oe, F_c0(0.0), tension)) from None
    if math.isinf(fastest):
        return at_rest
    highest = (1 - SINGULAR_SPEED_MARGIN) * fastest
    for top in (min(2 * at_rest, highest), highest):
        if excess(top) >= 0:
            return float(brentq(excess, 0.0, top, xtol=1e-14 * at_rest, rtol=1e-14))
    return math.inf


def _buckled(K_oe: FloatArray, F_c0: FloatArray, tension: float) -> str:
    # K_oe + f0 F_c0 is singular where -1/f0 is an eigenvalue of the pencil (F_c0, K_oe).
    inverse = eigh(F_c0, K_oe, eigvals_only=True)
    limit = -1 / (inverse[-1] if tension < 0 else inverse[0])
    return (
        f"tension = {tension!r} buckles the plate at rest, as every tension beyond {limit:.10g} does; "
        "give one nearer zero"
    )
