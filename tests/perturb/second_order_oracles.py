"""Second-order curves by label, and their gap to Hill's determinant."""

from __future__ import annotations

from typing import Any

import numpy as np

from perturb import TransitionCurve, transition_curves
from perturb.effective_matrix import EffectiveMatrix
from perturb.resonant_states import ResonantStates
from tests.perturb.perturb_oracles import hill_edges

EVERYTHING = (0.0, 1e6)


def curves(family: Any, Omega_range: tuple[float, float] = EVERYTHING, **options: Any) -> dict[str, TransitionCurve]:
    return {c.label: c for c in transition_curves(family, Omega_range, order=2, **options)}


def matrix_of(curve: TransitionCurve) -> EffectiveMatrix:
    """The effective matrix behind a curve."""
    assert isinstance(curve.prediction, ResonantStates)
    return curve.prediction.matrix


def gaps(system: Any, label: str, eps: np.ndarray, **hill: Any) -> np.ndarray:
    """Largest distance of the two edges from those of Hill's determinant."""
    found = curves(system)[label]
    result = []
    for value in eps:
        lower, upper = found.edges(value)
        exact = hill_edges(system, 0.5 * (lower + upper), upper - lower, value, **hill)
        result.append(max(abs(lower - exact[0]), abs(upper - exact[1])))
    return np.array(result)
