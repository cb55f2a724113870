"""One statement of the program, and what the other integrator says of it."""

from __future__ import annotations

from enum import StrEnum
from typing import NamedTuple


class Judged(StrEnum):
    """What became of a statement."""

    TRUE = "true"
    WRONG = "wrong"
    WITHHELD = "withheld"  # the program says that it cannot tell
    TOO_FINE = "too fine"  # the other integrator cannot tell


class Statement(NamedTuple):
    """A sentence about a system, and what became of it."""

    about: str
    sentence: str
    judged: Judged


class Case(NamedTuple):
    """A system of some sort and all that is asked of it, from one seed."""

    seed: int
    sort: str
    asked: str
    statements: list[Statement]
