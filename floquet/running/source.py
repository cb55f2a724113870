"""The state of the code, as one hash: what was computed or compiled by other code is not taken for this one's.

Run as a script it prints the hash. It needs nothing but the standard library, so that the Makefile and the tests can
ask before Numba is there.
"""

from __future__ import annotations

import hashlib
from pathlib import Path

# What charts are computed by: the folders whose edits make kept charts and compiled kernels stale.
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
