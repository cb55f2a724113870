"""Multiple scales and harmonic balance for any linear periodic system.

`perturb.transition_curves` comes here with whatever is not of the form of eq. (11): periodic mass, damping and
gyroscopic matrices, powers of eps, unsymmetric or indefinite stiffness, damping that feeds energy, first order. It is
expanded about the eigenvectors of its constant part:

>>> from periodic import PeriodicSystem, Term, waveforms
>>> from perturb import transition_curves
>>> pulsating = Term("damping", [[1.0]], waveforms.cosine())
>>> system = PeriodicSystem([[1.0]], damping=[[0.02]], stiffness=[[1.0]], terms=[pulsating])
>>> (curve,) = transition_curves(system, (1.5, 2.5))
>>> print(f"{curve.label} at {curve.centre:.4f}, open from eps = {curve.tip:.3f} on")
2ω₁ at 1.9999, open from eps = 0.040 on

Harmonic balance expands nothing in eps. It gives the amplitudes at which a multiplier is +1 or -1, and exponents:

>>> from perturb.general import balanced_amplitudes, balanced_exponents
>>> print(f"{balanced_amplitudes(system, 2.0, multiplier=-1, eps_max=0.5).eps[0]:.4f}")
0.0400
>>> print(f"{balanced_exponents(system, 2.0, eps=0.1).growth_rate:.4f}")
0.0150

Where a system is unstable by itself, second order says how excitation stabilises it. A pivot that shakes with the
acceleration eps holds up an inverted pendulum, x'' + (- 1 + eps cos Omega t) x = 0, while Omega is below eps / sqrt(2):

>>> from perturb.general import stable_windows
>>> inverted = PeriodicSystem([[1.0]], stiffness=[[-1.0]], cosine=[[1.0]])
>>> [window] = stable_windows(inverted, (15.0, 40.0), eps=32.0)
>>> print(f"up to {window.upper:.1f}")
up to 22.5

- `blocks` has the first-order form by powers of eps and harmonics, `eigenstates` its right and left eigenvectors;
- `equations` is Hill's infinite matrix in these states, `resonances` lists what resonates;
- `resonant_states` makes the theory of one resonance, to first or second order, with the machinery of `perturb`
  (`effective_matrix`, `intervals`, `resonant_states`), and `curves` puts all of it together;
- `windows` finds where excitation stabilises what is unstable without it, to second order;
- `harmonic_balance` has Bolotin's and Hill's determinants.
"""

from perturb.general.curves import general_transition_curves
from perturb.general.harmonic_balance import (
    BalancedAmplitudes,
    BalancedExponents,
    balanced_amplitudes,
    balanced_exponents,
)
from perturb.general.windows import StableWindow, second_order_growth, stable_windows

__all__ = [
    "BalancedAmplitudes",
    "BalancedExponents",
    "StableWindow",
    "balanced_amplitudes",
    "balanced_exponents",
    "general_transition_curves",
    "second_order_growth",
    "stable_windows",
]
