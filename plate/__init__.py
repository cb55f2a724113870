"""The axially moving plate of Young, Huang and Chiu: from its parameters to the matrices of eq. (11), section II.

`MovingPlate` holds the parameters, `EdgeLoad` says how the tension is spread over the edge and varies in time. Handed a
frequency, a plate returns its `periodic.PeriodicSystem`, which theory and integration take alike:

>>> from plate import EdgeLoad, MovingPlate
>>> plate = MovingPlate(aspect_ratio=1.0, speed=3.0, tension=10.0, inplane="static", load=EdgeLoad.partial(0.5))
>>> system = plate.at(30.0)
>>> system.size, system.harmonics
(28, 1)
>>> print(f"diverges at V = {plate.critical_speed():.3f}")
diverges at V = 4.343

With ``speed_amplitude`` the speed pulsates, with ``load_amplitude=0`` the load does not:

>>> web = MovingPlate(speed=3.0, tension=10.0, speed_amplitude=1.0, load_amplitude=0.0)
>>> [(term.of, term.power) for term in web.at(30.0).terms]
[('gyroscopic', 1), ('stiffness', 2), ('stiffness', 2)]

On the way from load to matrices the in-plane stress is found by one of three models (``inplane``). It can be looked at:

>>> field = plate.stress(Omega=0.0, harmonic=0, x=[0.0, 0.5], y=[0.1, 0.5])
>>> print(field.N_xx.real.round(3))  # rows follow y: the load has begun to spread at mid-span
[[ 0.     6.068]
 [20.    14.596]]

How the files work together, in the order of the derivation:

- `distribution`, `loads`: f(y, t) at the edges, eqs. (7) and (29);
- `inplane`, `levy`, `dynamic`, `stress`: the in-plane problem (2a, b), (5)-(8), and the three models of the stress;
- `basis`, `transverse`: trial functions (6), (9) and the matrices of eqs. (10), (11), and what
  a pulsating speed adds to them;
- `divergence`: the speed at which the stiffness becomes singular;
- `terms`: how many trial functions, by aspect ratio unless given;
- `moving_plate`, `si`, `checks`: the plate, its units and the checks of its arguments.
"""

from plate.distribution import Distribution
from plate.dynamic import InPlaneGrowthWarning, InPlaneResonanceWarning
from plate.inplane import InPlaneFrequencies, StressField
from plate.loads import WAVEFORMS, EdgeLoad
from plate.moving_plate import MovingPlate
from plate.si import SoftMaterialWarning
from plate.terms import Terms
from plate.transverse import deflection

__all__ = [
    "WAVEFORMS",
    "Distribution",
    "EdgeLoad",
    "InPlaneFrequencies",
    "InPlaneGrowthWarning",
    "InPlaneResonanceWarning",
    "MovingPlate",
    "SoftMaterialWarning",
    "StressField",
    "Terms",
    "deflection",
]
