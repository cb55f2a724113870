"""Edges of one region of instability, found by root-finding on the multipliers that resonate.

A question names a resonance by a frequency; the answer holds the edges of its region at every amplitude asked for:

>>> from floquet.boundary import natural_modes, nearest_resonance, trace_boundary
>>> from periodic.examples import mathieu
>>> modes = natural_modes(mathieu(), 2.0)  # without excitation
>>> nearest_resonance(modes, 1.98).label  # which resonance 1.98 means
'2ω₁'
>>> trace = trace_boundary(mathieu(), near=1.98, eps=[0.1, 0.4])
>>> trace.lower.round(4), trace.upper.round(4)
(array([1.9497, 1.796 ]), array([2.0497, 2.1946]))

`resonance` names resonances, once for the whole house. `pair` tells the two multipliers of a resonance from all others
and judges them by a function that is analytic at an edge. `boundary` follows them to the amplitude asked for and finds
the zeros of that function.
"""

from floquet.boundary.boundary import BoundaryTrace, trace_boundary
from floquet.boundary.resonance import (
    MIN_RELATIVE_FREQUENCY,
    Modes,
    NoResonanceError,
    Resonance,
    natural_modes,
    nearest_resonance,
    open_types,
    resonances,
)

__all__ = [
    "MIN_RELATIVE_FREQUENCY",
    "BoundaryTrace",
    "Modes",
    "NoResonanceError",
    "Resonance",
    "natural_modes",
    "nearest_resonance",
    "open_types",
    "resonances",
    "trace_boundary",
]
