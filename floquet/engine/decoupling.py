"""Independent subsystems: coordinates in which all matrices of a system have the same diagonal blocks."""

from __future__ import annotations

import numpy as np
import scipy.linalg as sla
from scipy.sparse.csgraph import connected_components

from periodic.checks import FloatArray

# Coupling that counts as rounding, as a part of the norm of its matrix: the eigenvectors below are good to about 1e-13.
COUPLING_TOLERANCE = 1e-11
# Random combinations that are tried: two eigenvalues of one may be so close by chance that their vectors mix.
RANDOM_COMBINATIONS = 2


def invariant_subspaces(matrices: FloatArray) -> list[FloatArray]:
    """Return orthonormal bases (n, b) of the subspaces that all ``matrices`` (p, n, n) and their transposes keep.

    If there are such subspaces, every symmetric combination of the matrices keeps them. A random combination has
    distinct eigenvalues with probability one, and so its eigenvectors do not mix the subspaces. The matrices in the
    basis of these eigenvectors show which of them belong together. A symmetric load, for instance, keeps even and odd
    shapes apart. (Subsystems that occur twice share eigenvalues and stay together: correct, only slower.)

    The order depends on the subspaces alone, so that a subsystem of a family has the same place at every frequency.
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
    for weights in random.uniform(0.5, 1.5, (RANDOM_COMBINATIONS, len(candidates))):
        _, X = sla.eigh(np.tensordot(weights, candidates, 1))
        coupled = (np.abs(X.T @ scaled @ X) > COUPLING_TOLERANCE).any(axis=0)
        count, label = connected_components(coupled, directed=False)
        if count > len(found):
            found = [np.ascontiguousarray(X[:, label == i]) for i in range(count)]
    return sorted(found, key=lambda basis: float(np.linalg.norm(direction @ basis)))
