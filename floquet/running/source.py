"""The state of the code as one hash, so that results and kernels of other code are not mistaken for those of this code.

Run as a script, this file prints the hash of what the kernels are compiled from. It needs the standard library only:
the Makefile and the tests run it before Numba is imported.
"""

from __future__ import annotations

import ast
import hashlib
from collections.abc import Iterable
from pathlib import Path

# Packages that charts are computed with: an edit in one of them makes kept charts stale.
PACKAGES = ("floquet", "periodic")
COMPILER = "numba"


def source_hash(root: Path | None = None) -> str:
    """Return the SHA-256, in hexadecimal, of every Python file of `PACKAGES` below ``root``, names included.

    Parameters
    ----------
    root : Path, optional
        The folder that holds the packages; by default the one that this file is in.
    """
    root = _root(root)
    return _digest(root, _files(root))


def kernel_hash(root: Path | None = None) -> str:
    """Return the SHA-256, in hexadecimal, of the files that kernels are compiled from.

    Those are the files of `PACKAGES` that import Numba and all that they import, directly or through others: an edit
    elsewhere leaves compiled kernels as they are.

    Parameters
    ----------
    root : Path, optional
        As in `source_hash`.
    """
    root = _root(root)
    return _digest(root, kernel_files(root))


def kernel_files(root: Path) -> list[Path]:
    """Return the files that kernels are compiled from: those that import Numba, and all that they import."""
    modules = {".".join(file.relative_to(root).with_suffix("").parts): file for file in _files(root)}
    modules = {name.removesuffix(".__init__"): file for name, file in modules.items()}
    imported = {name: _imports(file) for name, file in modules.items()}
    waiting = [name for name, others in imported.items() if COMPILER in others]
    found: set[str] = set()
    while waiting:
        name = waiting.pop()
        if name in modules and name not in found:
            found.add(name)
            waiting.extend(imported[name])
    return sorted(modules[name] for name in found)


def _root(root: Path | None) -> Path:
    return root or Path(__file__).resolve().parents[2]


def _files(root: Path) -> list[Path]:
    return [file for package in PACKAGES for file in sorted((root / package).rglob("*.py"))]


def _imports(file: Path) -> set[str]:
    """Return the names of the modules that a file may import; of ``from a import b``, both a and a.b."""
    names: set[str] = set()
    for node in ast.walk(ast.parse(file.read_bytes())):
        if isinstance(node, ast.Import):
            names.update(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            names.update([node.module, *(f"{node.module}.{alias.name}" for alias in node.names)])
    return names


def _digest(root: Path, files: Iterable[Path]) -> str:
    digest = hashlib.sha256()
    for file in files:
        digest.update(f"\0{file.relative_to(root).as_posix()}\0".encode())
        digest.update(file.read_bytes())
    return digest.hexdigest()


if __name__ == "__main__":
    print(kernel_hash())
