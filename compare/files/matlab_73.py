"""MATLAB files of version 7.3, which are HDF5 files: every real matrix in them, dense or sparse, through h5py."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import scipy.sparse as sp

# The attribute that says how many rows a sparse matrix has; its group holds values, rows and starts of columns.
SPARSE_ATTRIBUTE = "MATLAB_sparse"


def read_matlab_73(path: Path, most: int, most_sparse: int) -> dict[str, Any]:
    """Return {name: matrix} of the variables in ``path``: dense up to ``most`` rows, sparse up to ``most_sparse``.

    Raises
    ------
    ValueError
        If h5py is not installed, or a variable is no real matrix of such a size.
    """
    try:
        import h5py
    except ImportError:
        raise ValueError(
            "it is of version 7.3, which needs h5py: pip install 'floquet-charts[matlab73]'; or save it with "
            "save(..., '-v7')"
        ) from None
    with h5py.File(path, "r") as file:
        return {name: _matrix(name, file[name], most, most_sparse) for name in file if not name.startswith("#")}


def _matrix(name: str, value: Any, most: int, most_sparse: int) -> Any:
    if SPARSE_ATTRIBUTE in value.attrs:
        rows, columns = int(value.attrs[SPARSE_ATTRIBUTE]), len(value["jc"]) - 1
        _check(name, (rows, columns), most_sparse)
        if "data" not in value:  # no entry that is not zero
            return _dense_if_small(sp.csr_array((rows, columns)), most)
        parts = (value["data"][:].astype(float), value["ir"][:].astype(np.int64), value["jc"][:].astype(np.int64))
        matrix = sp.csc_array(parts, shape=(rows, columns))
        matrix.check_format(full_check=True)
        return _dense_if_small(matrix.tocsr(), most)
    shape = getattr(value, "shape", None)
    if shape is None or value.dtype.kind not in "fiu":
        raise ValueError(f"{name} is no matrix of real numbers; leave it out")
    _check(name, shape, most)
    return value[:].T.astype(float)  # MATLAB counts columns first


def _check(name: str, shape: tuple[int, ...], limit: int) -> None:
    if len(shape) != 2 or not all(1 <= size <= limit for size in shape):
        raise ValueError(f"{name} has shape {tuple(shape)}; give a matrix of at most {limit} rows")


def _dense_if_small(matrix: Any, most: int) -> Any:
    return matrix.toarray() if max(matrix.shape) <= most else matrix
