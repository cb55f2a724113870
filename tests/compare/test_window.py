"""The default window: it shows the main regions of the lowest modes, whatever the units, the mesh and rigid motion."""

from __future__ import annotations

import numpy as np
import pytest

from compare.window import default_window
from floquet import Kind, stability_chart
from periodic import PeriodicSystem
from periodic.examples import coupled_mathieu, gyroscopic_rotor, mathieu, meissner
from plate import MovingPlate
from tests.finite_elements import column

PLATE = MovingPlate(axial_terms=2, lateral_terms=2).at(0.0)


@pytest.mark.parametrize(
    ("system", "principal"),
    [
        (mathieu(), [2.0]),
        (mathieu(400.0, 0.1), [40.0]),
        (coupled_mathieu(frequencies=(1.0, 1.7)), [2.0, 2.7, 3.4]),
        (gyroscopic_rotor(), [4.0]),
        (meissner(), [2.0]),
        (PLATE, [18.675]),
    ],
)
def test_the_default_window_shows_the_main_regions(system: PeriodicSystem, principal: list[float]) -> None:
    (low, high), eps = default_window(system)
    assert all(low < Omega < high for Omega in principal)
    assert low < min(principal) / 2
    chart = stability_chart(system, np.linspace(low, high, 48), np.linspace(0, eps, 8), n_jobs=1, progress=False)
    unstable = (chart.kind > Kind.STABLE).mean()
    assert 0.01 < unstable < 0.9  # something to see, and somewhere to see it against


def test_the_default_window_follows_the_units() -> None:
    (low, high), eps = default_window(mathieu())
    scaled = PeriodicSystem([[2.0]], [[0.0]], [[0.0]], [[2e6]], [[[2e3]]])  # time in 1/1000, the force in 1/1000
    (low_2, high_2), eps_2 = default_window(scaled)
    assert (low_2, high_2, eps_2) == pytest.approx((1e3 * low, 1e3 * high, 1e3 * eps), rel=1e-12)


def test_rigid_body_motion_is_passed_over() -> None:
    free = PeriodicSystem(np.eye(2), np.zeros((2, 2)), np.zeros((2, 2)), [[1, -1], [-1, 1]], [np.eye(2)])
    assert default_window(free)[0] == pytest.approx((0.5 * np.sqrt(2), 2.2 * np.sqrt(2)), rel=0.05)
    with pytest.raises(ValueError, match="does not oscillate"):
        default_window(PeriodicSystem([[1.0]], [[0.0]], [[0.0]], [[0.0]], [[[1.0]]]))


def test_the_window_does_not_depend_on_the_mesh() -> None:
    # Frequencies and buckling load of four elements are within a per cent of the limit; two digits are kept.
    coarse, fine = default_window(column(4)), default_window(column(50))
    np.testing.assert_allclose([*coarse[0], coarse[1]], [*fine[0], fine[1]], rtol=0.1)
    # Half of what is left of the buckling load, pi^2 / 4, in the softest direction.
    assert fine[1] == pytest.approx(0.5 * (np.pi**2 / 4 - 1), rel=0.02)


def test_rigid_motion_does_not_shrink_the_default_eps() -> None:
    chain = np.array([[1.0, -1.0, 0.0], [-1.0, 2.0, -1.0], [0.0, -1.0, 1.0]])  # free: one rigid motion
    system = PeriodicSystem(np.eye(3), 0 * chain, 0 * chain, chain, [np.eye(3)])
    assert default_window(system)[1] > 0.1
