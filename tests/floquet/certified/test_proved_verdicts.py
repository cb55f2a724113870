"""`monodromy` and `stability_chart` against certificates: where they say stable or unstable, it is proved.

Wherever the certificate cannot decide, they must not decide either. Points are drawn at random and close to the
boundaries, where a wrong error estimate shows first.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np
import pytest

pytest.importorskip("flint", reason="python-flint, the extra certify, is not installed")

from floquet import Kind, monodromy, stability_chart
from floquet.certified import CertifiedGrowth, ProvedVerdict, certified_growth
from periodic import PeriodicSystem
from periodic.checks import FloatArray
from periodic.examples import coupled_mathieu, gyroscopic_rotor, mathieu, meissner
from plate import EdgeLoad, MovingPlate
from tests.sparing import all_but

# Relative distances from a boundary at which points are tried on either side; boundaries are located ten times better.
DISTANCES = (1e-6, 1e-7, 1e-8, 1e-9)
FEW_DISTANCES = (1e-6, 1e-9)  # in `make test`


# What is counted: verdicts "stable" and "unstable" are decisions, "undecided" is none.
COLUMNS = ("cells", "within 1e-6 of a boundary", "proof decides", "monodromy decides", "chart decides")


class Study(NamedTuple):
    system: PeriodicSystem
    window: tuple[float, float]
    eps: tuple[float, ...]
    columns: int  # of the scan for boundaries


def small_plate(**parameters: object) -> PeriodicSystem:
    return MovingPlate(axial_terms=2, lateral_terms=3, **parameters).at(1.0)  # type: ignore[arg-type]


SMALL = {
    "mathieu": Study(mathieu(), (0.4, 5.0), (0.5, 1.5), 60),
    "mathieu damped": Study(mathieu(damping=0.05), (0.4, 5.0), (0.5,), 60),
    "meissner": Study(meissner(harmonics=5), (0.8, 5.0), (0.5,), 40),
    "coupled, sum": Study(coupled_mathieu(), (0.8, 6.0), (0.5,), 80),
    "coupled, difference": Study(coupled_mathieu("difference"), (0.4, 6.0), (0.5,), 80),
    "coupled, damped": Study(coupled_mathieu(damping=(0.1, 0.02)), (0.8, 6.0), (0.5,), 80),
    "coupled, double": Study(coupled_mathieu(frequencies=(1.0, 1.0)), (0.8, 6.0), (0.5,), 40),
    "rotor": Study(gyroscopic_rotor(), (0.8, 8.0), (0.5,), 80),
    "rotor, oval shaft": Study(gyroscopic_rotor((4.0, 5.0), 0.7), (0.8, 8.0), (0.5,), 80),
    "rotor, damped": Study(gyroscopic_rotor((4.0, 5.0), 0.7, 0.05), (0.8, 8.0), (1.0,), 80),
    "plate": Study(small_plate(), (16.0, 22.0), (0.3,), 20),
}
LARGE = {name: study._replace(columns=3 * study.columns) for name, study in SMALL.items()} | {
    "plate": Study(small_plate(), (10.0, 90.0), (0.3, 0.8), 160),
    "plate, linear load": Study(small_plate(load=EdgeLoad.linear(0.5, 1.5)), (10.0, 90.0), (0.3,), 160),
    "plate, damped": Study(small_plate(damping=1e-3), (10.0, 90.0), (0.5,), 160),
}


def boundaries(study: Study, eps: float) -> Iterator[float]:
    """Yield Omega where `monodromy` turns from not unstable to unstable or back."""

    def unstable(Omega: float) -> bool:
        return monodromy(study.system, Omega, eps).kind > Kind.STABLE

    scan = np.linspace(*study.window, study.columns)
    kinds = [unstable(float(Omega)) for Omega in scan]
    for i in np.flatnonzero(np.diff(kinds)):
        low, high = float(scan[i]), float(scan[i + 1])
        while high - low > 0.1 * min(DISTANCES) * high and low < (middle := 0.5 * (low + high)) < high:
            low, high = (middle, high) if unstable(middle) == kinds[i] else (low, middle)
        yield low


def points(study: Study, eps: float, spread: int, distances: tuple[float, ...]) -> tuple[FloatArray, int]:
    """Return sorted Omega and how many of them are next to a boundary.

    ``spread`` are at random in the window, and two at each of ``distances`` from every boundary, one on either side.
    """
    near = [
        edge * (1 + sign * distance) for edge in boundaries(study, eps) for distance in distances for sign in (-1, 1)
    ]
    return np.unique([*np.random.default_rng(0).uniform(*study.window, spread), *near]), len(np.unique(near))


def check(kind: int, log_modulus: float, error: float, Omega: float, found: CertifiedGrowth) -> list[str]:
    """Return what is wrong with a verdict and a log|mu| that claims this error."""
    faults = []
    if kind != Kind.UNDECIDED and found.verdict is not (
        ProvedVerdict.STABLE if kind == Kind.STABLE else ProvedVerdict.UNSTABLE
    ):
        faults.append(f"Omega = {Omega!r}: {Kind(kind).name}, proved {found.verdict}")
    period = 2 * np.pi / Omega
    miss = max(found.lower * period - log_modulus, log_modulus - found.upper * period)
    if miss > 3 * error + 1e-13:
        faults.append(f"Omega = {Omega!r}: log|mu| = {log_modulus!r} is off by {miss:.3g}, estimated {error:.3g}")
    return faults


def compare(study: Study, spread: int, distances: tuple[float, ...]) -> tuple[Counter[str], list[str]]:
    """Hold both integrators against certificates; return how many cells and verdicts there were, and all faults."""
    faults: list[str] = []
    counts = Counter(dict.fromkeys(COLUMNS, 0))
    for eps in study.eps:
        Omega, near = points(study, eps, spread, distances)
        chart = stability_chart(study.system, Omega, [eps], n_jobs=1, progress=False)
        for i, w in enumerate(map(float, Omega)):
            found = certified_growth(study.system, w, eps)
            period = 2 * np.pi / w
            point = monodromy(study.system, w, eps)
            one = check(point.kind, point.growth_rate * period, point.log_modulus_error, w, found)
            cell = (int(chart.kind[0, i]), chart.growth_rate[0, i] * period, chart.error[0, i])
            faults += [f"monodromy, eps = {eps}, {fault}" for fault in one]
            faults += [f"chart, eps = {eps}, {fault}" for fault in check(*cell, w, found)]
            decided = (
                found.verdict is not ProvedVerdict.UNDECIDED,
                point.kind != Kind.UNDECIDED,
                cell[0] != Kind.UNDECIDED,
            )
            counts.update(dict(zip(COLUMNS[2:], map(int, decided), strict=True)))
        counts.update({COLUMNS[0]: len(Omega), COLUMNS[1]: near})
    return counts, faults


# Many seconds each.
DEAR = ["plate", "rotor", "rotor, damped", "rotor, oval shaft", "coupled, double", "coupled, difference"]


@pytest.mark.parametrize("name", all_but(DEAR, SMALL))
def test_verdicts_are_proved(name: str) -> None:
    counts, faults = compare(SMALL[name], 8, FEW_DISTANCES)
    assert not faults, "\n".join(faults)
    assert counts["cells"] > 15


@pytest.mark.slow
@pytest.mark.parametrize("name", LARGE)
def test_many_verdicts_are_proved(name: str, tabulate: Callable[..., None]) -> None:
    counts, faults = compare(LARGE[name], 60, DISTANCES)
    tabulate(
        "Verdicts held against proofs",
        system=name,
        n=LARGE[name].system.size,
        **counts,
        disagreements=len(faults),
    )
    assert not faults, "\n".join(faults)
    assert counts["cells"] > 75
    # next to a boundary, where it is hard, half of the verdicts are given all the same
    assert min(counts["monodromy decides"], counts["chart decides"]) > counts["cells"] / 2


@pytest.mark.parametrize("kappa", [0.25, 1.0, -2.0])
def test_on_a_boundary_nothing_is_decided(kappa: float) -> None:
    """exp(-kappa cos t) solves x'' + (-kappa^2/2 - kappa cos t + kappa^2/2 cos 2t) x = 0: mu = 1 is double, exactly."""
    half = kappa**2 / 2
    system = PeriodicSystem([[1.0]], [[0.0]], [[0.0]], [[-half]], [[[-kappa]], [[half]]])
    assert certified_growth(system, 1.0, 1.0).verdict is ProvedVerdict.UNDECIDED
    assert monodromy(system, 1.0, 1.0).kind is Kind.UNDECIDED
    assert stability_chart(system, [1.0], [1.0], n_jobs=1, progress=False).kind[0, 0] == Kind.UNDECIDED
