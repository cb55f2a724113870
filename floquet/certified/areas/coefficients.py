"""The equation over an area, in coordinates in which free motion keeps lengths (docs/certify.md, section 7)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy.linalg
from flint import arb, arb_mat, ctx, fmpq

from floquet.certified.areas.models import ROUNDING, norm
from floquet.certified.equation import block_matrix, exact, identity
from floquet.certified.spectrum import is_definite
from floquet.certified.structure import hamiltonian_change, is_reversible
from periodic import PeriodicSystem
from periodic.checks import FloatArray

# Working precision of what is done once for a system.
BITS = 192
# A coefficient is the float64 number nearest to its enclosure. In the 2-norm the difference of the matrices is below
# this part of the norm's bound: it counts as rounding.
COEFFICIENT_ERROR = 8 * ROUNDING
# Frequencies below this part of the highest are scaled as if they were as high.
LOWEST_SCALE = 1e-3
# By how much a bound of the growth rate exceeds the largest eigenvalue in float64, as a part of the norm.
GROWTH_SLACK = 1e-9


class Coefficients(NamedTuple):
    """z' = (A + eps sum_w g_w(theta) F_w) z / Omega, a prime for d/d theta.

    Attributes
    ----------
    A : ndarray, shape (2n, 2n)
    F : ndarray, shape (w, n, n)
        The block of F_w that takes z_2 to z_1'. Its other blocks are zero.
    harmonics : ndarray of int, shape (w,)
    sines : ndarray of bool, shape (w,)
        Whether g_w is sin(j theta), and not cos(j theta).
    norm, norms : float; ndarray, shape (w,)
        Bounds of the 2-norms of the matrices of absolute values.
    growth, symmetric_norms : float; ndarray, shape (w,)
        Bounds of the largest eigenvalue of (A + A^T) / 2, and of the 2-norms of (F_w + F_w^T) / 2.
    form : ndarray, shape (2n, 2n), or None
        Phi^T J Phi = J, to `COEFFICIENT_ERROR` of its Frobenius norm.
    reversible : bool
        Whether R Phi R = Phi^-1 with R = diag(-I, I).
    quarter : bool
        Whether theta = 0 stands for the phase 1/4.
    T1, scale : ndarray, shapes (n, n), (n,)
        W' = T1 z_1, W = T1 diag(1 / scale) z_2.
    """

    A: FloatArray
    F: FloatArray
    harmonics: FloatArray
    sines: FloatArray
    norm: float
    norms: FloatArray
    growth: float
    symmetric_norms: FloatArray
    form: FloatArray | None
    reversible: bool
    quarter: bool
    T1: FloatArray
    scale: FloatArray

    @property
    def reciprocal(self) -> bool:
        """Whether with mu, 1 / mu is a multiplier, with the same multiplicity."""
        return self.form is not None or self.reversible

    def waves(self, count: int, order: int) -> FloatArray:
        """Return the Taylor coefficients of g_w in the steps: shape (count, w, order + 1), to the last bits."""
        k = 2 * np.pi / count
        found = np.empty((count, len(self.harmonics), order + 1))
        i = np.arange(order + 1)
        for w, (j, is_sine) in enumerate(zip(self.harmonics.tolist(), self.sines, strict=True)):
            powers = np.cumprod(np.concatenate([[1.0], j * k / i[1:]]))
            for m in range(count):
                angle = fmpq(2 * j * m, count)
                cosine, sine = float(arb.cos_pi_fmpq(angle)), float(arb.sin_pi_fmpq(angle))
                turned = np.array([sine, cosine, -sine, -cosine] if is_sine else [cosine, -sine, -cosine, sine])
                found[m, w] = powers * turned[i % 4]
        return found


def coefficients_of(system: PeriodicSystem) -> Coefficients:
    """Return the equation of a system with periodic stiffness alone, with proved bounds."""
    n = system.size
    K = (system.stiffness + system.stiffness.T) / 2
    squares, Psi = scipy.linalg.eigh(K, system.mass)
    frequencies = np.sqrt(np.abs(squares))
    excitation = max(float(np.abs(X).max(initial=0.0)) for X in (system.cosine, system.sine))
    highest = max(float(frequencies.max()), np.sqrt(excitation / float(np.abs(system.mass).max())), 1e-100)
    scale = np.maximum(frequencies, LOWEST_SCALE * highest)
    quarter, waves = _waves(system)
    with ctx.workprec(BITS):
        left, right = exact(Psi.T), exact(Psi)
        inverse = (left * exact(system.mass) * right).inv()
        slow = exact(np.diag(scale)).inv()
        velocity = inverse * left * (exact(system.gyroscopic) + exact(system.damping)) * right
        place = inverse * left * exact(system.stiffness) * right * slow
        A, error = _nearest(block_matrix([[-velocity, -place], [exact(np.diag(scale)), arb_mat(n, n)]]))
        bound = _checked(A, error)
        F, bounds, symmetric = np.zeros((len(waves), n, n)), [], []
        for w, (_, _, X) in enumerate(waves):
            F[w], error = _nearest(-(inverse * left * exact(X) * right * slow))
            bounds.append(_checked(F[w], error))
            whole = np.zeros((2 * n, 2 * n))
            whole[:n, n:] = F[w] / 2
            symmetric.append(norm(whole + whole.T) * (1 + 1e-9) + bounds[-1] * COEFFICIENT_ERROR)
        sym = (exact(A) + exact(A.T)) / 2
        top = float(scipy.linalg.eigvalsh((A + A.T) / 2)[-1]) + GROWTH_SLACK * bound
        while not is_definite(identity(2 * n) * top - sym):
            top += GROWTH_SLACK * bound + abs(top)
        form = None
        if hamiltonian_change(system, 0.0, 1.0) == 0.0:
            lower = right * slow
            corner = left * exact(system.mass) * lower
            gyroscopic = lower.transpose() * exact(system.gyroscopic) * lower
            form, error = _nearest(block_matrix([[arb_mat(n, n), corner], [-corner.transpose(), -gyroscopic]]))
            if not float(error) <= COEFFICIENT_ERROR * float(np.linalg.norm(form)):
                raise ValueError("mass and gyroscopic are too badly scaled to be enclosed in float64; scale the system")
    harmonics, sines = (np.array([wave[i] for wave in waves]) for i in (0, 1))
    return Coefficients(
        A,
        F,
        harmonics.astype(np.int64),
        sines.astype(bool),
        bound,
        np.array(bounds),
        top + bound * COEFFICIENT_ERROR,
        np.array(symmetric),
        form,
        is_reversible(system, 1.0),
        quarter,
        Psi,
        scale,
    )


def _waves(system: PeriodicSystem) -> tuple[bool, list[tuple[int, bool, FloatArray]]]:
    """Return whether theta = 0 stands for the phase 1/4; harmonic, whether it is a sine, and matrix of every wave.

    About the phase 1/4 sines of odd and cosines of even harmonics are even in time. A system that is even about that
    phase and not about 0 is started there: its waves are then cosines alone.
    """
    found = []
    for j, (c, s) in enumerate(zip(system.cosine, system.sine, strict=True), start=1):
        found += [(j, is_sine, X) for is_sine, X in ((False, c), (True, s)) if X.any()]
    if any(s for _, s, _ in found) and all(s == bool(j % 2) for j, s, _ in found):
        # sin j (theta + pi/2) = cos(j theta) (-1)^((j - 1) / 2), cos j (theta + pi/2) = cos(j theta) (-1)^(j / 2)
        return True, [(j, False, X * (-1.0) ** (j // 2)) for j, _, X in found]
    return False, found


def _nearest(enclosed: arb_mat) -> tuple[FloatArray, arb]:
    """Return the float64 matrix nearest to an enclosure, and a bound of the Frobenius norm of the difference."""
    near = np.array([[float(x.mid()) for x in row] for row in enclosed.tolist()])
    difference = enclosed - exact(near)
    return near, sum((x * x for x in difference.entries()), arb(0)).sqrt().upper()


def _checked(A: FloatArray, error: arb) -> float:
    """Return a bound of the 2-norm of |A|, of which the error is a small part."""
    bound = float(norm(np.abs(A))) * (1 + 1e-9)
    if not error <= COEFFICIENT_ERROR * bound:
        raise ValueError("the matrices are too badly scaled to be enclosed in float64; scale the system")
    return bound
