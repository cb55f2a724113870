"""A chart must not become slower than a fixed amount of other work: ``python -m benchmarks --check``."""

from __future__ import annotations

import numpy as np

from benchmarks.peers import modal_equations, rk4
from benchmarks.subjects import BENCHMARK_DAMPING, chart, cpu_time, grids, plate

# CPU time of a chart per point, in steps of `peers.rk4` at the same size, by (n, damping). About twice what one run
# measured (1.0, 1.0, 0.8, 0.9): more than the scatter on a shared machine.
MAX_REFERENCE_STEPS = {(12, 0.0): 2.0, (12, BENCHMARK_DAMPING): 2.1, (28, 0.0): 1.7, (28, BENCHMARK_DAMPING): 1.8}
# Steps that are timed at once: a few milliseconds to a tenth of a second.
TIMED_REFERENCE_STEPS = 2000


def regression(rounds: int = 5, columns: int = 64, rows: int = 64) -> dict[tuple[int, float], float]:
    """Return the CPU time of a chart per point, in steps of `rk4`, by (n, damping): medians of some rounds."""
    ratios = {}
    for size, damping in MAX_REFERENCE_STEPS:
        family = plate(size, damping)
        equations = modal_equations(family.at(30.0))
        Omega, eps = grids(columns, rows)

        chart(family, Omega, eps)  # compiles, as the next line does
        rk4(*equations, 30.0, 0.5, 1)
        found = [
            cpu_time(chart, family, Omega, eps)[0] / Omega.size / eps.size / reference
            for reference in (
                cpu_time(rk4, *equations, 30.0, 0.5, TIMED_REFERENCE_STEPS)[0] / TIMED_REFERENCE_STEPS
                for _ in range(rounds)
            )
        ]
        ratios[size, damping] = float(np.median(found))
    return ratios
