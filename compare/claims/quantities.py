"""Widths and places of regions, by theory and by integration."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Literal, NamedTuple

import numpy as np

from floquet import BoundaryTrace, Kind, trace_boundary
from perturb import TransitionCurve, gyroscopic_modes, transition_curves
from plate import MovingPlate

# A width below this part of the frequency is no width: ten times what tracing resolves.
MIN_RELATIVE_WIDTH = 1e-8
# Regions whose starting points lie this many times their half widths apart do not merge.
MIN_SEPARATION = 2.0


class Measured(NamedTuple):
    """A number and its error; NaN where integration cannot tell."""

    value: float
    error: float


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
    stands_alone : bool
        Whether no other region comes near: theory treats every region by itself, and merged ones have no own edges.
    """

    system: str
    plate: MovingPlate
    curve: TransitionCurve
    eps: float
    stands_alone: bool = True

    @property
    def name(self) -> str:
        return f"{self.curve.label} of {self.system}"

    @cached_property
    def predicted(self) -> tuple[float, float]:
        """Lower and upper edge by theory; NaN where closed."""
        lower, upper = self.curve.edges(self.eps)
        return float(lower), float(upper)

    @cached_property
    def trace(self) -> BoundaryTrace:
        """The edges by integration."""
        curve = self.curve
        return trace_boundary(self.plate, curve.centre, np.array([self.eps]), type=curve.type, j=curve.j)

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
    is_clear : bool
        Whether the regions that it is about stand alone.
    """

    name: str
    predicted: float
    measure: Callable[[], Measured] | None = None
    eps: float = 0.0
    is_clear: bool = True

    def measured(self) -> Measured:
        return Measured(self.predicted, 0.0) if self.measure is None else self.measure()


def width(region: Region) -> Quantity:
    """Return the width of a region in Omega, 0 where it is closed; NaN by integration where it cannot be told."""

    def measure() -> Measured:
        trace = region.trace
        if trace.kind[0] == Kind.STABLE:
            return Measured(0.0, MIN_RELATIVE_WIDTH * region.curve.centre)
        return Measured(float(trace.upper[0] - trace.lower[0]), float(trace.lower_error[0] + trace.upper_error[0]))

    lower, upper = region.predicted
    return Quantity(
        f"width of {region.name}", upper - lower if region.is_open else 0.0, measure, region.eps, region.stands_alone
    )


def middle(region: Region) -> Quantity:
    """Return the middle of an open region; NaN by integration where it is closed."""

    def measure() -> Measured:
        trace = region.trace
        error = float(trace.lower_error[0] + trace.upper_error[0]) / 2
        return Measured(float(trace.lower[0] + trace.upper[0]) / 2, error)

    return Quantity(f"middle of {region.name}", sum(region.predicted) / 2, measure, region.eps, region.stands_alone)


def number(name: str, value: float) -> Quantity:
    """Return a plain number, the same by theory and by integration."""
    return Quantity(name, value)


def part_of(quantity: Quantity, factor: float, name: str) -> Quantity:
    """Return ``factor`` times a quantity."""

    def measure() -> Measured:
        value, error = quantity.measured()
        return Measured(factor * value, factor * error)

    return Quantity(name, factor * quantity.predicted, measure, quantity.eps, quantity.is_clear)


def distance(left: Quantity, right: Quantity, name: str) -> Quantity:
    """Return |left - right|."""

    def measure() -> Measured:
        a, b = left.measured(), right.measured()
        return Measured(abs(a.value - b.value), a.error + b.error)

    value, eps = abs(left.predicted - right.predicted), max(left.eps, right.eps)
    return Quantity(name, value, measure, eps, left.is_clear and right.is_clear)


def regions(
    system: str,
    plate: MovingPlate,
    eps: float,
    *,
    modes: int,
    type: Literal["sum", "difference"] = "sum",
    order: Literal[1, 2] = 1,
    interaction: Literal[1, 2] = 1,
) -> dict[tuple[int, int], Region]:
    """Return the regions among the lowest modes of a plate by (p, q), p <= q.

    ``interaction`` 1 are those that a harmonic opens by itself, j = 1; 2 those at half their frequencies, which two
    interactions with the first harmonic open together.
    """
    others = _curves(plate, modes, "sum", order)
    return {
        (curve.q, curve.p): Region(system, plate, curve, eps, _stands_alone(curve, others, eps))
        for curve in _curves(plate, modes, type, order)
        if max(curve.p, curve.q) <= modes and (curve.j, curve.interaction) == (interaction, interaction)
    }


def _stands_alone(curve: TransitionCurve, others: Sequence[TransitionCurve], eps: float) -> bool:
    """Whether every other region stays at least as far away as the two are wide."""

    def half_width(of: TransitionCurve) -> float:
        lower, upper = of.edges(eps)
        return float(np.nan_to_num(upper - lower)) / 2

    own = half_width(curve)
    return all(
        abs(other.centre - curve.centre) > MIN_SEPARATION * (own + half_width(other))
        for other in others
        if other is not curve
    )


@lru_cache(maxsize=1024)
def _curves(plate: MovingPlate, modes: int, type: str, order: Literal[1, 2]) -> list[TransitionCurve]:
    """Return the curves of a plate, kept since many claims look at the same plates."""
    highest = float(gyroscopic_modes(plate.at(0.0)).frequencies[modes - 1])
    return transition_curves(plate, (0.0, 2.001 * highest), order, (type,))
