"""``python -m benchmarks``: figures become tables, and tables go where they belong."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from benchmarks import Comparison, Timing, __main__, general, limits, methods, scaling
from benchmarks.general import GeneralTiming
from benchmarks.scaling import fresh_process
from benchmarks.stages import Stages
from benchmarks.tables import TABLES_BEGIN, TABLES_END, comparison_table, conditions


def test_ratio_and_spread() -> None:
    chart = Timing("stability_chart", "all", (1e-5, 2e-5, 4e-5), 1e-11)
    peer = Timing("peer", "all", (2e-3, 2e-3, 2e-3), 1e-9, 1e-7)
    table = comparison_table([Comparison(12, 0.0, (chart,), (peer,))])
    assert "| stability_chart | all | 20.0 | 150% | 1 | 1e-11 |  |" in table
    assert "| peer | all | 2,000.0 | 0% | 100 | 1e-09 | 1e-07 |" in table


def test_conditions_name_the_processor_and_the_libraries() -> None:
    assert "cores" in conditions()
    assert "openblas" in conditions() or "mkl" in conditions()


def test_fresh_process_reports_itself() -> None:
    wall, cpu, memory = fresh_process("pass")
    assert wall >= 0
    assert cpu >= 0
    assert np.isnan(memory) or 1 < memory < 100  # a bare python, not the parent's memory


def test_tables_go_between_the_marks(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    chart = Timing("stability_chart", "all", (1e-5,), 1e-11)
    timing = GeneralTiming("rectangular wave", 512, (3e-5, 2e-5, 4e-5), (1.5, 1.4, 1.7), 2e-12, 6e-3, 1e-6)
    monkeypatch.setattr(methods, "compare_methods", lambda plan: iter([Comparison(12, 0.0, (chart,), ())]))
    monkeypatch.setattr(general, "general_charts", lambda plan: [timing])
    monkeypatch.setattr(scaling, "scaling", lambda plan: [("16 x 8, 1 job", 3.0, 0.5), ("16 x 8, 2 jobs", 3.0, 0.3)])
    monkeypatch.setattr(scaling, "all_stages", lambda plan: {(12, 0.0): Stages(1.0, 2.0, 1.0, 3e10, 6e10)})
    monkeypatch.setattr(scaling, "start_up", lambda plan: [("import", 0.5, 0.4, 99.0)])
    page = tmp_path / "page.md"
    page.write_text(f"before\n{TABLES_BEGIN}\nold\n{TABLES_END}\nafter\n", encoding="utf-8")
    assert __main__.main(["--quick", "--output", str(page)]) == 0
    text = page.read_text(encoding="utf-8")
    assert text.startswith("before\n")
    assert text.endswith("after\n")
    assert "old" not in text
    for part in (
        "| 12 | 0 | stability_chart | all | 10.0 |",
        "| rectangular wave | 512 | 30.0 | 1.50 (1.40, 1.70) | 2e-12 | 6,000 | 200 | 1e-06 |",
        "| 12 | 0 | 25% | 50% | 25% | 30 | 50% |",
        "| 16 x 8, 1 job | 3.0 | 0.50 |",
        "Parallel efficiency on two cores: 0.83.",
        "| import | 0.5 | 0.4 | 99 |",
    ):
        assert part in text


def test_a_page_without_marks_is_left_alone(tmp_path: Path) -> None:
    for text in (f"before\n{TABLES_BEGIN}\nold\nafter\n", "no marks\n"):
        (tmp_path / "page.md").write_text(text, encoding="utf-8")
        with pytest.raises(SystemExit):  # before anything is measured
            __main__.main(["--quick", "--output", str(tmp_path / "page.md")])
        assert (tmp_path / "page.md").read_text(encoding="utf-8") == text


@pytest.mark.parametrize(("ratio", "status"), [(0.1, 0), (1e9, 1)])
def test_check_compares_with_the_limits(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], ratio: float, status: int
) -> None:
    monkeypatch.setattr(limits, "regression", lambda: dict.fromkeys(limits.MAX_REFERENCE_STEPS, ratio))
    assert __main__.main(["--check"]) == status
    assert capsys.readouterr().out.count("too slow") == status * len(limits.MAX_REFERENCE_STEPS)
