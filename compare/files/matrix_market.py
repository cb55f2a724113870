"""Matrix Market files, read and written as the format's own description says.

The format: Boisvert, Pozo and Remington, The Matrix Market Exchange Formats, NISTIR 5935 (1996). SciPy's compiled
reader is faster but ends the whole process on some damaged files; this one answers every file with a matrix or a
ValueError.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from periodic.checks import FloatArray

SYMMETRY_SIGNS = {"general": 0, "symmetric": 1, "skew-symmetric": -1}


def read_matrix_market(path: Path, most: int, most_sparse: int) -> Any:
    """Return the real square matrix in ``path``: dense up to ``most`` rows, sparse up to ``most_sparse``.

    Raises
    ------
    OSError
        If the file cannot be read.
    ValueError
        If it is no Matrix Market file, or the matrix is not real, not square or too large.
    """
    lines = path.read_text(encoding="utf-8", errors="replace").splitlines()
    banner = lines[0].lower().split() if lines else []
    if len(banner) != 5 or banner[:2] != ["%%matrixmarket", "matrix"]:
        raise ValueError("its first line is not: %%MatrixMarket matrix <coordinate|array> real <general|symmetric|...>")
    layout, field, symmetry = banner[2:]
    if layout not in ("coordinate", "array") or field not in ("real", "integer") or symmetry not in SYMMETRY_SIGNS:
        raise ValueError(
            f"its first line says {layout} {field} {symmetry}; give coordinate or array, real or integer, "
            f"and one of {', '.join(SYMMETRY_SIGNS)}"
        )
    rows = [line for line in lines[1:] if line.strip() and not line.startswith("%")]
    sizes = [int(text) for text in rows[0].split()] if rows else []
    limit = most_sparse if layout == "coordinate" else most
    if len(sizes) != (3 if layout == "coordinate" else 2) or sizes[0] != sizes[1] or not 1 <= sizes[0] <= limit:
        raise ValueError(f"its size line says {sizes}; give a square matrix of at most {limit} rows")
    sign = SYMMETRY_SIGNS[symmetry]
    if layout == "coordinate":
        matrix = _coordinate(rows[1:], sizes[0], sizes[2], sign)
        return matrix.toarray() if sizes[0] <= most else matrix
    return _array(np.array(" ".join(rows[1:]).split(), dtype=float), sizes[0], sign)


def write_matrix_market(path: Path, matrix: FloatArray) -> None:
    """Write a square matrix by its entries that are not zero, each with all its digits."""
    entries = [f"{i + 1} {j + 1} {float(matrix[i, j])!r}" for i, j in np.argwhere(matrix).tolist()]
    head = ["%%MatrixMarket matrix coordinate real general", f"{len(matrix)} {len(matrix)} {len(entries)}"]
    path.write_text("\n".join([*head, *entries, ""]), encoding="utf-8")


def _coordinate(rows: list[str], n: int, count: int, sign: int) -> Any:
    """Return the sparse matrix given by lines "row column value", entries of one place added up."""
    table = np.loadtxt(rows, ndmin=2, comments=None) if rows else np.empty((0, 3))
    if table.shape != (count, 3):
        raise ValueError(
            f"it has entries of shape {table.shape}; its size line announces {count} of row, column, value"
        )
    if ((table[:, :2] < 1) | (table[:, :2] > n) | (table[:, :2] % 1 != 0)).any():
        raise ValueError(f"it has an entry outside its {n} rows and columns")
    i, j = (table[:, :2].T - 1).astype(int)
    values = table[:, 2]
    if sign:
        off = i != j
        i, j = np.concatenate([i, j[off]]), np.concatenate([j, i[off]])
        values = np.concatenate([values, sign * values[off]])
    return sp.coo_array((values, (i, j)), shape=(n, n)).tocsr()


def _array(values: NDArray[np.float64], n: int, sign: int) -> FloatArray:
    """Return the matrix given column by column, only its lower triangle if it has a symmetry."""
    diagonal = 1 if sign < 0 else 0  # a skew-symmetric matrix leaves out its diagonal
    i, j = np.tril_indices(n, -diagonal) if sign else np.indices((n, n)).reshape(2, -1)
    if values.shape != i.shape:
        raise ValueError(f"it has {values.size} entries; its first lines ask for {i.size}")
    order = np.lexsort((i, j))
    i, j = i[order], j[order]
    matrix = np.zeros((n, n))
    matrix[i, j] = values
    if sign:
        matrix[j, i] = sign * values
    return matrix
