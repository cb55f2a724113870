"""Fixtures that several packages' tests share."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest


@pytest.fixture(scope="session")
def references() -> dict[str, Any]:
    """Independent reference numbers: exact or spectrally converged solutions made without this code base."""
    return json.loads((Path(__file__).parent / "references.json").read_text())
