"""Many points at once: the multipliers of whole columns of a chart, each with its error.

A system falls into independent subsystems (`decoupling`), each in coordinates that suit its free motion
(`coordinates`). For a subsystem and a frequency, `doubling` gives the monodromy matrices at all amplitudes, and `eigen`
their eigenvalues; `multipliers` puts the two together. `steps` finds how many steps a period needs, and `column`
measures what error is left. `stability` turns multipliers and errors into a verdict, and `krein` looks again at cells
in doubt.

>>> import numpy as np
>>> from floquet.engine import chart_batch, steps_needed
>>> from periodic.examples import mathieu
>>> system, Omega, eps = mathieu(delta=1.0), np.array([1.5, 2.0]), np.array([0.2, 0.4])
>>> steps = steps_needed([system, system], Omega, eps)
>>> tile = chart_batch([system, system], Omega, eps, steps)
>>> tile.kind.tolist()  # rows are amplitudes, columns are frequencies; see `Kind`
[[0, 2], [0, 2]]
>>> bool(tile.error.max() < 1e-8)
True
"""

from floquet.engine.column import ERROR_SAFETY, Tile, chart_batch
from floquet.engine.coordinates import Subsystem, equations, least_frequency, subsystems
from floquet.engine.doubling import INTERPOLATION_TOLERANCE, Sampler, Workspace
from floquet.engine.eigen import reciprocal_pairs
from floquet.engine.multipliers import Multipliers, ReciprocalSums, Spectra, dominant, spectra
from floquet.engine.parts import rigid_motions
from floquet.engine.stability import exponent, judge
from floquet.engine.steps import MIN_STEPS_PER_CYCLE, log2_steps, steps_needed

__all__ = [
    "ERROR_SAFETY",
    "INTERPOLATION_TOLERANCE",
    "MIN_STEPS_PER_CYCLE",
    "Multipliers",
    "ReciprocalSums",
    "Sampler",
    "Spectra",
    "Subsystem",
    "Tile",
    "Workspace",
    "chart_batch",
    "dominant",
    "equations",
    "exponent",
    "judge",
    "least_frequency",
    "log2_steps",
    "reciprocal_pairs",
    "rigid_motions",
    "spectra",
    "steps_needed",
    "subsystems",
]
