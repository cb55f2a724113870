"""`reduce_model`: a large system in its lowest modes, and how far what was left out can move an edge."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, NamedTuple, cast

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as spla

from periodic import PeriodicSystem, SparseSystem, Term
from periodic.checks import ComplexArray, FloatArray, interval, real_number, whole_number
from periodic.waveforms import Impulses, Trigonometric
from reduction.modes import MAX_DENSE_SIZE, NaturalModes, lowest_modes, natural_modes

# Natural frequencies are kept up to so many times the highest excitation frequency, and up to so many times its highest
# harmonic; of many harmonics only these count: what drives a mode of the window at a higher one is small.
MODES_OVER_OMEGA, MODES_OVER_HARMONIC, MAX_HARMONICS_COUNTED = 8.0, 4.0, 4
# Modes that a reduced model has at most, unless told otherwise.
MAX_MODES = 400
# A combination of real and imaginary parts of modes is a coordinate of its own above this part of unit mass.
MIN_INDEPENDENT_MASS = 1e-12
# Relative rounding of the flexibility of what was left out, and accuracy of the norm that bounds higher orders.
FLEXIBILITY_ROUNDING, NORM_TOLERANCE = 1e-13, 1e-2
# Phases at which a waveform is looked at for its largest value.
WAVEFORM_SAMPLES = 257
# Powers of a frequency in the force that a matrix exerts.
FREQUENCY_POWER = {"stiffness": 0, "damping": 1, "gyroscopic": 1, "mass": 2}


@dataclass(frozen=True, eq=False)
class ReducedModel:
    """A large system in its lowest modes: a family like any other.

    Attributes
    ----------
    whole : SparseSystem
        What was reduced.
    system : PeriodicSystem
        The motions W = basis @ q of it.
    basis : ndarray, shape (n, m)
        Orthonormal with respect to the mass: basis^T M basis = 1.
    frequencies : ndarray
        Natural frequencies of the modes that were kept: exactly those of ``whole`` up to a limit.
    Omega_range : (float, float)
        Excitation frequencies for which it was reduced.
    """

    whole: SparseSystem
    system: PeriodicSystem
    basis: FloatArray
    frequencies: FloatArray
    Omega_range: tuple[float, float]
    _left_out: _LeftOut = field(repr=False)

    def at(self, Omega: float) -> PeriodicSystem:
        """Return the reduced system, at every frequency the same."""
        return self.system

    @property
    def size(self) -> int:
        """Number of coordinates of the reduced system."""
        return self.system.size

    def change(self, eps: float) -> float:
        """Return how far the modes that were left out move an edge in ``Omega_range`` at most, in units of Omega.

        A bound of second order in eps, divided by one minus the share of eps that higher orders have; infinite where
        that is not positive, and for pulses. It is about resonances between modes up to the highest excitation
        frequency.

        Raises
        ------
        ValueError
            If ``eps`` is no number.
        """
        return self._left_out.change(abs(real_number("eps", eps)))

    def answer(self, forces: FloatArray | ComplexArray) -> FloatArray | ComplexArray:
        """Return the static answer K^-1 ``forces`` of the whole model, shape (n,) or (n, k).

        If its stiffness is not positive definite, so much of the mass is added to it that it is.
        """
        return self._left_out.answer(forces)

    def __repr__(self) -> str:
        low, high = self.frequencies[[0, -1]]
        return (
            f"ReducedModel({len(self.frequencies)} of {self.whole.size} modes, natural frequencies {low:.6g} to "
            f"{high:.6g})"
        )


def reduce_model(
    system: SparseSystem | PeriodicSystem, Omega_range: tuple[float, float], *, max_modes: int = MAX_MODES
) -> ReducedModel:
    """Reduce a large system to its lowest modes.

    Kept are all modes with natural frequencies up to eight times the highest excitation frequency (more if there are
    several harmonics): those of mass and stiffness, or of mass, stiffness and gyroscopic matrix, whose real and
    imaginary parts then are coordinates. By a count of eigenvalues (Sylvester's law of inertia) none is missing.

    Parameters
    ----------
    system : SparseSystem or PeriodicSystem
        Its stiffness has to be symmetric; with a gyroscopic matrix, positive definite.
    Omega_range : (float, float)
        Excitation frequencies that the reduced model is meant for.
    max_modes : int
        Most modes that are looked for.

    Returns
    -------
    ReducedModel

    Raises
    ------
    ValueError
        If an argument is out of range, there are more modes than ``max_modes``, or the stiffness is not what is asked
        for.

    Notes
    -----
    With V the kept and Z the other modes, the forces f = eps F(t) V q that the excitation exerts on Z are answered by
    Z (Lambda - nu^2)^-1 Z^T f, which is at most kappa times the static answer R f, R = K^-1 - V Lambda_V^-1 V^T,
    kappa = 1/(1 - nu^2/omega_c^2) for modes beyond omega_c. Acting back on V it moves an edge of omega_p + omega_q by
    (s_p + s_q)^2 at most, s_p^2 = kappa omega_p w_p^H f^H R f w_p with w_p of unit energy: one solution with K for each
    mode. Gyroscopic modes have kappa = 1/(1 - nu/omega_c).
    """
    if not isinstance(system, SparseSystem | PeriodicSystem):
        raise ValueError(f"system = {system!r} is no SparseSystem and no PeriodicSystem; give one")
    whole = system if isinstance(system, SparseSystem) else _as_sparse(system)
    low, high = interval("Omega_range", Omega_range, nonnegative=True)
    most = whole_number("max_modes", max_modes, least=1)
    J = min(max([1, *map(_harmonics, whole.terms)]), MAX_HARMONICS_COUNTED)
    modes = natural_modes(whole, max(MODES_OVER_OMEGA, MODES_OVER_HARMONIC * J) * high, most)
    if not len(modes.frequencies):
        raise ValueError(
            f"Omega_range = {(low, high)!r} lies below all natural frequencies, of which the lowest is "
            f"{modes.next:.6g}; give a higher one"
        )
    basis = _basis(whole, modes)
    return ReducedModel(
        whole, whole.restricted(basis), basis, modes.frequencies, (low, high), _LeftOut(whole, modes, J * high)
    )


def first_modes(system: SparseSystem, count: int) -> PeriodicSystem:
    """Return a large system in its ``count`` lowest modes, to look at: nothing is said of the others.

    Raises
    ------
    ValueError
        If ``count`` is not a small part of the coordinates, or the stiffness is not positive definite.
    """
    count = whole_number("count", count, least=1, most=system.size // 4)
    return system.restricted(_basis(system, lowest_modes(system, count)))


class _Part(NamedTuple):
    """What one matrix does between kept modes and others.

    Attributes
    ----------
    power, height : int, float
        Power of eps, and largest value of the waveform.
    rate : int
        Power of the frequency.
    reactions : ndarray
        s_p of each mode at height 1.
    norm : float
        Of the matrix between modes that were left out, divided by their stiffness.
    """

    power: int
    height: float
    rate: int
    reactions: FloatArray
    norm: float


class _LeftOut:
    """What the modes beyond the kept ones can do to the edges between the lowest of them.

    Parameters
    ----------
    whole : SparseSystem
    modes : NaturalModes
    highest : float
        The highest frequency of an excitation: modes up to it take part in the resonances of a window.
    """

    def __init__(self, whole: SparseSystem, modes: NaturalModes, highest: float) -> None:
        self._modes, self._highest = modes, highest
        part = (modes.frequencies > 0) & (modes.frequencies <= highest)
        self._frequencies = modes.frequencies[part]
        unit_energy = 1.0 if np.iscomplexobj(modes.shapes) else 1 / (np.sqrt(2) * self._frequencies)
        shapes = modes.shapes[:, part] * unit_energy
        self._parts = [
            _Part(power, height, FREQUENCY_POWER[of], self._reaction(of, X @ shapes), self._norm(X))
            for of, power, height, X in _forces(whole)
        ]

    def change(self, eps: float) -> float:
        """Return the largest change of an edge, in units of Omega."""
        omega = self._frequencies
        if not len(omega) or not np.isfinite(self._modes.next):
            return 0.0
        nu = 2 * self._highest
        ratio = nu / self._modes.next
        heights = [part.height * eps**part.power for part in self._parts]
        higher = sum(h * part.norm * nu**part.rate for h, part in zip(heights, self._parts, strict=True))
        margin = 1 - (ratio if np.iscomplexobj(self._modes.shapes) else ratio**2) - higher
        if not margin > 0:
            return np.inf
        s = sum((h * part.reactions for h, part in zip(heights, self._parts, strict=True)), np.zeros(len(omega)))
        shifted = 1 + self._modes.shift / self._modes.next**2
        return float((2 * s.max()) ** 2 * shifted / margin)  # of two modes, (s_p + s_q)^2

    def _reaction(self, of: str, forces: FloatArray | ComplexArray) -> FloatArray:
        """Return sqrt(omega_p f_p^H R f_p) of the forces f_p that the modes exert through one matrix."""
        answers = self._flexibility(forces)
        static = np.einsum("np,np->p", forces.conj(), answers).real
        return np.asarray(
            np.sqrt(self._frequencies * np.maximum(static, 0.0)) * self._frequencies ** FREQUENCY_POWER[of]
        )

    def answer(self, forces: Any) -> Any:
        """Return the static answer of the whole model."""
        solve = self._modes.factor.solve
        return solve(forces.real) + 1j * solve(forces.imag) if np.iscomplexobj(forces) else solve(forces)

    def _flexibility(self, forces: Any) -> Any:
        """Return R ``forces``: the static answer of what was left out."""
        modes, answer = self._modes, self.answer(forces)
        W = modes.shapes
        if np.iscomplexobj(W):  # states come in conjugate pairs
            inside = W @ (W.conj().T @ forces) + W.conj() @ (W.T @ forces)
            return answer - (inside if np.iscomplexobj(forces) else inside.real)
        return answer - W @ ((W.T @ forces).T / (modes.frequencies * np.abs(modes.frequencies) + modes.shift)).T

    def _norm(self, X: Any) -> float:
        """Return the largest singular value of R^1/2 X R^1/2; of a large model by Arnoldi's method."""
        n = X.shape[0]
        if n <= MAX_DENSE_SIZE:
            R, dense = self._flexibility(np.eye(n)), X.toarray()
            return float(np.sqrt(np.abs(np.linalg.eigvals(dense.T @ R @ dense @ R)).max()))
        operator = spla.LinearOperator(
            (n, n), lambda v: self._flexibility(X.T @ self._flexibility(X @ v.ravel())), dtype=float
        )
        start = np.random.default_rng(n).standard_normal(n)
        value = spla.eigs(operator, k=1, tol=NORM_TOLERANCE, v0=start, return_eigenvectors=False)
        return float(np.sqrt(abs(value[0])) * (1 + NORM_TOLERANCE))


def _basis(whole: SparseSystem, modes: NaturalModes) -> FloatArray:
    """Return coordinates that hold the modes, orthonormal with respect to the mass."""
    if not np.iscomplexobj(modes.shapes):
        return np.ascontiguousarray(modes.shapes.real)
    both = np.hstack([modes.shapes.real, modes.shapes.imag])
    both /= np.sqrt(np.einsum("np,np->p", both, whole.mass @ both))
    gram = both.T @ (whole.mass @ both)
    masses, vectors = np.linalg.eigh((gram + gram.T) / 2)
    kept = masses > MIN_INDEPENDENT_MASS
    return np.asarray(both @ (vectors[:, kept] / np.sqrt(masses[kept])))


def _as_sparse(system: PeriodicSystem) -> SparseSystem:
    constant = [sp.csr_array(X) for X in (system.mass, system.gyroscopic, system.damping, system.stiffness)]
    harmonics = ([sp.csr_array(X) for X in Xs] for Xs in (system.cosine, system.sine))
    terms = [Term(t.of, cast(Any, sp.csr_array(t.matrix)), t.waveform, t.power) for t in system.terms]
    return SparseSystem(*constant, *harmonics, terms=terms)


def _forces(whole: SparseSystem) -> list[tuple[str, int, float, Any]]:
    """Return what acts between modes: which matrix, power of eps, largest value in time, matrix."""
    constant = [("damping", 0, 1.0, whole.damping)] if whole.damping.nnz else []
    return constant + [(term.of, term.power, _height(term), term.matrix) for term in whole.terms]


def _harmonics(term: Term) -> int:
    return term.waveform.harmonics if isinstance(term.waveform, Trigonometric) else MAX_HARMONICS_COUNTED


def _height(term: Term) -> float:
    if isinstance(term.waveform, Impulses):
        return np.inf
    return float(np.abs(term.waveform.values(np.linspace(0, 2 * np.pi, WAVEFORM_SAMPLES))).max())
