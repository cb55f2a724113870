"""The centreline of a region from columns beside it: exact for constant frequencies, unknown among other modes."""

from __future__ import annotations

import numpy as np
import pytest

from floquet.regions.centrelines import centreline
from periodic.checks import FloatArray

OMEGA = np.array([9.0, 9.8, 10.0, 10.2, 11.0])
SLOPE = -np.pi


def measures(centre: float, height: float) -> tuple[FloatArray, FloatArray]:
    """f and the detuning of two modes of constant frequencies, (columns, 1); inside the region both have one angle."""
    x = SLOPE * (OMEGA - centre) / OMEGA
    f = height - x**2
    detuning = np.where(f > 0, 0.0, 2 * np.sign(x) * np.sqrt(np.maximum(-f, 0)))
    return f[:, None], detuning[:, None]


@pytest.mark.kernel
@pytest.mark.parametrize(("height", "inside"), [(1e-6, -1), (1e-3, 2)])
def test_the_centreline_is_exact_for_constant_frequencies(height: float, inside: int) -> None:
    f, detuning = measures(10.03, height)
    known = np.array([height])
    place, square, top, room, met, measured, *_ = centreline(
        OMEGA, f, detuning, False, known, 16 * known, 10.1, SLOPE, 0.1
    )
    assert place[0] == pytest.approx(10.03, rel=1e-9)
    assert np.sqrt(square[0] * height) == pytest.approx(np.sqrt(height) * 10.03 / np.pi, rel=1e-3)
    assert top[0] == pytest.approx(height, rel=1e-3)
    assert met[0] == inside
    assert measured[0] == (inside >= 0)
    # the region ends before the nearest column that is stable, though another one is nearer
    off, at = (0.03, 10.0) if inside < 0 else (0.17, 10.2)
    assert room[0] == pytest.approx((np.pi * off / at) ** 2, rel=1e-3)


@pytest.mark.kernel
def test_a_column_that_is_unstable_by_something_else_is_not_inside() -> None:
    f, detuning = measures(10.03, 1e-6)
    f[2] = 1e-2
    place, _, _, _, met, measured, *_ = centreline(
        OMEGA, f, detuning, False, np.array([1e-6]), np.array([16e-6]), 10.1, SLOPE, 0.1
    )
    assert place[0] == pytest.approx(10.03, rel=1e-3)
    assert met[0] == -1
    assert not measured[0]


@pytest.mark.kernel
def test_columns_of_other_modes_say_nothing() -> None:
    f, detuning = measures(10.03, 1e-6)
    args = (False, np.array([1e-6]), np.array([16e-6]), 10.1, SLOPE, 0.01)
    assert np.isnan(centreline(OMEGA, 30 * f, detuning, *args)[0][0])
    assert np.isnan(centreline(OMEGA, f, np.abs(detuning), *args)[0][0])
    assert np.isnan(centreline(OMEGA, np.full_like(f, np.nan), detuning, *args)[0][0])
    # but one that is close to the region says where it is, without a column on the other side
    close = (*args[:-1], 0.05)
    assert centreline(OMEGA[:3], f[:3], detuning[:3], *close)[0][0] == pytest.approx(10.03, rel=1e-9)


@pytest.mark.kernel
def test_a_region_may_go_on_straight_beyond_the_columns_on_one_side() -> None:
    args = (False, np.array([1e-6]), np.array([16e-6]), 10.1, SLOPE, 0.01)
    for centre, some in ((10.03, slice(1, 3)), (10.03, slice(3, 5)), (10.3, slice(1, 3)), (9.7, slice(2, 4))):
        f, detuning = (part[some] for part in measures(centre, 1e-6))
        place, *_, likely, _ = centreline(OMEGA[some], f, detuning, *args)
        assert np.isnan(place[0])
        if centre == 10.03:
            assert likely[0] == pytest.approx(10.03, abs=1e-3)
        else:  # further than they are detuning
            assert np.isnan(likely[0])


@pytest.mark.kernel
def test_doubt_is_what_the_centreline_is_off_where_frequencies_change() -> None:
    # x bends: the straight line between the two columns is off by more than the cubic
    bend = 3.0 * (OMEGA - 10.03) ** 2
    x = SLOPE * (OMEGA - 10.03) / OMEGA * (1 + 0.1 * bend / (1 + bend))
    args = (False, np.zeros(1), np.zeros(1), 10.1, SLOPE, 0.1)
    some = np.array([0, 1, 3, 4])
    place, *_, doubt = centreline(OMEGA[some], -(x[some, None] ** 2), np.sign(x[some, None]), *args)
    off = abs(place[0] - 10.03)
    assert off / 3 < doubt[0] < 20 * off
    straight, *_, doubt = centreline(OMEGA, *measures(10.03, 0.0), *args)
    assert straight[0] == pytest.approx(10.03, rel=1e-9)
    assert doubt[0] < 1e-9


@pytest.mark.kernel
def test_a_region_expected_too_wide_is_found_between_columns_too_near_for_that() -> None:
    f, detuning = measures(10.03, 1e-6)
    much = np.array([1.0])  # for that, x would have to fall from 10 to -10 between 10.0 and 10.2
    place, _, _, room, *_ = centreline(OMEGA, f, detuning, False, much, 16 * much, 10.1, SLOPE, 0.01)
    assert 10.0 < place[0] < 10.2
    assert room[0] < 0.01
