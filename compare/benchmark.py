"""The time of a chart against what other methods need for the same numbers, as ratios measured in one process."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from compare.peers import PEERS, Peer, Solve, modal_equations, rk4
from floquet import StabilityChart, monodromy, stability_chart
from periodic.checks import FloatArray
from plate import EdgeLoad, MovingPlate

# The error of max log|mu| that every peer must meet, at the least cost that does.
ACCURACY = 1e-8
# A point is used if the reference is surer than this; next to a boundary no method reaches ACCURACY.
REFERENCE_ERROR = 1e-10
TERMS = {12: (3, 4), 28: (4, 7), 60: (6, 10)}
DAMPING = 1e-3
COLUMNS, ROWS = 256, 128
# A slice is every fourth column of the chart: it spans all frequencies, and what a chart does once counts four times.
STRIDE = 4


@dataclass(frozen=True)
class Plan:
    """What to measure: grid, sizes n, and how often; peers are timed at ``points`` points in each round."""

    columns: int = COLUMNS
    rows: int = ROWS
    sizes: tuple[int, ...] = (12, 28, 60)
    rounds: tuple[int, ...] = (5, 3, 1)
    points: int = 3


QUICK = Plan(columns=64, rows=64, sizes=(12, 28), rounds=(2, 1), points=2)


@dataclass(frozen=True)
class Timing:
    """CPU seconds per point of a method in each round, its largest error of log|mu|, and its setting.

    ``skipped`` gives the reason where there are no figures.
    """

    method: str
    seconds: tuple[float, ...] = ()
    error: float = np.nan
    setting: float = np.nan
    skipped: str = ""

    @property
    def median(self) -> float:
        return float(np.median(self.seconds))

    @property
    def spread(self) -> float:
        """(largest - smallest) / median over the rounds."""
        return (max(self.seconds) - min(self.seconds)) / self.median


@dataclass(frozen=True)
class Comparison:
    """One plate: the chart first, then every peer."""

    size: int
    damping: float
    chart: Timing
    peers: tuple[Timing, ...]


def plate(size: int, damping: float) -> MovingPlate:
    """Return the plate of ``size`` coordinates: partly loaded edges, static in-plane stress."""
    axial, lateral = TERMS[size]
    return MovingPlate(
        load=EdgeLoad.partial(0.5), inplane="static", axial_terms=axial, lateral_terms=lateral, damping=damping
    )


def compare_methods(plan: Plan, peers: Sequence[Peer] = PEERS) -> Iterator[Comparison]:
    """Yield the figures of each plate, elastic and damped."""
    for size, rounds in zip(plan.sizes, plan.rounds, strict=True):
        for damping in (0.0, DAMPING):
            yield _compared(plan, size, damping, rounds, peers)


def _compared(plan: Plan, size: int, damping: float, rounds: int, peers: Sequence[Peer]) -> Comparison:
    family = plate(size, damping)
    Omega, eps = grids(plan.columns, plan.rows)
    chart(family, Omega[: 2 * STRIDE], eps[-8:])  # compiles
    points = sample_points(family, Omega[::STRIDE], eps, plan.points)
    ready: dict[str, tuple[Solve, float, float]] = {}
    reasons: dict[str, str] = {peer.name: peer.missing for peer in peers if peer.missing}
    for peer in peers:
        if peer.name not in reasons:
            found = cheapest(peer, family, points)
            if found is None:
                reasons[peer.name] = f"no setting reached {ACCURACY:g}"
            else:
                ready[peer.name] = found

    seconds: dict[str, list[float]] = {name: [] for name in ready}
    ours, error = [], 0.0
    for _ in range(rounds):  # interleaved: what else the machine does meets all methods alike
        spent, made = cpu_time(chart, family, Omega[::STRIDE], eps)
        ours.append(spent / made.kind.size)
        error = max(error, *(abs(log_modulus(made, w, e) - known) for w, e, known in points))
        for name, (solve, _, _) in ready.items():
            spent = sum(cpu_time(peer_value, solve, w, e)[0] for w, e, _ in points)
            seconds[name].append(spent / len(points))
    timings = tuple(
        Timing(peer.name, skipped=reasons[peer.name])
        if peer.name in reasons
        else Timing(peer.name, tuple(seconds[peer.name]), ready[peer.name][2], ready[peer.name][1])
        for peer in peers
    )
    return Comparison(size, damping, Timing("stability_chart", tuple(ours), error), timings)


def grids(columns: int, rows: int) -> tuple[FloatArray, FloatArray]:
    return np.linspace(20.0, 80.0, columns), np.linspace(0.0, 1.0, rows)


def sample_points(family: MovingPlate, Omega: FloatArray, eps: FloatArray, count: int) -> list[tuple[float, ...]]:
    """Return (Omega, eps, log|mu|) of grid points in equal strata of Omega, by `monodromy`, surer than needed."""
    random = np.random.default_rng(4)
    points: list[tuple[float, ...]] = []
    for stratum in np.array_split(Omega, count):
        while True:
            w, e = float(random.choice(stratum)), float(random.choice(eps[1:]))
            found = monodromy(family, w, e)
            if found.log_modulus_error < REFERENCE_ERROR:
                points.append((w, e, found.growth_rate * 2 * np.pi / w))
                break
    return points


def cheapest(peer: Peer, family: MovingPlate, points: Sequence[tuple[float, ...]]) -> tuple[Solve, float, float] | None:
    """Return the peer with the first setting that meets `ACCURACY` at all points, that setting and its error."""
    equations = modal_equations(family.at(points[0][0]))
    for setting in peer.settings:
        solve = peer.prepare(equations, setting)
        error = 0.0
        for w, e, known in points:
            with np.errstate(all="ignore"):  # it may overflow at a loose setting
                error = max(error, abs(peer_value(solve, w, e) - known))
            if error > ACCURACY:
                break
        else:
            return solve, setting, error
    return None


def peer_value(solve: Solve, Omega: float, eps: float) -> float:
    """Return max log|mu| as ``solve`` finds it, infinite where it overflowed."""
    matrix = solve(Omega, eps)
    return float(np.log(np.abs(np.linalg.eigvals(matrix)).max())) if np.isfinite(matrix).all() else np.inf


def chart(family: MovingPlate, Omega: FloatArray, eps: FloatArray, jobs: int = 1) -> StabilityChart:
    return stability_chart(family, Omega, eps, n_jobs=jobs, audit=0, progress=False)


def log_modulus(made: StabilityChart, Omega: float, eps: float) -> float:
    i, j = np.searchsorted(made.eps, eps), np.searchsorted(made.Omega, Omega)
    return float(made.growth_rate[i, j] * 2 * np.pi / Omega)


def cpu_time(function: Callable[..., Any], *arguments: Any) -> tuple[float, Any]:
    """Return the CPU seconds of this process, less disturbed by others than the clock on the wall, and the result."""
    start = time.process_time()
    result = function(*arguments)
    return time.process_time() - start, result


def scaling(plan: Plan) -> list[tuple[str, float, float]]:
    """Return (what, CPU microseconds per point, wall seconds) of damped charts of 28 coordinates: grids, then jobs."""
    family = plate(28, DAMPING)
    shapes = [(plan.columns // k, plan.rows // k, 1) for k in (4, 2, 1)] + [(plan.columns, plan.rows, 2)]
    rows = []
    for columns, lines, jobs in shapes:
        Omega, eps = grids(columns, lines)
        wall = time.perf_counter()
        spent, _ = cpu_time(chart, family, Omega, eps, jobs)
        wall = time.perf_counter() - wall
        rows.append((f"{columns} x {lines}, {jobs} job{'s' * (jobs > 1)}", 1e6 * spent / (columns * lines), wall))
    return rows


IMPORT = "import floquet, plate, perturb"
CHART = """
from compare.benchmark import grids, plate
from floquet import stability_chart
stability_chart(plate({size}, {damping}), *grids({columns}, {rows}), n_jobs=1, audit=0, progress=False)
"""
# What a child process reports about itself. VmHWM, because ru_maxrss begins with the memory of the parent.
REPORT = """
import json, pathlib, time
wall, cpu = time.perf_counter(), time.process_time()
{code}
wall, cpu = time.perf_counter() - wall, time.process_time() - cpu
status = pathlib.Path("/proc/self/status")
peak = [int(line.split()[1]) for line in status.read_text().splitlines() if "VmHWM" in line] if status.exists() else []
print(json.dumps([wall, cpu, peak[0] / 1024 if peak else float("nan")]))
"""


def fresh_process(code: str, *, cold: bool = False) -> tuple[float, float, float]:
    """Return wall seconds, CPU seconds and peak megabytes of ``code`` in a new process.

    ``cold``: with an empty Numba cache, as after an installation.
    """
    with tempfile.TemporaryDirectory() as folder:
        environment = os.environ | ({"NUMBA_CACHE_DIR": folder} if cold else {})
        found = subprocess.run(
            [sys.executable, "-c", REPORT.format(code=code)],
            env=environment,
            capture_output=True,
            text=True,
            check=True,
        )
    wall, cpu, memory = json.loads(found.stdout)
    return wall, cpu, memory


def start_up(plan: Plan) -> list[tuple[str, float, float, float]]:
    """Return (what, wall seconds, CPU seconds, peak megabytes), each in a process of its own."""
    first = CHART.format(size=12, damping=DAMPING, columns=16, rows=16)
    whole = CHART.format(size=plan.sizes[-1], damping=DAMPING, columns=plan.columns, rows=plan.rows)
    return [
        ("import", *fresh_process(IMPORT)),
        ("first chart, nothing compiled", *fresh_process(first, cold=True)),
        ("first chart, compiled before", *fresh_process(first)),
        (f"chart {plan.columns} x {plan.rows}, n = {plan.sizes[-1]}", *fresh_process(whole)),
    ]


# A chart costs per point as much as this many steps of `compare.peers.rk4` at the same size, elastic and damped: about
# twice what one run measured (2.7, 3.1, 1.7, 1.8), which is more than the scatter on a shared machine.
LIMITS = {(12, 0.0): 6.0, (12, DAMPING): 6.0, (28, 0.0): 3.5, (28, DAMPING): 3.5}
REFERENCE_STEPS = 2000


def regression(rounds: int = 5, columns: int = 64, rows: int = 64) -> dict[tuple[int, float], float]:
    """Return for each plate of `LIMITS` the CPU time of the chart per point in steps of `rk4`: median of the rounds."""
    ratios = {}
    for size, damping in LIMITS:
        family = plate(size, damping)
        equations = modal_equations(family.at(30.0))
        Omega, eps = grids(columns, rows)

        chart(family, Omega, eps)  # compiles, as the next line does
        rk4(*equations, 30.0, 0.5, 1)
        found = [
            cpu_time(chart, family, Omega, eps)[0] / Omega.size / eps.size / reference
            for reference in (
                cpu_time(rk4, *equations, 30.0, 0.5, REFERENCE_STEPS)[0] / REFERENCE_STEPS for _ in range(rounds)
            )
        ]
        ratios[size, damping] = float(np.median(found))
    return ratios


def comparison_table(comparisons: Sequence[Comparison]) -> str:
    """Return the figures as a Markdown table."""
    lines = [
        "| n | damping | method | CPU µs per point | spread | times the chart | error of log\\|mu\\| | setting |",
        "|--:|--:|:--|--:|--:|--:|--:|--:|",
    ]
    for found in comparisons:
        for timing in (found.chart, *found.peers):
            start = f"| {found.size} | {found.damping:g} | {timing.method} |"
            if timing.skipped:
                lines.append(f"{start} skipped: {timing.skipped} | | | | |")
                continue
            ratio = timing.median / found.chart.median
            setting = "" if np.isnan(timing.setting) else f"{timing.setting:g}"
            lines.append(
                f"{start} {1e6 * timing.median:,.1f} | {timing.spread:.0%} | {ratio:,.0f} | {timing.error:.0e} "
                f"| {setting} |"
            )
    return "\n".join(lines)


def scaling_table(rows: Sequence[tuple[str, float, float]]) -> str:
    lines = ["| n = 28, damped | CPU µs per point | wall s |", "|:--|--:|--:|"]
    return "\n".join(lines + [f"| {what} | {cpu:.1f} | {wall:.2f} |" for what, cpu, wall in rows])


def start_up_table(rows: Sequence[tuple[str, float, float, float]]) -> str:
    lines = ["| in a new process | wall s | CPU s | peak MB |", "|:--|--:|--:|--:|"]
    return "\n".join(lines + [f"| {what} | {wall:.1f} | {cpu:.1f} | {mb:.0f} |" for what, wall, cpu, mb in rows])
