"""The written report: one page to read offline, and the same as Markdown beside its pictures."""

from __future__ import annotations

import base64
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from jinja2 import Environment, PackageLoader, StrictUndefined, select_autoescape

from compare.claims import MOSTLY_SHARE, PARTLY_SHARE, SURVIVING_TICK, ClaimVerdict, Measured, Scope, Traced
from compare.study.limits import validity
from compare.study.provenance import provenance
from compare.study.study import Study, SystemStudy, tally_of
from periodic.checks import FloatArray

# Largest deviation of an edge of first order, as part of the traced width, where the report says that it holds.
REPORTED_TOLERANCE = 0.05


@dataclass(frozen=True)
class Picture:
    """A picture in the folder of the report.

    Attributes
    ----------
    file : str
        Name of the PNG; a PDF lies beside it.
    caption : str
    data : str
        The PNG in base64, for the page that carries its pictures.
    """

    file: str
    caption: str
    data: str


def write_report(studies: Sequence[Study], claims: Sequence[ClaimVerdict], folder: str | Path) -> None:
    """Write report.html, report.md and every picture (PNG and PDF) into a folder.

    Parameters
    ----------
    studies : sequence of Study
        The cases, from `compare.study.study.run_study`.
    claims : sequence of ClaimVerdict
        From `compare.claims.judge_claims`; may be empty.
    folder : str or Path
        Must exist. report.html needs no other file.
    """
    folder = Path(folder)
    pictures = {study.subject.name: _save_pictures(study, folder) for study in studies}
    environment = Environment(
        loader=PackageLoader("compare.study"),
        autoescape=select_autoescape(("html",)),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters.update(number=_number, figures=_figures, measured=_measured)
    environment.filters.update(last=_last, cell=_cell, status=_status, holds_to=_holds_to)
    facts = {
        "studies": studies,
        "claims": claims,
        "scopes": tuple(Scope),
        "tick": SURVIVING_TICK,
        "mostly": MOSTLY_SHARE,
        "partly": PARTLY_SHARE,
        "pictures": pictures,
        "tally": tally_of(studies),
        "failed_charts": sum(not variant.passed_audit for study in studies for variant in study.variants),
        "tolerance": REPORTED_TOLERANCE,
        "made": provenance(studies),
    }
    for name in ("report.html", "report.md"):
        text = environment.get_template(name).render(facts)
        (folder / name).write_text(text, encoding="utf-8")


def _save_pictures(study: Study, folder: Path) -> list[Picture]:
    captions = {"regions": "Region by region"}
    for variant, name in zip(study.variants, study.chart_names, strict=True):
        captions[name] = f"Chart: {variant.label}" if variant.label else "Chart"
    pictures = []
    for name, figure in study.figures().items():
        path = folder / f"{study.subject.name}-{name}.png"
        figure.savefig(path)
        figure.savefig(path.with_suffix(".pdf"))
        data = base64.b64encode(path.read_bytes()).decode("ascii")
        pictures.append(Picture(path.name, captions[name], data))
    return pictures


def _number(value: float, digits: int = 5) -> str:
    """Return a number to so many digits, a dash where there is none."""
    return "–" if math.isnan(value) else f"{value:.{digits}g}"


def _last(values: FloatArray) -> float:
    """Return the last number, NaN if there is none."""
    return float(values[-1]) if values.size else math.nan


def _figures(value: float, digits: int = 5) -> str:
    """Return `_number` with the zeros at its end, for columns that align their decimal points."""
    return "–" if math.isnan(value) else f"{value:#.{digits}g}"


def _measured(value: Measured) -> str:
    """Return a measured number with no more digits than its error allows."""
    number, error = value
    if math.isnan(number) or not math.isfinite(error):
        return "cannot be told"
    if error <= 0 or number == 0:
        return _number(number)
    return _number(number, max(1, min(6, math.floor(math.log10(abs(number) / error)))))


def _cell(text: object) -> str:
    """Return text fit for a cell of a Markdown table: no bars, line breaks or tags."""
    return " ".join(str(text).replace("|", "\\|").replace("<", "&lt;").split())


def _status(check: Traced) -> str:
    """Return what integration says about a finding."""
    if not check.decisive:
        return "undecided"
    return "holds" if check.holds else "contradicted"


def _holds_to(variant: SystemStudy, label: str) -> str:
    """Return where first order holds for a region, if its boundary was traced."""
    for curve, trace in variant.panels:
        if curve.label == label and trace.is_open.any():
            found = validity(curve, trace, (REPORTED_TOLERANCE,))[0]
            if math.isnan(found.last):
                return "nowhere"
            start = f"{found.first:.2g} " if found.first > 0 else ""
            return f"{start}to {'≥ ' if found.to_the_end else ''}{found.last:.2g}"
    return "–"
