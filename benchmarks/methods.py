"""The time of a chart against what other methods need for the same numbers, measured in one process."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from benchmarks.peers import PEERS, Peer, Solve, mixed_equations, modal_equations
from benchmarks.stages import chart_multipliers
from benchmarks.subjects import BENCHMARK_DAMPING, chart, cpu_time, grids, plate
from floquet import monodromy
from periodic.checks import ComplexArray, FloatArray
from plate import MovingPlate

# Largest error of a peer, at the least cost that meets it.
REQUIRED_ERROR = 1e-8
# What the error is of. "largest": log|mu| of the largest multiplier, which is all that a verdict needs. "all": every
# multiplier, which the chart computes and needs for its estimate of the error.
ERROR_CRITERIA = ("largest", "all")
# Largest error of the reference in log|mu| at a point that is used; next to a boundary no method meets REQUIRED_ERROR.
MAX_REFERENCE_ERROR = 1e-10
# Coordinates beyond which heyoka, without zeros in its equations, takes seconds for a point.
MAX_MIXED_COORDINATES = 28


@dataclass(frozen=True)
class Plan:
    """What to measure: grid, sizes n, and how often.

    Peers are set up so that they meet `REQUIRED_ERROR` at ``points`` points of the grid. In each round they are timed
    at the first ``timed`` of these.
    """

    columns: int = 256
    rows: int = 128
    sizes: tuple[int, ...] = (12, 28, 60)
    rounds: tuple[int, ...] = (5, 5, 3)
    points: int = 12
    timed: int = 3


# A first look, in a minute or two.
QUICK_PLAN = Plan(columns=64, rows=64, sizes=(12, 28), rounds=(2, 1), points=4, timed=2)


@dataclass(frozen=True)
class Timing:
    """CPU seconds per point of a method in each round, its largest error, and its setting.

    ``criterion`` says what the error is of, see `ERROR_CRITERIA`. ``skipped`` gives the reason where there are no
    figures.
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


def compare_methods(plan: Plan, peers: Sequence[Peer] = PEERS) -> Iterator[Comparison]:
    """Yield the figures of each plate, elastic and damped."""
    for size, rounds in zip(plan.sizes, plan.rounds, strict=True):
        for damping in (0.0, BENCHMARK_DAMPING):
            yield _compared(plan, size, damping, rounds, peers)


def _compared(plan: Plan, size: int, damping: float, rounds: int, peers: Sequence[Peer]) -> Comparison:
    family = plate(size, damping)
    Omega, eps = grids(plan.columns, plan.rows)
    chart(family, Omega[:2], eps[-32:])  # compiles
    samples = sample_points(family, Omega, eps, plan.points)
    ready: dict[tuple[str, str], tuple[Solve, float, float]] = {}
    reasons: dict[tuple[str, str], str] = {}
    for peer in peers:
        for criterion in ERROR_CRITERIA:
            reason = peer.missing or (
                f"n > {MAX_MIXED_COORDINATES}" if peer.mixed and size > MAX_MIXED_COORDINATES else ""
            )
            found = None if reason else cheapest(peer, family, samples, criterion)
            if found is None:
                reasons[peer.name, criterion] = reason or f"no setting reached {REQUIRED_ERROR:g}"
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
        for criterion in ERROR_CRITERIA
    )
    timings = tuple(
        Timing(*key, skipped=reasons[key])
        if key in reasons
        else Timing(*key, tuple(seconds[key]), ready[key][2], ready[key][1])
        for key in ((peer.name, criterion) for peer in peers for criterion in ERROR_CRITERIA)
    )
    charts = tuple(
        Timing("stability_chart", criterion, tuple(ours), largest)
        for criterion, largest in zip(ERROR_CRITERIA, errors, strict=True)
    )
    return Comparison(size, damping, charts, timings)


def sample_points(family: MovingPlate, Omega: FloatArray, eps: FloatArray, count: int) -> list[Sample]:
    """Return grid points at random in equal strata of Omega with their multipliers, surer than needed."""
    random = np.random.default_rng(4)
    points: list[Sample] = []
    for stratum in np.array_split(Omega, count):
        while True:
            w, e = float(random.choice(stratum)), float(random.choice(eps[1:]))
            found = monodromy(family, w, e)
            if found.log_modulus_error < MAX_REFERENCE_ERROR:
                points.append(Sample(w, e, found.multipliers))
                break
    order = random.permutation(count)
    return [points[i] for i in order]


def cheapest(
    peer: Peer, family: MovingPlate, samples: Sequence[Sample], criterion: str
) -> tuple[Solve, float, float] | None:
    """Return the peer with the first setting that meets `REQUIRED_ERROR` at all points, that setting and its error."""
    equations = modal_equations(family.at(samples[0].Omega))
    if peer.mixed:
        equations = mixed_equations(equations)
    for setting in peer.settings:
        solve = peer.prepare(equations, setting)
        largest = 0.0
        for w, e, exact in samples:
            with np.errstate(all="ignore"):  # it may overflow at a loose setting
                largest = max(largest, error(multipliers(solve, w, e), exact, criterion))
            if largest > REQUIRED_ERROR:
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
