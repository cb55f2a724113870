"""Charts of any linear periodic system: references, `monodromy`, one system in two ways, the cache, refusals."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from floquet import Kind, monodromy, stability_chart
from floquet.chart import TileStore
from periodic import AnySystem, FirstOrderSystem, PeriodicSystem, Term, waveforms
from tests.floquet.general_oracles import random_first_order, random_second_order
from tests.general_systems import Reference, growth_rates

GROWTH_RATES = growth_rates()
SYSTEMS = sorted({entry["system"] for entry in GROWTH_RATES})
FEW = 6  # random systems in `make test`: every sort of them
X = np.array([[1.0, 0.3], [0.3, -0.5]])


def chart(family: Any, Omega: Any, eps: Any, **options: Any) -> Any:
    """A chart without a progress bar, by one worker."""
    return stability_chart(family, Omega, eps, **({"n_jobs": 1, "progress": False, "audit": 0} | options))


@pytest.mark.parametrize("name", SYSTEMS)
def test_references(name: str) -> None:
    """log|mu| to 1e-9 where multipliers are apart, and within the estimate everywhere; no wrong verdict."""
    entry = [one for one in GROWTH_RATES if one["system"] == name][-1]
    family = Reference(name, entry["eps"])
    eps = np.unique([0.0, family.amplitude / 2, family.amplitude])
    found = chart(family, [entry["Omega"]], eps)
    i = int(np.flatnonzero(found.eps == family.amplitude)[0])
    difference = abs(found.growth_rate[i, 0] - entry["value"]) * 2 * np.pi / entry["Omega"]
    assert difference < 1e-9
    assert difference <= found.error[i, 0] + 1e-13
    assert found.kind[i, 0] == Kind.UNDECIDED or (found.kind[i, 0] > Kind.STABLE) == (entry["value"] > 0)


@pytest.mark.parametrize("seed", [pytest.param(seed, marks=[pytest.mark.slow] * (seed >= FEW)) for seed in range(12)])
def test_random_systems_agree_with_monodromy(seed: int) -> None:
    rng = np.random.default_rng(seed)
    kinds, pulses = (3, False) if seed % 3 == 0 else (7, seed % 2 == 0)
    system: AnySystem = (
        random_first_order(seed, int(rng.integers(1, 8)), kinds=kinds, pulses=pulses)
        if seed % 2
        else random_second_order(seed, int(rng.integers(1, 4)), kinds=kinds, pulses=pulses)
    )
    Omega, eps = np.sort(rng.uniform(0.8, 4, 2)), np.linspace(-0.5, 0.8, 12)
    found = chart(system, Omega, eps)
    for i, j in ((0, 0), (5, 1), (11, 0)):
        point = monodromy(system, float(Omega[j]), float(eps[i]))
        difference = abs(found.growth_rate[i, j] - point.growth_rate) * 2 * np.pi / Omega[j]
        assert difference < 1e-9
        assert difference <= found.error[i, j] + point.log_modulus_error + 1e-13
        kinds_found = {bool(kind > Kind.STABLE) for kind in (found.kind[i, j], point.kind) if kind != Kind.UNDECIDED}
        assert len(kinds_found) < 2


def test_what_is_stiffness_alone_is_computed_as_that() -> None:
    terms = [Term("stiffness", X), Term("stiffness", X.T, waveforms.sine(2))]
    as_terms = PeriodicSystem(np.eye(2), stiffness=np.diag([1.0, 3.0]), terms=terms)
    short = PeriodicSystem(np.eye(2), stiffness=np.diag([1.0, 3.0]), cosine=[X, 0 * X], sine=[0 * X, X.T])
    one, other = (chart(system, [1.9, 2.1], [0.1, 0.3]) for system in (as_terms, short))
    np.testing.assert_array_equal(one.growth_rate, other.growth_rate)
    np.testing.assert_array_equal(one.error, other.error)


def test_a_second_order_system_and_its_first_order_form_agree() -> None:
    terms = [Term("damping", 0.3 * X, waveforms.sawtooth(), 2), Term("gyroscopic", [[0.0, 0.5], [-0.5, 0.0]])]
    K, C = np.diag([1.0, 3.0]), 0.1 * np.eye(2)
    second = PeriodicSystem(np.eye(2), damping=C, stiffness=K, cosine=X, terms=terms)

    def state(on_velocity: Any, on_place: Any, unit: float) -> Any:
        return np.block([[-on_velocity, -on_place], [unit * np.eye(2), np.zeros((2, 2))]])

    zero = np.zeros((2, 2))
    first = FirstOrderSystem(
        state(C, K, 1.0),
        state(zero, X, 0.0),
        terms=[Term("state", state(term.matrix, zero, 0.0), term.waveform, term.power) for term in terms],
    )
    Omega, eps = [1.4, 2.0, 3.1], np.linspace(0, 0.8, 10)
    one, other = chart(second, Omega, eps), chart(first, Omega, eps)
    np.testing.assert_allclose(one.growth_rate, other.growth_rate, atol=1e-9)
    np.testing.assert_array_equal(one.kind, other.kind)


def test_an_undamped_accelerating_beam_is_stable_where_it_is_and_its_chart_audits_itself() -> None:
    found = chart(Reference("beam_v0.6_vf0.8_N4_a0", 0.1), np.linspace(16, 17, 9), np.linspace(0, 0.3, 12), audit=8)
    assert found.audit.ok
    assert (found.kind == Kind.STABLE).sum() > 40
    assert (found.growth_rate[found.kind == Kind.STABLE] == 0).all()
    assert (found.kind > Kind.STABLE).any()


def test_tiles_of_other_terms_are_other_tiles(tmp_path: Path) -> None:
    """The cache tells systems apart that differ in one thing only."""
    store = TileStore(tmp_path)
    eps = np.array([0.1, 0.2])

    def path(term: Term) -> Path:
        system = PeriodicSystem(np.eye(2), stiffness=np.eye(2), terms=[term])
        return store.path([([system], np.array([1.0]), eps)], 16.0)

    terms = [
        Term("damping", X),
        Term("damping", 2 * X),
        Term("damping", X, power=2),
        Term("damping", X, waveforms.rectangular()),
        Term("damping", X, waveforms.rectangular(0.4)),
        Term("mass", X),
        Term("stiffness", X, power=2),
    ]
    assert len({path(term) for term in terms}) == len(terms)
    assert path(terms[3]) == path(Term("damping", X, waveforms.rectangular()))
    first = FirstOrderSystem(np.eye(2), terms=[Term("state", X, power=2)])
    second = FirstOrderSystem(np.eye(2), terms=[Term("state", X, power=3)])
    assert store.path([([first], np.array([1.0]), eps)], 16.0) != store.path([([second], np.array([1.0]), eps)], 16.0)


def test_a_chart_goes_on_from_its_cache(tmp_path: Path) -> None:
    system = random_second_order(3, 2)
    one = chart(system, [1.0, 1.5], [0.1, 0.4], cache=tmp_path)
    assert list(tmp_path.glob("*.tile"))
    again = chart(system, [1.0, 1.5], [0.1, 0.4], cache=tmp_path)
    np.testing.assert_array_equal(one.growth_rate, again.growth_rate)


def test_refuses_a_mass_that_becomes_singular() -> None:
    system = PeriodicSystem(np.eye(1), stiffness=np.eye(1), terms=[Term("mass", np.eye(1))])
    with pytest.raises(ValueError, match=r"^mass at eps = 1.2 is not positive definite at the phase 0\.[45]"):
        chart(system, [1.0], [0.1, 0.5, 1.2])
    # of second order in eps the mass may be singular in between and not at the ends
    bump = [Term("mass", [[-4.0]], waveforms.constant()), Term("mass", [[4.0]], waveforms.constant(), 2)]
    system = PeriodicSystem(np.eye(1), stiffness=np.eye(1), terms=[*bump, Term("damping", [[1.0]])])
    with pytest.raises(ValueError, match=r"^mass at eps = 0.5 is not"):
        chart(system, [1.0], [0.0, 0.5, 1.0])
