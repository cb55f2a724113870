"""What `trace_boundary` says of a resonance."""

from __future__ import annotations

import numpy as np

from floquet import BoundaryTrace, Kind, trace_boundary
from periodic import PeriodicSystem
from tests.hunt.statements.magnus import Flows
from tests.hunt.statements.origin import origin
from tests.hunt.statements.parts import Part, frequencies, parts_of
from tests.hunt.statements.statement import Judged, Statement

# Distances from an edge, as parts of the width, at which both sides are looked at: the first that can be told counts.
DISTANCES = (1e-3, 1e-2, 1e-4, 1e-5)
# Errors of an edge within which nothing is said, and the part of Omega that is no gap.
ERRORS, NO_GAP = 10.0, 1e-6
# Points inside an interval, and points of a scan.
INSIDE, SCAN = 9, 41
# Growth at the outermost of these points, as part of that in the middle.
LEAST_GROWTH_INSIDE = 0.3
# Every so many regions are followed down to their origin.
FOLLOWED = 4


def ask(random: np.random.Generator, system: PeriodicSystem) -> tuple[str, list[Statement]]:
    """Ask for a random resonance at a random amplitude."""
    parts = parts_of(system)
    omega = frequencies(parts)
    if not omega.size:
        return "nothing oscillates", []
    few = min(len(omega), 4)
    p, q = np.sort(random.integers(0, few, 2))[::-1]
    j = int(random.choice([1, 1, 1, 2, 3]))
    type = "difference" if p != q and omega[p] - omega[q] > 0.02 * omega[p] and random.integers(4) == 0 else "sum"
    near = float(omega[p] + omega[q] if type == "sum" else omega[p] - omega[q]) / j
    eps = float(10 ** random.uniform(-2, -0.2)) / relative_strength(parts)
    asked = f"trace_boundary(system, {near!r}, [{eps!r}], type={type!r}, j={j}, p={p + 1}, q={q + 1})"
    trace = trace_boundary(system, near, [eps], type=type, j=j, p=int(p) + 1, q=int(q) + 1)
    follow = int(random.integers(FOLLOWED)) == 0
    return asked, list(statements(trace, parts, omega, follow))


def relative_strength(parts: list[Part]) -> float:
    """Return by which part of itself eps = 1 changes the stiffness of the softest mode that it acts on."""
    found = [0.0]
    for part in parts:
        if len(part.exponents) and part.F.any():
            found.append(float(max(np.linalg.norm(F, 2) for F in part.F) / part.exponents.imag.min() ** 2))
    return max(found) or 1.0


def statements(trace: BoundaryTrace, parts: list[Part], omega: np.ndarray, follow: bool) -> list[Statement]:
    """Return the statements of a trace at its first amplitude."""
    own = [part for part in parts if any(holds(part, one.p, one.q, omega) for one in trace.resonances)]
    either = [part for part in parts if any(part.holds(omega[n - 1]) for n in trace.resonance[:2])]
    flows, everything = Flows(own or either), Flows(parts)
    eps, kind, intervals = float(trace.eps[0]), Kind(trace.kind[0]), trace.intervals[0]
    found = [_centre(trace, omega)]
    if kind == Kind.UNDECIDED:
        return [*found, Statement("trace", kind.name, Judged.WITHHELD)]
    if trace.covered[0]:
        return [*found, _covered(flows if own else everything, trace, eps)]
    inside = 1 if trace.window == "unstable" else -1
    for low, high in intervals:
        found += _interval(flows if inside < 0 else everything, flows, float(low), float(high), eps, trace, inside)
    if len(intervals) and inside > 0:
        found.append(_kind(flows, eps, trace))
        if follow:
            found.append(_named(flows, trace, eps))
    elif kind > Kind.STABLE:  # no window
        sentence = f"nothing is stable at {trace.resonance.centre!r}"
        found.append(Statement("no window", sentence, _told(flows.state(trace.resonance.centre, eps)[0] == 1)))
    elif kind == Kind.STABLE and inside > 0:
        found.append(_closed(flows, trace, eps, coupled=bool(own)))
    return found


def holds(part: Part, p: int, q: int, omega: np.ndarray) -> bool:
    """Whether a part has two modes of the frequencies of modes ``p`` and ``q``; one, if they are the same."""
    return part.holds(*(float(omega[n - 1]) for n in {p, q}))


def _centre(trace: BoundaryTrace, omega: np.ndarray) -> Statement:
    one = trace.resonance
    centre = (omega[one.p - 1] + one.sign * omega[one.q - 1]) / one.j
    right = abs(centre - one.centre) <= 1e-6 * centre
    return Statement("centre", f"{one.label} has its centre at {one.centre!r}", _told(right))


def _told(right: bool) -> Judged:
    return Judged.TRUE if right else Judged.WRONG


def _interval(
    everything: Flows, flows: Flows, low: float, high: float, eps: float, trace: BoundaryTrace, inside: int
) -> list[Statement]:
    found = []
    centre = trace.resonance.centre
    a, b = low if np.isfinite(low) else centre / 2, high if np.isfinite(high) else 5 * centre
    if a > b:
        return [Statement("inside", f"an interval {low!r} to {high!r}", Judged.WRONG)]
    word = "unstable" if inside > 0 else "stable"
    grid = a + (b - a) * (1 - np.cos(np.pi * np.arange(1, INSIDE + 1) / (INSIDE + 1))) / 2
    finest = np.pi * trace.resonance.j * (b - a) / (2 * centre)  # largest growth in an interval so wide
    state = everything.state(grid, eps, LEAST_GROWTH_INSIDE * finest)
    judged = Judged.TRUE if (state == inside).all() else Judged.TOO_FINE
    if (state == -inside).any() and not _is_gap_resolved(everything, grid[state == -inside], eps, inside):
        judged = Judged.WRONG
    found.append(Statement("inside", f"{word} at {grid.tolist()} and between", judged))
    errors = np.array([trace.lower_error[0], trace.upper_error[0]])
    for side, edge, error in ((-1, low, errors[0]), (1, high, errors[1])):
        if np.isfinite(edge):
            error = error if np.isfinite(error) and edge in (trace.lower[0], trace.upper[0]) else 1e-9 * edge
            found.append(_edge(everything, flows, edge, side, float(error), b - a, eps, inside))
    return found


def _is_gap_resolved(flows: Flows, Omega: np.ndarray, eps: float, inside: int) -> bool:
    """Whether all gaps found are narrower than what counts as a gap."""
    beside = [flows.state(Omega * (1 + side * NO_GAP / 2), eps) for side in (-1, 1)]
    return bool(all((one == inside).all() for one in beside))


def _edge(
    everything: Flows, flows: Flows, edge: float, side: int, error: float, width: float, eps: float, inside: int
) -> Statement:
    name = "upper" if side > 0 else "lower"
    sentence = f"{name} edge at {edge!r} ± {error:.1g}, of an interval {width:.3g} wide"
    seen = set()
    for one in (everything, *(Flows([part]) for part in flows.parts)):
        within = beyond = 0
        for part in DISTANCES:
            d = max(part * width, ERRORS * error)
            if d > 0.2 * width:
                continue
            if within == 0:
                within = int(one.state(edge - side * d, eps)[0])
            if beyond in (0, inside):  # another region may begin so near
                beyond = int(one.state(edge + side * max(d, NO_GAP * edge), eps)[0]) or beyond
        if within == inside and beyond == -inside:
            return Statement("edge", sentence, Judged.TRUE)
        seen |= {within, beyond}
    return Statement("edge", f"{sentence}: no part has an edge there", Judged.TOO_FINE if 0 in seen else Judged.WRONG)


def _kind(flows: Flows, eps: float, trace: BoundaryTrace) -> Statement:
    kind = Kind(trace.kind[0])
    bounds = np.where(np.isnan(trace.intervals[0]), trace.resonance.centre * np.array([0.5, 5.0]), trace.intervals[0])
    meetings = np.array([[trace.lower_meeting[0], trace.upper_meeting[0]]])
    bounds = np.concatenate([bounds, meetings[np.isfinite(meetings).all(axis=1)]])
    fine = np.concatenate([np.linspace(low, high, SCAN // 2)[1:-1] for low, high in bounds])
    kinds = {one for flow in flows.flows for one in flow.kinds(fine, eps)}
    judged = _told(kind in kinds) if kinds else Judged.TOO_FINE
    return Statement("kind", f"{kind.name} somewhere inside {trace.intervals[0].tolist()}", judged)


def _named(flows: Flows, trace: BoundaryTrace, eps: float) -> Statement:
    names = ", ".join(one.label for one in trace.resonances)
    centre = trace.resonance.centre
    low, high = min(trace.intervals[0], key=lambda one: abs(np.nan_to_num(one, nan=centre).mean() - centre))
    low, high = np.nan_to_num(low, nan=centre * 0.7), np.nan_to_num(high, nan=centre * 1.5)
    start = float(min(max(centre, 0.9 * low + 0.1 * high), 0.1 * low + 0.9 * high))
    sentence = f"the region at {low!r} to {high!r} is that of {names}"
    if flows.state(start, eps)[0] != 1:
        start = float(low + high) / 2
    if high - low < 1e-4 * centre:
        return Statement("name", sentence, Judged.TOO_FINE)
    if np.isfinite([trace.lower_meeting[0], trace.upper_meeting[0]]).any():
        return Statement("name", f"{sentence} and of another, which takes over", Judged.TOO_FINE)
    came = origin(flows, start, eps, float(high - low), trace.resonance.j, centre)
    if came is None:
        return Statement("name", sentence, Judged.TOO_FINE)
    place, uncertainty = came
    right = any(abs(place - one.centre) <= 2 * uncertainty + 1e-3 * centre for one in trace.resonances)
    return Statement("name", f"{sentence}; it comes from {place:.6g} ± {uncertainty:.2g}", _told(right))


def _covered(flows: Flows, trace: BoundaryTrace, eps: float) -> Statement:
    one = trace.resonance
    grid = one.centre + _reach(flows, trace, eps) * np.linspace(-1, 1, SCAN) ** 3
    sentence = f"{one.label} is closed, and its place {one.centre!r} lies in the region of others"
    return Statement("covered", sentence, _told(bool((flows.state(grid, eps) == 1).any())))


def _reach(flows: Flows, trace: BoundaryTrace, eps: float) -> float:
    """Return how far from its centre a region may be, to first order."""
    centre = trace.resonance.centre
    omega = [min(part.exponents.imag) for part in flows.parts if len(part.exponents)]
    force = max((float(np.linalg.norm(F, 2)) for part in flows.parts for F in part.F), default=0.0)
    change = eps * force / (2 * min(omega) * centre)
    return centre * min(0.05, change + change**2) + 1e-6 * centre


def _closed(flows: Flows, trace: BoundaryTrace, eps: float, coupled: bool) -> Statement:
    one = trace.resonance
    reach = _reach(flows, trace, eps)
    grid = one.centre + reach * np.linspace(-1, 1, SCAN) ** 3
    sentence = f"no instability of {one.label} round {one.centre!r} within {reach:.3g}"
    state = flows.state(grid, eps)
    if not (state == 1).any():
        return Statement("closed", sentence, Judged.TRUE)
    if not coupled:  # no part has both modes
        return Statement("closed", sentence, Judged.TRUE)
    at = np.flatnonzero(state == 1)
    nearest = float(grid[at[np.abs(grid[at] - one.centre).argmin()]])
    came = origin(flows, nearest, eps, 2 * reach, one.j, one.centre)
    if came is None:
        return Statement("closed", f"{sentence}; {nearest!r} is unstable", Judged.TOO_FINE)
    place, uncertainty = came
    is_own = abs(place - one.centre) <= uncertainty + 1e-6 * one.centre
    return Statement(
        "closed", f"{sentence}; {nearest!r} is unstable, from {place:.8g} ± {uncertainty:.2g}", _told(not is_own)
    )
