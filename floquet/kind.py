"""The verdict on the zero solution, which all methods state in the same words."""

from __future__ import annotations

from enum import IntEnum


class Kind(IntEnum):
    """Verdict on the zero solution at one (Omega, eps).

    The last three are unstable, with the dominant multiplier real and positive, real and negative, or one of
    a complex pair. ``UNDECIDED`` means that the error estimate allows both answers.
    """

    UNDECIDED = -1
    STABLE = 0
    PLUS_ONE = 1
    MINUS_ONE = 2
    COMPLEX = 3
