"""Compile every kernel once, before the workers of a test run all ask for them: ``python -m tests.warm``.

What has been compiled before is loaded instead, in a second or two.
"""

from __future__ import annotations

import time

import numpy as np

from floquet import monodromy, stability_chart, trace_boundary, trace_regions
from periodic import AnySystem, FirstOrderSystem, PeriodicSystem, Term, waveforms
from periodic.examples import coupled_mathieu, meissner


def warm() -> None:
    """Go once along every path that is compiled: elastic and damped, one harmonic and several; other terms."""
    Omega, eps = np.linspace(1.5, 3.5, 8), np.linspace(0.0, 0.5, 16)
    for system in (coupled_mathieu(), coupled_mathieu(damping=(0.01, 0.02)), meissner(harmonics=3)):
        stability_chart(system, Omega, eps, n_jobs=1, progress=False)
        trace_regions(system, (1.5, 3.5), (0.0, 0.5), n_jobs=1, progress=False)
        monodromy(system, 2.0, 0.3)
    trace_boundary(coupled_mathieu(), near=2.7, eps=[0.1])
    for other in _general():
        stability_chart(other, Omega, eps, n_jobs=1, progress=False)
        monodromy(other, 2.0, 0.3)


def _general() -> list[AnySystem]:
    """Return systems with other terms than periodic stiffness: smooth, with jumps, periodic mass, first order."""
    one, stiffness = np.eye(2), np.diag([1.0, 5.0])
    waves = {"damping": waveforms.cosine(), "stiffness": waveforms.rectangular(), "mass": waveforms.cosine(2)}
    systems = [PeriodicSystem(one, stiffness=stiffness, terms=[Term(of, 0.2 * one, waves[of])]) for of in waves]
    return [*systems, FirstOrderSystem([[0.0, 1.0], [-1.0, -0.1]], [[0.0, 0.0], [1.0, 0.0]])]


if __name__ == "__main__":
    print("compiling the kernels, once for all workers and until the code changes: up to a minute or two", flush=True)
    start = time.perf_counter()
    warm()
    print(f"kernels ready after {time.perf_counter() - start:.0f} s", flush=True)
