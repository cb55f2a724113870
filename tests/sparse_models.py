"""Sparse finite-element models with known frequencies: beams, moving or not, and a square plate."""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.sparse as sp

from periodic import SparseSystem
from periodic.checks import FloatArray


def _assembled(element: FloatArray, elements: int) -> Any:
    """The matrix of a chain of cubic elements that is held at both ends, two coordinates a node."""
    i = np.broadcast_to(2 * np.arange(elements)[:, None, None] + np.arange(4)[:, None], (elements, 4, 4))
    values = np.broadcast_to(element, (elements, 4, 4)).ravel()
    whole = sp.coo_array((values, (i.ravel(), i.transpose(0, 2, 1).ravel()))).tocsr()
    free = np.setdiff1d(np.arange(2 * elements + 2), [0, 2 * elements])
    return whole[free][:, free]


def hermite(elements: int) -> dict[str, Any]:
    """(u, v), (u', v'), (u'', v'') and (u, v') over a unit length, u = 0 at its ends."""
    h = 1.0 / elements
    l = np.outer([1, h, 1, h], [1, h, 1, h])
    mass = h / 420 * l * np.array([[156, 22, 54, -13], [22, 4, 13, -3], [54, 13, 156, -22], [-13, -3, -22, 4]])
    slope = l / (30 * h) * np.array([[36, 3, -36, 3], [3, 4, -3, -1], [-36, -3, 36, -3], [3, -1, -3, 4]])
    bend = l / h**3 * np.array([[12, 6, -12, 6], [6, 4, -6, 2], [-12, -6, 12, -6], [6, 2, -6, 4]])
    moved = l / 60 * np.array([[-30, 6, 30, -6], [-6, 0, 6, -1], [-30, -6, 30, 6], [6, 1, -6, 0]])
    parts = {"mass": mass, "slope": slope, "bend": bend, "moved": moved}
    return {name: _assembled(element, elements) for name, element in parts.items()}


def moving_beam(elements: int, speed: float, *, uneven: bool = True) -> SparseSystem:
    """A tensioned beam, flexural rigidity 0.64; the tension pulsates, on the first half alone if ``uneven``."""
    part = hermite(elements)
    M, S, B, T = part["mass"], part["slope"], part["bend"], part["moved"]
    half = sp.diags_array(np.where(np.arange(M.shape[0]) < elements, 1.0, 0.0))
    excited = (S @ half + half @ S) / 2 if uneven else S
    gyroscopic = speed * (T - T.T) if speed else None
    return SparseSystem(M, gyroscopic, stiffness=0.64 * B + (1 - speed**2) * S, cosine=excited)


def square_plate(elements: int) -> SparseSystem:
    """A simply supported square plate: omega = pi^2 (m^2 + k^2), in pairs; N_xx pulsates, more in the middle."""
    part = hermite(elements)
    M, S, B = part["mass"], part["slope"], part["bend"]
    n = M.shape[0]
    load = sp.diags_array(np.sin(np.pi * (np.arange(n) + 0.5) / n))
    uneven = (M @ load + load @ M) / 2
    return SparseSystem(
        sp.kron(M, M).tocsr(),
        stiffness=(sp.kron(B, M) + 2 * sp.kron(S, S) + sp.kron(M, B)).tocsr(),
        cosine=sp.kron(S, uneven).tocsr(),
    )
