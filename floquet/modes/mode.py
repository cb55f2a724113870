"""One Floquet mode: its exponent, its periodic part as a Fourier series, its damping."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from floquet.modes.places import Places
from periodic.checks import ComplexArray, FloatArray, real_array

# Shares are put in order as rounded to so many digits.
SHARE_DIGITS = 10


@dataclass(frozen=True, eq=False)
class FloquetMode:
    """One solution x(t) = p(t) e^{lambda t}, p periodic with T = 2 pi / Omega.

    Of a cluster (`FloquetModes.clusters`), one vector of a basis of its solutions: their whole is P(t) e^{L t}, and p
    is a column of P. The first one of a cluster is a solution.

    Attributes
    ----------
    exponent : complex
        lambda; its imaginary part is the frequency of the strongest harmonic.
    multiplier : complex
        e^{lambda T}; 0 where it is too small for a float.
    error : float
        Estimated error of the exponent, per unit of time.
    harmonics : ndarray of int, shape (H,)
        k = -K, ..., K.
    coefficients : ndarray of complex, shape (H, S)
        p(t) = sum_k coefficients[k] e^{i k Omega t}, in the state (W', W) or x.
    participation : ndarray, shape (H,)
        Share of each harmonic in the mean square of the mode over a period: of the displacement with the constant mass
        matrix, of a first-order system of all states. They sum to one.
    left_out : float
        Share of the mean square that harmonics beyond K have.
    """

    exponent: complex
    multiplier: complex
    error: float
    harmonics: NDArray[np.intp]
    coefficients: ComplexArray
    participation: FloatArray
    left_out: float
    Omega: float
    _places: Places = field(repr=False)
    _values: ComplexArray = field(repr=False)

    @property
    def frequency(self) -> float:
        """Frequency of the strongest harmonic, per unit of time; that of harmonic k is this + k Omega."""
        return self.exponent.imag

    @property
    def growth_rate(self) -> float:
        """Real part of the exponent."""
        return self.exponent.real

    @property
    def damping_ratio(self) -> float:
        """-growth rate / modulus of the exponent; 0 for the exponent 0."""
        return float(ratio_of_damping(np.array(self.exponent)))

    def periodic(self, t: ArrayLike) -> ComplexArray:
        """Return p at the times ``t``, shape ``(*t.shape, S)``; just after where something jumps."""
        times = real_array("t", t, None)
        phases = times.ravel() * self.Omega / (2 * np.pi)
        return self._places.interpolated(self._values, phases).reshape(*times.shape, -1)

    def motion(self, t: ArrayLike) -> ComplexArray:
        """Return x(t) = p(t) e^{lambda t}, shape ``(*t.shape, S)``; its real part is a motion of the system."""
        times = real_array("t", t, None)
        return self.periodic(times) * np.exp(self.exponent * times)[..., None]

    def strongest(self, count: int = 5) -> list[tuple[float, float]]:
        """Return frequency and share of the strongest harmonics, strongest first; of equal ones positive ones."""
        frequencies = self.frequency + self.harmonics * self.Omega
        order = np.lexsort((-frequencies, -np.round(self.participation, SHARE_DIGITS)))[:count]
        return [(float(frequencies[i]), float(self.participation[i])) for i in order]

    def __repr__(self) -> str:
        return (
            f"FloquetMode(frequency={self.frequency:.6g}, growth_rate={self.growth_rate:.4g}, "
            f"damping_ratio={self.damping_ratio:.4g})"
        )


def ratio_of_damping(exponents: ComplexArray) -> FloatArray:
    """Return -growth rate / modulus of each exponent; 0 for the exponent 0."""
    size: Any = np.abs(exponents)
    return np.asarray(-exponents.real / np.where(size > 0, size, 1.0))
