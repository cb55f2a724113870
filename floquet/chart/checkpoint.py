"""Finished tiles of a chart on disk: a chart that was stopped can be continued, and ends with the same bits."""

from __future__ import annotations

import hashlib
import io
import os
import platform
import tempfile
from collections.abc import Sequence
from contextlib import suppress
from functools import cache
from itertools import groupby
from pathlib import Path

import llvmlite.binding
import numba
import numpy as np
import scipy

from floquet.engine import Tile
from floquet.running import replace_file, source_hash
from periodic import AnySystem
from periodic.checks import FloatArray

DIGEST_BYTES = 32


class TileStore:
    """A folder of finished tiles of columns, one file each, which several processes may share.

    A file's name is the hash of everything that its content depends on: matrices, frequencies, amplitudes, steps, the
    code, the libraries and the kind of processor. A file is complete or not there, and it holds the hash of its
    content: a damaged file counts as not there.

    The store remembers which tiles it has read or written. `clear` removes these and no others.

    Parameters
    ----------
    folder : str or path-like
        Made if it does not exist.
    fresh : bool
        Use no tile that was there before; new ones are kept as usual.

    Raises
    ------
    ValueError
        If ``folder`` is no path, or cannot be made or written to.
    """

    def __init__(self, folder: str | os.PathLike[str], *, fresh: bool = False) -> None:
        if not isinstance(folder, str | os.PathLike):
            raise ValueError(f"cache = {folder!r} is not a path; give the name of a folder")
        self.folder, self.fresh = Path(folder), fresh
        self._used: set[Path] = set()
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
            tempfile.TemporaryFile(dir=self.folder).close()
        except OSError as error:
            raise ValueError(self._refusal(error)) from None

    def path(self, batches: Sequence[tuple[Sequence[AnySystem], FloatArray, FloatArray]], steps: float) -> Path:
        """Return where the tile of some batches is kept: systems, Omega and eps, as `floquet.engine.chart_batch` takes
        them."""
        digest = hashlib.sha256(code_version() + processor().encode())
        add_array(digest, np.array(steps))
        for systems, Omega, eps in batches:
            add_array(digest, Omega)
            add_array(digest, eps)
            for system, same in groupby(systems):  # most families have one system for all columns
                add_array(digest, np.array(len(list(same))))
                add_system(digest, system)
        return self.folder / f"{digest.hexdigest()}.tile"

    def load(self, path: Path) -> Tile | None:
        """Return the tile in ``path``; None if there is none, if it is damaged, or if the store is to be fresh."""
        if self.fresh and path not in self._used:
            return None
        try:
            data = path.read_bytes()
        except OSError:
            return None
        digest, content = data[:DIGEST_BYTES], data[DIGEST_BYTES:]
        if hashlib.sha256(content).digest() != digest:
            return None
        self._used.add(path)
        with np.load(io.BytesIO(content), allow_pickle=False) as arrays:
            return Tile(*(arrays[name] for name in Tile._fields))

    def save(self, path: Path, tile: Tile) -> None:
        """Write a tile in one step: it is complete or not there, even if the power fails.

        Raises
        ------
        ValueError
            If it cannot be written, for instance because the disk is full.
        """
        buffer = io.BytesIO()
        np.savez(buffer, **tile._asdict())
        content = buffer.getvalue()
        self._used.add(path)
        try:
            self.folder.mkdir(parents=True, exist_ok=True)  # another process may have cleared its tiles, and the folder
            replace_file(path, hashlib.sha256(content).digest() + content)
        except OSError as error:
            raise ValueError(self._refusal(error)) from None

    @property
    def in_use(self) -> bool:
        """Whether any tile has been read or written here."""
        return bool(self._used)

    def clear(self) -> None:
        """Remove the tiles that were read or written here, and the folder if it is empty then."""
        for path in self._used:
            path.unlink(missing_ok=True)
        self._used.clear()
        with suppress(OSError):
            self.folder.rmdir()

    def _refusal(self, error: OSError) -> str:
        return f"cache = {str(self.folder)!r} cannot be written to ({error.strerror}); give another folder"


@cache
def code_version() -> bytes:
    """Return the hash of the code that computes charts and of the versions of what it is built on."""
    digest = hashlib.sha256(source_hash().encode())
    versions = (np.__version__, scipy.__version__, numba.__version__, platform.python_version())
    digest.update("\0".join(versions).encode())
    return digest.digest()


@cache
def processor() -> str:
    """Return the kind of processor, on which the last bits of a chart depend."""
    return f"{platform.machine()} {llvmlite.binding.get_host_cpu_name()}"


def add_system(digest: hashlib._Hash, system: AnySystem) -> None:
    """Add everything that a system is to a hash."""
    digest.update(type(system).__name__.encode())
    for name, array in vars(system).items():
        if name != "terms":
            add_array(digest, array)
    for term in system.terms:
        digest.update(repr((term.of, term.waveform, term.power)).encode())
        add_array(digest, term.matrix)


def add_array(digest: hashlib._Hash, array: FloatArray) -> None:
    """Add type, shape and entries of an array to a hash."""
    digest.update(f"{array.dtype.str}{array.shape}".encode())
    digest.update(np.ascontiguousarray(array).tobytes())
