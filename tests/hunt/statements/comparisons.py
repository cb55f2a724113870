"""What `agreement` says of the regions of a window."""

from __future__ import annotations

import numpy as np

from compare import agreement
from compare.outcome import Basis, Outcome, RegionAgreement
from periodic import PeriodicSystem
from tests.hunt.statements.magnus import Flows
from tests.hunt.statements.origin import origin
from tests.hunt.statements.parts import Part, frequencies, parts_of
from tests.hunt.statements.statement import Judged, Statement
from tests.hunt.statements.traces import holds

# At these parts of the width from an edge, or this many errors, both sides are looked at: the first that is right will
# do, as another region may begin near by.
DISTANCES, ERRORS = np.array([1e-2, 1e-3, 1e-4]), 10.0
SCAN = 41
# What is left at the lowest rung of a gap over eps^order, as part of its value at the top, where it vanishes.
LEFT = 0.75


def ask(random: np.random.Generator, system: PeriodicSystem) -> tuple[str, list[Statement]]:
    """Ask for the agreement in a random window."""
    parts = parts_of(system)
    omega = frequencies(parts)
    if not omega.size:
        return "nothing oscillates", []
    middle = 2 * omega[random.integers(min(3, len(omega)))]
    low, high = float(middle * random.uniform(0.88, 0.97)), float(middle * random.uniform(1.03, 1.12))
    order = int(random.choice([1, 1, 2]))
    asked = f"agreement(system, ({low!r}, {high!r}), order={order}, modes=4)"
    verdicts = agreement(system, (low, high), order=order, modes=4, n_jobs=1)
    found = []
    for verdict in verdicts:
        found += _verdict(verdict, parts, omega, order)
    return asked, found


def _verdict(one: RegionAgreement, parts: list[Part], omega: np.ndarray, order: int) -> list[Statement]:
    says = f"{one.label} {one.outcome}: {one.reason}"
    if one.outcome is Outcome.DISAGREES:  # theory of this order is right as eps -> 0: blamed for what it never promised
        return [Statement("disagrees", says, Judged.WRONG)]
    own = [part for part in parts if holds(part, one.p, one.q, omega)]
    if one.outcome is Outcome.NOT_COMPARED:
        if one.basis is Basis.UNCOUPLED:
            pair = float(omega[one.p - 1]), float(omega[one.q - 1])
            idle = not own or any(not part.F.any() for part in own)  # of parts with equal frequencies one is enough
            idle |= any(not part.holds(*set(pair)) and any(map(part.holds, pair)) for part in parts)
            return [Statement("uncoupled", says, Judged.TRUE if idle else Judged.WRONG)]
        if one.basis is Basis.DAMPED:
            return []
        return [Statement("verdict", says, Judged.WITHHELD)]
    if not own:
        return [Statement("verdict", f"{says}, of modes that nothing couples", Judged.WRONG)]
    found = [_numbers(one, says, order)]
    flows, each, eps = Flows(own), [Flows([part]) for part in own], float(one.eps[-1])
    if one.basis is Basis.CLOSED:
        return [*found, _closed(one, flows, eps, says)]
    for k, name in ((0, "lower"), (1, "upper")):
        edge, width = float(one.traced[k, -1]), float(one.traced[1, -1] - one.traced[0, -1])
        if not np.isfinite(width):
            continue
        inward = (1 - 2 * k) * np.maximum(DISTANCES * width, ERRORS * float(one.traced_error[k, -1]))
        # the region of another part may overlap
        near = [np.array([one.state(edge + inward, eps), one.state(edge - inward, eps)]) for one in each]
        right = any(((inside == 1) & (outside == -1)).any() for inside, outside in near)
        told = all(states.all() for states in near)
        judged = Judged.TRUE if right else Judged.WRONG if told else Judged.TOO_FINE
        found.append(Statement("traced", f"{one.label}: {name} edge by integration {edge!r} at eps = {eps!r}", judged))
    return found


def _numbers(one: RegionAgreement, says: str, order: int) -> Statement:
    """Agreement has numbers behind it, and they are close."""
    if not one.compared or not one.eps.size:
        return Statement("numbers", f"{says}: nothing was compared", Judged.WRONG)
    if one.basis is Basis.CLOSED or not np.isfinite(one.gap).any():
        return Statement("numbers", says, Judged.TRUE)
    part = one.gap / one.eps**order
    noise = 1e-7 * one.centre / one.eps[0] ** order
    count = min(4, one.eps.size)
    left = part[:, 0] <= LEFT * np.nanmax(part[:, :count], axis=1) + noise
    small = one.gap[:, 0] <= 0.1 * (one.traced[1, 0] - one.traced[0, 0]) + noise
    right = bool((left | small).all())
    return Statement("numbers", f"{says}; gap / eps^{order} = {part.tolist()}", Judged.TRUE if right else Judged.WRONG)


def _closed(one: RegionAgreement, flows: Flows, eps: float, says: str) -> Statement:
    reach = 0.02 * one.centre
    grid = one.centre + reach * np.linspace(-1, 1, SCAN) ** 3
    at = np.flatnonzero(flows.state(grid, eps) == 1)
    if not at.size or "width" in one.reason or "from eps" in one.reason:
        return Statement("closed", says, Judged.TRUE)
    nearest = float(grid[at[np.abs(grid[at] - one.centre).argmin()]])
    came = origin(flows, nearest, eps, reach, one.j, one.centre)
    if came is None:
        return Statement("closed", f"{says}; {nearest!r} is unstable at {eps!r}", Judged.TOO_FINE)
    place, uncertainty = came
    wrong = abs(place - one.centre) <= uncertainty + 1e-6 * one.centre
    return Statement(
        "closed",
        f"{says}; {nearest!r} is unstable at {eps!r}, from {place:.8g} ± {uncertainty:.2g}",
        Judged.WRONG if wrong else Judged.TRUE,
    )
