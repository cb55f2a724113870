"""`trace_boundary` of any linear periodic system: all terms, first order, jumps, pulses, modes that depend on Omega."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from floquet import Kind, monodromy, trace_boundary
from floquet.boundary import BoundaryTrace, Resonance, natural_modes, resonances
from periodic import AnySystem, FirstOrderSystem, PeriodicSystem, Term, waveforms
from tests.floquet.general_oracles import dop853
from tests.general_systems import Reference, references_general
from tests.sparing import all_but

# Systems of the file whose coefficients are constant between jumps: their edges are exact there, and here.
STEPWISE = ("meissner", "kick")
ENTRIES = [entry for entry in references_general()["entries"] if entry["quantity"] == "edges"]
SORTS: dict[str, dict[str, Any]] = {
    "damping": {"of": "damping"},
    "gyroscopic": {"of": "gyroscopic"},
    "mass": {"of": "mass"},
    "eps squared": {"of": "stiffness", "power": 2},
    "jumps": {"of": "stiffness", "waveform": waveforms.rectangular(0.3, 0.1)},
    "jumps of the mass": {"of": "mass", "waveform": waveforms.rectangular(0.4, 0.3)},
    "triangle": {"of": "stiffness", "waveform": waveforms.triangle()},
    "pulses": {"of": "stiffness", "waveform": waveforms.impulses([0.2, 0.7], [2.0, 1.0])},
    "mean that grows with eps": {"of": "stiffness", "waveform": waveforms.function(lambda x: 0.5 + np.cos(x) ** 3)},
}


def growth(system: AnySystem, Omega: float, eps: float) -> float:
    """log of the largest modulus of a multiplier, by DOP853."""
    return float(np.log(np.abs(np.linalg.eigvals(dop853(system.at(Omega), Omega, eps))).max()))


def assert_edges_separate(system: Any, trace: BoundaryTrace) -> None:
    """DOP853 finds instability just inside each edge of each interval, and none just outside."""
    for eps, intervals in zip(trace.eps.tolist(), trace.intervals, strict=True):
        for lower, upper in intervals.tolist():
            step = 1e-4 * (upper - lower)
            assert growth(system, lower + step, eps) > 0 > growth(system, lower - step, eps)
            assert growth(system, upper - step, eps) > 0 > growth(system, upper + step, eps)


# The most expensive of the systems in the file.
LONG = ["plate_V3.0_f10.0_r1.0_c0.0", "beam_v2.0_vf0.8_N4_a0", "pipe_u2.0_b0.5"]
NAMES = sorted({entry["system"] for entry in ENTRIES})


@pytest.mark.parametrize("name", all_but(LONG, NAMES))
def test_edges_of_the_references(name: str) -> None:
    # the unstable set at one amplitude is the union of what the file has; an interval may be that of another resonance
    # in the window that was searched; what is not found was said to be undecided
    tolerance = 1e-12 if name.startswith(STEPWISE) else 1e-8
    for eps in sorted({entry["eps"] for entry in ENTRIES if entry["system"] == name}):
        entries = [entry for entry in ENTRIES if (entry["system"], entry["eps"]) == (name, eps)]
        family, missing = Reference(name, eps), union([one for entry in entries for one in edges_of(entry)])
        withheld = 0
        for resonance in resonances_of(family, entries):
            if not missing:
                break
            p, q, j, type, centre = resonance
            trace = trace_boundary(family, centre, [eps], type=type, j=j, p=p, q=q)
            found = trace.intervals[0].tolist()
            withheld += int(trace.kind[0] == Kind.UNDECIDED)
            missing = [one for one in missing if min([distance(one, x) for x in found], default=1) > tolerance * one[1]]
        assert len(missing) <= min(withheld, 1), (eps, missing)


def edges_of(entry: dict[str, Any]) -> list[list[float]]:
    """The intervals of one entry that have both edges."""
    value = entry["value"] or {}
    both = value.get("all", [value.get("lower"), value.get("upper")])
    return [both] if len(both) == 2 and None not in both else []


def union(intervals: list[list[float]]) -> list[list[float]]:
    """The union of intervals, as disjoint ones."""
    joined: list[list[float]] = []
    for lower, upper in sorted(intervals):
        if joined and lower <= joined[-1][1]:
            joined[-1][1] = max(joined[-1][1], upper)
        else:
            joined.append([lower, upper])
    return joined


def resonances_of(family: Any, entries: list[dict[str, Any]]) -> list[Resonance]:
    """The resonances with centres near the intervals of some entries, low orders first."""
    found: dict[tuple[Any, ...], Resonance] = {}
    for entry in entries:
        low, high = entry.get("window") or [side for one in edges_of(entry) for side in one] or (0.0, 0.0)
        modes = natural_modes(family.at((low + high) / 2 or 1.0), (low + high) / 2 or 1.0)
        around = resonances(modes, (0.95 * low, 1.05 * high), orders=[1, 2, 3, 4])
        found |= {one[:4]: one for one in around}
    return sorted(found.values(), key=lambda one: (one.j, one.type == "difference", one.p + one.q))


def distance(one: list[float], other: list[float]) -> float:
    """The larger distance between the edges of two intervals."""
    return max(abs(a - b) for a, b in zip(one, other, strict=True))


@pytest.mark.parametrize("seed", [0, *(pytest.param(seed, marks=pytest.mark.slow) for seed in range(1, 5))])
@pytest.mark.parametrize("sort", SORTS)
def test_every_sort_of_term_by_another_integrator(sort: str, seed: int) -> None:
    rng = np.random.default_rng([seed, *sort.encode()])
    omega = np.array([1.0, rng.uniform(1.3, 1.7)])
    given = {"waveform": waveforms.cosine(1, rng.random()), "power": 1} | SORTS[sort]
    X = rng.uniform(0.3, 1, (2, 2))
    X = X - X.T if given["of"] == "gyroscopic" else X + X.T
    G = rng.uniform(0.2, 0.6) * np.array([[0, 1], [-1, 0]])
    terms = [Term(given["of"], 0.5 * X, given["waveform"], given["power"])]
    if sort == "gyroscopic":  # alone it opens nothing here
        terms.append(Term("stiffness", 0.5 * np.diag(rng.uniform(0.5, 1, 2))))
    damping = 0.004 * np.diag(rng.uniform(0.5, 1.5, 2))
    system = PeriodicSystem(np.eye(2), G, damping, np.diag(omega**2), terms=terms)
    modes = natural_modes(system, 1.0)
    amplitudes = [0.35, 0.6] if sort == "eps squared" else [0.1, 0.2]
    opened = 0
    for one in resonances(modes, (1.2, 4.0), ["sum"], [1]):
        trace = trace_boundary(system, one.centre, amplitudes, type=one.type, j=one.j, p=one.p, q=one.q)
        assert_edges_separate(system, trace)
        opened += int(trace.is_open.sum())
        for eps in np.array(amplitudes)[trace.kind == Kind.STABLE]:
            nearby = one.centre * (1 + 0.004 * np.linspace(-1, 1, 9))
            covered = trace.covered[amplitudes.index(eps)]
            assert covered or max(growth(system, Omega, eps) for Omega in nearby.tolist()) < 0
    assert opened >= 2


@pytest.mark.parametrize(("n", "seed"), [(3, 0), (3, 1), (3, 2), (5, 3), (5, 4)])
def test_first_order_systems_of_odd_size(n: int, seed: int) -> None:
    # oscillators beside states that only decay, mixed by a random change of coordinates
    rng = np.random.default_rng([n, seed])
    A = -np.diag(rng.uniform(0.3, 1.0, n))
    for k, frequency in zip(range(0, n - 1, 2), (1.0, 1.45), strict=False):
        A[k : k + 2, k : k + 2] = [[-0.01, frequency], [-frequency, -0.01]]
    T = np.eye(n) + 0.3 * rng.standard_normal((n, n))
    inverse = np.linalg.inv(T)
    X = T @ (0.5 * rng.standard_normal((n, n))) @ inverse
    system = FirstOrderSystem(T @ A @ inverse, terms=[Term("state", X, waveforms.cosine(1, rng.random()))])
    trace = trace_boundary(system, 2.0, [0.2, 0.4], p=1, q=1)
    assert trace.is_open.any()
    assert_edges_separate(system, trace)


class Rotor:
    """Two modes that a gyroscopic matrix in proportion to Omega moves, with pulsating stiffness."""

    def at(self, Omega: float) -> PeriodicSystem:
        """The member at a frequency."""
        G = 0.5 * Omega * np.array([[0, -1], [1, 0]])
        F = Term("stiffness", np.array([[0.4, 0.1], [0.1, -0.2]]))
        return PeriodicSystem(np.eye(2), G, 0.004 * np.eye(2), np.diag([1, 1.3]), terms=[F])


# omega_1 omega_2 = sqrt(1.3) and omega_1^2 + omega_2^2 = 2.3 + Omega^2 / 4 without damping
@pytest.mark.parametrize(
    ("near", "p", "j", "centre"),
    [
        (1.53, 1, 1, 2 * np.sqrt(1.3 / 2.3)),
        (2.4, 2, 1, np.sqrt((2.3 + 2 * np.sqrt(1.3)) / 0.75)),
        (0.84, 1, 2, np.sqrt((2.3 - np.sqrt(2.3**2 - 3.9)) / 1.5)),
    ],
)
def test_a_centre_that_depends_on_its_own_frequency(near: float, p: int, j: int, centre: float) -> None:
    trace = trace_boundary(Rotor(), near, [0.2, 0.4], p=p, q=1, j=j, type="sum")
    assert trace.resonance.centre == pytest.approx(centre, rel=1e-4)  # damping moves it by its square
    system = Rotor().at(trace.resonance.centre)
    A = np.block([[-system.gyroscopic - system.damping, -system.stiffness], [np.eye(2), np.zeros((2, 2))]])
    omega = np.sort(np.linalg.eigvals(A).imag)[2:]
    assert j * trace.resonance.centre == pytest.approx(omega[p - 1] + omega[0], rel=1e-12)
    assert trace.is_open.any()
    assert_edges_separate(Rotor(), trace)


def test_a_split_of_eps_squared_alone_is_followed_from_its_own_strength() -> None:
    # x'' + (1 + eps^2 cos 2t') x = 0 at eps is Mathieu's equation at eps^2
    def member(power: int) -> PeriodicSystem:
        return PeriodicSystem([[1.0]], stiffness=[[1.0]], terms=[Term("stiffness", [[1.0]], waveforms.cosine(), power)])

    squared = trace_boundary(member(2), 2.0, np.sqrt([0.1, 0.4]))
    plain = trace_boundary(member(1), 2.0, [0.1, 0.4])
    assert squared.lower == pytest.approx(plain.lower, rel=1e-9)
    assert squared.upper == pytest.approx(plain.upper, rel=1e-9)


def test_gear_meshes_of_many_teeth() -> None:
    # 2 omega = 23 Omega, the harmonic of a mesh of 23 teeth: edges of Mathieu's equation at 23 Omega
    mesh = PeriodicSystem([[1.0]], stiffness=[[1.0]], terms=[Term("stiffness", [[1.0]], waveforms.cosine(23), 1)])
    plain = trace_boundary(PeriodicSystem([[1.0]], stiffness=[[1.0]], cosine=[[1.0]]), 2.0, [0.2])
    trace = trace_boundary(mesh, 2 / 23, [0.2], j=23)
    assert 23 * trace.lower == pytest.approx(plain.lower, rel=1e-9)
    assert 23 * trace.upper == pytest.approx(plain.upper, rel=1e-9)


def test_a_mass_that_vanishes_within_the_period_is_refused() -> None:
    system = PeriodicSystem([[1.0]], stiffness=[[1.0]], terms=[Term("mass", [[1.0]])])
    assert monodromy(system, 2.0, 0.2).kind >= Kind.STABLE
    with pytest.raises(ValueError, match=r"not positive definite at the phase 0\.5"):
        trace_boundary(system, 2.0, [1.5])
