"""`floquet_modes`: how a periodic system moves at one point: exponents, periodic modes, harmonics, damping."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from floquet.modes.mode import FloquetMode, ratio_of_damping
from floquet.modes.places import Places
from floquet.modes.response import RESPONSE_SAMPLES, Response, TransientGrowth, respond, transient
from floquet.modes.solutions import (
    Pieces,
    Solutions,
    period_logarithms,
    period_places,
    periodic_parts,
    pieces_of,
    solutions_at,
)
from periodic import AnyFamily, AnySystem, FirstOrderSystem, any_member_at
from periodic.checks import ComplexArray, FloatArray, real_number

# Modes are put in order by their growth over a period, rounded to so many digits behind the point; equal ones by
# frequency.
GROWTH_DIGITS = 9
# Of harmonics whose shares come this close to the largest, the one with the lowest frequency names the branch.
EQUAL_SHARE = 1e-6


@dataclass(frozen=True, eq=False, repr=False)
class FloquetModes:
    """The modes of a system at one (Omega, eps), the fastest-growing first, of equal growth the slowest.

    ``modes[i]`` is a `FloquetMode`; one may iterate over them. Modes with complex exponents come in conjugate pairs.

    Attributes
    ----------
    system : PeriodicSystem or FirstOrderSystem
        The member at ``Omega``.
    Omega, eps : float
    exponents : ndarray of complex, shape (N,)
        Each on the branch of its strongest harmonic.
    multipliers : ndarray of complex, shape (N,)
        e^{lambda T}; 0 where it is too small for a float.
    errors : ndarray, shape (N,)
        Estimated errors of the exponents, per unit of time.
    clusters : tuple of tuple of int
        Modes whose multipliers are so close that the error of the motion lets them meet, as on the edge of a region:
        none of them can be told from the others, only their space and the mean of their exponents can. That mean
        stands for each of them.
    rigid : int
        Number of rigid motions, which are left out: N is the number of states less two for each.
    """

    system: AnySystem
    Omega: float
    eps: float
    exponents: ComplexArray
    errors: FloatArray
    clusters: tuple[tuple[int, ...], ...]
    _pieces: Pieces
    _places: Places
    _solutions: Solutions
    _order: NDArray[np.intp]
    _values: ComplexArray
    _mean_squares: FloatArray
    _scales: ComplexArray  # what the solutions were multiplied by to become modes

    @property
    def period(self) -> float:
        """T = 2 pi / Omega."""
        return 2 * np.pi / self.Omega

    @property
    def multipliers(self) -> ComplexArray:
        """e^{lambda T}, shape (N,)."""
        with np.errstate(under="ignore"):
            return np.asarray(np.exp(self.exponents * self.period))

    @property
    def rigid(self) -> int:
        """Number of rigid motions."""
        return self._pieces.rigid.shape[1]

    @property
    def frequencies(self) -> FloatArray:
        """Frequencies of the strongest harmonics, of either sign, shape (N,)."""
        return self.exponents.imag

    @property
    def growth_rates(self) -> FloatArray:
        """Real parts of the exponents, shape (N,)."""
        return self.exponents.real

    @property
    def damping_ratios(self) -> FloatArray:
        """-growth rate / modulus of the exponent, shape (N,)."""
        return ratio_of_damping(self.exponents)

    @property
    def harmonics(self) -> NDArray[np.intp]:
        """The harmonics k that are known, shape (H,)."""
        return self._places.harmonics

    @property
    def participation(self) -> FloatArray:
        """Shares of the harmonics of each mode, shape (N, H); each row sums to one (`FloquetMode.participation`)."""
        squares = _squares(self.system, self.coefficients)
        return np.asarray((squares / squares.sum(axis=0)).T)

    @cached_property
    def coefficients(self) -> ComplexArray:
        """Fourier coefficients of the periodic modes, shape (H, S, N)."""
        return self._places.coefficients(self._values)

    def time_to_grow(self, factor: float = 10.0) -> float:
        """Return the time in which the fastest-growing mode grows by ``factor``; infinite if none grows."""
        factor = real_number("factor", factor, positive=True)
        fastest = float(self.growth_rates.max(initial=0.0))
        return float(np.log(factor) / fastest) if fastest > 0 else float("inf")

    @property
    def subsystems(self) -> NDArray[np.intp]:
        """Number of the independent subsystem in which each mode lives, shape (N,)."""
        return np.asarray(self._solutions.subsystem[self._order])

    def left(self, number: int) -> ComplexArray:
        """Return the left mode at t = 0 (S,): left(i) @ p_k(0) is 1 for k = i and 0 for the others."""
        return np.asarray(self._solutions.left[0, self._order[number]] / self._scales[number])

    @cached_property
    def start(self) -> ComplexArray:
        """The periodic modes just after t = 0, in columns, shape (S, N)."""
        return self._solutions.right[0][:, self._order] * self._scales

    def response(self, initial: ArrayLike, periods: int, samples: int = RESPONSE_SAMPLES) -> Response:
        """Return the motion that follows from the state ``initial`` (S,) at t = 0, at ``samples`` times a period.

        Raises
        ------
        ValueError
            If an argument has the wrong type or shape, or is out of range.
        """
        return respond(self._pieces, initial, periods, samples)

    def transient(
        self, periods: int, samples: int = RESPONSE_SAMPLES, energy: ArrayLike | None = None
    ) -> TransientGrowth:
        """Return the largest growth of energy within some periods, over all initial values at t = 0.

        Parameters
        ----------
        periods : int
        samples : int
            Times in each period at which the growth is computed; the largest is found between them, too.
        energy : array_like, shape (S, S), optional
            E of the energy state^T E state. By default that of the constant mass and stiffness (`Response`).

        Raises
        ------
        ValueError
            If an argument has the wrong type or shape, or is out of range; or if no energy is given where the stiffness
            defines none.
        """
        return transient(self._pieces, periods, samples, energy)

    def __len__(self) -> int:
        return len(self.exponents)

    def __getitem__(self, number: int) -> FloquetMode:
        i = range(len(self))[number]
        squares = _squares(self.system, self.coefficients[:, :, i : i + 1])[:, 0]
        return FloquetMode(
            exponent=complex(self.exponents[i]),
            multiplier=complex(self.multipliers[i]),
            error=float(self.errors[i]),
            harmonics=self.harmonics,
            coefficients=self.coefficients[:, :, i],
            participation=squares / squares.sum(),
            left_out=max(0.0, float(1 - squares.sum() / self._mean_squares[i])),
            Omega=self.Omega,
            _places=self._places,
            _values=self._values[:, :, i],
        )

    def __iter__(self) -> Iterator[FloquetMode]:
        return (self[i] for i in range(len(self)))

    def __repr__(self) -> str:
        shown = [i for i in range(len(self)) if self.frequencies[i] >= 0][:8]
        lines = [f"FloquetModes at Omega = {self.Omega:.6g}, eps = {self.eps:.6g}: {len(self)} exponents"]
        lines += ["   frequency    growth rate   damping ratio"]
        lines += [
            f"{self.frequencies[i]:12.6g}{self.growth_rates[i]:15.5g}{self.damping_ratios[i]:16.5g}" for i in shown
        ]
        return "\n".join(lines)


def floquet_modes(system: AnyFamily, Omega: float, eps: float) -> FloquetModes:
    """Return all Floquet exponents and periodic modes at one point.

    Parameters
    ----------
    system : PeriodicSystem, FirstOrderSystem or SystemFamily
        The system, or a family, of which the member at ``Omega`` is taken.
    Omega : float
        Excitation frequency, > 0.
    eps : float
        Excitation amplitude, any sign.

    Returns
    -------
    FloquetModes

    Raises
    ------
    ValueError
        If an argument is of the wrong type, not finite or out of range, or as `monodromy`.

    Notes
    -----
    The period is cut into parts in which all solutions are of similar size, and the product of their matrices is never
    formed (`floquet.oracle.solutions`): exponents and modes of solutions that decay fast are as right as those of the
    others. A multiplier alone fixes the frequency only up to multiples of Omega; the harmonic with the largest
    participation decides.
    """
    Omega = real_number("Omega", Omega, positive=True)
    eps = real_number("eps", eps)
    return modes_of(any_member_at(system, Omega), Omega, eps)


def modes_of(member: AnySystem, Omega: float, eps: float) -> FloquetModes:
    """Return the modes of a member; arguments have been checked."""
    pieces = pieces_of(member, Omega, eps)
    places = period_places(pieces)
    begins = places.phases[0] == 0
    phases = np.concatenate([places.phases if begins else [0.0, *places.phases], [1.0]])
    solutions = solutions_at(pieces, phases)
    logarithms = period_logarithms(solutions)
    values = periodic_parts(solutions, logarithms, phases[:-1])[0 if begins else 1 :]
    shift = _branches(member, places, values, solutions, solutions.log_values.imag / (2 * np.pi))
    values = values * np.exp(-2j * np.pi * np.outer(places.phases, shift))[:, None, :]
    logs = np.asarray(solutions.log_values + 2j * np.pi * shift, dtype=complex)
    order = _in_order(logs)
    scales = _scales(member, places, values, solutions)
    values = (values * scales)[:, :, order]
    number = {int(old): new for new, old in enumerate(order)}
    clusters = tuple(tuple(sorted(number[i] for i in one)) for one in solutions.clusters if len(one) > 1)
    T = 2 * np.pi / Omega
    mean_squares = places.weights @ _squares(member, values)
    return FloquetModes(
        member,
        Omega,
        eps,
        np.asarray(logs[order] / T, dtype=complex),
        solutions.errors[order] / T,
        clusters,
        pieces,
        places,
        solutions,
        order,
        values,
        np.asarray(mean_squares),
        scales[order],
    )


def _branches(
    member: AnySystem, places: Places, values: ComplexArray, solutions: Solutions, angles: FloatArray
) -> FloatArray:
    """Return the harmonic of each solution that names its branch, one for all of a cluster, shape (N,).

    ``angles`` are the arguments of the multipliers as parts of a turn.
    """
    squares = _squares(member, places.coefficients(values))
    found = np.zeros(len(angles))
    for cluster in solutions.clusters:
        members = list(cluster)
        shares = squares[:, members].sum(axis=1)
        equal = np.flatnonzero(shares >= (1 - EQUAL_SHARE) * shares.max())
        frequency = places.harmonics[equal] + angles[members].mean()
        lowest = np.abs(frequency) <= np.abs(frequency).min() + EQUAL_SHARE
        found[members] = places.harmonics[equal][lowest][frequency[lowest].argmax()]
    return found


def _in_order(logs: ComplexArray) -> NDArray[np.intp]:
    frequency = logs.imag / (2 * np.pi)
    rounded = np.round(np.abs(frequency), GROWTH_DIGITS)
    return np.lexsort((-np.sign(frequency), rounded, -np.round(logs.real, GROWTH_DIGITS)))


def _scales(member: AnySystem, places: Places, values: ComplexArray, solutions: Solutions) -> ComplexArray:
    """Return factors that scale modes to a mean square of one, and make the largest entry of the branch's own harmonic
    real and positive; one for all of a cluster, shape (N,)."""
    mean_squares = places.weights @ _squares(member, values)
    own = np.tensordot(places.weights, values, 1)
    factors = np.ones(len(mean_squares), complex)
    for cluster in solutions.clusters:
        members = list(cluster)
        column = own[:, members[0]]
        largest = column[np.abs(column).argmax()]
        turn = largest.conj() / abs(largest) if largest else 1.0
        factors[members] = turn / np.sqrt(mean_squares[members].mean())
    return factors


def _squares(member: AnySystem, values: ComplexArray) -> FloatArray:
    """Return the squares of the modes in the columns of ``values`` (p, S, N), shape (p, N)."""
    if isinstance(member, FirstOrderSystem):
        return np.asarray((np.abs(values) ** 2).sum(axis=1))
    W = values[:, member.size :]
    return np.asarray((W.conj() * (member.mass @ W)).sum(axis=1).real)
