"""From a `PeriodicSystem` to what the single-point integrator works on: decoupled subsystems in energy coordinates."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy.linalg as sla
from numpy.typing import NDArray
from scipy.sparse.csgraph import connected_components

from floquet.oracle.rigid import rigid_motions
from floquet.oracle.taylor import MAX_SOLUTION, Equations
from periodic import PeriodicSystem, stiffness_alone
from periodic.checks import FloatArray

# Couplings and asymmetries below this part of the largest entry of their matrix are rounding errors of its assembly.
# They are dropped, and charged to the error estimate.
COUPLING_ROUNDING = 1e-14
# A hidden symmetry is used if the couplings that it leaves are below this part of the rate of motion, in energy
# coordinates. Dropping them then costs little more than rounding does anyway.
MAX_SPLIT_COUPLING = 1e-14


class Subsystem(NamedTuple):
    """One decoupled subsystem of m coordinates; `floquet.oracle.taylor` has its equations in y = (y1, y2).

    Attributes
    ----------
    to_q : ndarray, shape (2n, 2m)
        The subsystem contributes to_q @ y to q = (W', W) of eq. (13).
    from_q : ndarray, shape (2m, 2n)
        y = from_q @ q.
    equations : Equations
        Coefficients of the equations of motion of y.
    rate : float
        Bound on the norm of the coefficient matrix at any time, per unit of time: no free motion is faster.
    neglected : float
        Norm of all couplings and asymmetries dropped, as a coefficient matrix of y, per unit of time.
    reciprocal : bool
        True if with mu also 1/conj(mu) is a multiplier: the subsystem is conservative or reversible.
    bounded : bool
        True if the subsystem conserves a positive definite energy: conservative, not excited, with positive stiffness.
    form : ndarray, shape (2m, 2m), or None
        For a conservative subsystem the skew-symmetric form that its motion conserves.
    """

    to_q: FloatArray
    from_q: FloatArray
    equations: Equations
    rate: float
    neglected: float
    reciprocal: bool
    bounded: bool
    form: FloatArray | None


def reduce_system(system: PeriodicSystem, eps: float, slowest: float) -> list[Subsystem]:
    """Split ``system`` at amplitude ``eps`` into subsystems and write each in energy coordinates.

    Rigid motions (`rigid_basis`) are left out: nothing acts on them, and they act on nothing.

    The modes are those of the symmetric part of the stiffness, mass-normalised: W = modes @ (y1 / w), W' = modes @ y2.
    The scales w are the square roots of the moduli of the eigenvalues. A conservative motion is then nearly a rotation
    of (y1, y2), and the monodromy matrix as well-conditioned as can be.

    Parameters
    ----------
    system : PeriodicSystem
        The system.
    eps : float
        Excitation amplitude.
    slowest : float
        Scale w > 0 of coordinates without stiffness, a frequency.

    Returns
    -------
    list of Subsystem
        Empty if all motions are rigid.

    Raises
    ------
    ValueError
        If numbers are so large that their products would overflow.
    """
    matrices = _matrices(stiffness_alone(system), eps)
    scale = 1 / np.sqrt(np.diag(system.mass))
    with np.errstate(over="ignore", invalid="ignore"):
        to_unit_mass = scale[:, None] * matrices * scale
    if not (np.abs(to_unit_mass) <= MAX_SOLUTION).all():
        raise ValueError(
            f"mass, stiffness or excitation at eps = {eps!r}: per unit of mass, an entry exceeds {MAX_SOLUTION:.0e}; "
            "change the units or give a smaller eps"
        )
    uncoupled = coordinate_sets(to_unit_mass)
    # one and the same answer at every amplitude but 0: excitation of any strength couples what it couples
    reference = _matrices(system, 1.0) if eps else matrices
    separate = [basis for basis in (elastic_basis(reference, one) for one in uncoupled) if basis.size]
    if not separate:
        return []
    symmetric = [part for basis in separate for part in symmetry_parts(reference, basis)]
    if len(symmetric) > len(separate):
        judged = _reduce_all(reference, symmetric, slowest)
        if judged[0].neglected <= MAX_SPLIT_COUPLING * min(subsystem.rate for subsystem in judged):
            return judged if eps in (0.0, 1.0) else _reduce_all(matrices, symmetric, slowest)
    return _reduce_all(matrices, separate, slowest)


def rigid_basis(system: PeriodicSystem, eps: float) -> FloatArray:
    """Return the rigid motions of ``system`` at amplitude ``eps``: R (n, r) with R^T M R = I."""
    return rigid_motions(_matrices(stiffness_alone(system), eps))


def constant_matrix(equations: Equations) -> FloatArray:
    """Return the matrix A (2m, 2m) of y' = A y without excitation."""
    B, D = _parts(equations)
    stiffness = np.diag(equations.k) + np.tensordot(equations.alpha[:, 0], B, 1)
    return np.block([[np.zeros_like(D), np.diag(equations.w)], [-stiffness, -D]])


def modulation(equations: Equations) -> float:
    """Return a bound on the relative change of stiffness by the excitation (spectral norm in energy coordinates)."""
    B, _ = _parts(equations)
    sizes = np.linalg.norm(B / equations.w[:, None], 2, axis=(1, 2))
    return float(sizes @ np.hypot(equations.alpha, equations.beta)[:, 1:].sum(axis=1))


def _matrices(system: PeriodicSystem, eps: float) -> FloatArray:
    """Return M, G, C, K, eps F_c1 ... eps F_cJ, eps F_s1 ... eps F_sJ, shape (4 + 2 J, n, n)."""
    constant = np.array([system.mass, system.gyroscopic, system.damping, system.stiffness])
    return np.concatenate([constant, eps * system.cosine, eps * system.sine])


def coordinate_sets(matrices: FloatArray) -> list[FloatArray]:
    """Return the unit vectors (n, m) of each set of coordinates that ``matrices`` (p, n, n) leave uncoupled."""
    return _columns(np.eye(matrices.shape[1]), _components(matrices))


def elastic_basis(matrices: FloatArray, basis: FloatArray) -> FloatArray:
    """Return a basis (n, m - r) of the motions in the space of ``basis`` (n, m) that share no mass with rigid ones."""
    inside = basis.T @ matrices @ basis
    rigid = rigid_motions(inside)
    if not rigid.size:
        return basis
    scale = 1 / np.sqrt(np.diag(inside[0]))
    _, _, directions = np.linalg.svd((scale[:, None] * inside[0] @ rigid).T)
    return np.asarray(basis @ (scale[:, None] * directions[rigid.shape[1] :].T))


def _parts(equations: Equations) -> tuple[FloatArray, FloatArray]:
    """Return B (R, m, m) and D (m, m)."""
    m, functions = len(equations.w), len(equations.alpha)
    parts = equations.S.reshape(m, -1, m).transpose(1, 0, 2)
    return parts[:functions], parts[functions:].sum(axis=0)


def _components(matrices: FloatArray) -> NDArray[np.intp]:
    """Number the sets of coordinates that none of ``matrices`` (p, n, n) couples; return the set of each coordinate."""
    sizes = np.abs(matrices)
    coupled = (sizes > COUPLING_ROUNDING * sizes.max(axis=(1, 2), keepdims=True)).any(axis=0)
    _, label = connected_components(coupled, directed=False)
    return np.asarray(label, dtype=np.intp)


def _columns(basis: FloatArray, label: NDArray[np.intp]) -> list[FloatArray]:
    """Return the columns of ``basis`` of each label."""
    return [basis[:, label == c] for c in range(label.max() + 1)]


def symmetry_parts(matrices: FloatArray, basis: FloatArray) -> list[FloatArray]:
    """Split the space of ``basis`` (n, m) into parts that no matrix couples, whatever coordinates it is given in.

    Eigenvectors of any symmetric combination of the matrices span such parts, so a random combination is tried. The
    modes alone would not do: equal frequencies leave them undetermined.
    """
    if basis.shape[1] == 1:
        return [basis]
    M, *others = basis.T @ matrices @ basis
    weights = np.random.default_rng(0).uniform(1, 2, len(others))
    combination = sum(
        weight * (S + S.T) / np.abs(S).max() for weight, S in zip(weights, others, strict=True) if S.any()
    )
    found = basis @ sla.eigh(combination + np.zeros_like(M), M)[1]
    return _columns(found, _components(found.T @ matrices @ found))


def _reduce_all(matrices: FloatArray, bases: list[FloatArray], slowest: float) -> list[Subsystem]:
    """Return the subsystems of the given bases; each is charged with what all of them neglect."""
    subsystems = [_reduce(matrices, basis, slowest) for basis in bases]
    if len(subsystems) == 1:
        return subsystems
    n = len(matrices[0])
    modes = np.hstack([subsystem.to_q[:n, subsystem.to_q.shape[1] // 2 :] for subsystem in subsystems])
    w = np.concatenate([subsystem.equations.w for subsystem in subsystems])
    k = np.concatenate([subsystem.equations.k for subsystem in subsystems]) * w
    label = np.repeat(np.arange(len(subsystems)), [len(subsystem.equations.w) for subsystem in subsystems])
    M, G, C, *stiffness = np.where(label[:, None] == label, 0.0, modes.T @ matrices @ modes)
    # a coupling of mass acts through the acceleration, -k y1 / w
    forces = [M * k, *stiffness]
    neglected = np.linalg.norm(G) + np.linalg.norm(C) + sum(np.linalg.norm(force / w) for force in forces)
    return [subsystem._replace(neglected=subsystem.neglected + float(neglected)) for subsystem in subsystems]


def _reduce(matrices: FloatArray, basis: FloatArray, slowest: float) -> Subsystem:
    M, G, C, *_ = parts = basis.T @ matrices @ basis
    forces = parts[3:]  # K, eps F_c1 ... eps F_sJ
    skew = (forces - forces.transpose(0, 2, 1)) / 2
    symmetric = bool((np.abs(skew).max(axis=(1, 2)) <= COUPLING_ROUNDING * np.abs(forces).max(axis=(1, 2))).all())
    K = forces[0] - skew[0]
    _, modes = sla.eigh(K, M)
    # Rayleigh quotients: eigh gives every eigenvalue to rounding of the largest; for a graded stiffness, as of a Ritz
    # basis, these are good to their own rounding
    k = np.einsum("ij,ij->j", modes, K @ modes) / np.einsum("ij,ij->j", modes, M @ modes)
    conservative = symmetric and not C.any()
    damping = modes.T @ (G + C) @ modes
    asymmetry = modes.T @ skew @ modes
    excitation = modes.T @ forces[1:] @ modes
    w = driven_scales(k, excitation, slowest)
    asymmetry /= w
    excitation /= w
    if symmetric:
        excitation -= asymmetry[1:]
    alpha, beta, B = _forcing(np.zeros_like(asymmetry[0]) if symmetric else asymmetry[0], excitation)
    damped = bool(damping.any())
    S = np.ascontiguousarray(np.concatenate([*B, damping][: len(B) + damped], axis=1))
    equations = Equations(w, k / w, S, damped, alpha, beta)
    sines = forces[1 + len(excitation) // 2 :]
    shapes = basis @ modes
    inverse = shapes.T @ matrices[0]
    zero = np.zeros_like(shapes)
    return Subsystem(
        to_q=np.block([[zero, shapes], [shapes / w, zero]]),
        from_q=np.block([[zero.T, w[:, None] * inverse], [inverse, zero.T]]),
        equations=equations,
        rate=_rate(equations),
        neglected=float(np.linalg.norm(asymmetry, axis=(1, 2)).sum()) if symmetric else 0.0,
        reciprocal=conservative or not (C.any() or G.any() or sines.any()),
        bounded=conservative and not excitation.any() and bool((k > 0).all()),
        form=_symplectic_form(w, damping) if conservative else None,
    )


def driven_scales(k: FloatArray, excitation: FloatArray, slowest: float) -> FloatArray:
    """Return the scales w (m,): frequencies, raised to those that the excitation alone would cause, at most
    ``slowest``."""
    driven = np.sqrt(np.abs(np.diagonal(excitation, axis1=1, axis2=2)).sum(axis=0))
    w = np.maximum(np.sqrt(np.abs(k)), np.minimum(driven, slowest))
    return np.where(w > 0, w, slowest)


def _symplectic_form(w: FloatArray, gyroscopic: FloatArray) -> FloatArray:
    """Return dx ^ dp in terms of y, where x = y1 / w and p = x' + G x / 2: conserved by x'' + G x' + S(t) x = 0."""
    inverse = np.diag(1 / w)
    return np.block([[gyroscopic / np.outer(w, w), inverse], [-inverse, np.zeros_like(inverse)]])


def _forcing(constant: FloatArray, excitation: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return alpha, beta (R, J + 1) and B (R, m, m) of `floquet.oracle.taylor` from F_c1 ... F_cJ, F_s1 ... F_sJ.

    R is the number of matrix products that a term of the Taylor series costs. The harmonics of an excitation often
    share one distribution in space; R is therefore the rank of the span of the matrices, not their number.
    """
    J, m = len(excitation) // 2, len(constant)
    weights, sizes, basis = np.linalg.svd(excitation.reshape(2 * J, m * m), full_matrices=False)
    rank = max(1, int((sizes > np.finfo(float).eps * sizes[0]).sum()))
    factors = (weights * sizes)[:, :rank].T
    alpha, beta = np.zeros((rank, J + 1)), np.zeros((rank, J + 1))
    alpha[:, 1:], beta[:, 1:] = factors[:, :J], factors[:, J:]
    B = basis[:rank].reshape(rank, m, m)
    if constant.any():  # unsymmetric stiffness: a function of time that happens to be constant
        alpha = np.vstack([np.eye(1, J + 1), alpha])
        beta = np.vstack([np.zeros((1, J + 1)), beta])
        B = np.concatenate([constant[None], B])
    return alpha, beta, B


def _rate(equations: Equations) -> float:
    """Return a bound on the norm of the coefficient matrix, in the better of two scalings."""
    B, D = _parts(equations)
    sizes = np.linalg.norm(B, 2, axis=(1, 2))
    forcing = float(sizes @ np.hypot(equations.alpha, equations.beta).sum(axis=1))
    damping = float(np.linalg.norm(D, 2))
    w, k = equations.w.max(), np.abs(equations.k).max()
    as_it_is = max(w, k + forcing)
    rescaled = np.sqrt(w * (k + forcing))
    return float(min(as_it_is, rescaled)) + damping
