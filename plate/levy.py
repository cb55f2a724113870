"""The exact static in-plane stress: Lévy's series, what converges slowly in it summed in closed form.

Eqs. (2a, b) without inertia and transport, with v = 0 and N_xx = f(Y) at X = 0, r and free edges Y = 0, 1. Both ends
carry the same load, so that N_xx and N_yy are even about X = r/2 and N_xy is odd. With alpha = m pi / r, m = 1, 3, 5,
..., and g = 4 / (m pi), for which sum g sin(alpha X) = 1 inside the plate,

    N_xx = sum g p(Y) sin(alpha X)     N_yy = sum g q(Y) sin(alpha X)     N_xy = sum g t(Y) cos(alpha X)

Equilibrium is t' = alpha (f - p) and q' = alpha t, so that q = -alpha^2 phi, t = -alpha phi' and p = f + phi'' for one
function phi of each m. Compatibility is (d^2/dY^2 - alpha^2)^2 phi = -(f'' + nu alpha^2 f), a free edge phi = phi' = 0.
Three parts make up phi: the right side against the kernel (1 + alpha |s|) e^{-alpha |s|} / (4 alpha^3) of an endless
strip, a wave (A + B alpha Y) e^{-alpha Y} from the free edge Y = 0, and its like from Y = 1.

For large m, p, q and t are sums of powers of alpha times e^{-alpha D}. D = 0 belongs to f and its derivatives at Y
itself; elsewhere D is the distance from a break of f (its two ends among them), direct or by way of a free edge. These
sums are exact but for what a second free edge reflects, e^{-alpha} times smaller. Where D is small they make the series
converge slowly, and so they are summed in closed form over all the terms beyond the first few hundred.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache, cached_property
from itertools import pairwise

import numpy as np
from numpy.polynomial.polynomial import polyder, polyval
from scipy.special import exp1, zeta

from periodic.checks import ComplexArray, FloatArray
from plate.basis import gauss_legendre
from plate.distribution import Distribution
from plate.transverse import NumericArray

# Beyond this x, e^-x is rounding: integrals and sums of it end here.
NEGLIGIBLE_EXPONENT = 37.0

# Nodes of Gauss's rule that integrate e^-x from 0 to NEGLIGIBLE_EXPONENT to rounding.
EXPONENTIAL_NODES = 20

# Terms up to (1 + 1/r) times this alpha are summed one by one, the others in closed form, with f and its derivatives up
# to this order; the next would enter with alpha^-5.
MAX_SUMMED_ALPHA = 1000.0
LOAD_DERIVATIVES = 3

# The closed form is accurate for a piece of width w and degree n > 3 if alpha w is at least this times n^2. The degree
# is that of the last Legendre coefficient above LEGENDRE_TOLERANCE, a part of the largest one.
MIN_SMOOTH_PHASE = 8.0
LEGENDRE_TOLERANCE = 1e-9

# Narrower pieces (in b) are taken as straight: their third derivative would be rounding.
MIN_CURVED_WIDTH = 1e-6

# Powers of alpha in the closed form: a break adds a factor alpha D to its own power, a free edge another one alpha Y.
ALPHA_POWERS = np.arange(-LOAD_DERIVATIVES, 3)

# Orders of the correction in `sum_of_tail`: after a hundred terms the next order is rounding.
EULER_MACLAURIN_ORDERS = 9
# Terms of its power series in z. The largest |z|, 1.6, is 0.51 of the radius of convergence.
POWER_SERIES_TERMS = 60
# Beyond this |x| `exponential_integral` takes this many terms of the asymptotic series in 1/x.
MIN_ASYMPTOTIC_ARGUMENT = 50.0
ASYMPTOTIC_TERMS = 40

# Smallest distance from a singular point, as a part of the length a: nearer points differ by rounding only.
MIN_SINGULAR_DISTANCE = 1e-12


def static_stresses(load: Distribution, r: float, nu: float, X: FloatArray, Y: FloatArray) -> FloatArray:
    """Return N_xx, N_yy, N_xy of the edge load f on a grid, shape (3, X.size, Y.size).

    The error is about 1e-11 of the largest load, even beside edges, corners and jumps, if the pieces of f are of degree
    up to three or as smooth as half a wave over the width. Next to narrow pieces of a higher degree it is up to 1e-5.

    On X = 0 and r the stress is N_xx = f and N_yy = nu f, as the supports impose. Where f jumps it is that of the
    middle of the jump. There N_xy grows like the logarithm of the distance; its value `MIN_SINGULAR_DISTANCE` r away is
    returned. At a corner where f is not zero the stress depends on the direction of approach; what the edges impose is
    returned, N_xx = f and N_yy = N_xy = 0.

    Parameters
    ----------
    load : Distribution
        f.
    r : float
        Aspect ratio.
    nu : float
        Poisson's ratio.
    X : ndarray, shape (p,)
        Places from 0 to r.
    Y : ndarray, shape (q,)
        Places from 0 to 1, increasing.
    """
    derivatives = [smoothed(load)]
    for _ in range(LOAD_DERIVATIVES):
        derivatives.append(derivatives[-1].derivative)
    weights = kernel_weights(nu)
    series = Series(r, np.minimum(X, r - X))

    stress = series.first_terms(series_coefficients(load, series.alpha, weights, Y))
    values = np.array([load(Y), *(f(Y) for f in derivatives[1:])])
    stress += series.rest_here @ local_coefficients(values, weights)
    for y, *jumps in zip(derivatives[0].breaks, *(f.jumps for f in derivatives), strict=True):
        # a place on a break belongs to the piece to its right, as do the values of f
        side = np.where((y > Y) | (y == 1), 1.0, -1.0)
        D = np.abs(Y - y)
        stress += series.rest(D, break_coefficients(np.array(jumps), side, D, weights))
        for edge in (0, 1):
            as_seen = (-1.0) ** (edge * np.arange(1, LOAD_DERIVATIVES + 2)) * jumps  # as jumps of f(1 - Y) for edge 1
            d, D = abs(y - edge), np.abs(Y - edge)
            stress += mirrored(edge, series.rest(d + D, edge_coefficients(as_seen, d, D, weights)))

    N_xx, N_yy, N_xy = stress[0].imag, stress[1].imag, stress[2].real
    N = np.stack([N_xx, N_yy, np.where(r / 2 < X, -1.0, 1.0)[:, None] * N_xy])
    ends, free = series.X == 0, (Y == 0) | (Y == 1)
    N[:, ends[:, None] & free] = 0.0
    N[0, ends] = np.where(free, load(Y), N[0, ends])
    return N


def smoothed(load: Distribution) -> Distribution:
    """Return the load with rough pieces cut into cubics and the narrowest ones made straight, for the closed form."""
    breaks, rows = [0.0], []
    slopes = load.derivative
    for i, (start, end) in enumerate(pairwise(load.breaks)):
        width, row = end - start, load.coefficients[i]
        degree = np.max(np.flatnonzero(np.abs(row) > LEGENDRE_TOLERANCE * np.abs(row).max()), initial=0)
        rough = degree > LOAD_DERIVATIVES and MAX_SUMMED_ALPHA * width < MIN_SMOOTH_PHASE * degree**2
        parts = degree**2 if rough else 1
        narrow = degree > 1 and width < MIN_CURVED_WIDTH * parts
        if not (rough or narrow):
            breaks.append(end)
            rows.append(row)
            continue
        places = np.linspace(start, end, 2 if narrow else parts + 1)
        places[-1] = end
        breaks += places[1:].tolist()
        for low, high in pairwise(places):
            ends = np.array([low, high])
            f, df = load.piece(i, ends), (high - low) / 2 * slopes.piece(i, ends)
            mean, rise = f.mean(), (f[1] - f[0]) / 2
            # Hermite's cubic in P_0 .. P_3
            bend, twist = (0.0, 0.0) if narrow else ((df[1] - df[0]) / 6, (df.mean() - rise) / 5)
            rows.append((mean - bend, rise - twist, bend, twist))
    return Distribution(tuple(breaks), tuple(rows))


def kernel_weights(nu: float) -> FloatArray:
    """Return the rows (a, b) of p, q and t in an endless strip, shape (3, 2).

    Let L_0 and L_1 be the integrals of alpha e^{-alpha s} f(Y - s) and alpha^2 s e^{-alpha s} f(Y - s) over s > 0, and
    R_0, R_1 those of f(Y + s). Then p and q are a (L_0 + R_0) + b (L_1 + R_1), and t is a (L_0 - R_0) + b (L_1 - R_1).
    """
    return np.array([[3 + nu, -1 - nu], [nu - 1, 1 + nu], [2, -1 - nu]]) / 4


def series_coefficients(load: Distribution, alpha: FloatArray, weights: FloatArray, Y: FloatArray) -> FloatArray:
    """Return p, q and t for each alpha, shape (3, alpha.size, Y.size)."""
    stations = np.union1d(load.breaks, Y)
    L, R = (one_sided_integrals(load, alpha, stations, direction) for direction in (1, -1))
    strip = np.concatenate([np.tensordot(weights[:2], L + R, 1), np.tensordot(weights[2:], L - R, 1)])
    pqt = strip[..., np.searchsorted(stations, Y)]

    # Waves from both free edges make q = t = 0 there. One pair of waves is even about the mid-line, the other is odd.
    at_edges = [mirrored(edge, strip[..., -edge]) for edge in (0, 1)]
    for parity in (1, -1):
        _, q, t = (at_edges[0] + parity * at_edges[1]) / 2
        e = parity * np.exp(-alpha)
        # A (1 + e) + B alpha e = q and A (1 - e) - B (1 - e + alpha e) = -t
        determinant = 1 - e**2 + 2 * alpha * e
        A = (q * (1 - e + alpha * e) - t * alpha * e) / determinant
        B = (q * (1 - e) + t * (1 + e)) / determinant
        for edge in (0, 1):
            x = np.outer(alpha, np.abs(Y - edge))
            wave = edge_wave(A[:, None], B[:, None], B[:, None] * x) * np.exp(-x)
            pqt += parity**edge * mirrored(edge, wave)
    return pqt


def one_sided_integrals(load: Distribution, alpha: FloatArray, stations: FloatArray, direction: int) -> FloatArray:
    """Return L_0 and L_1 (direction 1) or R_0 and R_1 (-1) of `kernel_weights`, shape (2, alpha.size, stations.size).

    ``stations`` run from 0 to 1 and hold the breaks of f. From one to the next the integrals decay and gain what lies
    between, by Gauss's rule over the part of it that e^{-alpha s} leaves.
    """
    integrals = np.zeros((2, alpha.size, stations.size))
    midpoints = (stations[1:] + stations[:-1]) / 2
    pieces = np.clip(np.searchsorted(load.breaks, midpoints, side="right") - 1, 0, len(load.coefficients) - 1)
    for interval in list(pairwise(range(stations.size)))[::direction]:
        origin, here = interval[::direction]
        piece = pieces[interval[0]]
        x_origin = alpha * abs(stations[here] - stations[origin])
        nodes, node_weights = gauss_legendre(EXPONENTIAL_NODES + len(load.coefficients[piece]) // 2, 0.0, 1.0)
        length = np.minimum(x_origin, NEGLIGIBLE_EXPONENT)[:, None]
        x = length * nodes
        gain = length * node_weights * np.exp(-x) * load.piece(piece, stations[here] - direction * x / alpha[:, None])
        decay = np.exp(-x_origin)
        zeroth, first = integrals[:, :, origin]
        integrals[0, :, here] = decay * zeroth + gain.sum(axis=1)
        integrals[1, :, here] = decay * (first + x_origin * zeroth) + (gain * x).sum(axis=1)
    return integrals


def local_coefficients(values: FloatArray, weights: FloatArray) -> FloatArray:
    """Return the factors of the powers of alpha in p, q and t that f at Y gives, shape (3, ALPHA_POWERS.size, q).

    ``values`` are those of f and its derivatives at Y, shape (LOAD_DERIVATIVES + 1, q). Far from breaks L_0 is the sum
    of (-1)^k f^(k) / alpha^k and L_1 that of (-1)^k (k + 1) f^(k) / alpha^k; R_0 and R_1 are the same without signs.
    """
    coefficients = np.zeros((3, ALPHA_POWERS.size, values.shape[1]))
    for k, value in enumerate(values):
        for row in (0, 1) if k % 2 == 0 else (2,):
            a, b = weights[row]
            coefficients[row, LOAD_DERIVATIVES - k] = (-1) ** k * 2 * (a + b * (k + 1)) * value
    return coefficients


def break_coefficients(jumps: FloatArray, side: FloatArray, D: FloatArray, weights: FloatArray) -> FloatArray:
    """Return the factors of alpha^j e^{-alpha D} in p, q, t that a break of f gives, shape (3, ALPHA_POWERS.size, q).

    Parameters
    ----------
    jumps : ndarray, shape (LOAD_DERIVATIVES + 1,)
        Values of f and its derivatives to the right of the break less those to the left.
    side : ndarray, shape (q,)
        1 for places to the left of the break, where R_0 and R_1 reach beyond it, -1 for those to the right.
    D : ndarray, shape (q,)
        Distances from it.
    weights : ndarray, shape (3, 2)
        As from `kernel_weights`.
    """
    coefficients = np.zeros((3, ALPHA_POWERS.size, D.size))
    for k, jump in enumerate(jumps):
        for row, (a, b) in enumerate(weights):
            factor = jump * side ** (k + 1) * (1.0 if row < 2 else -side)
            coefficients[row, LOAD_DERIVATIVES - k] += factor * (a + b * (k + 1))
            coefficients[row, LOAD_DERIVATIVES - k + 1] += factor * b * D
    return coefficients


def edge_coefficients(jumps: FloatArray, d: float, Y: FloatArray, weights: FloatArray) -> FloatArray:
    """Return the factors of alpha^j e^{-alpha (d + Y)} that belong to the wave which a break sends by way of Y = 0.

    Arguments as in `break_coefficients`; d is the distance of the break from that edge.
    """
    _, q, t = break_coefficients(jumps, np.ones(1), np.array([d]), weights)
    B_Y = np.zeros((ALPHA_POWERS.size, Y.size))
    B_Y[1:] = (q + t)[:-1] * Y
    return edge_wave(q, q + t, B_Y)


def edge_wave(A: FloatArray, B: FloatArray, B_Y: FloatArray) -> FloatArray:
    """Return p, q, t of phi = (A + B_Y) e^{-alpha Y} / alpha^2, B_Y = B alpha Y, without the exponential.

    With A = q and B = q + t it cancels a q and a t at the edge.
    """
    return np.stack([A - 2 * B + B_Y, -A - B_Y, A - B + B_Y])


def mirrored(edge: int, pqt: NumericArray) -> NumericArray:
    """Return p, q and t as they are for ``edge`` 0, and p, q and -t for 1: what Y -> 1 - Y makes of them."""
    return pqt if edge == 0 else np.concatenate([pqt[:2], -pqt[2:]])


@dataclass(frozen=True, eq=False)
class Series:
    """Sums over m = 1, 3, 5, ... at places X, all complex: N_xx and N_yy are imaginary parts, N_xy is a real part.

    Parameters
    ----------
    r : float
        Aspect ratio.
    X : ndarray, shape (p,)
        Places from 0 to r/2.
    """

    r: float
    X: FloatArray

    @cached_property
    def alpha(self) -> FloatArray:
        """alpha of the first terms, up to (1 + 1/r) `MAX_SUMMED_ALPHA`, shape (terms,).

        These are at least the hundred that `EULER_MACLAURIN_ORDERS` wants, however short the plate.
        """
        count = math.ceil(MAX_SUMMED_ALPHA * (1 + self.r) / (2 * math.pi))
        return np.arange(1.0, 2.0 * count, 2.0) * (math.pi / self.r)

    def first_terms(self, coefficients: FloatArray) -> ComplexArray:
        """Return the sum of coefficients g e^{i alpha X}, shape (..., p, q) from (..., terms, q)."""
        return 4 / (self.alpha * self.r) * np.exp(1j * np.outer(self.X, self.alpha)) @ coefficients

    @cached_property
    def rest_here(self) -> ComplexArray:
        """The sums of g alpha^j e^{i alpha X} over all other terms, shape (p, ALPHA_POWERS.size)."""
        inside = np.maximum(self.X / self.r, MIN_SINGULAR_DISTANCE**2)  # X = 0: the limit, where sum g sin(alpha X) = 1
        return self._sums(-1j * np.pi * inside).T

    def rest(self, D: FloatArray, coefficients: FloatArray) -> ComplexArray:
        """Return the sum of coefficients g alpha^j e^{-alpha D} e^{i alpha X} over all other terms, shape (3, p, q)."""
        total = np.zeros((3, self.X.size, D.size), dtype=np.complex128)
        near = self.alpha[-1] * D < NEGLIGIBLE_EXPONENT
        if near.any():
            z = np.pi / self.r * (D[near] - 1j * self.X[:, None])
            z[np.abs(z) < np.pi * MIN_SINGULAR_DISTANCE] = -1j * np.pi * MIN_SINGULAR_DISTANCE
            total[:, :, near] = np.einsum("cjq,jpq->cpq", coefficients[:, :, near], self._sums(z))
        return total

    def _sums(self, z: ComplexArray) -> ComplexArray:
        """Return the sums of g alpha^j e^{-m z} over all other terms, shape (ALPHA_POWERS.size, *z.shape)."""
        tails = [sum_of_tail(int(1 - j), 2 * self.alpha.size + 1, z) for j in ALPHA_POWERS]
        return np.stack([4 / np.pi * (np.pi / self.r) ** j * tail for j, tail in zip(ALPHA_POWERS, tails, strict=True)])


def sum_of_tail(k: int, start: int, z: ComplexArray) -> ComplexArray:
    """Return the sum of e^{-m z} / m^k over m = start, start + 2, ..., for Re z >= 0 and 0 < |z| < 1.6, k >= -1.

    Half the integral over m, start^(1 - k) E_k(start z), and what Euler and Maclaurin correct, the exponential kept:
    with h = m^-k this is e^{-start z} sum_j c_j(z) h^(j)(start) / j!, c_j(z) being the sum of s^j e^{-s z} over s = 0,
    2, 4, ... less half the integral. c_0 = 1/2 + (coth z - 1/z) / 2, and c_(j+1) = -c_j'.
    """
    half_integral = start ** (1.0 - k) / 2 * exponential_integral(k, start * z)
    return half_integral + np.exp(-start * z) * polyval(z, _corrections(k, start))


@cache
def _corrections(k: int, start: int) -> FloatArray:
    """Return the powers of z in sum_j h^(j)(start) / j! c_j(z)."""
    n = np.arange(1, POWER_SERIES_TERMS // 2)
    c: FloatArray = np.zeros(POWER_SERIES_TERMS)
    c[0], c[2 * n - 1] = 0.5, -((-1.0) ** n) * zeta(2.0 * n) / np.pi ** (2 * n)
    total, h = np.zeros(POWER_SERIES_TERMS), float(start) ** -k
    for j in range(EULER_MACLAURIN_ORDERS):
        total[: c.size] += h * c
        c, h = np.asarray(-polyder(c), dtype=np.float64), -h * (k + j) / ((j + 1) * start)
    return total


def exponential_integral(k: int, x: ComplexArray) -> ComplexArray:
    """Return E_k(x), the integral of e^{-x t} / t^k over t > 1, for Re x >= 0 and k >= -1 (DLMF 8.19)."""
    decay = np.exp(-x)
    if k <= 0:
        return decay / x if k == 0 else decay * (1 + 1 / x) / x
    E = exp1(x)
    for i in range(1, k):
        E = (decay - x * E) / i
    far = np.abs(x) > MIN_ASYMPTOTIC_ARGUMENT  # where the recursion loses digits
    rising = np.cumprod([1.0, *(-(k + n) for n in range(ASYMPTOTIC_TERMS))])
    E[far] = decay[far] / x[far] * polyval(1 / x[far], rising)
    return E
