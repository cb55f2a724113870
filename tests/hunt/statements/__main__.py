"""`python -m tests.hunt.statements N [--seed S]`: check N statements; print what is wrong, and the count."""

from __future__ import annotations

import argparse
import sys
import time
from contextlib import suppress

from tests.hunt.statements.hunt import Tally, case
from tests.hunt.statements.statement import Case, Judged
from tests.hunt.statements.systems import SORTS


def main(arguments: list[str] | None = None) -> int:
    """Run the hunt; return 1 if a statement is wrong."""
    parser = argparse.ArgumentParser(prog="python -m tests.hunt.statements", description=__doc__)
    parser.add_argument("statements", type=int, nargs="?", default=100, help="statements to check")
    parser.add_argument("--seed", type=int, default=0, help="of the first system; the others follow")
    parser.add_argument("--sort", choices=list(SORTS), help="systems of this sort alone")
    parser.add_argument("--only", action="store_true", help="everything that is said of the system of this seed alone")
    parser.add_argument("--withheld", action="store_true", help="print what is withheld, too")
    options = parser.parse_args(arguments)
    if options.only:
        tally = Tally()
        tally.add(one := case(options.seed, options.sort))
        _show(one, set(Judged))
        print(tally)
        return int(tally.counts[Judged.WRONG] > 0)
    shown = {Judged.WRONG, Judged.WITHHELD} if options.withheld else {Judged.WRONG}
    began = time.process_time()
    tally = Tally()
    with suppress(KeyboardInterrupt):  # what has been counted so far
        for one in tally.cases_from(options.seed, options.statements, options.sort):
            _show(one, shown)
    print(f"{tally}, in {time.process_time() - began:.0f} s of processor time")
    return int(tally.counts[Judged.WRONG] > 0)


def _show(one: Case, judged: set[Judged]) -> None:
    for statement in one.statements:
        if statement.judged in judged:
            print(
                f"{statement.judged} (--only --seed {one.seed}, {one.sort}): {one.asked}: {statement.sentence}",
                flush=True,
            )


if __name__ == "__main__":
    sys.exit(main())
