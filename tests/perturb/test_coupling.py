"""Coupling of two modes: the paper's blocks against the closed form, signs, invariances, exact zeros."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from periodic import PeriodicSystem
from perturb import gyroscopic_modes
from perturb.coupling import amplitude, closed_form, products
from tests.perturb.paper_blocks import block_form, modal_blocks
from tests.perturb.perturb_oracles import changed, congruent, random_system

seeds = st.integers(0, 10**6)
types = st.sampled_from(["sum", "difference"])
few = settings(deadline=None, max_examples=20)


def all_products(system: PeriodicSystem, type: str, j: int = 1) -> np.ndarray:
    return products(gyroscopic_modes(system), amplitude(system, j), type)


@few
@given(seeds, types, st.booleans(), st.sampled_from([1, 2]))
def test_blocks_of_the_paper_agree_with_the_closed_form(seed: int, type: str, symmetric: bool, j: int) -> None:
    """Eqs. (26b), (26c), (28a) as printed and (28b) corrected, for symmetric and for unsymmetric F."""
    system = random_system(seed, 4, harmonics=2, symmetric=symmetric)
    modes = gyroscopic_modes(system)
    blocks, closed = block_form(modal_blocks(system, modes), j, type), closed_form(modes, amplitude(system, j), type)
    scale = np.abs(closed.forward).max()
    np.testing.assert_allclose(blocks.forward, closed.forward, atol=1e-12 * scale)
    np.testing.assert_allclose(blocks.backward, closed.backward, atol=1e-12 * scale)


def test_printed_eq_28b_is_wrong() -> None:
    """With its first - g^12 as printed, L of difference type comes out complex although F is symmetric."""
    system = random_system(5, 3)
    modes = gyroscopic_modes(system)
    blocks = modal_blocks(system, modes)
    g = blocks.G[0]
    printed = block_form(blocks, 1, "difference").backward + 0.5 * (g[..., 0, 0] - g[..., 0, 1]).T
    L = block_form(blocks, 1, "difference").forward * printed
    p, q = 2, 0
    assert abs(L[p, q].imag) > 0.01 * abs(L[p, q])
    assert all_products(system, "difference")[p, q].imag == 0


@few
@given(seeds)
def test_symmetric_excitation_gives_real_products_of_known_sign(seed: int) -> None:
    system = random_system(seed, 4)
    for type, sign in (("sum", 1), ("difference", -1)):
        L = all_products(system, type)
        assert (L.imag == 0).all()
        assert (sign * L.real >= 0).all()


@few
@given(seeds)
def test_single_modes_have_real_products_for_any_excitation(seed: int) -> None:
    L = np.diagonal(all_products(random_system(seed, 4, symmetric=False), "sum"))
    assert (L.imag == 0).all()
    assert (L.real > 0).all()


def test_unsymmetric_excitation_gives_complex_products() -> None:
    L = all_products(random_system(2, 3, symmetric=False), "sum")
    assert abs(L[1, 0].imag) > 0.01 * abs(L[1, 0])


@few
@given(seeds, types, st.floats(0, 2 * np.pi))
def test_origin_of_time_decides_nothing(seed: int, type: str, phase: float) -> None:
    """j Omega t -> j Omega t + phase mixes cosine and sine."""
    system = random_system(seed, 3, symmetric=False)
    c, s = np.cos(phase), np.sin(phase)
    shifted = changed(system, cosine=c * system.cosine + s * system.sine, sine=c * system.sine - s * system.cosine)
    L = all_products(system, type)
    np.testing.assert_allclose(all_products(shifted, type), L, atol=1e-12 * np.abs(L).max())


@few
@given(seeds, types)
def test_coordinates_decide_nothing(seed: int, type: str) -> None:
    system = random_system(seed, 3, symmetric=False)
    T = np.random.default_rng(seed).normal(size=(3, 3)) + 3 * np.eye(3)
    L = all_products(system, type)
    np.testing.assert_allclose(all_products(congruent(system, T), type), L, atol=1e-9 * np.abs(L).max())


@few
@given(seeds, types)
def test_reversed_transport_decides_nothing(seed: int, type: str) -> None:
    """G -> -G with t -> -t: conjugate modes, the same L for cosine excitation."""
    system = random_system(seed, 3)
    system = changed(system, sine=0 * system.sine)
    there = changed(system, gyroscopic=-system.gyroscopic)
    L = all_products(system, type)
    np.testing.assert_allclose(all_products(there, type), L, atol=1e-12 * np.abs(L).max())


@few
@given(seeds, types)
def test_modes_of_separate_blocks_are_not_coupled_at_all(seed: int, type: str) -> None:
    """Exactly zero, although the coordinates mix the two blocks and rounding couples them."""
    one, two = random_system(seed, 3), random_system(seed + 1, 2)

    def side_by_side(name: str) -> np.ndarray:
        a, b = getattr(one, name), getattr(two, name)
        joined = np.zeros((*a.shape[:-2], 5, 5))
        joined[..., :3, :3], joined[..., 3:, 3:] = a, b
        return joined

    names = ("mass", "gyroscopic", "damping", "stiffness", "cosine", "sine")
    both = PeriodicSystem(**{name: side_by_side(name) for name in names})
    T = np.random.default_rng(seed).normal(size=(5, 5)) + 4 * np.eye(5)
    modes = gyroscopic_modes(both)
    first = np.isin(np.round(modes.frequencies, 8), np.round(gyroscopic_modes(one).frequencies, 8))
    L = all_products(congruent(both, T), type)
    assert (L[np.ix_(first, ~first)] == 0).all()
    assert (np.abs(L[np.ix_(first, first)]) > 0).all()
