"""What `trace_regions` says of a window."""

from __future__ import annotations

import numpy as np

from floquet import Region, trace_regions
from periodic import PeriodicSystem
from tests.hunt.statements.magnus import Flows
from tests.hunt.statements.origin import origin
from tests.hunt.statements.parts import frequencies, parts_of
from tests.hunt.statements.statement import Judged, Statement
from tests.hunt.statements.traces import relative_strength

TOLERANCE = 3e-3
# Points of a window outside all regions, and inside one, that are looked at.
OUTSIDE, WITHIN = 60, 40
# Points nearer than this many tolerances to an outline are left alone.
CLEAR = 2.0
FOLLOWED = 3


def ask(random: np.random.Generator, system: PeriodicSystem) -> tuple[str, list[Statement]]:
    """Ask for the regions of a random window."""
    parts = parts_of(system)
    omega = frequencies(parts)
    if not omega.size:
        return "nothing oscillates", []
    middle = 2 * omega[random.integers(min(3, len(omega)))]
    low = float(middle * random.uniform(0.4, 0.95))
    high = float(low + middle * random.uniform(0.1, 0.6))
    top = float(10 ** random.uniform(-1, -0.3)) / relative_strength(parts)
    bottom = 0.0 if random.integers(3) else 0.3 * top
    asked = f"trace_regions(system, ({low!r}, {high!r}), ({bottom!r}, {top!r}), tolerance={TOLERANCE})"
    found = trace_regions(system, (low, high), (bottom, top), tolerance=TOLERANCE, n_jobs=1, progress=False)
    flows = Flows(parts)
    statements = [_outside(random, flows, found, (low, high), (bottom, top))]
    for region in found:
        statements += _region(random, flows, region, (high - low, top - bottom))
    return asked, statements


def _outside(random: np.random.Generator, flows: Flows, regions: list[Region], Omega: tuple, eps: tuple) -> Statement:
    """Points outside all regions are stable."""
    x, y = random.uniform(*Omega, OUTSIDE), random.uniform(*eps, OUTSIDE)
    size = Omega[1] - Omega[0], eps[1] - eps[0]
    free = ~np.any([_around(region, x, y, size).any(axis=0) for region in regions], axis=0) if regions else x > 0
    x, y = x[free], y[free]
    state = flows.state(x, y) if x.size else np.zeros(0)
    bad = [(float(a), float(b)) for a, b in zip(x[state == 1], y[state == 1], strict=True)]
    return Statement("outside", f"stable outside all regions, but not at {bad}", Judged.WRONG if bad else Judged.TRUE)


def _around(region: Region, x: np.ndarray, y: np.ndarray, size: tuple[float, float]) -> np.ndarray:
    """Whether points round each point lie in a region, (9, points)."""
    step = CLEAR * TOLERANCE
    shifts = [(a, b) for a in (-1, 0, 1) for b in (-1, 0, 1)]
    return np.array(
        [region.contains(x + a * step * size[0], np.maximum(y + b * step * size[1], 0.0)) for a, b in shifts]
    )


def _region(random: np.random.Generator, flows: Flows, region: Region, size: tuple[float, float]) -> list[Statement]:
    name = f"region {region.label!r} from {region.tip}"
    state = int(flows.state(*region.witness)[0])
    judged = {1: Judged.TRUE, -1: Judged.WRONG, 0: Judged.TOO_FINE}[state]
    found = [Statement("witness", f"{name} is unstable at {region.witness}", judged)]
    outer = region.outlines[0]
    x = random.uniform(outer.Omega.min(), outer.Omega.max(), WITHIN)
    y = random.uniform(outer.eps.min(), outer.eps.max(), WITHIN)
    deep = _around(region, x, y, size).all(axis=0)
    if deep.any():
        x, y = x[deep], y[deep]
        stable = flows.state(x, y) == -1
        bad = [(float(a), float(b)) for a, b in zip(x[stable], y[stable], strict=True)]
        found.append(Statement("within", f"{name} is unstable, but not at {bad}", Judged.WRONG if bad else Judged.TRUE))
    if region.resonances and int(random.integers(FOLLOWED)) == 0 and state == 1:
        Omega, eps = region.witness
        came = origin(flows, Omega, eps, 0.3 * size[0], region.resonances[0].j, region.resonances[0].centre)
        sentence = f"{name} starts from {[one.centre for one in region.resonances]}"
        if came is None:
            found.append(Statement("name", sentence, Judged.TOO_FINE))
        else:
            place, uncertainty = came
            right = any(
                abs(place - one.centre) <= 2 * uncertainty + 5 * TOLERANCE * size[0] for one in region.resonances
            )
            sentence = f"{sentence}; from {region.witness} it comes down to {place:.6g} ± {uncertainty:.2g}"
            found.append(Statement("name", sentence, Judged.TRUE if right else Judged.WRONG))
    return found
