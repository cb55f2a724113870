"""benchmarks/__main__.py: errors verified, ratios computed, tables written. No test asserts a time."""

from __future__ import annotations

import dataclasses
import importlib.util
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
import scipy.linalg

from benchmarks import benchmark, stages
from benchmarks.peers import PEERS, Equations, mixed_equations, modal_equations, rk4
from floquet import monodromy
from tests.paths import ROOT

TINY = benchmark.Plan(columns=16, rows=8, sizes=(12,), rounds=(1,), points=2, timed=1)


@pytest.fixture(scope="module")
def script() -> ModuleType:
    spec = importlib.util.spec_from_file_location("benchmark_script", ROOT / "benchmarks" / "__main__.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize("peer", PEERS, ids=lambda peer: peer.name)
def test_peer_finds_the_multipliers(peer) -> None:
    """At a fine setting every method gives the trace and the largest modulus that `monodromy` gives."""
    if peer.missing:
        pytest.skip(peer.missing)
    plate = benchmark.plate(12, 0.0)
    fine = 4096.0 if peer.package == "numba" else 1e-10
    matrix = peer.prepare(modal_equations(plate.at(36.0)), fine)(36.0, 0.9)
    expected = monodromy(plate, 36.0, 0.9).multipliers
    found = np.linalg.eigvals(matrix)
    assert abs(found.sum() - expected.sum()) < 1e-7
    assert abs(np.abs(found).max() - np.abs(expected).max()) < 1e-7


def test_runge_kutta_has_order_four() -> None:
    """Without excitation the matrix is exp(A T)."""
    equations = Equations(
        np.array([[0.1, 1.0], [-1.0, 0.2]]), np.diag([1.0, 3.0]), np.zeros((1, 2, 2)), np.zeros((1, 2, 2))
    )
    zero, one = np.zeros((2, 2)), np.eye(2)
    A = np.block([[zero, one], [-equations.stiffness, -equations.velocity]])
    exact = scipy.linalg.expm(A * 2 * np.pi / 3.0)
    errors = [np.linalg.norm(rk4(*equations, 3.0, 0.5, steps) - exact) for steps in (64, 128)]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(4.0, abs=0.1)


def test_mixed_equations_are_the_same_system_without_zeros() -> None:
    modal = modal_equations(benchmark.plate(12, 0.0).at(36.0))
    mixed = mixed_equations(modal)
    assert (modal.velocity == 0).mean() > 0.5
    beside = ~np.eye(12, dtype=bool)  # the diagonal of gyroscopic forces is zero in any coordinates
    for matrix in (mixed.velocity, mixed.stiffness, mixed.cosine[0]):
        assert (matrix[beside] != 0).all()
    one, other = (np.trace(rk4(*equations, 36.0, 0.9, 2048)) for equations in (modal, mixed))
    assert other == pytest.approx(one, abs=1e-9)


def test_comparison_verifies_errors_and_skips_what_is_missing() -> None:
    absent = dataclasses.replace(PEERS[0], name="absent", package="no_such_package")
    hopeless = dataclasses.replace(PEERS[1], name="hopeless", settings=(2.0,))
    found = next(benchmark.compare_methods(TINY, (PEERS[1], absent, hopeless)))
    assert found.size == 12
    assert all(ours.error < benchmark.ACCURACY for ours in found.chart)
    largest, everything, *others = found.peers
    assert 0 < largest.error <= benchmark.ACCURACY
    assert 0 < everything.error <= benchmark.ACCURACY
    assert largest.setting < everything.setting  # fewer steps will do for the largest multiplier alone
    assert len(largest.seconds) == 1
    assert "no_such_package is not installed" in others[0].skipped
    assert "no setting reached" in others[2].skipped
    table = benchmark.comparison_table([found])
    assert table.count("\n") == 9
    assert "| 12 | 0 | absent | largest | skipped: no_such_package" in table


def test_errors_of_multipliers() -> None:
    exact = np.array([2.0, 1j, -0.5])
    assert benchmark.error(exact[::-1], exact, "all") == 0
    assert benchmark.error(exact + np.array([0, 0, 0.02]), exact, "largest") == 0
    assert benchmark.error(exact + np.array([0, 0, 0.02]), exact, "all") == pytest.approx(0.01)
    assert benchmark.error(2 * exact, exact, "largest") == pytest.approx(np.log(2))
    overflown = benchmark.multipliers(lambda Omega, eps: np.full((3, 3), np.inf), 1.0, 1.0)
    assert benchmark.error(overflown, exact, "all") == np.inf


def test_stages_add_up_to_a_chart() -> None:
    family = benchmark.plate(12, benchmark.DAMPING)
    found = stages.stages(family, *benchmark.grids(2, 16), rounds=1)
    assert min(found.sampling, found.operations, found.peak) > 0
    # one column of 16 amplitudes is at least a hundred products of two blocks with 12 rows
    assert found.operations > 2 * 2 * 100 * 2 * 12**3
    table = stages.stages_table({(12, 0.0): found})
    assert table.count("%") == 4


def test_multipliers_of_the_chart_are_those_of_the_reference() -> None:
    family = benchmark.plate(12, 0.0)
    eps = np.linspace(0, 1, 24)
    found = stages.chart_multipliers(family, 36.0, eps)
    assert benchmark.error(found[-1], monodromy(family, 36.0, 1.0).multipliers, "all") < 1e-8


def test_ratio_and_spread() -> None:
    chart = benchmark.Timing("stability_chart", "all", (1e-5, 2e-5, 4e-5), 1e-11)
    peer = benchmark.Timing("peer", "all", (2e-3, 2e-3, 2e-3), 1e-9, 1e-7)
    table = benchmark.comparison_table([benchmark.Comparison(12, 0.0, (chart,), (peer,))])
    assert "| stability_chart | all | 20.0 | 150% | 1 | 1e-11 |  |" in table
    assert "| peer | all | 2,000.0 | 0% | 100 | 1e-09 | 1e-07 |" in table


def test_conditions_name_the_processor_and_the_libraries() -> None:
    assert "cores" in benchmark.conditions()
    assert "openblas" in benchmark.conditions() or "mkl" in benchmark.conditions()


def test_fresh_process_reports_itself() -> None:
    wall, cpu, memory = benchmark.fresh_process("pass")
    assert wall >= 0
    assert cpu >= 0
    assert np.isnan(memory) or 1 < memory < 100  # a bare python, not the parent's memory


def test_tables_go_between_the_marks(script: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    chart = benchmark.Timing("stability_chart", "all", (1e-5,), 1e-11)
    monkeypatch.setattr(benchmark, "compare_methods", lambda plan: iter([benchmark.Comparison(12, 0.0, (chart,), ())]))
    monkeypatch.setattr(benchmark, "scaling", lambda plan: [("16 x 8, 1 job", 3.0, 0.5), ("16 x 8, 2 jobs", 3.0, 0.3)])
    monkeypatch.setattr(benchmark, "all_stages", lambda plan: {(12, 0.0): stages.Stages(1.0, 2.0, 1.0, 3e10, 6e10)})
    monkeypatch.setattr(benchmark, "start_up", lambda plan: [("import", 0.5, 0.4, 99.0)])
    page = tmp_path / "page.md"
    page.write_text(f"before\n{script.BEGIN}\nold\n{script.END}\nafter\n", encoding="utf-8")
    assert script.main(["--quick", "--output", str(page)]) == 0
    text = page.read_text(encoding="utf-8")
    assert text.startswith("before\n")
    assert text.endswith("after\n")
    assert "old" not in text
    for part in (
        "| 12 | 0 | stability_chart | all | 10.0 |",
        "| 12 | 0 | 25% | 50% | 25% | 30 | 50% |",
        "| 16 x 8, 1 job | 3.0 | 0.50 |",
        "Parallel efficiency on two cores: 0.83.",
        "| import | 0.5 | 0.4 | 99 |",
    ):
        assert part in text


def test_a_page_without_marks_is_left_alone(script: ModuleType, tmp_path: Path) -> None:
    for text in (f"before\n{script.BEGIN}\nold\nafter\n", "no marks\n"):
        (tmp_path / "page.md").write_text(text, encoding="utf-8")
        with pytest.raises(SystemExit):  # before anything is measured
            script.main(["--quick", "--output", str(tmp_path / "page.md")])
        assert (tmp_path / "page.md").read_text(encoding="utf-8") == text


@pytest.mark.parametrize(("ratio", "status"), [(0.1, 0), (1e9, 1)])
def test_check_compares_with_the_limits(script: ModuleType, monkeypatch, capsys, ratio: float, status: int) -> None:
    monkeypatch.setattr(benchmark, "regression", lambda: dict.fromkeys(benchmark.LIMITS, ratio))
    assert script.main(["--check"]) == status
    assert capsys.readouterr().out.count("too slow") == status * len(benchmark.LIMITS)
