"""The lines that the docstrings of perturb/ show do what they say."""

from __future__ import annotations

import doctest

import perturb


def test_the_docstring_of_the_room_runs() -> None:
    outcome = doctest.testmod(perturb)
    assert outcome.attempted > 0
    assert outcome.failed == 0
