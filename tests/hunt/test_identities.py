"""What must be true of any system, held against both integrators: changes that leave multipliers alone.

Where a change of coordinates, units, direction or origin of time cannot matter, a difference beyond the error
estimates is a fault, and so is "stable" on one side against "unstable" on the other. `test_monodromy.py` has the
identities of the whole matrix (Liouville, symplecticity, reciprocal pairs, the exponential at eps = 0),
`test_doubling.py` and `test_oracle_taylor.py` the orders of convergence.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pytest
import scipy.linalg as sla
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from floquet import Kind, monodromy, stability_chart
from periodic import PeriodicSystem
from plate import Distribution, MovingPlate
from tests.strategies import amplitudes, arrays, frequencies, join, plates, seeds, systems, transformed

some = settings(
    max_examples=20, deadline=None, suppress_health_check=[HealthCheck.too_slow, HealthCheck.filter_too_much]
)


class Found(NamedTuple):
    log_modulus: float  # in one period
    error: float
    kind: int


def point(system: PeriodicSystem | MovingPlate, Omega: float, eps: float) -> Found:
    found = monodromy(system, Omega, eps)
    return Found(found.growth_rate * 2 * np.pi / Omega, found.log_modulus_error, int(found.kind))


def cell(system: PeriodicSystem | MovingPlate, Omega: float, eps: float) -> Found:
    chart = stability_chart(system, [Omega], [eps], n_jobs=1, progress=False, audit=0)
    log_modulus = chart.growth_rate[0, 0] * 2 * np.pi / Omega
    return Found(float(log_modulus), float(chart.error[0, 0]), int(chart.kind[0, 0]))


Integrator = Callable[[PeriodicSystem | MovingPlate, float, float], Found]
both = pytest.mark.parametrize("integrate", [point, cell])
resonant_or_not = pytest.mark.filterwarnings("ignore::plate.dynamic.InPlaneResonanceWarning")


def assert_same(one: Found, other: Found, *, factor: float = 1.0, shift: float = 0.0) -> None:
    """The multipliers of ``other`` are those of ``one`` to the power ``factor``, times exp(shift)."""
    expected = factor * one.log_modulus + shift
    # the changed system is rounded anew, which moves its multipliers as an error of the integration would
    allowance = 10 * (factor * one.error + other.error) + 1e-12 * (1 + abs(expected))
    assert abs(other.log_modulus - expected) <= allowance
    if shift == 0:
        assert {one.kind > Kind.STABLE, other.kind > Kind.STABLE} != {True, False} or Kind.UNDECIDED in (
            one.kind,
            other.kind,
        )


def delayed(system: PeriodicSystem, phase: float) -> PeriodicSystem:
    """The system with the origin of time moved by phase / Omega."""
    j = np.arange(1, system.harmonics + 1)[:, None, None] * phase
    F, S = system.cosine, system.sine
    return PeriodicSystem(*arrays(system)[:4], np.cos(j) * F + np.sin(j) * S, np.cos(j) * S - np.sin(j) * F)


@both
@some
@given(systems(4), frequencies, amplitudes, st.floats(0, 2 * np.pi))
def test_origin_of_time(integrate: Integrator, system: PeriodicSystem, Omega: float, eps: float, phase: float) -> None:
    assert_same(integrate(system, Omega, eps), integrate(delayed(system, phase), Omega, eps))


@both
@some
@given(systems(4), frequencies, amplitudes)
def test_half_a_period_later_odd_harmonics_change_sign(
    integrate: Integrator, system: PeriodicSystem, Omega: float, eps: float
) -> None:
    sign = (-1.0) ** np.arange(1, system.harmonics + 1)[:, None, None]
    later = PeriodicSystem(*arrays(system)[:4], sign * system.cosine, sign * system.sine)
    assert_same(integrate(system, Omega, eps), integrate(later, Omega, eps))
    odd = PeriodicSystem(*arrays(system)[:4], (sign < 0) * system.cosine, (sign < 0) * system.sine)
    assert_same(integrate(odd, Omega, eps), integrate(odd, Omega, -eps))


@both
@some
@given(systems(4), frequencies, amplitudes, st.floats(1e-3, 1e3), st.floats(1e-3, 1e3), st.floats(1e-3, 1e3))
def test_units_of_time_mass_and_amplitude(
    integrate: Integrator, system: PeriodicSystem, Omega: float, eps: float, time: float, mass: float, amplitude: float
) -> None:
    M, G, C, K, Fc, Fs = (mass * S for S in arrays(system))
    F = time**2 / amplitude * Fc, time**2 / amplitude * Fs
    changed = PeriodicSystem(M, time * G, time * C, time**2 * K, *F)
    assert_same(integrate(system, Omega, eps), integrate(changed, time * Omega, amplitude * eps))


@both
@some
@given(systems(4), frequencies, amplitudes, seeds)
def test_coordinates(integrate: Integrator, system: PeriodicSystem, Omega: float, eps: float, seed: int) -> None:
    n, random = system.size, np.random.default_rng(seed)
    order = np.eye(n)[random.permutation(n)]
    turn = sla.qr(random.standard_normal((n, n)))[0] @ np.diag(random.uniform(0.5, 2.0, n))
    expected = integrate(system, Omega, eps)
    for T in (order, turn):
        assert_same(expected, integrate(transformed(system, T), Omega, eps))


@both
@some
@given(systems(2), systems(2), frequencies, amplitudes, seeds)
def test_independent_systems_side_by_side(
    integrate: Integrator, first: PeriodicSystem, second: PeriodicSystem, Omega: float, eps: float, seed: int
) -> None:
    whole = join(first, second)
    mixed = transformed(whole, sla.qr(np.random.default_rng(seed).standard_normal((whole.size, whole.size)))[0])
    parts = [integrate(part, Omega, eps) for part in (first, second)]
    union = Found(max(p.log_modulus for p in parts), max(p.error for p in parts), max(p.kind for p in parts))
    if Kind.UNDECIDED in {p.kind for p in parts}:
        union = union._replace(kind=Kind.UNDECIDED)
    for system in (whole, mixed):
        assert_same(union, integrate(system, Omega, eps))


@some
@given(systems(2), systems(2), st.floats(1.0, 8.0), st.floats(-1.0, 1.0))
def test_multipliers_of_the_union(first: PeriodicSystem, second: PeriodicSystem, Omega: float, eps: float) -> None:
    parts = [monodromy(part, Omega, eps).matrix for part in (first, second)]
    joint = monodromy(join(first, second), Omega, eps)
    # coefficients of the characteristic polynomial: well-conditioned where multipliers meet
    expected = np.polymul(*(np.poly(matrix) for matrix in parts))
    scale = np.prod([1 + np.linalg.norm(matrix) for matrix in parts]) ** 4
    np.testing.assert_allclose(np.poly(joint.matrix), expected, atol=1e-11 * scale)


@both
@some
@given(systems(4), frequencies, amplitudes)
def test_the_adjoint_system_backwards(integrate: Integrator, system: PeriodicSystem, Omega: float, eps: float) -> None:
    """z'' M - (G + C)^T z' + S(t)^T z = 0 has the inverse multipliers; with time reversed, the same."""
    M, G, C, K, Fc, Fs = arrays(system)
    adjoint = PeriodicSystem(M, -G, C, K.T, Fc.transpose(0, 2, 1), -Fs.transpose(0, 2, 1))
    assert_same(integrate(system, Omega, eps), integrate(adjoint, Omega, eps))


@both
@some
@given(systems(4, damping=0.0, symmetric=True), frequencies, amplitudes)
def test_reciprocity(integrate: Integrator, system: PeriodicSystem, Omega: float, eps: float) -> None:
    """What grows forwards in a conservative system grows as much backwards, and nothing decays without growth."""
    M, G, C, K, Fc, Fs = arrays(system)
    forwards, backwards = integrate(system, Omega, eps), integrate(PeriodicSystem(M, -G, C, K, Fc, -Fs), Omega, eps)
    assert_same(forwards, backwards)
    assert forwards.log_modulus >= -forwards.error


@both
@some
@given(systems(4), frequencies, amplitudes)
def test_nothing_decays_faster_than_liouville_allows(
    integrate: Integrator, system: PeriodicSystem, Omega: float, eps: float
) -> None:
    found = integrate(system, Omega, eps)
    mean = -np.trace(np.linalg.solve(system.mass, system.damping)) / (2 * system.size) * 2 * np.pi / Omega
    assert found.log_modulus >= mean - 3 * found.error - 1e-12
    if system.size == 1 and found.kind == Kind.STABLE and found.log_modulus < mean + 1e-3:
        assert found.log_modulus == pytest.approx(mean, abs=3 * found.error + 1e-12)  # a pair of one modulus


@both
@some
@given(systems(4, gyroscopic=False, damping=0.0), frequencies, amplitudes, st.floats(0.01, 2.0))
def test_damping_in_proportion_to_mass_shifts_everything(
    integrate: Integrator, system: PeriodicSystem, Omega: float, eps: float, c: float
) -> None:
    """W = exp(-c t / 2) x leaves M x'' + (K - c^2/4 M + ...) x = 0."""
    M, G, C, K, Fc, Fs = arrays(system)
    plain, damped = PeriodicSystem(M, G, C, K - c**2 / 4 * M, Fc, Fs), PeriodicSystem(M, G, c * M, K, Fc, Fs)
    assert_same(integrate(plain, Omega, eps), integrate(damped, Omega, eps), shift=-c * np.pi / Omega)


@both
@some
@given(systems(3, harmonics=2), st.floats(1.0, 8.0), st.floats(-1.0, 1.0), st.integers(2, 3))
def test_harmonics_of_a_lower_frequency(
    integrate: Integrator, system: PeriodicSystem, Omega: float, eps: float, m: int
) -> None:
    """Harmonics m, 2 m of Omega / m are the harmonics 1, 2 of Omega; the period is m times as long."""
    n, J = system.size, system.harmonics
    cosine, sine = np.zeros((2, m * J, n, n))
    cosine[m - 1 :: m], sine[m - 1 :: m] = system.cosine, system.sine
    slower = PeriodicSystem(*arrays(system)[:4], cosine, sine)
    assert_same(integrate(system, Omega, eps), integrate(slower, Omega / m, eps), factor=m)


@both
@resonant_or_not
@some
@given(plates(), st.floats(10.0, 80.0), st.floats(0.0, 0.5))
def test_a_plate_in_the_mirror(integrate: Integrator, plate: MovingPlate, Omega: float, eps: float) -> None:
    """x -> a - x turns V into -V: sines change by (-1)^(k + 1), and nothing else happens."""
    system, other = plate.at(Omega), replace(plate, speed=-plate.speed).at(Omega)
    parity = np.repeat((-1.0) ** np.arange(plate.terms.axial), plate.terms.lateral)
    for one, two in zip(arrays(transformed(system, np.diag(parity))), arrays(other), strict=True):
        np.testing.assert_allclose(one, two, atol=1e-11 * np.abs(system.stiffness).max())
    assert_same(integrate(system, Omega, eps), integrate(other, Omega, eps))


@both
@resonant_or_not
@some
@given(plates(), st.floats(10.0, 80.0), st.floats(0.0, 0.5))
def test_a_plate_upside_down(integrate: Integrator, plate: MovingPlate, Omega: float, eps: float) -> None:
    """y -> b - y mirrors the load."""

    def mirrored(d: Distribution) -> Distribution:
        sign = [[(-1) ** i * c for i, c in enumerate(row)] for row in d.coefficients]
        return Distribution(tuple(1 - y for y in d.breaks[::-1]), tuple(map(tuple, sign[::-1])))

    load = plate.load
    parts = {"f_c": tuple(map(mirrored, load.f_c)), "f_s": tuple(map(mirrored, load.f_s))}
    other = replace(plate, load=replace(load, static=mirrored(load.static), **parts))
    assert_same(integrate(plate, Omega, eps), integrate(other, Omega, eps))


@some
@given(plates(damping=0.0, inplane="membrane", speed=0.0))
def test_frequencies_and_the_divergence_speed_fall_as_terms_are_added(plate: MovingPlate) -> None:
    """Rayleigh-Ritz: a larger space of trial functions never raises a minimum."""

    def frequencies_at_rest(plate: MovingPlate) -> np.ndarray:
        system = plate.at(1.0)
        return np.sqrt(sla.eigh(system.stiffness, system.mass, eigvals_only=True))

    few = frequencies_at_rest(plate)
    for more in (
        replace(plate, axial_terms=plate.terms.axial + 1),
        replace(plate, lateral_terms=plate.terms.lateral + 1),
    ):
        assert (frequencies_at_rest(more)[: len(few)] <= few * (1 + 1e-11)).all()
        assert more.critical_speed() <= plate.critical_speed() * (1 + 1e-11)


@some
@given(plates(speed=0.0), st.booleans())
def test_inplane_frequencies_fall_as_terms_are_added(plate: MovingPlate, axial: bool) -> None:
    terms = (6, 4) if axial else (5, 5)
    more = replace(plate, inplane_terms=terms).inplane_frequencies()
    for few, many in zip(plate.inplane_frequencies(), more, strict=True):
        assert (many[: len(few)] <= few * (1 + 1e-10)).all()


@settings(max_examples=10, deadline=None)
@given(systems(4), frequencies, st.floats(-1.0, 1.0))
def test_a_tighter_tolerance_is_never_worse(system: PeriodicSystem, Omega: float, eps: float) -> None:
    exact = monodromy(system, Omega, eps)
    size = max(1.0, float(np.linalg.norm(exact.matrix, 2)))
    tolerances = (1e-3, 1e-5, 1e-7, 1e-9)
    found = [monodromy(system, Omega, eps, tolerance=tolerance) for tolerance in tolerances]
    errors = [np.linalg.norm(f.matrix - exact.matrix, 2) / size for f in found]
    # steps are of equal length: what changes is the number of terms, by whole ones
    for worse, better, f in zip(errors, errors[1:], found[1:], strict=False):
        assert better <= worse + 3 * f.error
    for error, tolerance, f in zip(errors, tolerances, found, strict=True):
        assert error <= 3 * f.error + 1e-13
        assert f.error <= max(tolerance, 1e-10)
