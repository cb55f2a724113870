"""docs/results.md says of the claims what computation says today; test_docs runs its other numbers."""

from __future__ import annotations

import re

import pytest

from compare.claims import judge_claims
from tests.paths import ROOT


@pytest.mark.slow
def test_the_table_of_claims_is_todays() -> None:
    page = (ROOT / "docs" / "results.md").read_text(encoding="utf-8")
    claims = judge_claims()
    expected = [
        f"| {claim.name} | {claim.verdict} | {claim.held} of {len(claim.findings)} | {len(claim.counter_examples)} |"
        for claim in claims
    ]
    assert re.findall(r"^\| .* of \d+ \| \d+ \|$", page, re.MULTILINE) == expected
    assert all(f"- **{claim.name}**" in page or f"- **{claim.name}.**" in page for claim in claims)
    assert all(claim.is_decided for claim in claims)
