"""Waveforms: values, slopes, Fourier coefficients and their bounds, jumps, and what is refused."""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import iv

from periodic import waveforms
from periodic.waveforms import Piecewise, Waveform

SMOOTH_AND_NOT: dict[str, Any] = {
    "cosine": waveforms.cosine(3, phase=0.1),
    "sine": waveforms.sine(2),
    "constant": waveforms.constant(),
    "rectangular": waveforms.rectangular(0.3, phase=0.85),
    "triangle": waveforms.triangle(),
    "sawtooth": waveforms.sawtooth(),
    "function": waveforms.function(lambda theta: math.exp(math.cos(theta))),
    "rectified": waveforms.function(lambda theta: abs(math.sin(theta)), jumps=[0, 0.5]),
}


def between_jumps(waveform: Waveform, count: int = 7) -> np.ndarray:
    """Phases in radians, the same number in every segment and none at a jump."""
    ends = [*sorted({0.0, *waveform.jumps}), 1.0]
    parts = (np.arange(count) + 0.5) / count
    return 2 * np.pi * np.concatenate([a + (b - a) * parts for a, b in pairwise(ends)])


@pytest.mark.parametrize(
    ("made", "formula"),
    [
        (waveforms.constant(), lambda x: 1.0),
        (waveforms.cosine(), lambda x: math.cos(2 * math.pi * x)),
        (waveforms.cosine(3, phase=0.1), lambda x: math.cos(6 * math.pi * (x - 0.1))),
        (waveforms.sine(2), lambda x: math.sin(4 * math.pi * x)),
        (waveforms.rectangular(0.3, phase=0.85), lambda x: 1.0 if (x - 0.85) % 1 < 0.3 else -1.0),
        (waveforms.triangle(), lambda x: 4 * abs(x % 1 - 0.5) - 1),
        (waveforms.sawtooth(), lambda x: 2 * (x % 1) - 1),
        (SMOOTH_AND_NOT["function"], lambda x: math.exp(math.cos(2 * math.pi * x))),
        (SMOOTH_AND_NOT["rectified"], lambda x: abs(math.sin(2 * math.pi * x))),
        (waveforms.samples(np.cos(2 * np.pi * np.arange(12) / 12 - 0.4)), lambda x: math.cos(2 * math.pi * x - 0.4)),
    ],
)
def test_values(made: Any, formula: Callable[[float], float]) -> None:
    theta = between_jumps(made)
    for turns in (0, -3, 5):
        np.testing.assert_allclose(
            made.values(theta + 2 * np.pi * turns), [formula(t / (2 * np.pi)) for t in theta], rtol=0, atol=3e-14
        )


@pytest.mark.parametrize("name", SMOOTH_AND_NOT)
def test_derivative_is_the_limit_of_differences(name: str) -> None:
    made = SMOOTH_AND_NOT[name]
    theta = between_jumps(made)
    h = 1e-5
    differences = (made.values(theta + h) - made.values(theta - h)) / (2 * h)
    np.testing.assert_allclose(made.derivative(theta), differences, rtol=0, atol=2e-9)


@pytest.mark.parametrize("name", SMOOTH_AND_NOT)
def test_fourier_coefficients_are_the_integrals(name: str) -> None:
    made = SMOOTH_AND_NOT[name]
    c, s, _ = made.fourier(5)
    ends = 2 * np.pi * np.array([*sorted({0.0, *made.jumps}), 1.0])
    for j in range(6):
        for found, wave in ((c[j], np.cos), (s[j], np.sin)):
            parts = [
                quad(lambda t, j=j, wave=wave: made.values(t) * wave(j * t), a, b, epsabs=1e-13)[0]
                for a, b in pairwise(ends)
            ]
            assert found == pytest.approx(sum(parts) / np.pi / (1 if j else 2), abs=2e-11)


@pytest.mark.parametrize("name", SMOOTH_AND_NOT)
@pytest.mark.parametrize("J", [0, 1, 4, 20, 100])
def test_what_a_truncation_leaves_out_is_below_its_bound(name: str, J: int) -> None:
    made = SMOOTH_AND_NOT[name]
    c, s, bound = made.fourier(J)
    theta = 2 * np.pi * (np.arange(4000) + 0.5) / 4000
    turned = np.outer(theta, np.arange(J + 1))
    left = made.values(theta) - np.cos(turned) @ c - np.sin(turned) @ s
    measured = float(np.sqrt((left**2).mean())) if isinstance(made, Piecewise) else float(np.abs(left).max())
    assert measured <= bound + 1e-13
    assert bound <= 30 * measured + 2e-14  # and no idle one


def test_a_smooth_function_has_the_coefficients_of_the_modified_bessel_functions() -> None:
    c, s, _ = SMOOTH_AND_NOT["function"].fourier(8)
    np.testing.assert_allclose(c, iv(np.arange(9), 1.0) * np.r_[1, 2 * np.ones(8)], atol=1e-15)
    np.testing.assert_allclose(s, 0, atol=1e-15)


def test_equal_waveforms_are_equal() -> None:
    assert waveforms.cosine(2) == waveforms.cosine(2, phase=1.0)
    assert hash(waveforms.rectangular(0.3)) == hash(waveforms.rectangular(0.3))
    assert waveforms.rectangular(0.3) != waveforms.rectangular(0.31)
    assert waveforms.cosine(1, phase=0.25) == waveforms.sine(1)


def test_impulses_at_one_phase_are_added() -> None:
    assert waveforms.impulses([0.5, 1.5, 0.25], [1.0, 2.0, 5.0]) == waveforms.Impulses((0.25, 0.5), (5.0, 3.0))
    c, s, bound = waveforms.impulses([0.25], [2.0]).fourier(2)
    np.testing.assert_allclose(c, np.array([1, 0, -2]) / np.pi, atol=1e-15)
    np.testing.assert_allclose(s, np.array([0, 2, 0]) / np.pi, atol=1e-15)
    assert bound == math.inf


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (lambda: waveforms.cosine(0), r"^j = 0"),
        (lambda: waveforms.sine(1.5), r"^j = 1.5"),
        (lambda: waveforms.rectangular(1.0), r"^duty = 1.0 is out of range"),
        (lambda: waveforms.samples([1.0, 2.0]), r"^values has 2 entries"),
        (
            lambda: waveforms.samples(np.sign(np.sin(np.arange(200) / 200 * 2 * np.pi + 0.01))),
            r"too few: the last third",
        ),
        (lambda: waveforms.samples(np.cos(2 * np.pi * 5 * np.arange(12) / 12)), r"too few: the last third"),
        (lambda: waveforms.function(3.0), r"^g = 3.0 is not callable"),
        (lambda: waveforms.function(lambda theta: theta), r"^g has no period 2 pi"),
        (lambda: waveforms.function(lambda theta: math.cos(theta / 2)), r"^g has no period 2 pi"),
        (lambda: waveforms.function(lambda theta: math.nan), r"^g\(.*out of range"),
        (lambda: waveforms.function(lambda theta: abs(math.sin(theta))), r"^g is not smooth.*name in jumps"),
        (lambda: waveforms.function(lambda theta: abs(math.sin(theta)), [0.3]), r"^g is not smooth near theta"),
        (lambda: waveforms.impulses([], []), r"^weights has shape"),
        (lambda: waveforms.impulses([0.1, 0.2], [1.0]), r"^weights has shape \(1,\) and phases \(2,\)"),
    ],
)
def test_refusals(make: Callable[[], Waveform], says: str) -> None:
    with pytest.raises(ValueError, match=says):
        make()


def test_a_function_that_is_constant_between_jumps_is_so_exactly() -> None:
    """A mesh of teeth: rounding of the fit would turn one exponential for each piece into many steps."""
    teeth, duty = 23, 0.6
    starts = np.arange(teeth) / teeth

    def mesh(theta: float) -> float:
        return 1.0 if (theta / (2 * np.pi) * teeth) % 1.0 < duty else -duty / (1 - duty)

    found = waveforms.function(mesh, np.sort(np.concatenate([starts, starts + duty / teeth])))
    assert isinstance(found, waveforms.Piecewise)
    assert found.is_constant_between_jumps
    assert len(found.pieces) == 2 * teeth
    assert {piece[0] for piece in found.pieces} == {1.0, -duty / (1 - duty)}
