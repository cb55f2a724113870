"""Which of many cases belong to `make test`: a few of each kind; `make test-full` runs all."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from typing import Any

import pytest


def all_but(slow: Collection[Any], cases: Iterable[Any]) -> list[Any]:
    """Return ``cases`` as parameters of a test, those in ``slow`` marked so.

    Raises
    ------
    ValueError
        If there is no such case: a list of slow ones must not outlive them.
    """
    cases = list(cases)
    if unknown := [case for case in slow if case not in cases]:
        raise ValueError(f"slow = {unknown!r} are no cases; give some of {cases!r}")
    return [pytest.param(case, marks=pytest.mark.slow) if case in slow else case for case in cases]
