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

The room works from the inside outwards, each step in its own module:

1. `resonance` names resonances, once for the whole house, and `question` says which one a frequency means;
2. `subsystems` takes any linear periodic system apart, `forcing` tells how strongly it is excited; `solutions`
   integrates a subsystem at one point and keeps what is needed of its multipliers;
3. `pair` tells the two solutions of a resonance from all others, and judges them by a function that is analytic at an
   edge; `hill` climbs to the top of that function;
4. `follow` follows the pair from eps = 0 to the amplitude asked for, `crowd` finds what more than two states open;
5. `walk` goes from a point inside to the first stable gap on either side;
6. `region` joins these for one subsystem, `companions` for coincident resonances of several, `trace` for the user.
"""

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
from floquet.boundary.subsystems import monodromy_matrix, subsystems_at
from floquet.boundary.trace import BoundaryTrace, trace_boundary

__all__ = [
    "MIN_RELATIVE_FREQUENCY",
    "BoundaryTrace",
    "Modes",
    "NoResonanceError",
    "Resonance",
    "monodromy_matrix",
    "natural_modes",
    "nearest_resonance",
    "open_types",
    "resonances",
    "subsystems_at",
    "trace_boundary",
]
