"""Monodromy matrices of a subsystem at one frequency and many amplitudes, by repeated doubling.

A `Sampler` takes 2^L short steps (`step`) at a few phases and amplitudes, multiplies neighbouring ones until one
product spans the period (`doubling`), and interpolates in between (`interpolation`). Which products are sampled is
planned in advance (`schedule`), and the plan is kept for the columns beside it (`memo`). The matrices of a whole column
are combinations of a few samples (`sampling`).

>>> import numpy as np
>>> from floquet.engine import subsystems
>>> from floquet.engine.doubling import INTERPOLATION_TOLERANCE, Sampler, Workspace
>>> from periodic.examples import mathieu
>>> subsystem, = subsystems(mathieu(delta=1.0))
>>> sampler = Sampler.of(subsystem, Omega=2.0, work=Workspace())
>>> matrices = sampler.matrices(np.array([0.0, 0.4]), L=8, tolerance=INTERPOLATION_TOLERANCE)
>>> [float(abs(np.linalg.eigvals(matrix)).max().round(6)) for matrix in matrices]
[1.0, 1.367115]
"""

from floquet.engine.doubling.doubling import RESCALING_NORM, Scale, cancellation, doublings
from floquet.engine.doubling.interpolation import chebyshev_points, chebyshev_weights, degree
from floquet.engine.doubling.sampling import (
    Piece,
    Sampler,
    Workspace,
    combination_norms,
    in_lanes,
    largest_amplitude,
)
from floquet.engine.doubling.schedule import INTERPOLATION_TOLERANCE, Schedule, growth_bounds, quantised
from floquet.engine.doubling.step import exponential, multiply

__all__ = [
    "INTERPOLATION_TOLERANCE",
    "RESCALING_NORM",
    "Piece",
    "Sampler",
    "Scale",
    "Schedule",
    "Workspace",
    "cancellation",
    "chebyshev_points",
    "chebyshev_weights",
    "combination_norms",
    "degree",
    "doublings",
    "exponential",
    "growth_bounds",
    "in_lanes",
    "largest_amplitude",
    "multiply",
    "quantised",
]
