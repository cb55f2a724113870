"""What a chart and a certificate say of points."""

from __future__ import annotations

import numpy as np

from floquet import Kind, stability_chart
from periodic import PeriodicSystem
from tests.hunt.statements.magnus import Flows, Multipliers
from tests.hunt.statements.parts import frequencies, parts_of
from tests.hunt.statements.statement import Judged, Statement
from tests.hunt.statements.traces import relative_strength

COLUMNS, ROWS = 8, 6
# Error of the other integrator's growth where it is not known better.
GROWTH_ERROR = 1e-9


def _window(random: np.random.Generator, parts: list) -> tuple[float, float, float] | None:
    omega = frequencies(parts)
    if not omega.size:
        return None
    middle = 2 * float(omega[random.integers(min(3, len(omega)))])
    return middle * 0.47, middle * 1.3, float(10 ** random.uniform(-1, 0)) / relative_strength(parts)


def ask_chart(random: np.random.Generator, system: PeriodicSystem) -> tuple[str, list[Statement]]:
    """Ask for a small chart."""
    parts = parts_of(system)
    window = _window(random, parts)
    if window is None:
        return "nothing oscillates", []
    Omega, eps = np.linspace(*window[:2], COLUMNS), np.linspace(0, window[2], ROWS)
    grids = f"linspace({window[0]!r}, {window[1]!r}, {COLUMNS}), linspace(0, {window[2]!r}, {ROWS})"
    asked = f"stability_chart(system, {grids})"
    chart = stability_chart(system, Omega, eps, n_jobs=1, progress=False, audit=0)
    flows, found = Flows(parts), []
    for c, w in enumerate(Omega.tolist()):
        mine = flows.dominant(np.full(ROWS, w), eps)
        found.append(_column(chart.kind[:, c], chart.growth_rate[:, c] * 2 * np.pi / w, chart.error[:, c], mine, w))
    return asked, found


def _column(kind: np.ndarray, growth: np.ndarray, error: np.ndarray, mine: Multipliers, Omega: float) -> Statement:
    said = np.where(kind > Kind.STABLE, 1, np.where(kind == Kind.STABLE, -1, 0))
    against = (said * mine.state == -1).any()
    off = (np.abs(growth - mine.growth) > error + mine.error + GROWTH_ERROR) & (mine.state == 1)
    sentence = f"column at Omega = {Omega!r}: kinds {kind.tolist()}, log|mu| {growth.tolist()} ± {error.max():.1g}"
    if against or off.any():
        return Statement("column", f"{sentence}; right {mine.growth.tolist()}", Judged.WRONG)
    if (said == 0).any():
        return Statement("column", sentence, Judged.WITHHELD)
    return Statement("column", sentence, Judged.TRUE if (mine.state != 0).all() else Judged.TOO_FINE)


def ask_certificate(random: np.random.Generator, system: PeriodicSystem) -> tuple[str, list[Statement]]:
    """Ask for a proof at a random point."""
    from floquet.certified import ProvedVerdict, certified_growth

    parts = parts_of(system)
    window = _window(random, parts)
    if window is None:
        return "nothing oscillates", []
    Omega, eps = float(random.uniform(*window[:2])), float(random.uniform(0, window[2]))
    asked = f"certified_growth(system, {Omega!r}, {eps!r})"
    proof = certified_growth(system, Omega, eps, max_bits=256, progress=False)
    mine = Flows(parts).dominant(Omega, eps)
    growth, error = float(mine.growth[0]) * Omega / (2 * np.pi), float(mine.error[0]) + GROWTH_ERROR
    state = int(mine.state[0])
    said = {ProvedVerdict.UNSTABLE: 1, ProvedVerdict.STABLE: -1, ProvedVerdict.UNDECIDED: 0}[proof.verdict]
    sentence = f"{proof.verdict} with growth in [{proof.lower!r}, {proof.upper!r}] at {Omega!r}, {eps!r}; {growth!r}"
    if said == 1 and state == -1 and proof.upper <= error:
        return asked, [Statement("certificate", sentence, Judged.TOO_FINE)]  # true of these very numbers
    bounded = state != 1 or proof.lower - error <= growth <= proof.upper + error
    judged = Judged.WRONG if said * state == -1 or not bounded else Judged.TRUE
    return asked, [Statement("certificate", sentence, Judged.WITHHELD if said == 0 and bounded else judged)]
