"""The edges of one region of instability, by root-finding on the multipliers that resonate."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from floquet.boundary.companions import Place
from floquet.boundary.forcing import highest_harmonic
from floquet.boundary.question import asked
from floquet.boundary.region import Found
from floquet.boundary.resonance import MAX_ORDER, ORDERS, SIGNS, Resonance, natural_modes
from floquet.boundary.walk import Edge
from floquet.kind import Kind
from periodic import AnyFamily, any_member_at
from periodic.checks import FloatArray, one_of, real_array, real_number, whole_number

# More stations than these are refused: a hundred times the stiffness is far beyond any separate region.
MAX_STATIONS = 400


@dataclass(frozen=True, eq=False)
class BoundaryTrace:
    """The region of one resonance at k values of eps.

    Attributes
    ----------
    near : float
        The frequency that the region was asked for by.
    resonance : Resonance
        The resonance that the region starts from at eps = 0.
    resonances : tuple of Resonance
        The same, followed by those that resonate together with it at one of the amplitudes: coincident ones, and those
        that are nearer to it than the regions are wide. Together they have one region.
    eps : ndarray, shape (k,)
        Excitation amplitudes, in the order given.
    intervals : tuple of ndarray, shape (m, 2) each
        At each amplitude the m intervals of Omega that the region consists of, from left to right. None where it is
        closed, several where it has split. NaN on a side without an edge.
    lower, upper : ndarray, shape (k,)
        Outermost edges in Omega; NaN where the region is closed or cannot be told, or on a side without an edge.
    lower_error, upper_error : ndarray, shape (k,)
        Estimated errors of the edges; NaN where they are.
    lower_meeting, upper_meeting : ndarray, shape (k,)
        Where the region has merged with another one on that side, the Omega at which the other one takes over. The edge
        is then that of the two together. NaN elsewhere.
    kind : ndarray of int8, shape (k,)
        `Kind` of the instability inside; of several intervals, in the one where the solutions of the resonance grow
        most. STABLE where the region is closed, or narrower than can be resolved: the two solutions were followed to
        the frequency at which they come nearest to instability, and decay or stay there; where more than two states
        resonate together, their place was scanned. Elsewhere nothing was looked at: that is what charts do.
        UNDECIDED where the solutions of the resonance cannot be told from others.
    covered : ndarray of bool, shape (k,)
        Where the region is closed, but its place lies in another one: the solutions of the resonance do not grow there,
        others do.
    growth_rate : ndarray, shape (k,)
        Of the solutions that resonate, at a point inside the region. Where the region is closed, where it comes nearest
        to opening: below zero by what damping leaves to the tip. NaN where it is not known.
    coupled : bool
        False if symmetry keeps the two modes apart: excitation does not make them unstable together.
    window : {"unstable", "stable"}
        What the intervals are. "stable" if the subsystem of the resonance is unstable without excitation: then the
        intervals are windows in which excitation makes it stable, and ``kind`` is STABLE where there is one. It is
        looked for where the two solutions decay most, or round the centre; the same system may have others further
        away.
    """

    near: float
    resonance: Resonance
    resonances: tuple[Resonance, ...]
    eps: FloatArray
    intervals: tuple[FloatArray, ...]
    lower: FloatArray
    upper: FloatArray
    lower_error: FloatArray
    upper_error: FloatArray
    lower_meeting: FloatArray
    upper_meeting: FloatArray
    kind: NDArray[np.int8]
    covered: NDArray[np.bool_]
    growth_rate: FloatArray
    coupled: bool
    window: str

    @property
    def is_open(self) -> NDArray[np.bool_]:
        """Where there is a region, or a window of stability, shape (k,)."""
        return self.kind > Kind.STABLE if self.window == "unstable" else self.kind == Kind.STABLE


def trace_boundary(
    family: AnyFamily,
    near: float,
    eps: ArrayLike,
    *,
    type: str | None = None,
    j: int | None = None,
    p: int | None = None,
    q: int | None = None,
) -> BoundaryTrace:
    """Find the edges of the region of instability that grows out of a resonance.

    Parameters
    ----------
    family : PeriodicSystem, FirstOrderSystem or SystemFamily
        The system, or what gives it at each frequency.
    near : float
        Frequency of resonance, (omega_p ± omega_q) / j at eps = 0, or a guess within 5 %. Of several resonances the
        nearest is taken, with preference for low j and for sums. If the modes depend on Omega, they are those at the
        resonance.
    eps : array_like, shape (k,), or float
        Excitation amplitudes >= 0, in any order. The edges at one do not depend on the others.
    type : "sum" or "difference", optional
        Of the resonance, if only such are meant.
    j : int, optional
        Its order, if only that one is meant.
    p, q : int, optional
        Numbers of its modes by increasing frequency, from 1, in any order, if only those are meant.

    Returns
    -------
    BoundaryTrace

    Raises
    ------
    ValueError
        If an argument is of the wrong type or shape, not finite, out of range or empty, or if ``near`` is near no
        resonance that is meant.

    Notes
    -----
    Inside each interval the system is unstable. Just outside, the subsystem of the resonance is stable: symmetry may
    divide a system into subsystems that know nothing of each other, and the region of another one may overlap.
    Coincident resonances of several subsystems have one region, the union of theirs, whichever of them ``p`` and ``q``
    choose. Edges are looked for between half the centre and five times the centre.

    The two solutions that resonate are told from the others by their initial values, which grow continuously out of
    two modes at eps = 0, and judged by a test function f that is analytic in Omega where the two multipliers coalesce,
    positive inside the region and negative outside (`floquet.boundary.pair.instability`). Near a resonance f is nearly
    a parabola: its top is found by interpolation, however narrow the region. From there the way leads outwards in steps
    so short that the pair turns little, up to the first stable gap, whose edge is a zero of f by Brent's method.
    Gaps narrower than a millionth of Omega are no gaps: there two regions have merged.

    States that the excitation mixes more than their detuning keeps them apart resonate together: a scan finds where
    their invariant subspace grows.

    An undamped system that is neither conservative nor reversible may grow outside its resonances, if slowly (of order
    eps^2), and then its regions have no edges.
    """
    near = real_number("near", near, positive=True)
    amplitudes = real_array("eps", eps if isinstance(eps, list | tuple) else np.atleast_1d(eps), 1)
    if amplitudes.size == 0:
        raise ValueError("eps is empty; give at least one amplitude")
    if amplitudes.min() < 0:
        raise ValueError(f"eps has the entry {float(amplitudes.min())!r}; give amplitudes >= 0")
    types = SIGNS if type is None else (one_of("type", type, tuple(SIGNS)),)
    member = any_member_at(family, near, "family")
    most = max(MAX_ORDER, highest_harmonic(member, MAX_ORDER))
    orders = ORDERS if j is None else (whole_number("j", j, least=1, most=most),)
    count = max(len(natural_modes(member, near).exponents), 1)
    numbers = [whole_number(name, n, least=1, most=count) for name, n in (("p", p), ("q", q)) if n is not None]
    resonance, modes = asked(family, near, types, orders, numbers)
    place = Place(family, resonance, modes)
    _check_size(place, amplitudes)
    return _trace(near, place, amplitudes, [place.at(float(amplitude)) for amplitude in amplitudes])


def _check_size(place: Place, eps: FloatArray) -> None:
    largest, own = float(eps.max()), place.own
    if own is None or not any(own.strength.sizes):
        return
    most = own.follower.after(0.0, MAX_STATIONS)
    if largest > most:
        raise ValueError(
            f"eps has the entry {largest!r}, which changes the stiffness by a factor of "
            f"{own.strength.at(largest):.3g}; give amplitudes below {most:.3g}"
        )


def _trace(near: float, place: Place, eps: FloatArray, found: list[Found]) -> BoundaryTrace:
    ends = [(one.intervals[0][0], one.intervals[-1][1]) if one.intervals else (Edge(), Edge()) for one in found]
    edges = np.array(ends).transpose(1, 2, 0)  # side, field of Edge, amplitude
    (lower, lower_error, left), (upper, upper_error, right) = edges
    intervals = tuple(
        np.array([[side.Omega for side in interval] for interval in one.intervals]).reshape(-1, 2) for one in found
    )
    kind = np.array([one.kind for one in found], dtype=np.int8)
    covered = np.array([one.covered for one in found])
    growth_rate = np.array([one.growth_rate for one in found])
    for array in (
        eps,
        edges,
        kind,
        covered,
        growth_rate,
        *intervals,
        lower,
        upper,
        lower_error,
        upper_error,
        left,
        right,
    ):
        array.setflags(write=False)
    return BoundaryTrace(
        near=near,
        resonance=place.resonance,
        resonances=tuple(place.resonances),
        eps=eps,
        intervals=intervals,
        lower=lower,
        upper=upper,
        lower_error=lower_error,
        upper_error=upper_error,
        lower_meeting=left,
        upper_meeting=right,
        kind=kind,
        covered=covered,
        growth_rate=growth_rate,
        coupled=place.coupled,
        window="stable" if place.own is not None and place.own.is_window else "unstable",
    )
