"""What the commands share: reading the command line, workers, finished tiles that are kept, and exit statuses."""

from __future__ import annotations

import argparse
import os
import re
import sys
from collections.abc import Callable
from contextlib import suppress
from importlib.util import find_spec
from io import TextIOWrapper
from pathlib import Path
from typing import Any, NoReturn, TextIO

from compare.cluster import workers_at
from compare.files import did_you_mean, shipped_cases
from floquet.chart import TileStore
from periodic.checks import interval, real_number

# The folder, inside that of the results, that keeps finished tiles of charts until all is written.
UNFINISHED_FOLDER = ".unfinished"
ALL_MODES_HELP = "integrate every mode of a large model, also those far above the window, which takes much longer"
STOPPED_RUNS_HELP = f"""\
A run that was stopped, by Ctrl-C, kill -9 or a power cut, goes on where it was if you give the same command again with
--resume. Finished parts of charts are kept in {UNFINISHED_FOLDER}, in the output folder, until all is written. The
results are the same to the last bit. Traced boundaries are not kept but computed again.
"""

CASE_HELP = f"a case file, or the name of a shipped case: {', '.join(path.stem for path in shipped_cases())}"
SYSTEM_HELP = "your system: .npz, .mat, a folder of .mtx files or a .py file"
SYSTEM_FILES_HELP = """\
The arrays of a system's file are M, G, C, K of M q" + (G + C) q' + K q = 0, and what is multiplied by
eps cos(j Omega t) or eps sin(j Omega t): K1c, K1s, C2c, ... A .py file defines a function system() that returns the
system, with waveforms that jump, if need be. All of it: docs/matrices.md and docs/systems.md of the sources.
"""


class Parser(argparse.ArgumentParser):
    """A command line that says in one sentence what is wrong with it, and what may have been meant.

    Its help names the command as the reader has started it: ``{command}`` in ``epilog`` stands for it.
    """

    def __init__(self, name: str, description: str | None, epilog: str) -> None:
        self._name = name
        script = Path(sys.argv[0]).name == f"{name}.py"
        command = f"scripts/{name}.py" if script else f"floquet-charts {name}"
        super().__init__(
            prog=command,
            description=description,
            epilog=epilog.replace("{command}", command),
            formatter_class=argparse.RawDescriptionHelpFormatter,
        )

    def error(self, message: str) -> NoReturn:
        """End with exit status 2 and a sentence."""
        unknown = re.fullmatch(r"unrecognized arguments: (\S+).*", message, re.DOTALL)
        choice = re.fullmatch(r".*invalid choice: '([^']*)' \(choose from (.*)\)", message, re.DOTALL)
        hint = ""
        if unknown:
            message = f"{unknown[1]} is not known here"
            hint = did_you_mean(unknown[1], (name for action in self._actions for name in action.option_strings))
        elif choice:
            hint = did_you_mean(choice[1], choice[2].replace("'", "").split(", "))
        print(f"{self._name}: {message}{hint}; {self.prog} --help shows all", file=sys.stderr)
        sys.exit(2)


def check_window(options: argparse.Namespace) -> None:
    """Refuse what is no window, by the names of the options. Raises ValueError."""
    if options.Omega is not None:
        real_number("--Omega", interval("--Omega", options.Omega)[0], positive=True)
    if options.eps is not None:
        real_number("--eps", options.eps, positive=True)


def check_extra(option: str, package: str, extra: str) -> None:
    """Refuse an option whose package is missing, before anything is computed. Raises ValueError."""
    if find_spec(package) is None:
        raise ValueError(f"{option} needs {package}; install it with: pip install 'floquet-charts[{extra}]'")


def point(text: str) -> tuple[float, float]:
    """Return the point of ``--at``."""
    try:
        Omega, eps = map(float, text.split(","))
        return real_number("Omega", Omega, positive=True), real_number("eps", eps)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is no point; give Omega > 0 and eps, such as 18.6,0.3") from None


class _Steady:
    """A stream that writes into nothing once nobody reads it any more, as after `| head`, so that the work goes on."""

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream

    def write(self, text: str) -> int:
        return self._kept(lambda: self._stream.write(text)) or 0

    def flush(self) -> None:
        self._kept(self._stream.flush)

    def _kept(self, output: Callable[[], Any]) -> Any:
        try:
            return output()
        except BrokenPipeError:
            os.dup2(os.open(os.devnull, os.O_WRONLY), self._stream.fileno())
            return None

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)


def steady_output() -> None:
    """Let no output stop the work: neither a terminal without Greek letters nor a reader that has gone."""
    for name in ("stdout", "stderr"):
        stream = getattr(sys, name)
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors="replace")
            setattr(sys, name, _Steady(stream))


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the options that say where a long run is computed, and where its tiles are kept."""
    running = parser.add_argument_group("running")
    running.add_argument("--jobs", type=_jobs, default=-1, metavar="N", help="workers (-1: one for each core)")
    running.add_argument("--dask", metavar="ADDRESS", help="compute on the workers of this dask scheduler instead")
    running.add_argument(
        "--resume",
        nargs="?",
        type=Path,
        const=Path(UNFINISHED_FOLDER),
        metavar="DIR",
        help=f"go on where a stopped run was; DIR, or else OUTPUT/{UNFINISHED_FOLDER}, keeps its parts of charts",
    )
    running.add_argument("--no-progress", action="store_true", help="no progress bars")


def run(name: str, options: argparse.Namespace, work: Callable[[TileStore], int]) -> int:
    """Do ``work`` and return its exit status; 2 for wrong input and 130 for Ctrl-C, each with a sentence."""
    own = options.resume in (None, Path(UNFINISHED_FOLDER))
    folder = options.output / UNFINISHED_FOLDER if own else options.resume
    store, status = None, None
    try:
        if own and any(folder.glob("*.tile")):
            what = f"{folder} holds finished parts of charts of a run that was stopped"
            print(what if options.resume else f"{what}; --resume goes on with them")
        try:
            store = TileStore(folder, fresh=options.resume is None)
        except ValueError as error:
            raise ValueError(f"{f'--output {options.output}' if own else f'--resume {folder}'}: {error}") from None
        with workers_at(options.dask) as remark:
            if remark:
                print(remark)
            status = work(store)
        if own:
            store.clear()
        return status
    except ValueError as error:
        return _stopped(name, str(error), store, 2)
    except KeyboardInterrupt:
        written = "nothing was" if status is None else "all was"
        return _stopped(name, f"interrupted; {written} written", store, 130)
    finally:
        with suppress(OSError):  # it may hold finished tiles
            folder.rmdir()


def _stopped(name: str, why: str, store: TileStore | None, status: int) -> int:
    """Say why the command ends, and how to go on if any tile has been kept."""
    print(f"{name}: {why}", file=sys.stderr)
    if store is not None and store.in_use:
        print(
            f"Finished parts of charts are kept in {store.folder}: the same command with --resume goes on from there.",
            file=sys.stderr,
        )
    return status


def _jobs(text: str) -> int:
    try:
        number = int(text)
    except ValueError:
        number = 0
    if number == 0 or number < -1:
        raise argparse.ArgumentTypeError(f"{text!r} is no number of workers; give 1, 2, ... or -1 for all cores")
    return number
