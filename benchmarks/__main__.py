#!/usr/bin/env python3
"""Time the chart engine against its peers, in one process, as ratios; every error is verified in the same run."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from pathlib import Path

from benchmarks import general, limits, methods, scaling, tables

BENCHMARK_HELP = """\
Peers that are not installed are skipped; pip install 'floquet-charts[bench]' brings them. Set OPENBLAS_NUM_THREADS=1,
as make benchmark does: times are CPU seconds of one core. docs/performance.md explains the figures.

--check exits with status 1 if the chart has become slower than its limits, in steps of a reference integrator.
"""


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks",
        description=__doc__,
        epilog=BENCHMARK_HELP,
        formatter_class=argparse.RawDescriptionHelpFormatter,
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
            tables.surroundings(options.output)  # before the work
        except OSError as error:
            parser.error(str(error))
    page = []
    for text in _measured(methods.QUICK_PLAN if options.quick else methods.Plan()):
        page.append(text)
        print(f"{text}\n", flush=True)
    if options.output:
        try:
            tables.write_between(options.output, "\n\n".join(page))
        except OSError as error:
            print(f"benchmarks: {error}", file=sys.stderr)
            return 2
    return 0


def _check() -> int:
    slow = False
    for (size, damping), ratio in limits.regression().items():
        limit = limits.MAX_REFERENCE_STEPS[size, damping]
        slow |= ratio > limit
        verdict = "too slow" if ratio > limit else "ok"
        print(f"n = {size}, damping {damping:g}: a point costs {ratio:.2f} reference steps, limit {limit:g}: {verdict}")
    return int(slow)


def _measured(plan: methods.Plan) -> Iterator[str]:
    """Yield one part of the page after the other, each as soon as it has been measured."""
    yield f"Before: {tables.conditions()}"
    comparisons = []
    for found in methods.compare_methods(plan):
        comparisons.append(found)
        print(f"measured: n = {found.size}, damping {found.damping:g}", file=sys.stderr, flush=True)
    yield tables.comparison_table(comparisons)
    yield tables.general_table(general.general_charts(plan))
    yield tables.stages_table(scaling.all_stages(plan))
    yield tables.scaling_table(scaling.scaling(plan))
    yield tables.start_up_table(scaling.start_up(plan))
    yield f"After: {tables.conditions()}"


if __name__ == "__main__":
    sys.exit(main())
