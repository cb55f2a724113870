"""One region compared: its edges by theory and by integration on a ladder, and what follows from them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from compare.ladder import (
    MAX_EXTENSIONS,
    MIN_TOP_OVER_TIP,
    RUNGS,
    DampingScaled,
    OutOfRangeError,
    is_damped,
    rungs_below,
    top_rung,
)
from compare.orders import MAX_REMAINDER, fitted_order, noise, still_falls, vanishes
from compare.outcome import Basis, Outcome, RegionAgreement
from floquet import BoundaryTrace, Kind, trace_boundary
from floquet.boundary import NoResonanceError, natural_modes
from periodic import AnyFamily
from periodic.checks import FloatArray
from perturb import TransitionCurve, transition_curves

# Distance below which two edges are one, as part of the frequency: ten times what tracing resolves.
MIN_RESOLVED_GAP = 1e-9
# Distance of the fitted order from the expected one within which the two are called the same.
ORDER_TOLERANCE = 0.15
# Fewest rungs on which a gap shows where it goes as eps -> 0.
MIN_RUNGS = 3
# Smallest rung over the eps up to which a region stands alone, below which its neighbours do not matter any more.
ALONE = 0.1
# Ratio of the tips by first and second order from which on first order is not meant.
MAX_TIP_RATIO = 1.5

Order = Literal[1, 2]


class Key(NamedTuple):
    """What tells one region of a system from another."""

    p: int
    q: int
    j: int
    type: str


@dataclass(eq=False)
class Theory:
    """The analytic curves of a family in a window, for any part of its damping; computed when first asked for."""

    family: AnyFamily
    window: tuple[float, float]
    order: Order
    types: tuple[str, ...]
    _found: dict[float, dict[Key, TransitionCurve]] = field(default_factory=dict)

    def curves(self, factor: float) -> dict[Key, TransitionCurve]:
        """Return the curves of the family with ``factor`` times its damping."""
        if factor not in self._found:
            rung = DampingScaled(self.family, factor)
            curves = transition_curves(rung, self.window, order=self.order, types=self.types)
            self._found[factor] = {Key(curve.p, curve.q, curve.j, curve.type): curve for curve in curves}
        return self._found[factor]


class _Rung(NamedTuple):
    """One amplitude: edges by theory, and by integration with their errors; why the latter are missing, or ""; whether
    another region takes over before an edge; whether it is closed at a place that lies in another region."""

    analytic: FloatArray
    traced: FloatArray
    error: FloatArray
    trouble: str
    joined: bool = False
    covered: bool = False


class _Weighed(NamedTuple):
    """What a ladder says: whether it is decided, and how."""

    settled: bool
    outcome: Outcome
    basis: Basis
    reason: str


def traced_curve(family: AnyFamily, curve: TransitionCurve, eps: ArrayLike) -> BoundaryTrace | None:
    """Return the region of a transition curve by integration; None where damping moves its frequencies so far that they
    do not belong to the curve any more."""
    try:
        return trace_boundary(family, curve.centre, eps, type=curve.type, j=curve.j, p=curve.p, q=curve.q)
    except NoResonanceError:
        return None


def compare_region(theory: Theory, key: Key, given: FloatArray | None) -> RegionAgreement:
    """Compare one region of a family.

    Parameters
    ----------
    theory : Theory
    key : Key
        One of ``theory.curves(1.0)``.
    given : ndarray or None
        The ladder; None for one that suits the region.
    """
    curve = theory.curves(1.0)[key]
    try:
        return _Comparison(theory, key, curve).result(given)
    except OutOfRangeError as error:
        return _not_compared(curve, Basis.DAMPED, str(error))
    except ValueError as error:  # one region that cannot be traced says nothing of the others
        return _not_compared(curve, Basis.UNTRACED, f"it cannot be traced: {error}")


class _Comparison:
    """One region, with the rungs that have been computed."""

    def __init__(self, theory: Theory, key: Key, curve: TransitionCurve) -> None:
        self.theory, self.key, self.curve = theory, key, curve
        self.system = theory.family.at(curve.centre)
        self.damped = is_damped(self.system)
        self.resolution = MIN_RESOLVED_GAP * curve.centre
        self.rungs: dict[float, _Rung] = {}

    def result(self, given: FloatArray | None) -> RegionAgreement:
        """Return the outcome."""
        apart = self._apart()
        if apart:
            return _not_compared(self.curve, Basis.UNCOUPLED, apart)
        tops = [given[-1]] if given is not None else self._tops()
        for top in tops:
            eps = given if given is not None else rungs_below(top)
            self.rungs = {}
            weighed = self._climb_down(eps, top)
            if weighed.outcome is not Outcome.NOT_COMPARED:
                break
        return self._report(weighed, top)

    def _apart(self) -> str:
        """Return why nothing can open the region; "" if something may."""
        if np.isinf(self.curve.eps_max):
            return "the excitation does not act on these modes"
        subsystem = natural_modes(self.system, self.curve.centre).subsystem
        if max(self.key.p, self.key.q) > subsystem.size or subsystem[self.key.p - 1] == subsystem[self.key.q - 1]:
            return ""
        return f"modes {self.key.q} and {self.key.p} are uncoupled, by symmetry; nothing was integrated"

    def _tops(self) -> list[float]:
        """Return the top rungs to try, the largest first."""
        tip = self.curve.tip
        top = top_rung(tip, self.curve.eps_max)
        first, second = self.curve.tips
        if 0 < first < np.inf and max(first, second) > MAX_TIP_RATIO * min(first, second):
            raise OutOfRangeError(
                f"first order lets it open at eps = {first:.4g}, second order at {second:.4g}: what first order leaves "
                "out is as strong there"
            )
        lower = MIN_TOP_OVER_TIP * tip
        return [top, lower] if 0 < tip < np.inf and lower < top else [top]

    def _climb_down(self, eps: FloatArray, top: float) -> _Weighed:
        """Weigh the ladder, with more rungs below as long as it is not decided."""
        for extension in range(MAX_EXTENSIONS + 1):
            for value in eps.tolist():
                if value not in self.rungs:
                    self.rungs[value] = self._rung(value, top)
            weighed = self._weigh(top)
            more = np.concatenate([rungs_below(eps[0] / 2, 1), eps])
            if weighed.settled or extension == MAX_EXTENSIONS or not self._resolves(more):
                break
            eps = more
        if not weighed.settled:
            together = self._together(float(eps[0]))
            if together:
                return _Weighed(True, Outcome.NOT_COMPARED, Basis.COINCIDENT, together)
            joined = {value: rung for value, rung in self.rungs.items() if rung.joined and not rung.trouble}
            for value, rung in joined.items():  # edges of other regions are no reason to disagree
                self.rungs[value] = rung._replace(trouble="integration finds it joined with another region")
            return self._weigh(top) if joined else weighed
        return weighed

    def _resolves(self, eps: FloatArray) -> bool:
        """Whether tracing still resolves, on the lowest of these rungs, what a wrong theory would leave of the gap.

        Further down the error of tracing is larger than that, and any theory would pass.
        """
        order = self.theory.order
        gaps = [np.abs(rung.traced - rung.analytic).max() / value**order for value, rung in self.rungs.items()]
        finite = [gap for gap in gaps if np.isfinite(gap)]
        return not finite or noise(eps[:RUNGS], order, self.resolution) <= MAX_REMAINDER * max(finite)

    def _rung(self, eps: float, top: float) -> _Rung:
        """Return the edges at ``eps``, where the damping is scaled as the order of the region asks for."""
        factor = (eps / top) ** self.curve.interaction if self.damped else 1.0
        none = np.full(2, np.nan)
        curve = self.theory.curves(factor).get(self.key)
        if curve is None:  # a mode that begins to oscillate with less damping, and moves the numbers of others
            return _Rung(none, none, none, "with less damping theory has no such resonance")
        analytic = np.array(curve.merged_edges(eps), dtype=float)
        trace = traced_curve(DampingScaled(self.theory.family, factor), curve, eps)
        if trace is None:
            return _Rung(analytic, none, none, "damping moves the natural frequencies by more than first order allows")
        named = trace.resonance
        if (named.p, named.q) != (self.key.p, self.key.q):
            return _Rung(analytic, none, none, f"integration takes this frequency for {named.label}")
        edges = np.array([trace.lower[0], trace.upper[0]])
        errors = np.array([trace.lower_error[0], trace.upper_error[0]])
        trouble = ""
        if trace.window == "stable":
            trouble = "without excitation the system is unstable (see perturb.general.stable_windows),"
        elif trace.kind[0] == Kind.UNDECIDED:
            trouble = "integration cannot tell this region from others"
        elif trace.kind[0] > Kind.STABLE and np.isnan(edges).any():
            trouble = "integration finds no edge where instability ends"
        elif np.isinf(analytic).any():
            trouble = "theory finds no edge where instability ends"
        joined = bool(np.isfinite([trace.lower_meeting[0], trace.upper_meeting[0]]).any())
        return _Rung(analytic, edges, errors, trouble, joined, bool(trace.covered[0]))

    def _weigh(self, top: float) -> _Weighed:
        """Return what the rungs say so far."""
        eps = np.array(sorted(self.rungs))
        troubled = np.array([bool(self.rungs[value].trouble) for value in eps.tolist()])
        if (troubled[-1] and self.damped) or troubled[:MIN_RUNGS].any():
            return self._troubled(eps[troubled], settled=bool(self.damped and troubled[-1]))
        count = int(np.argmax(troubled)) if troubled.any() else eps.size
        eps = eps[: min(count, RUNGS)]
        analytic = np.array([self.rungs[value].analytic for value in eps.tolist()]).T
        traced = np.array([self.rungs[value].traced for value in eps.tolist()]).T
        predicted = analytic[1] - analytic[0] > self.resolution  # NaN (closed) compares false
        found = traced[1] - traced[0] > self.resolution
        if not predicted.any() and not np.isfinite(self.curve.tip) and np.isnan(analytic).any():
            return self._closed(eps, traced, found)
        if not predicted.any() and not found.any():
            return self._nothing_open(float(eps[-1]))
        both = predicted & found if predicted.any() else found
        if both[:MIN_RUNGS].all():
            length = int(np.argmin(both)) if not both.all() else both.size
            return self._edges(eps[:length], analytic[:, :length], traced[:, :length])
        if (predicted == found).all():
            reason = f"open at fewer than {MIN_RUNGS} of the smallest amplitudes, by theory and by integration"
            return _Weighed(False, Outcome.NOT_COMPARED, Basis.UNTRACED, reason)
        side = "theory" if (predicted & ~found).any() else "integration"
        where = _listed(eps[predicted != found])
        return _Weighed(False, Outcome.DISAGREES, Basis.EDGES, f"only {side} finds it open at eps = {where}")

    def _troubled(self, where: FloatArray, settled: bool) -> _Weighed:
        reasons: dict[str, list[float]] = {}
        for value in where.tolist():
            reasons.setdefault(self.rungs[value].trouble, []).append(value)
        reason, values = next(iter(reasons.items()))
        return _Weighed(settled, Outcome.NOT_COMPARED, Basis.UNTRACED, f"{reason} at eps = {_listed(np.array(values))}")

    def _nothing_open(self, top: float) -> _Weighed:
        tip = self.curve.tip
        if 0 < tip < np.inf:
            reason = f"closed by damping on the rungs up to eps = {top:.4g}; theory lets it open at {tip:.4g}"
            return _Weighed(True, Outcome.NOT_COMPARED, Basis.DAMPED, reason)
        return self._none_found(f"without width by theory up to eps = {top:.4g}")

    def _none_found(self, theory: str) -> _Weighed:
        """Return what it is worth that integration finds nothing open: nothing where the place is in another region."""
        covered = sorted(value for value, rung in self.rungs.items() if rung.covered)
        free = sorted(set(self.rungs) - set(covered))
        beside = f"their place lies in another region at eps = {_listed(covered)}" if covered else ""
        if len(free) < MIN_RUNGS:
            reason = f"{theory}, but whether these modes are unstable cannot be seen: {beside}"
            return _Weighed(True, Outcome.NOT_COMPARED, Basis.UNTRACED, reason)
        found = f"integration finds no instability of these modes up to eps = {free[-1]:.4g}"
        reason = f"{theory}, and {found}" + (f"; {beside}" if beside else "")
        return _Weighed(True, Outcome.AGREES, Basis.CLOSED, reason)

    def _closed(self, eps: FloatArray, traced: FloatArray, found: NDArray[np.bool_]) -> _Weighed:
        """Return what there is to say of a region that theory closes at every eps."""
        order, width = self.theory.order, np.where(found, traced[1] - traced[0], 0.0)
        if not found.any():
            return self._none_found("closed by theory at every eps")
        if not found[:MIN_RUNGS].any():
            reason = (
                f"closed to order {order}; integration finds it open from eps = {eps[np.argmax(found)]:.4g} on only"
            )
            return _Weighed(True, Outcome.AGREES, Basis.CLOSED, reason)
        if found.all() and vanishes(eps, width, order, self.resolution):
            reason = (
                f"closed to order {order}; integration finds a width of order {fitted_order(eps, width):.2f} in eps"
            )
            return _Weighed(True, Outcome.AGREES, Basis.CLOSED, reason)
        reason = f"closed by theory, but integration finds it open, {width.max():.3g} wide at most"
        return _Weighed(False, Outcome.DISAGREES, Basis.CLOSED, reason)

    def _edges(self, eps: FloatArray, analytic: FloatArray, traced: FloatArray) -> _Weighed:
        """Return what there is to say of edges that both sides have."""
        order, wanted = self.theory.order, self.theory.order + 1
        gap = np.abs(traced - analytic)
        if (gap <= 10 * self.resolution).all():
            return _Weighed(True, Outcome.AGREES, Basis.EDGES, "no gap at all that tracing could resolve")
        fitted = [fitted_order(eps, edge) for edge in gap]
        orders = " and ".join("(none)" if np.isnan(m) else f"{m:.2f}" for m in fitted)
        left = [edge for edge in traced - analytic if not vanishes(eps, edge, order, self.resolution)]
        if left:
            reason = f"gap of order {orders} in eps where {wanted} is expected"
            if all(still_falls(eps, edge, order) for edge in left):
                reason = f"{reason}, but over eps^{order} it still falls on the smallest eps"
                return _Weighed(False, Outcome.NOT_COMPARED, Basis.UNSETTLED, reason)
            return _Weighed(False, Outcome.DISAGREES, Basis.EDGES, reason)
        if all(abs(m - wanted) <= ORDER_TOLERANCE for m in fitted):
            return _Weighed(True, Outcome.AGREES, Basis.EDGES, f"gap of order {orders} in eps (expected {wanted})")
        bound = float((gap / eps**wanted).max())
        reason = f"gap at most {bound:.2g} eps^{wanted} on these rungs, and nothing of order {order} is left at eps = 0"
        return _Weighed(True, Outcome.AGREES, Basis.EDGES, reason)

    def _together(self, eps: float) -> str:
        """Return which resonances share the region down to ``eps``; "" if it stands alone there."""
        if not self.curve.coincident or eps < ALONE * self.curve.isolated_up_to:
            return ""
        names = ", ".join(self.curve.coincident)
        return f"resonates together with {names}: its edges are not those of one pair of modes"

    def _report(self, weighed: _Weighed, top: float) -> RegionAgreement:
        eps = np.array(sorted(self.rungs))
        rungs = [self.rungs[value] for value in eps.tolist()]
        analytic, traced, error = (np.array([getattr(rung, name) for rung in rungs]).T for name in _Rung._fields[:3])
        gap = np.abs(traced - analytic)
        width, found = analytic[1] - analytic[0], traced[1] - traced[0]
        with np.errstate(divide="ignore", invalid="ignore"):
            ratio = np.where(width > self.resolution, found / width, np.nan)
        compared = ""
        if weighed.outcome is not Outcome.NOT_COMPARED:
            compared = f"eps = {_listed(eps)}"
            if np.isfinite(gap).any():
                compared = f"lower and upper edge at {compared}: gap at most {np.nanmax(gap):.2g}"
            else:
                compared = f"instability of these modes looked for at {compared}"
        return RegionAgreement(
            self.curve.label,
            self.curve.type,
            self.curve.p,
            self.curve.q,
            self.curve.j,
            self.curve.centre,
            eps,
            analytic,
            traced,
            error,
            gap,
            np.array([fitted_order(eps, edge) for edge in gap]),
            ratio,
            weighed.outcome,
            weighed.basis,
            weighed.reason,
            compared,
            self.curve.coincident,
        )


def _not_compared(curve: TransitionCurve, basis: Basis, reason: str) -> RegionAgreement:
    none = np.empty((2, 0))
    return RegionAgreement(
        curve.label,
        curve.type,
        curve.p,
        curve.q,
        curve.j,
        curve.centre,
        np.empty(0),
        none,
        none,
        none,
        none,
        np.full(2, np.nan),
        np.empty(0),
        Outcome.NOT_COMPARED,
        basis,
        reason,
        "",
        curve.coincident,
    )


def _listed(values: FloatArray | Sequence[float]) -> str:
    """Return the amplitudes in words: each of a few, the ends of many."""
    if len(values) > RUNGS:
        return f"{values[0]:.4g} to {values[-1]:.4g}"
    return ", ".join(f"{value:.4g}" for value in values)
