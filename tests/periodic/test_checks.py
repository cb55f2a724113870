"""The argument checks every room uses."""

from __future__ import annotations

from decimal import Decimal
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

from periodic.checks import (
    grid,
    interval,
    is_positive_definite,
    one_of,
    real_array,
    real_number,
    whole_number,
    workers,
)

NOT_A_NUMBER: list[Any] = [
    None,
    "1.0",
    b"1",
    True,
    np.True_,
    np.array(True),
    np.array("1.0"),
    1j,
    np.complex128(1.0),
    np.array(1j),
    [1.0],
    np.array([1.0]),
    [[1.0], [1.0, 2.0]],
    {"a": 1},
    object(),
    np.timedelta64(3),
    np.datetime64("2020"),
    10**400,
]


@pytest.mark.parametrize("value", NOT_A_NUMBER)
def test_real_number_refuses_what_is_none(value: Any) -> None:
    with pytest.raises(ValueError, match=r"^speed = .*is not a number; give"):
        real_number("speed", value)


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf, np.float32("nan")])
def test_real_number_refuses_what_is_not_finite(value: Any) -> None:
    with pytest.raises(ValueError, match=r"^speed = .*out of range"):
        real_number("speed", value)


@pytest.mark.parametrize("value", [2, 2.0, np.float32(2), np.int8(2), np.array(2.0), Fraction(4, 2), Decimal(2)])
def test_real_number_takes_every_real_type(value: Any) -> None:
    number = real_number("speed", value)
    assert type(number) is float
    assert number == 2.0


def test_real_number_minds_the_sign() -> None:
    assert real_number("c", 0.0, nonnegative=True) == 0.0
    with pytest.raises(ValueError, match=r"^c = -1.0 .*>= 0"):
        real_number("c", -1.0, nonnegative=True)
    with pytest.raises(ValueError, match=r"^c = 0.0 .*positive"):
        real_number("c", 0, positive=True)


@pytest.mark.parametrize("value", [1.0, "1", None, True, np.bool_(1), [1], 1j, np.float64(2)])
def test_whole_number_refuses_other_types(value: Any) -> None:
    with pytest.raises(ValueError, match=r"^order = .*whole number"):
        whole_number("order", value, least=1)


def test_whole_number_minds_its_bounds() -> None:
    assert whole_number("order", np.int64(2), least=1, most=2) == 2
    with pytest.raises(ValueError, match=r"^order = 0 .*>= 1"):
        whole_number("order", 0, least=1)
    with pytest.raises(ValueError, match=r"^order = 3 .*from 1 to 2"):
        whole_number("order", 3, least=1, most=2)


@pytest.mark.parametrize("value", ["Sum", "", None, 1, ["sum"], np.array("sum")])
def test_one_of_lists_the_choices(value: Any) -> None:
    with pytest.raises(ValueError, match=r"^kind = .*'sum', 'difference'"):
        one_of("kind", value, ("sum", "difference"))


def test_one_of_tells_true_from_one() -> None:
    assert one_of("order", 1, (1, 2)) == 1
    with pytest.raises(ValueError, match=r"^order = True"):
        one_of("order", True, (1, 2))


def test_real_array_copies() -> None:
    source = np.arange(4.0).reshape(2, 2)
    array = real_array("K", source, 2)
    array[0, 0] = 9.0
    assert source[0, 0] == 0.0


def test_real_array_says_where_it_is_not_finite() -> None:
    with pytest.raises(ValueError, match=r"^K has the entry nan at \(1, 0\)"):
        real_array("K", [[1.0, 2.0], [np.nan, 4.0]], 2)


def test_grid_is_frozen_and_takes_a_scalar() -> None:
    array = grid("eps", 0.3)
    np.testing.assert_array_equal(array, [0.3])
    assert not array.flags.writeable


@pytest.mark.parametrize(
    ("value", "says"),
    [
        ([], "empty"),
        ([1.0, 1.0], "increasing"),
        ([2.0, 1.0], "increasing"),
        ([0.0, np.nan], "finite"),
        ([[1.0, 2.0]], "axes"),
        ([[1.0], [1.0, 2.0]], "ragged"),
        (None, "type"),
        ("ab", "type"),
        ([0.0, 1.0], r"starts at 0\.0; every value must be positive"),
    ],
)
def test_grid_refuses(value: Any, says: str) -> None:
    with pytest.raises(ValueError, match=rf"^Omega .*{says}"):
        grid("Omega", value, positive=True)


def test_interval() -> None:
    assert interval("Omega_range", np.array([1, 2])) == (1.0, 2.0)
    for value in (None, 3.0, (1.0,), (1.0, 2.0, 3.0), (2.0, 1.0), (1.0, 1.0), ("a", "b"), (0.0, np.inf), (np.nan, 1.0)):
        with pytest.raises(ValueError, match=r"^Omega_range"):
            interval("Omega_range", value)
    with pytest.raises(ValueError, match=r"^Omega_range\[0\] = -1.0"):
        interval("Omega_range", (-1.0, 1.0), nonnegative=True)


def test_positive_definite_beyond_rounding() -> None:
    assert is_positive_definite(np.diag([1e-200, 1.0, 1e200]))
    assert not is_positive_definite(np.diag([1.0, 0.0]))
    assert not is_positive_definite(np.ones((3, 3)))  # a zero eigenvalue that Cholesky may take for a tiny positive one
    assert is_positive_definite(np.ones((3, 3)) + 1e-12 * np.eye(3))


def test_workers() -> None:
    assert [workers("n_jobs", value) for value in (1, 7, -1, None)] == [1, 7, -1, None]
    for value in (0, -2, 1.5, True, "2"):
        with pytest.raises(ValueError, match=r"^n_jobs = "):
            workers("n_jobs", value)
