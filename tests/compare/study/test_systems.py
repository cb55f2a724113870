"""Anybody's matrices: the window chosen for them, the modes left out, and theory held against integration."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from compare.files.matrices import save_system
from compare.study import OwnSystem, own_system, run_study, system_subject
from compare.window import default_window
from periodic import PeriodicSystem
from periodic.examples import coupled_mathieu, gyroscopic_rotor, mathieu
from tests.finite_elements import column


def _own(system: PeriodicSystem, **changes: object) -> OwnSystem:
    window, eps = default_window(system)
    return replace(OwnSystem(Path("mine.npz"), system, window, eps, ""), **changes)


@pytest.mark.parametrize(
    "system",
    [mathieu(1.0), mathieu(1.0, damping=0.02), coupled_mathieu(), gyroscopic_rotor(), column(2)],
    ids=["mathieu", "damped", "pair", "rotor", "column"],
)
def test_theory_and_integration_agree(system: PeriodicSystem) -> None:
    study = run_study(system_subject(_own(system), points=(16, 8)), n_jobs=1, quick=True)
    assert study.variants[0].verdicts
    assert study.agrees, [verdict.reason for verdict in study.variants[0].verdicts]


@pytest.mark.parametrize("unit", [1e-3, 1e4])
def test_units_decide_nothing(unit: float) -> None:
    # Omega in other units, eps in others still: the same verdicts.
    one = coupled_mathieu()
    other = PeriodicSystem(
        one.mass, unit * one.gyroscopic, unit * one.damping, unit**2 * one.stiffness, one.cosine, one.sine
    )
    studies = [run_study(system_subject(_own(s), points=(8, 4)), n_jobs=1, quick=True) for s in (one, other)]
    assert [study.agrees for study in studies] == [True, True]
    a, b = (study.variants[0].verdicts for study in studies)
    assert [verdict.label for verdict in a] == [verdict.label for verdict in b]


def test_the_widest_regions_are_looked_at_closely() -> None:
    study = run_study(system_subject(_own(coupled_mathieu()), points=(8, 4)), n_jobs=1, quick=True)
    assert [curve.label for curve, _ in study.variants[0].panels] == ["ω₁+ω₂"]
    assert set(study.figures()) == {"chart", "regions"}


def test_of_a_system_that_nothing_excites_nothing_is_compared() -> None:
    still = PeriodicSystem([[1.0]], [[0.0]], [[0.0]], [[1.0]], [[[0.0]]])
    study = run_study(system_subject(_own(still), points=(8, 4)), n_jobs=1, quick=True)
    assert not study.agrees
    assert str(study.tally).startswith("NOTHING WAS COMPARED")
    assert set(study.figures()) == {"chart"}


def test_an_undamped_system_under_unsymmetric_excitation_is_remarked() -> None:
    circulatory = np.array([[0.0, 1.0], [-0.5, 0.0]])
    zero = np.zeros((2, 2))
    for damping, expected in ((zero, True), (0.1 * np.eye(2), False)):
        system = PeriodicSystem(np.eye(2), zero, damping, np.diag([1.0, 3.0]), [circulatory])
        assert ("no damping" in system_subject(_own(system)).remark) is expected


def test_errors_name_file_and_matrix(tmp_path: Path) -> None:
    save_system(tmp_path / "trap.npz", mathieu(-0.3))
    save_system(tmp_path / "fine.npz", mathieu(1.0))
    with pytest.raises(ValueError, match=r"trap\.npz: there is no theory .* K \(stiffness\).*explore\.py --system"):
        system_subject(own_system(tmp_path / "trap.npz"))
    with pytest.raises(ValueError, match=r"fine\.npz: none of the regions .* frequencies 1\).*--modes"):
        system_subject(own_system(tmp_path / "fine.npz", (5.0, 6.0)))
    with pytest.raises(ValueError, match=r"Omega_range = \(3\.0, 2\.0\) is empty"):
        own_system(tmp_path / "fine.npz", (3.0, 2.0))
    with pytest.raises(ValueError, match=r"eps_max = -1\.0"):
        own_system(tmp_path / "fine.npz", None, -1.0)
    with pytest.raises(ValueError, match="modes = 0"):
        system_subject(own_system(tmp_path / "fine.npz"), modes=0)
    with pytest.raises(ValueError, match="points = 1"):
        system_subject(own_system(tmp_path / "fine.npz"), points=(1, 1))


def test_numbers_whose_squares_overflow_are_refused(tmp_path: Path) -> None:
    save_system(tmp_path / "huge.npz", PeriodicSystem([[1.0]], [[0.0]], [[0.0]], [[1e308]], [[[1.0]]]))
    with pytest.raises(ValueError, match=r"huge\.npz: stiffness or damping, .* change the units"):
        own_system(tmp_path / "huge.npz")


def test_a_system_that_cannot_oscillate_says_so(tmp_path: Path) -> None:
    zero = np.zeros((1, 1))
    save_system(tmp_path / "free.npz", PeriodicSystem([[1.0]], zero, zero, zero, [[[1.0]]]))
    with pytest.raises(ValueError, match=r"free\.npz: the system does not oscillate"):
        own_system(tmp_path / "free.npz")
