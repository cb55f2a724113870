"""What is measured: the plates, the grid, and one chart of them."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np

from floquet import StabilityChart, stability_chart
from periodic import AnyFamily
from periodic.checks import FloatArray
from plate import EdgeLoad, MovingPlate

# Axial and lateral terms of the plate with so many coordinates.
PLATE_TERMS = {12: (3, 4), 28: (4, 7), 60: (6, 10)}
# Kelvin-Voigt damping c of the damped plates, dimensionless.
BENCHMARK_DAMPING = 1e-3


def plate(size: int, damping: float, **pulsation: float) -> MovingPlate:
    """Return the plate of ``size`` coordinates: partly loaded edges, static in-plane stress.

    ``pulsation``: ``speed_amplitude`` and ``load_amplitude`` of `MovingPlate`, if the speed pulsates.
    """
    axial, lateral = PLATE_TERMS[size]
    return MovingPlate(
        load=EdgeLoad.partial(0.5),
        inplane="static",
        axial_terms=axial,
        lateral_terms=lateral,
        damping=damping,
        **pulsation,  # type: ignore[arg-type]
    )


def grids(columns: int, rows: int) -> tuple[FloatArray, FloatArray]:
    return np.linspace(20.0, 80.0, columns), np.linspace(0.0, 1.0, rows)


def chart(family: AnyFamily, Omega: FloatArray, eps: FloatArray, jobs: int = 1) -> StabilityChart:
    return stability_chart(family, Omega, eps, n_jobs=jobs, audit=0, progress=False)


def cpu_time(function: Callable[..., Any], *arguments: Any) -> tuple[float, Any]:
    """Return the CPU seconds of this process, less disturbed by others than the clock on the wall, and the result."""
    start = time.process_time()
    result = function(*arguments)
    return time.process_time() - start, result
