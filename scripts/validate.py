#!/usr/bin/env python3
"""Draw stability charts by theory and by integration, lay one over the other, and say in numbers where they agree."""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path

from compare.cases import Case, load_case, shipped_cases
from compare.claims import ClaimVerdict, judge_claims
from compare.publish import staged
from compare.report import write_report
from compare.study import CaseStudy, run_case

EPILOG = """\
examples:
  scripts/validate.py                          every case in cases/ and the paper's claims, written to output/
  scripts/validate.py --case cases/fig2.toml   one case, no claims
  scripts/validate.py --quick --output first   coarse charts, for a first look

A case file names a plate, a window of excitation frequencies and the regions to look at closely; docs/cases.md lists
its keys. The exit status is 0 if theory and integration agree everywhere, 1 if they do not, 2 if the input is wrong.
A claim of the paper that is contradicted, with counter-examples that integration confirms, is no disagreement.
"""


def main(arguments: list[str] | None = None) -> int:
    options = _parser().parse_args(arguments)
    try:
        cases = [load_case(path) for path in options.case or shipped_cases()]
        studies = [_study(case, options) for case in cases]
        claims = [] if options.case else _claims(options)
    except ValueError as error:
        print(f"validate: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("validate: interrupted; nothing was written", file=sys.stderr)
        return 130
    with staged(options.output) as folder:
        write_report(studies, claims, folder)
        data = {"cases": [study.to_dict() for study in studies], "claims": [claim.to_dict() for claim in claims]}
        text = json.dumps(data, indent=1, ensure_ascii=False, allow_nan=False)
        (folder / "agreement.json").write_text(text, encoding="utf-8")
    print(f"\nreport.html, report.md, the pictures and agreement.json are in {options.output}")
    return 0 if all(study.agrees for study in studies) and all(claim.is_decided for claim in claims) else 1


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        description=__doc__, epilog=EPILOG, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--case", type=Path, action="append", metavar="FILE", help="a case file; may be repeated")
    parser.add_argument("--output", type=Path, default=Path("output"), metavar="DIR", help="where to write (output)")
    parser.add_argument("--jobs", type=_jobs, default=-1, metavar="N", help="workers; -1, the default, for all cores")
    parser.add_argument("--quick", action="store_true", help="coarser charts, claims over a smaller range")
    parser.add_argument("--no-progress", action="store_true", help="no progress bars")
    return parser


def _jobs(text: str) -> int:
    try:
        number = int(text)
    except ValueError:
        number = 0
    if number == 0 or number < -1:
        raise argparse.ArgumentTypeError(f"{text!r} is no number of workers; give 1, 2, ... or -1 for all cores")
    return number


def _study(case: Case, options: argparse.Namespace) -> CaseStudy:
    study = run_case(case, n_jobs=options.jobs, quick=options.quick, progress=not options.no_progress)
    print(f"\n{case.title}")
    for variant in study.variants:
        if variant.label:
            print(f"  {variant.label}")
        print(f"  {'region':<12}{'centre':>10}  {'width ratio':>11}  agrees  because")
        for verdict in variant.verdicts:
            ratio = f"{verdict.width_ratio[0]:.5f}" if verdict.width_ratio[0] > 0 else "closed"
            agrees = "yes" if verdict.agrees else "NO"
            print(f"  {verdict.label:<12}{verdict.centre:>10.4f}  {ratio:>11}  {agrees:<6}  {verdict.reason}")
        print(f"  {variant.audit}")
    return study


def _claims(options: argparse.Namespace) -> list[ClaimVerdict]:
    claims = judge_claims(n_jobs=options.jobs, progress=not options.no_progress, quick=options.quick)
    print("\nThe paper's claims")
    for claim in claims:
        traced = f"{len(claim.counter_examples)} counter-examples traced" if claim.counter_examples else ""
        doubt = "" if claim.is_decided else "NOT CONFIRMED by integration"
        print(f"  {claim.name:<48}{claim.verdict.value:<18}  {doubt or traced}")
    return claims


if __name__ == "__main__":
    sys.exit(main())
