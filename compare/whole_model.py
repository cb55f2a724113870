"""A reduced model held against the whole one at chosen points, without the whole model's monodromy matrix.

A Floquet solution e^{lambda t} sum_h w_h e^{i h Omega t} of the reduced model is put into the equations of the whole
one. What is left, one force for each harmonic, is answered by the stiffness of the whole model; the answers become
further coordinates of the reduced model, and so on, until nothing is left: then it is a solution of the whole model.

Source of the method: residual corrections of reduced bases, as in Krylov subspace methods of structural dynamics;
R. R. Craig and A. J. Kurdila, Fundamentals of Structural Dynamics, 2nd ed. (2006).
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import scipy.linalg as sla

from floquet.modes import FloquetMode, FloquetModes, floquet_modes
from periodic import SparseSystem
from periodic.checks import ComplexArray, FloatArray, real_number, whole_number
from reduction import FREQUENCY_POWER, ReducedModel

# Rounds of corrections; the share of the forces of a mode below which what is left of its equations is rounding; the
# change of an exponent, in parts of Omega, below which a round has changed nothing.
MAX_CORRECTIONS, RESIDUAL_TOLERANCE, EXPONENT_TOLERANCE = 12, 1e-7, 1e-9
# Harmonics of a motion below this part of the strongest are rounding.
NEGLIGIBLE_HARMONIC = 1e-12
# New coordinates of a round: those with more than this share of the largest answer, and at most so many.
MIN_ANSWER, MAX_ANSWERS = 1e-3, 12


class WholeModelCheck(NamedTuple):
    """One motion of the reduced model, and what becomes of it in the whole one.

    Attributes
    ----------
    Omega, eps : float
    reduced, whole : complex
        The Floquet exponent in the reduced and in the whole model, per unit of time.
    residual : float
        What is left of the whole model's equations, as part of the elastic forces of the motion.
    coordinates : int
        Coordinates that the motion needed.
    converged : bool
        Whether the residual is rounding, or a further round changed nothing. If not, ``whole`` is the best that was
        found.
    """

    Omega: float
    eps: float
    reduced: complex
    whole: complex
    residual: float
    coordinates: int
    converged: bool

    @property
    def difference(self) -> float:
        """|whole - reduced|."""
        return abs(self.whole - self.reduced)


def check_whole_model(model: ReducedModel, Omega: float, eps: float, *, motion: int = 0) -> WholeModelCheck:
    """Follow one motion of a reduced model into the whole model.

    Parameters
    ----------
    model : ReducedModel
    Omega, eps : float
    motion : int
        Which of the reduced model's modes at this point, as `floquet.floquet_modes` has them: 0 is the least stable.

    Raises
    ------
    ValueError
        If an argument is out of range, or the reduced model cannot be integrated there.
    """
    if not isinstance(model, ReducedModel):
        raise ValueError(f"model = {model!r} is no ReducedModel; make one with reduction.reduce_model")
    Omega, eps = real_number("Omega", Omega, positive=True), real_number("eps", eps)
    modes = floquet_modes(model.system, Omega, eps)
    motion = whole_number("motion", motion, least=0, most=len(modes) - 1)
    basis, mode = model.basis, modes[motion]
    first = mode.exponent
    moved = np.inf
    for _ in range(MAX_CORRECTIONS):
        shapes, forces = _left_over(model.whole, basis, mode, eps)
        answers = model.answer(forces)
        elastic = np.einsum("nh,nh->", shapes.conj(), model.whole.stiffness @ shapes).real
        residual = float(np.sqrt(max(np.einsum("nh,nh->", forces.conj(), answers).real, 0.0) / abs(elastic)))
        complete = basis.shape[1] == model.whole.size
        if complete or residual < RESIDUAL_TOLERANCE or moved < EXPONENT_TOLERANCE * Omega:
            return WholeModelCheck(Omega, eps, first, mode.exponent, residual, basis.shape[1], True)
        basis = _enlarged(model.whole, basis, answers)
        mode, before = _nearest(floquet_modes(model.whole.restricted(basis), Omega, eps), mode), mode.exponent
        moved = abs(mode.exponent - before)
    return WholeModelCheck(Omega, eps, first, mode.exponent, residual, basis.shape[1], False)


def _left_over(whole: SparseSystem, basis: FloatArray, mode: FloquetMode, eps: float) -> tuple[Any, Any]:
    """Return the harmonics w_h of a motion of the whole model and what is left of its equations, shape (n, H) each."""
    parts = mode.coefficients[:, basis.shape[1] :]
    sizes = np.abs(parts).max(axis=1)
    strong = np.flatnonzero(sizes > NEGLIGIBLE_HARMONIC * sizes.max())
    kept = slice(int(strong[0]), int(strong[-1]) + 1)
    w = basis @ parts[kept].T
    rates = mode.exponent + 1j * mode.harmonics[kept] * mode.Omega
    forces = whole.mass @ (w * rates**2) + (whole.damping + whole.gyroscopic) @ (w * rates) + whole.stiffness @ w
    for term in whole.terms:
        moved = term.matrix @ (w * rates ** FREQUENCY_POWER[term.of])
        forces = forces + eps**term.power * _product(term.waveform.fourier(len(rates)), moved)
    return w, forces


def _product(fourier: tuple[FloatArray, FloatArray, float], series: Any) -> ComplexArray:
    """Return the harmonics of g(theta) times a series, shape (n, H), without what falls beyond its ends."""
    cosines, sines, _ = fourier
    total: ComplexArray = cosines[0] * series
    H = series.shape[1]
    for j in range(1, min(len(cosines), H)):
        up, down = (cosines[j] - 1j * sines[j]) / 2, (cosines[j] + 1j * sines[j]) / 2
        if up:
            total[:, j:] += up * series[:, :-j]
            total[:, :-j] += down * series[:, j:]
    return total


def _enlarged(whole: SparseSystem, basis: FloatArray, answers: Any) -> FloatArray:
    """Return the basis with the main directions of the answers, orthonormal with respect to the mass."""
    new = np.hstack([answers.real, answers.imag])
    for _ in range(2):  # once leaves rounding of large parts inside the basis
        new = new - basis @ (basis.T @ (whole.mass @ new))
    gram = new.T @ (whole.mass @ new)
    squares, vectors = sla.eigh((gram + gram.T) / 2)
    free = min(MAX_ANSWERS, whole.size - basis.shape[1])
    kept = np.flatnonzero(squares > MIN_ANSWER**2 * squares[-1])[-free:]
    return np.hstack([basis, new @ (vectors[:, kept] / np.sqrt(squares[kept]))])


def _nearest(modes: FloquetModes, before: FloquetMode) -> FloquetMode:
    """Return the mode whose exponent is nearest, up to multiples of i Omega."""
    apart = modes.exponents - before.exponent
    turns = np.round(apart.imag / before.Omega)
    return modes[int(np.argmin(np.abs(apart - 1j * turns * before.Omega)))]
