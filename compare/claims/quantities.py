"""Widths and places of regions, by theory and by integration."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Literal, NamedTuple

import numpy as np

from compare.claims.convergence import KEPT_PLATES
from compare.claims.literal import literal_edges, slightly_damped
from floquet import BoundaryTrace, Kind, trace_boundary
from floquet.boundary import NoResonanceError
from periodic.checks import FloatArray
from perturb import Resonance, TransitionCurve, gyroscopic_modes, transition_curves
from plate import MovingPlate

# A width below this part of the frequency is no width: ten times what tracing resolves.
MIN_RELATIVE_WIDTH = 1e-8
# Regions whose starting points lie this many times their half widths apart do not merge.
MIN_SEPARATION = 2.0
# Plates of which more coordinates than these move together are left to theory: tracing a region of 49 takes ten times
# as long as one of 28, and one of 81 half a minute.
MAX_TRACED_COORDINATES = 30


class Measured(NamedTuple):
    """A number and its error; NaN where integration cannot tell."""

    value: float
    error: float


CANNOT_BE_TOLD = Measured(np.nan, np.nan)


@dataclass(frozen=True, eq=False)
class Region:
    """One region of one system, at one eps, by theory and by integration.

    Attributes
    ----------
    system : str
        How tables name the plate.
    plate : MovingPlate
    curve : TransitionCurve
    eps : float
    predicted : (float, float)
        Lower and upper edge by theory; NaN where closed.
    stands_alone : bool
        Whether theory and integration can be held together: no other region comes near, since theory treats every
        region by itself and merged ones have no own edges; the amplitude is not beyond the range in which theory is
        meant; and the plate is not too large to integrate.
    literal : bool
        Whether theory is eq. (25) as printed, with a damping that vanishes. Integration then takes a plate with so
        little damping that the region is as wide as that, to a part of 1e-3.
    """

    system: str
    plate: MovingPlate
    curve: TransitionCurve
    eps: float
    predicted: tuple[float, float]
    stands_alone: bool = True
    literal: bool = False

    @property
    def name(self) -> str:
        return f"{self.curve.label} of {self.system}"

    @property
    def trace(self) -> BoundaryTrace | None:
        """The edges by integration; None where damping moves the frequencies of the modes too far to find it."""
        return _traced(*self.question)

    @property
    def question(self) -> tuple[MovingPlate, Resonance, float]:
        """What integration is asked: equal for regions that are the same."""
        plate = slightly_damped(self.plate, self.curve.resonance, self.eps) if self.literal else self.plate
        return plate, self.curve.resonance, self.eps

    @property
    def is_open(self) -> bool:
        """Whether theory finds the region wide enough to be one."""
        lower, upper = self.predicted
        return upper - lower > MIN_RELATIVE_WIDTH * self.curve.centre


@dataclass(frozen=True, eq=False)
class Quantity:
    """A number that theory predicts and integration can measure.

    Attributes
    ----------
    name : str
        What it is, of which region and system.
    predicted : float
        Value by theory.
    measure : callable or None
        Returns the value by integration and its error; None for a plain number.
    eps : float
        Amplitude at which it is taken.
    regions : tuple of Region
        What integration has to trace for it.
    """

    name: str
    predicted: float
    measure: Callable[[], Measured] | None = None
    eps: float = 0.0
    regions: tuple[Region, ...] = ()

    @property
    def is_clear(self) -> bool:
        """Whether the regions that it is about stand alone."""
        return all(region.stands_alone for region in self.regions)

    def measured(self) -> Measured:
        return Measured(self.predicted, 0.0) if self.measure is None else self.measure()


def width(region: Region) -> Quantity:
    """Return the width of a region in Omega, 0 where it is closed; NaN by integration where it cannot be told."""

    def measure() -> Measured:
        trace = region.trace
        if trace is None or _is_merged(trace):
            return CANNOT_BE_TOLD
        if trace.kind[0] == Kind.STABLE:
            return Measured(0.0, MIN_RELATIVE_WIDTH * region.curve.centre)
        return Measured(float(trace.upper[0] - trace.lower[0]), float(trace.lower_error[0] + trace.upper_error[0]))

    lower, upper = region.predicted
    predicted = upper - lower if region.is_open else 0.0
    return Quantity(f"width of {region.name}", predicted, measure, region.eps, (region,))


def middle(region: Region) -> Quantity:
    """Return the middle of an open region; NaN by integration where it is closed."""

    def measure() -> Measured:
        trace = region.trace
        if trace is None or _is_merged(trace):
            return CANNOT_BE_TOLD
        error = float(trace.lower_error[0] + trace.upper_error[0]) / 2
        return Measured(float(trace.lower[0] + trace.upper[0]) / 2, error)

    return Quantity(f"middle of {region.name}", sum(region.predicted) / 2, measure, region.eps, (region,))


def _is_merged(trace: BoundaryTrace) -> bool:
    """Whether another region takes over on one side, so that the edges are those of both."""
    return bool(np.isfinite([trace.lower_meeting[0], trace.upper_meeting[0]]).any())


def number(name: str, value: float) -> Quantity:
    """Return a plain number, the same by theory and by integration."""
    return Quantity(name, value)


def part_of(quantity: Quantity, factor: float, name: str) -> Quantity:
    """Return ``factor`` times a quantity."""

    def measure() -> Measured:
        value, error = quantity.measured()
        return Measured(factor * value, factor * error)

    return Quantity(name, factor * quantity.predicted, measure, quantity.eps, quantity.regions)


def distance(left: Quantity, right: Quantity, name: str) -> Quantity:
    """Return |left - right|."""

    def measure() -> Measured:
        a, b = left.measured(), right.measured()
        return Measured(abs(a.value - b.value), a.error + b.error)

    value, eps = abs(left.predicted - right.predicted), max(left.eps, right.eps)
    return Quantity(name, value, measure, eps, (*left.regions, *right.regions))


def regions(
    system: str,
    plate: MovingPlate,
    eps: float,
    *,
    modes: int,
    type: Literal["sum", "difference"] = "sum",
    order: Literal[1, 2] = 1,
    interaction: Literal[1, 2] = 1,
    literal: bool = False,
) -> dict[tuple[int, int], Region]:
    """Return the regions among the lowest modes of a plate by (p, q), p <= q.

    ``interaction`` 1 are those that a harmonic opens by itself, j = 1; 2 those at half their frequencies, which two
    interactions with the first harmonic open together. ``literal`` takes eq. (25) as printed for a plate without
    damping.
    """
    return {
        (curve.q, curve.p): Region(system, plate, curve, eps, edges, alone, literal)
        for curve, edges, alone in _predicted(plate, eps, modes, type, order, interaction, literal)
    }


@lru_cache(maxsize=KEPT_PLATES)
def _predicted(
    plate: MovingPlate,
    eps: float,
    modes: int,
    type: str,
    order: Literal[1, 2],
    interaction: int,
    literal: bool,
) -> list[tuple[TransitionCurve, tuple[float, float], bool]]:
    """Return curve, edges and whether theory and integration can be held together, of every region asked for."""
    neighbours = _neighbours(plate, eps, modes)
    small = _largest_subsystem(plate) <= MAX_TRACED_COORDINATES
    found = []
    for curve in _curves(plate, modes, type, order):
        if max(curve.p, curve.q) <= modes and (curve.j, curve.interaction) == (interaction, interaction):
            lower, upper = literal_edges(plate, curve.resonance, eps) if literal else curve.edges(eps)
            edges = float(lower), float(upper)
            alone = all(
                abs(other.centre - curve.centre) > MIN_SEPARATION * (_half_width(edges) + half)
                for other, half in neighbours
                if other[:4] != curve.resonance[:4]
            )
            meant = eps <= min(curve.eps_max, curve.isolated_up_to)
            found.append((curve, edges, alone and meant and small))
    return found


@lru_cache(maxsize=KEPT_PLATES)
def _neighbours(plate: MovingPlate, eps: float, modes: int) -> list[tuple[Resonance, float]]:
    """Return every open region that may come near others, with its half width."""
    widths = ((curve.resonance, _half_width(curve.edges(eps))) for curve in _curves(plate, modes, "sum", 1))
    return [(resonance, half) for resonance, half in widths if half > 0]


@lru_cache(maxsize=KEPT_PLATES)
def _curves(plate: MovingPlate, modes: int, type: str, order: Literal[1, 2]) -> list[TransitionCurve]:
    """Return the curves of a plate, kept since many claims look at the same plates."""
    highest = float(gyroscopic_modes(plate.at(0.0)).frequencies[modes - 1])
    return transition_curves(plate, (0.0, 2.001 * highest), order, (type,))


def _largest_subsystem(plate: MovingPlate) -> int:
    """Return how many coordinates move together: those of even lateral functions do alone under a symmetric load."""
    terms, system = plate.terms, plate.at(0.0)
    odd = np.arange(system.size) % terms.lateral % 2 == 1
    coupled = bool(system.cosine[:, odd][:, :, ~odd].any() or system.stiffness[odd][:, ~odd].any())
    return system.size if coupled else int((~odd).sum())


def _half_width(edges: tuple[FloatArray | float, FloatArray | float]) -> float:
    lower, upper = edges
    return float(np.nan_to_num(upper - lower)) / 2


@lru_cache(maxsize=KEPT_PLATES)
def _traced(plate: MovingPlate, resonance: Resonance, eps: float) -> BoundaryTrace | None:
    """Return one region by integration, kept since many claims look at the same ones; None where damping hides it."""
    one = resonance
    try:
        return trace_boundary(plate, one.centre, np.array([eps]), type=one.type, j=one.j, p=one.p, q=one.q)
    except NoResonanceError:
        return None
