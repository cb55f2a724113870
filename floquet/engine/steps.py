"""How many steps a period needs, from the error of a few columns that are integrated with N and with 2 N steps."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from floquet.engine.doubling import INTERPOLATION_TOLERANCE, Workspace, largest_amplitude
from floquet.engine.multipliers import Spectra, discrepancies, spectra
from floquet.engine.parts import AnySampler, AnySubsystem, parts_of, sampler_of
from floquet.running import single_blas_thread
from periodic import AnySystem
from periodic.checks import FloatArray

# Steps in one cycle of the fastest motion. With fewer than two and a bit, the steps themselves are in resonance with
# the fast modes, which then look unstable.
MIN_STEPS_PER_CYCLE = 16.0
MAX_STEPS_PER_CYCLE = 2.0**16  # more only collect rounding errors
MAX_DOUBLINGS = 20  # log2 of the steps of one period, for the same reason
ORDER = 4  # of the error in the length of a step
TARGET_ERROR = 1e-10  # for the error E of `floquet.engine.stability`
# An error is extrapolated to steps that are shorter by at most this factor; beyond that it is measured again.
MAX_EXTRAPOLATION = 4.0
MEASURED_AMPLITUDES = 6  # of a column, at which its error is measured
# The finer of two computations is interpolated to this part of the tolerance, so that the steps alone make them differ.
FINER_TOLERANCE = INTERPOLATION_TOLERANCE / 10


def steps_needed(systems: Sequence[AnySystem], Omega: FloatArray, eps: FloatArray) -> float:
    """Return how many steps in one cycle of the fastest motion the given columns need.

    ``systems`` are those at the frequencies ``Omega``. The result is meant for `floquet.engine.chart_batch`.

    Raises
    ------
    ValueError
        If a period has too many cycles of the fastest motion, or a mass becomes singular within it.
    """
    work = Workspace()
    with single_blas_thread():
        needed = [
            _needed_steps(subsystem, float(frequency), eps, work)
            for system, frequency in zip(systems, Omega, strict=True)
            for subsystem in parts_of([system], np.array([frequency]), eps)[0]
        ]
    return max(needed, default=MIN_STEPS_PER_CYCLE)


def _needed_steps(subsystem: AnySubsystem, Omega: float, eps: FloatArray, work: Workspace) -> float:
    """Return how many steps in one cycle of the fastest motion bring the error at ``Omega`` down to TARGET_ERROR."""
    sampler, some = sampler_of(subsystem, Omega, work), eps[measured_amplitudes(eps)]
    steps = MIN_STEPS_PER_CYCLE
    while True:
        L = log2_steps(subsystem, Omega, eps, steps)
        errors = step_errors(sampler, spectra(sampler, some, L, INTERPOLATION_TOLERANCE), some, L)
        error = errors.max(where=np.isfinite(errors), initial=0.0)  # infinite where an eigenvalue did not converge
        taken = 2.0**L * Omega / fastest(subsystem, Omega, eps)
        steps = taken * (error / TARGET_ERROR) ** (1 / ORDER)
        steps = min(max(steps, MIN_STEPS_PER_CYCLE), MAX_STEPS_PER_CYCLE)
        if steps <= MAX_EXTRAPOLATION * taken or L == MAX_DOUBLINGS:
            return steps


def step_errors(sampler: AnySampler, found: Spectra, eps: FloatArray, L: int) -> FloatArray:
    """Return E (k,) of the multipliers ``found`` at the amplitudes ``eps`` with 2^L steps, by twice as many steps."""
    return discrepancies(found, spectra(sampler, eps, L + 1, FINER_TOLERANCE))


def measured_amplitudes(eps: FloatArray) -> list[int]:
    """Return the places of the amplitudes at which errors are measured: evenly spaced among those that are not zero."""
    excited = np.flatnonzero(eps) if np.any(eps) else np.arange(1)
    places = np.linspace(0, len(excited) - 1, min(MEASURED_AMPLITUDES, len(excited)))
    return excited[np.rint(places).astype(int)].tolist()


def fastest(subsystem: AnySubsystem, Omega: float, eps: FloatArray) -> float:
    """Return the rate of the fastest motion: of the system at its stiffest, or of the excitation."""
    return subsystem.fastest(Omega, largest_amplitude(eps))


def log2_steps(subsystem: AnySubsystem, Omega: float, eps: FloatArray, steps_per_cycle: float) -> int:
    """Return L for a period of 2^L steps, at least ``steps_per_cycle`` in one cycle of the fastest motion.

    Raises
    ------
    ValueError
        If one period has too many cycles of the fastest motion for 2^MAX_DOUBLINGS steps.
    """
    cycles = fastest(subsystem, Omega, eps) / Omega
    if not MIN_STEPS_PER_CYCLE * cycles <= 2.0**MAX_DOUBLINGS:
        raise ValueError(
            f"Omega = {Omega!r} with eps up to {largest_amplitude(eps)!r}: one period has {cycles:.2g} cycles of the "
            "fastest motion, too many to integrate; give a larger Omega or a smaller eps"
        )
    return min(math.ceil(math.log2(steps_per_cycle * cycles)), MAX_DOUBLINGS)
