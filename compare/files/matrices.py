"""Your own system from a file: matrices as .npz, MATLAB .mat or a folder of Matrix Market files, or a Python file."""

from __future__ import annotations

import io
import warnings
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, cast

import numpy as np
import scipy.sparse as sp
from scipy.io import savemat

from compare.files.matlab_file import matrix_bytes, read_matlab
from compare.files.matrix_market import read_matrix_market, write_matrix_market
from compare.files.names import Part, matrices_of, parts_of, sparse_system_of, system_of
from compare.files.publish import staged
from compare.files.python_file import run_python_file
from periodic import AnyFamily, AnySystem, FirstOrderSystem, PeriodicSystem, SparseSystem
from periodic.checks import FloatArray, is_sparse, real_array

# Coordinates of a system from a file in dense matrices: so many can still be integrated. Larger models are sparse, and
# are reduced to their lowest modes.
MAX_FILE_COORDINATES = 500
MAX_SPARSE_COORDINATES = 2_000_000
# One part of a sparse matrix in a file may hold so many bytes: a damaged one does not fill the memory.
MAX_SPARSE_BYTES = 2**31
MAX_MATRIX_BYTES = matrix_bytes(MAX_FILE_COORDINATES)

ZIP_MAGIC = b"PK\x03\x04"
SYSTEM_FORMATS = (
    "give a .npz file, a MATLAB .mat file, a folder of Matrix Market files (.mtx) or of sparse .npz files, or a Python "
    "file with a function system()"
)


def load_system(path: str | Path) -> AnyFamily | SparseSystem:
    """Read a system from a file of matrices, or from a Python file.

    Parameters
    ----------
    path : str or Path
        A .npz file, a MATLAB .mat file, a folder of Matrix Market files (M.mtx, K.mtx, ...) or of files that
        `scipy.sparse.save_npz` wrote (M.npz, K.npz, ...):
        M, G, C, K and what the excitation adds to them, K1c, C2s, K1c_2, ...; or A, A1c, ... of x' = A x. In capitals
        or not, dense or sparse. M, K (or A) and one excited matrix are needed, the others are zero if missing.
        docs/matrices.md describes the format. Or a Python file (.py) with a function ``system()`` that returns a
        `PeriodicSystem`, a `FirstOrderSystem` or a family of them, such as a `MovingBeam`: it is executed.

    Returns
    -------
    PeriodicSystem or FirstOrderSystem, or what a Python file returned; a SparseSystem of more than 500 coordinates

    Raises
    ------
    ValueError
        If the file cannot be read, a name is unknown or missing, or a matrix is not what its name asks for; the
        message names file and matrix. Nothing in a file of matrices is ever executed: pickled objects are refused.
    """
    path = _as_path(path)
    if path.is_dir():
        found = _read_folder(path)
    elif path.suffix.lower() == ".npz":
        found = _read_npz(path)
    elif path.suffix.lower() == ".mat":
        found = _read_mat(path)
    elif path.suffix.lower() == ".py":
        return run_python_file(path)
    else:
        fault = "has no ending that says what it holds" if path.exists() else "is not there"
        raise ValueError(f"{path}: {fault}; {SYSTEM_FORMATS}")
    parts = parts_of(found)
    large = any(is_sparse(value) for value in found.values())
    checked = _sparse if large else _dense
    matrices = {name: checked(f"{path}: {name}", value) for name, value in found.items()}
    first = next(name for name, part in parts.items() if part in (Part("M"), Part("A")))
    n = matrices[first].shape[0]
    for name, matrix in matrices.items():
        if matrix.shape != (n, n):
            raise ValueError(f"{path}: {name} has shape {matrix.shape}; give ({n}, {n}), as {first} has")
    try:
        return (sparse_system_of if large else system_of)({parts[name]: matrix for name, matrix in matrices.items()})
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None


def save_system(path: str | Path, system: AnySystem) -> None:
    """Write a system in a form that `load_system` reads back, to the last bit if each term has one harmonic.

    Parameters
    ----------
    path : str or Path
        A name ending in .npz or .mat, or a folder for Matrix Market files. An old file is replaced only by a complete
        new one.
    system : PeriodicSystem or FirstOrderSystem
        Its matrices are written, but for those that are zero and not needed.

    Raises
    ------
    ValueError
        If ``system`` is no system, has more coordinates or harmonics than `load_system` takes, or waveforms that are no
        finite Fourier sums, or ``path`` cannot be written to.
    """
    path = _as_path(path)
    if not isinstance(system, PeriodicSystem | FirstOrderSystem):
        raise ValueError(f"system = {system!r} is no PeriodicSystem and no FirstOrderSystem; give one")
    if system.size > MAX_FILE_COORDINATES:
        raise ValueError(f"system has {system.size} coordinates; give at most {MAX_FILE_COORDINATES}")
    matrices = {part.name: matrix for part, matrix in matrices_of(system).items()}
    if path.suffix.lower() in (".npz", ".mat"):
        with staged(path.parent) as folder:
            if path.suffix.lower() == ".mat":
                savemat(str(folder / path.name), matrices, appendmat=False, do_compression=True)
            else:
                with (folder / path.name).open("wb") as file:  # savez would add .npz to a name that ends in .NPZ
                    np.savez_compressed(file, **cast(dict[str, Any], matrices))
        return
    others = sorted({file.name for file in path.glob("*.mtx")} - {f"{name}.mtx" for name in matrices})
    if others:
        raise ValueError(f"{path}: holds {', '.join(others)}, which this system does not have; give an empty folder")
    with staged(path) as folder:
        for name, matrix in matrices.items():
            write_matrix_market(folder / f"{name}.mtx", matrix)


def _checked(path: Path, names: Iterable[str]) -> list[str]:
    """Return the names of a file, refused if they make no system."""
    names = list(names)
    try:
        parts_of(names)
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None
    return names


def _read_npz(path: Path) -> dict[str, Any]:
    with _parser_of(path, "an .npz file"):
        data = path.read_bytes()
        if not data.startswith(ZIP_MAGIC):
            raise ValueError("it does not start like one")
        archive = np.load(io.BytesIO(data), allow_pickle=False)
    with archive:
        for member in archive.zip.infolist():
            if member.file_size > MAX_MATRIX_BYTES:
                raise ValueError(
                    f"{path}: {member.filename} has {member.file_size} bytes; give at most {MAX_MATRIX_BYTES}"
                )
        matrices = {}
        for name in _checked(path, archive.files):
            with _parser_of(path, f"the plain array {name}; save sparse matrices by scipy.sparse.save_npz in a folder"):
                matrices[name] = archive[name]
        return matrices


def _read_mat(path: Path) -> dict[str, Any]:
    with _parser_of(path, "a MATLAB file"):
        variables = read_matlab(path, MAX_FILE_COORDINATES, MAX_SPARSE_COORDINATES)
    return {name: variables[name] for name in _checked(path, variables)}


def _read_folder(path: Path) -> dict[str, Any]:
    with _parser_of(path, "a folder"):
        files = {file.stem: file for file in sorted(path.iterdir()) if file.suffix.lower() in (".mtx", ".npz")}
    if not files:
        raise ValueError(f"{path}: this folder has no .mtx or .npz file; {SYSTEM_FORMATS}")
    matrices: dict[str, Any] = {}
    for name in _checked(path, files):
        if files[name].suffix.lower() == ".npz":
            with _parser_of(files[name], "a sparse matrix of scipy.sparse.save_npz"):
                matrices[name] = _sparse_npz(files[name])
            continue
        with _parser_of(files[name], "a Matrix Market file"):
            matrices[name] = read_matrix_market(files[name], MAX_FILE_COORDINATES, MAX_SPARSE_COORDINATES)
    return matrices


def _sparse_npz(path: Path) -> Any:
    """Return a sparse matrix in compressed rows; dense if it is small."""
    file = io.BytesIO(path.read_bytes())
    if not file.getbuffer()[: len(ZIP_MAGIC)] == ZIP_MAGIC:
        raise ValueError("it does not start like one")
    with np.load(file, allow_pickle=False) as archive:
        for member in archive.zip.infolist():
            if member.file_size > MAX_SPARSE_BYTES:
                raise ValueError(f"{member.filename} has {member.file_size} bytes; give at most {MAX_SPARSE_BYTES}")
    file.seek(0)
    matrix: Any = sp.load_npz(file)
    rows = max(matrix.shape)
    if rows > MAX_SPARSE_COORDINATES:
        raise ValueError(f"it has {rows} rows; give at most {MAX_SPARSE_COORDINATES}")
    if hasattr(matrix, "check_format"):
        matrix.check_format(full_check=True)
    return matrix.toarray() if rows <= MAX_FILE_COORDINATES else matrix.tocsr()


@contextmanager
def _parser_of(path: Path, what: str) -> Iterator[None]:
    """Turn every exception of a parser, whatever its type, into a ValueError that names the file."""
    try:
        if not (path.is_file() or path.is_dir()):  # reading a pipe or a device might never end
            raise ValueError("it is no file")
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            yield
    except OSError as error:
        raise ValueError(f"{path}: cannot be read ({error.strerror or error})") from None
    except Exception as error:  # a wrong byte makes parsers raise exceptions of any type
        raise ValueError(f"{path}: cannot be read as {what} ({str(error) or type(error).__name__})") from None


def _as_path(path: str | Path) -> Path:
    try:
        return Path(path)
    except TypeError:
        raise ValueError(f"path = {path!r} is no path; {SYSTEM_FORMATS}") from None


def _check_shape(name: str, shape: tuple[int, ...]) -> None:
    """Refuse a matrix that is not square or too large, before memory is taken for it."""
    if len(shape) != 2 or shape[0] != shape[1] or shape[0] < 1:
        raise ValueError(f"{name} has shape {tuple(shape)}; give a square matrix")
    if shape[0] > MAX_FILE_COORDINATES:
        raise ValueError(
            f"{name} is dense and has {shape[0]} coordinates; give more than {MAX_FILE_COORDINATES} as sparse matrices"
        )


def _sparse(name: str, value: Any) -> Any:
    """Return a matrix of a large system in compressed rows."""
    return value.tocsr() if is_sparse(value) else sp.csr_array(value)


def _dense(name: str, value: Any) -> FloatArray:
    """Return a matrix, or a number, as a checked square float64 array."""
    value = np.asarray(value)
    if value.ndim == 0:
        value = value.reshape(1, 1)
    _check_shape(name, value.shape)
    return real_array(name, value, 2)
