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
from typing import Any, NamedTuple

import numpy as np
from llvmlite.binding import get_host_cpu_name
from threadpoolctl import threadpool_info

from benchmarks.peers import PEERS, Peer, Solve, mixed_equations, modal_equations, rk4
from benchmarks.stages import Stages, chart_multipliers, stages
from floquet import StabilityChart, monodromy, stability_chart
from periodic.checks import ComplexArray, FloatArray
from plate import EdgeLoad, MovingPlate

# The error that every peer must meet, at the least cost that does.
ACCURACY = 1e-8
# What is held to it: log|mu| of the largest multiplier, which a verdict needs, or every multiplier, which an estimate
# of its error needs and which the chart computes.
CRITERIA = ("largest", "all")
# A point is used if the reference is surer than this; next to a boundary no method reaches ACCURACY.
REFERENCE_ERROR = 1e-10
TERMS = {12: (3, 4), 28: (4, 7), 60: (6, 10)}
DAMPING = 1e-3
# Without zeros heyoka takes seconds a point for more coordinates than this.
MOST_MIXED = 28


@dataclass(frozen=True)
class Plan:
    """What to measure: grid, sizes n, and how often.

    Peers are set up so that they meet `ACCURACY` at ``points`` points of the grid, and timed at the first ``timed`` in
    each round.
    """

    columns: int = 256
    rows: int = 128
    sizes: tuple[int, ...] = (12, 28, 60)
    rounds: tuple[int, ...] = (5, 5, 3)
    points: int = 12
    timed: int = 3


QUICK = Plan(columns=64, rows=64, sizes=(12, 28), rounds=(2, 1), points=4, timed=2)


@dataclass(frozen=True)
class Timing:
    """CPU seconds per point of a method in each round, its largest error, and its setting.

    ``criterion`` says what the error is of, see `CRITERIA`; ``skipped`` gives the reason where there are no figures.
    """

    method: str
    criterion: str
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
    """One plate: the chart, which has one cost and two errors, then every peer under both criteria."""

    size: int
    damping: float
    chart: tuple[Timing, ...]
    peers: tuple[Timing, ...]


class Sample(NamedTuple):
    """A point of the grid, and its multipliers by `monodromy`."""

    Omega: float
    eps: float
    mu: ComplexArray


def plate(size: int, damping: float) -> MovingPlate:
    """Return the plate of ``size`` coordinates: partly loaded edges, static in-plane stress."""
    axial, lateral = TERMS[size]
    return MovingPlate(
        load=EdgeLoad.partial(0.5), inplane="static", axial_terms=axial, lateral_terms=lateral, damping=damping
    )


def conditions() -> str:
    """Return in one line what was measured on, and how busy it was with other work."""
    libraries = {f"{found['internal_api']} {found.get('architecture', '')}".strip() for found in threadpool_info()}
    load = f"{os.getloadavg()[0]:.1f}" if hasattr(os, "getloadavg") else "unknown"
    return f"{get_host_cpu_name()}, {os.cpu_count()} cores, load {load}, {', '.join(sorted(libraries))}."


def compare_methods(plan: Plan, peers: Sequence[Peer] = PEERS) -> Iterator[Comparison]:
    """Yield the figures of each plate, elastic and damped."""
    for size, rounds in zip(plan.sizes, plan.rounds, strict=True):
        for damping in (0.0, DAMPING):
            yield _compared(plan, size, damping, rounds, peers)


def _compared(plan: Plan, size: int, damping: float, rounds: int, peers: Sequence[Peer]) -> Comparison:
    family = plate(size, damping)
    Omega, eps = grids(plan.columns, plan.rows)
    chart(family, Omega[:2], eps[-32:])  # compiles
    samples = sample_points(family, Omega, eps, plan.points)
    ready: dict[tuple[str, str], tuple[Solve, float, float]] = {}
    reasons: dict[tuple[str, str], str] = {}
    for peer in peers:
        for criterion in CRITERIA:
            reason = peer.missing or (f"n > {MOST_MIXED}" if peer.mixed and size > MOST_MIXED else "")
            found = None if reason else cheapest(peer, family, samples, criterion)
            if found is None:
                reasons[peer.name, criterion] = reason or f"no setting reached {ACCURACY:g}"
            else:
                ready[peer.name, criterion] = found

    seconds: dict[tuple[str, str], list[float]] = {key: [] for key in ready}
    ours = []
    for _ in range(rounds):  # interleaved: what else the machine does meets all methods alike
        ours.append(cpu_time(chart, family, Omega, eps)[0] / (Omega.size * eps.size))
        for key, (solve, _, _) in ready.items():
            spent = sum(cpu_time(multipliers, solve, w, e)[0] for w, e, _ in samples[: plan.timed])
            seconds[key].append(spent / plan.timed)
    spectra = [chart_multipliers(family, w, eps)[eps.tolist().index(e)] for w, e, _ in samples]
    errors = (
        max(error(mu, sample.mu, criterion) for mu, sample in zip(spectra, samples, strict=True))
        for criterion in CRITERIA
    )
    timings = tuple(
        Timing(*key, skipped=reasons[key])
        if key in reasons
        else Timing(*key, tuple(seconds[key]), ready[key][2], ready[key][1])
        for key in ((peer.name, criterion) for peer in peers for criterion in CRITERIA)
    )
    charts = tuple(
        Timing("stability_chart", criterion, tuple(ours), largest)
        for criterion, largest in zip(CRITERIA, errors, strict=True)
    )
    return Comparison(size, damping, charts, timings)


def grids(columns: int, rows: int) -> tuple[FloatArray, FloatArray]:
    return np.linspace(20.0, 80.0, columns), np.linspace(0.0, 1.0, rows)


def sample_points(family: MovingPlate, Omega: FloatArray, eps: FloatArray, count: int) -> list[Sample]:
    """Return grid points at random in equal strata of Omega with their multipliers, surer than needed."""
    random = np.random.default_rng(4)
    points: list[Sample] = []
    for stratum in np.array_split(Omega, count):
        while True:
            w, e = float(random.choice(stratum)), float(random.choice(eps[1:]))
            found = monodromy(family, w, e)
            if found.log_modulus_error < REFERENCE_ERROR:
                points.append(Sample(w, e, found.multipliers))
                break
    order = random.permutation(count)
    return [points[i] for i in order]


def cheapest(
    peer: Peer, family: MovingPlate, samples: Sequence[Sample], criterion: str
) -> tuple[Solve, float, float] | None:
    """Return the peer with the first setting that meets `ACCURACY` at all points, that setting and its error."""
    equations = modal_equations(family.at(samples[0].Omega))
    if peer.mixed:
        equations = mixed_equations(equations)
    for setting in peer.settings:
        solve = peer.prepare(equations, setting)
        largest = 0.0
        for w, e, exact in samples:
            with np.errstate(all="ignore"):  # it may overflow at a loose setting
                largest = max(largest, error(multipliers(solve, w, e), exact, criterion))
            if largest > ACCURACY:
                break
        else:
            return solve, setting, largest
    return None


def multipliers(solve: Solve, Omega: float, eps: float) -> ComplexArray:
    """Return the multipliers as ``solve`` finds them, NaN where it overflowed."""
    matrix = solve(Omega, eps)
    if not np.isfinite(matrix).all():
        return np.full(1, np.nan, np.complex128)
    return np.linalg.eigvals(matrix).astype(np.complex128)


def error(mu: ComplexArray, exact: ComplexArray, criterion: str) -> float:
    """Return the error of log|mu| of the largest multiplier, or the largest distance of any from its place, in units
    of the largest; infinite where there are none."""
    if not np.isfinite(mu).all():
        return np.inf
    if criterion == "largest":
        return float(abs(np.log(np.abs(mu).max() / np.abs(exact).max())))
    distances = np.abs(mu[:, None] - exact) / np.abs(exact).max()
    return float(max(distances.min(axis=0).max(), distances.min(axis=1).max()))


def chart(family: MovingPlate, Omega: FloatArray, eps: FloatArray, jobs: int = 1) -> StabilityChart:
    return stability_chart(family, Omega, eps, n_jobs=jobs, audit=0, progress=False)


def cpu_time(function: Callable[..., Any], *arguments: Any) -> tuple[float, Any]:
    """Return the CPU seconds of this process, less disturbed by others than the clock on the wall, and the result."""
    start = time.process_time()
    result = function(*arguments)
    return time.process_time() - start, result


def all_stages(plan: Plan) -> dict[tuple[int, float], Stages]:
    """Return where the time of each chart goes."""
    Omega, eps = grids(plan.columns, plan.rows)
    return {(n, damping): stages(plate(n, damping), Omega, eps) for n in plan.sizes for damping in (0.0, DAMPING)}


def scaling(plan: Plan) -> list[tuple[str, float, float]]:
    """Return (what, CPU microseconds per point, wall seconds) of damped charts of 28 coordinates: grids, then jobs.

    Medians of interleaved rounds.
    """
    family = plate(28, DAMPING)
    shapes = [(plan.columns // k, plan.rows // k, 1) for k in (4, 2, 1)] + [(plan.columns, plan.rows, 2)]
    figures: list[list[tuple[float, float]]] = [[] for _ in shapes]
    for _ in range(plan.rounds[-1]):
        for (columns, lines, jobs), found in zip(shapes, figures, strict=True):
            wall = time.perf_counter()
            spent, _ = cpu_time(chart, family, *grids(columns, lines), jobs)
            found.append((1e6 * spent / (columns * lines), time.perf_counter() - wall))
    rows = []
    for (columns, lines, jobs), found in zip(shapes, figures, strict=True):
        cpu, wall = (float(median) for median in np.median(found, axis=0))
        rows.append((f"{columns} x {lines}, {jobs} job{'s' * (jobs > 1)}", cpu, wall))
    return rows


IMPORT = "import floquet, plate, perturb"
CHART = """
from benchmarks.benchmark import grids, plate
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


# A chart costs per point as much as this many steps of `peers.rk4` at the same size, elastic and damped: about twice
# what one run measured (1.0, 1.0, 0.8, 0.9), which is more than the scatter on a shared machine.
LIMITS = {(12, 0.0): 2.0, (12, DAMPING): 2.1, (28, 0.0): 1.7, (28, DAMPING): 1.8}
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
        "| n | damping | method | error of | CPU µs per point | spread | times the chart | error | setting |",
        "|--:|--:|:--|:--|--:|--:|--:|--:|--:|",
    ]
    for found in comparisons:
        for timing in (*found.chart, *found.peers):
            start = f"| {found.size} | {found.damping:g} | {timing.method} | {timing.criterion} |"
            if timing.skipped:
                lines.append(f"{start} skipped: {timing.skipped} | | | | |")
                continue
            ratio = timing.median / found.chart[0].median
            setting = "" if np.isnan(timing.setting) else f"{timing.setting:g}"
            lines.append(
                f"{start} {1e6 * timing.median:,.1f} | {timing.spread:.0%} | {ratio:,.0f} | {timing.error:.0e} "
                f"| {setting} |"
            )
    return "\n".join(lines)


def scaling_table(rows: Sequence[tuple[str, float, float]]) -> str:
    lines = ["| n = 28, damped | CPU µs per point | wall s |", "|:--|--:|--:|"]
    lines += [f"| {what} | {cpu:.1f} | {wall:.2f} |" for what, cpu, wall in rows]
    return "\n".join([*lines, f"\nParallel efficiency on two cores: {rows[-2][2] / (2 * rows[-1][2]):.2f}."])


def start_up_table(rows: Sequence[tuple[str, float, float, float]]) -> str:
    lines = ["| in a new process | wall s | CPU s | peak MB |", "|:--|--:|--:|--:|"]
    return "\n".join(lines + [f"| {what} | {wall:.1f} | {cpu:.1f} | {mb:.0f} |" for what, wall, cpu, mb in rows])
