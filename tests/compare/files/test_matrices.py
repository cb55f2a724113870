"""Systems from files: what is read is what was written, and a damaged file is a clear error."""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.io
import scipy.sparse
from hypothesis import given, settings
from hypothesis import strategies as st

from compare.files.matrices import MAX_FILE_COORDINATES, load_system, save_system
from periodic import PeriodicSystem, SparseSystem
from periodic.examples import coupled_mathieu, gyroscopic_rotor, mathieu, meissner
from tests.paths import ROOT

FORMS = ("a.npz", "a.mat", "a.MAT", "a.NPZ", "folder")
ROTOR = gyroscopic_rotor(damping=0.1)
M, K, F = np.diag([2.0, 3.0]), np.array([[4.0, 1.0], [1.0, 5.0]]), np.array([[0.0, 1.0], [2.0, 0.0]])


def second_order(path: Path | str) -> PeriodicSystem:
    system = load_system(path)
    assert isinstance(system, PeriodicSystem)
    return system


def _same(one: Any, other: Any) -> None:
    for name, array in vars(one).items():
        np.testing.assert_array_equal(getattr(other, name), array, err_msg=name)


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize(
    "system",
    [mathieu(), mathieu(-0.3, 0.1), ROTOR, coupled_mathieu("difference"), meissner(harmonics=4)],
    ids=["mathieu", "trap", "rotor", "difference", "meissner"],
)
def test_a_system_comes_back_to_the_last_bit(tmp_path: Path, form: str, system: PeriodicSystem) -> None:
    save_system(tmp_path / form, system)
    _same(load_system(tmp_path / form), system)


@settings(deadline=None, max_examples=20)
@given(st.integers(0, 2**32 - 1), st.sampled_from(FORMS))
def test_random_numbers_of_any_magnitude_come_back(
    tmp_path_factory: pytest.TempPathFactory, seed: int, form: str
) -> None:
    random = np.random.default_rng(seed)
    n, J = int(random.integers(1, 6)), int(random.integers(1, 4))
    numbers = random.standard_normal((2 * J + 2, n, n)) * 10.0 ** random.integers(-200, 200, (2 * J + 2, 1, 1))
    numbers[random.random(numbers.shape) < 0.3] = 0
    skew, K, *excitation = numbers
    system = PeriodicSystem(np.eye(n), skew - skew.T, skew + skew.T, K, excitation[:J], excitation[J:])
    path = tmp_path_factory.mktemp("system") / form
    save_system(path, system)
    _same(load_system(path), system)


def test_what_is_missing_is_zero(tmp_path: Path) -> None:
    np.savez(tmp_path / "a.npz", M=M, K=K, F3s=F)
    system = second_order(tmp_path / "a.npz")
    assert system.harmonics == 3
    assert not system.gyroscopic.any()
    assert not system.damping.any()
    assert not system.cosine.any()
    assert not system.sine[:2].any()
    np.testing.assert_array_equal(system.sine[2], F)


def test_capitals_integers_and_numbers_for_one_coordinate(tmp_path: Path) -> None:
    np.savez(tmp_path / "a.npz", m=2, k=np.float32(8), f1C=[[1]])
    system = second_order(tmp_path / "a.npz")
    assert (system.mass.item(), system.stiffness.item(), system.cosine.item()) == (2.0, 8.0, 1.0)


# SciPy writes these files; it is the oracle of our own readers.
@pytest.mark.parametrize("kind", ["dense", "sparse", "single", "int32"])
@pytest.mark.parametrize("compressed", [False, True])
def test_matlab_files_as_scipy_writes_them(tmp_path: Path, kind: str, compressed: bool) -> None:
    changes: dict[str, Callable[[Any], Any]] = {
        "dense": np.array,
        "sparse": scipy.sparse.csc_matrix,
        "single": np.float32,
        "int32": np.int32,
    }
    change = changes[kind]
    matrices = {"M": change(M), "K": change(K), "F1c": change(F), "f2s": change(np.zeros((2, 2)))}
    scipy.io.savemat(tmp_path / "a.mat", matrices, do_compression=compressed)
    system = second_order(tmp_path / "a.mat")
    np.testing.assert_array_equal(system.stiffness, K)
    np.testing.assert_array_equal(system.cosine, [F, np.zeros((2, 2))])


@pytest.mark.parametrize("symmetry", ["general", "symmetric", "skew-symmetric"])
@pytest.mark.parametrize("layout", ["array", "coordinate"])
def test_matrix_market_files_as_scipy_writes_them(tmp_path: Path, layout: str, symmetry: str) -> None:
    square = np.random.default_rng(1).standard_normal((4, 4)).round(3)
    F4 = {"general": square, "symmetric": square + square.T, "skew-symmetric": square - square.T}[symmetry]
    for name, matrix in {"M": np.eye(4), "K": np.eye(4, dtype=int), "F1c": F4}.items():
        value = scipy.sparse.coo_matrix(matrix) if layout == "coordinate" else matrix
        kind = symmetry if name == "F1c" else "symmetric"
        scipy.io.mmwrite(tmp_path / f"{name}.mtx", value, comment="a comment", symmetry=kind, precision=17)
    (tmp_path / "notes.txt").write_text("not a matrix")
    np.testing.assert_array_equal(load_system(tmp_path).at(1.0).cosine[0], F4)


@pytest.mark.parametrize(
    ("matrices", "wanted"),
    [
        ({"M": M, "F1c": F}, r"a\.npz: K is missing"),
        ({"M": M, "K": K}, r"a\.npz: there is no excitation"),
        ({"M": M, "K": K, "F1": F}, r"a\.npz: 'F1' is no matrix"),
        ({"M": M, "K": K, "F0c": F}, r"a\.npz: 'F0c' is no matrix"),
        ({"M": M, "K": K, "F1c": F, "F01c": F}, r"a\.npz: K1c is there twice, as F1c and as F01c"),
        ({"M": M, "K": K, "F65c": F}, r"a\.npz: F65c is beyond harmonic 64"),
        ({"M": M, "K": K, "F1c": F, "f1c": F}, r"a\.npz: K1c is there twice, as F1c and as f1c"),
        ({"M": M, "K": K[:1], "F1c": F}, r"a\.npz: K has shape \(1, 2\); give a square"),
        ({"M": M, "K": np.eye(3), "F1c": F}, r"a\.npz: K has shape \(3, 3\); give \(2, 2\), as M has"),
        ({"M": M, "K": K, "F1c": [F]}, r"a\.npz: F1c has shape \(1, 2, 2\)"),
        ({"M": M, "K": K * np.nan, "F1c": F}, r"a\.npz: K has the entry nan at \(0, 0\)"),
        ({"M": M, "K": K + 1j, "F1c": F}, r"a\.npz: K has entries of type complex"),
        ({"M": M, "K": K.astype(str), "F1c": F}, r"a\.npz: K has entries of type"),
        ({"M": -M, "K": K, "F1c": F}, r"a\.npz: M \(mass\) has the lowest eigenvalue"),
        ({"M": M, "K": K, "G": F, "F1c": F}, r"a\.npz: G \(gyroscopic\) is not skew-symmetric"),
        ({"M": M, "K": K, "C": F, "F1c": F}, r"a\.npz: C \(damping\) is not symmetric"),
        ({"M": np.empty((0, 0)), "K": K, "F1c": F}, r"a\.npz: M has shape \(0, 0\)"),
    ],
)
def test_an_error_names_the_file_and_the_matrix(tmp_path: Path, matrices: dict[str, np.ndarray], wanted: str) -> None:
    np.savez(tmp_path / "a.npz", **matrices)
    with pytest.raises(ValueError, match=wanted):
        load_system(tmp_path / "a.npz")


def test_too_many_coordinates_are_refused_before_memory_is_taken(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    n = MAX_FILE_COORDINATES + 1
    np.savez_compressed(tmp_path / "a.npz", M=np.eye(n), K=np.eye(n), F1c=np.eye(n))
    with pytest.raises(ValueError, match=r"a\.npz: M is dense and has 501 coordinates; give more"):
        load_system(tmp_path / "a.npz")
    np.savez_compressed(tmp_path / "a.npz", M=np.eye(2 * n), K=np.eye(n), F1c=np.eye(n))
    with pytest.raises(ValueError, match=r"a\.npz: M\.npy has \d+ bytes"):
        load_system(tmp_path / "a.npz")
    monkeypatch.setattr("compare.files.matrices.MAX_SPARSE_COORDINATES", 10**4)
    many = scipy.sparse.eye(10**4 + 1, format="csc")
    scipy.io.savemat(tmp_path / "a.mat", {"M": many, "K": many, "F1c": many}, do_compression=True)
    with pytest.raises(ValueError, match=r"a\.mat: .*at most 10000 rows"):
        load_system(tmp_path / "a.mat")
    (tmp_path / "a.npz").unlink()
    for name in ("M", "K", "F1c"):
        (tmp_path / f"{name}.mtx").write_text(f"%%MatrixMarket matrix array real general\n{10**9} {10**9}\n1\n")
    with pytest.raises(ValueError, match=r"\.mtx: .*at most 500 rows"):
        load_system(tmp_path)


def sparse_parts(n: int) -> dict[str, Any]:
    """Matrices of a chain of n masses, in compressed columns."""
    K = scipy.sparse.diags_array([-1.0, 2.0, -1.0], offsets=[-1, 0, 1], shape=(n, n)).tocsc()
    return {"M": scipy.sparse.eye_array(n).tocsc(), "K": K, "K1c_2": 0.5 * scipy.sparse.eye_array(n).tocsc()}


def matlab_73(path: Path, parts: dict[str, Any]) -> None:
    """Write sparse matrices as MATLAB does in version 7.3."""
    h5py = pytest.importorskip("h5py")
    with h5py.File(path, "w", userblock_size=512) as file:
        for name, X in parts.items():
            group = file.create_group(name)
            group.attrs["MATLAB_sparse"] = np.uint64(X.shape[0])
            group["data"], group["ir"], group["jc"] = X.data, X.indices.astype("u8"), X.indptr.astype("u8")
    with path.open("r+b") as raw:
        raw.write(b"MATLAB 7.3 MAT-file".ljust(124) + b"\x00\x02IM")


@pytest.mark.parametrize("form", ["folder of npz", "folder of mtx", "a.mat", "7.3"])
@pytest.mark.parametrize("n", [5, MAX_FILE_COORDINATES + 100])
def test_sparse_matrices_are_a_dense_system_if_small_and_a_sparse_one_if_large(
    tmp_path: Path, form: str, n: int
) -> None:
    parts, path = sparse_parts(n), tmp_path
    if form == "folder of npz":
        for name, X in parts.items():
            scipy.sparse.save_npz(tmp_path / f"{name}.npz", X)
    elif form == "folder of mtx":
        for name, X in parts.items():
            scipy.io.mmwrite(tmp_path / f"{name}.mtx", X, symmetry="symmetric")
    else:
        path = tmp_path / "a.mat"
        matlab_73(path, parts) if form == "7.3" else scipy.io.savemat(path, parts)
    found = load_system(path)
    if n == 5:
        assert isinstance(found, PeriodicSystem)
        np.testing.assert_array_equal(found.stiffness, parts["K"].toarray())
    else:
        assert isinstance(found, SparseSystem)
        assert abs(found.stiffness - parts["K"]).max() == 0
    assert [(term.of, term.power) for term in found.terms] == [("stiffness", 2)]


def test_faults_of_sparse_files(tmp_path: Path) -> None:
    n = MAX_FILE_COORDINATES + 1
    many = scipy.sparse.eye_array(n).tocsr()
    for name in ("A", "A1c"):
        scipy.sparse.save_npz(tmp_path / f"{name}.npz", many)
    with pytest.raises(ValueError, match="A has too many states"):
        load_system(tmp_path)
    other = tmp_path / "other"
    other.mkdir()
    lone = scipy.sparse.csr_array(([1.0], ([0], [1])), shape=(n, n))
    for name, X in (("M", many), ("K", lone), ("K1c", many)):
        scipy.sparse.save_npz(other / f"{name}.npz", X)
    with pytest.raises(ValueError, match=r"other: K \(stiffness\) is not symmetric"):
        load_system(other)
    scipy.sparse.save_npz(other / "K.npz", scipy.sparse.eye_array(n + 1).tocsr())
    with pytest.raises(ValueError, match=r"K has shape \(502, 502\)"):
        load_system(other)
    (other / "K.npz").write_bytes(b"PK\x03\x04 damaged")
    with pytest.raises(ValueError, match=r"K\.npz: cannot be read"):
        load_system(other)


def test_no_pickle_is_ever_loaded(tmp_path: Path) -> None:
    np.savez(tmp_path / "a.npz", M=M, K=K, F1c=np.array({"a": 1}, dtype=object))
    with pytest.raises(ValueError, match=r"a\.npz: .*array F1c; save sparse matrices by scipy"):
        load_system(tmp_path / "a.npz")
    (tmp_path / "b.npz").write_bytes(b"\x80\x04.")  # a bare pickle, which numpy.load would look into
    with pytest.raises(ValueError, match=r"b\.npz: cannot be read as an \.npz file \(it does not start like one\)"):
        load_system(tmp_path / "b.npz")


def test_other_variables_in_a_matlab_file(tmp_path: Path) -> None:
    for value, wanted in (("text", "class 4"), ({"a": 1}, "class 2"), (K + 1j, "complex"), (np.eye(2), "no matrix of")):
        scipy.io.savemat(tmp_path / "a.mat", {"M": M, "K": K, "F1c": F, "other": value})
        with pytest.raises(ValueError, match=rf"a\.mat: .*other.*{wanted}"):
            load_system(tmp_path / "a.mat")


def test_matlab_files_of_other_versions(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "a.mat"
    path.write_bytes(b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(124) + b"\x00\x02IM" + b"\x89HDF")
    with pytest.raises(ValueError, match=r"a\.mat: cannot be read"):
        load_system(path)
    monkeypatch.setitem(sys.modules, "h5py", None)
    with pytest.raises(ValueError, match=r"a\.mat: .*version 7\.3, which needs h5py: pip install .*'-v7'"):
        load_system(path)
    scipy.io.savemat(path, {"M": M, "K": K, "F1c": F}, format="4")
    with pytest.raises(ValueError, match=r"a\.mat: .*'-v7'"):
        load_system(path)


@pytest.mark.parametrize("name", ["nothing.npz", "nothing.mat", "nothing", "notes.txt", "empty"])
def test_a_path_that_leads_nowhere(tmp_path: Path, name: str) -> None:
    (tmp_path / "notes.txt").write_text("hello")
    (tmp_path / "empty").mkdir()
    with pytest.raises(ValueError, match=re.escape(name)):
        load_system(tmp_path / name)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="this system has no named pipes")
def test_a_pipe_is_not_waited_for(tmp_path: Path) -> None:
    for name in ("a.npz", "a.mat", "M.mtx"):
        os.mkfifo(tmp_path / name)
    for path in (tmp_path / "a.npz", tmp_path / "a.mat"):
        with pytest.raises(ValueError, match="no file"):
            load_system(path)


@pytest.mark.parametrize("value", [None, 3, b"\x00"])
def test_something_else_than_a_path(value: object) -> None:
    with pytest.raises(ValueError, match="path"):
        load_system(value)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="system = 3 is no PeriodicSystem"):
        save_system("a.npz", 3)  # type: ignore[arg-type]


def test_a_folder_with_matrices_of_another_system_is_left_alone(tmp_path: Path) -> None:
    save_system(tmp_path, meissner(harmonics=3))
    with pytest.raises(ValueError, match=r"holds K3c\.mtx"):
        save_system(tmp_path, mathieu())
    assert second_order(tmp_path).harmonics == 3


@settings(deadline=None, max_examples=150)
@given(st.sampled_from(FORMS), st.integers(0, 2**32 - 1))
def test_a_damaged_file_is_a_system_or_a_clear_error(
    tmp_path_factory: pytest.TempPathFactory, form: str, seed: int
) -> None:
    random = np.random.default_rng(seed)
    path = tmp_path_factory.mktemp("damaged") / form
    save_system(path, ROTOR)
    file = path if path.is_file() else sorted(path.iterdir())[random.integers(4)]
    data = bytearray(file.read_bytes())
    for _ in range(random.integers(1, 6)):
        at = int(random.integers(len(data) + 1))
        match random.integers(4):
            case 0:
                data[at : at + 1] = random.bytes(1)
            case 1:
                data[at:at] = random.bytes(int(random.integers(9)))
            case 2:
                del data[at : at + int(random.integers(9))]
            case _:
                data[at : at + 1] = bytes([random.choice(list(b"0123456789eE+-. %\n"))])
    file.write_bytes(data)
    try:
        fault = None
        load_system(path)
    except ValueError as error:
        fault = str(error)
    assert fault is None or path.name in fault


def test_the_example_of_the_format_page(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for code in re.findall(r"```python\n(.*?)```", (ROOT / "docs" / "matrices.md").read_text(encoding="utf-8"), re.S):
        exec(code, {})
    system = second_order("column.npz")
    _same(load_system("column.mat"), system)
    _same(load_system("column-matrices"), system)
    # Euler's load of a cantilever, pi^2/4; four cubic elements reach it to 1e-4.
    buckling = np.linalg.eigvals(np.linalg.solve(system.cosine[0], system.stiffness)).real
    assert -buckling.max() + 1.0 == pytest.approx(np.pi**2 / 4, rel=1e-4)
