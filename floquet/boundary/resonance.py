"""Resonances j Omega = omega_p ± omega_q: the modes at eps = 0, their pairs, and which of them a frequency means."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from itertools import combinations, combinations_with_replacement
from typing import NamedTuple

import numpy as np
import scipy.linalg as sla
from numpy.typing import NDArray

from floquet.boundary.subsystems import free_matrix, free_subsystems
from floquet.kind import Kind
from floquet.oracle import COUPLING_ROUNDING
from periodic import AnySystem, PeriodicSystem
from periodic.checks import ComplexArray, is_positive_definite

# A resonance further from `near`, relative to it, is not what was meant.
MAX_GUESS_DISTANCE = 0.05
# j Omega = omega_p ± omega_q is looked for up to this j; higher tongues are narrower than eps^8.
MAX_ORDER = 8
ORDERS = tuple(range(1, MAX_ORDER + 1))
SIGNS = {"sum": 1, "difference": -1}
# Of two resonances near by, the one of higher j is taken if it is this many times nearer for each step in j (the
# tongues get narrower by a power of eps), a difference if it is this many times nearer than a sum (most are no
# regions at all).
ORDER_PREFERENCE = 100.0
# Relative distance below which `near` agrees with a resonance, ten times as much for one that symmetry closes: of two
# at the same place the other one is taken.
EXACT_GUESS_DISTANCE, EXACT_GUESS_DISTANCE_APART = 1e-9, 1e-8
# Motion slower than this part of the fastest is no oscillation: the exponents of a free or critically damped mode are
# off by the square root of rounding.
MIN_RELATIVE_FREQUENCY = 1e-7

SUBSCRIPTS = str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉")


class NoResonanceError(ValueError):
    """No resonance is near enough to the frequency asked for."""


class Resonance(NamedTuple):
    """j Omega = omega_p + omega_q ("sum") or omega_p - omega_q ("difference") of a system at eps = 0.

    Attributes
    ----------
    p, q : int
        Numbers of the modes by increasing frequency, from 1; p >= q.
    j : int
        Order.
    type : str
        "sum" or "difference".
    centre : float
        The frequency Omega of resonance.
    """

    p: int
    q: int
    j: int
    type: str
    centre: float

    @property
    def sign(self) -> int:
        """1 for a sum, -1 for a difference."""
        return SIGNS[self.type]

    @property
    def kind(self) -> Kind:
        """How a region that starts from this resonance is unstable."""
        if self.p != self.q:
            return Kind.COMPLEX
        return Kind.PLUS_ONE if self.j % 2 == 0 else Kind.MINUS_ONE

    @property
    def label(self) -> str:
        """Name of the resonance: 2ω₁, ω₁+ω₃, ω₃−ω₁, for j > 1 2ω₁/2, (ω₁+ω₃)/2."""
        p, q = (f"ω{n}".translate(SUBSCRIPTS) for n in (self.p, self.q))
        if self.p == self.q:
            name = f"2{p}"
        else:
            total = f"{q}+{p}" if self.type == "sum" else f"{p}−{q}"
            name = total if self.j == 1 else f"({total})"
        return name if self.j == 1 else f"{name}/{self.j}"


class Modes(NamedTuple):
    """The modes of a system at eps = 0 that oscillate, by increasing frequency.

    Attributes
    ----------
    exponents : ndarray of complex, shape (m,)
        i omega - decay, omega > 0.
    vectors : ndarray of complex, shape (S, m)
        The modes as states: (W', W), or x of a first-order system.
    subsystem : ndarray of int, shape (m,)
        Number of the subsystem of each mode: two modes of different subsystems are not coupled.
    """

    exponents: ComplexArray
    vectors: ComplexArray
    subsystem: NDArray[np.intp]

    def decay(self, resonance: Resonance) -> float:
        """Return the sum of the decay rates of the two modes of a resonance."""
        return float(-self.exponents.real[[resonance.p - 1, resonance.q - 1]].sum())

    def solutions(self, resonance: Resonance) -> ComplexArray:
        """Return the two solutions that resonate, (S, 2), as states at t = 0: those of e^{i omega_p t} and of
        e^{∓ i omega_q t}."""
        second = self.vectors[:, resonance.q - 1]
        return np.column_stack([self.vectors[:, resonance.p - 1], second.conj() if resonance.sign > 0 else second])


def natural_modes(system: AnySystem, Omega: float) -> Modes:
    """Return the modes of a system at eps = 0; ``Omega`` is the scale of frequencies in which it is looked at.

    They are those of the subsystems into which the excited system splits: of two modes with equal frequency in
    different subsystems no mixture is formed.
    """
    # a system of rigid motions alone has no subsystems, and no modes
    states = system.size * (2 if isinstance(system, PeriodicSystem) else 1)
    exponents, vectors, home = [np.zeros(0, complex)], [np.zeros((states, 0), complex)], []
    for number, subsystem in enumerate(free_subsystems(system, Omega)):
        values, columns = sla.eig(free_matrix(subsystem))
        oscillating = values.imag > MIN_RELATIVE_FREQUENCY * np.abs(values).max()
        exponents.append(values[oscillating])
        vectors.append(subsystem.to_q @ columns[:, oscillating])
        home += [number] * int(oscillating.sum())
    exponent = np.concatenate(exponents)
    order = np.argsort(exponent.imag)
    return Modes(exponent[order], np.concatenate(vectors, axis=1)[:, order], np.array(home, dtype=np.intp)[order])


def resonances(
    modes: Modes,
    Omega_range: tuple[float, float],
    types: Collection[str] = SIGNS,
    orders: Sequence[int] = ORDERS,
    *,
    coupled: bool = True,
) -> list[Resonance]:
    """Return the resonances with a centre in ``Omega_range``, by increasing order and frequency.

    ``coupled``: only those of two modes of one subsystem.
    """
    low, high = Omega_range
    omega, numbers = modes.exponents.imag, range(len(modes.exponents))
    found = []
    for type in (type for type in SIGNS if type in types):
        pairs = (combinations_with_replacement if type == "sum" else combinations)(numbers, 2)
        for q, p in pairs:
            if coupled and modes.subsystem[p] != modes.subsystem[q]:
                continue
            total = float(omega[p] + SIGNS[type] * omega[q])
            found += [Resonance(p + 1, q + 1, j, type, total / j) for j in orders if low <= total / j <= high]
    return sorted(found, key=lambda one: (one.j, one.centre))


def open_types(system: PeriodicSystem) -> tuple[str, ...]:
    """Return the types of resonance that may open a region.

    Differences open none where all stiffness is symmetric and positive definite without excitation: both modes have
    positive energy (M. G. Krein).
    """
    parts = np.concatenate([system.stiffness[None], system.cosine, system.sine])
    asymmetry = np.abs(parts - parts.transpose(0, 2, 1)).max(axis=(1, 2))
    symmetric = bool((asymmetry <= COUPLING_ROUNDING * np.abs(parts).max(axis=(1, 2))).all())
    definite = symmetric and is_positive_definite((system.stiffness + system.stiffness.T) / 2)
    return ("sum",) if definite else ("sum", "difference")


def nearest_resonance(
    modes: Modes,
    near: float,
    types: Collection[str] = SIGNS,
    orders: Sequence[int] = ORDERS,
    numbers: Collection[int] = (),
    among: Sequence[Resonance] | None = None,
) -> Resonance:
    """Return the resonance of one of the ``types`` and ``orders`` that ``near`` means.

    If ``numbers`` of modes are given, it is one between them. Of several at one place one that symmetry does not close
    is taken. ``among``: those within 5 %, if they are not all of the modes.

    Raises
    ------
    NoResonanceError
        If there is none within 5 % of ``near``.
    """
    found = list(among or [])
    if among is None:
        around = (1 - MAX_GUESS_DISTANCE) * near, (1 + MAX_GUESS_DISTANCE) * near
        found = resonances(modes, around, types, orders, coupled=False)
    wanted = sorted(numbers)
    if len(wanted) == 1:
        found = [one for one in found if wanted[0] in (one.p, one.q)]
    elif wanted:
        found = [one for one in found if wanted == [one.q, one.p]]
    if not found:
        named = "(omega_p " + ("±" if len(types) > 1 else "+" if "sum" in types else "-") + " omega_q) / j"
        which = f"= {orders[0]}" if len(orders) == 1 else f"<= {orders[-1]}"
        chosen = f" between modes {' and '.join(map(str, wanted))}" if wanted else ""
        frequencies = modes.exponents.imag
        first = ", ".join(f"{f:.6g}" for f in frequencies[:4]) or "none"
        raise NoResonanceError(
            f"near = {near!r} is not within {MAX_GUESS_DISTANCE:.0%} of any {named} with j {which}{chosen}; "
            f"the natural frequencies, damping included, are {first}{', ...' if len(frequencies) > 4 else ''}"
        )

    def score(one: Resonance) -> float:
        handicap = ORDER_PREFERENCE ** (one.j - 1.0) * (1.0 if one.type == "sum" else ORDER_PREFERENCE)
        apart = modes.subsystem[one.p - 1] != modes.subsystem[one.q - 1]
        return (abs(one.centre / near - 1) + (EXACT_GUESS_DISTANCE_APART if apart else EXACT_GUESS_DISTANCE)) * handicap

    return min(found, key=score)
