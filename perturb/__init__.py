"""Multiple scales: analytic transition curves of a `periodic.PeriodicSystem`, without integration.

The modes of the system without damping and excitation come first (eqs. (13)-(18)):

>>> from periodic.examples import coupled_mathieu
>>> from perturb import gyroscopic_modes, transition_curves
>>> system = coupled_mathieu(frequencies=(1.0, 1.7), damping=(0.01, 0.01))
>>> gyroscopic_modes(system).frequencies.tolist()
[1.0, 1.7]

Each resonance j Omega = omega_p ± omega_q of these modes has a `TransitionCurve`. It knows where its region of
instability starts, from which eps on it is open, and its edges and growth rates (eqs. (24)-(28)):

>>> for curve in transition_curves(system, Omega_range=(2.0, 3.0), types=("sum",)):
...     print(f"{curve.label} at {curve.centre:.2f}, open from eps = {curve.tip:.3f} on")
2ω₁ at 2.00, open from eps = inf on
ω₁+ω₂ at 2.70, open from eps = 0.026 on
>>> lower, upper = curve.edges(0.1)
>>> print(f"{lower:.3f} to {upper:.3f}")
2.663 to 2.737

How the modules work together:

- `modes` gives the frequencies omega_n, the vectors w_n and the decay of the modes;
- `resonance` lists the resonances of a frequency range, `campbell` those of modes that depend on Omega;
- `coupling` says how strongly the excitation couples two modes, and `pair` solves the two amplitude equations in closed
  form; `resonant_pair` puts them together as the first-order theory of one resonance;
- `expansion` writes the equations in the modal basis, `effective_matrix` reduces them to the few states that resonate
  together, to first or second order in eps, `intervals` finds where these states are unstable, and `resonant_states`
  makes the theory of a resonance of it;
- `transition` chooses between the two, and `curve` is what it returns;
- `general` has the same for any linear periodic system, and harmonic balance.
"""

from perturb.curve import TransitionCurve
from perturb.modes import GyroscopicModes, gyroscopic_modes
from perturb.resonance import Resonance
from perturb.transition import transition_curves

__all__ = ["GyroscopicModes", "Resonance", "TransitionCurve", "gyroscopic_modes", "transition_curves"]
