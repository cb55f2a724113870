"""Every sentence about random systems is true, as far as an integrator of another kind can tell."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from numpy.testing import assert_allclose

from floquet import monodromy
from periodic.examples import mathieu
from tests.floquet.oracle_systems import dop853
from tests.hunt.statements import traces
from tests.hunt.statements.hunt import Tally, case
from tests.hunt.statements.magnus import Flows
from tests.hunt.statements.origin import origin
from tests.hunt.statements.parts import parts_of
from tests.hunt.statements.statement import Judged
from tests.hunt.statements.systems import SORTS

FEW, MANY, PLATES = 100, 10_000, 1_000
# Largest part of the statements on random plates that may be withheld.
MAX_WITHHELD = 0.02


def wrong(tally: Tally) -> str:
    return "\n".join(
        f"seed {one.seed}, {one.sort}: {one.asked}: {statement.sentence}"
        for one, statement in tally.noted
        if statement.judged == Judged.WRONG
    )


def hunted(seed: int, statements: int, sort: str | None = None) -> Tally:
    tally = Tally()
    for _ in tally.cases_from(seed, statements, sort):
        pass
    return tally


def test_a_hundred_statements() -> None:
    tally = hunted(0, FEW)
    assert not wrong(tally), wrong(tally)
    assert tally.checked >= FEW


@pytest.mark.parametrize("seed", [51012, 51080])
def test_a_region_whose_pairs_turn_too_fast_to_be_followed_has_its_edges(seed: int) -> None:
    statements = case(seed).statements
    assert statements
    assert [one.sentence for one in statements if one.judged is Judged.WRONG] == []


@pytest.mark.parametrize("seed", [50993, 52268])
def test_a_region_is_not_looked_for_where_the_search_ends(seed: int) -> None:
    statements = case(seed).statements
    assert [one.sentence for one in statements if one.judged is Judged.WRONG] == []


@pytest.mark.slow
def test_ten_thousand_statements(tabulate: Callable[..., None]) -> None:
    tally = hunted(10_000, MANY)
    counts = {str(one): tally.counts[one] for one in (Judged.WRONG, Judged.WITHHELD, Judged.TOO_FINE)}
    tabulate("Statements", systems=tally.cases, checked=tally.checked, **counts)
    assert not wrong(tally), wrong(tally)


@pytest.mark.slow
def test_little_is_withheld_about_plates() -> None:
    tally = hunted(20_000, PLATES, "plate")
    assert not wrong(tally), wrong(tally)
    assert tally.counts[Judged.WITHHELD] < MAX_WITHHELD * tally.checked


@pytest.mark.parametrize("sort", SORTS)
def test_the_other_integrator(sort: str) -> None:
    random = np.random.default_rng(3)
    system = SORTS[sort](random)
    parts = parts_of(system)
    omega = min(part.exponents.imag.min() for part in parts if len(part.exponents))
    eps = 0.2 / traces.relative_strength(parts)
    frequencies = omega * np.array([2.0] if sort.startswith("plate") else [1.3, 1.9, 2.0])  # DOP853 takes its time
    found = Flows(parts).dominant(frequencies, eps)
    for Omega, growth, error in zip(frequencies, found.growth, found.error, strict=True):
        right = float(np.log(np.abs(np.linalg.eigvals(dop853(system, Omega, eps)))).max())
        if right > 1e-5:
            assert_allclose(growth, right, rtol=0, atol=error + 1e-9)
        else:  # what is left of a rigid motion is rounding of DOP853
            assert growth < error + 1e-6


def test_the_other_integrator_knows_how_wrong_it_is() -> None:
    flows = Flows(parts_of(mathieu()))
    for Omega in np.linspace(0.4, 2.5, 30):  # from one to the next, errors are not measured anew
        found = flows.dominant(float(Omega), 0.8)
        right = monodromy(mathieu(), float(Omega), 0.8)
        if right.kind > 0 and found.state[0] == 1:
            assert abs(found.growth[0] - right.growth_rate * 2 * np.pi / Omega) <= found.error[0] + 10 * right.error


def test_a_region_is_followed_down_to_its_origin() -> None:
    flows = Flows(parts_of(mathieu()))
    for j in (1, 2):
        came = origin(flows, 2.0 / j - 0.01 * (j - 1), 0.3, 0.3, j, 2.0 / j)
        assert came is not None
        assert abs(came[0] - 2.0 / j) < 0.01


# What the hunt must notice: each changes an answer so that it is wrong.
def _wider(trace: object) -> dict[str, object]:
    return {"intervals": tuple(one * np.array([1 - 1e-3, 1 + 1e-3]) for one in trace.intervals)}  # type: ignore[attr-defined]


LIES = {
    "edges too far out": _wider,
    "closed": lambda trace: {
        "covered": np.zeros(1, dtype=bool),
        "intervals": (np.empty((0, 2)),),
        "kind": np.zeros(1, dtype=np.int8),
    },
    "of another kind": lambda trace: {"kind": 5 - trace.kind},
    "of another resonance": lambda trace: {"resonance": trace.resonance._replace(centre=1.01 * trace.near)},
}


@pytest.mark.parametrize("name", LIES)
def test_lies_are_found(monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    from dataclasses import replace

    answer = traces.trace_boundary

    def lie(*arguments: object, **options: object) -> object:
        trace = answer(*arguments, **options)
        return replace(trace, **LIES[name](trace)) if len(trace.intervals[0]) == 1 else trace

    seeds = [seed for seed in range(40) if list(SORTS)[seed % len(SORTS)] in ("plain", "damped", "two_harmonics")]
    monkeypatch.setattr(traces, "trace_boundary", lie)
    tally = Tally()
    for seed in seeds:
        tally.add(case(seed))
        if tally.counts[Judged.WRONG]:
            return
    pytest.fail("no lie was found")
