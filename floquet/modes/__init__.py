"""How a periodic system moves at one point: exponents, periodic modes, response, sensitivities, modes along a line.

>>> from floquet.modes import floquet_modes
>>> from periodic.examples import mathieu
>>> modes = floquet_modes(mathieu(), Omega=2.0, eps=0.1)
>>> growing = modes[0]
>>> print(f"{growing.growth_rate:.6f} at frequency {growing.frequency:.3f}")
0.024993 at frequency 1.000
>>> [(round(frequency, 6), round(share, 4)) for frequency, share in growing.strongest(2)]
[(1.0, 0.5), (-1.0, 0.5)]

How the files work together: `places` are phases of a period; `solutions` are the oracle's Floquet solutions there;
`modes` makes a
`mode` of each, with the name of its branch; `response` has what finite runs show; `parametric` is a system as a
function of a parameter, along which `line` follows modes and with respect to which `sensitivity` differentiates them.
"""

from floquet.modes.line import ModeLine, follow_modes
from floquet.modes.mode import FloquetMode
from floquet.modes.modes import FloquetModes, floquet_modes
from floquet.modes.response import Response, TransientGrowth
from floquet.modes.sensitivity import Sensitivities, edge_sensitivity, exponent_sensitivities, tip_sensitivity

__all__ = [
    "FloquetMode",
    "FloquetModes",
    "ModeLine",
    "Response",
    "Sensitivities",
    "TransientGrowth",
    "edge_sensitivity",
    "exponent_sensitivities",
    "floquet_modes",
    "follow_modes",
    "tip_sensitivity",
]
