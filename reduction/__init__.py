"""Large models in their lowest modes: finite elements of 10⁵ coordinates become a system of a few dozen.

>>> import numpy as np
>>> import scipy.sparse as sp
>>> from periodic import SparseSystem
>>> from reduction import reduce_model
>>> n, h = 2000, 1 / 2001
>>> stiffness = sp.diags_array([-1.0, 2.0, -1.0], offsets=[-1, 0, 1], shape=(n, n)) / h
>>> foundation = h * sp.diags_array(np.linspace(0, 1, n))
>>> chain = SparseSystem(mass=h * sp.eye_array(n), stiffness=stiffness, cosine=foundation)
>>> model = reduce_model(chain, Omega_range=(3.0, 14.0))
>>> print(model)
ReducedModel(35 of 2000 modes, natural frequencies 3.14159 to 109.942)

A reduced model is a family like any other: charts, boundaries and theory take it as it is. How far the modes that were
left out can move an edge has a bound, of second order in eps:

>>> model.change(eps=1.0) < 1e-6
True

How the files work together: `factor` solves with a sparse symmetric matrix and counts its negative eigenvalues; `modes`
counts the lowest modes by them, and finds so many by shift-invert; `reduced` is the model and the
bound.
"""

from reduction.reduced import FREQUENCY_POWER, ReducedModel, first_modes, reduce_model

__all__ = ["FREQUENCY_POWER", "ReducedModel", "first_modes", "reduce_model"]
