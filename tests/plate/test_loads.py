"""Edge loads: shapes of mean 1, waveforms by their Fourier series, bad input."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad
from scipy.signal import sawtooth, square

from plate import Distribution, EdgeLoad

y = np.linspace(0, 1, 101)

LOADS = {
    "uniform": EdgeLoad.uniform(),
    "linear": EdgeLoad.linear(3.0, 1.0),
    "bending": EdgeLoad.linear(-1.0, 2.0),
    "partial": EdgeLoad.partial(0.3, centre=0.2),
    "parabolic": EdgeLoad.parabolic(edge=0.4),
    "cosine": EdgeLoad.cosine(edge=-0.2),
    "samples": EdgeLoad.from_samples([0.0, 0.3, 1.0], [4.0, 5.0, 1.0]),
}


@pytest.mark.parametrize("load", LOADS.values(), ids=LOADS)
def test_every_shape_has_mean_one(load: EdgeLoad) -> None:
    assert load.static.mean == pytest.approx(1.0, rel=1e-14)
    assert load.harmonics == 1
    assert load.f_c == (load.static,)
    assert not load.f_s[0](y).any()


def test_uniform_is_the_limit_of_every_shape() -> None:
    ones = np.ones_like(y)
    for load in (EdgeLoad.linear(2.0, 2.0), EdgeLoad.partial(1.0), EdgeLoad.parabolic(1.0), EdgeLoad.cosine(1.0)):
        np.testing.assert_allclose(load.static(y), ones, rtol=1e-14)


def test_linear_keeps_the_ratio_of_the_edges() -> None:
    np.testing.assert_allclose(EdgeLoad.linear(1.0, 3.0).static(y), 0.5 + y, rtol=1e-14)


@settings(max_examples=30, deadline=None)
@given(st.floats(0.001, 1.0), st.floats(0.0, 1.0))
def test_partial_is_flat_where_loaded(width: float, place: float) -> None:
    centre = width / 2 + place * (1 - width)
    f = EdgeLoad.partial(width, centre).static
    inside = np.abs(y - centre) < width / 2 - 1e-9
    outside = np.abs(y - centre) > width / 2 + 1e-9
    np.testing.assert_allclose(f(y)[inside], 1 / width, rtol=1e-12)
    np.testing.assert_array_equal(f(y)[outside], 0.0)
    assert f.projection(2)[1] == pytest.approx(np.sqrt(3) * (2 * centre - 1), abs=1e-9)  # first moment


def test_arches_take_the_given_value_at_the_edges() -> None:
    for edge in (0.0, 0.4, 2.0):
        np.testing.assert_allclose(EdgeLoad.parabolic(edge).static(y), edge + (1 - edge) * 6 * y * (1 - y), atol=1e-13)
        np.testing.assert_allclose(
            EdgeLoad.cosine(edge).static(y), edge + (1 - edge) * np.pi / 2 * np.sin(np.pi * y), atol=1e-13
        )


def test_samples_may_have_any_unit() -> None:
    values = np.array([200.0, 400.0, 100.0])
    load = EdgeLoad.from_samples([0.0, 0.5, 1.0], values)
    np.testing.assert_allclose(load.static([0.0, 0.5, 1.0]), values / 275.0, rtol=1e-14)


WAVES: dict[str, Any] = {
    "cosine": np.cos,
    "square": lambda t: square(t + np.pi / 2),
    "triangle": lambda t: -sawtooth(t, 0.5),
    "sawtooth": lambda t: sawtooth(t + np.pi),
}


@pytest.mark.parametrize("name", WAVES)
def test_named_waveforms_are_fourier_series(name: str) -> None:
    load = EdgeLoad.linear(1.0, 2.0).with_waveform(name, harmonics=6)
    jumps = [np.pi / 2, np.pi, 3 * np.pi / 2]
    for j in range(1, 7):
        waves: list[tuple[Any, Any]] = [(load.f_c, np.cos), (load.f_s, np.sin)]
        for distributions, function in waves:
            coefficient = (
                quad(lambda t, j=j, g=function: WAVES[name](t) * g(j * t), 0, 2 * np.pi, points=jumps)[0] / np.pi
            )
            np.testing.assert_allclose(distributions[j - 1](y), coefficient * load.static(y), atol=1e-7)  # quad's own


def test_default_numbers_of_harmonics() -> None:
    load = EdgeLoad.uniform()
    assert load.with_waveform("cosine") == load
    assert load.with_waveform("square").harmonics == 5
    assert load.with_waveform({3: (1.0, 0.0)}).harmonics == 3
    assert load.with_waveform({1: (1.0, 0.0)}, harmonics=4).harmonics == 4


def test_each_harmonic_has_distributions_of_its_own() -> None:
    bending = Distribution.from_samples([0.0, 1.0], [-1.0, 1.0])
    static, half = EdgeLoad.parabolic(), EdgeLoad.partial(0.5, centre=0.25)
    load = static.with_waveform({3: (bending, 2), 1: (half, -0.5)})
    assert load.static == static.static
    assert load.harmonic(0) == (static.static, 0 * static.static)
    assert load.harmonic(1) == (half.static, -0.5 * static.static)
    assert load.harmonic(2) == (0 * static.static, 0 * static.static)
    assert load.harmonic(3) == (bending, 2 * static.static)


def test_a_waveform_replaces_the_one_before() -> None:
    load = EdgeLoad.partial(0.3)
    assert load.with_waveform("square").with_waveform("cosine") == load


@pytest.mark.parametrize(
    ("waveform", "harmonics", "message"),
    [
        ("sine", None, "waveform = 'sine'"),
        (3, None, "waveform = 3"),
        (None, None, "waveform = None"),
        ({}, None, "waveform is empty"),
        ({0: (1.0, 0.0)}, None, "harmonic = 0"),
        ({-1: (1.0, 0.0)}, None, "harmonic = -1"),
        ({1.5: (1.0, 0.0)}, None, "harmonic = 1.5"),
        ({"1": (1.0, 0.0)}, None, "harmonic = '1'"),
        ({10**9: (1.0, 0.0)}, None, "harmonic = 1000000000"),
        ({1: 1.0}, None, r"waveform\[1\] = 1.0"),
        ({1: (1.0,)}, None, r"waveform\[1\]"),
        ({1: (1.0, 0.0, 0.0)}, None, r"waveform\[1\]"),
        ({1: ("a", 0.0)}, None, r"waveform\[1\]\[0\]"),
        ({1: (1.0, np.nan)}, None, r"waveform\[1\]\[1\]"),
        ({1: (1.0, np.inf)}, None, r"waveform\[1\]\[1\]"),
        ({1: (None, 0.0)}, None, r"waveform\[1\]\[0\]"),
        ({2: (1.0, 0.0)}, 1, "harmonics >= 2"),
        ("square", 0, "harmonics = 0"),
        ("square", 2.0, "harmonics = 2.0"),
        ("square", 10**9, "harmonics = 1000000000"),
    ],
)
def test_bad_waveforms_are_refused(waveform: Any, harmonics: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        EdgeLoad.uniform().with_waveform(waveform, harmonics)


@pytest.mark.parametrize(
    ("build", "message"),
    [
        (lambda: EdgeLoad.linear(-1.0, 1.0), "mean 0"),
        (lambda: EdgeLoad.linear(-3.0, 1.0), "mean -1"),
        (lambda: EdgeLoad.linear(0, 0), "mean 0"),
        (lambda: EdgeLoad.linear("a", 1.0), "left = 'a'"),
        (lambda: EdgeLoad.linear(1.0, np.inf), "right = inf"),
        (lambda: EdgeLoad.linear(1.0, np.nan), "right = nan"),
        (lambda: EdgeLoad.partial(0.0), "width = 0"),
        (lambda: EdgeLoad.partial(-0.5), "width = -0.5"),
        (lambda: EdgeLoad.partial(1.5), "width = 1.5"),
        (lambda: EdgeLoad.partial(0.5, centre=0.1), "centre = 0.1"),
        (lambda: EdgeLoad.partial(0.5, centre=0.9), "centre = 0.9"),
        (lambda: EdgeLoad.partial(0.5, centre=np.nan), "centre = nan"),
        (lambda: EdgeLoad.partial(1e-15), "width = 1e-15"),
        (lambda: EdgeLoad.uniform().harmonic(-1), "j = -1"),
        (lambda: EdgeLoad.uniform().harmonic(2), "j = 2"),
        (lambda: EdgeLoad.uniform().static([[0.5], [0.1, 0.2]]), "y"),
        (lambda: EdgeLoad.partial(True), "width = True"),
        (lambda: EdgeLoad.parabolic(np.inf), "edge = inf"),
        (lambda: EdgeLoad.parabolic("0"), "edge = '0'"),
        (lambda: EdgeLoad.cosine(np.nan), "edge = nan"),
        (lambda: EdgeLoad.from_samples([0, 1], [1, -1]), "mean 0"),
        (lambda: EdgeLoad.from_samples([0, 0.5], [1, 1]), "y runs from 0 to 0.5"),
        (lambda: EdgeLoad.from_samples([], []), "y is empty"),
        (lambda: EdgeLoad("uniform"), "static = 'uniform'"),
        (lambda: EdgeLoad(EdgeLoad.uniform()), "static = "),
        (lambda: EdgeLoad(EdgeLoad.uniform().static, (1.0,), (2.0,)), "f_c = "),
        (lambda: EdgeLoad(EdgeLoad.uniform().static, [EdgeLoad.uniform().static]), "f_c = "),
        (lambda: EdgeLoad(EdgeLoad.uniform().static, (EdgeLoad.uniform().static,)), "f_c holds 1"),
    ],
)
def test_bad_loads_are_refused(build: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        build()
