"""The three outcomes of a comparison, what they rest on, and everything that is known of one region."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

import numpy as np

from periodic.checks import FloatArray


class Outcome(StrEnum):
    """What became of the comparison of a region."""

    AGREES = "agrees"
    DISAGREES = "disagrees"
    NOT_COMPARED = "not compared"


# Of several outcomes of one region the most serious counts.
PRIORITY = {Outcome.NOT_COMPARED: 0, Outcome.AGREES: 1, Outcome.DISAGREES: 2}


class Basis(StrEnum):
    """What an outcome rests on; `compare.tally` counts a region under it."""

    EDGES = "edges compared"
    CLOSED = "closed by theory, and integrated"
    UNCOUPLED = "kept apart by symmetry"
    DAMPED = "closed by damping wherever the theory is meant"
    COINCIDENT = "in resonance together with others"
    UNSETTLED = "not near enough to eps = 0 for a limit"
    UNTRACED = "not to be traced"


@dataclass(frozen=True, eq=False)
class RegionAgreement:
    """One region of instability by theory and by integration, on a ladder of eps.

    Attributes
    ----------
    label, type : str
        Name of the resonance ("ω₁+ω₃") and its type ("sum" or "difference").
    p, q, j : int
        Modes (from 1) and harmonic: j Omega = omega_p ± omega_q.
    centre : float
        Frequency at which the region opens.
    eps : ndarray, shape (k,)
        Ladder, increasing, with the rungs that were added below it; empty if nothing was traced. The damping of rung i
        is the system's times eps[i] / eps[-1] (its square for a region that only two interactions open).
    analytic, traced : ndarray, shape (2, k)
        Lower and upper edge; NaN where closed.
    traced_error : ndarray, shape (2, k)
        Error estimate of the traced edges.
    gap : ndarray, shape (2, k)
        |traced - analytic|; NaN where either is closed.
    order : ndarray, shape (2,)
        Fitted order of the gap in eps at each edge; NaN where it cannot be fitted.
    width_ratio : ndarray, shape (k,)
        Traced width over analytic width; NaN where either is closed.
    outcome : Outcome
    basis : Basis
    reason : str
        Why this outcome.
    compared : str
        What was compared, in words and numbers; empty if nothing was.
    coincident : tuple of str
        Names of the resonances that share the region, which is then one region with all these names.
    """

    label: str
    type: str
    p: int
    q: int
    j: int
    centre: float
    eps: FloatArray
    analytic: FloatArray
    traced: FloatArray
    traced_error: FloatArray
    gap: FloatArray
    order: FloatArray
    width_ratio: FloatArray
    outcome: Outcome
    basis: Basis
    reason: str
    compared: str
    coincident: tuple[str, ...] = ()

    @property
    def names(self) -> frozenset[str]:
        """All names of the region."""
        return frozenset((self.label, *self.coincident))

    @property
    def agrees(self) -> bool:
        """Whether numbers were compared and are close; False also for what was not compared."""
        return self.outcome is Outcome.AGREES

    @property
    def limiting_ratio(self) -> float:
        """Width by integration over width by theory at the smallest amplitude at which both are open; NaN if none."""
        both = self.width_ratio[self.width_ratio > 0]
        return float(both[0]) if both.size else float("nan")

    def to_dict(self) -> dict[str, Any]:
        """Return plain numbers and strings, NaN as None, fit for JSON."""
        return {name: _plain(value) for name, value in vars(self).items()} | {"agrees": self.agrees}


def each_once(verdicts: Iterable[RegionAgreement]) -> list[RegionAgreement]:
    """Return each region once: of those with the same names the first with the most serious outcome."""
    found: dict[frozenset[str], RegionAgreement] = {}
    for one in verdicts:
        if one.names not in found or PRIORITY[one.outcome] > PRIORITY[found[one.names].outcome]:
            found[one.names] = one
    return list(found.values())


def _plain(value: Any) -> Any:
    if isinstance(value, StrEnum):
        return value.value
    if isinstance(value, np.ndarray):
        return [_plain(item) for item in value.tolist()]
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    if isinstance(value, float) and not np.isfinite(value):
        return None
    return value
