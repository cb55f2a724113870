"""Two modes coupled by resonance: the 2 x 2 amplitude equations behind eqs. (25) and (27), solved in closed form.

With the detuning s = j Omega - (omega_p ± omega_q), the amplitudes of a resonant pair grow like e^{lambda t}, where
lambda is an eigenvalue of

    1/2 [[-C_p - i s, a], [b, -C_q + i s]],     L = a b.

C_p, C_q are the decay coefficients (c c_p of the paper), and L = eps^2 Lambda_pq conj(Lambda_qp) to first order. Every
function here takes arrays that broadcast together. L is real for symmetric excitation matrices and complex in general.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from periodic.checks import FloatArray


class Detuning(NamedTuple):
    """The detuning s = j Omega - (omega_p ± omega_q) as a function of x = Omega - centre: s = rate x + bend x^2.

    Where the modes do not depend on Omega, rate is j and bend is 0.
    """

    rate: float
    bend: float

    def __call__(self, x: FloatArray) -> FloatArray:
        """Return s at x."""
        return self.rate * x + self.bend * x**2 if self.bend else self.rate * x

    def between(self, low: FloatArray, high: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the interval of x around the resonance in which low < s < high.

        Where s turns round before it reaches one of the two, the interval goes on to where it comes back to the other.
        """
        if self.rate < 0:
            lower, upper = Detuning(-self.rate, self.bend).between(low, high)
            return -upper, -lower
        if not self.bend:
            return low / self.rate, high / self.rate
        with np.errstate(invalid="ignore", divide="ignore"):
            root_low, root_high = (np.sqrt(self.rate**2 + 4 * self.bend * s) for s in (low, high))
            lower, upper = (
                np.where(np.isinf(s) | (s == 0), s, 2 * s / (self.rate + root))
                for s, root in ((low, root_low), (high, root_high))
            )
            beyond_low, beyond_high = (-(self.rate + root) / (2 * self.bend) for root in (root_high, root_low))
        return (
            np.where(np.isnan(root_low) & np.isfinite(low), beyond_low, lower),
            np.where(np.isnan(root_high) & np.isfinite(high), beyond_high, upper),
        )


def pair_growth(C_p: ArrayLike, C_q: ArrayLike, L: ArrayLike, s: ArrayLike) -> FloatArray:
    """Return the larger real part of the two eigenvalues."""
    C_p, C_q, L, s = np.broadcast_arrays(C_p, C_q, L, s)
    S, D = (C_p + C_q) / 2, (C_p - C_q) / 2
    return 0.5 * (np.sqrt((D + 1j * s) ** 2 + L).real - S)


def pair_edges(C_p: ArrayLike, C_q: ArrayLike, L: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Return the detunings between which the pair is unstable; NaN where it is stable at every detuning.

    The larger real part vanishes where C_p C_q s^2 - D Im(L) s - Im(L)^2 / 4 - S^2 (Re(L) - C_p C_q) = 0, with
    S = (C_p + C_q) / 2, D = (C_p - C_q) / 2. For real L this is s = ± S sqrt(L / (C_p C_q) - 1), eq. (25).
    An edge is infinite where the instability does not end at any detuning: a damped mode coupled to one without
    damping, a complex L without damping, a mode that grows by itself. An undamped pair with L = 0 has both edges at 0.
    """
    C_p, C_q, L = np.broadcast_arrays(C_p, C_q, L)
    S, D, product = (C_p + C_q) / 2, (C_p - C_q) / 2, C_p * C_q
    real, imag = L.real, L.imag
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        # both modes damped, eqs. (25), (27); discriminant < 0: stable at every detuning, NaN
        root = S * np.sqrt(imag**2 + 4 * product * (real - product))
        middle = D * imag
        low, high = (middle - root) / (2 * product), (middle + root) / (2 * product)
        # one mode damped: the condition is linear in s
        bound = -(imag**2 / 4 + S**2 * real) / middle
        half_damped = (product == 0) & (S > 0)
        low = np.where(half_damped, np.where(middle > 0, bound, -np.inf), low)
        high = np.where(half_damped, np.where(middle < 0, bound, np.inf), high)
        never = half_damped & (imag == 0) & (real <= 0)
        # neither damped: eigenvalues ± sqrt(L - s^2) / 2
        undamped = (C_p == 0) & (C_q == 0)
        low = np.where(undamped, np.where(imag == 0, -np.sqrt(real), -np.inf), low)
        high = np.where(undamped, np.where(imag == 0, np.sqrt(real), np.inf), high)
    low, high = np.where(never, np.nan, low), np.where(never, np.nan, high)
    grows_alone = (S < 0) | (product < 0)
    return np.where(grows_alone, -np.inf, low), np.where(grows_alone, np.inf, high)


def pair_edges_vanishing(c_p: ArrayLike, c_q: ArrayLike, L: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Return the limit of `pair_edges` for C_p = alpha c_p, C_q = alpha c_q with alpha -> 0.

    It is not the undamped result: for real L the edges ± sqrt(L) move out by (c_p + c_q) / (2 sqrt(c_p c_q)).
    """
    c_p, c_q, L = np.broadcast_arrays(c_p, c_q, L)
    with np.errstate(invalid="ignore"):
        half = np.where(L.imag == 0, _widening(c_p, c_q) * np.sqrt(L.real), np.inf)
    return -half, half


def pair_tip(C_p: ArrayLike, C_q: ArrayLike, L: ArrayLike) -> FloatArray:
    """Return the eps at which the region opens, for L the value at eps = 1 of a product that grows like eps^2."""
    C_p, C_q, L = np.broadcast_arrays(C_p, C_q, L)
    reach = np.abs(L) + L.real  # 2 L where L is real and positive, 0 where it is real and negative
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        tip = np.sqrt(2 * C_p * C_q / reach)
    return np.where(reach > 0, tip, np.inf)


def pair_slope(C_p: ArrayLike, C_q: ArrayLike, L: ArrayLike) -> FloatArray:
    """Return d(half width in s) / d eps as eps grows, for L as in `pair_tip`."""
    C_p, C_q, L = np.broadcast_arrays(C_p, C_q, L)
    with np.errstate(invalid="ignore"):
        slope = np.where(L.real > 0, _widening(C_p, C_q) * np.sqrt(L.real), 0.0)
    return np.where(L.imag == 0, slope, np.inf)


def _widening(C_p: FloatArray, C_q: FloatArray) -> FloatArray:
    """Return how much wider damping makes the region at large eps: arithmetic over geometric mean of C_p and C_q."""
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        return np.where(C_p + C_q > 0, (C_p + C_q) / (2 * np.sqrt(C_p * C_q)), 1.0)
