#!/usr/bin/env python3
"""Draw stability charts by theory and by integration, lay one over the other, and say in numbers where they agree."""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path

try:
    from compare import Outcome
    from compare.claims import ClaimVerdict, judge_claims
    from compare.files import load_case, shipped_cases, staged
    from compare.study import (
        CHART_POINTS,
        Study,
        Subject,
        own_system,
        run_studies,
        system_subject,
        tally_of,
        write_report,
    )
    from compare.window import MODES_SHOWN
    from floquet.chart import TileStore
    from floquet_scripts import running
    from floquet_scripts.compiling import announce_compilation
except ModuleNotFoundError as error:
    if __name__ != "__main__":
        raise
    print(
        f"validate: this python has no package {error.name}; set up .venv by make validate and take .venv/bin/python, "
        "or install the program into this python: pip install .",
        file=sys.stderr,
    )
    sys.exit(2)

VALIDATE_HELP = f"""\
examples:
  {{command}}                          every shipped case and the paper's claims, written to output/
  {{command}} --case fig2              one case, no claims; mine.toml for your own
  {{command}} --system mine.npz        your own matrices, in a window that suits them
  {{command}} --system mine.npz --Omega 1 30 --eps 0.8 --modes 5
  {{command}} --quick --output first   coarse charts, for a first look

A case file names a plate, a window of excitation frequencies and the regions to look at closely; docs/cases.md of the
sources lists its keys. Of a system, the regions of its lowest modes are judged (--modes). Give a window by --Omega and
--eps, or leave it to the program, which takes one that shows their main regions. Theory is for small ε, where the
excitation changes the stiffness of a region's modes little. There its gap to the integrated boundaries has to shrink
like ε²; the report says how far it holds beyond.

The exit status is 0 if no region disagrees and every case or system had something to compare, 1 if a region disagrees
or a chart did not pass its audit by a second integrator, 2 if the input is wrong, 3 if nothing disagrees but nothing
could be compared for a case or system. Regions that were not compared are counted apart, with the reason.
A claim of the paper that is contradicted, with counter-examples that integration confirms, is no disagreement.

{running.SYSTEM_FILES_HELP}
{running.STOPPED_RUNS_HELP}"""


def main(arguments: list[str] | None = None) -> int:
    running.steady_output()
    announce_compilation()
    options = _parser().parse_args(arguments)
    try:
        subjects = _subjects(options)
    except ValueError as error:
        print(f"validate: {error}", file=sys.stderr)
        return 2
    return running.run("validate", options, lambda store: _validate(subjects, options, store))


def _parser() -> argparse.ArgumentParser:
    parser = running.Parser("validate", __doc__, VALIDATE_HELP)
    what = parser.add_argument_group("what to judge (by default every shipped case, and the claims)")
    what.add_argument(
        "--case", type=Path, action="append", default=[], metavar="CASE", help=f"{running.CASE_HELP}; repeatable"
    )
    what.add_argument(
        "--system",
        type=Path,
        action="append",
        default=[],
        metavar="FILE",
        help=f"{running.SYSTEM_HELP}; repeatable",
    )
    system = parser.add_argument_group("for --system")
    system.add_argument("--Omega", type=float, nargs=2, metavar=("LOW", "HIGH"), help="excitation frequencies")
    system.add_argument("--eps", type=float, metavar="MAX", help="largest amplitude of the chart")
    system.add_argument("--points", type=int, nargs=2, metavar=("COLUMNS", "ROWS"), help="of the chart (256 128)")
    system.add_argument("--modes", type=int, metavar="N", help="judge the regions between the N lowest modes (3)")
    system.add_argument("--all-modes", action="store_true", help=running.ALL_MODES_HELP)
    result = parser.add_argument_group("result")
    result.add_argument("--output", type=Path, default=Path("output"), metavar="DIR", help="where to write (output)")
    result.add_argument("--quick", action="store_true", help="coarser charts, claims over a smaller range")
    running.add_options(parser)
    return parser


def _subjects(options: argparse.Namespace) -> list[Subject]:
    """Return the cases and systems that the options name, all read and checked before the first is computed."""
    given = [name for name in ("Omega", "eps", "points", "modes") if getattr(options, name) is not None]
    given += ["all-modes"] if options.all_modes else []
    if given and not options.system:
        raise ValueError(f"--{given[0]} belongs to a system; add --system, or write it into a case file")
    running.check_window(options)
    subjects = [Subject.of_case(load_case(path)) for path in options.case]
    for path in options.system:
        own = own_system(path, options.Omega, options.eps, all_modes=options.all_modes)
        modes = MODES_SHOWN if options.modes is None else options.modes
        subjects.append(system_subject(own, points=options.points or CHART_POINTS, modes=modes))
    names = [subject.name for subject in subjects]
    for name in names:
        if names.count(name) > 1:
            raise ValueError(f"two of the files are called {name!r}, as their pictures would be; rename one")
    return subjects or [Subject.of_case(load_case(path)) for path in shipped_cases()]


def _validate(subjects: list[Subject], options: argparse.Namespace, store: TileStore) -> int:
    studies = run_studies(
        subjects, n_jobs=options.jobs, quick=options.quick, progress=not options.no_progress, cache=store
    )
    for study in studies:
        _print(study)
    tally = tally_of(studies)
    print(f"\n{tally}")
    claims = [] if options.case or options.system else _claims(options)
    with staged(options.output) as folder:
        write_report(studies, claims, folder)
        data = {
            "summary": tally.to_dict(),
            "cases": [study.to_dict() for study in studies],
            "claims": [claim.to_dict() for claim in claims],
        }
        text = json.dumps(data, indent=1, ensure_ascii=False, allow_nan=False)
        (folder / "agreement.json").write_text(text, encoding="utf-8")
    print(f"\nreport.html, report.md, the pictures and agreement.json are in {options.output}")
    return _status(studies, claims)


def _status(studies: list[Study], claims: list[ClaimVerdict]) -> int:
    """Return the exit status, and say why if nothing was compared."""
    audited = all(variant.passed_audit for study in studies for variant in study.variants)
    if tally_of(studies).wrong or not audited or not all(claim.is_decided for claim in claims):
        return 1
    empty = [study.subject.title for study in studies if not study.agrees]
    for title in empty:
        print(f"{title}: nothing was compared; the reasons stand beside the regions", file=sys.stderr)
    return 3 if empty else 0


def _print(study: Study) -> None:
    print(f"\n{study.subject.title}")
    if study.subject.remark:
        print(f"  {study.subject.remark}")
    for variant in study.variants:
        if variant.label:
            print(f"  {variant.label}")
        print(f"  {'region':<12}{'centre':>10}  {'width ratio':>11}  {'outcome':<12}  because")
        for verdict in variant.verdicts:
            ratio = f"{verdict.limiting_ratio:.5f}" if verdict.limiting_ratio > 0 else "–"
            outcome = verdict.outcome.value.upper() if verdict.outcome is Outcome.DISAGREES else verdict.outcome.value
            print(f"  {verdict.label:<12}{verdict.centre:>10.4f}  {ratio:>11}  {outcome:<12}  {verdict.reason}")
        print(f"  {variant.audit}")


def _claims(options: argparse.Namespace) -> list[ClaimVerdict]:
    claims = judge_claims(n_jobs=options.jobs, progress=not options.no_progress, quick=options.quick)
    print("\nThe paper's claims")
    for claim in claims:
        print(f"\n  {claim.name}")
        for judgement in claim.judgements:
            count = len(judgement.counter_examples)
            traced = f"{count} counter-example{'s' if count > 1 else ''} traced" if count else ""
            doubt = "" if judgement.is_decided else "NOT CONFIRMED by integration"
            print(f"    {judgement.scope.value:<28}{judgement.sentence:<42}  {doubt or traced}".rstrip())
        print(f"    {claim.conclusion}")
    return claims


if __name__ == "__main__":
    sys.exit(main())
