"""The sentence on a chart's audit tells what was found, in numbers."""

from __future__ import annotations

import re

import numpy as np
import pytest

from compare.audit import audit_sentence
from floquet.chart import ChartAudit

CELLS = np.array([[0, 0], [1, 2]])
NONE = [False, False]


@pytest.mark.parametrize(
    ("differences", "contradictions", "wanted"),
    [
        ([2e-9, 1e-9], NONE, "2 cells of the chart, .* at most 2.0e-09 .*, within the estimated error."),
        ([2e-9, np.nan], NONE, "1 cell of the chart, .* differs .* within the estimated error."),
        ([2e-9, 7e-8], NONE, "2 cells .* 7.0e-08 .* up to 7.0 times the estimated error: DO NOT TRUST"),
        ([2e-9, 1e-9], [False, True], "2 cells .* 2.0e-09 .* the opposite verdict came out for 1: DO NOT TRUST"),
        ([np.nan, np.nan], NONE, "No cell of the chart was integrated again"),
    ],
)
def test_the_sentence_tells_what_was_found(differences: list[float], contradictions: list[bool], wanted: str) -> None:
    audit = ChartAudit(CELLS, np.array(differences), np.full(2, 1e-8), np.array(contradictions))
    assert re.match(wanted, audit_sentence(audit))


def test_a_chart_without_audit_says_so() -> None:
    assert audit_sentence(None) == audit_sentence(ChartAudit(CELLS[:0], *3 * [np.empty(0)]))
