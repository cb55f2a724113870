"""How far a theory can be trusted: the eps up to which its edges stay within a few per cent of the traced width."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from floquet import BoundaryTrace
from periodic.checks import FloatArray, real_number
from perturb import TransitionCurve

# Largest deviation of an edge, as part of the traced width, up to which a theory is said to hold.
VALIDITY_TOLERANCES = (0.01, 0.05, 0.10)


@dataclass(frozen=True)
class Validity:
    """Where one theory of one region holds.

    Attributes
    ----------
    label : str
        Name of the region.
    order : int
        Order of the theory.
    tolerance : float
        Largest deviation of an edge, as a part of the traced width.
    first, last : float
        The theory holds from eps = ``first`` (above the tip of a damped region, where the width starts from zero) to
        ``last``; NaN where it holds nowhere.
    to_the_end : bool
        ``last`` is the largest eps traced: the theory may hold further.
    """

    label: str
    order: int
    tolerance: float
    first: float
    last: float
    to_the_end: bool

    def __str__(self) -> str:
        name = {1: "first", 2: "second"}[self.order]
        if np.isnan(self.last):
            return f"{name} order holds nowhere to {self.tolerance:.0%}"
        start = f"from eps = {self.first:.2g} " if self.first > 0 else ""
        end = f"at least {self.last:.2g}" if self.to_the_end else f"{self.last:.2g}"
        return f"{name} order holds {start}to eps = {end} ({self.tolerance:.0%})"


def validity(
    curve: TransitionCurve, trace: BoundaryTrace, tolerances: Sequence[float] = VALIDITY_TOLERANCES
) -> list[Validity]:
    """Return where ``curve`` stays within each tolerance of the traced region.

    Parameters
    ----------
    curve : TransitionCurve
        The theory, of first or second order.
    trace : BoundaryTrace
        The same region by integration. Between its values of eps the deviation is interpolated linearly, so that the
        limits are as fine as the trace.
    tolerances : sequence of float
        Largest deviation of an edge over the traced width, > 0.

    Returns
    -------
    list of Validity
        One for each tolerance.

    Raises
    ------
    ValueError
        If a tolerance is not a positive number.
    """
    checked = [real_number("tolerances", value, positive=True) for value in tolerances]
    order = np.argsort(trace.eps)
    eps = trace.eps[order]
    lower, upper = curve.edges(eps)
    gap = np.fmax(np.abs(lower - trace.lower[order]), np.abs(upper - trace.upper[order]))
    closed = ~(np.isfinite(lower) & np.isfinite(upper) & trace.is_open[order])
    with np.errstate(divide="ignore", invalid="ignore"):
        deviation = np.where(closed, np.inf, gap / (trace.upper - trace.lower)[order])
    limits = [_first_run(eps, deviation, tolerance, bool(curve.tip > 0)) for tolerance in checked]
    return [
        Validity(curve.label, curve.order, tolerance, first, last, last == eps[-1])
        for tolerance, (first, last) in zip(checked, limits, strict=True)
    ]


def _first_run(eps: FloatArray, deviation: FloatArray, tolerance: float, damped: bool) -> tuple[float, float]:
    """Return the first stretch of eps on which ``deviation`` stays within ``tolerance``.

    Without damping the deviation vanishes at eps = 0, and a stretch from there is the only one that counts: a later
    one is where a wrong curve crosses the right one.
    """
    if not damped:
        eps, deviation = np.concatenate([[0.0], eps]), np.concatenate([[0.0], deviation])
    inside = deviation <= tolerance
    if not inside.any():
        return np.nan, np.nan
    start = int(np.argmax(inside))
    beyond = np.flatnonzero(~inside[start:])
    stop = start + int(beyond[0]) if beyond.size else len(eps)
    first = eps[0] if start == 0 else _crossing(eps, deviation, start - 1, tolerance)
    last = eps[-1] if stop == len(eps) else _crossing(eps, deviation, stop - 1, tolerance)
    return (float(first), float(last)) if last > 0 else (np.nan, np.nan)


def _crossing(eps: FloatArray, deviation: FloatArray, k: int, tolerance: float) -> float:
    """Return where ``deviation`` passes ``tolerance`` between points k and k + 1; the inner point if one is closed."""
    left, right = deviation[k], deviation[k + 1]
    if not np.isfinite(left):
        return float(eps[k + 1])
    if not np.isfinite(right):
        return float(eps[k])
    return float(eps[k] + (eps[k + 1] - eps[k]) * (tolerance - left) / (right - left))
