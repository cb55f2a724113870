"""What columns say about a resonance: where wide regions are, which subsystem is meant, what is unstable with a
third."""

from __future__ import annotations

import numpy as np
import pytest

from floquet.engine import subsystems
from floquet.regions.column import SubsystemColumn
from floquet.regions.detuning import Detuning, WideRegions, detunings, matching_subsystem
from floquet.regions.scan import Scan
from floquet.regions.tracking import LogMultipliers
from floquet.regions.window import Window
from periodic.examples import coupled_mathieu, mathieu
from plate import MovingPlate
from tests.floquet.regions.resonating import resonances_of, tongues_expected


def test_wide_is_where_both_columns_beside_are_unstable() -> None:
    met = np.array([[False, True, True], [False, False, True]])
    wide = WideRegions(np.array([1.0, 2.0, 3.0]), met)
    np.testing.assert_array_equal(wide.at(1.5), met[0])
    np.testing.assert_array_equal(wide.at(np.array([2.5, 1.5, 2.5])), [False, True, True])
    assert not wide.at(0.5).any()
    assert not wide.at(3.5).any()


def test_columns_on_both_sides_enclose_every_resonance() -> None:
    system = mathieu()
    scan = Scan(Window(system, (0.3, 3.0), (0.0, 0.4)))
    scan.add(np.linspace(0.3, 3.0, 129))
    some = tongues_expected(system, 0.4, 0.4, 1.5)
    for one, found in zip(some, detunings(some, scan), strict=True):
        assert (np.diff(found.Omega) > 0).all()
        assert (found.detuning[0] > 0).all()
        assert (found.detuning[-1] < 0).all()
        # without excitation the angles are those of two oscillators: 2 pi (2 omega / Omega - j)
        np.testing.assert_allclose(found.detuning[:, 0], 2 * np.pi * (2 / found.Omega - one.resonance.j), atol=1e-6)


def test_the_subsystem_of_a_tongue_is_found_among_others() -> None:
    system = MovingPlate(axial_terms=2, lateral_terms=3).at(30.0)
    parts = subsystems(system)
    for one in tongues_expected(system, 0.5, 20.0, 40.0)[:10]:
        assert parts[matching_subsystem(parts, one.modes, 20.0)].K.shape == one.modes.subsystem.K.shape
        np.testing.assert_allclose(parts[matching_subsystem(parts, one.modes, 20.0)].K, one.modes.subsystem.K)


@pytest.mark.parametrize(("partner", "counts"), [(1, True), (2, False)])
def test_a_damped_mode_that_is_unstable_with_a_third_says_nothing(partner: int, counts: bool) -> None:
    system = coupled_mathieu("sum", damping=(0.01, 0.01))
    (one,) = tongues_expected(system, 0.1, 2.69, 2.71, resonances_of(system, 2.69, 2.71)[:1])
    period = 2 * np.pi / 2.7
    angle = np.tile(one.modes.exponents.imag * period, (2, 1))
    modulus = np.tile(one.modes.exponents.real * period, (2, 1))
    modulus[1, 0] += 0.1  # what mode 1 gains, mode 2 loses, unless it comes from elsewhere
    if partner == 1:
        modulus[1, 1] -= 0.1
    column = SubsystemColumn(
        one.modes.subsystem, LogMultipliers(np.abs((angle + np.pi) % (2 * np.pi) - np.pi), modulus, 0 * angle)
    )
    none = np.zeros((0, 2))
    found = Detuning(np.zeros(0), none, none, WideRegions(np.array([1.0, 4.0]), np.zeros((1, 2), dtype=bool)))
    f = found.with_column(one, 2.7, column, np.array([0.0, 0.1])).f[0]
    assert f[0] < 0
    assert f[1] > 0 if counts else np.isnan(f[1])
