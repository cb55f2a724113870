"""`floquet.engine.eigen.lanes`: every operation says the same compiled and in NumPy."""

from __future__ import annotations

import numpy as np
import pytest
from numba import njit

from floquet.engine.doubling.step import multiply
from floquet.engine.eigen.lanes import (
    WIDTH,
    fma,
    highest,
    load,
    load_row,
    magnitude,
    pick_le,
    root,
    spread,
    store,
    store_row,
)

pytestmark = pytest.mark.kernel


@njit
def compiled(a, out):
    x, y, z = load(a, 0, 0), load(a, 0, 1), load(a, 1, 0)
    store(out, 0, 0, x + y)
    store(out, 0, 1, x - y)
    store(out, 0, 2, x * y)
    store(out, 1, 0, x / y)
    store(out, 1, 1, -x)
    store(out, 1, 2, fma(x, y, z))
    store(out, 2, 0, root(magnitude(x)))
    store(out, 2, 1, pick_le(x, y, x, z))
    store(out, 2, 2, spread(2.5))


def test_operations():
    a = np.random.default_rng(0).standard_normal((2, 2, WIDTH))
    a[0, 1, 3] = a[0, 0, 3]  # equal lanes: <= picks the first
    x, y, z = a[0, 0], a[0, 1], a[1, 0]
    out = np.zeros((3, 3, WIDTH))
    compiled(a, out)
    exact = [x + y, x - y, x * y, x / y, -x, x * y + z, np.sqrt(np.abs(x)), np.where(x <= y, x, z), np.full(WIDTH, 2.5)]
    for found, expected in zip(out.reshape(-1, WIDTH), exact, strict=True):
        # a fused multiply-add rounds once where NumPy rounds twice
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-15)


def test_not_a_number_is_never_less():
    a = np.zeros((2, 2, WIDTH))
    a[0, 0, 1] = np.nan
    a[1, 0] = 7.0
    out = np.zeros((3, 3, WIDTH))
    with np.errstate(divide="ignore", invalid="ignore"):
        compiled(a, out)
    assert out[2, 1].tolist() == [0.0, 7.0, *[0.0] * (WIDTH - 2)]


def test_highest():
    @njit
    def largest(a):
        return highest(load(a, 0, 0))

    for lane in range(WIDTH):
        a = np.arange(-2.0 * WIDTH, -WIDTH).reshape(1, 1, WIDTH)
        a[0, 0, lane] = -0.5
        assert largest(a) == -0.5


def test_loaded_lanes_are_a_copy():
    @njit
    def swap(a):
        x, y = load(a, 0, 0), load(a, 0, 1)
        store(a, 0, 0, y)
        store(a, 0, 1, x)

    a = np.arange(2.0 * WIDTH).reshape(1, 2, WIDTH)
    expected = a[:, ::-1].copy()
    swap(a)
    assert (a == expected).all()


@pytest.mark.parametrize("columns", [1, 2, 7, 8, 9, WIDTH])
def test_rows_of_matrices(columns):
    @njit
    def copy(a, b):
        for k in range(a.shape[0]):
            for i in range(a.shape[1]):
                store_row(b, k, i, load_row(a, k, i))

    a = np.random.default_rng(0).standard_normal((2, 3, columns))
    room = np.full(a.size + WIDTH, 7.0)
    copy(a, room[: a.size].reshape(a.shape))
    assert (room[: a.size] == a.ravel()).all()
    assert (room[a.size :] == 7.0).all()


def test_row_ends_with_zeros():
    @njit
    def row(a, out):
        store(out, 0, 0, load_row(a, 0, 0))

    out = np.full((1, 1, WIDTH), np.nan)
    row(np.full((1, 2, 3), 5.0), out)
    assert out.ravel().tolist() == [5.0] * 3 + [0.0] * (WIDTH - 3)


@pytest.mark.parametrize("N", [1, 2, 5, 6, 16, 18])
def test_product(N):
    P = np.random.default_rng(0).standard_normal((3, N, N))
    Q = np.full((3, N, N), 7.0)
    multiply(P, 2, 0, Q, 1)
    np.testing.assert_allclose(Q[1], P[0] @ P[2], rtol=0, atol=1e-14)
    assert (Q[[0, 2]] == 7.0).all()
