"""What the long commands share: workers here or elsewhere, finished tiles that are kept, and exit statuses."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Callable
from contextlib import suppress
from io import TextIOWrapper
from pathlib import Path
from typing import Any, TextIO

from compare.cluster import workers_at
from floquet.chart import TileStore

# The folder, inside that of the results, that keeps finished tiles of charts until all is written.
UNFINISHED_FOLDER = ".unfinished"
ALL_MODES_HELP = "integrate every mode of a large model, also those far above the window, which takes much longer"
STOPPED_RUNS_HELP = f"""\
A run that was stopped, by Ctrl-C, kill -9 or a power cut, goes on where it was if you give the same command again with
--resume. Finished parts of charts are kept in {UNFINISHED_FOLDER}, in the output folder, until all is written. The
results are the same to the last bit. Traced boundaries are not kept but computed again.
"""


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
