"""Columns of charts of any linear periodic system.

`members` takes systems apart and writes each part as y' = [A + V(t)] y. With smooth coefficients and a constant mass
`sampling` doubles steps (`step`) as for periodic stiffness alone; else it goes from jump to jump.

>>> import numpy as np
>>> from floquet.engine.doubling import Workspace
>>> from floquet.engine.general import general_subsystems, general_sampler
>>> from periodic import PeriodicSystem, Term, waveforms
>>> system = PeriodicSystem([[1.0]], stiffness=[[1.0]], terms=[Term("stiffness", [[1.0]], waveforms.rectangular())])
>>> ((subsystem,), rigid), = general_subsystems([system], np.array([2.0]))
>>> Phi, = general_sampler(subsystem, 2.0, Workspace()).matrices(np.array([0.5]), L=6, tolerance=1e-10)
>>> u, v = np.pi / 2 * np.sqrt([1.5, 0.5])  # Meissner's equation: the trace is known
>>> trace = 2 * np.cos(u) * np.cos(v) - (u / v + v / u) * np.sin(u) * np.sin(v)
>>> bool(abs(np.trace(Phi) - trace) < 1e-13)
True
"""

from floquet.engine.general.members import general_subsystems
from floquet.engine.general.sampling import JumpSampler, SmoothSampler, general_sampler
from floquet.engine.general.subsystems import GeneralSubsystem, Parts, refuse_singular_mass

__all__ = [
    "GeneralSubsystem",
    "JumpSampler",
    "Parts",
    "SmoothSampler",
    "general_sampler",
    "general_subsystems",
    "refuse_singular_mass",
]
