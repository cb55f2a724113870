"""`stability_chart` and `StabilityChart`: the public interface, workers, audit, files, bad input."""

from __future__ import annotations

import dataclasses
import sys
from pathlib import Path
from typing import Any

import joblib
import numpy as np
import pytest

import floquet.chart.filling
from floquet import Kind, StabilityChart, monodromy, stability_chart
from floquet.chart import ChartAudit
from periodic import PeriodicSystem
from periodic.examples import coupled_mathieu, mathieu
from tests.floquet.chart.chart_oracles import agrees, chart
from tests.floquet.oracle_systems import random_system

ARRAYS = ("Omega", "eps", "growth_rate", "multiplier", "kind", "error")


def same(one: StabilityChart, other: StabilityChart) -> bool:
    """Whether two charts agree to the last bit."""
    return all(np.array_equal(getattr(one, name), getattr(other, name)) for name in ARRAYS)


def audited(found: StabilityChart) -> ChartAudit:
    """The audit of a chart that has one."""
    assert found.audit is not None
    return found.audit


# ---- what a chart is ----


@pytest.fixture(scope="module")
def example() -> StabilityChart:
    return stability_chart(mathieu(1.0), np.linspace(0.6, 2.6, 21), np.linspace(0, 0.8, 17), n_jobs=1, progress=False)


def test_shapes_and_types(example: StabilityChart) -> None:
    assert (
        example.growth_rate.shape == example.multiplier.shape == example.kind.shape == example.error.shape == (17, 21)
    )
    assert example.multiplier.dtype == np.complex128
    assert example.kind.dtype == np.int8
    for name in ARRAYS:
        with pytest.raises(ValueError, match="read-only"):
            getattr(example, name)[0] = 0
    with pytest.raises(dataclasses.FrozenInstanceError):
        example.eps = None  # type: ignore[misc, assignment]


def test_fields_belong_together(example: StabilityChart) -> None:
    period = 2 * np.pi / example.Omega
    assert np.abs(example.multiplier) == pytest.approx(np.exp(example.growth_rate * period), rel=1e-12)
    assert (example.multiplier.imag >= 0).all()
    assert (example.growth_rate[example.kind == Kind.STABLE] == 0).all()  # conservative
    assert ((example.growth_rate * period)[example.kind > 0] > example.error[example.kind > 0]).all()
    assert (example.multiplier.real[example.kind == Kind.PLUS_ONE] > 1).all()
    assert (example.multiplier.real[example.kind == Kind.MINUS_ONE] < -1).all()
    assert (example.multiplier.imag[example.kind > 0] == 0).all()
    # regions around 2 omega / n: n odd at -1, n even at +1
    assert {int(k) for k in np.unique(example.kind)} <= {-1, 0, 1, 2}
    assert example.kind[-1, np.argmin(np.abs(example.Omega - 2.0))] == Kind.MINUS_ONE
    assert example.kind[-1, np.argmin(np.abs(example.Omega - 0.9))] == Kind.PLUS_ONE


def test_combination_resonance_is_of_complex_kind() -> None:
    found = chart(coupled_mathieu("sum"), [2.7], [0.3])
    assert found.kind.tolist() == [[Kind.COMPLEX]]
    assert found.multiplier[0, 0].imag > 0.1
    difference = chart(coupled_mathieu("difference"), [0.7], [0.3])
    assert difference.kind.tolist() == [[Kind.COMPLEX]]


def test_damped_cells_are_stable_or_not() -> None:
    found = chart(mathieu(1.0, 0.1), np.linspace(1.5, 2.5, 11), np.linspace(0, 0.8, 9))
    assert (found.growth_rate[found.kind == Kind.STABLE] < 0).all()
    assert found.growth_rate[0] == pytest.approx(-0.05)  # no excitation: half the damping coefficient


def test_points_can_be_computed_alone() -> None:
    # a cell does not depend on its neighbours by more than its error; single columns, rows and cells work
    system = random_system(21, 3, 2, damping=0.05)
    Omega, eps = np.linspace(0.9, 3.0, 5), np.linspace(-0.5, 1.0, 20)
    whole = chart(system, Omega, eps)
    for part, i, j in (
        (chart(system, Omega[2], eps), slice(None), slice(2, 3)),
        (chart(system, Omega, eps[7]), slice(7, 8), slice(None)),
        (chart(system, Omega[3], eps[11]), slice(11, 12), slice(3, 4)),
    ):
        period = 2 * np.pi / part.Omega
        difference = np.abs(part.growth_rate - whole.growth_rate[i, j]) * period
        assert (difference <= part.error + whole.error[i, j]).all()


def test_a_tuple_of_two_is_a_range() -> None:
    """As for `trace_regions`; a list of two stays two frequencies."""
    wide = stability_chart(mathieu(1.0), (1.9, 2.1), [0.1, 0.2], audit=0, n_jobs=1, progress=False)
    assert wide.Omega == pytest.approx(np.linspace(1.9, 2.1, 256), abs=1e-15)
    assert wide.eps.tolist() == [0.1, 0.2]
    tall = stability_chart(mathieu(1.0), [1.9, 2.1], (0.1, 0.2), audit=0, n_jobs=1, progress=False)
    assert tall.kind.shape == (128, 2)
    for start, wrong in (("Omega", ((2.1, 1.9), [0.1])), ("eps", ([2.0], (0.2, 0.2)))):
        with pytest.raises(ValueError, match=f"^{start} = .* is empty; give low < high"):
            stability_chart(mathieu(1.0), *wrong, progress=False)


def test_a_chart_shows_itself_in_a_line(example: StabilityChart) -> None:
    parts = [f"{100 * np.count_nonzero(cells) / 357:.1f}%" for cells in (example.kind > 0, example.kind < 0)]
    expected = "StabilityChart(Omega 0.6 to 2.6 (21), eps 0 to 0.8 (17): {} of the cells unstable, {} undecided)"
    assert repr(example) == expected.format(*parts)


def test_uneven_grids() -> None:
    system = random_system(22, 2, 1, damping=0.1)
    found = chart(system, [0.7, 0.71, 5.0, 40.0], [-3.0, -1e-9, 0.0, 1e-12, 0.2, *np.linspace(0.5, 0.6, 12), 2.0])
    assert agrees(system, found)


class Family:
    """Coordinates that are independent below Omega = 2, coupled above: excitation that depends on the frequency."""

    def at(self, Omega: float) -> PeriodicSystem:
        off = 0.7 * (Omega > 2)
        F = [[[1.0, off], [off, 1.5]]]
        return PeriodicSystem(np.eye(2), np.zeros((2, 2)), 0.02 * np.eye(2), np.diag([1.0, 2.3]), F)


def test_excitation_that_depends_on_the_frequency() -> None:
    family = Family()
    found = chart(family, np.linspace(1.6, 2.8, 7), np.linspace(0, 0.9, 10))
    for j, Omega in enumerate(found.Omega):
        for i in (3, 9):
            exact = monodromy(family, float(Omega), float(found.eps[i])).growth_rate
            assert abs(found.growth_rate[i, j] - exact) * 2 * np.pi / Omega <= 3 * found.error[i, j] + 1e-13


# ---- workers ----


def test_number_of_workers_and_backend_do_not_matter() -> None:
    system = random_system(23, 4, 2)
    Omega, eps = np.linspace(0.8, 3.0, 19), np.linspace(0, 0.6, 12)
    one = chart(system, Omega, eps, audit=4)
    assert same(one, chart(system, Omega, eps, n_jobs=2))
    assert same(one, chart(system, Omega, eps, n_jobs=-1))
    for backend in ("threading", "sequential"):
        with joblib.parallel_config(backend=backend, n_jobs=2):
            assert same(one, chart(system, Omega, eps, n_jobs=None))


@pytest.mark.slow
def test_processes_do_not_matter() -> None:
    system = random_system(23, 4, 2)
    Omega, eps = np.linspace(0.8, 3.0, 19), np.linspace(0, 0.6, 12)
    with joblib.parallel_config(backend="loky", n_jobs=2):
        other = chart(system, Omega, eps, n_jobs=None, audit=4)
    assert same(chart(system, Omega, eps), other)
    assert audited(other).ok


def test_columns_do_not_depend_on_their_task(monkeypatch: pytest.MonkeyPatch) -> None:
    system = random_system(24, 3, 1)
    Omega, eps = np.linspace(0.8, 3.0, 13), np.linspace(0, 0.6, 12)
    one = chart(system, Omega, eps)
    monkeypatch.setattr(floquet.chart.filling, "MIN_TASK_COLUMNS", 5)
    assert same(one, chart(system, Omega, eps))


def test_progress_bar(capfd: pytest.CaptureFixture[str]) -> None:
    Omega = np.linspace(0.8, 3.0, 9)
    chart(mathieu(), Omega, [0.1], progress=False)
    chart(mathieu(), Omega, [0.1], progress=None)  # no terminal here
    assert capfd.readouterr() == ("", "")
    chart(mathieu(), Omega, [0.1], progress=True)
    captured = capfd.readouterr()
    assert captured.out == ""
    assert "9/9" in captured.err


# ---- audit ----


def test_audit(example: StabilityChart) -> None:
    audit = audited(example)
    assert len(audit.cells) in (16, 17)
    assert [int(i) for i in np.unravel_index(example.error.argmax(), example.error.shape)] in audit.cells.tolist()
    assert audit.ok
    assert audit.compared == len(audit.cells)
    assert audit.largest_difference < 1e-6
    assert audit.largest_ratio < 3
    again = audited(stability_chart(mathieu(1.0), example.Omega, example.eps, n_jobs=1, progress=False))
    assert np.array_equal(again.cells, audit.cells)
    assert np.array_equal(again.differences, audit.differences)


def test_audit_notices_faults(monkeypatch: pytest.MonkeyPatch) -> None:
    # another system in the place of the one that is integrated: the audit must say so
    right, wrong = random_system(25, 2, 1, damping=0.1), random_system(26, 2, 1, damping=0.1)
    monkeypatch.setattr(
        floquet.chart.filling, "chart_batch", lambda systems, *rest: original([wrong] * len(systems), *rest)
    )
    found = chart(right, np.linspace(1, 2, 5), np.linspace(0, 1, 5), audit=16)
    assert not audited(found).ok
    assert audited(found).largest_ratio > 1e3


original = floquet.chart.filling.chart_batch


def test_contradiction_is_not_ok() -> None:
    def audit(contradiction: bool) -> ChartAudit:
        return ChartAudit(np.array([[0, 0]]), np.array([1e-12]), np.array([1e-10]), np.array([contradiction]))

    assert audit(False).ok
    assert not audit(True).ok


def test_refused_cells_are_not_compared() -> None:
    nothing = ChartAudit(np.array([[0, 0]]), np.array([np.nan]), np.array([np.nan]), np.array([False]))
    assert nothing.compared == 0
    assert np.isnan(nothing.largest_difference)
    assert np.isnan(nothing.largest_ratio)
    assert nothing.ok


# ---- files ----


def test_save_and_load(example: StabilityChart, tmp_path: Path) -> None:
    path = tmp_path / "chart.npz"
    example.save(path)
    loaded = StabilityChart.load(str(path))
    assert same(example, loaded)
    for field in dataclasses.fields(ChartAudit):
        assert np.array_equal(getattr(loaded.audit, field.name), getattr(example.audit, field.name))
    dataclasses.replace(example, audit=None).save(path)  # replaces the file
    assert StabilityChart.load(path).audit is None
    assert [entry.name for entry in tmp_path.iterdir()] == ["chart.npz"]


def test_interrupted_save_leaves_the_old_file(
    example: StabilityChart, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "chart.npz"
    example.save(path)
    before = path.read_bytes()

    def interrupted(file: Any, **arrays: Any) -> None:
        file.write(b"half a file")
        raise KeyboardInterrupt

    monkeypatch.setattr(np, "savez_compressed", interrupted)
    with pytest.raises(KeyboardInterrupt):
        example.save(path)
    assert path.read_bytes() == before
    assert [entry.name for entry in tmp_path.iterdir()] == ["chart.npz"]


@pytest.mark.parametrize("content", [b"", b"no archive", b"PK\x03\x04 truncated"])
def test_load_refuses_other_files(content: bytes, tmp_path: Path) -> None:
    path = tmp_path / "other.npz"
    path.write_bytes(content)
    with pytest.raises(ValueError, match=r"other\.npz.*is not a saved chart.*give a file that save wrote"):
        StabilityChart.load(path)


def test_load_refuses_other_arrays(example: StabilityChart, tmp_path: Path) -> None:
    path = tmp_path / "chart.npz"
    np.savez(path, Omega=[1.0])
    with pytest.raises(ValueError, match="is not a saved chart"):
        StabilityChart.load(path)
    np.save(tmp_path / "array.npy", np.ones(3))
    with pytest.raises(ValueError, match="is not a saved chart"):
        StabilityChart.load(tmp_path / "array.npy")
    np.savez(
        path, **{name: getattr(example, name) for name in ARRAYS} | {"kind": np.zeros((2, 2), np.int8), "rigid": 0}
    )
    with pytest.raises(ValueError, match="kind has shape"):
        StabilityChart.load(path)
    with pytest.raises(FileNotFoundError):
        StabilityChart.load(tmp_path / "missing.npz")


@pytest.mark.parametrize("path", [None, 3, [1]])
def test_paths_are_checked(example: StabilityChart, path: Any) -> None:
    with pytest.raises(ValueError, match="is not a path"):
        example.save(path)
    with pytest.raises(ValueError, match="is not a path"):
        StabilityChart.load(path)


def test_without_xarray(example: StabilityChart, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "xarray", None)  # as if it were not installed
    with pytest.raises(ImportError, match=r"floquet-charts\[xarray\]"):
        example.to_xarray()


def test_to_xarray(example: StabilityChart) -> None:
    pytest.importorskip("xarray")
    dataset = example.to_xarray()
    assert dataset.growth_rate.dims == ("eps", "Omega")
    assert (dataset.kind.values == example.kind).all()


# ---- bad input ----


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"family": None}, "family = None"),
        ({"family": np.eye(2)}, "(?s)family = .* give"),
        ({"family": PeriodicSystem}, "family = "),
        ({"Omega": []}, "Omega is empty"),
        ({"Omega": [[1.0]]}, "Omega has shape"),
        ({"Omega": 0.0}, "Omega starts at .*0.0"),
        ({"Omega": [-1.0, 1.0]}, "Omega starts at .*-1.0"),
        ({"Omega": [1.0, 1.0]}, "Omega is not strictly increasing"),
        ({"Omega": [1.0, np.nan]}, "Omega has the entry nan"),
        ({"Omega": "1"}, "Omega has entries of type"),
        ({"Omega": [1.0, 2.0j]}, "Omega has entries of type complex"),
        ({"eps": []}, "eps is empty"),
        ({"eps": [0.0, np.inf]}, "eps has the entry inf"),
        ({"eps": [1.0, 0.0]}, "eps is not strictly increasing"),
        ({"eps": None}, "eps has entries of type"),
        ({"n_jobs": 0}, "n_jobs = 0"),
        ({"n_jobs": 1.5}, "n_jobs = 1.5"),
        ({"n_jobs": "2"}, "n_jobs = '2'"),
        ({"progress": 1}, "progress = 1"),
        ({"progress": "yes"}, "progress = 'yes'"),
        ({"audit": -1}, "audit = -1"),
        ({"audit": True}, "audit = True"),
    ],
)
def test_arguments_are_checked(arguments: dict[str, Any], message: str) -> None:
    good: dict[str, Any] = {"family": mathieu(), "Omega": [1.0], "eps": [0.1]}
    with pytest.raises(ValueError, match=message):
        stability_chart(**good | arguments)


def test_families_are_checked() -> None:
    class Wrong:
        def at(self, Omega: float) -> Any:
            return "no system"

    with pytest.raises(ValueError, match=r"family\.at"):
        chart(Wrong(), [1.0], [0.1])


def test_charts_are_checked(example: StabilityChart) -> None:
    with pytest.raises(ValueError, match="growth_rate has shape"):
        dataclasses.replace(example, growth_rate=np.zeros((2, 2)))
    with pytest.raises(ValueError, match="Omega is not strictly increasing"):
        dataclasses.replace(example, Omega=example.Omega[::-1])


@pytest.mark.parametrize(("Omega", "eps"), [(1e-7, 1.0), (1e-200, 1.0), (1.0, 1e10)])
def test_a_period_of_too_many_cycles_is_refused(Omega: float, eps: float) -> None:
    with pytest.raises(ValueError, match="cycles of the fastest motion"):
        chart(mathieu(), np.array([Omega]), np.array([0.0, eps]))
