#!/usr/bin/env python3
"""Time charts against other integrators, as ratios per core, each at its cheapest setting that is as accurate.

Times are of the processor, not of the clock, in one thread; repetitions of all contestants are interleaved.
"""

from __future__ import annotations

import argparse
import statistics
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from threadpoolctl import threadpool_limits

from floquet import monodromy, stability_chart
from floquet_scripts.peers import PEERS, Point, Settings
from plate import EdgeLoad, MovingPlate

ACCURACY = 1e-8  # of log|mu|, verified against `monodromy` in every run
TERMS = {12: (3, 4), 28: (4, 7), 60: (6, 10)}
LARGEST = {"heyoka, batch of 8": 28, "CyRK DOP853": 28}  # left out beyond, to keep a run short
# Ratios against SciPy's DOP853 that a change must not fall below: about half of what a busy machine measured.
LEAST_RATIO = {(12, 0.0): 70.0, (12, 0.001): 55.0, (28, 0.0): 140.0, (28, 0.001): 95.0}
OMEGA, EPS = (20.0, 80.0), (0.0, 1.0)


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sizes", type=int, nargs="+", choices=TERMS, default=[12, 28], help="coordinates (12 28)")
    parser.add_argument("--repeats", type=int, default=5, help="interleaved repetitions (5)")
    parser.add_argument("--points", type=int, default=6, help="points at which the peers are timed (6)")
    parser.add_argument("--grid", type=int, nargs=2, default=(128, 128), help="frequencies and amplitudes (128 128)")
    parser.add_argument("--output", type=Path, help="write the table to this file too")
    options = parser.parse_args(arguments)
    lines = [
        "| n | damping | method | setting | per point | spread | error | ratio |",
        "|---|---|---|---|---|---|---|---|",
    ]
    failed = []
    for n in options.sizes:
        for damping in (0.0, 0.001):
            rows, ratio = _compare(n, damping, options)
            lines += rows
            print("\n".join(rows), flush=True)
            if ratio < LEAST_RATIO.get((n, damping), 0.0):
                failed.append(f"n = {n}, damping {damping}: ratio {ratio:.0f}")
    if options.output is not None:
        options.output.write_text("\n".join(lines) + "\n", encoding="utf-8")
    for line in failed:
        print(f"benchmark: slower than it was: {line}", file=sys.stderr)
    return 1 if failed else 0


def _compare(n: int, damping: float, options: argparse.Namespace) -> tuple[list[str], float]:
    """Return rows of the table for one plate, and our ratio to SciPy's DOP853."""
    axial, lateral = TERMS[n]
    load = EdgeLoad.partial(0.5)
    plate = MovingPlate(load=load, inplane="static", damping=damping, axial_terms=axial, lateral_terms=lateral)
    system = plate.at(OMEGA[0])
    Omega, eps = np.linspace(*OMEGA, options.grid[0]), np.linspace(*EPS, options.grid[1])
    # one frequency from each part of the range, so that the mean over the points is that over the chart
    rng = np.random.default_rng(0)
    columns = ((np.arange(options.points) + 0.5) / options.points * len(Omega)).astype(int)
    rows = rng.integers(len(eps), size=options.points)
    points = [(float(Omega[j]), float(eps[i])) for i, j in zip(rows, columns, strict=True)]
    exact = [monodromy(system, *point).growth_rate * 2 * np.pi / point[0] for point in points]

    def chart() -> np.ndarray:
        found = stability_chart(plate, Omega, eps, n_jobs=1, progress=False, audit=0)
        return found.growth_rate[rows, columns] * 2 * np.pi / Omega[columns]

    with threadpool_limits(limits=1, user_api="blas"):
        error = float(np.abs(chart() - exact).max())
        contestants: dict[str, tuple[str, float, Callable[[], object], int]] = {
            "this chart": ("", error, chart, Omega.size * eps.size)
        }
        for name, peer in PEERS.items():
            if n > LARGEST.get(name, n):
                continue
            try:
                setting, integrate, error = _cheapest(peer(system), points, exact)
            except ImportError:
                print(f"benchmark: {name} is not installed; pip install '.[bench]'", file=sys.stderr)
                continue
            contestants[name] = (setting, error, _all_points(integrate, points), len(points))
        times: dict[str, list[float]] = {name: [] for name in contestants}
        for _ in range(options.repeats):
            for name, (_, _, run, count) in contestants.items():
                begin = time.process_time()
                run()
                times[name].append((time.process_time() - begin) / count)
    ours = statistics.median(times["this chart"])
    table = []
    for name, (setting, error, _, _) in contestants.items():
        median = statistics.median(times[name])
        spread = (max(times[name]) - min(times[name])) / median
        cells = (
            n,
            damping,
            name,
            setting,
            f"{median * 1e3:.4g} ms",
            f"{spread:.0%}",
            f"{error:.0e}",
            f"{median / ours:.0f}",
        )
        table.append("| " + " | ".join(map(str, cells)) + " |")
    return table, statistics.median(times["SciPy DOP853"]) / ours


def _cheapest(settings: Settings, points: list[tuple[float, float]], exact: list[float]) -> tuple[str, Point, float]:
    """Return the first setting whose largest error is small enough."""
    for setting, integrate in settings:
        with np.errstate(all="ignore"):
            try:
                error = max(abs(integrate(*point) - value) for point, value in zip(points, exact, strict=True))
            except np.linalg.LinAlgError:  # unstable with so few steps
                continue
        if error <= ACCURACY:
            return setting, integrate, error
    raise ValueError(f"no setting reaches an error of {ACCURACY}; add more accurate ones")


def _all_points(integrate: Point, points: list[tuple[float, float]]) -> Callable[[], object]:
    return lambda: [integrate(*point) for point in points]


if __name__ == "__main__":
    sys.exit(main())
