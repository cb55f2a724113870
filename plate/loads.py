"""Edge loads: how the tension is spread over the edges and how it varies in time, eqs. (7) and (29)."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import spherical_jn

from periodic.checks import one_of, real_number, whole_number
from plate.distribution import Distribution

WAVEFORMS = ("cosine", "square", "triangle", "sawtooth")

# Harmonics of a named waveform by default: the first three that a square or triangle wave has.
DEFAULT_WAVEFORM_HARMONICS = 5

# Most harmonics of a load: more than anybody integrates, few enough that a slip does not fill the memory.
MAX_LOAD_HARMONICS = 1000

# Two positions on the edge (in b) that differ by less are the same: rounding of centre - width / 2.
MIN_EDGE_GAP = 1e-14

# A static load whose mean differs from 1 by less is not scaled again: only its last digit would change.
UNIT_MEAN_TOLERANCE = 1e-14

# A mean below this part of the mean modulus is rounding; a load with such a mean cannot be scaled to mean 1.
MIN_RELATIVE_MEAN = 1e-10

# Terms of the Legendre series of the cosine arch; the last, j_20(pi / 2) = 5e-22, is far below rounding.
COSINE_LEGENDRE_TERMS = 21


@dataclass(frozen=True)
class EdgeLoad:
    """The tension along the edges x = 0 and x = a, divided by its static mean f0, eqs. (7) and (29).

    f(y, t) / f0 = static(y) + eps sum_j [f_c[j-1](y) cos(j Omega t) + f_s[j-1](y) sin(j Omega t)]

    Build one with `uniform`, `linear`, `partial`, `parabolic`, `cosine` or `from_samples`. The static part always has
    mean 1, so that f0 is the total force divided by the width whatever the shape. Unless `with_waveform` says otherwise
    the whole load pulsates, static(y) (1 + eps cos Omega t): the paper's eq. (29).

    Parameters
    ----------
    static : Distribution
        Shape of the static tension; only the shape counts, it is scaled to mean 1.
    f_c, f_s : tuple of J Distributions
        Shapes of the harmonics as multiples of f0, of any mean. Left out: one harmonic, f_c like ``static``, f_s zero.

    Raises
    ------
    ValueError
        If ``static`` has no positive mean, or f_c and f_s do not hold the same number of distributions.

    Examples
    --------
    >>> load = EdgeLoad.partial(0.5)  # the paper's middle half: twice the mean there, nothing elsewhere
    >>> float(load.static(0.5)), float(load.static(0.2))
    (2.0, 0.0)
    >>> load.with_waveform("square", harmonics=3).harmonics
    3
    """

    static: Distribution
    f_c: tuple[Distribution, ...] = ()
    f_s: tuple[Distribution, ...] = ()

    def __post_init__(self) -> None:
        if not isinstance(self.static, Distribution):
            raise ValueError(f"static = {self.static!r} is no Distribution; use EdgeLoad.uniform() or a sister of it")
        mean = self.static.mean
        if mean <= MIN_RELATIVE_MEAN * self.static.bound:
            raise ValueError(
                f"the static load has mean {mean:.6g}; give a positive mean (the sign belongs to tension; "
                "a distribution of zero mean can be a harmonic: Distribution.from_samples and with_waveform)"
            )
        if not math.isclose(mean, 1, rel_tol=UNIT_MEAN_TOLERANCE):
            object.__setattr__(self, "static", self.static * (1 / mean))
        if not self.f_c and not self.f_s:
            object.__setattr__(self, "f_c", (self.static,))
            object.__setattr__(self, "f_s", (0 * self.static,))
        for name in ("f_c", "f_s"):
            value = getattr(self, name)
            if not isinstance(value, tuple) or not all(isinstance(entry, Distribution) for entry in value):
                raise ValueError(
                    f"{name} = {value!r} is not known; give a tuple of Distributions, or use with_waveform"
                )
        if len(self.f_c) != len(self.f_s):
            raise ValueError(f"f_c holds {len(self.f_c)} harmonics and f_s {len(self.f_s)}; give as many of each")

    @classmethod
    def uniform(cls) -> EdgeLoad:
        """Return the load that is the same all along the edge."""
        return cls(Distribution((0.0, 1.0), ((1.0,),)))

    @classmethod
    def linear(cls, left: float, right: float) -> EdgeLoad:
        """Return the load that varies linearly from y = 0 to y = b.

        Parameters
        ----------
        left, right : float
            Values at y = 0 and y = b. Only left : right counts, since the load is scaled to mean 1:
            ``linear(1, 3)`` is ``linear(0.5, 1.5)``.

        Raises
        ------
        ValueError
            If a value is not a finite number, or their mean is not positive.
        """
        left, right = real_number("left", left), real_number("right", right)
        return cls(Distribution.from_samples((0.0, 1.0), (left, right)))

    @classmethod
    def partial(cls, width: float, centre: float = 0.5) -> EdgeLoad:
        """Return the load spread evenly over a part of the edge, zero elsewhere.

        Parameters
        ----------
        width : float
            Width of the loaded part divided by b; the load there is 1 / width.
        centre : float
            Its middle y/b.

        Raises
        ------
        ValueError
            If the loaded part is empty or reaches beyond the edge.
        """
        width, centre = real_number("width", width, positive=True), real_number("centre", centre)
        start, end = centre - width / 2, centre + width / 2
        if start < -MIN_EDGE_GAP or end > 1 + MIN_EDGE_GAP:
            raise ValueError(
                f"width = {width!r}, centre = {centre!r} load y/b from {start:.6g} to {end:.6g}; keep within 0 to 1"
            )
        pieces = ((0.0, start, 0.0), (start, end, 1 / width), (end, 1.0, 0.0))
        nonempty = [(low, high, value) for low, high, value in pieces if high - low > MIN_EDGE_GAP]
        if not any(value for *_, value in nonempty):
            raise ValueError(f"width = {width!r} is too narrow; give more than {MIN_EDGE_GAP}")
        breaks = (0.0, *(low for low, *_ in nonempty[1:]), 1.0)
        return cls(Distribution(breaks, tuple((value,) for *_, value in nonempty)))

    @classmethod
    def parabolic(cls, edge: float = 0.0) -> EdgeLoad:
        """Return the parabola symmetric about the mid-line, edge + (1 - edge) 6 (y/b) (1 - y/b).

        Parameters
        ----------
        edge : float
            Value at the free edges y = 0, b in multiples of the mean; 0 vanishes there, 1 is uniform.

        Raises
        ------
        ValueError
            If ``edge`` is not a finite number.
        """
        edge = real_number("edge", edge)
        return cls(Distribution((0.0, 1.0), ((1.0, 0.0, edge - 1.0),)))

    @classmethod
    def cosine(cls, edge: float = 0.0) -> EdgeLoad:
        """Return the half wave symmetric about the mid-line, edge + (1 - edge) (pi/2) cos(pi (y/b - 1/2)).

        Parameters
        ----------
        edge : float
            Value at the free edges y = 0, b in multiples of the mean; 0 vanishes there, 1 is uniform.

        Raises
        ------
        ValueError
            If ``edge`` is not a finite number.
        """
        edge = real_number("edge", edge)
        # cos(w xi) = sum over even n of (2 n + 1) (-1)^(n/2) j_n(w) P_n(xi), here with w = pi/2 (DLMF 10.60.7)
        n = np.arange(COSINE_LEGENDRE_TERMS)
        sign = np.array([1.0, 0.0, -1.0, 0.0])[n % 4]
        row = (1 - edge) * np.pi / 2 * (2 * n + 1) * sign * spherical_jn(n, np.pi / 2)
        row[0] = 1.0
        return cls(Distribution((0.0, 1.0), (tuple(row),)))

    @classmethod
    def from_samples(cls, y: ArrayLike, f: ArrayLike) -> EdgeLoad:
        """Return the piecewise linear load through samples, scaled to mean 1.

        Parameters
        ----------
        y : array_like, shape (p,), p >= 2
            Places y/b, strictly increasing from 0 to 1.
        f : array_like, shape (p,)
            Values there, in any unit.

        Raises
        ------
        ValueError
            If y does not run from 0 to 1, f does not fit it, or the mean of f is not positive.
        """
        return cls(Distribution.from_samples(y, f))

    @property
    def harmonics(self) -> int:
        """Number of harmonics J."""
        return len(self.f_c)

    def harmonic(self, j: int) -> tuple[Distribution, Distribution]:
        """Return f_cj and f_sj of eq. (7) for j from 0 (the static load, zero) to J.

        Raises
        ------
        ValueError
            If j is no whole number or lies outside.
        """
        j = whole_number("j", j, least=0, most=self.harmonics)
        return (self.static, 0 * self.static) if j == 0 else (self.f_c[j - 1], self.f_s[j - 1])

    def with_waveform(self, waveform: str | Mapping[int, tuple[Any, Any]], harmonics: int | None = None) -> EdgeLoad:
        """Return the same static load with another periodic part.

        Parameters
        ----------
        waveform : {"cosine", "square", "triangle", "sawtooth"} or mapping of j to (cosine, sine)
            A name: the whole load pulsates with that waveform, of amplitude 1 and mean 0, by its Fourier series;
            cosine, square and triangle start from their maximum at t = 0, the sawtooth rises through zero there.
            A mapping: for each harmonic j >= 1 the factors of cos(j Omega t) and sin(j Omega t); each is a number (so
            many times the static load), an `EdgeLoad` (its static part) or a `Distribution`.
        harmonics : int, optional
            J, the number of harmonics kept. By default 1 for "cosine", 5 for the other names, the largest j for a
            mapping.

        Returns
        -------
        EdgeLoad

        Raises
        ------
        ValueError
            If a name, a harmonic or a factor is not one of these, or a mapping goes beyond ``harmonics``.

        Examples
        --------
        A second harmonic of a tenth of the first, a quarter of a period late:

        >>> load = EdgeLoad.uniform().with_waveform({1: (1.0, 0.0), 2: (0.0, 0.1)})

        Pulsating tension on one half of the edge only, with bending of the edges at twice the frequency:

        >>> bending = Distribution.from_samples([0.0, 1.0], [-1.0, 1.0])
        >>> load = EdgeLoad.uniform().with_waveform({1: (EdgeLoad.partial(0.5, centre=0.25), 0.0), 2: (bending, 0.0)})
        """
        if harmonics is not None:
            harmonics = whole_number("harmonics", harmonics, least=1, most=MAX_LOAD_HARMONICS)
        if isinstance(waveform, Mapping):
            factors = {whole_number("harmonic", j, least=1, most=MAX_LOAD_HARMONICS): waveform[j] for j in waveform}
            if not factors:
                raise ValueError("waveform is empty; give at least one harmonic, such as {1: (1.0, 0.0)}")
            J = harmonics or max(factors)
            if max(factors) > J:
                raise ValueError(f"waveform has harmonic {max(factors)}; give harmonics >= {max(factors)}, not {J}")
        else:
            name = one_of("waveform", waveform, WAVEFORMS)
            J = harmonics or (1 if name == "cosine" else DEFAULT_WAVEFORM_HARMONICS)
            factors = dict(enumerate(_fourier_coefficients(name, J), start=1))
        pairs = [self._pair(j, factors.get(j, (0.0, 0.0))) for j in range(1, J + 1)]
        return replace(self, f_c=tuple(c for c, _ in pairs), f_s=tuple(s for _, s in pairs))

    def _pair(self, j: int, factors: Any) -> tuple[Distribution, Distribution]:
        try:
            cosine, sine = factors
        except (TypeError, ValueError):
            raise ValueError(f"waveform[{j}] = {factors!r} is not a pair; give (cosine, sine)") from None
        return self._times_static(f"waveform[{j}][0]", cosine), self._times_static(f"waveform[{j}][1]", sine)

    def _times_static(self, name: str, factor: Any) -> Distribution:
        if isinstance(factor, EdgeLoad):
            return factor.static
        if isinstance(factor, Distribution):
            return factor
        return real_number(name, factor) * self.static


def _fourier_coefficients(name: str, J: int) -> list[tuple[float, float]]:
    """Return (cosine, sine) of harmonics 1..J of a waveform between -1 and 1 with mean 0."""
    pairs = []
    for j in range(1, J + 1):
        odd = j % 2
        match name:
            case "cosine":
                pairs.append((float(j == 1), 0.0))
            case "square":
                pairs.append((odd * 4 / (math.pi * j) * (-1) ** (j // 2), 0.0))
            case "triangle":
                pairs.append((odd * 8 / (math.pi * j) ** 2, 0.0))
            case _:
                pairs.append((0.0, 2 / (math.pi * j) * (-1) ** (j + 1)))
    return pairs
