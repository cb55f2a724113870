"""The written report: complete, self-contained, and safe for whatever a case file calls its things."""

from __future__ import annotations

import base64
import re
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest

from compare.claims import ClaimVerdict, Finding, Instances, Judgement, Measured, Scope
from compare.claims.evidence import trace_telling
from compare.claims.quantities import Quantity
from compare.files.cases import load_case
from compare.study import Study, Subject, run_study, write_report
from compare.study.report import _measured
from tests.small_case import SMALL_CASE, TITLE

VARIANTS = """
[[variants]]
label = "slow | <i>"
plate = {speed = 1.0}
[[variants]]
label = "fast"
plate = {speed = 3.0}
"""
VOID = {"meta", "img", "br", "link"}


class Page(HTMLParser):
    """Collects text and pictures, and notices tags that are not closed in order."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.links: list[str] = []
        self.text = ""

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        if tag not in VOID:
            self.open.append(tag)
        self.links += [value or "" for name, value in attributes if name in ("src", "href")]

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.text += data


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> Study:
    path = tmp_path_factory.mktemp("cases") / "two plates.toml"
    case = SMALL_CASE.replace(TITLE, "Plates <b>& pipes | bars</b>")
    path.write_text(case + VARIANTS, encoding="utf-8")
    return run_study(Subject.of_case(load_case(path)), n_jobs=1, quick=True)


@pytest.fixture(scope="module")
def claims() -> list[ClaimVerdict]:
    def quantity(name: str, value: float) -> Quantity:
        return Quantity(name, value, lambda: Measured(value, 1e-4), eps=0.05)

    findings = (
        Finding("main | regions", quantity("width <1>", 0.5), quantity("width 2", 0.25)),
        Finding("combination regions", quantity("width 3", 0.1), quantity("width 4", 0.3)),
    )
    [traced] = trace_telling([findings], 1, False)
    judgements = [Judgement(scope, Instances("one <plate>", findings), tuple(traced)) for scope in Scope]
    judgements[1] = Judgement(Scope.LITERAL, Instances("one | plate", (), "nothing else is there"), ())
    return [ClaimVerdict("Everything shrinks", "All regions <shrink>.", tuple(judgements))]


@pytest.fixture(scope="module")
def folder(study: Study, claims: list[ClaimVerdict], tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("report")
    write_report([study], claims, folder)
    return folder


def _page(folder: Path) -> Page:
    page = Page()
    page.feed((folder / "report.html").read_text(encoding="utf-8"))
    page.close()
    return page


def test_the_page_is_well_formed_and_carries_its_pictures(folder: Path) -> None:
    page = _page(folder)
    assert not page.open
    pictures = [link for link in page.links if not link.startswith("#")]
    assert len(pictures) == 3  # regions, and one chart a variant
    for link in pictures:
        kind, data = link.split(",", 1)
        assert kind == "data:image/png;base64"
        assert base64.b64decode(data).startswith(b"\x89PNG")
    assert not re.search(r"https?://", (folder / "report.html").read_text(encoding="utf-8"))


def test_links_within_the_page_lead_somewhere(folder: Path) -> None:
    text = (folder / "report.html").read_text(encoding="utf-8")
    targets = [link[1:] for link in _page(folder).links if link.startswith("#")]
    assert targets
    assert all(f'id="{target}"' in text for target in targets)


def test_the_markdown_links_every_picture(folder: Path) -> None:
    text = (folder / "report.md").read_text(encoding="utf-8")
    linked = {name.replace("%20", " ") for name in re.findall(r"!\[[^\]]*\]\(([^)]*)\)", text)}
    assert linked == {path.name for path in folder.glob("*.png")}
    assert {path.stem for path in folder.glob("*.pdf")} == {path.stem for path in folder.glob("*.png")}


def test_every_region_and_claim_is_in_both(folder: Path, study: Study, claims: list[ClaimVerdict]) -> None:
    texts = [_page(folder).text, (folder / "report.md").read_text(encoding="utf-8")]
    for text in texts:
        for variant in study.variants:
            for verdict in variant.verdicts:
                assert verdict.label in text
                assert f"{verdict.centre:#.6g}" in text
                assert verdict.reason in text
        assert "holds in part, 1 of 2 (50 %)" in text
        assert "holds by construction" in text
        assert "It cannot fail: nothing else is there" in text
        assert "Everything shrinks" in text
        assert all(scope.value in text for scope in Scope)
        assert claims[0].conclusion in text
        assert "contradicted" in text
        assert "1 of 1" in text
    assert all(str(study.tally) in text for text in texts)


def test_names_from_a_case_file_stay_text(folder: Path) -> None:
    assert "Plates <b>& pipes | bars</b>" in _page(folder).text
    assert "All regions <shrink>." in _page(folder).text
    text = (folder / "report.md").read_text(encoding="utf-8")
    tables = re.findall(r"(?:^\|.*\n)+", text, re.MULTILINE)
    assert "| main \\| regions |" in text
    for table in tables:
        cells = {len(re.findall(r"(?<!\\)\|", row)) for row in table.splitlines()}
        assert len(cells) == 1, table


def test_a_measured_number_shows_the_digits_that_its_error_allows() -> None:
    assert _measured(Measured(1.23456789, 1e-4)) == "1.235"
    assert _measured(Measured(1.23456789, 1e-12)) == "1.23457"
    assert _measured(Measured(float("nan"), 1.0)) == "cannot be told"
    assert _measured(Measured(1.0, float("inf"))) == "cannot be told"
    assert _measured(Measured(0.0, 1e-7)) == "0"


@pytest.fixture(scope="module")
def worse(study: Study) -> Study:
    """The study with a chart that failed its audit."""
    variant = study.variants[0]
    assert variant.chart.audit is not None
    contradicted = replace(variant.chart.audit, contradictions=np.ones_like(variant.chart.audit.contradictions))
    failed = replace(variant, chart=replace(variant.chart, audit=contradicted))
    return replace(study, variants=[failed, *study.variants[1:]])


@pytest.fixture(scope="module")
def without_claims(worse: Study, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("without claims")
    write_report([worse], [], folder)
    return folder


def test_a_report_without_claims_has_no_such_section(folder: Path, without_claims: Path) -> None:
    for name in ("report.html", "report.md"):
        assert "The paper's claims" in (folder / name).read_text(encoding="utf-8")
        assert "The paper's claims" not in (without_claims / name).read_text(encoding="utf-8")


def test_a_chart_that_failed_its_audit_is_a_disagreement(
    study: Study, worse: Study, folder: Path, without_claims: Path
) -> None:
    assert study.agrees
    assert not worse.agrees
    assert worse.to_dict()["variants"][0]["chart_passed_audit"] is False
    for name in ("report.html", "report.md"):
        head, details = (without_claims / name).read_text(encoding="utf-8").split("Plates", 1)
        assert "Charts that did not pass their audit: 1." in head
        assert "DO NOT TRUST THIS CHART" in details
    variant = study.variants[0]
    assert variant.chart.audit is not None
    unchecked = replace(variant.chart.audit, differences=np.full_like(variant.chart.audit.differences, np.nan))
    assert not replace(variant, chart=replace(variant.chart, audit=unchecked)).passed_audit
    assert not replace(variant, chart=replace(variant.chart, audit=None)).passed_audit
    assert "did not pass" not in (folder / "report.html").read_text(encoding="utf-8")
