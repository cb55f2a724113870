"""Multiple scales and harmonic balance for any linear periodic system: x' = A(Omega t, eps) x.

`perturb.transition_curves` comes here with whatever is not of the form of eq. (11): periodic mass, damping and
gyroscopic matrices, powers of eps, unsymmetric or indefinite stiffness, damping that feeds energy, first order.

- `blocks` has the first-order form by powers of eps and harmonics, `eigenstates` its right and left eigenvectors;
- `equations` is Hill's infinite matrix in these states, `resonances` lists what resonates;
- `resonant_states` makes the theory of one resonance, to first or second order, with the machinery of `perturb`
  (`effective_matrix`, `intervals`, `resonant_states`), and `curves` puts all of it together.
"""

from perturb.general.curves import general_transition_curves

__all__ = ["general_transition_curves"]
