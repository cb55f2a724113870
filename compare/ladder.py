"""The amplitudes at which one region is compared, and the system on each of them.

Multiple scales order the damping with the excitation, c = eps alpha (eq. (21)). On a ladder of amplitudes the damping
therefore shrinks in step with eps, and a region that is open on one rung is open on all. The top rung is the system as
it is given, so the top has to lie above the tip. How large it may be depends on the modes of the region: theory says up
to which eps it is meant (`perturb.TransitionCurve.eps_max`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from periodic import AnyFamily, AnySystem, FirstOrderSystem, PeriodicSystem
from periodic.checks import FloatArray

# The top rung over the eps up to which the theory is meant, if nothing else asks for another one.
TOP_OVER_MAX = 1 / 3
# The top rung over the tip of a damped region. Nearer to the tip the edges turn so sharply that a small error of theory
# moves them far.
TOP_OVER_TIP, MIN_TOP_OVER_TIP = 1.5, 1.1
# Rungs of a ladder at first, each half of the next, and how many are added below, one at a time, as long as the gap has
# not come to its limit.
RUNGS, MAX_EXTENSIONS = 4, 8
# Rates of decay below this part of the largest entry of A are rounding.
DECAY_ROUNDING = 1e-12


@dataclass(frozen=True, eq=False)
class DampingScaled:
    """A family with its damping matrix multiplied by ``factor``: the system on one rung.

    A system of first order has no damping matrix. There the decay of every motion that oscillates is multiplied.
    """

    family: AnyFamily
    factor: float

    def at(self, Omega: float) -> AnySystem:
        """Return the member at Omega."""
        system = self.family.at(Omega)
        if self.factor == 1 or not is_damped(system):
            return system
        if isinstance(system, FirstOrderSystem):
            A = system.constant - (1 - self.factor) * _decay(system)
            return FirstOrderSystem(A, system.cosine, system.sine, terms=system.terms)
        return PeriodicSystem(
            system.mass,
            system.gyroscopic,
            self.factor * system.damping,
            system.stiffness,
            system.cosine,
            system.sine,
            terms=system.terms,
        )


def is_damped(system: AnySystem) -> bool:
    """Return whether a system has a damping matrix, or, of first order, motions that oscillate and decay or grow."""
    if isinstance(system, FirstOrderSystem):
        return bool(np.abs(_decay(system)).max() > DECAY_ROUNDING * np.abs(system.constant).max())
    return bool(system.damping.any())


def _decay(system: FirstOrderSystem) -> FloatArray:
    """Return the part of A by which motions that oscillate decay or grow."""
    values, vectors = np.linalg.eig(system.constant)
    rates = np.where(np.abs(values.imag) > DECAY_ROUNDING * np.abs(values).max(), values.real, 0.0)
    return np.asarray((vectors * rates @ np.linalg.inv(vectors)).real)


class OutOfRangeError(ValueError):
    """A region opens at an eps at which its theory is not meant any more."""


def rungs_below(top: float, count: int = RUNGS) -> FloatArray:
    """Return ``count`` amplitudes up to ``top``, each half of the next, increasing."""
    return np.ldexp(top, np.arange(1 - count, 1))


def top_rung(tip: float, eps_max: float) -> float:
    """Return the largest amplitude at which a region with this tip is compared.

    Parameters
    ----------
    tip : float
        Where theory lets the region open: 0 without damping, infinite if it never opens.
    eps_max : float
        The eps up to which the theory is meant (`perturb.TransitionCurve.eps_max`).

    Raises
    ------
    OutOfRangeError
        If the region opens beyond that eps; the message says where both are.
    """
    usual = TOP_OVER_MAX * eps_max
    if not np.isfinite(tip):
        return usual
    if MIN_TOP_OVER_TIP * tip > eps_max:
        where = "beyond" if tip > eps_max else "too near to the end of"
        raise OutOfRangeError(
            f"opens at eps = {tip:.4g}, {where} the range in which the theory is meant, eps up to {eps_max:.4g}"
        )
    return max(usual, min(TOP_OVER_TIP * tip, eps_max))
