"""Sensitivities of exponents to a parameter, by left and right modes; and of edges and tips of regions.

A change dF_k of the motion over part k of the period changes the logarithm of a simple multiplier by

    d log mu = sum_k l_{k+1} dF_k r_k,      F_k r_k = r_{k+1},  l_k r_k = 1,  l_{k+1} F_k = l_k

(T. Kato, Perturbation theory for linear operators, II.2). The same with the bases of a cluster gives a matrix, whose
trace is the change of the sum of its exponents: where multipliers meet, that alone has a derivative. The dF_k are
differences of fourth order between the matrices of neighbouring systems. So everything may depend on the parameter:
matrices, waveforms, places of jumps, Omega and eps.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from floquet.modes.modes import FloquetModes, modes_of
from floquet.modes.parametric import At, checked_make, derivative_step, made
from floquet.modes.places import jumps_of
from floquet.modes.solutions import Solutions, pieces_of, solutions_at
from periodic import AnyFamily, any_member_at
from periodic.checks import ComplexArray, FloatArray, real_number

# Parts of a period whose matrices are differentiated, and phases at which the first of them may begin.
PARTS, CANDIDATES = 64, 32
# Differences of fourth order: places and weights.
PLACES, WEIGHTS = np.array([-2.0, -1.0, 1.0, 2.0]), np.array([1.0, -8.0, 8.0, -1.0]) / 12
# A point is on an edge if the modulus of a multiplier is this close to one, or the square of the distance of two that
# can leave the circle together is below it; and if the next one is this many times further away, beside rounding.
EDGE_TOLERANCE, EDGE_CLARITY, ROUNDING_OF_EDGE = 1e-3, 3.0, 1e-9


@dataclass(frozen=True, eq=False)
class Sensitivities:
    """Derivatives of exponents with respect to a parameter.

    Attributes
    ----------
    modes : FloquetModes
        The modes at the value; entry i below belongs to ``modes[i]``.
    exponents : ndarray of complex, shape (N,)
        d lambda / d parameter, on the branch of the mode. Of each member of a cluster the derivative of the mean
        exponent of the cluster: its members have none.
    clusters : tuple of tuple of int
        Which modes stand for their mean.
    """

    modes: FloquetModes
    exponents: ComplexArray
    clusters: tuple[tuple[int, ...], ...]

    @property
    def growth_rates(self) -> FloatArray:
        """Derivatives of the growth rates, shape (N,)."""
        return self.exponents.real

    @property
    def frequencies(self) -> FloatArray:
        """Derivatives of the frequencies, shape (N,)."""
        return self.exponents.imag


def exponent_sensitivities(
    make: Callable[[float], Any],
    value: float,
    *,
    Omega: float | None = None,
    eps: float | None = None,
    step: float | None = None,
) -> Sensitivities:
    """Return the derivatives of all exponents with respect to a parameter.

    Parameters
    ----------
    make : callable
        Takes a value of the parameter and returns a system or family, or (system, Omega, eps) where the parameter moves
        the point.
    value : float
        Where the derivatives are wanted.
    Omega, eps : float, optional
        The point, unless ``make`` returns it.
    step : float, optional
        ``make`` is called at up to two steps on either side; by default a thousandth of ``value``, or 0.001 at zero. It
        should change the phase of no motion in a part of a period by more than a hundredth.

    Returns
    -------
    Sensitivities

    Raises
    ------
    ValueError
        If an argument is of the wrong type, not finite or out of range, or as `floquet_modes`.
    """
    make, value = checked_make(make), real_number("value", value)
    h = derivative_step(value, step)
    change = _Change(made(make, value, Omega, eps))
    rates, dOmega = change.logarithms(lambda shift: made(make, value + shift, Omega, eps), h)
    modes = modes_of(*change.at)
    order, clusters = change.matched(modes)
    # lambda = (log mu + 2 pi i k) Omega / 2 pi
    found = rates[order] / modes.period + modes.exponents * (dOmega / modes.Omega)
    for cluster in clusters:
        found[list(cluster)] = found[list(cluster)].mean()
    return Sensitivities(modes, found, clusters)


def edge_sensitivity(
    make: Callable[[float], Any], value: float, Omega: float, eps: float, *, step: float | None = None
) -> float:
    """Return dOmega / d parameter of the edge of a region that passes through a point, at constant eps.

    Parameters
    ----------
    make : callable
        Takes a value of the parameter and returns a system or family.
    value : float
        The value at which the edge has been found.
    Omega, eps : float
        A point on the edge, such as one of `trace_boundary`.
    step : float, optional
        As in `exponent_sensitivities`.

    Raises
    ------
    ValueError
        If the point is on no edge, or more than one pair of multipliers are about to leave the unit circle; and as
        `exponent_sensitivities`.

    Notes
    -----
    With damping one exponent (or a conjugate pair) has the growth rate zero, whose derivatives are known. Without, two
    multipliers meet on the unit circle. There (mu_1 - mu_2)^2 is a smooth function of parameter and Omega, though
    neither multiplier is.
    """
    make, value = checked_make(make), real_number("value", value)
    Omega, eps = real_number("Omega", Omega, positive=True), real_number("eps", eps)
    h = derivative_step(value, step)
    family = make(value)
    change = _Change(At(any_member_at(family, Omega, "make"), Omega, eps))
    measure = change.marginal()
    by_parameter = measure(change.matrix(lambda shift: made(make, value + shift, Omega, eps), h))
    by_Omega = measure(change.matrix(_at_frequency(family, Omega, eps), derivative_step(Omega, None)))
    return -by_parameter / by_Omega


def tip_sensitivity(
    make: Callable[[float], Any], value: float, Omega: float, eps: float, *, step: float | None = None
) -> float:
    """Return d eps / d parameter of the tip of a region that damping keeps closed below: the threshold.

    Arguments and errors are those of `edge_sensitivity`; the point is the tip. There the growth rate is zero and has
    its maximum in Omega, so that the tip's own motion in Omega does not count. Without damping the tip stays at zero.
    """
    make, value = checked_make(make), real_number("value", value)
    Omega, eps = real_number("Omega", Omega, positive=True), real_number("eps", eps)
    if eps == 0:
        raise ValueError("eps = 0.0: without damping a region begins at zero, whatever the parameter; give a tip above")
    h = derivative_step(value, step)
    family = make(value)
    change = _Change(At(any_member_at(family, Omega, "make"), Omega, eps))
    measure = change.marginal(alone=True)
    by_parameter = measure(change.matrix(lambda shift: made(make, value + shift, Omega, eps), h))
    by_eps = measure(change.matrix(lambda shift: At(change.at.system, Omega, eps + shift), derivative_step(eps, None)))
    return -by_parameter / by_eps


def _at_frequency(family: AnyFamily, Omega: float, eps: float) -> Callable[[float], At]:
    def shifted(shift: float) -> At:
        return At(any_member_at(family, Omega + shift, "make"), Omega + shift, eps)

    return shifted


class _Change:
    """The Floquet solutions of a point, at the ends of parts of a period, and how they answer to changes."""

    def __init__(self, at: At) -> None:
        self.at = at
        self.phases = _ends(jumps_of(at.system, at.eps)) + np.linspace(0, 1, PARTS + 1)
        self.pieces = pieces_of(*at)
        self.solutions: Solutions = solutions_at(self.pieces, self.phases)

    def matrix(self, moved: Callable[[float], At], h: float) -> ComplexArray:
        """Return G (N, N): its diagonal has the derivatives of log mu, its diagonal blocks those of clusters.

        The matrix of a period in the basis of solutions at its beginning has the derivative (that matrix) @ G.
        """
        s = self.solutions
        derivative = sum(
            weight * pieces_of(*moved(place * h)).factors(self.phases)
            for place, weight in zip(PLACES, WEIGHTS, strict=True)
        )
        dF = np.asarray(derivative) / h
        after = np.concatenate([s.left[1:], np.linalg.solve(s.closing, s.left[0])[None]])
        begun = s.begun
        inside = after @ dF @ s.right
        # of two solutions, each as it has grown from the beginning
        return np.asarray((inside * np.exp(begun[:, None, :] - (begun + s.logs)[:, :, None])).sum(axis=0))

    def logarithms(self, moved: Callable[[float], At], h: float) -> tuple[ComplexArray, float]:
        """Return the derivatives of log mu (N,), and that of Omega."""
        ends = [moved(place * h).Omega for place in PLACES]
        return np.diagonal(self.matrix(moved, h)), float(WEIGHTS @ ends) / h

    def matched(self, modes: FloquetModes) -> tuple[NDArray[np.intp], tuple[tuple[int, ...], ...]]:
        """Return which solution each mode is, and the modes that stand for their mean."""
        logs = modes.exponents * modes.period
        free = list(range(len(logs)))
        order = np.empty(len(logs), dtype=np.intp)
        for i, log in enumerate(logs):
            turned = (self.solutions.log_values[free] - log).imag
            apart = np.hypot((self.solutions.log_values[free] - log).real, np.abs(np.exp(1j * turned) - 1))
            order[i] = free.pop(int(apart.argmin()))
        number = {int(old): new for new, old in enumerate(order)}
        joined = {tuple(sorted(number[i] for i in one)) for one in self.solutions.clusters if len(one) > 1}
        return order, _joined([*joined, *modes.clusters, *_equal(modes)])

    def marginal(self, alone: bool = False) -> Callable[[ComplexArray], float]:
        """Return what a derivative G does to the quantity that vanishes on the edge.

        ``alone`` leaves out multipliers that can only leave the unit circle in pairs.
        """
        s, at = self.solutions, self.at
        upper = np.sin(s.log_values.imag) >= -EDGE_TOLERANCE
        found: list[tuple[float, tuple[int, ...]]] = []
        for number, subsystem in enumerate(self.pieces.subsystems):
            inside = np.flatnonzero(upper & (s.subsystem == number))
            if not subsystem.reciprocal:
                found += [(abs(float(s.log_values[i].real)), (int(i),)) for i in inside]
            elif not alone:
                found += self._pairs(inside, np.flatnonzero(s.subsystem == number))
        found = sorted(one for one in found if one[0] <= EDGE_TOLERANCE)
        where = f"Omega = {at.Omega!r}, eps = {at.eps!r}"
        if not found:
            raise ValueError(f"{where} is on no edge: no multiplier is about to leave the unit circle; give an edge")
        if len(found) > 1 and found[1][0] <= EDGE_CLARITY * found[0][0] + ROUNDING_OF_EDGE:
            raise ValueError(f"{where}: several multipliers are about to leave the unit circle; give another eps")
        members = found[0][1]
        here = np.ix_(members, members)
        if len(members) == 1:
            return lambda G: float(G[here].real.item())
        period = s.closing[here] * np.exp(s.logs.sum(axis=0))[list(members)]
        middle = np.trace(period) / 2
        traceless = period - middle * np.eye(2)
        # d ((mu_1 - mu_2)^2 / 4) / mu^2, real where both are on the circle or on a ray
        return lambda G: float((np.trace(traceless @ period @ G[here]) / middle**2).real)

    def _pairs(self, inside: NDArray[np.intp], all_of_it: NDArray[np.intp]) -> list[tuple[float, tuple[int, ...]]]:
        """Return pairs of multipliers near the unit circle with the squares of their distances."""
        logs = self.solutions.log_values
        mu = np.exp(1j * logs.imag)
        found: list[tuple[float, tuple[int, ...]]] = []
        for i in inside:
            for j in all_of_it:
                apart = abs(mu[i] - mu[j]) ** 2 + abs(logs[i].real - logs[j].real) ** 2
                if (j < i or j not in inside) and apart <= EDGE_TOLERANCE:
                    found.append((float(apart), (int(j), int(i))))
        return found


def _ends(jumps: tuple[float, ...]) -> float:
    """Return where the first part begins, so that no part ends near a jump."""
    if not jumps:
        return 0.0
    candidates = (np.arange(CANDIDATES) + 0.5) / CANDIDATES / PARTS
    apart = np.abs((np.array(jumps) * PARTS)[:, None] - candidates * PARTS) % 1.0
    return float(candidates[np.minimum(apart, 1 - apart).min(axis=0).argmax()])


def _equal(modes: FloquetModes) -> list[tuple[int, ...]]:
    """Return the pairs of modes whose multipliers are equal within their errors, of different subsystems too."""
    logs, errors = modes.exponents * modes.period, modes.errors * modes.period
    apart = np.abs(logs.real[:, None] - logs.real) + np.abs(np.exp(1j * logs.imag)[:, None] - np.exp(1j * logs.imag))
    near = apart <= errors[:, None] + errors
    return [(int(i), int(j)) for i, j in np.argwhere(near) if i < j]


def _joined(groups: list[tuple[int, ...]]) -> tuple[tuple[int, ...], ...]:
    found: list[set[int]] = []
    for group in groups:
        touching = [one for one in found if not one.isdisjoint(group)]
        found = [one for one in found if one.isdisjoint(group)]
        found.append(set(group).union(*touching))
    return tuple(sorted(tuple(sorted(one)) for one in found))
