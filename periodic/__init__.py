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

`periodic.examples` has small systems with known answers, `periodic.checks` the checks of arguments for all rooms.

>>> from periodic.examples import mathieu
>>> mathieu(damping=-1.0)
Traceback (most recent call last):
ValueError: damping = -1.0 is out of range; give a number >= 0
"""

from periodic.system import SYMMETRY_TOLERANCE, PeriodicSystem, SystemFamily, member_at

__all__ = ["SYMMETRY_TOLERANCE", "PeriodicSystem", "SystemFamily", "member_at"]
