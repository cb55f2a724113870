"""Which resonance a frequency means: natural frequencies of the first-order matrix, their sums and differences."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from itertools import combinations, combinations_with_replacement

import numpy as np
import scipy.linalg as sla

from floquet.oracle.reduction import constant_matrix, reduce_system
from periodic import PeriodicSystem
from periodic.checks import ComplexArray

# A resonance further from `near`, relative to it, is not what was meant.
FARTHEST = 0.05
# j Omega = omega_p ± omega_q is looked for up to this j; higher tongues are narrower than eps^8.
HIGHEST_ORDER = 8
ORDERS = tuple(range(1, HIGHEST_ORDER + 1))
SIGNS = {"sum": 1.0, "difference": -1.0}
# Of two resonances near by, the one of higher j is taken if it is this many times nearer for each step in j (the
# tongues get narrower by a power of eps), a difference if it is this many times nearer than a sum (most are no
# regions at all).
PREFERENCE = 100.0
# Relative distance below which `near` agrees with a resonance.
AGREEMENT = 1e-9
# Motion slower than this part of the fastest is no oscillation: the exponents of a free or critically damped mode are
# off by the square root of rounding.
SLOWEST = 1e-7


class NoResonanceError(ValueError):
    """No resonance is near enough to the frequency asked for."""


@dataclass(frozen=True, eq=False)
class Resonance:
    """j Omega = omega_p + omega_q ("sum") or omega_p - omega_q ("difference") of a system at eps = 0.

    Attributes
    ----------
    p, q : int
        Numbers of the modes by increasing frequency, from 1; p >= q.
    j : int
        Order.
    kind : str
        "sum" or "difference".
    centre : float
        The frequency Omega of resonance.
    decay : float
        Sum of the decay rates of the two modes.
    solutions : ndarray of complex, shape (2n, 2)
        The two solutions that resonate, at t = 0 in (W', W): those of e^{i omega_p t} and of e^{∓ i omega_q t}.
    """

    p: int
    q: int
    j: int
    kind: str
    centre: float
    decay: float
    solutions: ComplexArray


def nearest_resonance(
    system: PeriodicSystem, near: float, kinds: Collection[str] = SIGNS, orders: Sequence[int] = ORDERS
) -> Resonance:
    """Return the resonance of one of the ``kinds`` and ``orders`` that ``near`` means.

    Raises
    ------
    NoResonanceError
        If there is none within 5 % of ``near``.
    """
    exponents, vectors = _oscillations(system, near)
    frequencies, decay = exponents.imag, -exponents.real
    numbers = range(len(frequencies))
    pairs = [("sum", p, q) for q, p in combinations_with_replacement(numbers, 2)]
    pairs += [("difference", p, q) for q, p in combinations(numbers, 2)]
    pairs = [pair for pair in pairs if pair[0] in kinds]
    total = np.array([frequencies[p] + SIGNS[kind] * frequencies[q] for kind, p, q in pairs])
    distance = np.abs(total[:, None] / orders / near - 1)
    if not (distance <= FARTHEST).any():
        named = "(omega_p " + ("±" if len(kinds) > 1 else "+" if "sum" in kinds else "-") + " omega_q) / j"
        which = f"= {orders[0]}" if len(orders) == 1 else f"<= {orders[-1]}"
        first = ", ".join(f"{f:.6g}" for f in frequencies[:4]) or "none"
        raise NoResonanceError(
            f"near = {near!r} is not within {FARTHEST:.0%} of any {named} with j {which}; "
            f"the natural frequencies are {first}{', ...' if len(frequencies) > 4 else ''}"
        )
    handicap = PREFERENCE ** (np.array(orders) - 1.0) * np.array(
        [[1.0 if kind == "sum" else PREFERENCE] for kind, _, _ in pairs]
    )
    score = np.where(distance <= FARTHEST, (distance + AGREEMENT) * handicap, np.inf)
    row, column = divmod(int(score.argmin()), len(orders))
    (kind, p, q), j = pairs[row], int(orders[column])
    partner = vectors[:, q].conj() if kind == "sum" else vectors[:, q]
    both = np.column_stack([vectors[:, p], partner])
    return Resonance(p + 1, q + 1, j, kind, float(total[row] / j), float(decay[p] + decay[q]), both)


def _oscillations(system: PeriodicSystem, near: float) -> tuple[ComplexArray, ComplexArray]:
    """Return the exponents i omega - decay at eps = 0, by increasing omega > 0, and the modes (2n, count) in (W', W).

    Modes are those of the subsystems into which the excited system splits: of two modes with equal frequency in
    different subsystems no mixture is formed.
    """
    exponents, modes = [], []
    for subsystem in reduce_system(system, 1.0, near / (2 * np.pi)):
        values, vectors = sla.eig(constant_matrix(subsystem.equations))
        oscillating = values.imag > SLOWEST * np.abs(values).max()
        exponents.append(values[oscillating])
        modes.append(subsystem.to_q @ vectors[:, oscillating])
    exponent = np.concatenate(exponents)
    order = np.argsort(exponent.imag)
    return exponent[order], np.concatenate(modes, axis=1)[:, order]
