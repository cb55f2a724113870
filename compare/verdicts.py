"""Where theory and integration agree: region by region, in plain numbers.

Each region's two edges are traced by root-finding on the Floquet multipliers and held against the analytic transition
curves on a ladder of eps. The expansion orders damping with the excitation, c = eps alpha (eq. (21)), so the damping
matrix shrinks along the ladder in step with eps; the last rung is the system as given. A theory of order m leaves a gap
O(eps^(m+1)): the fitted order says whether it does.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike
from tqdm import tqdm

from floquet import BoundaryTrace, Kind, trace_boundary
from floquet.boundary import NoResonanceError
from floquet.running import gather
from periodic import PeriodicSystem, SystemFamily, member_at
from periodic.checks import FloatArray, grid, interval, one_of, whole_number, workers
from perturb import TransitionCurve, transition_curves

# Rungs double, so that two neighbours give a local order; the smallest keeps the gap of a second-order edge far above
# the tracing error of 1e-9, the largest is still small against the distance of neighbouring regions.
DEFAULT_LADDER = (0.0125, 0.025, 0.05, 0.1)
# How far the fitted order may fall short of the expected one: the next term of the expansion still counts on rungs as
# large as these.
ORDER_TOLERANCE = 0.15
# Largest value at eps = 0 of a gap over eps^order, as part of its largest value on the ladder: the error of the
# polynomial through the rungs.
MAX_REMAINDER = 0.02
# Distance below which two edges are one, as part of the frequency: ten times what tracing resolves.
MIN_RESOLVED_GAP = 1e-8


@dataclass(frozen=True, eq=False)
class RegionAgreement:
    """One region of instability by theory and by integration, on a ladder of eps.

    Attributes
    ----------
    label, type : str
        Name of the resonance ("ω₁+ω₃") and its type ("sum" or "difference").
    p, q, j : int
        Modes (from 1) and harmonic: j Omega = omega_p ± omega_q.
    centre : float
        Frequency at which the region opens.
    eps : ndarray, shape (k,)
        Ladder; the damping of rung i is the system's times eps[i] / eps[-1].
    analytic, traced : ndarray, shape (2, k)
        Lower and upper edge; NaN where closed.
    traced_error : ndarray, shape (2, k)
        Error estimate of the traced edges.
    gap : ndarray, shape (2, k)
        |traced - analytic|; NaN where either is closed.
    order : ndarray, shape (2,)
        Fitted order of the gap in eps at each edge; NaN where it cannot be fitted.
    width_ratio : ndarray, shape (k,)
        Traced width over analytic width; NaN where either is closed.
    agrees : bool
        The verdict, and in ``reason`` why.
    reason : str
    """

    label: str
    type: str
    p: int
    q: int
    j: int
    centre: float
    eps: FloatArray
    analytic: FloatArray
    traced: FloatArray
    traced_error: FloatArray
    gap: FloatArray
    order: FloatArray
    width_ratio: FloatArray
    agrees: bool
    reason: str

    def to_dict(self) -> dict[str, Any]:
        """Return plain numbers and strings, NaN as None, fit for JSON."""
        return {name: _plain(value) for name, value in vars(self).items()}


def agreement(
    family: SystemFamily,
    Omega_range: tuple[float, float],
    eps: ArrayLike = DEFAULT_LADDER,
    *,
    order: Literal[1, 2] = 1,
    types: tuple[str, ...] = ("sum", "difference"),
    modes: int | None = None,
    n_jobs: int | None = -1,
    progress: bool = False,
) -> list[RegionAgreement]:
    """Judge every region that opens in a frequency window, theory against Floquet integration.

    Parameters
    ----------
    family : SystemFamily
        A `periodic.PeriodicSystem`, a `plate.MovingPlate`, or anything with ``at(Omega)``.
    Omega_range : (float, float)
        Window of excitation frequencies in which a region's centre must lie.
    eps : array_like, shape (k,)
        Ladder, increasing, at least three positive values; rungs that double give the cleanest order.
    order : 1 or 2
        Order of the theory; the gap is expected to be O(eps^(order + 1)).
    types : tuple of str
        Types of resonance to judge. Regions that the theory predicts closed are judged too: integration must find
        no instability there.
    modes : int, optional
        Judge only resonances among the lowest ``modes`` modes; all if left out.
    n_jobs : int or None
        Regions traced at once, as in `floquet.stability_chart`.
    progress : bool
        Show a progress bar.

    Returns
    -------
    list of RegionAgreement
        By ascending centre.

    Raises
    ------
    ValueError
        If an argument is out of range, or the stiffness is not positive definite (see `perturb.gyroscopic_modes`).
    """
    window = interval("Omega_range", Omega_range, nonnegative=True)
    member_at(family, window[1], "family")
    ladder = grid("eps", eps, positive=True)
    if ladder.size < 3:
        raise ValueError(f"eps has {ladder.size} values; give at least three, so that an order can be fitted")
    one_of("order", order, (1, 2))
    n_jobs = workers("n_jobs", n_jobs)
    if modes is not None:
        whole_number("modes", modes, least=1)

    rungs = [_DampingScaled(family, value / ladder[-1]) for value in ladder]
    predictions = [_select(transition_curves(rung, window, order=order, types=types), modes) for rung in rungs]
    regions = sorted(predictions[-1], key=lambda key: predictions[-1][key].centre)
    tasks = [(rungs, [curves[key] for curves in predictions], ladder, order) for key in regions]
    with tqdm(desc="boundaries", total=len(tasks), unit="region", disable=not progress) as bar:
        return gather(_judge, tasks, n_jobs, bar)


@dataclass(frozen=True, eq=False)
class _DampingScaled:
    """A family with its damping matrix multiplied by ``factor``: one rung of the ladder c = eps alpha."""

    family: SystemFamily
    factor: float

    def at(self, Omega: float) -> PeriodicSystem:
        system = self.family.at(Omega)
        if self.factor == 1 or not system.damping.any():
            return system
        return PeriodicSystem(
            system.mass,
            system.gyroscopic,
            self.factor * system.damping,
            system.stiffness,
            system.cosine,
            system.sine,
        )


def _select(curves: list[TransitionCurve], modes: int | None) -> dict[tuple[Any, ...], TransitionCurve]:
    return {
        (curve.p, curve.q, curve.j, curve.type): curve
        for curve in curves
        if modes is None or max(curve.p, curve.q) <= modes
    }


def _judge(rungs: list[_DampingScaled], curves: list[TransitionCurve], eps: FloatArray, order: int) -> RegionAgreement:
    last = curves[-1]
    traces = [traced_curve(rung, last, value) for rung, value in zip(rungs, eps, strict=True)]
    analytic = np.array([curve.edges(value) for curve, value in zip(curves, eps, strict=True)], dtype=float).T
    traced = _stack(traces, "lower", "upper")
    gap = np.abs(traced - analytic)
    width, traced_width = analytic[1] - analytic[0], traced[1] - traced[0]
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = np.where(width > MIN_RESOLVED_GAP * last.centre, traced_width / width, np.nan)
    fitted = np.array([fitted_order(eps, edge) for edge in gap])
    agrees, reason = False, _trouble(traces, eps)
    if not reason:
        agrees, reason = _verdict(eps, analytic, traced, fitted, order, MIN_RESOLVED_GAP * last.centre)
    return RegionAgreement(
        label=last.label,
        type=last.type,
        p=last.p,
        q=last.q,
        j=last.j,
        centre=last.centre,
        eps=eps,
        analytic=analytic,
        traced=traced,
        traced_error=_stack(traces, "lower_error", "upper_error"),
        gap=gap,
        order=fitted,
        width_ratio=ratio,
        agrees=agrees,
        reason=reason,
    )


def traced_curve(family: SystemFamily, curve: TransitionCurve, eps: ArrayLike) -> BoundaryTrace | None:
    """Return the region of a transition curve by integration; None where damping moves its frequencies so far that they
    do not belong to the curve any more."""
    try:
        return trace_boundary(family, curve.centre, eps, type=curve.type, j=curve.j)
    except NoResonanceError:
        return None


def _trouble(traces: list[BoundaryTrace | None], eps: FloatArray) -> str:
    """Return why, and where, there is nothing that the edges of theory could be held against; "" if there is."""
    missing = np.array([trace is None for trace in traces])
    kind = np.array([Kind.STABLE if trace is None else trace.kind[0] for trace in traces])
    edges = _stack(traces, "lower", "upper")
    reasons = {
        "damping moves the natural frequencies by more than first order allows": missing,
        "integration cannot tell this region from others": kind == Kind.UNDECIDED,
        "integration finds no edge where instability ends": (kind > Kind.STABLE) & np.isnan(edges).any(axis=0),
    }
    return next((f"{reason} at eps = {_listed(eps[rungs])}" for reason, rungs in reasons.items() if rungs.any()), "")


def _listed(values: FloatArray) -> str:
    return ", ".join(f"{value:g}" for value in values)


def fitted_order(eps: FloatArray, gap: FloatArray) -> float:
    """Return the order of ``gap`` in eps as eps -> 0, from the three smallest rungs.

    Two local orders, log(gap ratio) / log(eps ratio), extrapolated linearly to eps = 0: on gap = a eps^m + b eps^(m+1)
    a single ratio is off by O(eps), the extrapolation by O(eps^2). NaN if a gap is missing or zero.
    """
    e, g = eps[:3], gap[:3]
    if not (np.isfinite(g).all() and (g > 0).all()):
        return float("nan")
    local = np.diff(np.log(g)) / np.diff(np.log(e))
    middle = 0.5 * (e[1:] + e[:-1])
    return float(local[0] - (local[1] - local[0]) * middle[0] / (middle[1] - middle[0]))


def vanishes(eps: FloatArray, difference: FloatArray, order: int, resolution: float) -> bool:
    """Return whether a signed difference of edges has no part of order ``order``, or lower, in eps.

    A gap whose leading part happens to be small changes sign between rungs, and then has no local order. Divided by
    eps^order it still has to go to zero: the polynomial through all rungs says where it goes.
    """
    quotient = difference / eps**order
    if not np.isfinite(quotient).all():
        return False
    others = [np.delete(eps, k) for k in range(eps.size)]
    weights = np.array([np.prod(rest / (rest - e)) for e, rest in zip(eps, others, strict=True)])  # Lagrange's, at 0
    allowed = MAX_REMAINDER * np.abs(quotient).max() + resolution * np.abs(weights / eps**order).sum()
    return bool(abs(weights @ quotient) <= allowed)


def _verdict(
    eps: FloatArray,
    analytic: FloatArray,
    traced: FloatArray,
    fitted: FloatArray,
    order: int,
    resolution: float,
) -> tuple[bool, str]:
    gap = np.abs(traced - analytic)
    predicted = analytic[1] - analytic[0] > resolution  # NaN (closed) compares false
    found = traced[1] - traced[0] > resolution
    wanted = order + 1
    if not predicted.any():
        if not found.any():
            return True, f"closed by theory up to eps = {eps[-1]:g}, and integration finds no instability"
        growth = fitted_order(eps, traced[1] - traced[0])
        if growth >= wanted - ORDER_TOLERANCE:
            return True, f"closed to order {order}; integration finds it open with a width of order {growth:.2f} in eps"
        largest = float(np.nanmax(traced[1] - traced[0]))
        return False, f"closed by theory, but integration finds it open, {largest:.3g} wide at most"
    if (predicted != found).any():
        side = "theory" if predicted[predicted != found][0] else "integration"
        return False, f"only {side} finds it open at eps = {_listed(eps[predicted != found])}"
    if not predicted.all():
        return True, "open on the same rungs by theory and by integration"
    at_floor = np.asarray((gap <= 10 * resolution).all(axis=1))
    if at_floor.all():
        return True, "no gap at all that tracing could resolve"
    if (at_floor | (fitted >= wanted - ORDER_TOLERANCE)).all():
        orders = " and ".join("(none)" if flat else f"{m:.2f}" for flat, m in zip(at_floor, fitted, strict=True))
        return True, f"gap of order {orders} in eps (expected {wanted})"
    orders = f"{fitted[0]:.2f} and {fitted[1]:.2f}"
    vanishing = [vanishes(eps, edge, order, resolution) for edge in traced - analytic]
    if (at_floor | (fitted >= wanted - ORDER_TOLERANCE) | vanishing).all():
        return True, f"gap changes sign (order {orders} fitted); nothing of order {order} in eps is left at eps = 0"
    return False, f"gap of order {orders} in eps where {wanted} is expected"


def _stack(traces: list[BoundaryTrace | None], *names: str) -> FloatArray:
    return np.array([[np.nan if trace is None else getattr(trace, name)[0] for trace in traces] for name in names])


def _plain(value: Any) -> Any:
    if isinstance(value, np.ndarray):
        return [_plain(item) for item in value.tolist()]
    if isinstance(value, list):
        return [_plain(item) for item in value]
    if isinstance(value, float) and not np.isfinite(value):
        return None
    return value
