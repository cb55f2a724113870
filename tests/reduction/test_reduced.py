"""Large models in their lowest modes: exact frequencies, no mode missing, and a bound that holds and is of use."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.sparse as sp

from beam import MovingBeam
from compare.files import load_system
from floquet import trace_boundary
from periodic import FirstOrderSystem, PeriodicSystem, SparseSystem, Term, waveforms
from perturb import gyroscopic_modes
from plate import MovingPlate
from reduction import first_modes, reduce_model
from tests.paths import ROOT
from tests.sparse_models import moving_beam, square_plate


def test_frequencies_of_a_square_plate_with_all_its_pairs() -> None:
    model = reduce_model(square_plate(16), (20.0, 60.0))
    m = np.arange(1, 20)
    exact = np.sort(np.pi**2 * np.add.outer(m**2, m**2).ravel())
    exact = exact[: len(model.frequencies)]
    np.testing.assert_allclose(model.frequencies[:8], exact[:8], rtol=1e-4)
    np.testing.assert_allclose(model.frequencies, exact, rtol=2e-2)
    np.testing.assert_allclose(model.system.mass, np.eye(model.size), atol=1e-9)
    np.testing.assert_allclose(np.diag(model.system.stiffness), model.frequencies**2, rtol=1e-8)


@pytest.mark.parametrize("elements", [60, 300])  # all modes at once; shift-invert
def test_gyroscopic_modes_are_kept_exactly(elements: int) -> None:
    model = reduce_model(moving_beam(elements, 2.0), (2.0, 40.0))
    exact = gyroscopic_modes(MovingBeam(speed=2.0, flexural_rigidity=0.64, terms=30).at(1.0)).frequencies
    np.testing.assert_allclose(model.frequencies[:3], exact[:3], rtol=2e-4)  # the beam's sines converge slowly
    kept = gyroscopic_modes(model.system).frequencies
    np.testing.assert_allclose(kept[: len(model.frequencies)], model.frequencies, rtol=1e-7)


def test_both_ways_to_the_modes_agree(monkeypatch: pytest.MonkeyPatch) -> None:
    for speed in (0.0, 2.0):
        system = moving_beam(60, speed)
        a = reduce_model(system, (2.0, 40.0))
        with monkeypatch.context() as patch:
            patch.setattr("reduction.modes.MAX_DENSE_SIZE", 0)
            b = reduce_model(system, (2.0, 40.0))
        np.testing.assert_allclose(a.frequencies, b.frequencies, rtol=1e-9)
        assert a.change(1.0) == pytest.approx(b.change(1.0), rel=0.05)  # the norm is found by iteration


def test_a_moving_web_of_finite_elements_is_the_moving_plate(tmp_path: Path) -> None:
    folder = tmp_path / "web"
    script = [sys.executable, str(ROOT / "examples" / "finite_element_plate.py"), str(folder)]
    subprocess.run([*script, "--elements", "14", "--speed", "2"], check=True)
    system = load_system(folder)
    assert isinstance(system, SparseSystem)
    found = first_modes(system, 4)
    plate = MovingPlate(speed=2.0, tension=10.0, axial_terms=10, lateral_terms=8).at(1.0)
    exact = gyroscopic_modes(plate).frequencies[:4]
    np.testing.assert_allclose(gyroscopic_modes(found).frequencies[:4], exact, rtol=1e-4)


@pytest.mark.parametrize("speed", [0.0, 2.0])
@pytest.mark.parametrize("eps", [1.0, 4.0])
def test_the_bound_holds_and_is_near(speed: float, eps: float) -> None:
    system = moving_beam(8, speed)
    model, whole = reduce_model(system, (2.0, 40.0)), system.restricted(np.eye(system.size))
    assert model.size < whole.size
    near = 2 * model.frequencies[0]
    a, b = (trace_boundary(family, near=near, eps=[eps]).intervals[0] for family in (model, whole))
    moved = np.abs(a - b).max()
    assert moved <= model.change(eps) <= 100 * moved


def test_the_bound_falls_as_more_is_kept_and_grows_with_eps() -> None:
    system = moving_beam(40, 0.0)
    near, far = reduce_model(system, (2.0, 17.0)), reduce_model(system, (2.0, 80.0))
    assert near.size < far.size
    assert 0 < far._left_out._parts[0].reactions[0] < near._left_out._parts[0].reactions[0]
    assert near.change(0.0) == 0.0
    assert near.change(0.2) == pytest.approx(4 * near.change(0.1), rel=0.05)
    assert near.change(1e9) == np.inf


def test_no_bound_for_pulses() -> None:
    system = moving_beam(40, 0.0)
    pulse = Term("stiffness", system.terms[0].matrix, waveforms.impulses())
    model = reduce_model(SparseSystem(system.mass, stiffness=system.stiffness, terms=[pulse]), (2.0, 17.0))
    assert model.change(0.1) == np.inf


def test_terms_of_every_matrix_are_reduced() -> None:
    base = moving_beam(30, 1.0)
    given = [Term(of, 0.1 * base.mass, waveforms.cosine(2), 2) for of in ("mass", "damping", "stiffness")]
    given.append(Term("gyroscopic", 0.1 * base.gyroscopic))
    system = SparseSystem(base.mass, base.gyroscopic, 0.01 * base.mass, base.stiffness, terms=given)
    model = reduce_model(system, (2.0, 17.0))
    V, theta = model.basis, np.array([0.3, 2.0])
    whole = system.restricted(np.eye(system.size)).matrices(theta, 0.4)
    for found, wanted in zip(model.system.matrices(theta, 0.4), whole, strict=True):
        np.testing.assert_allclose(found, V.T @ wanted @ V, atol=1e-9 * np.abs(wanted).max())
    assert 0 < model.change(0.1) < np.inf


def test_a_dense_system_and_a_motion_without_stiffness() -> None:
    chain = np.diag([1.0, 2.0, 2.0, 1.0]) - np.diag(np.ones(3), 1) - np.diag(np.ones(3), -1)
    chain[2:, 2:] += 1e6 * np.array([[1.0, -1.0], [-1.0, 1.0]])
    system = PeriodicSystem(np.eye(4), stiffness=chain, cosine=np.diag([1.0, 0.5, 0.2, 0.1]))
    model = reduce_model(system, (0.5, 3.0))
    assert (len(model.frequencies), model.size) == (3, 3)
    assert abs(model.frequencies[0]) < 1e-4


@pytest.mark.parametrize(
    ("make", "wanted"),
    [
        (lambda: reduce_model(FirstOrderSystem([[-1.0]], [[1.0]]), (1.0, 2.0)), "is no SparseSystem"),
        (lambda: reduce_model(moving_beam(30, 0.0), (3.0, 2.0)), "give low < high"),
        (lambda: reduce_model(moving_beam(30, 0.0), (0.1, 0.2)), "below all natural frequencies, of which the lowest"),
        (lambda: reduce_model(moving_beam(30, 0.0), (1.0, 20.0), max_modes=2), "and at most 2 are computed"),
        (lambda: reduce_model(moving_beam(30, 0.0), (1.0, 20.0), max_modes=0), "max_modes = 0 is out of range"),
        (lambda: reduce_model(moving_beam(30, 4.0), (1.0, 20.0)), "is not positive definite"),
        (lambda: first_modes(moving_beam(30, 0.0), 100), "count = 100 is out of range"),
        (lambda: moving_beam(30, 0.0).at(2.0), "reduction.reduce_model"),
        (lambda: trace_boundary(moving_beam(30, 0.0), near=3.0, eps=[0.1]), "reduction.reduce_model"),
        (lambda: PeriodicSystem(sp.eye_array(3000)), "give a model of so many coordinates as a"),
    ],
)
def test_bad_input(make: Any, wanted: str) -> None:
    with pytest.raises(ValueError, match=wanted):
        make()
