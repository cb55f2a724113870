"""The lowest modes of a large system without excitation, by shift-invert, and a proof that none is missing.

Without gyroscopic matrix, K phi = omega^2 M phi. With it, the equations of motion in the state z = (W', W) are
A z' = B z, A = diag(M, K) positive definite and B = [[-G, -K], [K, 0]] skew: all eigenvalues are i omega, and the modes
are orthogonal in the energy z^H A z. The inverse needs K alone,

    B (a, b) = A (p, q):    a = q,    b = -K^-1 (M p + G q),

so that the linearisation stays as sparse as the matrices are.

Source: F. Tisseur and K. Meerbergen, "The quadratic eigenvalue problem", SIAM Review 43 (2001) 235-286.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy.linalg as sla
import scipy.sparse.linalg as spla

from periodic import SparseSystem
from periodic.checks import ComplexArray, FloatArray
from reduction.factor import Factor

# Coordinates up to which all modes are computed at once.
MAX_DENSE_SIZE = 500
# A shift for a stiffness that is not positive definite, in parts of the highest frequency that is wanted, squared.
INDEFINITE_SHIFT = 1.0


class NaturalModes(NamedTuple):
    """Modes with natural frequencies up to a limit.

    Attributes
    ----------
    frequencies : ndarray, shape (m,)
        omega, in ascending order; 0 for a motion without stiffness, imaginary ones as negative numbers.
    shapes : ndarray, shape (n, m)
        W of each mode. Real with w^T M w = 1, or with gyroscopic matrix complex with w^H (omega^2 M + K) w = 1.
    next : float
        The lowest frequency that was left out; infinite if none was.
    shift, factor : float, Factor
        Of K + shift M, which is positive definite.
    """

    frequencies: FloatArray
    shapes: FloatArray | ComplexArray
    next: float
    shift: float
    factor: Factor


def natural_modes(system: SparseSystem, limit: float, most: int) -> NaturalModes:
    """Return all modes with natural frequencies up to ``limit``.

    Raises
    ------
    ValueError
        If there are more than ``most``, if the stiffness is far from positive definite, or not quite so and the system
        gyroscopic.
    """
    gyroscopic = system.gyroscopic.nnz > 0
    shift, factor = _shifted(system, limit, gyroscopic)
    if system.size <= MAX_DENSE_SIZE:
        frequencies, shapes = _all_modes(system, gyroscopic)
        count = int((frequencies <= limit).sum())
    else:
        count = _count(system, limit, gyroscopic)
    allowed = most if system.size <= MAX_DENSE_SIZE else min(most, system.size // 4)
    if count > allowed:
        raise ValueError(
            f"system has {count} modes below {limit:.6g}, and at most {allowed} are computed; give a lower Omega_range"
            + (", or a larger max_modes" if allowed == most else "")
        )
    if system.size > MAX_DENSE_SIZE:
        frequencies, shapes = (_gyroscopic if gyroscopic else _plain)(system, factor, shift, count + 1)
        found = int((frequencies <= limit).sum())
        if found != count:
            raise ValueError(
                f"system has {count} modes below {limit:.6g}, of which Lanczos' method found {found}; "
                "give another Omega_range"
            )
    beyond = float(frequencies[count]) if count < len(frequencies) else np.inf
    return NaturalModes(frequencies[:count], shapes[:, :count], beyond, shift, factor)


def lowest_modes(system: SparseSystem, count: int) -> NaturalModes:
    """Return the ``count`` lowest modes; that none is missing is not proved.

    Raises
    ------
    ValueError
        If the stiffness is not positive definite.
    """
    gyroscopic = system.gyroscopic.nnz > 0
    try:
        factor = Factor(system.stiffness)
    except ArithmeticError:
        raise ValueError("stiffness is singular; give the window of Omega and eps yourself") from None
    if factor.negative:
        raise ValueError("stiffness is not positive definite; give the window of Omega and eps yourself")
    frequencies, shapes = (_gyroscopic if gyroscopic else _plain)(system, factor, 0.0, count + 1)
    return NaturalModes(frequencies[:count], shapes[:, :count], float(frequencies[count]), 0.0, factor)


def _shifted(system: SparseSystem, limit: float, gyroscopic: bool) -> tuple[float, Factor]:
    """Return a shift s for which K + s M is positive definite, and its factorisation."""
    for shift in (0.0, INDEFINITE_SHIFT * limit**2):
        try:
            factor = Factor(system.stiffness + shift * system.mass)
        except ArithmeticError:
            continue
        if factor.negative == 0:
            return shift, factor
        if gyroscopic:
            break
    if gyroscopic:
        raise ValueError("stiffness of a gyroscopic system is not positive definite; give one that is")
    raise ValueError(
        f"stiffness has modes that grow faster than exp({limit:.6g} t); give a stiffness that is nearer to stability"
    )


def _all_modes(system: SparseSystem, gyroscopic: bool) -> tuple[FloatArray, FloatArray | ComplexArray]:
    if gyroscopic:
        return _ritz(system, np.eye(2 * system.size))
    squares, shapes = sla.eigh(system.stiffness.toarray(), system.mass.toarray())
    return _signed_root(squares), shapes


def _plain(system: SparseSystem, factor: Factor, shift: float, count: int) -> tuple[FloatArray, FloatArray]:
    solve = spla.LinearOperator(system.mass.shape, factor.solve, dtype=float)
    squares, shapes = spla.eigsh(
        system.stiffness, k=count, M=system.mass, sigma=-shift, OPinv=solve, v0=_start(system.size)
    )
    order = np.argsort(squares)
    return _signed_root(squares[order]), shapes[:, order]


def _signed_root(squares: FloatArray) -> FloatArray:
    return np.asarray(np.sign(squares) * np.sqrt(np.abs(squares)))


def _gyroscopic(system: SparseSystem, factor: Factor, shift: float, count: int) -> tuple[FloatArray, ComplexArray]:
    """Return the modes with the largest eigenvalues 1/(i omega) of the inverse."""
    n, M, G = system.size, system.mass, system.gyroscopic

    def inverse(z: FloatArray) -> FloatArray:
        velocity, displacement = z[:n], z[n:]
        return np.concatenate([displacement, -factor.solve(M @ velocity + G @ displacement)])

    operator = spla.LinearOperator((2 * n, 2 * n), inverse, dtype=float)
    found = spla.eigs(operator, k=2 * count, which="LM", v0=_start(2 * n))[1]
    frequencies, shapes = _ritz(system, sla.orth(np.hstack([found.real, found.imag])))
    return frequencies[:count], shapes[:, :count]


def _ritz(system: SparseSystem, basis: FloatArray) -> tuple[FloatArray, ComplexArray]:
    """Return frequencies > 0 and shapes of the modes in a subspace of states, by Rayleigh-Ritz in the energy."""
    M, G, K = system.mass, system.gyroscopic, system.stiffness
    velocity, displacement = basis[: system.size], basis[system.size :]
    energy = velocity.T @ (M @ velocity) + displacement.T @ (K @ displacement)
    skew = displacement.T @ (K @ velocity)
    power = skew - skew.T - velocity.T @ (G @ velocity)  # z^T B z
    values, vectors = sla.eigh(-0.5j * (power - power.T), (energy + energy.T) / 2)
    positive = values > 0
    return values[positive], displacement @ vectors[:, positive]


def _count(system: SparseSystem, limit: float, gyroscopic: bool) -> int:
    """Return the number of modes below ``limit``: of negative eigenvalues of K - omega^2 M + i omega G, omega = limit.

    These eigenvalues fall as omega rises, since every mode has positive energy, so that each crosses zero once.

    Raises
    ------
    ValueError
        If ``limit`` is a natural frequency, to working precision.
    """
    matrix = system.stiffness - limit**2 * system.mass
    if gyroscopic:
        matrix = matrix + 1j * limit * system.gyroscopic
    try:
        return Factor(matrix).negative
    except ArithmeticError as error:
        raise ValueError(f"system's modes below {limit:.6g} cannot be counted: {error}; change Omega_range") from None


def _start(n: int) -> FloatArray:
    """A vector that has part in every mode, the same every time."""
    return np.random.default_rng(n).standard_normal(n)
