"""Errors are verified, and what is missing is skipped. No test asserts a time."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from benchmarks import PEERS, Plan, compare_methods
from benchmarks.methods import REQUIRED_ERROR, error, multipliers
from benchmarks.tables import comparison_table

TINY = Plan(columns=16, rows=8, sizes=(12,), rounds=(1,), points=2, timed=1)


def test_comparison_verifies_errors_and_skips_what_is_missing() -> None:
    absent = dataclasses.replace(PEERS[0], name="absent", package="no_such_package")
    hopeless = dataclasses.replace(PEERS[1], name="hopeless", settings=(2.0,))
    found = next(compare_methods(TINY, (PEERS[1], absent, hopeless)))
    assert found.size == 12
    assert all(ours.error < REQUIRED_ERROR for ours in found.chart)
    largest, everything, *others = found.peers
    assert 0 < largest.error <= REQUIRED_ERROR
    assert 0 < everything.error <= REQUIRED_ERROR
    assert largest.setting < everything.setting  # fewer steps will do for the largest multiplier alone
    assert len(largest.seconds) == 1
    assert "no_such_package is not installed" in others[0].skipped
    assert "no setting reached" in others[2].skipped
    table = comparison_table([found])
    assert table.count("\n") == 9
    assert "| 12 | 0 | absent | largest | skipped: no_such_package" in table


def test_errors_of_multipliers() -> None:
    exact = np.array([2.0, 1j, -0.5])
    assert error(exact[::-1], exact, "all") == 0
    assert error(exact + np.array([0, 0, 0.02]), exact, "largest") == 0
    assert error(exact + np.array([0, 0, 0.02]), exact, "all") == pytest.approx(0.01)
    assert error(2 * exact, exact, "largest") == pytest.approx(np.log(2))
    overflown = multipliers(lambda Omega, eps: np.full((3, 3), np.inf), 1.0, 1.0)
    assert error(overflown, exact, "all") == np.inf
