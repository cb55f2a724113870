"""The table of deliberate faults in docs/testing.md."""

from __future__ import annotations

import re

from tests.hunt.faults import FAULTS
from tests.paths import ROOT

PAGE = ROOT / "docs" / "testing.md"
HEADER = "| fault | in | caught by |\n|---|---|---|\n"


def with_table(page: str) -> str:
    """Return the page with its table of faults renewed."""
    rows = "".join(f"| {fault.name} | `{fault.file}` | `tests/{fault.tests}` |\n" for fault in FAULTS)
    renewed, count = re.subn(re.escape(HEADER) + r"(\|.*\|\n)*", lambda _: HEADER + rows, page)
    if count != 1:
        raise ValueError(f"{PAGE} has {count} tables of faults; it must have one, which begins with {HEADER!r}")
    return renewed
