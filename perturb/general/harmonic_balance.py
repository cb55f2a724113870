"""Harmonic balance: the method of Bolotin's and Hill's determinants, for any linear periodic system.

A solution e^{lambda t} sum_h W_h e^{i h Omega t} turns the equations of motion into one linear system for the W_h,

    sum_h' [ (lambda + i h' Omega)^2 M_{h-h'} + (lambda + i h' Omega) (G + C)_{h-h'} + K_{h-h'} ] W_h' = 0,

with the Fourier coefficients of the matrices at the amplitude eps; of first order, sum_h' A_{h-h'} x_h' = (lambda + i h
Omega) x_h. At an edge with the multiplier +1 it has a solution with lambda = 0 and whole h, at one with -1 one with
half-integer h (Bolotin's determinants). At given Omega the matrix is a polynomial in eps, so that the edges are its
eigenvalues. Exponents lambda at given Omega and eps are eigenvalues, too (Hill's determinant). Nothing is expanded in
eps; what is left out are harmonics beyond ``harmonics``, which are doubled until that shows no more.
"""

from __future__ import annotations

from collections import defaultdict
from typing import NamedTuple

import numpy as np
from scipy.linalg import eig

from periodic import AnyFamily, AnySystem, FirstOrderSystem, any_member_at
from periodic.checks import ComplexArray, FloatArray, real_number
from periodic.waveforms import Trigonometric
from perturb.general.blocks import MAX_SERIES_HARMONICS

# Harmonics to begin with, beyond those of the excitation, and rows of a matrix at which doubling them ends.
FIRST_HARMONICS = 8
MAX_BALANCED_ROWS = 1200

# Wanted change of a result, relative to it or to Omega, from half the harmonics to all of them.
BALANCE_TOLERANCE = 1e-11

# Rounding makes a complex pair of two real amplitudes that nearly coincide: imaginary part over modulus.
REAL_AMPLITUDE = 1e-7

# Where two edges touch they are one amplitude: difference over modulus.
SAME_AMPLITUDE = 1e-9

# Polynomial in eps (by power) of Fourier coefficients (by harmonic), for the matrices of the equations of motion.
Polynomial = dict[int, dict[int, ComplexArray]]


class BalancedAmplitudes(NamedTuple):
    """Amplitudes eps at which a multiplier is +1 or -1.

    Attributes
    ----------
    eps : ndarray, shape (m,)
        Increasing, >= 0.
    change : ndarray, shape (m,)
        By how much each changed when the harmonics were doubled for the last time.
    harmonics : int
        H; harmonics -H..H were balanced.
    """

    eps: FloatArray
    change: FloatArray
    harmonics: int


class BalancedExponents(NamedTuple):
    """Exponents from Hill's matrix.

    Attributes
    ----------
    exponents : ndarray, shape (N,), complex
        One of each class modulo i Omega, by decreasing real part.
    change : float
        By how much the growth rate changed when the harmonics were doubled for the last time.
    harmonics : int
        H; harmonics -H..H were balanced.
    """

    exponents: ComplexArray
    change: float
    harmonics: int

    @property
    def growth_rate(self) -> float:
        """Largest real part."""
        return float(self.exponents[0].real)


def balanced_amplitudes(family: AnyFamily, Omega: float, multiplier: int, eps_max: float) -> BalancedAmplitudes:
    """Return all amplitudes up to ``eps_max`` at which a multiplier is +1 or -1: the edges of these kinds.

    Not every one is an edge: with the multiplier +1 or -1 a second solution may grow on both sides.

    Parameters
    ----------
    family : AnyFamily
    Omega : float
        Excitation frequency, > 0.
    multiplier : {1, -1}
        1 for solutions of the period T, -1 for those of 2 T.
    eps_max : float
        Largest amplitude, > 0.

    Raises
    ------
    ValueError
        If an argument is out of range, or a waveform is no finite Fourier sum.
    """
    Omega = real_number("Omega", Omega, positive=True)
    eps_max = real_number("eps_max", eps_max, positive=True)
    if multiplier not in (1, -1):
        raise ValueError(f"multiplier = {multiplier!r} is neither; give 1 or -1")
    system = any_member_at(family, Omega, "family")
    matrices = _matrices(system, Omega)
    H = FIRST_HARMONICS + _reach(matrices)
    found = _amplitudes(system, matrices, Omega, multiplier, H, eps_max)
    while True:
        more = _amplitudes(system, matrices, Omega, multiplier, 2 * H, eps_max)
        change = _changes(more, found)
        found, H = more, 2 * H
        if (change <= BALANCE_TOLERANCE * np.maximum(found, 1e-3 * eps_max)).all() or _rows(system, 2 * H) > (
            MAX_BALANCED_ROWS
        ):
            return BalancedAmplitudes(found, change, H)


def balanced_exponents(family: AnyFamily, Omega: float, eps: float) -> BalancedExponents:
    """Return the Floquet exponents at one point as eigenvalues of Hill's matrix.

    Parameters
    ----------
    family : AnyFamily
    Omega : float
        Excitation frequency, > 0.
    eps : float
        Excitation amplitude.

    Raises
    ------
    ValueError
        If an argument is out of range, or a waveform is no finite Fourier sum.
    """
    Omega, eps = real_number("Omega", Omega, positive=True), real_number("eps", eps)
    system = any_member_at(family, Omega, "family")
    matrices = _matrices(system, Omega)
    H = FIRST_HARMONICS + _reach(matrices)
    found = _exponents(system, matrices, Omega, eps, H)
    while True:
        more = _exponents(system, matrices, Omega, eps, 2 * H)
        change = abs(float(more[0].real - found[0].real)) if len(found) else np.inf
        found, H = more, 2 * H
        if change <= BALANCE_TOLERANCE * Omega or _rows(system, 2 * H) > MAX_BALANCED_ROWS:
            return BalancedExponents(found, change, H)


def _rows(system: AnySystem, H: int) -> int:
    return (1 if isinstance(system, FirstOrderSystem) else 2) * system.size * (2 * H + 1)


def _matrices(system: AnySystem, Omega: float) -> dict[str, Polynomial]:
    """Return the matrices of the equations: M, C (with G) and K, or A."""
    if isinstance(system, FirstOrderSystem):
        constant, name = {"A": system.constant}, {"state": "A"}
    else:
        damping = system.gyroscopic + system.damping
        constant = {"M": system.mass, "C": damping, "K": system.stiffness}
        name = {"mass": "M", "gyroscopic": "C", "damping": "C", "stiffness": "K"}
    found: dict[str, Polynomial] = {
        key: defaultdict(lambda: defaultdict(lambda: np.zeros((system.size, system.size), complex))) for key in constant
    }
    for key, X in constant.items():
        found[key][0][0] += X
    excited = found["A" if "A" in found else "K"]
    for j, (c, s) in enumerate(zip(system.cosine, system.sine, strict=True), start=1):
        if c.any() or s.any():
            excited[1][j] += 0.5 * (c - 1j * s)
            excited[1][-j] += 0.5 * (c + 1j * s)
    for term in system.terms:
        wave = term.waveform
        if not isinstance(wave, Trigonometric) or wave.harmonics > MAX_SERIES_HARMONICS:
            raise ValueError(
                f"family has a {term.of} term whose waveform is no Fourier sum of at most {MAX_SERIES_HARMONICS} "
                "harmonics; harmonic balance needs one (transition_curves and floquet/ take any)"
            )
        part = found[name[term.of]][term.power]
        for j, (cosine, sine) in enumerate(zip(wave.cosines, wave.sines, strict=True)):
            if j == 0 and cosine:
                part[0] += cosine * term.matrix
            elif cosine or sine:
                part[j] += 0.5 * (cosine - 1j * sine) * term.matrix
                part[-j] += 0.5 * (cosine + 1j * sine) * term.matrix
    return found


def _reach(matrices: dict[str, Polynomial]) -> int:
    """Return the highest harmonic."""
    return max(abs(j) for polynomial in matrices.values() for series in polynomial.values() for j in series)


def _toeplitz(series: dict[int, ComplexArray], count: int, size: int) -> ComplexArray:
    """Return the matrix with block series[h - h'] in row h, column h'."""
    total = np.zeros((count * size, count * size), dtype=complex)
    for j, X in series.items():
        if abs(j) < count:
            total += np.kron(np.eye(count, k=-j), X)
    return total


def _amplitudes(
    system: AnySystem, matrices: dict[str, Polynomial], Omega: float, multiplier: int, H: int, eps_max: float
) -> FloatArray:
    """Return the real eigenvalues eps of the balance of harmonics up to H."""
    harmonics = np.asarray(np.arange(-H, H + 1) if multiplier == 1 else np.arange(-H, H) + 0.5, dtype=float)
    count, n = len(harmonics), system.size
    turning = np.kron(np.diag(1j * harmonics * Omega), np.eye(n))
    factors = {"M": turning @ turning, "C": turning, "K": np.eye(count * n), "A": np.eye(count * n)}
    degree = max(max(polynomial) for polynomial in matrices.values())
    balance = [np.zeros((count * n, count * n), dtype=complex) for _ in range(degree + 1)]
    for name, polynomial in matrices.items():
        for power, series in polynomial.items():
            balance[power] += _toeplitz(series, count, n) @ factors[name]
    if "A" in matrices:
        balance[0] -= turning
    if degree == 0:
        return np.zeros(0)
    U = np.asarray(np.kron(_real_basis(harmonics), np.eye(n, dtype=complex)), dtype=complex)
    real: list[FloatArray] = [np.asarray((U.conj().T @ X @ U).real) for X in balance]
    scale: FloatArray = 1 / np.abs(real[0]).max(axis=1)
    real = [np.asarray(scale[:, None] * X, dtype=float) for X in real]
    # companion form of sum_m eps^m B_m: the first row of blocks holds B_0, and the others define the powers
    size = count * n
    left, right = np.eye(degree * size), np.zeros((degree * size, degree * size))
    left[:size, :size] = real[0]
    for power in range(1, degree + 1):
        right[:size, (power - 1) * size : power * size] = -real[power]
    right[size:, :-size] = np.eye((degree - 1) * size)
    alpha, beta = eig(left, right, right=False, homogeneous_eigvals=True)
    finite = np.abs(beta) * eps_max * (1 + REAL_AMPLITUDE) >= np.abs(alpha)
    eps = alpha[finite] / beta[finite]
    real_ones = eps[(np.abs(eps.imag) <= REAL_AMPLITUDE * np.abs(eps)) & (eps.real >= 0)].real
    found = np.sort(real_ones[real_ones <= eps_max])
    return np.asarray(found[np.concatenate([[True], np.diff(found) > SAME_AMPLITUDE * found[1:]])[: len(found)]])


def _real_basis(harmonics: FloatArray) -> ComplexArray:
    """Return the unitary matrix from cosines and sines to e^{i h theta}, harmonics symmetric about zero."""
    count = len(harmonics)
    U = np.zeros((count, count), dtype=complex)
    for k in range(count // 2):
        mirror = count - 1 - k
        U[[k, mirror], k] = 1 / np.sqrt(2)
        U[[k, mirror], mirror] = -1j / np.sqrt(2), 1j / np.sqrt(2)
    if count % 2:
        U[count // 2, count // 2] = 1
    return U


def _changes(values: FloatArray, before: FloatArray) -> FloatArray:
    """Return how far each value is from the nearest one before."""
    if not len(before):
        return np.full(len(values), np.inf)
    return np.asarray(np.abs(np.subtract.outer(values, before)).min(axis=1))


def _exponents(system: AnySystem, matrices: dict[str, Polynomial], Omega: float, eps: float, H: int) -> ComplexArray:
    """Return the exponents from Hill's matrix of harmonics up to H."""
    harmonics = np.arange(-H, H + 1)
    count, n = len(harmonics), system.size
    turning = np.kron(np.diag(1j * harmonics * Omega), np.eye(n))
    whole = {
        name: sum(eps**power * _toeplitz(series, count, n) for power, series in polynomial.items())
        for name, polynomial in matrices.items()
    }
    if "A" in whole:
        hill = whole["A"] - turning
    else:
        pushes = np.linalg.solve(whole["M"], np.concatenate([whole["C"], whole["K"]], axis=1))
        one = np.eye(count * n)
        hill = np.block([[-turning - pushes[:, : count * n], -pushes[:, count * n :]], [one, -turning]])
    N = n if "A" in whole else 2 * n
    values = np.linalg.eigvals(hill)
    middle = values[np.abs(values.imag) <= 1.5 * Omega]  # far from the cut
    phases = np.sort(middle.imag % Omega)
    gaps = np.diff(np.concatenate([phases, [phases[0] + Omega]]))
    start = float(phases[int(gaps.argmax())] + 0.5 * gaps.max()) % Omega - Omega
    found = middle[(middle.imag >= start) & (middle.imag < start + Omega)]
    found = found[np.argsort(-found.real, kind="stable")]
    return np.asarray(found) if len(found) == N else np.zeros(0, dtype=complex)
