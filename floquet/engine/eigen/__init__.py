"""Eigenvalues of sixteen small matrices at once.

LAPACK spends most of its time on small matrices with overheads. Here each SIMD lane holds a matrix of its own
(`lanes`). A general matrix goes through Householder reflections (`reflections`) and Francis QR (`hessenberg`). A
symplectic matrix is reduced to half its size first, and its multipliers come as sums mu + 1/mu (`symplectic`). Matrices
are given as combinations of samples, sixteen sets of weights at a time.

>>> import numpy as np
>>> from floquet.engine.eigen import LANE_COUNT, eigenvalues, reciprocal_sums
>>> samples = np.array([[[0.0, 1.0], [-1.0, 0.0]], np.eye(2)])
>>> weights = np.stack([np.ones(LANE_COUNT), np.arange(LANE_COUNT)])[None]
>>> eigenvalues(samples, weights)[:2].tolist()  # of samples[0] and of samples[0] + samples[1]
[[1j, -1j], [(1+1j), (1-1j)]]
>>> reciprocal_sums(samples[:1], weights[:, :1])[0].tolist()
[0j]
"""

from floquet.engine.eigen.hessenberg import UNIT_ROUNDOFF, eigenvalues
from floquet.engine.eigen.lanes import (
    LANE_COUNT,
    MAX_LANE_ROW,
    broadcast,
    fma,
    load,
    load_row,
    pick_le,
    square_root,
    store,
    store_row,
)
from floquet.engine.eigen.symplectic import reciprocal_pairs, reciprocal_sums

__all__ = [
    "LANE_COUNT",
    "MAX_LANE_ROW",
    "UNIT_ROUNDOFF",
    "broadcast",
    "eigenvalues",
    "fma",
    "load",
    "load_row",
    "pick_le",
    "reciprocal_pairs",
    "reciprocal_sums",
    "square_root",
    "store",
    "store_row",
]
