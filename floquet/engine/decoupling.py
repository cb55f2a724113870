"""Independent subsystems: coordinates in which all matrices of a system fall into the same diagonal subsystems."""

from __future__ import annotations

import numpy as np
import scipy.linalg as sla
from scipy.sparse.csgraph import connected_components

from periodic.checks import FloatArray

# Couplings below this part of the norm of their matrix are rounding: the eigenvectors below are good to about 1e-13.
COUPLING = 1e-11
# Two eigenvalues of one random combination may be so close by chance that their vectors mix; of two hardly.
COMBINATIONS = 2


def invariant_subspaces(matrices: FloatArray) -> list[FloatArray]:
    """Return orthonormal bases (n, b) of subspaces that all ``matrices`` (p, n, n) and their transposes leave
    invariant.

    If such subspaces exist, every symmetric combination of the matrices respects them. The eigenvectors of a random
    one do not mix them, since its eigenvalues are distinct with probability one; which eigenvectors belong together is
    read off the matrices in this basis. A symmetric load, for instance, leaves even and odd shapes apart.
    (Subsystems that occur twice share eigenvalues and are left together: correct, only slower.)

    Their order depends on the subspaces alone, so that a subsystem of a family has the same place at every frequency.
    """
    sizes = np.linalg.norm(matrices, axis=(1, 2))
    scaled = matrices[sizes > 0] / sizes[sizes > 0, None, None]
    if len(scaled) == 0:
        return [basis[:, None] for basis in np.eye(matrices.shape[1])]
    symmetric = (scaled + scaled.transpose(0, 2, 1)) / 2
    skew = (scaled - scaled.transpose(0, 2, 1)) / 2
    candidates = np.concatenate([symmetric, skew.transpose(0, 2, 1) @ skew])
    found: list[FloatArray] = []
    random = np.random.default_rng(0)
    direction = random.standard_normal(matrices.shape[1])
    for weights in random.uniform(0.5, 1.5, (COMBINATIONS, len(candidates))):
        _, X = sla.eigh(np.tensordot(weights, candidates, 1))
        coupled = (np.abs(X.T @ scaled @ X) > COUPLING).any(axis=0)
        count, label = connected_components(coupled, directed=False)
        if count > len(found):
            found = [np.ascontiguousarray(X[:, label == i]) for i in range(count)]
    return sorted(found, key=lambda basis: float(np.linalg.norm(direction @ basis)))
