"""What a chart costs on larger grids, with two workers, and in a process of its own."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import time

import numpy as np

from benchmarks.methods import Plan
from benchmarks.stages import Stages, stages
from benchmarks.subjects import BENCHMARK_DAMPING, chart, cpu_time, grids, plate

IMPORT_CODE = "import floquet, plate, perturb"
CHART_CODE = """
from benchmarks import grids, plate
from floquet import stability_chart
stability_chart(plate({size}, {damping}), *grids({columns}, {rows}), n_jobs=1, audit=0, progress=False)
"""
# What a child process reports about itself: seconds by the clock and of the processor, and its peak of megabytes.
# VmHWM, because ru_maxrss begins with the memory of the parent.
REPORT_CODE = """
import json, pathlib, time
wall, cpu = time.perf_counter(), time.process_time()
{code}
wall, cpu = time.perf_counter() - wall, time.process_time() - cpu
status = pathlib.Path("/proc/self/status")
peak = [int(line.split()[1]) for line in status.read_text().splitlines() if "VmHWM" in line] if status.exists() else []
print(json.dumps([wall, cpu, peak[0] / 1024 if peak else float("nan")]))
"""


def all_stages(plan: Plan) -> dict[tuple[int, float], Stages]:
    """Return where the time of each chart goes."""
    Omega, eps = grids(plan.columns, plan.rows)
    return {
        (n, damping): stages(plate(n, damping), Omega, eps) for n in plan.sizes for damping in (0.0, BENCHMARK_DAMPING)
    }


def scaling(plan: Plan) -> list[tuple[str, float, float]]:
    """Return (what, CPU microseconds per point, wall seconds) of damped charts of 28 coordinates: grids, then jobs.

    Medians of interleaved rounds.
    """
    family = plate(28, BENCHMARK_DAMPING)
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


def fresh_process(code: str, *, cold: bool = False) -> tuple[float, float, float]:
    """Return wall seconds, CPU seconds and peak megabytes of ``code`` in a new process.

    ``cold``: with an empty Numba cache, as after an installation.
    """
    with tempfile.TemporaryDirectory() as folder:
        environment = os.environ | ({"NUMBA_CACHE_DIR": folder} if cold else {})
        found = subprocess.run(
            [sys.executable, "-c", REPORT_CODE.format(code=code)],
            env=environment,
            capture_output=True,
            text=True,
            check=True,
        )
    wall, cpu, memory = json.loads(found.stdout)
    return wall, cpu, memory


def start_up(plan: Plan) -> list[tuple[str, float, float, float]]:
    """Return (what, wall seconds, CPU seconds, peak megabytes), each in a process of its own."""
    first = CHART_CODE.format(size=12, damping=BENCHMARK_DAMPING, columns=16, rows=16)
    whole = CHART_CODE.format(size=plan.sizes[-1], damping=BENCHMARK_DAMPING, columns=plan.columns, rows=plan.rows)
    return [
        ("import", *fresh_process(IMPORT_CODE)),
        ("first chart, nothing compiled", *fresh_process(first, cold=True)),
        ("first chart, compiled before", *fresh_process(first)),
        (f"chart {plan.columns} x {plan.rows}, n = {plan.sizes[-1]}", *fresh_process(whole)),
    ]
