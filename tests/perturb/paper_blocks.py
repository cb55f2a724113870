"""Eqs. (17), (18) and (26)-(28) by the paper's own 2 x 2 blocks: the other way to what `perturb.coupling` computes."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from periodic import PeriodicSystem
from periodic.checks import FloatArray
from perturb import GyroscopicModes
from perturb.coupling import Coupling


class ModalBlocks(NamedTuple):
    """Matrices of eq. (17) by 2 x 2 blocks: [..., n, m, r, s] holds the paper's c_{nm}^{rs} (all counted from 0)."""

    C: FloatArray  # (n, n, 2, 2), of the damping matrix
    G: FloatArray  # (J, n, n, 2, 2), of the cosine harmonics
    H: FloatArray  # (J, n, n, 2, 2), of the sine harmonics


def modal_blocks(system: PeriodicSystem, modes: GyroscopicModes) -> ModalBlocks:
    """Return the matrices C, G and H of eqs. (17), (18) for the matrices of ``system``, in the basis P of ``modes``.

    C belongs to the damping matrix as it stands (c K_oe) and G, H to the harmonics as they stand (f0 F_cj, f0 F_sj).
    """
    P = modes.modal_matrix
    n = len(P) // 2
    velocity, displacement = P[:n], P[n:]

    def blocks(matrix: FloatArray) -> FloatArray:
        shape = (*matrix.shape[:-2], n, 2, n, 2)
        return np.swapaxes(matrix.reshape(shape), -3, -2)

    return ModalBlocks(
        C=blocks(velocity.T @ system.damping @ velocity),  # eq. (17)
        G=blocks(velocity.T @ system.cosine @ displacement),
        H=blocks(velocity.T @ system.sine @ displacement),
    )


def block_form(blocks: ModalBlocks, j: int, type: str) -> Coupling:
    """Return Lambda_pq and its partner from the blocks of eq. (18), as the paper has them.

    Sums: eqs. (26b), (26c). Differences: eq. (28a), and eq. (28b) with - g^11 in place of its first - g^12.
    """
    g, h = blocks.G[j - 1], blocks.H[j - 1]
    g11, g12, g21, g22 = (g[..., r, s] for r in (0, 1) for s in (0, 1))
    h11, h12, h21, h22 = (h[..., r, s] for r in (0, 1) for s in (0, 1))
    if type == "sum":
        forward = 0.5 * (h21 - 1j * h22 + 1j * g21 + g22 + 1j * h11 + h12 - g11 + 1j * g12)  # eq. (26b)
        backward = 0.5 * (h21 + 1j * h22 - 1j * g21 + g22 - 1j * h11 + h12 - g11 - 1j * g12)  # eq. (26c)
    else:
        forward = 0.5 * (h21 + 1j * h22 + 1j * g21 - g22 + 1j * h11 - h12 - g11 - 1j * g12)  # eq. (28a)
        backward = 0.5 * (-h21 - 1j * h22 + 1j * g21 - g22 - 1j * h11 + h12 - g11 - 1j * g12)  # eq. (28b), corrected
    return Coupling(forward, backward.T)
