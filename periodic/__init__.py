"""The definition that every other room shares: a linear system with periodic coefficients, as data without a method.

A `PeriodicSystem` holds the matrices; it checks them, copies them and makes them read-only.

>>> import numpy as np
>>> from periodic import PeriodicSystem
>>> zero = np.zeros((2, 2))
>>> system = PeriodicSystem(
...     mass=np.eye(2), gyroscopic=zero, damping=0.01 * np.eye(2), stiffness=np.diag([1.0, 5.0]),
...     cosine=[[[1.0, 0.5], [0.5, 1.0]]],
... )
>>> system.size, system.harmonics
(2, 1)

What depends on the excitation frequency is a family: anything with a method ``at(Omega)``, by the rules of
`SystemFamily`. A system is a family of one.

>>> system.at(2.0) is system
True

Any of its matrices may depend on time: `Term` is one part of one matrix, `waveforms` has how it goes with time. Systems
x' = A(t) x are `FirstOrderSystem`.

>>> from periodic import FirstOrderSystem, Term, waveforms
>>> pulsating_damping = Term("damping", [[1.0]], waveforms.rectangular(duty=0.25), power=2)
>>> PeriodicSystem([[1.0]], stiffness=[[1.0]], terms=[pulsating_damping]).terms[0].power
2
>>> FirstOrderSystem([[-1.0]], cosine=[[0.5]]).size
1

A finite-element model of many coordinates stays sparse, as a `SparseSystem`, until `reduction` has made a small system
of its lowest modes.

`periodic.examples` has small systems with known answers, `periodic.checks` the checks of arguments for all rooms.

>>> from periodic.examples import mathieu
>>> mathieu(damping=-1.0)
Traceback (most recent call last):
ValueError: damping = -1.0 is out of range; give a number >= 0
"""

from periodic import waveforms
from periodic.family import (
    AnyFamily,
    AnySystem,
    SystemFamily,
    any_member_at,
    excitation,
    has_stiffness_alone,
    member_at,
    stiffness_alone,
)
from periodic.first_order import FirstOrderSystem
from periodic.massless import Condensed, without_massless
from periodic.solid import StandardLinearSolid
from periodic.sparse import SparseSystem
from periodic.system import PeriodicSystem, check_mass
from periodic.terms import SYMMETRY_TOLERANCE, Term

__all__ = [
    "SYMMETRY_TOLERANCE",
    "AnyFamily",
    "AnySystem",
    "Condensed",
    "FirstOrderSystem",
    "PeriodicSystem",
    "SparseSystem",
    "StandardLinearSolid",
    "SystemFamily",
    "Term",
    "any_member_at",
    "check_mass",
    "excitation",
    "has_stiffness_alone",
    "member_at",
    "stiffness_alone",
    "waveforms",
    "without_massless",
]
