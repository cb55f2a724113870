"""Renew the table of faults in docs/testing.md: ``python -m tests.hunt.faults``."""

from tests.hunt.table import PAGE, with_table

PAGE.write_text(with_table(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
