"""One point (Omega, eps), integrated as well as float64 allows: the oracle that charts and boundaries are held against.

The room works in five steps, each in its own module:

1. `reduction` splits a system at one amplitude into subsystems and writes each in energy coordinates; `rigid` sets
   rigid motions apart;
2. `taylor` and `period` integrate a subsystem over one period by Taylor series, and estimate the error;
3. `multipliers` turns the matrix and its error into multipliers and a verdict; where small multipliers are below its
   rounding, `factors` and `products` find them from parts of the period;
4. `solutions` finds the solutions that go with the multipliers, at any phase of the period, however fast they decay;
5. `point` joins the subsystems: `monodromy` for all that is known, `is_unstable` for a quick yes or no.

Systems with periodic stiffness alone, eq. (11), and those that are of this form at the amplitude asked for (`frozen`),
take these. Any other is E(t) y' = A(t) y, and `general` takes it over a period, from jump to jump.

>>> from floquet.oracle import monodromy
>>> from periodic.examples import mathieu
>>> found = monodromy(mathieu(), Omega=2.0, eps=0.1)
>>> found.kind.name, round(found.growth_rate, 4)  # first order: eps / 4
('MINUS_ONE', 0.025)
>>> found.error < 1e-11
True

The steps by themselves serve root-finding, which needs many points with little else:

>>> import numpy as np
>>> from floquet.oracle import propagate, reduce_system, steps_of_period
>>> (subsystem,) = reduce_system(mathieu(), eps=0.1, slowest=0.3)
>>> steps = steps_of_period(subsystem, Omega=2.0)
>>> Phi = propagate(subsystem, 2.0, 0.1, steps, 1e-13, np.eye(2))
>>> bool(abs(np.linalg.det(Phi) - 1) < 1e-13)  # Liouville's formula
True
"""

from floquet.oracle.general import GeneralSubsystem, factors_between, largest_rate, split
from floquet.oracle.multipliers import eigensystem
from floquet.oracle.period import PeriodMap, period_map, propagate, steps_of_period
from floquet.oracle.point import Monodromy, is_unstable, monodromy
from floquet.oracle.reduction import (
    COUPLING_ROUNDING,
    Subsystem,
    constant_matrix,
    modulation,
    reduce_system,
    rigid_basis,
)
from floquet.oracle.solutions import ProductSolutions, product_solutions

__all__ = [
    "COUPLING_ROUNDING",
    "GeneralSubsystem",
    "Monodromy",
    "PeriodMap",
    "ProductSolutions",
    "Subsystem",
    "constant_matrix",
    "eigensystem",
    "factors_between",
    "is_unstable",
    "largest_rate",
    "modulation",
    "monodromy",
    "period_map",
    "product_solutions",
    "propagate",
    "reduce_system",
    "rigid_basis",
    "split",
    "steps_of_period",
]
