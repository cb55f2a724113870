"""Write a folder of results: an old result is replaced only by a complete new one."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def staged(folder: str | Path) -> Iterator[Path]:
    """Yield an empty folder; once the ``with`` block has succeeded, its files move into ``folder``, each in one step.

    If the block raises, or the process dies, ``folder`` keeps the files that it had. Other files in it are never
    touched.

    Parameters
    ----------
    folder : str or Path
        Where the files go in the end. It is made if it does not exist.

    Raises
    ------
    ValueError
        If ``folder`` cannot be made or written to, the disk is full, or a folder stands where a file has to go.
    """
    target = Path(folder)
    try:
        target.mkdir(parents=True, exist_ok=True)
        # Inside the target, so that the moves stay on one file system and are atomic.
        workspace = tempfile.TemporaryDirectory(prefix=".incomplete-", dir=target)
    except OSError as error:
        raise ValueError(f"{target}: cannot be written to ({error.strerror}); give another folder") from None
    with workspace as name:
        stage = Path(name)
        try:
            yield stage
            for path in sorted(stage.rglob("*")):
                if path.is_file():
                    final = target / path.relative_to(stage)
                    final.parent.mkdir(parents=True, exist_ok=True)
                    os.replace(path, final)
        except OSError as error:
            where = error.filename2 or error.filename or target
            raise ValueError(f"{where}: results cannot be written ({error.strerror or error})") from error
