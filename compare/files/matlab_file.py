"""MATLAB files of version 5 to 7.3: every real matrix in them, dense or sparse.

The format: The MathWorks, MAT-File Format. SciPy's compiled reader takes more kinds of variables, but ends the whole
process on some damaged files; this one answers every file with matrices or a ValueError.
"""

from __future__ import annotations

import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from compare.files.matlab_73 import read_matlab_73

# The format's numbers for types of elements: of numbers (as NumPy calls them), of a matrix, of compressed data.
MATLAB_NUMBER_TYPES = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 9: "f8", 12: "i8", 13: "u8"}
MATRIX_TYPE, COMPRESSED_TYPE = 14, 15
# Its numbers for classes of matrices, and the flag of complex ones.
SPARSE_CLASS, NUMERIC_CLASSES = 5, range(6, 16)
COMPLEX_FLAG = 0x0800
# A compressed variable may hold so many bytes: a damaged one does not fill the memory.
MAX_VARIABLE_BYTES = 2**30
# Bytes before the first element.
HEADER_BYTES = 128


def read_matlab(path: Path, most: int, most_sparse: int) -> dict[str, Any]:
    """Return {name: matrix} of the variables in ``path``: dense up to ``most`` rows, sparse up to ``most_sparse``.

    Raises
    ------
    OSError
        If the file cannot be read.
    ValueError
        If it is no MATLAB file of version 5 or newer, is damaged, or a variable is no real matrix.
    """
    data = path.read_bytes()
    version, order = data[124:126], {b"IM": "<", b"MI": ">"}.get(data[126:128])
    if data.startswith((b"MATLAB 7.3", b"\x89HDF")):
        return read_matlab_73(path, most, most_sparse)
    if order is None or version not in (b"\x00\x01", b"\x01\x00"):
        raise ValueError("it does not start like one of version 5 to 7; save it with save(..., '-v7')")
    matrices: dict[str, Any] = {}
    for kind, content in _elements(data[HEADER_BYTES:], order):
        if kind == COMPRESSED_TYPE:
            content = _decompress(content, MAX_VARIABLE_BYTES)
            kind, content = next(_elements(content, order), (0, b""))
        if kind != MATRIX_TYPE:
            raise ValueError(f"it holds an element of type {kind} where a variable should be")
        name, matrix = _variable(content, order, most, most_sparse)
        if name in matrices:
            raise ValueError(f"it holds {name!r} twice")
        if name:  # MATLAB keeps what belongs to no variable under an empty name
            matrices[name] = matrix
    return matrices


def matrix_bytes(coordinates: int) -> int:
    """Return the most bytes that a square matrix takes in a file: its entries in the widest type, and a header."""
    return 16 * coordinates**2 + 4096


def _elements(data: bytes, order: str) -> Iterator[tuple[int, bytes]]:
    """Yield (type, content) of the elements that follow each other in ``data``."""
    at = 0
    while at < len(data):
        if len(data) - at < 8:
            raise ValueError("it ends early")
        kind, size = np.frombuffer(data, f"{order}u4", 2, at).tolist()
        if kind >> 16:  # up to four bytes sit in the tag itself
            kind, size, start, end = kind & 0xFFFF, kind >> 16, at + 4, at + 8
            if size > 4:
                raise ValueError("it has a damaged tag")
        else:
            start = at + 8
            end = start + (size if kind == COMPRESSED_TYPE else -(-size // 8) * 8)
        if start + size > len(data):
            raise ValueError("it ends early")
        yield kind, data[start : start + size]
        at = end


def _decompress(content: bytes, most_bytes: int) -> bytes:
    stream = zlib.decompressobj()
    try:
        plain = stream.decompress(content, most_bytes)
    except zlib.error:
        raise ValueError("its compressed data are damaged") from None
    if not stream.eof:
        raise ValueError(f"its compressed data end early or hold more than {most_bytes} bytes")
    return plain


def _variable(content: bytes, order: str, most: int, most_sparse: int) -> tuple[str, Any]:
    """Return name and value of a variable: array flags, dimensions, name, then the numbers."""
    flags, dimensions, label, *parts = [*_elements(content, order), *[(0, b"")] * 3]
    name = label[1].decode("ascii", errors="replace")
    if not name:
        return name, np.empty((0, 0))
    flag = int(_numbers(flags, order)[0]) if flags[1] else 0
    if flag & 0xFF != SPARSE_CLASS and flag & 0xFF not in NUMERIC_CLASSES:
        raise ValueError(f"{name} is no matrix of numbers but of class {flag & 0xFF}; leave it out")
    if flag & COMPLEX_FLAG:
        raise ValueError(f"{name} is complex; give a real matrix")
    shape = _numbers(dimensions, order).tolist()
    limit = most_sparse if flag & 0xFF == SPARSE_CLASS else most
    if len(shape) != 2 or not all(1 <= size <= limit for size in shape):
        raise ValueError(f"{name} has shape {tuple(shape)}; give a matrix of at most {limit} rows")
    values = [_numbers(part, order) for part in parts if part[0]]
    if flag & 0xFF == SPARSE_CLASS:
        matrix = _sparse(name, shape, values)
        return name, matrix.toarray() if max(shape) <= most else matrix
    if len(values) != 1 or values[0].size != shape[0] * shape[1]:
        raise ValueError(f"{name} does not hold the numbers that its shape {tuple(shape)} announces")
    return name, values[0].reshape(shape, order="F").astype(float)


def _numbers(element: tuple[int, bytes], order: str) -> NDArray[Any]:
    kind, data = element
    if kind not in MATLAB_NUMBER_TYPES:
        raise ValueError(f"it holds {len(data)} bytes of type {kind} where numbers should be")
    return np.frombuffer(data, order + MATLAB_NUMBER_TYPES[kind])


def _sparse(name: str, shape: list[int], values: list[NDArray[Any]]) -> Any:
    """Return the sparse matrix in compressed columns: row of each entry, first entry of each column, entries."""
    rows, columns = shape
    if len(values) == 3:
        row, start = values[0].astype(np.int64), values[1].astype(np.int64)
        count = int(start[-1]) if start.size == columns + 1 else -1
        if 0 <= count <= min(row.size, values[2].size) and start[0] == 0 and (np.diff(start) >= 0).all():
            row, column = row[:count], np.repeat(np.arange(columns), np.diff(start))
            if ((row >= 0) & (row < rows)).all():
                return sp.coo_array((values[2][:count].astype(float), (row, column)), shape=(rows, columns)).tocsr()
    raise ValueError(f"{name} is a damaged sparse matrix")
