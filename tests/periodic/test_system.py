"""PeriodicSystem: what it refuses, what it keeps, what it promises."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from periodic import PeriodicSystem
from periodic.system import SYMMETRY_TOLERANCE

NAMES = ("mass", "gyroscopic", "damping", "stiffness", "cosine", "sine")


def good(**changes: Any) -> dict[str, Any]:
    """Arguments of a valid system with n = 2, J = 1, some of them replaced."""
    arguments = {
        "mass": [[2.0, 0.5], [0.5, 1.0]],
        "gyroscopic": [[0.0, -1.0], [1.0, 0.0]],
        "damping": [[0.1, 0.0], [0.0, 0.2]],
        "stiffness": [[3.0, 0.4], [-0.3, -1.0]],
        "cosine": [[[1.0, 2.0], [3.0, 4.0]]],
        "sine": [[[0.0, 1.0], [0.0, 0.0]]],
    }
    return arguments | changes


def test_keeps_what_it_is_given() -> None:
    system = PeriodicSystem(**good())
    for name in NAMES:
        np.testing.assert_array_equal(getattr(system, name), good()[name])
    assert (system.size, system.harmonics) == (2, 1)
    assert system.at(3.0) is system


def test_sine_is_zero_when_left_out() -> None:
    arguments = good()
    del arguments["sine"]
    np.testing.assert_array_equal(PeriodicSystem(**arguments).sine, np.zeros((1, 2, 2)))


def test_copies_and_freezes_its_arrays() -> None:
    arguments = {name: np.array(value) for name, value in good().items()}
    system = PeriodicSystem(**arguments)
    for name, array in arguments.items():
        array += 1.0  # the caller's array stays the caller's
        np.testing.assert_array_equal(getattr(system, name), good()[name])
        with pytest.raises(ValueError, match="read-only"):
            getattr(system, name)[0] = 0.0
        with pytest.raises(dataclasses.FrozenInstanceError):
            setattr(system, name, array)


def test_arrays_are_contiguous_float64() -> None:
    system = PeriodicSystem(
        mass=np.asfortranarray([[2, 1], [1, 2]]),
        gyroscopic=np.zeros((2, 2), dtype=np.float32),
        damping=np.zeros((4, 4), dtype=int)[::2, ::2],
        stiffness=np.array([[1, 2], [3, 4]], dtype=np.uint8).T,
        cosine=np.ones((2, 2, 1), dtype=np.float16).transpose(2, 0, 1),
    )
    for name in NAMES:
        array = getattr(system, name)
        assert array.dtype == np.float64
        assert array.flags.c_contiguous


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize(
    ("change", "says"),
    [
        (lambda a: a[..., :1], "shape"),
        (lambda a: a[..., 0], "shape"),
        (lambda a: a[None], "shape"),
        (lambda a: a[:0], "shape"),
        (lambda a: a[..., :0, :0], "shape"),
        (lambda a: np.nan * a, "finite"),
        (lambda a: np.full_like(a, np.inf), "finite"),
        (lambda a: a + 0j, "complex"),
        (lambda a: a.astype(str), "type"),
        (lambda a: a > 0, "bool"),
        (lambda a: a.astype(object), "object"),
        (lambda a: [[1.0], [1.0, 2.0]], "ragged"),
        (lambda a: "M", "type"),
    ],
)
def test_refuses_bad_arrays_by_name(name: str, change: Any, says: str) -> None:
    bad = change(np.array(good()[name]))
    with pytest.raises(ValueError, match=rf"^{name} .*{says}"):
        PeriodicSystem(**good(**{name: bad}))


def test_none_is_no_mass() -> None:
    with pytest.raises(ValueError, match=r"^mass "):
        PeriodicSystem(**good(mass=None))


@pytest.mark.parametrize("name", ["gyroscopic", "damping", "stiffness", "cosine", "sine"])
def test_a_matrix_that_is_left_out_is_zero(name: str) -> None:
    np.testing.assert_array_equal(getattr(PeriodicSystem(**good(**{name: None})), name), 0 * np.array(good()[name]))


def test_one_matrix_is_that_of_the_first_harmonic() -> None:
    system = PeriodicSystem(**good(cosine=good()["cosine"][0], sine=good()["sine"][0]))
    np.testing.assert_array_equal(system.cosine, good()["cosine"])
    np.testing.assert_array_equal(system.sine, good()["sine"])


@pytest.mark.parametrize("name", ["gyroscopic", "damping", "stiffness"])
def test_refuses_the_size_of_another_system(name: str) -> None:
    with pytest.raises(ValueError, match=rf"^{name} has shape \(3, 3\); give \(2, 2\)"):
        PeriodicSystem(**good(**{name: np.zeros((3, 3))}))


def test_refuses_sine_with_other_harmonics() -> None:
    with pytest.raises(ValueError, match=r"^sine has shape \(2, 2, 2\)"):
        PeriodicSystem(**good(sine=np.zeros((2, 2, 2))))


def test_refuses_no_harmonics() -> None:
    with pytest.raises(ValueError, match=r"^cosine .*J >= 1"):
        PeriodicSystem(**good(cosine=np.zeros((0, 2, 2)), sine=None))


@pytest.mark.parametrize(
    "mass",
    [
        [[0.0, 0.0], [0.0, 1.0]],
        [[1.0, 1.0], [1.0, 1.0]],
        [[1.0, 2.0], [2.0, 1.0]],
        [[-1.0, 0.0], [0.0, -1.0]],
        [[1e8, 1e4], [1e4, 1.0]],
    ],
)
def test_refuses_a_mass_that_is_not_positive_definite(mass: Any) -> None:
    with pytest.raises(ValueError, match=r"^mass has the lowest eigenvalue .*positive definite"):
        PeriodicSystem(**good(mass=mass))


@pytest.mark.parametrize("scale", [1e-300, 1e-20, 1e20, 1e300])
def test_units_of_one_coordinate_decide_nothing(scale: float) -> None:
    """A rotation beside a translation: eigenvalues far apart, and still positive definite."""
    mass = [[1.0, 0.5 * scale**0.5], [0.5 * scale**0.5, scale]]
    assert PeriodicSystem(**good(mass=mass)).mass[1, 1] == scale


@pytest.mark.parametrize("name", ["mass", "damping", "gyroscopic"])
def test_refuses_the_wrong_symmetry(name: str) -> None:
    kind = "skew-symmetric" if name == "gyroscopic" else "symmetric"
    bad = np.array(good()[name])
    bad[0, 1] += 1e-3
    with pytest.raises(ValueError, match=rf"^{name} is not {kind}"):
        PeriodicSystem(**good(**{name: bad}))


@settings(deadline=None, max_examples=25)
@given(st.floats(-0.9, 0.9), st.sampled_from(["mass", "damping", "gyroscopic"]))
def test_rounding_is_symmetrised_away(part: float, name: str) -> None:
    bad = np.array(good()[name])
    bad[0, 1] += part * SYMMETRY_TOLERANCE * np.abs(bad).max()
    array = getattr(PeriodicSystem(**good(**{name: bad})), name)
    sign = -1 if name == "gyroscopic" else 1
    np.testing.assert_array_equal(array, sign * array.T)
    np.testing.assert_allclose(array, good()[name], atol=SYMMETRY_TOLERANCE * np.abs(bad).max())


def test_largest_numbers_do_not_overflow() -> None:
    system = PeriodicSystem(**good(gyroscopic=[[0.0, -1.7e308], [1.7e308, 0.0]]))
    assert system.gyroscopic[1, 0] == 1.7e308


def test_replace_makes_a_checked_copy() -> None:
    system = PeriodicSystem(**good())
    damped = dataclasses.replace(system, damping=np.eye(2))
    np.testing.assert_array_equal(damped.damping, np.eye(2))
    np.testing.assert_array_equal(damped.mass, system.mass)
    with pytest.raises(ValueError, match=r"^damping"):
        dataclasses.replace(system, damping=np.eye(3))
