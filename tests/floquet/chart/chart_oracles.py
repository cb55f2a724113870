"""Charts without audit, and every cell of a chart by another integrator."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from floquet import StabilityChart, monodromy, stability_chart
from periodic import SystemFamily


def chart(system: SystemFamily, Omega: ArrayLike, eps: ArrayLike, **options: Any) -> StabilityChart:
    return stability_chart(system, Omega, eps, **{"n_jobs": 1, "progress": False, "audit": 0} | options)


def agrees(system: SystemFamily, found: StabilityChart) -> bool:
    """Compare every cell of a chart with `monodromy`: growth within the errors, no contradiction."""
    for j, Omega in enumerate(found.Omega):
        for i, eps in enumerate(found.eps):
            exact = monodromy(system, float(Omega), float(eps))
            difference = abs(found.growth_rate[i, j] - exact.growth_rate) * 2 * np.pi / Omega
            assert difference <= 3 * (found.error[i, j] + exact.log_modulus_error) + 1e-13
            if found.kind[i, j] >= 0 and exact.kind >= 0:
                assert (found.kind[i, j] > 0) == (exact.kind > 0)
    return True
