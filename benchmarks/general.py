"""Charts of other systems than eq. (11): against a chart of the same plate with a cosine, and against DOP853.

DOP853 is given the same task: it is told where coefficients jump, and integrates from jump to jump.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
import scipy.integrate

from benchmarks.methods import MAX_REFERENCE_ERROR, REQUIRED_ERROR, Plan
from benchmarks.peers import DOP853_TOLERANCES
from benchmarks.subjects import BENCHMARK_DAMPING, chart, cpu_time, grids, plate
from floquet import monodromy
from periodic import AnyFamily, PeriodicSystem, Term, waveforms
from periodic.checks import FloatArray

# Amplitude of the pulsating speed, for eps = 1, in parts of the mean speed.
SPEED_AMPLITUDE = 0.3
# Teeth of the wheels whose meshes excite the drive, and the part of a tooth during which two pairs are in contact.
TEETH, CONTACT = (23, 47), (0.6, 0.7)
# Frequencies of a wheel of the drive: its 23rd and 47th harmonic meet natural frequencies.
GEAR_FREQUENCIES, GEAR_GRID = (0.05, 0.2), (64, 32)


class Subject(NamedTuple):
    """A family, its grid, and which of the cosine's charts its cost is compared with; "" for none."""

    name: str
    family: AnyFamily
    Omega: FloatArray
    eps: FloatArray
    beside: str


@dataclass(frozen=True)
class GeneralTiming:
    """CPU seconds per point of a chart in each round, the ratios to the chart beside it, and DOP853's."""

    name: str
    points: int
    seconds: tuple[float, ...]
    ratios: tuple[float, ...]
    error: float
    peer_seconds: float
    peer_setting: float


def gear_drive() -> PeriodicSystem:
    """Four wheels, two meshes of 23 and 47 teeth whose stiffness jumps 140 times a period, a soft shaft."""
    first, second, shaft = (np.eye(4)[i] - np.eye(4)[j] for i, j in ((0, 1), (2, 3), (1, 2)))
    M = np.diag([1.0, 0.8, 1.2, 2.0])
    meshes = [10.0 * np.outer(first, first), 12.0 * np.outer(second, second)]
    K = sum(meshes) + 5.0 * np.outer(shaft, shaft) + 0.5 * np.eye(4)
    terms = [Term("stiffness", X, mesh(z, part)) for X, z, part in zip(meshes, TEETH, CONTACT, strict=True)]
    return PeriodicSystem(M, damping=1e-2 * M + 1e-3 * K, stiffness=K, terms=terms)


def mesh(teeth: int, part: float) -> waveforms.Waveform:
    """Return the stiffness of a mesh: 1 during a ``part`` of each tooth, and as much lower that its mean is zero."""
    starts = np.arange(teeth) / teeth
    jumps = np.sort(np.concatenate([starts, starts + part / teeth])).tolist()
    return waveforms.function(
        lambda theta: 1.0 if theta / (2 * math.pi) * teeth % 1.0 < part else -part / (1 - part), jumps
    )


def rectangular(size: int, damping: float) -> PeriodicSystem:
    """Return the plate whose load is switched instead of turned like a cosine."""
    steady = plate(size, damping).at(30.0)
    load = Term("stiffness", steady.cosine[0], waveforms.rectangular())
    return PeriodicSystem(steady.mass, steady.gyroscopic, steady.damping, steady.stiffness, terms=[load])


def subjects(plan: Plan) -> list[Subject]:
    """Return what is timed: elastic and damped plates of 28 coordinates, or of the smallest size, and the drive."""
    size = 28 if 28 in plan.sizes else plan.sizes[0]
    found = []
    for word, damping in (("elastic", 0.0), ("damped", BENCHMARK_DAMPING)):
        cosine, grid = plate(size, damping), grids(plan.columns, plan.rows)
        moving = plate(size, damping, speed_amplitude=SPEED_AMPLITUDE, load_amplitude=0.0)
        beside = f"cosine, {word}"
        found += [Subject(beside, cosine, *grid, beside), Subject(f"pulsating speed, {word}", moving, *grid, beside)]
        found.append(Subject(f"rectangular wave, {word}", rectangular(size, damping), *grid, beside))
    columns, rows = (min(one, other) for one, other in zip(GEAR_GRID, (plan.columns, plan.rows), strict=True))
    gears = np.linspace(*GEAR_FREQUENCIES, columns), np.linspace(0.0, 0.5, rows)
    return [*found, Subject("gear mesh, 23 and 47 teeth", gear_drive(), *gears, "")]


def general_charts(plan: Plan) -> list[GeneralTiming]:
    """Time the charts in turns; verify log|mu| of some points of each, and time DOP853 at them."""
    some = subjects(plan)
    for one in some:
        chart(one.family, one.Omega[:9], one.eps)  # compiles
    seconds: dict[str, list[float]] = {one.name: [] for one in some}
    charts: dict[str, Any] = {}
    for _ in range(plan.rounds[0]):
        for one in some:
            spent, charts[one.name] = cpu_time(chart, one.family, one.Omega, one.eps)
            seconds[one.name].append(spent / (one.Omega.size * one.eps.size))
    found = []
    for one in some:
        beside = seconds[one.beside] if one.beside else []
        ratios = tuple(ours / theirs for ours, theirs in zip(seconds[one.name], beside, strict=False))
        error, peer_seconds, setting = _verified(one, charts[one.name], plan.timed)
        points = one.Omega.size * one.eps.size
        found.append(GeneralTiming(one.name, points, tuple(seconds[one.name]), ratios, error, peer_seconds, setting))
    return found


def _verified(subject: Subject, found: Any, count: int) -> tuple[float, float, float]:
    """Return the chart's largest error at some points, and DOP853's seconds and setting where it meets the error."""
    random = np.random.default_rng(4)
    points: list[tuple[float, float, float, float]] = []
    while len(points) < count:
        i, j = int(random.integers(1, subject.eps.size)), int(random.integers(subject.Omega.size))
        w, e = float(subject.Omega[j]), float(subject.eps[i])
        exact = monodromy(subject.family, w, e)
        if exact.log_modulus_error < MAX_REFERENCE_ERROR and found.error[i, j] < REQUIRED_ERROR:
            period = 2 * np.pi / w
            points.append((w, e, exact.growth_rate * period, found.growth_rate[i, j] * period))
    error = max(abs(ours - exact) for _, _, exact, ours in points)
    for setting in DOP853_TOLERANCES:
        solve = dop853_between_jumps(setting)
        runs = [cpu_time(solve, subject.family.at(w), w, e) for w, e, _, _ in points]
        largest = [
            math.log(np.abs(np.linalg.eigvals(Phi)).max()) if np.isfinite(Phi).all() else np.inf for _, Phi in runs
        ]
        if max(abs(one - exact) for one, (_, _, exact, _) in zip(largest, points, strict=True)) <= REQUIRED_ERROR:
            return error, sum(spent for spent, _ in runs) / count, setting
    return error, math.nan, math.nan


def dop853_between_jumps(rtol: float) -> Callable[[Any, float, float], FloatArray]:
    """Return a function of (system, Omega, eps) that gives the monodromy matrix in (W, W') by SciPy's DOP853."""

    def solve(system: PeriodicSystem, Omega: float, eps: float) -> FloatArray:
        n = system.size
        inverse = np.linalg.inv(system.mass)
        free = np.block(
            [
                [np.zeros((n, n)), np.eye(n)],
                [-inverse @ system.stiffness, -inverse @ (system.gyroscopic + system.damping)],
            ]
        )
        terms = [*system.terms]
        for j in range(system.harmonics):
            terms += [
                Term("stiffness", X, wave)
                for X, wave in ((system.cosine[j], waveforms.cosine(j + 1)), (system.sine[j], waveforms.sine(j + 1)))
                if X.any()
            ]
        waves: list[tuple[Any, FloatArray]] = []
        for term in terms:
            acting = np.zeros((2 * n, 2 * n))
            acting[n:, slice(0, n) if term.of == "stiffness" else slice(n, 2 * n)] = -inverse @ (
                eps**term.power * term.matrix
            )
            waves.append((term.waveform, acting))
        Phi: FloatArray = np.eye(2 * n)
        jumps = {jump for term in terms for jump in term.waveform.jumps}
        for a, b in pairwise(sorted({0.0, 1.0, *jumps})):

            def rate(x: float, y: FloatArray, inside: float = (a + b) / 2) -> FloatArray:
                A = free + sum((g.value_beside(x, inside) * X for g, X in waves), np.zeros((2 * n, 2 * n)))
                return np.asarray((2 * np.pi / Omega * A @ y.reshape(2 * n, 2 * n)).ravel())

            part = scipy.integrate.solve_ivp(rate, (a, b), Phi.ravel(), method="DOP853", rtol=rtol, atol=rtol)
            Phi = np.asarray(part.y[:, -1]).reshape(2 * n, 2 * n)
        return Phi

    return solve
