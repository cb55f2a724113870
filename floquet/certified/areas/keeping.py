"""Pieces of a proof on disk, so that a long one goes on where it was stopped."""

from __future__ import annotations

import hashlib
import io
import os
import time
from collections.abc import Sequence
from pathlib import Path
from zipfile import BadZipFile

import numpy as np

from floquet.certified.areas.chart import PartArrays, arrays_of
from floquet.certified.areas.coefficients import Coefficients
from floquet.certified.areas.search import Rectangle, search
from floquet.running import replace_file, source_hash

# Arrays with one row for each patch, leaf, sign, coefficient or rectangle; those that say where the rows of each begin.
ROWS = ("patches", "leaves", "whole", "basis", "sizes", "signs", "coef", "sign_radius", "left")
STARTS = ("first_leaf", "first_sign", "first_coef")


def piece_of(
    equation: Coefficients,
    coordinates: np.ndarray,
    piece: Rectangle,
    least: tuple[float, float],
    deadline: float,
    folder: Path | None,
) -> PartArrays:
    """Return what is proved of a rectangle: kept in ``folder``, or found and, if time did not end it, kept there."""
    if folder is None:
        return arrays_of([search(equation, piece, least, deadline)], coordinates, equation)
    path = folder / f"{_key(equation, piece, least)}.npz"
    try:
        with np.load(io.BytesIO(path.read_bytes()), allow_pickle=False) as file:
            return PartArrays(**{name: file[name] for name in PartArrays._fields})
    except (OSError, ValueError, KeyError, EOFError, BadZipFile):  # not there, or damaged
        pass
    found = arrays_of([search(equation, piece, least, deadline)], coordinates, equation)
    if time.monotonic() <= deadline:
        buffer = io.BytesIO()
        np.savez_compressed(buffer, **found._asdict())
        replace_file(path, buffer.getvalue())
    return found


def joined(parts: Sequence[PartArrays]) -> PartArrays:
    """Return the pieces of one subsystem as one."""
    arrays = parts[0]._asdict()
    for name in ROWS:
        arrays[name] = np.concatenate([getattr(part, name) for part in parts])
    for name in STARTS:
        lengths = [np.diff(getattr(part, name)) for part in parts]
        arrays[name] = np.concatenate([[0], np.cumsum(np.concatenate(lengths))]).astype(np.int64)
    arrays["degree"] = max((part.degree for part in parts), key=int)  # 0 of a piece without patches
    return PartArrays(**arrays)


def checked_folder(cache: str | os.PathLike[str] | None) -> Path | None:
    """Return the folder of kept pieces, made if it is not there.

    Raises
    ------
    ValueError
        If there can be no such folder.
    """
    if cache is None:
        return None
    try:
        folder = Path(cache)
        folder.mkdir(parents=True, exist_ok=True)
    except (TypeError, OSError) as error:
        raise ValueError(f"cache = {cache!r} is no folder ({error}); give the path of one") from None
    return folder


def _key(equation: Coefficients, piece: Rectangle, least: tuple[float, float]) -> str:
    digest = hashlib.sha256(source_hash().encode())
    for value in (*equation, *piece, *least):
        array = np.zeros(0) if value is None else np.asarray(value)
        digest.update(f"{array.shape} {array.dtype}".encode())
        digest.update(np.ascontiguousarray(array).tobytes())
    return digest.hexdigest()[:32]
