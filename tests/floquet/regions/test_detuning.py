"""What columns say about a resonance: where wide regions are, which subsystem is meant, what is unstable with a
third."""

from __future__ import annotations

import numpy as np
import pytest

from floquet.engine import subsystems
from floquet.regions.detuning import Nodes, Wide, home_of, scan_nodes
from floquet.regions.exponents import Exponents
from floquet.regions.scan import Modes, Scan
from periodic.examples import coupled_mathieu, mathieu
from plate import MovingPlate
from tests.floquet.regions.resonating import candidates_of, resonances_of

EPS = np.linspace(0.0, 0.4, 80)


def test_wide_is_where_both_columns_beside_are_unstable() -> None:
    met = np.array([[False, True, True], [False, False, True]])
    wide = Wide(np.array([1.0, 2.0, 3.0]), met)
    np.testing.assert_array_equal(wide.at(1.5), met[0])
    np.testing.assert_array_equal(wide.at(np.array([2.5, 1.5, 2.5])), [False, True, True])
    assert not wide.at(0.5).any()
    assert not wide.at(3.5).any()


def test_columns_on_both_sides_enclose_every_resonance() -> None:
    system = mathieu()
    scan = Scan(system, (0.3, 3.0), EPS, 1)
    scan.add(np.linspace(0.3, 3.0, 129))
    some = candidates_of(system, 0.4, 0.4, 1.5)
    for one, nodes in zip(some, scan_nodes(some, scan), strict=True):
        assert (np.diff(nodes.Omega) > 0).all()
        assert (nodes.apart[0] > 0).all()
        assert (nodes.apart[-1] < 0).all()
        # without excitation the angles are those of two oscillators: 2 pi (2 omega / Omega - j)
        np.testing.assert_allclose(nodes.apart[:, 0], 2 * np.pi * (2 / nodes.Omega - one.name.j), atol=1e-6)


def test_the_home_of_a_candidate_is_found_among_blocks() -> None:
    system = MovingPlate(axial_terms=2, lateral_terms=3).at(30.0)
    parts = subsystems(system)
    for one in candidates_of(system, 0.5, 20.0, 40.0)[:10]:
        assert parts[home_of(parts, one.home, 20.0)].K.shape == one.home.subsystem.K.shape
        np.testing.assert_allclose(parts[home_of(parts, one.home, 20.0)].K, one.home.subsystem.K)


@pytest.mark.parametrize(("partner", "counts"), [(1, True), (2, False)])
def test_a_damped_mode_that_is_unstable_with_a_third_says_nothing(partner: int, counts: bool) -> None:
    system = coupled_mathieu("sum", damping=(0.01, 0.01))
    (one,) = candidates_of(system, 0.1, 2.69, 2.71, resonances_of(system, 2.69, 2.71)[:1])
    period = 2 * np.pi / 2.7
    angle = np.tile(one.home.exponents.imag * period, (2, 1))
    modulus = np.tile(one.home.exponents.real * period, (2, 1))
    modulus[1, 0] += 0.1  # what mode 1 gains, mode 2 loses, unless it comes from elsewhere
    if partner == 1:
        modulus[1, 1] -= 0.1
    column = Modes(one.home.subsystem, Exponents(np.abs((angle + np.pi) % (2 * np.pi) - np.pi), modulus, 0 * angle))
    none = np.zeros((0, 2))
    nodes = Nodes(np.zeros(0), none, none, Wide(np.array([1.0, 4.0]), np.zeros((1, 2), dtype=bool)))
    f = nodes.with_column(one, 2.7, column, np.array([0.0, 0.1])).f[0]
    assert f[0] < 0
    assert f[1] > 0 if counts else np.isnan(f[1])
