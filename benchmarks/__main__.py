#!/usr/bin/env python3
"""Time the chart engine against its peers, in one process, as ratios; every error is verified in the same run."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from benchmarks import benchmark, stages

EPILOG = """\
Peers that are not installed are skipped; pip install 'floquet-charts[bench]' brings them. Set OPENBLAS_NUM_THREADS=1,
as make benchmark does: times are CPU seconds of one core. docs/performance.md explains the figures.

--check exits with status 1 if the chart has become slower than its limits, in steps of a reference integrator.
"""
# --output replaces what is between these lines, and keeps the rest of the file.
BEGIN, END = "<!-- begin: benchmarks/__main__.py -->", "<!-- end: benchmarks/__main__.py -->"


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, epilog=EPILOG, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--quick", action="store_true", help="a smaller grid, n = 12 and 28 only, fewer rounds")
    parser.add_argument("--output", type=Path, metavar="FILE", help="write the tables into this page as well")
    parser.add_argument("--check", action="store_true", help="hold the chart against its limits, nothing else")
    options = parser.parse_args(arguments)
    if options.check and options.output:
        parser.error("--output has no meaning with --check; leave it out")
    if options.check:
        return _check()
    if options.output:
        try:
            surroundings(options.output)  # before the work
        except OSError as error:
            parser.error(str(error))
    plan = benchmark.QUICK if options.quick else benchmark.Plan()
    tables = [f"Before: {benchmark.conditions()}"]
    print(tables[0], flush=True)
    comparisons = []
    for found in benchmark.compare_methods(plan):
        comparisons.append(found)
        print(benchmark.comparison_table([found]), flush=True)
    tables.append(benchmark.comparison_table(comparisons))
    for table in (
        stages.stages_table(benchmark.all_stages(plan)),
        benchmark.scaling_table(benchmark.scaling(plan)),
        benchmark.start_up_table(benchmark.start_up(plan)),
    ):
        tables.append(table)
        print(f"\n{table}", flush=True)
    tables.append(f"After: {benchmark.conditions()}")
    if options.output:
        try:
            write_between(options.output, "\n\n".join(tables))
        except OSError as error:
            print(f"benchmark: {error}", file=sys.stderr)
            return 2
    return 0


def _check() -> int:
    slow = False
    for (size, damping), ratio in benchmark.regression().items():
        limit = benchmark.LIMITS[size, damping]
        slow |= ratio > limit
        verdict = "too slow" if ratio > limit else "ok"
        print(f"n = {size}, damping {damping:g}: a point costs {ratio:.2f} reference steps, limit {limit:g}: {verdict}")
    return int(slow)


def surroundings(path: Path) -> tuple[str, str]:
    """Return what is before and after the marks in the file; nothing if there is no file.

    Raises
    ------
    OSError
        If the file cannot be read, or has no marks.
    """
    if not path.exists():
        return "", "\n"
    head, begun, rest = path.read_text(encoding="utf-8").partition(BEGIN)
    _, ended, tail = rest.partition(END)
    if not (begun and ended):
        raise OSError(f"{path} has no lines {BEGIN} and {END}; put them where the tables shall be")
    return head, tail


def write_between(path: Path, text: str) -> None:
    """Put ``text`` between the marks in the file; make the file if there is none."""
    head, tail = surroundings(path)
    path.write_text(f"{head}{BEGIN}\n{text}\n{END}{tail}", encoding="utf-8")


if __name__ == "__main__":
    sys.exit(main())
