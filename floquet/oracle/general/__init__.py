"""Any linear periodic system, E(t) y' = A(t) y, over one period.

`splitting` takes a system apart into independent subsystems, each in coordinates that suit it; `coefficients` has E and
A as functions of time. `period` takes a subsystem over a period, from jump to jump: by Taylor series (`series`), and by
exponentials where all is constant.

>>> from floquet.oracle.general import passage, split
>>> from periodic import FirstOrderSystem, Term, waveforms
>>> system = FirstOrderSystem([[-1.0]], terms=[Term("state", [[1.0]], waveforms.sawtooth(), power=2)])
>>> (subsystem,), _ = split(system, Omega=2.0, eps=0.5)
>>> found = passage(subsystem, Omega=2.0, eps=0.5, tolerance=1e-11)
>>> [round(float(x), 9) for x in found.map.matrix.ravel()]  # the mean of a sawtooth is zero: exp(-pi)
[0.043213918]
"""

from floquet.oracle.general.period import (
    Parts,
    Passage,
    factors_between,
    largest_rate,
    multipliers_of,
    passage,
    period_matrix,
)
from floquet.oracle.general.splitting import GeneralSubsystem, Split, split

__all__ = [
    "GeneralSubsystem",
    "Parts",
    "Passage",
    "Split",
    "factors_between",
    "largest_rate",
    "multipliers_of",
    "passage",
    "period_matrix",
    "split",
]
