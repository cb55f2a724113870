"""Where the time of a chart goes, and its multipliers before only the dominant one is kept."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from floquet.chart import task_columns
from floquet.engine import (
    INTERPOLATION_TOLERANCE,
    ReciprocalSums,
    Sampler,
    Subsystem,
    Workspace,
    chart_batch,
    log2_steps,
    reciprocal_pairs,
    spectra,
    steps_needed,
    subsystems,
)
from floquet.running import single_blas_thread
from periodic import SystemFamily
from periodic.checks import ComplexArray, FloatArray

# Rows of the matrices whose product shows the peak rate of BLAS.
PEAK_SIZE = 512


@dataclass(frozen=True)
class Stages:
    """CPU seconds of the stages of a chart, its matrix products, and the peak rate of BLAS.

    ``rest`` is what is left of the whole: dominant multipliers, measured errors, verdicts. ``operations`` are the
    multiplications and additions of the products that double the steps, and of nothing else.
    """

    sampling: float
    eigenvalues: float
    rest: float
    operations: float
    peak: float

    @property
    def rate(self) -> float:
        """Operations per second of sampling."""
        return self.operations / self.sampling


def chart_multipliers(family: SystemFamily, Omega: float, eps: FloatArray) -> ComplexArray:
    """Return all multipliers at the amplitudes of a column, shape (k, 2n), from the steps that the chart takes."""
    system = family.at(Omega)
    steps = steps_needed([system], np.array([Omega]), eps)
    found = []
    with single_blas_thread():
        for subsystem in subsystems(system):
            sampler, L = _sampler(subsystem, Omega, eps, steps, Workspace())
            these = spectra(sampler, eps, L, INTERPOLATION_TOLERANCE)
            mu = reciprocal_pairs(these.sums) if isinstance(these, ReciprocalSums) else these.mu
            found.append(mu * np.exp2(these.exponents)[:, None])
    return np.concatenate(found, axis=1)


def stages(family: SystemFamily, Omega: FloatArray, eps: FloatArray, every: int = 4, rounds: int = 3) -> Stages:
    """Time the stages of some tasks of a chart, one out of ``every`` so many; the least of some rounds each."""
    some = [Omega[columns] for columns in task_columns(len(Omega))[::every]]
    blocks_of_columns = [([family.at(float(w)) for w in part], part) for part in some]
    Omega = np.concatenate(some)
    systems = [system for part, _ in blocks_of_columns for system in part]
    steps = steps_needed([systems[0], systems[-1]], Omega[[0, -1]], eps)
    work = Workspace()
    samplers = [
        _sampler(b, float(w), eps, steps, work) for s, w in zip(systems, Omega, strict=True) for b in subsystems(s)
    ]
    operations = 0.0
    for sampler, L in samplers:
        plan = sampler.plan(eps, L, INTERPOLATION_TOLERANCE)
        if plan is not None:
            operations += 2.0 * sampler.size**3 * float(plan.schedule.sizes[1:].sum())

    def sample() -> None:
        for sampler, L in samplers:
            for _ in sampler.pieces(eps, L, INTERPOLATION_TOLERANCE):
                pass

    def solve() -> None:
        for sampler, L in samplers:
            spectra(sampler, eps, L, INTERPOLATION_TOLERANCE)

    def whole() -> None:
        for columns in blocks_of_columns:
            chart_batch(*columns, eps, steps)

    A = np.random.default_rng(0).standard_normal((PEAK_SIZE, PEAK_SIZE))
    with single_blas_thread():
        least = [_least(stage, rounds) for stage in (sample, solve, whole, lambda: A @ A)]
    sampled, solved, all_of_it, product = least
    return Stages(sampled, solved - sampled, all_of_it - solved, operations, 2.0 * PEAK_SIZE**3 / product)


def _sampler(subsystem: Subsystem, Omega: float, eps: FloatArray, steps: float, work: Workspace) -> tuple[Sampler, int]:
    sampler = Sampler.of(subsystem, Omega, work)
    return sampler, log2_steps(subsystem, Omega, eps, steps)


def _least(function: Callable[[], object], rounds: int) -> float:
    def once() -> float:
        start = time.process_time()
        function()
        return time.process_time() - start

    once()
    return min(once() for _ in range(rounds))
