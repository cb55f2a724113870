"""Names of matrices in files: every term of a linear periodic system has one, and a slip is answered."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from beam import MovingBeam
from compare.files import load_system, save_system
from compare.files.names import Part, matrices_of, part_of, system_of
from compare.study import own_system, system_subject
from compare.window import default_window
from floquet import monodromy
from periodic import FirstOrderSystem, PeriodicSystem, Term, waveforms

M, K = np.diag([2.0, 3.0]), np.array([[4.0, 1.0], [1.0, 5.0]])
S, J, X = np.array([[1.0, 0.5], [0.5, -2.0]]), np.array([[0.0, 1.0], [-1.0, 0.0]]), np.array([[0.0, 1.0], [2.0, 3.0]])

PHASES = np.linspace(0, 2 * np.pi, 7)


@pytest.mark.parametrize(
    ("name", "part"),
    [
        ("M", Part("M")),
        ("a", Part("A")),
        ("K1c", Part("K", 1, "c", 1)),
        ("F2s", Part("K", 2, "s", 1)),
        ("c12S", Part("C", 12, "s", 1)),
        ("G1c_2", Part("G", 1, "c", 2)),
        ("K0_3", Part("K", 0, "", 3)),
    ],
)
def test_what_a_name_means(name: str, part: Part) -> None:
    assert part_of(name) == part
    assert part_of(part.name) == part


@pytest.mark.parametrize(
    ("name", "wanted"),
    [
        ("K1", r"'K1' is no matrix of a system \(did you mean K1[cs]\?\)"),
        ("Kc1", r"did you mean K1c"),
        ("F", r"'F' is no matrix"),
        ("K0", r"call it K, or K0_1"),
        ("K0c", r"'K0c' is no matrix"),
        ("K1c_0", r"K1c_0 has the power 0 of ε; give one from 1 to 16"),
        ("K1c_17", r"give one from 1 to 16"),
        ("K65s", r"beyond harmonic 64"),
        ("stiffness", r"name the constant matrices"),
    ],
)
def test_a_slip_is_answered(name: str, wanted: str) -> None:
    with pytest.raises(ValueError, match=wanted):
        part_of(name)


@pytest.mark.parametrize(
    ("matrices", "wanted"),
    [
        ({"M": M, "K": K, "C": X, "K1c": K}, r"C \(damping\) is not symmetric .*its skew part is gyroscopic: put"),
        ({"M": M, "K": K, "C1c": X}, r"C1c is not symmetric .*its skew part is gyroscopic"),
        ({"M": M, "K": K, "G2s_2": X}, r"G2s_2 is not skew-symmetric .*its symmetric part is damping"),
        ({"M": M, "K": K, "M1c": X}, r"M1c is not symmetric"),
        ({"M": M, "K": K, "K1c": K, "F1c": K}, r"K1c is there twice, as K1c and as F1c"),
        ({"A": X, "M": M, "A1c": X}, r"A stands for x' = A x, which has no M"),
        ({"A1c": X}, r"A is missing"),
        ({"A": X}, r"there is no excitation; add at least one of A1c"),
        ({"M": M, "K": K, "C": S}, r"there is no excitation"),
    ],
)
def test_what_does_not_fit_is_refused(tmp_path: Path, matrices: dict[str, np.ndarray], wanted: str) -> None:
    np.savez(tmp_path / "a.npz", **matrices)
    with pytest.raises(ValueError, match=rf"a\.npz: {wanted}"):
        load_system(tmp_path / "a.npz")


def test_matrices_are_where_their_names_say(tmp_path: Path) -> None:
    given = {"M": M, "G": J, "C": S, "K": K, "M1c": S, "G1s": J, "C2c_2": S, "K1c": X, "K2s": K, "K0_1": S, "K1c_2": X}
    np.savez(tmp_path / "a.npz", **given)
    system, eps = load_system(tmp_path / "a.npz"), 0.3
    assert isinstance(system, PeriodicSystem)
    found = system.matrices(PHASES, eps)
    one = np.ones_like(PHASES)
    cos, sin = (lambda j: np.cos(j * PHASES)), (lambda j: np.sin(j * PHASES))
    exact = (
        np.multiply.outer(one, M) + eps * np.multiply.outer(cos(1), S),
        np.multiply.outer(one, J) + eps * np.multiply.outer(sin(1), J),
        np.multiply.outer(one, S) + eps**2 * np.multiply.outer(cos(2), S),
        np.multiply.outer(one, K + eps * S)
        + eps * (np.multiply.outer(cos(1), X) + np.multiply.outer(sin(2), K))
        + eps**2 * np.multiply.outer(cos(1), X),
    )
    for one_matrix, wanted in zip(found, exact, strict=True):
        np.testing.assert_allclose(one_matrix, wanted, rtol=0, atol=1e-15)


@pytest.mark.parametrize("form", ["a.npz", "a.mat", "folder"])
def test_first_order_and_terms_come_back_to_the_last_bit(tmp_path: Path, form: str) -> None:
    first = FirstOrderSystem(X, S, terms=[Term("state", K, waveforms.sine(2), 3)])
    save_system(tmp_path / form, first)
    found = load_system(tmp_path / form)
    assert isinstance(found, FirstOrderSystem)
    np.testing.assert_array_equal(found.matrix(PHASES, 0.7), first.matrix(PHASES, 0.7))


numbers = st.floats(-10, 10).filter(lambda x: x == 0 or abs(x) > 1e-3)
terms = st.lists(
    st.builds(
        lambda of, a, b, j, power: Term(of, a * {"gyroscopic": J}.get(of, S), waveforms.cosine(j, b), power),
        st.sampled_from(["mass", "gyroscopic", "damping", "stiffness"]),
        numbers,
        st.sampled_from([0.0, 0.25, 0.5, 0.75]),
        st.integers(1, 5),
        st.integers(1, 3),
    ),
    min_size=1,
    max_size=4,
)


@settings(deadline=None, max_examples=50)
@given(terms)
def test_any_system_of_harmonics_has_names(terms: list[Term]) -> None:
    system = PeriodicSystem(M, J, S, K, terms=terms)
    back = system_of(matrices_of(system))
    assert isinstance(back, PeriodicSystem)
    for one, other in zip(back.matrices(PHASES, 0.4), system.matrices(PHASES, 0.4), strict=True):
        np.testing.assert_allclose(one, other, rtol=0, atol=1e-13 * (1 + np.abs(other).max()))


def test_what_no_file_of_matrices_holds_is_refused(tmp_path: Path) -> None:
    system = PeriodicSystem([[1.0]], stiffness=[[1.0]], terms=[Term("stiffness", [[1.0]], waveforms.rectangular())])
    with pytest.raises(ValueError, match="Piecewise in a term of 'stiffness', which no file of matrices holds"):
        save_system(tmp_path / "a.npz", system)


PYTHON = """
from periodic import PeriodicSystem, Term, waveforms

def system(delta=1.0, duty=0.5):
    wave = waveforms.rectangular(duty)
    return PeriodicSystem([[1.0]], stiffness=[[delta]], terms=[Term("stiffness", [[1.0]], wave)])
"""


def test_a_python_file(tmp_path: Path) -> None:
    (tmp_path / "a.py").write_text(PYTHON, encoding="utf-8")
    system: Any = load_system(tmp_path / "a.py")
    # Meissner's equation: trace = 2 cos cos - (a/b + b/a) sin sin over the two halves of the period
    a, b, half = np.sqrt(1.3), np.sqrt(0.7), np.pi / 2.2
    trace = 2 * np.cos(a * half) * np.cos(b * half) - (a / b + b / a) * np.sin(a * half) * np.sin(b * half)
    found = monodromy(system, 2.2, 0.3)
    assert np.trace(found.matrix) == pytest.approx(trace, abs=1e-12)


def test_a_python_file_with_a_family(tmp_path: Path) -> None:
    text = "from beam import MovingBeam\ndef system(speed=2.0): return MovingBeam(speed, 0.64, damping=0.001)\n"
    (tmp_path / "belt.py").write_text(text, encoding="utf-8")
    beam = MovingBeam(2.0, 0.64, damping=0.001)
    assert load_system(tmp_path / "belt.py") == beam
    own = own_system(tmp_path / "belt.py", (8.0, 40.0), 0.1)
    assert own.system == beam  # a family, not its member at one frequency
    assert system_subject(own, modes=1).systems == {"": beam}


@pytest.mark.parametrize(
    ("text", "wanted"),
    [
        ("x = 1", r"has no function system\(\)"),
        ("def system(a): pass", r"system\(\) failed \(TypeError: .*its parameters need defaults"),
        ("def system(): return 3", r"what system\(\) returned = 3 is no system"),
        ("import nothing_of_that_name", r"cannot be executed \(ModuleNotFoundError"),
        ("raise SystemExit(3)", r"cannot be executed \(SystemExit: 3"),
    ],
)
def test_a_python_file_that_gives_no_system(tmp_path: Path, text: str, wanted: str) -> None:
    (tmp_path / "a.py").write_text(text, encoding="utf-8")
    with pytest.raises(ValueError, match=wanted):
        load_system(tmp_path / "a.py")


@pytest.mark.parametrize(
    "system",
    [
        PeriodicSystem(M, J, S @ S, K, terms=[Term("damping", S), Term("mass", S, power=2)]),
        PeriodicSystem([[1.0]], stiffness=[[4.0]], terms=[Term("stiffness", [[1.0]], waveforms.impulses([0], [1]))]),
        FirstOrderSystem([[0.0, 1.0], [-4.0, 0.0]], [[0.0, 0.0], [1.0, 0.0]]),
    ],
)
def test_a_window_is_suggested_whatever_the_terms(system: Any) -> None:
    (low, high), eps = default_window(system)
    assert 0 < low < high < 20
    assert 0 < eps < 10
