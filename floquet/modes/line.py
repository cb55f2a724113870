"""Modes followed along a line of any parameter: each keeps its number through veerings and crossings.

Two modes at neighbouring values are the same if the left mode of the one answers to the right mode of the other,
(l_i r_j') (l_j' r_i) near 1. Where that is not clear, or where the multipliers of two modes of one subsystem may have
met between the values, the interval is halved. Where frequencies veer, modes turn into each other within a short
distance, and halving shows it; where they cross, they do not turn however close one looks.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import linear_sum_assignment
from tqdm import tqdm

from floquet.modes.mode import ratio_of_damping
from floquet.modes.modes import FloquetModes, modes_of
from floquet.modes.parametric import At, checked_make, made
from floquet.modes.solutions import pieces_of, solutions_at
from floquet.running import gather
from periodic.checks import ComplexArray, FloatArray, grid, one_of, workers

# Distance of the likeness from one below which two modes count as the same one.
MAX_UNLIKENESS = 0.25
# Two exponents may have met between two values if the straight way of their difference, less multiples of i Omega,
# comes nearer to zero than this part of its length; of such multiples so many count, the others couple too little.
MEETING, COUPLED_HARMONICS = 0.3, 4
# Modes that come nearer to each other than this part of Omega without turning into each other cross.
MIN_GAP = 1e-6
# Parts of a period where nothing but exponents and modes at t = 0 are wanted.
FEW_PARTS = 64
# Exponents that differ by less than this part of themselves are equal.
EQUAL_EXPONENTS = 1e-10
# An interval is halved at most so many times.
MAX_LINE_HALVINGS = 24
# Part of Omega by which an exponent may change from value to value, so that its branch is not lost.
MAX_BRANCH_STEP = 0.25
# Harmonics on either side whose participation is kept.
KEPT_HARMONICS = 12


class _Station(NamedTuple):
    """What is kept of the modes at one value: exponents, errors and subsystems (N,), right (S, N) and left (N, S) modes
    at t = 0, the participation (N, H), and whether there is excitation."""

    Omega: float
    exponents: ComplexArray
    errors: FloatArray
    right: ComplexArray
    left: ComplexArray
    subsystem: NDArray[np.intp]
    participation: FloatArray
    excited: bool


@dataclass(frozen=True, eq=False, repr=False)
class ModeLine:
    """Modes along a line of a parameter.

    Attributes
    ----------
    values : ndarray, shape (m,)
        Of the parameter.
    Omega : ndarray, shape (m,)
        Excitation frequency at each value.
    exponents : ndarray of complex, shape (m, N)
        Column i is one mode, on one branch, from the first value to the last; columns are in the order of
        `FloquetModes` at the first value.
    errors : ndarray, shape (m, N)
        Estimated errors of the exponents.
    harmonics : ndarray of int, shape (H,)
    participation : ndarray, shape (m, N, H)
        Share of the harmonic k, of frequency ``exponents.imag`` + k Omega, in each mode.
    unclear : ndarray of bool, shape (m, N)
        Where it could not be told which mode goes on as which, since the value before: they met there, and left each
        other as different modes, as on an edge.
    """

    values: FloatArray
    Omega: FloatArray
    exponents: ComplexArray
    errors: FloatArray
    harmonics: NDArray[np.intp]
    participation: FloatArray
    unclear: NDArray[np.bool_]

    @property
    def frequencies(self) -> FloatArray:
        """Imaginary parts of the exponents, shape (m, N)."""
        return self.exponents.imag

    @property
    def growth_rates(self) -> FloatArray:
        """Real parts of the exponents, shape (m, N)."""
        return self.exponents.real

    @property
    def damping_ratios(self) -> FloatArray:
        """-growth rate / modulus of the exponent, shape (m, N)."""
        return ratio_of_damping(self.exponents)

    @property
    def multipliers(self) -> ComplexArray:
        """Multipliers along the line, shape (m, N)."""
        with np.errstate(under="ignore"):
            return np.asarray(np.exp(self.exponents * (2 * np.pi / self.Omega)[:, None]))

    def __repr__(self) -> str:
        m, N = self.exponents.shape
        return f"ModeLine of {N} exponents at {m} values from {self.values[0]:.6g} to {self.values[-1]:.6g}"


def follow_modes(
    make: Callable[[float], Any],
    values: ArrayLike,
    *,
    Omega: float | None = None,
    eps: float | None = None,
    n_jobs: int | None = -1,
    progress: bool | None = None,
) -> ModeLine:
    """Follow all modes along a line of a parameter.

    Parameters
    ----------
    make : callable
        Takes a value of the parameter and returns a system or family, or (system, Omega, eps) where the parameter moves
        the point.
    values : array_like, shape (m,)
        Strictly increasing.
    Omega, eps : float, optional
        The point, unless ``make`` returns it.
    n_jobs : int or None
        Workers, as in `stability_chart`.
    progress : bool or None
        Whether to show a progress bar. None shows it on a terminal only.

    Returns
    -------
    ModeLine

    Raises
    ------
    ValueError
        If an argument is of the wrong type, not finite or out of range, or as `floquet_modes`; if the number of modes
        changes along the line.
    """
    make, places = checked_make(make), grid("values", values)
    n_jobs = workers("n_jobs", n_jobs)
    progress = one_of("progress", progress, (True, False, None))
    points = [made(make, value, Omega, eps) for value in places.tolist()]
    with tqdm(total=len(points), unit="point", disable=None if progress is None else not progress) as bar:
        stations = gather(_station, [(point,) for point in points], n_jobs, bar)
    line = [_Followed(stations[0], np.arange(len(stations[0].errors)), stations[0].exponents)]
    unclear = [np.zeros(len(stations[0].errors), dtype=bool)]

    def between(a: float, b: float) -> _Station:
        return _sparse_station(made(make, (a + b) / 2, Omega, eps))

    for a, b, station in zip(places[:-1].tolist(), places[1:].tolist(), stations[1:], strict=True):
        if len(station.errors) != len(stations[0].errors):
            raise ValueError(f"values: at {b!r} there are {len(station.errors)} modes, before {len(unclear[0])}; "
                             "a motion has become rigid, or is so no longer: follow on one side")  # fmt: skip
        following, lost = _go(line[-1], station, a, b, between, MAX_LINE_HALVINGS)
        line.append(following)
        unclear.append(lost)
    return ModeLine(
        places,
        np.array([one.station.Omega for one in line]),
        np.array([one.exponents for one in line]),
        np.array([one.station.errors[one.order] for one in line]),
        np.arange(-KEPT_HARMONICS, KEPT_HARMONICS + 1),
        np.array([one.participation() for one in line]),
        np.array(unclear),
    )


class _Followed(NamedTuple):
    """A station, the number in it of each mode (N,), and the exponents on their branches (N,)."""

    station: _Station
    order: NDArray[np.intp]
    exponents: ComplexArray

    def participation(self) -> FloatArray:
        """Return the shares of the kept harmonics, counted from the branch, shape (N, H)."""
        shares = self.station.participation[self.order]
        turns = np.rint((self.exponents - self.station.exponents[self.order]).imag / self.station.Omega).astype(int)
        middle = shares.shape[1] // 2
        index = middle + np.arange(-KEPT_HARMONICS, KEPT_HARMONICS + 1) + turns[:, None]
        inside = (index >= 0) & (index < shares.shape[1])
        found = np.take_along_axis(shares, np.clip(index, 0, shares.shape[1] - 1), axis=1)
        return np.where(inside, found, 0.0)


def _station(at: At) -> _Station:
    modes: FloquetModes = modes_of(*at)
    left = np.array([modes.left(i) for i in range(len(modes))]).reshape(len(modes), -1)
    return _Station(
        at.Omega, modes.exponents, modes.errors, modes.start, left, modes.subsystems, modes.participation, at.eps != 0
    )


def _sparse_station(at: At) -> _Station:
    """Return a station that only stands between two others: without participation, and on any branch."""
    found = solutions_at(pieces_of(*at), np.linspace(0, 1, FEW_PARTS + 1))
    rate = at.Omega / (2 * np.pi)
    none = np.zeros((len(found.errors), 0))
    return _Station(
        at.Omega, found.log_values * rate, found.errors * rate, found.right[0], found.left[0], found.subsystem, none,
        at.eps != 0,
    )  # fmt: skip


def _go(
    before: _Followed, after: _Station, a: float, b: float, between: Callable[[float, float], _Station], left: int
) -> tuple[_Followed, NDArray[np.bool_]]:
    """Follow modes from one value to the next, through the middle where it is not clear which is which."""
    following, clear, crossing = _matched(before, after)
    if (clear.all() and not crossing) or not left or not a < (a + b) / 2 < b:
        return following, ~clear
    middle, lost = _go(before, between(a, b), a, (a + b) / 2, between, left - 1)
    following, later = _go(middle, after, (a + b) / 2, b, between, left - 1)
    return following, lost | later


def _matched(before: _Followed, after: _Station) -> tuple[_Followed, NDArray[np.bool_], bool]:
    """Return each mode as it goes on, whether that is clear, and whether two of them may have met on the way."""
    station = before.station
    products = (station.left[before.order] @ after.right) * (after.left @ station.right[:, before.order]).T
    _, order = linear_sum_assignment(-np.minimum(np.abs(products), 1.0))
    # modes of equal exponents may be mixed in any way: what counts is what they answer together
    apart = np.abs(after.exponents[:, None] - after.exponents)
    equal = apart <= EQUAL_EXPONENTS * np.abs(after.exponents) + after.errors[:, None] + after.errors
    found = (products @ equal)[np.arange(len(order)), order]
    own = after.exponents[order]
    turns = np.rint((before.exponents - own).imag / after.Omega)
    exponents = own + 1j * turns * after.Omega
    near = np.abs((exponents - before.exponents).imag) <= MAX_BRANCH_STEP * after.Omega
    clear = (np.abs(found - 1) <= MAX_UNLIKENESS) & near
    following = _Followed(after, order, exponents)
    return following, clear, _may_have_met(before, following)


def _may_have_met(before: _Followed, after: _Followed) -> bool:
    """Return whether two modes of one subsystem may have had one multiplier between two stations."""
    start, end = (one.exponents[:, None] - one.exponents for one in (before, after))
    Omega = after.station.Omega
    turns = np.rint(((start + end) / 2).imag / Omega)
    start, end = start - 1j * turns * before.station.Omega, end - 1j * turns * Omega
    way = np.abs(end - start)
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.clip(np.nan_to_num(-(start * (end - start).conj()).real / way**2), 0, 1)
    nearest = np.abs(start + share * (end - start))
    subsystem = after.station.subsystem[after.order]
    # without excitation any mode is a subsystem of its own, at each value another one
    together = (subsystem[:, None] == subsystem) | (not after.station.excited)
    may = together & (np.abs(turns) <= (COUPLED_HARMONICS if after.station.excited else 0))
    inside = (share > 0) & (share < 1) & (way > MIN_GAP * Omega)
    np.fill_diagonal(may, False)
    return bool((may & inside & (nearest < MEETING * way)).any())
