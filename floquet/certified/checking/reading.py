"""Arrays of a .npz file, read by Python's own library."""

from __future__ import annotations

import ast
import hashlib
import math
import struct
import zipfile
from typing import Any

from flint import arb, arb_mat


class Refused(Exception):
    """The certificate does not prove what it says."""


def demand(holds: bool, what: str) -> None:
    if not holds:
        raise Refused(what)


class Array:
    """An array of a file: ``shape``, and the numbers one row after the other; indexing gives what is below."""

    def __init__(self, shape: tuple[int, ...], flat: Any) -> None:
        self.shape, self.flat = shape, flat

    def __getitem__(self, i: int) -> Any:
        if not 0 <= i < self.shape[0]:
            raise IndexError(f"{i} of {self.shape[0]}")
        below = math.prod(self.shape[1:])
        part = self.flat[i * below : (i + 1) * below]
        return part[0] if len(self.shape) == 1 else Array(self.shape[1:], part)

    def __len__(self) -> int:
        return self.shape[0]

    def mat(self) -> arb_mat:
        return arb_mat(self.shape[0], self.shape[1], [arb(x) for x in self.flat])


def read(path: str) -> dict[str, Array]:
    found = {}
    with zipfile.ZipFile(path) as archive:
        for name in archive.namelist():
            raw = archive.read(name)
            demand(raw[:8] == b"\x93NUMPY\x01\x00", f"{name} is no array")
            end = 10 + struct.unpack("<H", raw[8:10])[0]
            head = ast.literal_eval(raw[10:end].decode())
            kind, count = head["descr"], math.prod(head["shape"])
            demand(not head["fortran_order"] or len(head["shape"]) < 2, f"{name} is in another order")
            if kind[1] == "U":
                flat: Any = [raw[end:].decode("utf-32-le")]
            else:
                flat = struct.unpack("<" + str(count) + {"<f8": "d", "<i8": "q", "|b1": "?"}[kind], raw[end:])
            demand(kind != "<f8" or all(map(math.isfinite, flat)), f"{name} is not finite")
            found[name.removesuffix(".npy")] = Array(head["shape"], flat)
    return found


def digest(arrays: dict[str, Array]) -> str:
    text = "".join(
        f"{name}{one.shape}{[x.hex() if isinstance(x, float) else x for x in one.flat]}"
        for name, one in sorted(arrays.items())
        if name != "digest"
    )
    return hashlib.sha256(text.encode()).hexdigest()
