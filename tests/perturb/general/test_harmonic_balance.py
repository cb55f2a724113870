"""Harmonic balance against SciPy's Mathieu functions, multipliers of integrated equations, and exact exponents."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.special import mathieu_a, mathieu_b

from floquet import monodromy
from periodic import FirstOrderSystem, PeriodicSystem, Term, waveforms
from periodic.examples import mathieu
from perturb.general import balanced_amplitudes, balanced_exponents
from tests.general_systems import Reference
from tests.perturb.general.general_oracles import with_terms


@pytest.mark.parametrize("multiplier", [1, -1])
@pytest.mark.parametrize("Omega", [0.7, 1.1, 1.9, 2.2])
def test_amplitudes_of_the_mathieu_equation(Omega: float, multiplier: int) -> None:
    """With z = Omega t / 2: a = 4 / Omega^2, q = 2 eps / Omega^2; even orders have the period T."""
    found = balanced_amplitudes(mathieu(), Omega, multiplier, 3.0)
    a, curves = 4 / Omega**2, []
    for n in range(9):
        if (n % 2 == 0) == (multiplier == 1):
            curves += [(mathieu_a, n)] + ([(mathieu_b, n)] if n else [])
    for eps in found.eps:
        assert min(abs(f(n, 2 * eps / Omega**2) - a) for f, n in curves) < 1e-10
    # none is missing
    eps = np.linspace(0, 3, 3001)
    crossings = sum(np.count_nonzero(np.diff(np.sign(f(n, 2 * eps / Omega**2) - a))) for f, n in curves)
    assert len(found.eps) == crossings
    assert (found.change < 1e-10).all()


@pytest.mark.parametrize("name", ["mems_a0.1", "two_blade_whirl_a"])
def test_amplitudes_are_where_a_multiplier_is_minus_one(name: str) -> None:
    family = Reference(name, 0.3)
    found = balanced_amplitudes(family, 1.93, -1, 0.6)
    for eps in found.eps:
        assert np.abs(monodromy(family, 1.93, float(eps)).multipliers + 1).min() < 1e-8
    if name == "mems_a0.1":
        assert len(found.eps) == 1


def test_powers_of_eps_are_part_of_the_pencil() -> None:
    """x'' + (1 + eps^2 cos Omega t) x = 0 is a Mathieu equation at the amplitude eps^2."""
    squared = PeriodicSystem([[1.0]], stiffness=[[1.0]], terms=[Term("stiffness", [[1.0]], waveforms.cosine(), 2)])
    found = balanced_amplitudes(squared, 1.9, -1, 1.5)
    np.testing.assert_allclose(found.eps**2, balanced_amplitudes(mathieu(), 1.9, -1, 2.25).eps, rtol=1e-12)


@pytest.mark.parametrize(
    ("name", "Omega", "eps"),
    [("mems_a0.1", 1.9, 0.3), ("two_blade_whirl_a", 1.3, 0.5), ("sls3_a", 2.1, 0.2), ("lyapunov5_a", 1.0, 1.0)],
)
def test_exponents_of_the_references(name: str, Omega: float, eps: float) -> None:
    family = Reference(name, eps)
    found = balanced_exponents(family, Omega, eps)
    expected = monodromy(family, Omega, eps).multipliers
    assert len(found.exponents) == len(expected)
    multipliers = np.exp(found.exponents * 2 * np.pi / Omega)
    for multiplier in multipliers:
        assert np.abs(expected - multiplier).min() < 1e-9
    assert found.change < 1e-11


def test_exponents_of_random_systems_with_terms_in_every_matrix() -> None:
    for seed in range(4):
        system = with_terms(seed, 0.05)
        found = balanced_exponents(system, 2.3, 0.2)
        assert found.growth_rate == pytest.approx(monodromy(system, 2.3, 0.2).growth_rate, abs=1e-10)


def test_exponents_where_they_are_known() -> None:
    """x_1' = (a + eps cos) x_1 has the exponent a whatever eps is."""
    system = FirstOrderSystem(np.diag([-0.1, 0.2, -0.7]), cosine=np.diag([1.0, -2.0, 0.5]))
    found = balanced_exponents(system, 1.0, 0.8)
    np.testing.assert_allclose(np.sort(found.exponents.real), [-0.7, -0.1, 0.2], atol=1e-12)


def test_waveforms_that_do_not_end_are_refused() -> None:
    system = PeriodicSystem([[1.0]], stiffness=[[1.0]], terms=[Term("stiffness", [[1.0]], waveforms.rectangular())])
    for call in (lambda: balanced_exponents(system, 1.0, 0.1), lambda: balanced_amplitudes(system, 1.0, 1, 0.1)):
        with pytest.raises(ValueError, match="no Fourier sum"):
            call()


def test_bad_arguments_are_named() -> None:
    with pytest.raises(ValueError, match=r"^multiplier = 2"):
        balanced_amplitudes(mathieu(), 1.0, 2, 1.0)
    with pytest.raises(ValueError, match=r"^eps_max"):
        balanced_amplitudes(mathieu(), 1.0, 1, 0.0)
    with pytest.raises(ValueError, match=r"^Omega"):
        balanced_exponents(mathieu(), -1.0, 0.1)
