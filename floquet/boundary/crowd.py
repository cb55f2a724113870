"""The states that resonate together: those that excitation mixes more than their detuning keeps them apart."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from floquet.boundary.forcing import first_order_parts
from floquet.boundary.hill import Height, climb
from floquet.boundary.pair import Point, growing, instability, judge
from floquet.boundary.resonance import Modes, Resonance
from floquet.boundary.solutions import Integrator, Solutions
from floquet.boundary.subsystems import AnySubsystem, free_matrix
from floquet.boundary.walk import EDGE_RESOLUTION
from floquet.oracle import eigensystem
from periodic import AnySystem
from periodic.checks import ComplexArray

# Frequencies that agree to this part of Omega coincide.
COINCIDENCE = 1e-8
# Largest condition number of an eigenvalue whose state counts: those of free and critically damped modes are infinite.
MAX_STATE_CONDITION = 1e6
# Part of a growing solution in the span of the crowd from which on it is the crowd that grows.
MIN_CROWD_PART = 0.5
# Points of a scan, and how often an interval between two of them is halved at most, as long as a hill may be in it.
SCAN_POINTS, MAX_SCAN_HALVINGS = 33, 6
# Part of the distance from a point at which the nearest pair of a crowd meets at the earliest, up to which none is
# looked for.
SURE_DISTANCE = 0.7


class States(NamedTuple):
    """The free states of one subsystem, and how the excitation couples them.

    Attributes
    ----------
    exponents : ndarray of complex, shape (N,)
        Those of e^{lambda t}, in conjugate pairs.
    solutions : ndarray of complex, shape (S, N)
        Their initial values, as states (W', W) or x.
    coupling : ndarray of complex, shape (2 J + 1, N, N)
        First-order rates at eps = 1: [J + h, a, b] by which state b feeds state a through harmonic h.
    """

    exponents: ComplexArray
    solutions: ComplexArray
    coupling: ComplexArray


class Crowd(NamedTuple):
    """Those of the free states that resonate together.

    Attributes
    ----------
    members : list of int
        Their numbers.
    reach : float
        How far from the centre they may be unstable, in Omega.
    spread : int
        Largest difference of the harmonics at which they meet.
    """

    members: list[int]
    reach: float
    spread: int


def free_states(system: AnySystem, subsystem: AnySubsystem, Omega: float) -> States:
    """Return the states of a subsystem without excitation, and the couplings between them near a frequency."""
    values, left, right = eigensystem(free_matrix(subsystem))
    overlap = np.einsum("ij,ij->j", left.conj(), right)
    good = np.abs(overlap) > 1 / MAX_STATE_CONDITION
    values, right, left = values[good], right[:, good], left[:, good] / overlap[good].conj()
    J = int(np.ceil(2 * np.abs(values.imag).max(initial=0.0) / Omega)) + 1  # no two states are further apart
    coupling = np.zeros((2 * J + 1, len(values), len(values)), complex)
    for h, kick in first_order_parts(system, Omega, J).items():
        coupling[J + h] = left.conj().T @ subsystem.from_q @ kick @ subsystem.to_q @ right
    return States(values, subsystem.to_q @ right, coupling)


def gather(states: States, modes: Modes, resonance: Resonance, eps: float, second_order: float = 0.0) -> Crowd:
    """Return the states that resonate together at ``eps``.

    A state joins if its detuning from one of them, damping included, is less than the rate at which the excitation
    exchanges the two, or if it coincides. ``second_order``, as part of the centre, is a rate at which two interactions
    exchange any two.
    """
    Omega, J = resonance.centre, len(states.coupling) // 2
    first, second = _exponents(modes, resonance)
    members = _pair_among(states, first, second)
    harmonics = np.rint((states.exponents.imag - first.imag) / Omega).astype(int)
    rest = states.exponents - 1j * harmonics * Omega
    detuning = np.abs(rest[:, None] - rest)
    step = harmonics[:, None] - harmonics
    index = np.arange(len(rest))
    rate = np.where(np.abs(step) <= J, states.coupling[np.clip(step, -J, J) + J, index[:, None], index], 0.0)
    exchange = eps * np.sqrt(np.abs(rate * rate.T))
    together = detuning < np.maximum(exchange, max(COINCIDENCE, second_order) * Omega)
    while True:
        joined = [a for a in index.tolist() if a in members or together[a, members].any()]
        if len(joined) == len(members):
            break
        members = joined
    inner = np.ix_(members, members)
    reach = float(detuning[inner].max() + 2 * eps * np.linalg.norm(rate[inner], 2))
    return Crowd(members, reach, int(np.abs(step[inner]).max()))


def drift_of(states: States, modes: Modes, resonance: Resonance) -> float:
    """Return d Omega / d eps of the centreline at eps = 0: what the mean of the excitation does to the frequencies."""
    p, q = _pair_among(states, *_exponents(modes, resonance))
    mean = states.coupling[len(states.coupling) // 2]
    return float((mean[p, p] - mean[q, q]).imag / resonance.j)


def scan(
    integrator: Integrator, eps: float, low: float, high: float, solutions: ComplexArray, spread: int
) -> list[Point]:
    """Return points between two frequencies at which solutions in the span of ``solutions`` (S, d) grow, by Omega.

    At least one on every hill of the test function. Two of the solutions turn by pi times ``spread`` / Omega at most
    against each other: the test function at a point tells how far from it none can meet, and intervals in which some
    may are halved. The tops of hills that are not high enough at the points of the scan are found by parabolas.
    """

    def value(Omega: float) -> float:
        return _value(integrator.at(Omega, eps), solutions)

    grid, heights = _refined(value, np.linspace(low, high, SCAN_POINTS).tolist(), spread)
    inside = [Omega for Omega, height in zip(grid, heights, strict=True) if height > 0]
    for k in range(1, len(grid) - 1):
        if not np.isfinite(heights[k]) or not max(heights[k - 1], heights[k + 1]) <= heights[k] <= 0:
            continue
        hill = [Height(grid[i], heights[i]) for i in (k, k - 1, k + 1)]
        within = grid[k - 1], grid[k + 1]
        best = climb(hill, value, EDGE_RESOLUTION * grid[k], within, enough=lambda best, way: True)
        if best.value > 0:
            inside.append(best.Omega)
    found = [integrator.at(Omega, eps) for Omega in sorted(inside)]
    return [judge(there, growing(there)) for there in found]


def _refined(value: Callable[[float], float], grid: list[float], spread: int) -> tuple[list[float], list[float]]:
    """Return a grid that is finer where pairs may meet between two points, and the test function there."""
    heights = [value(Omega) for Omega in grid]
    for _ in range(MAX_SCAN_HALVINGS):
        sure = [
            SURE_DISTANCE * np.sqrt(max(-f, 0.0)) * Omega / (np.pi * spread)
            for Omega, f in zip(grid, heights, strict=True)
        ]
        finer = [
            k
            for k in range(1, len(grid))
            if grid[k] - grid[k - 1] > sure[k - 1] + sure[k] and not min(heights[k - 1], heights[k]) > 0
        ]
        for k in reversed(finer):
            middle = (grid[k - 1] + grid[k]) / 2
            grid.insert(k, middle)
            heights.insert(k, value(middle))
    return grid, heights


def _exponents(modes: Modes, resonance: Resonance) -> tuple[complex, complex]:
    """Return the exponents of the two states that resonate."""
    first, second = (complex(modes.exponents[number - 1]) for number in (resonance.p, resonance.q))
    return first, second.conjugate() if resonance.sign > 0 else second


def _pair_among(states: States, first: complex, second: complex) -> list[int]:
    """Return the numbers of the states with two exponents."""
    return [int(np.abs(states.exponents - exponent).argmin()) for exponent in (first, second)]


def _value(found: Solutions, solutions: ComplexArray) -> float:
    """Return the test function of a crowd: that of the pair in it that is nearest to instability."""
    span, _ = np.linalg.qr(found.subsystem.from_q @ solutions)
    part = np.linalg.norm(span.conj().T @ found.vectors, axis=0)
    growth = np.where(part > MIN_CROWD_PART, found.growth, 0.0)
    if growth.max() > 0:
        return float(growth.max() ** 2)
    members = np.argsort(-part)[: solutions.shape[1]]
    mu, form = found.multipliers[members], found.subsystem.form
    sign = np.zeros(len(members))
    if form is not None:
        x = found.vectors[:, members]
        sign = np.sign(np.einsum("ij,ik,kj->j", x.conj(), 1j * form, x).real)
    values = [
        instability(mu[[i, k]], None, found.subsystem.reciprocal, 0.0)[0]
        for i in range(len(members))
        for k in range(i)
        if sign[i] * sign[k] <= 0
    ]
    return min(max(values, default=-np.inf), 0.0)
