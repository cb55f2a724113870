"""Every sort of result goes into a file and comes back, in both formats; other files are refused."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from beam import MovingBeam
from compare import agreement, difference, load, save
from floquet import (
    Kind,
    PlaneChart,
    Point,
    StabilityChart,
    floquet_modes,
    monodromy,
    plane_chart,
    stability_chart,
    trace_boundary,
    trace_regions,
)
from periodic import FirstOrderSystem, PeriodicSystem, Term, waveforms
from periodic.examples import coupled_mathieu, mathieu
from perturb import gyroscopic_modes, transition_curves
from plate import MovingPlate

PAIR, DAMPED = coupled_mathieu(), mathieu(damping=0.1)


def chart() -> StabilityChart:
    return stability_chart(DAMPED, [1.9, 2.0, 2.1], [0.1, 0.3], audit=2, n_jobs=1, progress=False)


RESULTS: dict[str, Callable[[], Any]] = {
    "chart": chart,
    "difference": lambda: difference(chart(), chart()),
    "regions": lambda: trace_regions(PAIR, (1.5, 3.2), (0.0, 0.3), n_jobs=1, progress=False),
    "trace": lambda: trace_boundary(DAMPED, near=2.0, eps=[0.1, 0.3]),
    "curves": lambda: transition_curves(PAIR, (1.3, 3.2)),
    "modes of a system": lambda: gyroscopic_modes(PAIR),
    "verdicts": lambda: agreement(DAMPED, (1.5, 2.5), n_jobs=1),
    "stress": lambda: MovingPlate().stress(Omega=0.0, harmonic=0, x=[0.1, 0.2], y=[0.2]),
    "response": lambda: floquet_modes(PAIR, 2.0, 0.1).response([0, 0, 1, 0], 2),
    "transient": lambda: floquet_modes(PAIR, 2.0, 0.1).transient(2),
    "system": lambda: PAIR,
    "first order": lambda: FirstOrderSystem([[-1.0]], cosine=[[0.5]]),
    "jumps": lambda: PeriodicSystem(
        [[1.0]], stiffness=[[1.0]], terms=[Term("damping", [[1.0]], waveforms.rectangular(duty=0.25), power=2)]
    ),
    "function": lambda: PeriodicSystem([[1.0]], terms=[Term("stiffness", [[1.0]], waveforms.function(np.sin))]),
    "models": lambda: (MovingPlate(speed=2.0), MovingBeam(1.0, 0.5)),
    "plain": lambda: {"a": [1, 2.5, 1j, Kind.STABLE], 3: (None, True, "ω", float("nan"), np.zeros((0, 2)))},
}


def same(one: Any, other: Any) -> bool:
    """Whether two results are of one type and equal to the last bit."""
    if isinstance(one, np.ndarray):
        return one.dtype == other.dtype and np.array_equal(one, other, equal_nan=one.dtype.kind in "fc")
    if dataclasses.is_dataclass(one):
        names = [field.name for field in dataclasses.fields(one)]
        return type(one) is type(other) and all(same(getattr(one, name), getattr(other, name)) for name in names)
    if isinstance(one, list | tuple):
        return type(one) is type(other) and len(one) == len(other) and all(map(same, one, other))
    if isinstance(one, dict):
        return list(one) == list(other) and all(same(one[key], other[key]) for key in one)
    return bool(type(one) is type(other) and (one == other or one != one))


@pytest.fixture(params=["nc", "npz"])
def path(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    if request.param == "nc":
        pytest.importorskip("xarray")
    return tmp_path / f"result.{request.param}"


@pytest.mark.parametrize("name", [name for name in RESULTS if name != "curves"])
def test_a_result_comes_back_to_the_last_bit(name: str, path: Path) -> None:
    result = RESULTS[name]()
    save(path, result)
    assert same(load(path), result)


def test_curves_come_back_with_what_they_can_say(path: Path) -> None:
    curves = transition_curves(PAIR, (1.3, 3.2), order=2)
    save(path, curves)
    for before, after in zip(curves, load(path), strict=True):
        assert repr(before) == repr(after)
        np.testing.assert_array_equal(before.edges([0.1, 0.2]), after.edges([0.1, 0.2]))


def test_regions_come_back_with_their_names(path: Path) -> None:
    regions = RESULTS["regions"]()
    save(path, regions)
    back = load(path)
    assert back["w1+w2"].width(0.2) == regions["w1+w2"].width(0.2)
    assert repr(back) == repr(regions)


def test_one_point_comes_back_with_its_multipliers_and_modes(path: Path) -> None:
    found = monodromy(PAIR, 2.7, 0.3)
    save(path, found)
    back = load(path)
    for name in ("matrix", "growth_rate", "kind", "multipliers", "multiplier_errors"):
        np.testing.assert_array_equal(getattr(back, name), getattr(found, name))
    modes = floquet_modes(PAIR, 2.7, 0.3)
    save(path, modes)
    again = load(path)
    np.testing.assert_array_equal(again.exponents, modes.exponents)
    np.testing.assert_array_equal(again[0].coefficients, modes[0].coefficients)


def test_what_other_programs_see_of_a_chart(tmp_path: Path) -> None:
    xarray = pytest.importorskip("xarray")
    save(tmp_path / "chart.nc", chart())
    with xarray.open_dataset(tmp_path / "chart.nc") as data:
        assert data.growth_rate.dims == ("eps", "Omega")
        assert data.growth_rate.sel(Omega=2.0, eps=0.3).item() == chart().growth_rate[1, 1]
        assert data.Omega.attrs == {"long_name": "excitation frequency", "units": "rad per unit of time of the system"}
        both = data.multiplier_real + 1j * data.multiplier_imag
        np.testing.assert_array_equal(both, chart().multiplier)


def test_what_is_no_data_is_refused_and_nothing_written(path: Path) -> None:
    for result, sentence in (
        (floquet_modes(PAIR, 2.0, 0.1)[0], "is one mode, which needs the others; save the FloquetModes that it is of"),
        (print, "is no data; save what you computed from it"),
    ):
        with pytest.raises(ValueError, match=sentence):
            save(path, result)
    assert not path.exists()


def test_names_of_files_are_checked(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(ValueError, match=r"has no known ending; give a name that ends in \.nc or \.npz"):
        save(tmp_path / "result.txt", 1.0)
    with pytest.raises(ValueError, match=r"^path = 3 is not a path"):
        load(3)
    with pytest.raises(FileNotFoundError):
        load(tmp_path / "none.npz")
    monkeypatch.setattr("compare.files.results.find_spec", lambda _: None)
    with pytest.raises(
        ValueError, match=r"needs xarray; install it with: pip install 'floquet-charts\[xarray\]', or take"
    ):
        save(tmp_path / "result.nc", 1.0)


def test_other_files_are_refused(path: Path) -> None:
    path.write_bytes(b"nothing of the sort")
    with pytest.raises(ValueError, match=r"not a saved result .*; give a file that save wrote"):
        load(path)


@pytest.mark.parametrize(
    "content",
    [
        {"type": "os:system", "fields": {"command": "true"}},
        {"type": "compare.files.results:replace_file", "fields": {}},
        {"type": "compare.files.results:Path", "fields": {}},
        {"type": "floquet.chart:StabilityChart", "fields": {}},
        {"dtype": "<f8", "shape": [1], "array": "missing"},
        {"type": "floquet.kind:Kind", "member": "WILD"},
    ],
)
def test_a_file_names_no_other_code(content: Any, tmp_path: Path) -> None:
    path = tmp_path / "other.npz"
    np.savez(path, result=json.dumps({"format": "floquet-charts result 1", "content": content}))
    with pytest.raises(ValueError, match="not a saved result"):
        load(path)


@pytest.mark.parametrize("ending", ["npz", "nc"])
def test_a_chart_of_a_plane(tmp_path: Path, ending: str) -> None:
    if ending == "nc":
        pytest.importorskip("xarray")

    def make(a: float, q: float) -> Point:
        if a > 2:
            raise ValueError("too much")
        return Point(mathieu(a), 2.0, q)

    chart = plane_chart(make, ("a", [0.5, 1.0, 3.0]), ("q", [0.1, 0.2]), n_jobs=1, progress=False, audit=0)
    save(tmp_path / f"plane.{ending}", chart)
    found = load(tmp_path / f"plane.{ending}")
    assert isinstance(found, PlaneChart)
    assert found.names == ("a", "q")
    assert found.remark == chart.remark
    for name in ("x", "y", "growth_rate", "multiplier", "kind", "refused"):
        np.testing.assert_array_equal(getattr(found, name), getattr(chart, name))
