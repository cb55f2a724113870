"""On an exact boundary neither answer is right, and next to one the error decides.

Any function x without zeros that returns after a period solves x'' + c x' + s(t) x = 0 with s = -(x'' + c x') / x, so
that equation has the multiplier 1, or -1 if x returns with the other sign. By Liouville's theorem the other is the same
without damping, and exp(-c T) with it. For x = exp(g) with a trigonometric polynomial g, s is one too; where its
coefficients are binary fractions the boundary is exact, whatever the computer. Solutions grow and decay by exp(2 k)
inside a period and return, which is what tries the error estimates.
"""

from __future__ import annotations

import numpy as np
import pytest
import scipy.linalg as sla
from hypothesis import given, settings
from hypothesis import strategies as st

from floquet import Kind, monodromy, stability_chart
from periodic import PeriodicSystem
from periodic.examples import mathieu
from tests.sparing import all_but

# Steps that binary numbers hold exactly: those of `make test`, and those of `make test-full` for one point and for a
# chart.
COARSE, FINE, FINE_CHART = 16, 64, 8


def grid(steps: int) -> list[float]:
    """Return k from -4 to 4 in steps of 1 / steps, without 0."""
    return [k / steps for k in range(-4 * steps, 4 * steps + 1) if k]


def hill(mean: float, cosine: list[float], sine: list[float] | None = None, damping: float = 0.0) -> PeriodicSystem:
    """x'' + damping x' + (mean + sum_j cosine[j] cos jt + sine[j] sin jt) x = 0 at Omega = eps = 1."""
    waves = [np.reshape(wave, (-1, 1, 1)) for wave in (cosine, sine or [0.0] * len(cosine))]
    return PeriodicSystem([[1.0]], [[0.0]], [[damping]], [[mean]], *waves)


def exponential(a: list[float], b: list[float], damping: float = 0.0) -> PeriodicSystem:
    """The equation that x = exp(g), g = sum_j a[j-1] cos jt + b[j-1] sin jt, solves: mu = 1."""
    J = len(a)
    g = np.zeros(2 * J + 1, complex)  # Fourier coefficients from -J to J
    g[J + 1 :] = (np.array(a) - 1j * np.array(b)) / 2
    g[:J] = g[:J:-1].conj()
    slope = 1j * np.arange(-J, J + 1) * g
    s = -np.convolve(slope, slope)  # x'' / x = g'' + g'^2
    s[J : 3 * J + 1] -= 1j * np.arange(-J, J + 1) * slope + damping * slope
    waves = 2 * s[2 * J + 1 :]
    return hill(float(s[2 * J].real), list(waves.real), list(-waves.imag), damping)


# x = exp(-k cos t); cos(t / 2) exp(k cos t); sin(t / 2) exp(k cos t); exp(-k cos t) with damping
FAMILIES = {
    "plus": lambda k: hill(-k * k / 2, [-k, k * k / 2]),
    "minus, even": lambda k: hill(0.25 - k - k * k / 2, [2 * k, k * k / 2]),
    "minus, odd": lambda k: hill(0.25 + k - k * k / 2, [2 * k, k * k / 2]),
    "damped": lambda k: hill(-k * k / 2, [-k, k * k / 2], [-0.25 * k, 0.0], 0.25),
    "more damped": lambda k: hill(-k * k / 2, [-k, k * k / 2], [-k, 0.0], 1.0),
}


@pytest.mark.parametrize("steps", [COARSE, pytest.param(FINE, marks=pytest.mark.slow)])
@pytest.mark.parametrize("name", all_but(["plus", "minus, odd"], FAMILIES))
def test_monodromy_decides_nothing_on_a_boundary(name: str, steps: int) -> None:
    exact = -1 if name.startswith("minus") else 1
    for k in grid(steps):
        found = monodromy(FAMILIES[name](k), 1.0, 1.0)
        assert found.kind == Kind.UNDECIDED, k
        # log|mu| of the critical multiplier is 0
        assert abs(found.growth_rate) * 2 * np.pi <= found.log_modulus_error, k
        # known even so, while rounding is amplified by less than 1e7; a double one to the root of its error
        if abs(k) < 2 and 8 * k % 1 == 0:
            assert np.abs(found.multipliers - exact).min() < 1e-4, k


@pytest.mark.parametrize("name", FAMILIES)
@pytest.mark.parametrize("k", [-12.0, -9.5, -6.5, 5.25, 8.5, 11.0])
def test_monodromy_decides_nothing_where_rounding_has_eaten_everything(name: str, k: float) -> None:
    assert monodromy(FAMILIES[name](k), 1.0, 1.0).kind == Kind.UNDECIDED


sixteenths = st.integers(-16, 16).map(lambda i: i / 16)


@settings(max_examples=100, deadline=None)
@given(st.lists(st.tuples(sixteenths, sixteenths), min_size=1, max_size=4), st.sampled_from([0.0, 0.25, 1.0]))
def test_monodromy_decides_nothing_on_random_boundaries(g: list[tuple[float, float]], damping: float) -> None:
    a, b = (list(values) for values in zip(*g, strict=True))
    found = monodromy(exponential(a, b, damping), 1.0, 1.0)
    # g = 0 without damping is x'' = 0: a rigid motion, which is set apart and not judged
    rigid = not (any(a) or any(b) or damping)
    assert (found.rigid, found.kind) == ((1, Kind.STABLE) if rigid else (0, Kind.UNDECIDED))


@pytest.mark.parametrize("k", [0.5, 1.75, 2.875, 2.9375, -2.8125])
@pytest.mark.parametrize("name", FAMILIES)
def test_monodromy_finds_the_boundary_among_other_coordinates(name: str, k: float) -> None:
    critical, calm = FAMILIES[name](k), mathieu(9.3125, damping=0.5)
    assert monodromy(calm, 1.0, 1.0).kind == Kind.STABLE
    T = np.array([[1.0, 0.5], [-0.25, 1.0]])  # every product below is exact

    def joint(first: np.ndarray, second: np.ndarray) -> np.ndarray:
        return T.T @ sla.block_diag(first, second) @ T

    zero = np.zeros((1, 1))
    M, G, C, K = (
        joint(getattr(critical, part), getattr(calm, part)) for part in ("mass", "gyroscopic", "damping", "stiffness")
    )
    cosine = [joint(critical.cosine[0], calm.cosine[0]), joint(critical.cosine[1], zero)]
    system = PeriodicSystem(M, G, C, K, cosine, [joint(sine, zero) for sine in critical.sine])
    assert monodromy(system, 1.0, 1.0).kind == Kind.UNDECIDED


@pytest.mark.parametrize("steps", [FINE_CHART // 2, pytest.param(FINE_CHART, marks=pytest.mark.slow)])
def test_chart_decides_nothing_on_a_boundary(steps: int) -> None:
    decided = []
    for name, family in FAMILIES.items():
        for k in grid(steps):
            chart = stability_chart(family(k), [1.0], [1.0], n_jobs=1, progress=False)
            if chart.kind[0, 0] != Kind.UNDECIDED:
                decided.append((name, k, Kind(chart.kind[0, 0]).name))
    assert not decided


def test_a_meeting_of_multipliers_within_the_error_is_not_called_unstable() -> None:
    # This point is proved stable in ball arithmetic; its two multipliers meet within the error of the matrix.
    assert monodromy(mathieu(), 1.7443588168468573, 0.5).kind == Kind.UNDECIDED


@pytest.mark.parametrize("strength", [1.0, 30.0, 1000.0])
@pytest.mark.parametrize("rows", all_but([12], [2, 12]))
def test_chart_grows_nothing_without_excitation(strength: float, rows: int) -> None:
    # at Omega = 2 / k both multipliers are (-1)^k at eps = 0, and strong excitation, at the other amplitudes, asks for
    # many steps
    for k in (1, 4, 19, 31, 39):
        system = PeriodicSystem([[1.0]], [[0.0]], [[0.0]], [[1.0]], [[[strength]]])
        chart = stability_chart(system, [2 / k], np.linspace(0.0, 1.0, rows), n_jobs=1, progress=False, audit=0)
        assert chart.kind[0, 0] in (Kind.STABLE, Kind.UNDECIDED)
