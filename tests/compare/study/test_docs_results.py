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
        f"| {claim.name} | {' | '.join(judgement.sentence for judgement in claim.judgements)} |" for claim in claims
    ]
    assert re.findall(r"^\| .* \| (?:mostly )?(?:holds|does not hold).* \|$", page, re.MULTILINE) == expected
    assert all(f"- **{claim.name}**" in page or f"- **{claim.name}.**" in page for claim in claims)
    assert all(claim.is_decided for claim in claims)
    terms = re.search(r"largest changes left: [^)]*", claims[0].judgements[0].instances.where)
    assert terms is not None
    assert terms[0].removeprefix("largest changes left: ") in page
