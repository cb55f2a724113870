"""The first-order form x' = (A_0 + sum_m eps^m sum_j A_mj e^{i j Omega t}) x of any linear periodic system.

For second-order systems x = (W', W). Where energy is neither fed nor taken at any time, x = (p, W), p = M W' + G W / 2:

    W' = M^-1 (p - G W / 2),    p' = - (G / 2 + C - M') W' - (K - G' / 2) W

are Hamilton's equations if C = M' and K - G' / 2 is symmetric, as for pulsating speed, and theory keeps their structure
at every order. The momentum is also what goes on where the mass jumps. A periodic mass is expanded: with
M = M_0 + eps M_1 + eps^2 M_2,

    M^-1 = N_0 + eps N_1 + eps^2 N_2,   N_1 = - N_0 M_1 N_0,   N_2 = N_0 (M_1 N_0 M_1 - M_2) N_0,

where a product of two periodic matrices is the convolution of their Fourier coefficients.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from periodic import AnySystem, FirstOrderSystem, PeriodicSystem, Term
from periodic.checks import ComplexArray, FloatArray
from periodic.terms import SYMMETRY_TOLERANCE
from periodic.waveforms import Impulses, Piecewise, Trigonometric, Waveform

# What a waveform has beyond its first J harmonics reaches an edge through two interactions with a harmonic above J,
# as rest^2 / (J Omega). J is doubled until this is below a part of what the waveform itself amounts to, or J is at its
# limit, where pulses and nothing else go on.
SERIES_PART = 1e-4
MAX_SERIES_HARMONICS = 128

# Fourier coefficients of one matrix by their harmonic: the part that goes with e^{i j Omega t}.
Series = dict[int, ComplexArray]


class Blocks(NamedTuple):
    """Coefficients of x' = A(t) x.

    Attributes
    ----------
    constant : ndarray, shape (N, N)
        A_0.
    first, second : dict
        A_1j and A_2j by their harmonic j, which may be negative or zero; those that are zero are left out.
    velocity : ndarray, shape (N, N)
        T of (W', W) = T x without excitation; of a first-order system the unit matrix.
    conservative : bool
        The equations are Hamilton's: A is J times a symmetric matrix at all times.
    """

    constant: FloatArray
    first: Series
    second: Series
    velocity: FloatArray
    conservative: bool = False

    def equals(self, other: Blocks) -> bool:
        """Whether all coefficients are the same."""
        return self is other or (
            np.array_equal(self.constant, other.constant)
            and all(
                ours.keys() == theirs.keys() and all(np.array_equal(ours[j], theirs[j]) for j in ours)
                for ours, theirs in ((self.first, other.first), (self.second, other.second))
            )
        )


def first_order_blocks(system: AnySystem, Omega: float) -> Blocks:
    """Return the coefficients of the first-order form, to second order in eps.

    Parameters
    ----------
    system : PeriodicSystem or FirstOrderSystem
    Omega : float
        Frequency; the Fourier coefficients of pulses are proportional to it.
    """
    if isinstance(system, FirstOrderSystem):
        once, twice = (_series(system, "state", power, Omega) for power in (1, 2))
        return Blocks(system.constant, _present(once), _present(twice), np.eye(system.size))
    jumps = any(
        term.of == "mass" and isinstance(term.waveform, Piecewise) and _steps(term.waveform).any()
        for term in system.terms
    )
    if jumps or not system.damping.any():
        momentum = _momentum_form(system, Omega)
        if jumps or momentum.conservative:
            return momentum
    return _velocity_form(system, Omega)


def _velocity_form(system: PeriodicSystem, Omega: float) -> Blocks:
    """Return the coefficients for x = (W', W)."""
    N, G, C, K = _matrices(system, Omega)
    one, zero = np.eye(system.size), np.zeros((system.size, system.size))
    pushes = _powers(N, [_sum(both) for both in zip(G, C, strict=True)]), _powers(N, K)
    whole = [_joined(_times(-1, pushes[0][m]), _times(-1, pushes[1][m]), {}, {}, system.size) for m in range(3)]
    constant = whole[0][0].real + np.block([[zero, zero], [one, zero]])
    return Blocks(constant, _present(whole[1]), _present(whole[2]), np.eye(2 * system.size))


def _momentum_form(system: PeriodicSystem, Omega: float) -> Blocks:
    """Return the coefficients for x = (p, W)."""
    n = system.size
    N, G, C, K = _matrices(system, Omega)
    half = [_times(0.5, series) for series in G]
    C = [_sum([C[m], _times(-1, _rate_of_mass(system, m, Omega))]) for m in range(3)]
    K = [_sum([K[m], {j: -1j * j * Omega * X for j, X in half[m].items() if j}]) for m in range(3)]
    turned = _powers(N, half)
    push = [_times(-1, _sum(both)) for both in zip(half, C, strict=True)]  # of W' on p
    held = [_times(-1, _sum(both)) for both in zip(K, _powers(push, turned), strict=True)]  # of W on p
    pushed = _powers(push, N)
    whole = [_joined(pushed[m], held[m], N[m], _times(-1, turned[m]), n) for m in range(3)]
    constant = whole[0][0].real
    velocity = np.block([[constant[n:, :n], constant[n:, n:]], [np.zeros((n, n)), np.eye(n)]])
    J = np.block([[np.zeros((n, n)), -np.eye(n)], [np.eye(n), np.zeros((n, n))]])
    hessians = [J.T @ A for series in whole for A in series.values()]
    conservative = all(np.abs(X - X.T).max() <= SYMMETRY_TOLERANCE * np.abs(X).max() for X in hessians)
    return Blocks(constant, _present(whole[1]), _present(whole[2]), velocity, conservative)


def _matrices(system: PeriodicSystem, Omega: float) -> tuple[list[Series], ...]:
    """Return M^-1, G, C and K by powers of eps."""
    steady = (system.mass, system.gyroscopic, system.damping, system.stiffness)
    M, G, C, K = (
        [{0: X.astype(complex)}, *(_series(system, of, power, Omega) for power in (1, 2))]
        for of, X in zip(("mass", "gyroscopic", "damping", "stiffness"), steady, strict=True)
    )
    inverse: FloatArray = np.asarray(np.linalg.inv(system.mass), dtype=float)
    return [{0: inverse.astype(complex)}, *_inverse(inverse, *M[1:])], G, C, K


def _joined(a: Series, b: Series, c: Series, d: Series, n: int) -> Series:
    """Return [[a, b], [c, d]]."""
    total: defaultdict[int, ComplexArray] = defaultdict(lambda: np.zeros((2 * n, 2 * n), complex))
    for series, row, column in ((a, 0, 0), (b, 0, n), (c, n, 0), (d, n, n)):
        for j, X in series.items():
            total[j][row : row + n, column : column + n] += X
    return dict(total)


def has_pulses(system: AnySystem) -> bool:
    """Whether a term consists of impulses."""
    return any(isinstance(term.waveform, Impulses) for term in system.terms)


def _series(system: AnySystem, of: str, power: int, Omega: float) -> Series:
    """Return the Fourier coefficients of the part of one matrix that goes with eps^power."""
    total: defaultdict[int, ComplexArray] = defaultdict(lambda: np.zeros((system.size, system.size), complex))
    if power == 1 and of in ("stiffness", "state"):
        for j, (c, s) in enumerate(zip(system.cosine, system.sine, strict=True), start=1):
            total[j] += 0.5 * (c - 1j * s)
            total[-j] += 0.5 * (c + 1j * s)
    for term in _terms(system.terms, of, power):
        cosines, sines = _coefficients(term.waveform)
        factor = Omega if isinstance(term.waveform, Impulses) else 1.0
        for j in np.flatnonzero((cosines != 0) | (sines != 0)).tolist():
            if j == 0:
                total[0] += factor * cosines[0] * term.matrix
                continue
            total[j] += factor * 0.5 * (cosines[j] - 1j * sines[j]) * term.matrix
            total[-j] += factor * 0.5 * (cosines[j] + 1j * sines[j]) * term.matrix
    return dict(total)


def _terms(terms: Iterable[Term], of: str, power: int) -> list[Term]:
    return [term for term in terms if (term.of, term.power) == (of, power)]


@lru_cache(maxsize=64)
def _coefficients(waveform: Waveform) -> tuple[FloatArray, FloatArray]:
    """Return the Fourier coefficients of a waveform, as many as theory takes."""
    if isinstance(waveform, Trigonometric):
        return waveform.fourier(waveform.harmonics)[:2]
    J = 1
    while True:
        cosines, sines, rest = waveform.fourier(J)
        size = np.hypot(cosines, sines)
        if J >= MAX_SERIES_HARMONICS or rest**2 <= SERIES_PART * J * (size @ size):
            return cosines, sines
        J *= 2


def _rate_of_mass(system: PeriodicSystem, power: int, Omega: float) -> Series:
    """Return the Fourier coefficients of dM/dt between its jumps, at which the momentum M W' goes on."""
    total: Series = {}
    for term in _terms(system.terms, "mass", power):
        cosines, sines = _coefficients(term.waveform)
        for j in range(-len(cosines) + 1, len(cosines)):
            k = abs(j)
            value = j * 0.5j * (cosines[k] - 1j * np.sign(j) * sines[k])
            if isinstance(term.waveform, Piecewise):
                phases = np.exp(-2j * np.pi * j * np.array(term.waveform.jumps))
                value -= phases @ _steps(term.waveform) / (2 * np.pi)
            total[j] = total.get(j, 0) + Omega * value * term.matrix
    return total


def _steps(waveform: Piecewise) -> FloatArray:
    """Return by how much a waveform jumps where another formula begins."""
    ends = [np.polynomial.polynomial.polyval(np.array([-1.0, 1.0]), np.array(piece)) for piece in waveform.pieces]
    return np.array([after[0] - before[1] for before, after in zip([ends[-1], *ends[:-1]], ends, strict=True)])


def _times(factor: float, series: Series) -> Series:
    return {j: factor * X for j, X in series.items()}


def _powers(a: list[Series], b: list[Series]) -> list[Series]:
    """Return the product of two matrices by powers of eps."""
    return [_sum([_product(a[m], b[power - m]) for m in range(power + 1)]) for power in range(3)]


def _inverse(N_0: FloatArray, M_1: Series, M_2: Series) -> tuple[Series, Series]:
    """Return N_1 and N_2."""
    N_1 = {j: -N_0 @ X @ N_0 for j, X in M_1.items()}
    twice = {j: -X for j, X in _product(M_1, N_1).items()}  # M_1 N_0 M_1 N_0
    N_2 = _sum([{j: N_0 @ X for j, X in twice.items()}, {j: -N_0 @ X @ N_0 for j, X in M_2.items()}])
    return N_1, N_2


def _product(a: Series, b: Series) -> Series:
    """Return the Fourier coefficients of a product."""
    total: Series = {}
    for j, X in a.items():
        for k, Y in b.items():
            total[j + k] = total.get(j + k, 0) + X @ Y
    return total


def _sum(parts: Iterable[Series]) -> Series:
    total: Series = {}
    for part in parts:
        for j, X in part.items():
            total[j] = total.get(j, 0) + X
    return total


def _present(series: Series) -> Series:
    """Return the coefficients that are not zero, by increasing harmonic."""
    return {j: series[j] for j in sorted(series) if series[j].any()}
