"""What somebody may have meant who wrote a name that is not known."""

from __future__ import annotations

from collections.abc import Iterable
from difflib import get_close_matches

# How alike two names are at least, from 0 to 1, for one to be taken for a slip of the other.
MIN_LIKENESS = 0.6


def did_you_mean(word: str, known: Iterable[str]) -> str:
    """Return "; did you mean ...?" with the known name most like ``word``, whatever its case; empty if none is like it.

    >>> did_you_mean("omega", ["eps", "Omega"])
    '; did you mean Omega?'
    """
    names = {name.casefold(): name for name in known}
    found = get_close_matches(word.casefold(), names, n=1, cutoff=MIN_LIKENESS)
    return f"; did you mean {names[found[0]]}?" if found else ""
