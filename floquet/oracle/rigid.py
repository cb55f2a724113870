"""Rigid motions: those that nothing restores, damps, turns or excites."""

from __future__ import annotations

import numpy as np

from periodic.checks import FloatArray

# A matrix that leaves of a motion less than this part, row by row, does not act on it: the rest is rounding of its
# assembly.
RIGID_ROUNDING = 1e-14


def rigid_motions(matrices: FloatArray) -> FloatArray:
    """Return the rigid motions of a system.

    Parameters
    ----------
    matrices : ndarray, shape (p, n, n)
        M, G, C, K and the matrices of the excitation.

    Returns
    -------
    ndarray, shape (n, r)
        R with R^T M R = I. G, C, K, the excitation and their transposes times R are zero but for rounding: motions
        W = R a have a'' = 0, and are neither driven by others nor drive them.
    """
    mass, gyroscopic, damping, stiffness, *excitation = matrices
    scale = 1 / np.sqrt(np.diag(mass))  # brings coordinates of any units to one mass
    # the stiffness first: few systems have a motion that it leaves alone
    acting = [S for S in (stiffness, gyroscopic, damping, *excitation) if S.any()]
    scaled = [scale[:, None] * one * scale for S in acting for one in (S, S.T)]
    space = np.eye(len(mass))
    for S in scaled:
        _, sizes, directions = np.linalg.svd(S @ space)
        still = sizes <= len(mass) * RIGID_ROUNDING * np.abs(S).max()
        space = space @ directions[still].T
        if not still.any():
            return space
    # a graded matrix may be small on a motion that it restores all the same: each row has to vanish by its own measure
    exact = np.ones(space.shape[1], dtype=bool)
    for S in scaled:
        exact &= (np.abs(S @ space) <= RIGID_ROUNDING * np.abs(S).sum(axis=1, keepdims=True)).all(axis=0)
    motions = scale[:, None] * space[:, exact]
    return np.asarray(motions @ np.linalg.inv(np.linalg.cholesky(motions.T @ mass @ motions)).T)
