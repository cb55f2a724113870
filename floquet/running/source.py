"""The state of the code as one hash, so that results and kernels of other code are not mistaken for those of this code.

Run as a script, this file prints the hash. It needs the standard library only: the Makefile and the tests run it before
Numba is imported.
"""

from __future__ import annotations

import hashlib
from pathlib import Path

# Packages that charts are computed with: an edit in one of them makes kept charts and compiled kernels stale.
PACKAGES = ("floquet", "periodic")


def source_hash(root: Path | None = None) -> str:
    """Return the SHA-256, in hexadecimal, of every Python file of `PACKAGES` below ``root``, names included.

    Parameters
    ----------
    root : Path, optional
        The folder that holds the packages; by default the one that this file is in.
    """
    root = root or Path(__file__).resolve().parents[2]
    digest = hashlib.sha256()
    for package in PACKAGES:
        for source in sorted((root / package).rglob("*.py")):
            digest.update(f"\0{source.relative_to(root).as_posix()}\0".encode())
            digest.update(source.read_bytes())
    return digest.hexdigest()


if __name__ == "__main__":
    print(source_hash())
