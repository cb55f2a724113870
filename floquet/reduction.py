"""From a `PeriodicSystem` to what the single-point integrator works on: decoupled blocks in energy coordinates."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy.linalg as sla
from numpy.typing import NDArray
from scipy.sparse.csgraph import connected_components

from floquet.taylor import Block
from periodic import PeriodicSystem
from periodic.checks import FloatArray

# Couplings and asymmetries below this part of the largest entry of their matrix are rounding errors of its assembly.
# What is dropped is charged to the error estimate.
ROUNDING = 1e-14


class Reduction(NamedTuple):
    """One decoupled block of m coordinates; `floquet.taylor` has its equations in y = (y1, y2).

    Attributes
    ----------
    coordinates : ndarray of int, shape (m,)
        The coordinates of the system that form the block.
    to_q, from_q : ndarray, shape (2m, 2m)
        q = to_q @ y and y = from_q @ q, where q = (W', W) of the block, eq. (13).
    equations : Block
        Coefficients.
    rate : float
        Bound on the norm of the coefficient matrix at any time: no free motion is faster.
    neglected : float
        Norm of all couplings and asymmetries dropped, as a coefficient matrix of y, per unit of time.
    reciprocal : bool
        True if with mu also 1/conj(mu) is a multiplier: the block is conservative or reversible.
    form : ndarray, shape (2m, 2m), or None
        For a conservative block the skew-symmetric form that its motion conserves.
    """

    coordinates: NDArray[np.intp]
    to_q: FloatArray
    from_q: FloatArray
    equations: Block
    rate: float
    neglected: float
    reciprocal: bool
    form: FloatArray | None


def reduce_system(system: PeriodicSystem, eps: float, slowest: float) -> list[Reduction]:
    """Split ``system`` at amplitude ``eps`` into blocks and write each in energy coordinates.

    With modes of the symmetric part of the stiffness, mass-normalised, W = modes @ (y1 / w) and W' = modes @ y2. The
    scales w are the square roots of the moduli of the eigenvalues: a conservative motion is nearly a rotation of
    (y1, y2), and the monodromy matrix as well-conditioned as can be. ``slowest`` > 0 is the scale of coordinates that
    have less stiffness than that.
    """
    constant = np.array([system.mass, system.gyroscopic, system.damping, system.stiffness])
    matrices = np.concatenate([constant, eps * system.cosine, eps * system.sine])
    scale = 1 / np.sqrt(np.diag(system.mass))
    label = _components(scale[:, None] * matrices * scale)
    blocks = [np.flatnonzero(label == b) for b in range(label.max() + 1)]
    reduced = [_reduce(matrices[:, index[:, None], index], index, slowest) for index in blocks]
    if len(blocks) == 1:
        return reduced
    neglected = _neglected(matrices, reduced, label)
    return [block._replace(neglected=block.neglected + neglected) for block in reduced]


def constant_matrix(equations: Block) -> FloatArray:
    """Return the matrix A (2m, 2m) of y' = A y without excitation."""
    B, D = _parts(equations)
    stiffness = np.diag(equations.k) + np.tensordot(equations.alpha[:, 0], B, 1)
    return np.block([[np.zeros_like(D), np.diag(equations.w)], [-stiffness, -D]])


def modulation(equations: Block) -> float:
    """Return a bound on the relative change of stiffness by the excitation (spectral norm in energy coordinates)."""
    B, _ = _parts(equations)
    sizes = np.linalg.norm(B / equations.w[:, None], 2, axis=(1, 2))
    return float(sizes @ np.hypot(equations.alpha, equations.beta)[:, 1:].sum(axis=1))


def _parts(equations: Block) -> tuple[FloatArray, FloatArray]:
    """Return B (R, m, m) and D (m, m)."""
    m, functions = len(equations.w), len(equations.alpha)
    parts = equations.S.reshape(m, -1, m).transpose(1, 0, 2)
    return parts[:functions], parts[functions:].sum(axis=0)


def _components(matrices: FloatArray) -> NDArray[np.intp]:
    """Number the sets of coordinates that none of ``matrices`` (p, n, n) couples; return the set of each coordinate."""
    sizes = np.abs(matrices)
    coupled = (sizes > ROUNDING * sizes.max(axis=(1, 2), keepdims=True)).any(axis=0)
    _, label = connected_components(coupled, directed=False)
    return np.asarray(label, dtype=np.intp)


def _neglected(matrices: FloatArray, blocks: list[Reduction], label: NDArray[np.intp]) -> float:
    """Return the norm of the coefficients between different blocks, in energy coordinates."""
    n = len(label)
    modes, w, k = np.zeros((n, n)), np.empty(n), np.empty(n)
    for block in blocks:
        m = len(block.coordinates)
        modes[np.ix_(block.coordinates, block.coordinates)] = block.to_q[:m, m:]
        w[block.coordinates], k[block.coordinates] = block.equations.w, block.equations.k * block.equations.w
    M, G, C, *stiffness = np.where(label[:, None] == label, 0.0, modes.T @ matrices @ modes)
    # a coupling of mass acts through the acceleration, -k y1 / w
    forces = [M * k, *stiffness]
    return float(np.linalg.norm(G) + np.linalg.norm(C) + sum(np.linalg.norm(force / w) for force in forces))


def _reduce(matrices: FloatArray, index: NDArray[np.intp], slowest: float) -> Reduction:
    M, G, C = matrices[:3]
    forces = matrices[3:]  # K, eps F_c1 ... eps F_sJ
    skew = (forces - forces.transpose(0, 2, 1)) / 2
    symmetric = bool((np.abs(skew).max(axis=(1, 2)) <= ROUNDING * np.abs(forces).max(axis=(1, 2))).all())
    K = forces[0] - skew[0]
    _, modes = sla.eigh(K, M)
    # Rayleigh quotients: eigh gives every eigenvalue to rounding of the largest, these are good to their own rounding
    k = np.einsum("ij,ij->j", modes, K @ modes) / np.einsum("ij,ij->j", modes, M @ modes)
    w = np.maximum(np.sqrt(np.abs(k)), slowest)
    damping = modes.T @ (G + C) @ modes
    asymmetry = modes.T @ skew @ modes / w
    excitation = modes.T @ forces[1:] @ modes / w
    if symmetric:
        excitation -= asymmetry[1:]
    alpha, beta, B = _forcing(np.zeros_like(asymmetry[0]) if symmetric else asymmetry[0], excitation)
    damped = bool(damping.any())
    S = np.ascontiguousarray(np.concatenate([*B, damping][: len(B) + damped], axis=1))
    equations = Block(w, k / w, S, damped, alpha, beta)
    sines = forces[1 + len(excitation) // 2 :]
    m = len(index)
    zero, inverse = np.zeros((m, m)), modes.T @ M
    return Reduction(
        index,
        to_q=np.block([[zero, modes], [modes / w, zero]]),
        from_q=np.block([[zero, w[:, None] * inverse], [inverse, zero]]),
        equations=equations,
        rate=_rate(equations),
        neglected=float(np.linalg.norm(asymmetry, axis=(1, 2)).sum()) if symmetric else 0.0,
        reciprocal=not C.any() and (symmetric or not (G.any() or sines.any())),
        form=_symplectic_form(w, damping) if symmetric and not C.any() else None,
    )


def _symplectic_form(w: FloatArray, gyroscopic: FloatArray) -> FloatArray:
    """Return dx ^ dp in terms of y, where x = y1 / w and p = x' + G x / 2: conserved by x'' + G x' + S(t) x = 0."""
    inverse = np.diag(1 / w)
    return np.block([[gyroscopic / np.outer(w, w), inverse], [-inverse, np.zeros_like(inverse)]])


def _forcing(constant: FloatArray, excitation: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return alpha, beta (R, J + 1) and B (R, m, m) of `floquet.taylor` from F_c1 ... F_cJ, F_s1 ... F_sJ.

    The harmonics of an excitation often share one distribution in space. R, the number of matrix products that a term
    of the Taylor series costs, is therefore the rank of the span of the matrices, not their number.
    """
    J, m = len(excitation) // 2, len(constant)
    weights, sizes, basis = np.linalg.svd(excitation.reshape(2 * J, m * m), full_matrices=False)
    rank = int((sizes > np.finfo(float).eps * sizes[0]).sum())
    factors = (weights * sizes)[:, :rank].T
    alpha, beta = np.zeros((rank, J + 1)), np.zeros((rank, J + 1))
    alpha[:, 1:], beta[:, 1:] = factors[:, :J], factors[:, J:]
    B = basis[:rank].reshape(rank, m, m)
    if constant.any():  # unsymmetric stiffness: a function of time that happens to be constant
        alpha = np.vstack([np.eye(1, J + 1), alpha])
        beta = np.vstack([np.zeros((1, J + 1)), beta])
        B = np.concatenate([constant[None], B])
    return alpha, beta, B


def _rate(equations: Block) -> float:
    """Return a bound on the norm of the coefficient matrix, in the better of two scalings."""
    B, D = _parts(equations)
    sizes = np.linalg.norm(B, 2, axis=(1, 2))
    forcing = float(sizes @ np.hypot(equations.alpha, equations.beta).sum(axis=1))
    damping = float(np.linalg.norm(D, 2))
    w, k = equations.w.max(), np.abs(equations.k).max()
    as_it_is = max(w, k + forcing)
    rescaled = np.sqrt(w * (k + forcing))
    return float(min(as_it_is, rescaled)) + damping
