"""Random systems of every kind: chart, `monodromy` and SciPy's DOP853 have to agree.

``python -m tests.hunt.charts 0 2000`` looks at the seeds 0 to 1999 and prints the worst figures. It is another program
than the one that it looks at: DOP853 integrates the definition of the system, from jump to jump.
"""

from __future__ import annotations

import sys
from typing import NamedTuple

import numpy as np

from floquet import Kind, monodromy, stability_chart
from periodic import AnySystem, PeriodicSystem, Term, waveforms
from tests.floquet.general_oracles import dop853, random_first_order, random_second_order, random_waveform

OMEGA_RANGE, EPS_RANGE = (0.8, 4.0), (-0.6, 0.8)
COLUMNS, ROWS = 2, 4
LARGEST_SIZE = 8
# Of log|mu|, where chart and point both claim to be that good; elsewhere their estimates count.
REQUIRED_AGREEMENT = 1e-9
# An estimate is an order of magnitude.
MAX_ERROR_RATIO, ROUNDING = 3.0, 1e-13
# Error of the multipliers by DOP853, relative to the largest matrix entry that they come from.
DOP853_ERROR = 1e-10
# DOP853 takes seconds for a point: it is asked for so many seeds out of so many.
DOP853_SEEDS, DOP853_OF = 5, 50


class Finding(NamedTuple):
    """What one system shows.

    ``difference`` is the largest of log|mu| between chart and `monodromy` where both claim REQUIRED_AGREEMENT,
    ``ratio`` the largest of any difference to the sum of the estimates, ``wrong`` the number of contradictions,
    ``undecided`` of cells without a verdict. ``dop853`` is the largest difference of the chart from DOP853, NaN if it
    was not asked, ``dop853_ratio`` that difference in units of what the two may differ by.
    """

    seed: int
    sort: str
    cells: int
    difference: float
    ratio: float
    wrong: int
    undecided: int
    dop853: float
    dop853_ratio: float


def conservative(seed: int, n: int) -> PeriodicSystem:
    """A gyroscopic system without damping whose stiffness goes with jumps, or with none: Hamiltonian."""
    rng = np.random.default_rng(seed)

    def matrix(size: float, sign: int = 1) -> np.ndarray:
        X = size * rng.standard_normal((n, n))
        return (X + sign * X.T) / 2

    A, B = matrix(0.5), matrix(1.0)
    terms = [
        Term("stiffness", matrix(0.5), random_waveform(rng), int(rng.integers(1, 3))) for _ in range(rng.integers(1, 3))
    ]
    if rng.random() < 0.3:
        terms.append(Term("stiffness", matrix(0.3), waveforms.impulses(np.sort(rng.random(2)), [1.0, -0.5])))
    return PeriodicSystem(A @ A + np.eye(n), matrix(1.0, -1), None, B @ B + np.eye(n), terms=terms)


def random_system(seed: int) -> tuple[str, AnySystem]:
    """One of five sorts, by the seed: what it is, and the system."""
    rng = np.random.default_rng([seed, 1])
    size, pulses = int(rng.integers(1, LARGEST_SIZE + 1)), bool(rng.random() < 0.3)
    match seed % 5:
        case 0:
            return "second order, any terms", random_second_order(seed, (size + 1) // 2, pulses=pulses)
        case 1:
            return "first order", random_first_order(seed, size, pulses=pulses)
        case 2:
            return "second order, smooth", random_second_order(seed, size, kinds=3)
        case 3:
            return "conservative", conservative(seed, (size + 1) // 2)
        case _:
            of = ("stiffness", "damping", "gyroscopic")
            return "second order, no mass", random_second_order(seed, size, of=of, pulses=pulses)


def examine(seed: int, *, with_dop853: bool) -> Finding:
    """Compare a small chart of one system with points, and one of its points with DOP853."""
    sort, system = random_system(seed)
    rng = np.random.default_rng([seed, 2])
    Omega, eps = np.sort(rng.uniform(*OMEGA_RANGE, COLUMNS)), np.sort(rng.uniform(*EPS_RANGE, ROWS))
    chart = stability_chart(system, Omega, eps, n_jobs=1, progress=False, audit=0)
    difference = ratio = 0.0
    wrong = 0
    for i in range(ROWS):
        for j in range(COLUMNS):
            point = monodromy(system, float(Omega[j]), float(eps[i]))
            found = abs(chart.growth_rate[i, j] - point.growth_rate) * 2 * np.pi / Omega[j]
            allowed = chart.error[i, j] + point.log_modulus_error + ROUNDING
            if allowed < REQUIRED_AGREEMENT:
                difference = max(difference, found)
            ratio = max(ratio, found / allowed)
            wrong += contradict(chart.kind[i, j], point.kind)
    by_dop853 = dop853_ratio = float("nan")
    if with_dop853:
        i, j = int(rng.integers(ROWS)), int(rng.integers(COLUMNS))
        Phi = dop853(system, float(Omega[j]), float(eps[i]))
        largest = np.abs(np.linalg.eigvals(Phi)).max()
        by_dop853 = abs(float(np.log(largest)) - chart.growth_rate[i, j] * 2 * np.pi / Omega[j])
        # close multipliers move by the root of an error
        error = DOP853_ERROR * np.linalg.norm(Phi, 2) / largest
        dop853_ratio = by_dop853 / (chart.error[i, j] + max(error, np.sqrt(error) * (chart.error[i, j] > error)))
    undecided = int((chart.kind == Kind.UNDECIDED).sum())
    return Finding(seed, sort, chart.kind.size, difference, ratio, wrong, undecided, by_dop853, dop853_ratio)


def contradict(one: int, other: int) -> bool:
    """Return whether one verdict says stable and the other unstable."""
    return one != Kind.UNDECIDED and other != Kind.UNDECIDED and (one > Kind.STABLE) != (other > Kind.STABLE)


def is_fault(found: Finding) -> bool:
    """Return whether a finding is not as it has to be."""
    return bool(
        found.wrong
        or found.difference > REQUIRED_AGREEMENT
        or found.ratio > MAX_ERROR_RATIO
        or found.dop853_ratio > MAX_ERROR_RATIO
    )


def summary(findings: list[Finding]) -> str:
    """Return the worst figures as a Markdown table, by sort of system."""
    lines = [
        "| sort | systems | cells | largest difference | of estimate | wrong | undecided | from DOP853 | of allowed |",
        "|:--|--:|--:|--:|--:|--:|--:|--:|--:|",
    ]
    for sort in dict.fromkeys(one.sort for one in findings):
        some = [one for one in findings if one.sort == sort]
        asked = [one for one in some if np.isfinite(one.dop853)]
        lines.append(
            f"| {sort} | {len(some)} | {sum(one.cells for one in some)} | {max(one.difference for one in some):.1e} "
            f"| {max(one.ratio for one in some):.2f} | {sum(one.wrong for one in some)} "
            f"| {sum(one.undecided for one in some)} | {max((one.dop853 for one in asked), default=np.nan):.1e} "
            f"({len(asked)}) | {max((one.dop853_ratio for one in asked), default=np.nan):.2f} |"
        )
    return "\n".join(lines)


def main(first: int, stop: int) -> int:
    """Examine the seeds from ``first`` on; print each fault and then the worst figures."""
    findings = []
    for seed in range(first, stop):
        try:
            found = examine(seed, with_dop853=seed % DOP853_OF < DOP853_SEEDS)
        except Exception as error:
            print(f"seed {seed}: {type(error).__name__}: {error}", flush=True)
            continue
        findings.append(found)
        if is_fault(found):
            print(found, flush=True)
        if seed % 100 == 99:
            print(f"{seed + 1 - first} systems", file=sys.stderr, flush=True)
    print(summary(findings))
    return int(any(map(is_fault, findings)))


if __name__ == "__main__":
    sys.exit(main(*map(int, sys.argv[1:3])))
