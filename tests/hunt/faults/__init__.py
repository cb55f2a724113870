"""Deliberate faults, each of which the tests named with it must notice; `tests/hunt/test_mutations.py` sees to it.

A fault is one that somebody could make: a sign, a factor, a term left out, a check that no longer checks. A test that
fails for another reason than the fault would prove nothing, so the same tests are run first without any fault.

Each module lists those of one room. ``python -m tests.hunt.faults`` renews the table in docs/testing.md.
"""

from tests.hunt.faults import beam, certified, chart, compare, edges, oracle, periodic, perturb, plate

ROOMS = (periodic, plate, beam, perturb, chart, oracle, certified, edges, compare)
FAULTS = tuple(fault for room in ROOMS for fault in room.FAULTS)
