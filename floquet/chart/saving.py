"""Charts as files and as xarray data sets."""

from __future__ import annotations

import io
import os
import zipfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from floquet.chart.audit import ChartAudit
from floquet.running import replace_file

AUDIT_ARRAYS = ("cells", "differences", "estimates", "contradictions")
Chart = TypeVar("Chart")


def save_arrays(path: Any, arrays: Mapping[str, Any], audit: ChartAudit | None) -> None:
    """Write arrays and an audit to the .npz file ``path``, which is replaced only once the new file is complete.

    Raises
    ------
    ValueError
        If ``path`` is not a path.
    OSError
        If the file cannot be written.
    """
    target, content = _path(path), dict(arrays)
    if audit is not None:
        content |= {f"audit_{name}": getattr(audit, name) for name in AUDIT_ARRAYS}
    buffer = io.BytesIO()
    np.savez_compressed(buffer, **content)
    replace_file(target, buffer.getvalue())


def load_arrays(path: Any, make: Callable[[Mapping[str, NDArray[Any]], ChartAudit | None], Chart]) -> Chart:
    """Return what ``make`` makes of the arrays and the audit in a file that `save_arrays` wrote.

    Raises
    ------
    OSError
        If there is no such file.
    ValueError
        If ``path`` is not a path, or ``make`` finds that the file is not its chart.
    """
    source = _path(path)
    try:
        with source.open("rb") as file, np.load(file, allow_pickle=False) as arrays:
            found = (arrays[f"audit_{name}"] for name in AUDIT_ARRAYS)
            return make(arrays, ChartAudit(*found) if "audit_cells" in arrays else None)
    except (KeyError, ValueError, TypeError, AttributeError, EOFError, zipfile.BadZipFile) as error:
        message = f"path = {str(path)!r} is not a saved chart ({error}); give a file that save wrote"
        raise ValueError(message) from None


def data_set(
    cells: Mapping[str, NDArray[Any]], axes: tuple[str, str], coordinates: Mapping[str, Any], **attributes: Any
) -> Any:
    """Return an `xarray.Dataset` of arrays over two axes, rows first.

    Raises
    ------
    ImportError
        If xarray is not installed.
    """
    try:
        import xarray
    except ImportError:
        message = "to_xarray needs the package xarray; install it with: pip install 'floquet-charts[xarray]'"
        raise ImportError(message) from None
    return xarray.Dataset({name: (axes, array) for name, array in cells.items()}, coords=coordinates, attrs=attributes)


def _path(path: Any) -> Path:
    if not isinstance(path, str | os.PathLike):
        raise ValueError(f"path = {path!r} is not a path; give a file name")
    return Path(path)
