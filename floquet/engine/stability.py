"""What the multipliers of a cell say: the dominant one, its error, and whether the cell is stable.

The error of the monodromy matrix moves a multiplier that is far from all others by about as much. Two multipliers that
are the gap g apart move by E / g, and two that coalesce, as they do at the boundaries of regions, by sqrt(E). Here E is
the product of error and gap, which is smooth where multipliers coalesce.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from floquet.kind import Kind
from periodic.checks import ComplexArray, FloatArray

# Distance of two multipliers on the unit circle, in units of sqrt(E), beyond which they cannot meet and leave it: the
# error of the square of their distance is 4 E.
SAFE_GAP = 3.0
SMALLEST_NORMAL = float(np.finfo(float).tiny)  # the smallest float of full accuracy
LARGE_SUM = 1e8  # modulus of mu + 1/mu from which on it is mu to within rounding


class Stability(NamedTuple):
    """Growth, error and verdict of each cell; arrays of one shape."""

    log_modulus: FloatArray  # log|mu| of the dominant multiplier mu
    angle: FloatArray  # its argument, between 0 and pi
    error: FloatArray  # estimated error of log_modulus
    kind: NDArray[np.int8]


class DominantMultiplier(NamedTuple):
    """The dominant multiplier mu of each cell of a subsystem: log|mu|, argument and relative distance to the nearest
    other.

    If all multipliers are on the unit circle, ``gap`` is the smallest distance between any two. ``excess`` is the norm
    of the matrix in units of the dominant multiplier, at least 1: the value for a normal matrix.
    """

    log_modulus: FloatArray
    angle: FloatArray
    gap: FloatArray
    excess: FloatArray


@njit(cache=True, nogil=True)
def _square(z: complex) -> float:
    """Return |z|^2, without the root that |z| takes."""
    return z.real * z.real + z.imag * z.imag


@njit(cache=True, nogil=True)
def dominant_multiplier(
    mu: ComplexArray, exponents: FloatArray, norms: FloatArray, reversible: bool
) -> DominantMultiplier:
    """Return the dominant ones of the multipliers 2^exponents[c] mu[c, i], mu of shape (k, N).

    ``norms`` (k,) are those of the matrices at the scale of ``mu``.
    """
    k, N = mu.shape
    log_modulus, angle, gap, excess = np.empty(k), np.empty(k), np.empty(k), np.empty(k)
    for c in range(k):
        top, largest, nearest = 0, SMALLEST_NORMAL, np.inf
        for i in range(N):
            square = _square(mu[c, i])
            if square > largest:
                top, largest = i, square
        for i in range(N):
            if i == top or reversible:
                for j in range(N):
                    if j != i:
                        nearest = min(nearest, _square(mu[c, i] - mu[c, j]))
        log_modulus[c] = 0.5 * np.log(largest) + exponents[c] * np.log(2.0)
        angle[c] = abs(np.angle(mu[c, top]))
        gap[c] = np.sqrt(nearest / largest)
        excess[c] = max(norms[c] / np.sqrt(largest), 1.0)
    return DominantMultiplier(log_modulus, angle, gap, excess)


@njit(cache=True, nogil=True)
def exponent(s: complex, shift: float) -> tuple[float, float]:
    """Return log|mu| >= 0 and the argument in [0, pi] of the larger multiplier with mu + 1/mu = 2^shift s.

    With s = 2 cosh(u + i v), |s/2|^2 = sinh^2 u + cos^2 v and Im(s/2) = sinh u sin v.
    """
    if shift != 0.0 or abs(s) > LARGE_SUM:
        return np.log(abs(s)) + shift * np.log(2.0), abs(np.angle(s))
    a, b = 0.5 * s.real, 0.5 * abs(s.imag)
    if b == 0.0:
        if abs(a) <= 1.0:
            return 0.0, np.arccos(a)
        return np.arccosh(abs(a)), 0.0 if a > 0.0 else np.pi
    excess = a * a + b * b - 1.0
    size = np.hypot(excess, 2.0 * b)
    # sinh^2 u = (excess + size) / 2, without cancellation
    sinh = np.sqrt(0.5 * (excess + size) if excess > 0.0 else 2.0 * b * b / (size - excess))
    u = np.arcsinh(sinh)
    return u, np.arccos(min(max(a / np.cosh(u), -1.0), 1.0))


@njit(cache=True, nogil=True)
def dominant_of_sums(s: ComplexArray, exponents: FloatArray, norms: FloatArray) -> DominantMultiplier:
    """Return the dominant multipliers of cells with the sums mu + 1/mu = 2^exponents[c] s[c, i], s of shape (k, n)."""
    k, n = s.shape
    log_modulus, angle, gap, excess = np.empty(k), np.empty(k), np.empty(k), np.empty(k)
    u, v, cosines = np.zeros(n), np.zeros(n), np.zeros(n)
    for c in range(k):
        on_circle, largest = exponents[c] == 0.0, 4.0 ** -exponents[c]  # mu + 1/mu may be zero, mu not
        for i in range(n):
            square = _square(s[c, i])
            if square > largest:  # NaN is not
                largest = square
            cosines[i] = 0.5 * s[c, i].real
            on_circle &= s[c, i].imag == 0.0 and abs(cosines[i]) <= 1.0
        excess[c] = max(norms[c] / max(np.sqrt(largest), SMALLEST_NORMAL), 1.0)
        if on_circle:
            log_modulus[c], angle[c], gap[c] = 0.0, np.arccos(cosines[0]), _least_chord(cosines)
            continue
        count, top = 0, 0
        for i in range(n):
            if s[c, i].imag >= 0.0:  # s and conj(s) belong to one pair mu, 1 / conj(mu) in the upper half plane
                u[count], v[count] = exponent(s[c, i], exponents[c])
                if u[count] > u[top]:
                    top = count
                count += 1
        nearest = _distance_to_images(u[top], v[top])
        for i in range(count):
            if i != top:
                nearest = min(nearest, np.hypot(u[top] - u[i], v[top] - v[i]))
        log_modulus[c], angle[c], gap[c] = u[top], v[top], nearest
    return DominantMultiplier(log_modulus, angle, gap, excess)


@njit(cache=True, nogil=True)
def _least_chord(cosines: FloatArray) -> float:
    """Return the smallest distance between points on the unit circle, given their cosines, which are sorted in
    place."""
    last_c, last_s, least = 1.0, 0.0, np.inf
    for i in range(1, cosines.size):  # by insertion: there are few, and Numba's sort takes longer to begin
        c, k = cosines[i], i
        while k > 0 and cosines[k - 1] > c:
            cosines[k] = cosines[k - 1]
            k -= 1
        cosines[k] = c
    for i in range(cosines.size - 1, -1, -1):
        c = cosines[i]
        sine = np.sqrt((1.0 - c) * (1.0 + c))
        least = min(least, 2.0 * sine)  # a point in the upper half plane and its mirror image
        if i < cosines.size - 1:
            least = min(least, np.sqrt((c - last_c) ** 2 + (sine - last_s) ** 2))
        last_c, last_s = c, sine
    return least


@njit(cache=True, nogil=True)
def _distance_to_images(u: float, v: float) -> float:
    """Return the distance, in log mu, of the multiplier exp(u + i v), u > 0, from 1/conj(mu) and conj(mu)."""
    across = min(2.0 * v, 2.0 * (np.pi - v))
    return 2.0 * u if across == 0.0 else min(2.0 * u, across)


@njit(cache=True, nogil=True)
def discrepancy(mu: ComplexArray, other: ComplexArray) -> FloatArray:
    """Return E (k,), in units of the dominant multiplier, from two computations of all multipliers (k, N)."""
    k, N = mu.shape
    E = np.zeros(k)
    for c in range(k):
        size = np.abs(mu[c]).max()
        for i in range(N):
            shift, gap = np.inf, 1.0
            for j in range(N):
                shift = min(shift, abs(mu[c, i] - other[c, j]) / size)
                if j != i:
                    gap = min(gap, abs(mu[c, i] - mu[c, j]) / size)
            E[c] = max(E[c], shift * max(gap, shift))
    return E


def judge(found: DominantMultiplier, E: FloatArray, reciprocal: bool) -> Stability:
    """Return the stability of a subsystem; ``reciprocal``: with mu also 1 / conj(mu) is a multiplier."""
    with np.errstate(divide="ignore"):
        error = np.minimum(E / np.minimum(found.gap, 1), np.sqrt(E))
    log_modulus = found.log_modulus
    real = np.where(found.angle <= error, Kind.PLUS_ONE, Kind.COMPLEX)
    unstable = np.where(np.pi - found.angle <= error, Kind.MINUS_ONE, real)
    if reciprocal:
        held = (np.abs(log_modulus) <= error) & (found.gap > SAFE_GAP * np.sqrt(E))
        stable = np.where(held, Kind.STABLE, Kind.UNDECIDED)
        log_modulus, error = np.where(held, 0.0, log_modulus), np.where(held, E, error)
    else:
        stable = np.where(log_modulus < -error, Kind.STABLE, Kind.UNDECIDED)
    kind = np.where(log_modulus > error, unstable, stable).astype(np.int8)
    return Stability(log_modulus, found.angle, error, kind)


def combine(subsystems: list[Stability]) -> Stability:
    """Return the stability of a system from that of its independent subsystems."""
    log_modulus = np.array([part.log_modulus for part in subsystems])
    error = np.array([part.error for part in subsystems])
    kinds = np.array([part.kind for part in subsystems])
    angles = np.array([part.angle for part in subsystems])
    value = log_modulus.max(axis=0)
    above = (log_modulus + error).max(axis=0) - value
    below = value - (log_modulus - error).max(axis=0)
    # an unstable subsystem makes the system unstable; otherwise an undecided one leaves it undecided
    unstable = kinds > Kind.STABLE
    top = np.where(unstable | ~unstable.any(axis=0), log_modulus, -np.inf).argmax(axis=0)[None]
    angle, dominant_kind = (np.take_along_axis(array, top, axis=0)[0] for array in (angles, kinds))
    kind = np.where(unstable.any(axis=0), dominant_kind, kinds.min(axis=0))
    return Stability(value, angle, np.maximum(above, below), kind)
