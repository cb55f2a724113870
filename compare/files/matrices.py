"""Your own system from a file: matrices as .npz, MATLAB .mat or a folder of Matrix Market files."""

from __future__ import annotations

import io
import re
import warnings
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from scipy.io import savemat

from compare.files.matlab_file import matrix_bytes, read_matlab
from compare.files.matrix_market import read_matrix_market, write_matrix_market
from compare.files.publish import staged
from periodic import PeriodicSystem, stiffness_alone
from periodic.checks import FloatArray, real_array

# Coordinates and harmonics of a system from a file. So many coordinates can still be integrated; a larger model has to
# be reduced to its lowest modes first. Together they bound the memory that a damaged file can ask for.
MAX_FILE_COORDINATES, MAX_FILE_HARMONICS = 500, 64
MAX_MATRIX_BYTES = matrix_bytes(MAX_FILE_COORDINATES)

ZIP_MAGIC = b"PK\x03\x04"
MATRIX_NAMES = {"mass": "M", "gyroscopic": "G", "damping": "C", "stiffness": "K"}
REQUIRED_MATRICES = ("M", "K")
EXCITATION_NAME = re.compile(r"F([1-9][0-9]{0,8})([CS])")
SYSTEM_FORMATS = "give a .npz file, a MATLAB .mat file or a folder of Matrix Market files (.mtx)"


def load_system(path: str | Path) -> PeriodicSystem:
    """Read a system M W'' + (G + C) W' + (K + eps sum_j [Fjc cos(j Omega t) + Fjs sin(j Omega t)]) W = 0.

    Parameters
    ----------
    path : str or Path
        A .npz file, a MATLAB .mat file (version 7 or older) or a folder of Matrix Market files (M.mtx, K.mtx, ...).
        The matrices are named M, G, C, K, F1c, F1s, F2c, ..., in capitals or not, dense or sparse; M, K and one F are
        needed, the others are zero if missing. docs/matrices.md describes the format.

    Returns
    -------
    PeriodicSystem

    Raises
    ------
    ValueError
        If the file cannot be read, a name is unknown or missing, or a matrix is not what its name asks for; the
        message names file and matrix. Nothing in a file is ever executed: pickled objects are refused.
    """
    path = _as_path(path)
    if path.is_dir():
        found = _read_folder(path)
    elif path.suffix.lower() == ".npz":
        found = _read_npz(path)
    elif path.suffix.lower() == ".mat":
        found = _read_mat(path)
    else:
        fault = "has no ending that says what it holds" if path.exists() else "is not there"
        raise ValueError(f"{path}: {fault}; {SYSTEM_FORMATS}")
    matrices = {name: _dense(f"{path}: {name}", value) for name, value in found.items()}
    n = len(matrices["M"])
    for name, matrix in matrices.items():
        if matrix.shape != (n, n):
            raise ValueError(f"{path}: {name} has shape {matrix.shape}; give ({n}, {n}), as M has")
    try:
        return PeriodicSystem(**_arguments(matrices))
    except ValueError as error:
        field, _, fault = str(error).partition(" ")
        raise ValueError(f"{path}: {MATRIX_NAMES.get(field, 'F')} ({field}) {fault}") from None


def save_system(path: str | Path, system: PeriodicSystem) -> None:
    """Write a system in a form that `load_system` reads back to the last bit.

    Parameters
    ----------
    path : str or Path
        A name ending in .npz or .mat, or a folder for Matrix Market files. An old file is replaced only by a complete
        new one.
    system : PeriodicSystem
        Its matrices are written, but for those that are zero and not needed.

    Raises
    ------
    ValueError
        If ``system`` is no PeriodicSystem, has more coordinates or harmonics than `load_system` takes, or ``path``
        cannot be written to.
    """
    path = _as_path(path)
    if not isinstance(system, PeriodicSystem):
        raise ValueError(f"system = {system!r} is no PeriodicSystem; give one")
    stiffness_alone(system)
    if system.size > MAX_FILE_COORDINATES or system.harmonics > MAX_FILE_HARMONICS:
        raise ValueError(
            f"system has {system.size} coordinates and {system.harmonics} harmonics; "
            f"give at most {MAX_FILE_COORDINATES} and {MAX_FILE_HARMONICS}"
        )
    matrices = {letter: getattr(system, field) for field, letter in MATRIX_NAMES.items()}
    for j, (cosine, sine) in enumerate(zip(system.cosine, system.sine, strict=True), start=1):
        matrices |= {f"F{j}c": cosine, f"F{j}s": sine}
    # The last cosine stays even if zero: it says how many harmonics there are.
    needed = {*REQUIRED_MATRICES, f"F{system.harmonics}c"}
    matrices = {name: matrix for name, matrix in matrices.items() if name in needed or matrix.any()}
    if path.suffix.lower() in (".npz", ".mat"):
        with staged(path.parent) as folder:
            if path.suffix.lower() == ".mat":
                savemat(str(folder / path.name), matrices, appendmat=False, do_compression=True)
            else:
                with (folder / path.name).open("wb") as file:  # savez would add .npz to a name that ends in .NPZ
                    np.savez_compressed(file, **matrices)
        return
    others = sorted({file.name for file in path.glob("*.mtx")} - {f"{name}.mtx" for name in matrices})
    if others:
        raise ValueError(f"{path}: holds {', '.join(others)}, which this system does not have; give an empty folder")
    with staged(path) as folder:
        for name, matrix in matrices.items():
            write_matrix_market(folder / f"{name}.mtx", matrix)


def _arguments(matrices: Mapping[str, FloatArray]) -> dict[str, Any]:
    """Return the arguments of `PeriodicSystem`, zero where a matrix is missing."""
    zero = np.zeros_like(matrices["M"])
    arguments: dict[str, Any] = {field: matrices.get(letter, zero) for field, letter in MATRIX_NAMES.items()}
    J = max(int(name[1:-1]) for name in matrices if EXCITATION_NAME.fullmatch(name.upper()))
    for field, letter in (("cosine", "c"), ("sine", "s")):
        arguments[field] = np.array([matrices.get(f"F{j}{letter}", zero) for j in range(1, J + 1)])
    return arguments


def _names(path: Path, given: list[str]) -> dict[str, str]:
    """Return {name in the file: canonical name}, refusing unknown, repeated and missing names."""
    names: dict[str, str] = {}
    for name in given:
        upper = name.upper()
        excitation = EXCITATION_NAME.fullmatch(upper)
        if upper not in MATRIX_NAMES.values() and excitation is None:
            raise ValueError(f"{path}: {name!r} is no matrix of a system; name them M, G, C, K, F1c, F1s, F2c, ...")
        if excitation and int(excitation[1]) > MAX_FILE_HARMONICS:
            raise ValueError(f"{path}: {name} is beyond harmonic {MAX_FILE_HARMONICS}; leave it out")
        canonical = f"F{excitation[1]}{excitation[2].lower()}" if excitation else upper
        if canonical in names.values():
            raise ValueError(f"{path}: {canonical} is there twice; capitals make no difference, keep one")
        names[name] = canonical
    for letter in REQUIRED_MATRICES:
        if letter not in names.values():
            raise ValueError(f"{path}: {letter} is missing; add it")
    if not any(name.startswith("F") for name in names.values()):
        raise ValueError(f"{path}: there is no excitation; add at least one of F1c, F1s, F2c, ...")
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
        for name, canonical in _names(path, archive.files).items():
            with _parser_of(path, f"the plain array {canonical}; a sparse matrix has to be saved by its .toarray()"):
                matrices[canonical] = archive[name]
        return matrices


def _read_mat(path: Path) -> dict[str, FloatArray]:
    with _parser_of(path, "a MATLAB file"):
        variables = read_matlab(path, MAX_FILE_COORDINATES)
    return {canonical: variables[name] for name, canonical in _names(path, list(variables)).items()}


def _read_folder(path: Path) -> dict[str, FloatArray]:
    with _parser_of(path, "a folder"):
        files = {file.stem: file for file in sorted(path.iterdir()) if file.suffix.lower() == ".mtx"}
    if not files:
        raise ValueError(f"{path}: this folder has no .mtx file; {SYSTEM_FORMATS}")
    matrices = {}
    for name, canonical in _names(path, list(files)).items():
        with _parser_of(files[name], "a Matrix Market file"):
            matrices[canonical] = read_matrix_market(files[name], MAX_FILE_COORDINATES)
    return matrices


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
            f"{name} has {shape[0]} coordinates; reduce the model to its lowest modes first, "
            f"to at most {MAX_FILE_COORDINATES} coordinates"
        )


def _dense(name: str, value: Any) -> FloatArray:
    """Return a sparse or dense matrix, or a number, as a checked square float64 array."""
    if hasattr(value, "toarray"):  # sparse
        _check_shape(name, value.shape)
        value = value.toarray()
    value = np.asarray(value)
    if value.ndim == 0:
        value = value.reshape(1, 1)
    _check_shape(name, value.shape)
    return real_array(name, value, 2)
