"""`trace_boundary`: combination resonances, plates, regions that meet or are closed, bad input."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from floquet import BoundaryTrace, Kind, monodromy, trace_boundary
from periodic import PeriodicSystem
from periodic.examples import coupled_mathieu, gyroscopic_rotor, mathieu
from plate import EdgeLoad, MovingPlate
from plate.distribution import Distribution
from tests.floquet.oracle_systems import dop853, random_system


@pytest.mark.parametrize("kind", ["sum", "difference"])
def test_combination_resonance(kind: str) -> None:
    omega = np.array([1.0, 1.7])
    centre = omega[1] + omega[0] if kind == "sum" else omega[1] - omega[0]
    root_L = 1 / (2 * math.sqrt(omega[0] * omega[1]))
    eps = np.array([0.01, 0.02, 0.04])
    elastic = trace_boundary(coupled_mathieu(kind, omega), centre, eps)
    assert (elastic.kind == Kind.COMPLEX).all()
    assert (elastic.resonance.p, elastic.resonance.q, elastic.resonance.type) == (2, 1, kind)
    half = (elastic.upper - elastic.lower) / 2
    assert half == pytest.approx(eps * root_L, rel=1e-3)

    # two unequal dampings: eq. (25) of Young, Huang and Chiu with decay rates d / 2, far from the elastic curve
    d = np.array([0.001, 0.02])
    damped = trace_boundary(coupled_mathieu(kind, omega, damping=d), centre, eps)
    expected = d.sum() / 2 * np.sqrt(eps**2 * root_L**2 / (d[0] * d[1]) - 1 + 0j).real
    assert damped.is_open.tolist() == [False, True, True]
    assert ((damped.upper - damped.lower) / 2)[1:] == pytest.approx(expected[1:], rel=2e-3)
    assert expected[2] > 2 * half[2]  # damping has widened the region

    # as damping vanishes the edges do not tend to the elastic ones (destabilisation paradox)
    faint = trace_boundary(coupled_mathieu(kind, omega, damping=1e-5 * d), centre, eps)
    assert (faint.upper - faint.lower) / 2 == pytest.approx(half * d.sum() / (2 * math.sqrt(d[0] * d[1])), rel=2e-3)

    other = "difference" if kind == "sum" else "sum"
    closed = trace_boundary(coupled_mathieu(other, omega), centre, eps)
    assert not closed.is_open.any()
    assert (closed.kind == Kind.STABLE).all()


def test_edges_separate_stable_from_unstable_by_another_integrator() -> None:
    # a gyroscopic system with two harmonics: on either side of every edge DOP853 finds what the trace says
    system = random_system(20, 3, 2)
    K = system.stiffness + (1 - np.linalg.eigvalsh(system.stiffness)[0]) * np.eye(3)
    system = PeriodicSystem(system.mass, system.gyroscopic, system.damping, K, system.cosine, system.sine)
    exponents = np.linalg.eigvals(
        np.block(
            [
                [-np.linalg.solve(system.mass, system.gyroscopic), -np.linalg.solve(system.mass, K)],
                [np.eye(3), np.zeros((3, 3))],
            ]
        )
    )
    first = np.sort(exponents.imag[exponents.imag > 0])[0]
    trace = trace_boundary(system, 2 * first, 0.05)
    width = trace.upper[0] - trace.lower[0]
    for Omega, unstable in (
        (trace.lower[0] * (1 - 1e-6), False),  # the next region begins 1e-4 below
        (trace.lower[0] + 0.02 * width, True),
        (trace.upper[0] - 0.02 * width, True),
        (trace.upper[0] + 0.02 * width, False),
    ):
        growth = np.log(np.abs(np.linalg.eigvals(dop853(system, Omega, 0.05))).max())
        assert (growth > 1e-7) == unstable


def test_round_rotor_has_the_regions_of_mathieu() -> None:
    eps = [0.1, 1.0]
    rotor = trace_boundary(gyroscopic_rotor((4.0, 4.0), 0.5), 4.0, eps)
    plain = trace_boundary(mathieu(4.0), 4.0, eps)
    assert rotor.lower == pytest.approx(plain.lower, rel=1e-9)
    assert rotor.upper == pytest.approx(plain.upper, rel=1e-9)
    assert (rotor.kind == Kind.COMPLEX).all()
    for near in (3.0, 5.0):  # 2 omega_1 and 2 omega_2 have no width
        assert not trace_boundary(gyroscopic_rotor((4.0, 4.0), 0.5), near, eps).is_open.any()


def test_equal_frequencies() -> None:
    # x1 + x2 and x1 - x2 obey Mathieu's equation with eps and -eps: the same edges
    eps = [0.01, 0.5, 1.0]
    for damping in (0.0, 0.002):
        both = trace_boundary(coupled_mathieu("sum", (1.0, 1.0), damping=(damping, damping)), 2.0, eps)
        plain = trace_boundary(mathieu(1.0, damping), 2.0, eps)
        assert both.lower == pytest.approx(plain.lower, rel=1e-9)
        assert both.upper == pytest.approx(plain.upper, rel=1e-9)


@pytest.fixture(scope="module")
def plate() -> MovingPlate:
    return MovingPlate(axial_terms=2, lateral_terms=5)


def test_regions_of_the_plate(plate: MovingPlate, references: dict[str, Any]) -> None:
    expected = references["first_order_membrane"]["a/b=1 V=3 f0=10"]
    eps = np.array([0.02, 0.04])
    for pair in ("1+1", "2+2", "3+3"):
        centre, slope = (float(expected[pair][key]) for key in ("centre", "sqrtL"))
        trace = trace_boundary(plate, centre, eps)
        assert f"{trace.resonance.q}+{trace.resonance.p}" == pair
        # few terms: frequencies and widths are within a few per cent of the converged ones
        assert trace.resonance.centre == pytest.approx(centre, rel=0.02)
        assert (trace.upper - trace.lower) / 2 == pytest.approx(slope * eps, rel=0.03)
    for pair in ("1+2", "2+3"):
        trace = trace_boundary(plate, float(expected[pair]["centre"]), eps)
        assert f"{trace.resonance.q}+{trace.resonance.p}" == pair
        assert (trace.kind == Kind.STABLE).all()


def test_narrow_region_of_the_plate(plate: MovingPlate) -> None:
    # 1+3 is a hundred times narrower than 2 omega_1; a grid would need its place first
    trace = trace_boundary(plate, 45.3, [1e-4, 1e-2])
    assert (trace.resonance.q, trace.resonance.p) == (1, 3)
    width = trace.upper - trace.lower
    assert 1e-6 < width[0] < 2e-5
    assert width[1] / width[0] == pytest.approx(100, rel=1e-3)
    assert (trace.lower_error < 1e-9 * trace.lower).all()


def test_narrow_region_among_other_multipliers() -> None:
    # at eps = 1 other multipliers of the plate pass close to the pair 1+3; the edges must not jump to them
    trace = trace_boundary(MovingPlate(), 44.967, [0.9, 0.95, 1.0, 1.05, 1.1])
    for edge in (trace.lower, trace.upper):
        assert np.abs(np.diff(edge, 3)).max() < 1e-4  # the width is 0.09


def test_another_tongue_inside_the_region() -> None:
    # at eps = 0.3 the third tongue of a higher mode passes through the upper edge of 2 omega_2
    trace = trace_boundary(MovingPlate(damping=2e-4), 30.9, [0.28, 0.29, 0.3, 0.31, 0.32])
    assert np.isfinite(trace.lower).all()
    assert np.isfinite(trace.upper).all()
    assert np.abs(np.diff(trace.upper, 2)).max() < 1e-3


def test_difference_type_stays_closed_on_the_plate(plate: MovingPlate) -> None:
    # L_diff < 0 for symmetric F (theory.md, section 5)
    trace = trace_boundary(plate, 26.5, [0.01, 0.1, 0.3])
    assert trace.resonance.type == "difference"
    assert (trace.resonance.p, trace.resonance.q) == (3, 1)
    assert (trace.kind == Kind.STABLE).all()


def test_regions_narrower_than_the_resolution_count_as_closed() -> None:
    # the third tongue of Mathieu's equation at eps = 1e-3 is 1e-10 wide
    assert trace_boundary(mathieu(), 2 / 3, 1e-3).kind[0] == Kind.STABLE


def test_errors_of_edges_in_a_sensitive_case() -> None:
    # faint damping: the edges of a combination resonance depend on the ratio of two tiny decays. In rotated coordinates
    # the system is the same, rounding is not
    plain = coupled_mathieu("sum", damping=(1e-9, 2e-8))
    T = np.array([[0.8, 0.6], [-0.6, 0.8]])
    arrays = (plain.mass, plain.gyroscopic, plain.damping, plain.stiffness, plain.cosine)
    rotated = PeriodicSystem(*[T.T @ S @ T for S in arrays])
    one, other = (trace_boundary(system, 2.7, [0.01, 0.1, 0.3]) for system in (plain, rotated))
    for edge in ("lower", "upper"):
        difference = np.abs(getattr(one, edge) - getattr(other, edge))
        allowed = getattr(one, edge + "_error") + getattr(other, edge + "_error")
        assert (difference <= 3 * allowed).all()
        assert (difference / allowed).max() > 1e-3  # by chance one may be small
        assert (allowed > 1e-8).all()  # more than the resolution of the search


def test_family_is_asked_at_every_frequency() -> None:
    class Family:
        """F grows with Omega: x'' + (1 + eps (Omega / 2)^2 cos Omega t) x = 0."""

        def at(self, Omega: float) -> PeriodicSystem:
            return PeriodicSystem([[1.0]], [[0.0]], [[0.0]], [[1.0]], [[[(Omega / 2) ** 2]]])

    trace = trace_boundary(Family(), 2.0, 0.4)
    for Omega in (trace.lower[0], trace.upper[0]):
        plain = trace_boundary(mathieu(), 2.0, 0.4 * (Omega / 2) ** 2)
        assert min(abs(plain.lower[0] - Omega), abs(plain.upper[0] - Omega)) < 1e-9


def test_results_do_not_depend_on_the_company() -> None:
    system = coupled_mathieu("sum")
    together = trace_boundary(system, 2.7, [0.9, 0.01, 0.3])
    for i, eps in enumerate([0.9, 0.01, 0.3]):
        alone = trace_boundary(system, 2.7, eps)
        assert alone.lower[0] == together.lower[i]
        assert alone.upper_error[0] == together.upper_error[i]
    assert together.eps.tolist() == [0.9, 0.01, 0.3]


@settings(max_examples=15, deadline=None)
@given(st.floats(-0.03, 0.03), st.sampled_from([1, 2, 3]))
def test_near_may_be_a_guess(offset: float, n: int) -> None:
    guessed = trace_boundary(mathieu(), 2 / n * (1 + offset), 0.2)
    exact = trace_boundary(mathieu(), 2 / n, 0.2)
    assert guessed.resonance.j == n
    assert guessed.lower[0] == pytest.approx(exact.lower[0], rel=1e-9)
    assert guessed.near == 2 / n * (1 + offset)


@settings(max_examples=15, deadline=None)
@given(st.integers(0, 10**6), st.integers(2, 3), st.floats(0.01, 0.1))
def test_inside_is_unstable(seed: int, n: int, strength: float) -> None:
    system = random_system(seed, n, 2)
    lowest = np.linalg.eigvalsh(system.stiffness)[0]
    stiffness = system.stiffness + (1 - lowest) * np.eye(n)
    system = PeriodicSystem(
        system.mass, system.gyroscopic, system.damping, stiffness, system.cosine / 5, system.sine / 5
    )
    first = trace_boundary_of_first_mode(system, strength)
    lower, upper = first.lower[0], first.upper[0]
    assume(np.isfinite(upper - lower))  # else regions have met, as where omega_2 = 5 omega_1
    for part in (0.01, 0.5, 0.99):
        assert monodromy(system, lower + part * (upper - lower), strength).kind > Kind.STABLE


def trace_boundary_of_first_mode(system: PeriodicSystem, eps: float) -> BoundaryTrace:
    n = system.size
    upper = -np.linalg.solve(system.mass, np.hstack([system.gyroscopic, system.stiffness]))
    exponents = np.linalg.eigvals(np.vstack([upper, np.eye(n, 2 * n)]))
    return trace_boundary(system, 2 * np.sort(exponents.imag[exponents.imag > 0])[0], eps)


def test_trace_is_frozen() -> None:
    trace = trace_boundary(mathieu(), 2.0, 0.1)
    assert isinstance(trace, BoundaryTrace)
    for name in ("eps", "lower", "upper", "lower_error", "upper_error", "kind"):
        assert getattr(trace, name).shape == (1,)
        assert not getattr(trace, name).flags.writeable
    with pytest.raises(AttributeError):
        trace.lower = np.zeros(1)  # type: ignore[misc]


def test_no_excitation_no_region() -> None:
    assert not trace_boundary(mathieu(), 2.0, 0.0).is_open.any()
    silent = PeriodicSystem([[1.0]], [[0.0]], [[0.0]], [[1.0]], [[[0.0]]])
    assert not trace_boundary(silent, 2.0, [0.1, 1.0]).is_open.any()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"family": None}, "family = None is no system"),
        ({"family": "plate"}, "family = 'plate' is no system"),
        ({"near": 0.0}, "near = 0.0 is out of range"),
        ({"near": math.nan}, "near = nan"),
        ({"near": "2"}, "near = '2' is not a number"),
        (
            {"near": 2.5},
            r"near = 2.5 is not within 5% of any \(omega_p ± omega_q\) / j .* damping included, are 1$",
        ),
        ({"eps": []}, "eps is empty"),
        ({"eps": [0.1, -0.1]}, "eps has the entry -0.1"),
        ({"eps": [0.1, math.nan]}, "eps has the entry nan"),
        ({"eps": "0.1"}, "eps has entries of type"),
        ({"eps": [[0.1]]}, "eps has shape"),
        ({"eps": [[0.1], [0.1, 0.2]]}, "eps is ragged"),
        (
            {"eps": [0.1, 1e9]},
            r"eps has the entry 1000000000\.0, which changes the stiffness .* give amplitudes below 100",
        ),
        ({"eps": None}, "eps has entries of type"),
    ],
)
def test_bad_arguments(arguments: dict[str, Any], message: str) -> None:
    given_: dict[str, Any] = {"family": mathieu(), "near": 2.0, "eps": 0.1} | arguments
    with pytest.raises(ValueError, match=message):
        trace_boundary(**given_)


def test_system_that_does_not_oscillate() -> None:
    with pytest.raises(ValueError, match="natural frequencies, damping included, are none"):
        trace_boundary(mathieu(-1.0), 2.0, 0.1)


@pytest.mark.slow
def test_a_question_is_answered_near_its_frequency() -> None:
    """A plate near its critical speed, unstable at this eps from 0.5 to 36: no search gets lost down at 0.002."""
    load = EdgeLoad.partial(0.5).with_waveform({1: (1, 0), 2: (0.3, Distribution.from_samples([0, 1], [-1, 1]))})
    still = MovingPlate(
        speed=0.0,
        aspect_ratio=3,
        tension=50,
        damping=1e-5,
        inplane="dynamic",
        load=load,
        axial_terms=3,
        lateral_terms=4,
    )
    plate = replace(still, speed=0.97 * still.critical_speed())
    trace = trace_boundary(plate, 3.61, [0.6])
    assert trace.resonance.centre == pytest.approx(3.606, abs=1e-3)
    assert trace.kind[0] > Kind.STABLE
    assert len(trace.intervals[0]) == 1
    assert np.isnan(trace.intervals[0]).all()
    for Omega in (2.5, 7.2):
        assert np.abs(np.linalg.eigvals(dop853(plate.at(Omega), Omega, 0.6))).max() > 2
    with pytest.raises(ValueError, match=r"eps has the entry 5.0"):
        trace_boundary(plate, 3.61, [5.0])
