"""From a monodromy matrix with its error to multipliers, their largest modulus with its error, and the verdict."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import scipy.linalg as sla
from numpy.typing import NDArray
from scipy.optimize import brentq
from scipy.sparse.csgraph import connected_components

from floquet.kind import Kind
from periodic.checks import ComplexArray, FloatArray

# A multiplier is isolated if its first-order error is below this part of the distance to its nearest neighbour: no
# admissible error then lets it meet another.
ISOLATED_SHIFT = 0.1
# Error that the QR algorithm itself makes: this many roundings of the norm of the matrix.
QR_ROUNDINGS = 4
# Relative accuracy to which the excursion of a multiplier is looked for.
EXCURSION_TOLERANCE = 0.1
# A signature below this part of the form is none: the multipliers are about to leave the circle.
MIN_SIGNATURE = 1e-6


class Spectrum(NamedTuple):
    """What is known of the multipliers of one subsystem.

    Attributes
    ----------
    multipliers : ndarray of complex, shape (N,)
        By decreasing modulus.
    errors : ndarray, shape (N,)
        Their estimated errors, relative to their moduli.
    log_modulus, error : float
        Logarithm of the largest modulus, and its estimated error.
    kind : Kind
        The verdict.
    """

    multipliers: ComplexArray
    errors: FloatArray
    log_modulus: float
    error: float
    kind: Kind


def spectrum(
    Phi: FloatArray, error: float, *, reciprocal: bool, bounded: bool = False, form: FloatArray | None = None
) -> Spectrum:
    """Judge a monodromy matrix.

    Parameters
    ----------
    Phi : ndarray, shape (N, N)
        Monodromy matrix, best in coordinates in which it is well-conditioned.
    error : float
        Estimated spectral norm of the error of ``Phi``.
    reciprocal : bool
        True if with mu also 1/conj(mu) is a multiplier, as for conservative and for reversible systems. A simple
        multiplier then cannot leave the unit circle alone, and stable means that all lie on it. Otherwise stable means
        that all lie inside.
    bounded : bool
        True if a positive definite energy is conserved: nothing grows, even where multipliers meet.
    form : ndarray, shape (N, N), optional
        Skew-symmetric matrix that ``Phi`` conserves, Phi^T form Phi = form. It tells which multipliers can leave the
        unit circle where they meet (M. G. Krein's signature).

    Returns
    -------
    Spectrum

    Notes
    -----
    An error E of ``Phi`` moves a simple multiplier by at most kappa E, where kappa is its condition number. At a
    multiple one kappa is infinite, but the shift stays of the order of sqrt(E). There it is read from the
    pseudospectrum: it is the largest distance along the ray through mu at which some error of norm E can put a
    multiplier (L. N. Trefethen and M. Embree, Spectra and Pseudospectra, 2005, chapter 2).
    """
    found = perturbed_eigenvalues(Phi, error)
    mu, E, first_order, distance, crowded = found
    modulus = np.abs(mu)
    shift = found.shifts(Phi, np.flatnonzero(modulus + first_order > modulus.max()))
    top = int(modulus.argmax())
    log_modulus = float(np.log(modulus[top]))
    upper = np.log1p((modulus + shift - modulus[top]).max() / modulus[top])
    down = max(shift[top], first_order[top])
    if crowded[top]:
        # if an error can make the two meet, it can turn them into a complex pair of their mean modulus
        near = int(distance[top].argmin())
        middle = 0.5 * (mu[top] + mu[near]) * np.eye(len(Phi))
        if sla.svdvals(middle - Phi)[-1] <= E:
            down = max(shift[top], 0.5 * distance[top, near] + E)
    # an error as large as the multiplier leaves nothing to tell it from zero
    lower = -np.log(max(1 - down / modulus[top], np.finfo(float).tiny))
    log_error = float(max(upper, lower))
    if log_modulus > log_error and not bounded:
        kind = _kind(mu[top], shift[top])
    elif reciprocal:
        held = bounded or _held(Phi, mu, first_order, distance, crowded, form)
        kind = Kind.STABLE if held else Kind.UNDECIDED
        if held:
            mu = mu / modulus
            log_modulus = 0.0
    else:
        kind = Kind.STABLE if log_modulus < -log_error else Kind.UNDECIDED
    with np.errstate(divide="ignore"):
        errors = shift / modulus
    order = by_modulus(mu)
    return Spectrum(mu[order], errors[order], log_modulus, log_error, kind)


class PerturbedEigenvalues(NamedTuple):
    """Eigenvalues of a matrix known up to an error, and how well they are known.

    Attributes
    ----------
    mu : ndarray of complex, shape (N,)
    error : float
        Spectral norm of the error of the matrix, that of the QR algorithm included.
    first_order : ndarray, shape (N,)
        Shift of each eigenvalue by the error, to first order.
    distance : ndarray, shape (N, N)
        Distances between eigenvalues, infinite on the diagonal.
    crowded : ndarray of bool, shape (N,)
        Whether an eigenvalue is so close to another that first order does not do.
    """

    mu: ComplexArray
    error: float
    first_order: FloatArray
    distance: FloatArray
    crowded: NDArray[np.bool_]

    def shifts(self, matrix: FloatArray, where: NDArray[np.intp]) -> FloatArray:
        """Return the shift of each eigenvalue (N,); of crowded ones from the pseudospectrum, but only ``where``."""
        shift = self.first_order.copy()
        for i in where[self.crowded[where] & (self.mu[where].imag >= 0)]:
            shift[i] = _excursion(matrix, self.mu[i], self.error, self.first_order[i])
            shift[self.mu == self.mu[i].conj()] = shift[i]
        return shift


def perturbed_eigenvalues(matrix: FloatArray, error: float) -> PerturbedEigenvalues:
    """Return the eigenvalues of a matrix (N, N) whose error has the spectral norm ``error``."""
    mu, left, right = eigensystem(matrix)
    norm = float(np.linalg.norm(matrix))
    E = error + QR_ROUNDINGS * np.finfo(float).eps * norm
    with np.errstate(divide="ignore"):
        kappa = 1 / np.abs(np.einsum("ij,ij->j", left.conj(), right))  # both sets are normalised
    first_order = np.minimum(kappa * E, 2 * norm + E)
    distance = np.abs(mu[:, None] - mu) + np.diag(np.full(len(mu), np.inf))
    crowded = first_order > ISOLATED_SHIFT * distance.min(axis=1)
    return PerturbedEigenvalues(mu, E, first_order, distance, crowded)


def eigensystem(Phi: FloatArray) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
    """Return the eigenvalues (N,) of a matrix, and its left and right eigenvectors in columns, normalised.

    The matrix is scaled by a power of two, which rounds nothing. LAPACK scales matrices above 1e138 itself; with
    vectors wanted as well it then returned eigenvalues that were too small by a factor of 500 and more.
    """
    scale = 2.0 ** np.floor(np.log2(max(float(np.abs(Phi).max()), 1.0)))
    mu, left, right = sla.eig(Phi / scale, left=True, right=True)
    return scale * mu, left, right


def combine(spectra: Sequence[Spectrum]) -> Spectrum:
    """Return the spectrum of a system made of decoupled subsystems from those of the subsystems.

    Without any it is stable: there is nothing that could grow.
    """
    if not spectra:
        return Spectrum(np.zeros(0, complex), np.zeros(0), 0.0, 0.0, Kind.STABLE)
    value = max(s.log_modulus for s in spectra)
    upper = max(s.log_modulus + s.error for s in spectra)
    lower = max(s.log_modulus - s.error for s in spectra)
    unstable = [s for s in spectra if s.kind > Kind.STABLE]
    # without an unstable subsystem, one undecided subsystem leaves the whole undecided
    kind = max(unstable, key=lambda s: s.log_modulus).kind if unstable else min(s.kind for s in spectra)
    mu = np.concatenate([s.multipliers for s in spectra])
    errors = np.concatenate([s.errors for s in spectra])
    order = by_modulus(mu)
    return Spectrum(mu[order], errors[order], value, max(upper - value, value - lower), kind)


def by_modulus(mu: ComplexArray) -> NDArray[np.intp]:
    """Return the order of decreasing modulus, of equal moduli that of increasing angle."""
    return np.lexsort((np.angle(mu), -np.abs(mu)))


def _kind(mu: complex, shift: float) -> Kind:
    if abs(mu.imag) > shift:
        return Kind.COMPLEX
    return Kind.PLUS_ONE if mu.real > 0 else Kind.MINUS_ONE


def _excursion(Phi: FloatArray, mu: complex, E: float, most: float) -> float:
    """Return how far along its ray an error of norm ``E`` can put the multiplier ``mu``, to 10 %."""
    direction = mu / abs(mu)
    unit = np.eye(len(Phi))

    def margin(log_shift: float) -> float:
        z = mu + np.exp(log_shift) * direction
        return float(np.log(max(sla.svdvals(z * unit - Phi)[-1] / E, 1e-9)))

    low, high = np.log(E), np.log(most)
    if low >= high or margin(low) >= 0 or margin(high) <= 0:
        return max(E, most) if low >= high or margin(high) <= 0 else E
    return float(np.exp(brentq(margin, low, high, xtol=EXCURSION_TOLERANCE)))


def _held(
    Phi: FloatArray,
    mu: ComplexArray,
    first_order: FloatArray,
    distance: FloatArray,
    crowded: NDArray[np.bool_],
    form: FloatArray | None,
) -> bool:
    """Return whether no admissible error can take a multiplier of a reciprocal system off the unit circle."""
    if not crowded.any():
        return True
    if form is None:
        return False
    reach = np.maximum(first_order[:, None], first_order) / ISOLATED_SHIFT
    _, cluster = connected_components(distance <= reach, directed=False)
    return all(_definite(Phi, mu, cluster == c, form) for c in np.unique(cluster[crowded]))


def _definite(Phi: FloatArray, mu: ComplexArray, members: NDArray[np.bool_], form: FloatArray) -> bool:
    """Return whether i x^H form x has one sign on the invariant subspace of ``members``: then they cannot leave."""
    inside, outside = mu[members], mu[~members]

    def selected(z: complex) -> bool:
        return len(outside) == 0 or np.abs(inside - z).min() < np.abs(outside - z).min()

    _, basis, count = sla.schur(Phi.astype(complex), "complex", sort=selected)  # type: ignore[call-overload]
    if count != len(inside):
        return False
    X = basis[:, :count]
    signs = np.linalg.eigvalsh(1j * X.conj().T @ form @ X)
    return bool(signs[0] * signs[-1] > 0 and np.abs(signs).min() > MIN_SIGNATURE * np.linalg.norm(form, 2))
