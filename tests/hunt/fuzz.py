"""Damaged input files: how they are made, and what a reader may make of them. Run by `test_fuzz.py` in child processes.

Every input follows from its number alone, so that `python -m tests.hunt.fuzz 4711 4712 1 FOLDER` shows one again.
"""

from __future__ import annotations

import contextlib
import faulthandler
import io
import json
import re
import resource
import sys
import warnings
import zipfile
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import scipy.io
import scipy.sparse

from compare.files import MATRIX_NAMES, Plate, load_case, load_system
from floquet import monodromy
from periodic import PeriodicSystem
from periodic.examples import coupled_mathieu, gyroscopic_rotor, meissner
from scripts import explore, validate
from tests.hunt.damage import BYTES, TEXT, Random
from tests.paths import ROOT

SECONDS = 300  # for one input: one that is a system after all may compute for a while, on a busy machine
MEMORY = 2**31  # bytes that it may ask for beyond what the process has; a chart of 64 harmonics takes half of it
LONGEST_MESSAGE = 4000  # characters: an error is read by a person
OF_THE_WHOLE_FILE = "|".join(
    [
        "not a TOML file",
        "cannot be read",
        "unknown key",
        "no excitation",
        "no matrix of a system",
        r"\d+ bytes",
        "no .mtx",
    ]
)

STIFF = 1e3  # rate of the fastest motion, from which on a chart of ordinary frequencies takes minutes
SAMPLE = 25  # every so many inputs the command line is tried as well

Files = dict[str, bytes]  # one file, or those of a folder of Matrix Market files


class Mutant(NamedTuple):
    form: str
    kind: str
    files: Files


# --- case files ---

SMALL_CASE = """title = "everything, small"
compare = "beside"
regions = [[1, 1], [1, 3]]
[plate]
aspect_ratio = 1.5
speed = 1.0
tension = 10.0
damping = 1e-4
poisson_ratio = 0.25
thickness_ratio = 0.02
inplane = "dynamic"
axial_terms = 2
lateral_terms = 3
inplane_terms = [3, 2]
[plate.load]
shape = "samples"
parameters = {y = [0.0, 0.5, 1.0], f = [0.5, 1.5, 0.5]}
waveform = {1 = [1.0, 0.0], 3 = [0.1, 0.2]}
[chart]
Omega = [5.0, 60.0]
eps = 0.3
points = [8, 4]
[[variants]]
label = "as it is"
[[variants]]
label = "other"
plate = {tension = 12.0, load = {shape = "partial", parameters = {width = 0.5, centre = 0.4}, waveform = "square"}}
"""
PLAIN_CASE = """title = "plain"
[plate]
axial_terms = 2
lateral_terms = 2
load = {shape = "linear", parameters = {left = 0.5, right = 1.5}, waveform = "triangle", harmonics = 3}
[chart]
eps = 0.5
points = [6, 3]
"""
CASE_KEYS = "|".join(sorted(set(re.findall(r"\w+(?= =)", SMALL_CASE + PLAIN_CASE)) | {"plate", "load", "chart"}))


def toml_mutant(random: Random) -> Mutant:
    kind = str(random.choice(list(TEXT)))
    shipped = sorted((ROOT / "cases").glob("*.toml"))
    texts = (
        [SMALL_CASE.encode()] * 5 + [PLAIN_CASE.encode()] * 4 + [shipped[random.integers(len(shipped))].read_bytes()]
    )
    return Mutant("toml", kind, {"case.toml": TEXT[kind](texts[random.integers(len(texts))], random)})


# --- matrices ---


def matrices_of(random: Random) -> dict[str, Any]:
    systems = (gyroscopic_rotor(damping=0.1), coupled_mathieu("difference"), meissner(harmonics=3))
    system = systems[random.integers(len(systems))]
    found = {letter: getattr(system, field) for field, letter in MATRIX_NAMES.items()}
    for j, (cosine, sine) in enumerate(zip(system.cosine, system.sine, strict=True), start=1):
        found |= {f"F{j}c": cosine, f"F{j}s": sine}
    return {name: np.array(matrix) for name, matrix in found.items()}


NUMBERS = (0.0, -1.0, 1e308, -1e308, 5e-324, 1e160, 1e-160, np.nan, np.inf, -np.inf, 1e9, 1e16)
NAMES = [
    "m",
    "G",
    "g",
    "C",
    "F0c",
    "F1",
    "F1C",
    "F01c",
    "F64s",
    "F65c",
    "F999999999s",
    "Q",
    "mass",
    "F1c2",
    "../M",
    "é",
]


def odd_number(matrices: dict[str, Any], name: str, random: Random) -> None:
    if random.integers(2):
        matrices[name].flat[random.integers(matrices[name].size)] = NUMBERS[random.integers(len(NUMBERS))]
    else:
        matrices[name] *= NUMBERS[random.integers(len(NUMBERS))]


def odd_shape(matrices: dict[str, Any], name: str, random: Random) -> None:
    A = matrices[name]
    others = (
        A[:1],
        A[:, :0],
        A[None],
        A.ravel(),
        np.eye(len(A) + 1),
        np.zeros((0, 0)),
        np.eye(501),
        A.sum(),
        A[:, ::-1],
    )
    matrices[name] = others[random.integers(len(others))]


def odd_type(matrices: dict[str, Any], name: str, random: Random) -> None:
    A = matrices[name]
    pairs = np.zeros(A.shape, dtype=[("x", float)])
    others = (A + 1j, A.astype(bool), A.astype(str), A.astype(object), A.astype(np.int8), A.astype(np.float16), pairs)
    matrices[name] = others[random.integers(len(others))]


def odd_name(matrices: dict[str, Any], name: str, random: Random) -> None:
    """A matrix missing, under another name, or there twice but for capitals."""
    value = matrices[name] if random.integers(3) == 0 else matrices.pop(name)
    if random.integers(3):
        matrices[NAMES[random.integers(len(NAMES))]] = value


MATRICES: dict[str, Callable[[dict[str, Any], str, Random], None]] = {
    "odd numbers": odd_number,
    "wrong shape": odd_shape,
    "wrong type": odd_type,
    "names": odd_name,
}


def mutated_matrices(kind: str, random: Random) -> dict[str, Any]:
    matrices = matrices_of(random)
    if kind in MATRICES:
        with np.errstate(all="ignore"):
            MATRICES[kind](matrices, str(random.choice(list(matrices))), random)
    return matrices


def zipped(members: Files) -> bytes:
    file = io.BytesIO()
    with warnings.catch_warnings(), zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as archive:
        warnings.simplefilter("ignore")  # of names that are there twice
        for name, data in members.items():
            archive.writestr(name, data)
    return file.getvalue()


def as_npy(value: Any) -> bytes:
    file = io.BytesIO()
    np.lib.format.write_array(file, np.asarray(value), allow_pickle=True)
    return file.getvalue()


def npz_mutant(random: Random) -> Mutant:
    kind = str(random.choice([*BYTES, *MATRICES, "inside", "false size"]))
    members = {f"{name}.npy": as_npy(value) for name, value in mutated_matrices(kind, random).items()}
    name = str(random.choice(list(members)))
    if kind == "inside":  # behind the checksums
        members[name] = [*BYTES.values()][random.integers(3)](members[name], random)
    if kind == "false size":
        size = b"%d" % 10 ** int(random.choice([3, 9, 18, 30]))
        shape = [b"(%s, %s)", b"(%s, 2)", b"(-%s, %s)", b"(%s,)"][random.integers(4)].replace(b"%s", size)
        header = re.sub(rb"\([^)]*\)", shape, members[name], count=1)
        members[name] = header if random.integers(2) else header + bytes(10**7)
    data = zipped(members)
    return Mutant("npz", kind, {"a.npz": BYTES[kind](data, random) if kind in BYTES else data})


def mat_mutant(random: Random) -> Mutant:
    kind = str(random.choice([*BYTES, *MATRICES, "inside", "false size"]))
    matrices = mutated_matrices(kind, random)
    if random.integers(3) == 0:
        with contextlib.suppress(Exception):
            matrices |= {name: scipy.sparse.csc_matrix(value) for name, value in matrices.items()}
    file = io.BytesIO()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            scipy.io.savemat(file, matrices, do_compression=kind not in ("inside", "false size"))
        except Exception:  # what SciPy will not write cannot come from it
            return Mutant("mat", kind, {"a.mat": b""})
    data = file.getvalue()
    if kind == "false size":  # tags, flags and dimensions are words of four bytes
        at = 128 + 4 * int(random.integers((len(data) - 128) // 4))
        size = int(random.choice([0, 5, 501, 10**6, 10**9, 2**31 - 1, 2**32 - 1]))
        data = data[:at] + size.to_bytes(4, "little") + data[at + 4 :]
    elif kind in BYTES or kind == "inside":
        data = BYTES.get(kind, [*BYTES.values()][random.integers(3)])(data, random)
    if kind in ("inside", "false size") and random.integers(2):  # behind the checksum of compressed data
        element = zlib.compress(data[128:] if random.integers(9) else bytes(10**8))
        data = data[:128] + (15).to_bytes(4, "little") + len(element).to_bytes(4, "little") + element
    return Mutant("mat", kind, {"a.mat": data})


def as_matrix_market(value: Any, random: Random) -> bytes:
    file = io.BytesIO()
    A = np.asarray(value)
    if A.ndim != 2 or A.dtype.kind not in "fiuc" or not np.isfinite(A).all():
        rows = "\n".join(str(entry) for entry in A.ravel().tolist())
        return f"%%MatrixMarket matrix array real general\n{' '.join(map(str, A.shape))}\n{rows}\n".encode()
    A = A if A.dtype != np.float16 else A.astype(float)
    scipy.io.mmwrite(file, A if random.integers(2) else scipy.sparse.coo_matrix(A), precision=17)
    return file.getvalue()


def mtx_mutant(random: Random) -> Mutant:
    kind = str(random.choice([*TEXT, *MATRICES, "false size"]))
    files = {
        f"{n.replace('/', '-')}.mtx": as_matrix_market(A, random) for n, A in mutated_matrices(kind, random).items()
    }
    name = str(random.choice(list(files)))
    if kind in TEXT:
        files[name] = TEXT[kind](files[name], random)
    if kind == "false size":
        size = str(10 ** int(random.choice([0, 3, 9, 30])))
        line = [f"{size} {size} {size}", f"2 2 {size}", f"-{size} -{size}", f"{size} {size}", "2 2"][random.integers(5)]
        files[name] = re.sub(rb"(?m)^\d+ \d+.*$", line.encode(), files[name], count=1)
    return Mutant("mtx", kind, files)


MAKERS = {"toml": toml_mutant, "npz": npz_mutant, "mat": mat_mutant, "mtx": mtx_mutant}


def mutant(number: int) -> Mutant:
    """Return input ``number``; the four formats take turns."""
    return [*MAKERS.values()][number % len(MAKERS)](np.random.default_rng(number))


# --- what a reader may do ---


def written(case: Mutant, folder: Path) -> Path:
    """Write the input below ``folder`` and return what a user would name: a file, or the folder of .mtx files."""
    place = folder / "input"
    place.mkdir(parents=True)
    for name, data in case.files.items():
        (place / name).write_bytes(data)
    return place if case.form == "mtx" else place / next(iter(case.files))


def verdict(path: Path, form: str) -> tuple[str, str]:
    """Return ("result", "") or ("error", message) if all is as it should be, and ("fault", what) otherwise."""
    try:
        _use(path, form)
    except ValueError as error:
        message = str(error)
        keys = CASE_KEYS if form == "toml" else "M|G|C|K|F[0-9]+[cs]?|F"
        if path.name not in message:
            return "fault", f"the error does not name the file: {message[:300]}"
        if len(message) > LONGEST_MESSAGE:
            return "fault", f"the error has {len(message)} characters: {message[:300]}"
        about = message.replace(str(path), "")
        if not re.search(rf"\b({keys})\b|{OF_THE_WHOLE_FILE}", about):
            return "fault", f"the error names neither key nor matrix: {message[:300]}"
        return "error", message
    except Exception as error:  # the very thing that is hunted
        return "fault", f"{type(error).__name__}: {str(error)[:300]}"
    return "result", ""


def _use(path: Path, form: str) -> None:
    """Read the file; what it holds must be usable, or say why not."""
    if form == "toml":
        for plate in load_case(path).systems().values():
            plate.at(30.0)
        return
    system = load_system(path)
    if not isinstance(system, PeriodicSystem):
        raise TypeError(f"gave {system!r}")
    try:
        monodromy(system, min(max(fastest(system), 1.0), 1e100), 0.1)
    except ValueError as error:  # of the system itself, whose file is no longer known
        if not re.search("Omega|eps|mass|stiffness", str(error)):
            raise RuntimeError(f"unclear: {error}") from None


def fastest(system: PeriodicSystem) -> float:
    """Return about the rate of the fastest motion, so that one period of it has few steps."""
    with np.errstate(all="ignore"):
        size = max(float(np.abs(F).max()) for F in (system.stiffness, system.cosine, system.sine))
        light = float(np.diag(system.mass).min())
        gyration = max(float(np.abs(S).max()) for S in (system.gyroscopic, system.damping)) / light
        return float(np.nan_to_num(max(np.sqrt(size / light), gyration), nan=np.inf, posinf=1e300))


def command_line(path: Path, form: str, folder: Path) -> str:
    """Run the scripts on the input; return what is wrong with how they end, or nothing."""
    option = "--case" if form == "toml" else "--system"
    small = ["--points", "4", "3", "--no-regions", "--jobs", "1", "--no-progress"]
    if form != "toml" and verdict(path, form)[0] == "result" and fastest(load_system(path)) > STIFF:
        return ""
    runs: list[tuple[Callable[[list[str]], int], list[str]]] = [(explore.main, [option, str(path), *small])]
    if form == "toml" and verdict(path, form)[0] == "error":  # else it would draw the whole case
        runs.append((validate.main, [option, str(path), "--no-progress"]))
    for main, arguments in runs:
        output, errors = folder / "output", io.StringIO()
        try:
            with contextlib.redirect_stderr(errors), contextlib.redirect_stdout(io.StringIO()):
                status = main([*arguments, "--output", str(output)])
        except (Exception, SystemExit) as error:
            return f"{main.__module__}: {type(error).__name__}: {str(error)[:300]}"
        files = sorted(p.name for p in output.rglob("*")) if output.exists() else []
        if status == 2 and (files or not errors.getvalue().strip()):
            return f"{main.__module__}: status 2, with files {files} and the message {errors.getvalue()!r}"
        if status not in (0, 2) or (status == 0 and not files):
            return f"{main.__module__}: status {status} with files {files}"
    return ""


def run(numbers: range, folder: Path) -> None:
    """Try each input; print its number before, and a line of JSON after."""
    warnings.simplefilter("ignore")
    # what has to be compiled, imported or opened once
    monodromy(gyroscopic_rotor(damping=0.1), 1.0, 0.1)
    Plate().build().at(30.0)
    size = (
        int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize() if sys.platform == "linux" else 0
    )
    if size:
        resource.setrlimit(resource.RLIMIT_AS, (size + MEMORY, size + MEMORY))
    for number in numbers:
        print(number, flush=True)
        faulthandler.dump_traceback_later(SECONDS, exit=True)
        case = mutant(number)
        place = folder / str(number)
        path = written(case, place)
        outcome, what = verdict(path, case.form)
        if outcome != "fault" and number // len(MAKERS) % SAMPLE == 0 and (ill := command_line(path, case.form, place)):
            outcome, what = "fault", ill
        faulthandler.cancel_dump_traceback_later()
        print(json.dumps([case.form, case.kind, outcome, what]), flush=True)


if __name__ == "__main__":
    first, last, step = map(int, sys.argv[1:4])
    run(range(first, last, step), Path(sys.argv[4]))
