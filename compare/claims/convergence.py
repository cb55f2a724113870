"""How many terms a plate of the survey needs: refined until frequencies and slopes move less than a stated part."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from periodic.checks import FloatArray
from perturb import gyroscopic_modes, transition_curves
from plate import MovingPlate, Terms

# Refined terms move the divergence speed and the frequencies of a converged plate by less than this part of them, ...
FREQUENCY_TOLERANCE = 0.002
# ... and the slopes of its regions by less than this part of them. Slopes below a hundredth of the plate's largest one,
# which are small by cancellation, are held to a part of that hundredth.
SLOPE_TOLERANCE = 0.01
LEAST_SLOPE = 0.01
# By how much each number of terms grows in one refinement: sines, polynomials, and in-plane functions each way.
REFINEMENT = Terms(2, 2, (4, 4))
# A direction that moves frequencies or slopes by more than this part of the tolerance is refined.
DIRECTION_SHARE = 1 / 3
# After so many refinements a plate is taken as it is, and what is left is told.
MAX_REFINEMENTS = 6
# Plates that are kept, since many claims look at the same ones.
KEPT_PLATES = 4096


class Converged(NamedTuple):
    """A plate with enough terms.

    Attributes
    ----------
    plate : MovingPlate
    frequency_change, slope_change : float
        Largest change, as a part, of divergence speed and natural frequencies and of slopes if all terms are refined
        once more; NaN if the terms were given.
    """

    plate: MovingPlate
    frequency_change: float
    slope_change: float


class _Numbers(NamedTuple):
    frequencies: FloatArray
    slopes: FloatArray

    def change(self, finer: _Numbers) -> tuple[float, float]:
        """Return the largest change of frequencies and slopes from these numbers to finer ones."""
        least = LEAST_SLOPE * max(float(finer.slopes.max()), np.finfo(float).tiny)
        return (
            float(np.abs(finer.frequencies / self.frequencies - 1).max()),
            float((np.abs(finer.slopes - self.slopes) / np.maximum(finer.slopes, least)).max()),
        )


@lru_cache(maxsize=KEPT_PLATES)
def converged(plate: MovingPlate, fraction: float | None, modes: int) -> Converged:
    """Return a plate with as many terms as it needs.

    Parameters
    ----------
    plate : MovingPlate
        Terms that it leaves open are chosen; if it gives all, they are kept.
    fraction : float or None
        Its speed as a part of its own divergence speed, which moves with the terms; None: the speed that it has.
    modes : int
        Lowest modes whose frequencies and regions have to be right.
    """
    if None not in (plate.axial_terms, plate.lateral_terms, plate.inplane_terms):
        return Converged(_with(plate, plate.terms, fraction), np.nan, np.nan)
    terms = plate.terms
    for refinement in range(MAX_REFINEMENTS + 1):
        here = _numbers(plate, terms, fraction, modes)
        left = here.change(_numbers(plate, _finer(terms, (True, True, True)), fraction, modes))
        if _size(left) <= 1 or refinement == MAX_REFINEMENTS:
            break
        ways = ((True, False, False), (False, True, False), (False, False, True))
        changes = [_size(here.change(_numbers(plate, _finer(terms, way), fraction, modes))) for way in ways]
        most = max(changes)
        terms = _finer(terms, tuple(change > DIRECTION_SHARE or change == most for change in changes))
    return Converged(_with(plate, terms, fraction), *left)


def terms_left(plates: Sequence[Converged]) -> str:
    """Return in words how well the terms of some plates are chosen."""
    left = [(one.frequency_change, one.slope_change) for one in plates if np.isfinite(one.frequency_change)]
    if not left:
        return "terms of the plates as given"
    frequency, slope = (100 * max(change) for change in zip(*left, strict=True))
    return (
        f"terms chosen plate by plate, so that more would move frequencies and divergence speeds by less than "
        f"{100 * FREQUENCY_TOLERANCE:g} % and slopes by less than {100 * SLOPE_TOLERANCE:g} % (largest changes left: "
        f"{frequency:.2g} % and {slope:.2g} %)"
    )


def _size(change: tuple[float, float]) -> float:
    """Return a change in multiples of the tolerance."""
    return max(change[0] / FREQUENCY_TOLERANCE, change[1] / SLOPE_TOLERANCE)


def _finer(terms: Terms, ways: tuple[bool, ...]) -> Terms:
    """Return the terms, refined along x, across y, in the in-plane problem, or in some of these ways."""
    axial, lateral, inplane = ways
    (along, across), (more_along, more_across) = terms.inplane, REFINEMENT.inplane
    return Terms(
        terms.axial + axial * REFINEMENT.axial,
        terms.lateral + lateral * REFINEMENT.lateral,
        (along + inplane * more_along, across + inplane * more_across),
    )


def _with(plate: MovingPlate, terms: Terms, fraction: float | None) -> MovingPlate:
    """Return the plate with these terms, at a part of its divergence speed."""
    speed = plate.speed if fraction is None else 0.0
    there = replace(
        plate, axial_terms=terms.axial, lateral_terms=terms.lateral, inplane_terms=terms.inplane, speed=speed
    )
    return there if fraction is None else replace(there, speed=fraction * there.critical_speed())


@lru_cache(maxsize=KEPT_PLATES)
def _numbers(plate: MovingPlate, terms: Terms, fraction: float | None, modes: int) -> _Numbers:
    """Return divergence speed and frequencies of the lowest modes, and the slopes of their regions."""
    refined = _with(plate, terms, fraction)
    frequencies = gyroscopic_modes(refined.at(0.0)).frequencies[:modes]
    curves = transition_curves(refined, (0.0, 2.001 * float(frequencies[-1])), types=("sum",))
    slopes = {(curve.q, curve.p): curve.slope for curve in curves if curve.j == 1 and curve.p <= modes}
    return _Numbers(
        np.array([refined.critical_speed(), *frequencies]), np.array([slopes[pair] for pair in sorted(slopes)])
    )
