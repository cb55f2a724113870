"""`floquet.engine.eigen.lanes`: every operation says the same compiled and in NumPy."""

from __future__ import annotations

import numpy as np
import pytest
from numba import njit

from floquet.engine.doubling.step import multiply
from floquet.engine.eigen.lanes import (
    LANE_COUNT,
    broadcast,
    fma,
    highest,
    load,
    load_row,
    magnitude,
    pick_le,
    square_root,
    store,
    store_row,
)
from periodic.checks import FloatArray

pytestmark = pytest.mark.kernel


@njit
def compiled(a: FloatArray, out: FloatArray) -> None:
    x, y, z = load(a, 0, 0), load(a, 0, 1), load(a, 1, 0)
    store(out, 0, 0, x + y)
    store(out, 0, 1, x - y)
    store(out, 0, 2, x * y)
    store(out, 1, 0, x / y)
    store(out, 1, 1, -x)
    store(out, 1, 2, fma(x, y, z))
    store(out, 2, 0, square_root(magnitude(x)))
    store(out, 2, 1, pick_le(x, y, x, z))
    store(out, 2, 2, broadcast(2.5))


def test_operations() -> None:
    a = np.random.default_rng(0).standard_normal((2, 2, LANE_COUNT))
    a[0, 1, 3] = a[0, 0, 3]  # equal lanes: <= picks the first
    x, y, z = a[0, 0], a[0, 1], a[1, 0]
    out = np.zeros((3, 3, LANE_COUNT))
    compiled(a, out)
    exact = [
        x + y,
        x - y,
        x * y,
        x / y,
        -x,
        x * y + z,
        np.sqrt(np.abs(x)),
        np.where(x <= y, x, z),
        np.full(LANE_COUNT, 2.5),
    ]
    for found, expected in zip(out.reshape(-1, LANE_COUNT), exact, strict=True):
        # a fused multiply-add rounds once where NumPy rounds twice
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-15)


def test_not_a_number_is_never_less() -> None:
    a = np.zeros((2, 2, LANE_COUNT))
    a[0, 0, 1] = np.nan
    a[1, 0] = 7.0
    out = np.zeros((3, 3, LANE_COUNT))
    with np.errstate(divide="ignore", invalid="ignore"):
        compiled(a, out)
    assert out[2, 1].tolist() == [0.0, 7.0, *[0.0] * (LANE_COUNT - 2)]


def test_highest() -> None:
    @njit
    def largest(a: FloatArray) -> float:
        return highest(load(a, 0, 0))

    for lane in range(LANE_COUNT):
        a = np.arange(-2.0 * LANE_COUNT, -LANE_COUNT).reshape(1, 1, LANE_COUNT)
        a[0, 0, lane] = -0.5
        assert largest(a) == -0.5


def test_loaded_lanes_are_a_copy() -> None:
    @njit
    def swap(a: FloatArray) -> None:
        x, y = load(a, 0, 0), load(a, 0, 1)
        store(a, 0, 0, y)
        store(a, 0, 1, x)

    a = np.arange(2.0 * LANE_COUNT).reshape(1, 2, LANE_COUNT)
    expected = a[:, ::-1].copy()
    swap(a)
    assert (a == expected).all()


@pytest.mark.parametrize("columns", [1, 2, 7, 8, 9, LANE_COUNT])
def test_rows_of_matrices(columns: int) -> None:
    @njit
    def copy(a: FloatArray, b: FloatArray) -> None:
        for k in range(a.shape[0]):
            for i in range(a.shape[1]):
                store_row(b, k, i, load_row(a, k, i))

    a = np.random.default_rng(0).standard_normal((2, 3, columns))
    room = np.full(a.size + LANE_COUNT, 7.0)
    copy(a, room[: a.size].reshape(a.shape))
    assert (room[: a.size] == a.ravel()).all()
    assert (room[a.size :] == 7.0).all()


def test_row_ends_with_zeros() -> None:
    @njit
    def row(a: FloatArray, out: FloatArray) -> None:
        store(out, 0, 0, load_row(a, 0, 0))

    out = np.full((1, 1, LANE_COUNT), np.nan)
    row(np.full((1, 2, 3), 5.0), out)
    assert out.ravel().tolist() == [5.0] * 3 + [0.0] * (LANE_COUNT - 3)


@pytest.mark.parametrize("N", [1, 2, 5, 6, 16, 18])
def test_product(N: int) -> None:
    P = np.random.default_rng(0).standard_normal((3, N, N))
    Q = np.full((3, N, N), 7.0)
    multiply(P, 2, 0, Q, 1)
    np.testing.assert_allclose(Q[1], P[0] @ P[2], rtol=0, atol=1e-14)
    assert (Q[[0, 2]] == 7.0).all()
