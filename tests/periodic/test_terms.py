"""Terms and the two kinds of systems: the short form, sums of matrices, refusals, and the gate for other methods."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from floquet import trace_regions
from floquet.engine import subsystems
from floquet.oracle import reduce_system, rigid_basis
from periodic import (
    FirstOrderSystem,
    PeriodicSystem,
    Term,
    any_member_at,
    check_mass,
    member_at,
    stiffness_alone,
    waveforms,
)

X = np.array([[1.0, 0.3], [0.3, -0.5]])
SKEW = np.array([[0.0, 1.0], [-1.0, 0.0]])


def system(*terms: Term, **matrices: Any) -> PeriodicSystem:
    """Two oscillators with terms."""
    return PeriodicSystem(**{"mass": np.eye(2), "stiffness": np.diag([1.0, 3.0])} | matrices, terms=terms)


def test_harmonics_of_the_stiffness_become_the_short_form() -> None:
    made = system(
        Term("stiffness", X),
        Term("stiffness", X, waveforms.cosine(3)),
        Term("stiffness", SKEW, waveforms.sine(2)),
        cosine=2 * X,
    )
    assert made.terms == ()
    np.testing.assert_array_equal(made.cosine, [3 * X, 0 * X, X])
    np.testing.assert_array_equal(made.sine, [0 * X, SKEW, 0 * X])


def test_other_terms_stay_as_they_are() -> None:
    terms = (
        Term("stiffness", X, power=2),
        Term("stiffness", X, waveforms.rectangular()),
        Term("damping", X),
        Term("gyroscopic", SKEW, waveforms.sine(2)),
        Term("mass", X),
        Term("stiffness", X, waveforms.constant()),
    )
    made = system(*terms)
    assert made.terms == terms
    assert not made.cosine.any()


def test_the_mean_of_a_waveform_grows_with_eps_and_its_harmonics_are_the_short_form() -> None:
    made = system(Term("stiffness", X, waveforms.function(lambda theta: 0.5)))
    assert made.terms[0].waveform.fourier(0)[0] == pytest.approx([0.5])
    mixed = waveforms.Trigonometric((2.0, 0.5), (0.0, 0.0))
    made = system(Term("stiffness", X, mixed))
    np.testing.assert_array_equal(made.cosine, [0.5 * X])
    np.testing.assert_array_equal(made.terms[0].matrix, 2 * X)
    np.testing.assert_allclose(made.matrices(0.4, 0.7)[3] - made.stiffness, 0.7 * (2 + 0.5 * np.cos(0.4)) * X)


def test_matrices_are_the_sums_of_the_definition() -> None:
    made = system(
        Term("mass", 0.1 * X, waveforms.cosine(2)),
        Term("damping", X, waveforms.triangle(), power=2),
        Term("gyroscopic", SKEW, waveforms.sine()),
        Term("stiffness", X, waveforms.sawtooth(), power=3),
        Term("stiffness", X, waveforms.impulses([0.5], [1.0])),
        cosine=X,
        sine=SKEW,
    )
    theta, eps = np.array([[0.3, 2.0], [4.0, 6.0]]), 0.6
    M, G, C, K = made.matrices(theta, eps)
    for i in np.ndindex(theta.shape):
        t, x = theta[i], theta[i] / (2 * np.pi)
        np.testing.assert_allclose(M[i], np.eye(2) + eps * np.cos(2 * t) * 0.1 * X)
        np.testing.assert_allclose(C[i], eps**2 * (4 * abs(x - 0.5) - 1) * X, atol=1e-15)
        np.testing.assert_allclose(G[i], eps * np.sin(t) * SKEW)
        excitation = eps * (np.cos(t) * X + np.sin(t) * SKEW) + eps**3 * (2 * x - 1) * X
        np.testing.assert_allclose(K[i], np.diag([1.0, 3.0]) + excitation)


def test_first_order_systems_take_any_size() -> None:
    A = np.arange(9.0).reshape(3, 3)
    made = FirstOrderSystem(A, A, terms=[Term("state", A, waveforms.sine(2)), Term("state", A, power=2)])
    assert (made.size, len(made.cosine), len(made.terms)) == (3, 2, 1)
    expected = A * (1 + 0.5 * np.cos(0.3) + 0.5 * np.sin(0.6) + 0.25 * np.cos(0.3))
    np.testing.assert_allclose(made.matrix(0.3, 0.5), expected)
    assert made.at(2.0) is made


def test_arrays_of_terms_are_copies_that_nobody_changes() -> None:
    given = X.copy()
    term = Term("damping", given)
    given += 1
    np.testing.assert_array_equal(term.matrix, X)
    with pytest.raises(ValueError, match="read-only"):
        term.matrix[0] = 0


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ({"of": "force", "matrix": X}, r"^of = 'force' is not known"),
        ({"of": "damping", "matrix": X, "power": 0}, r"^power = 0 is out of range"),
        ({"of": "damping", "matrix": X, "power": 1.0}, r"^power = 1.0 is not a whole number"),
        ({"of": "damping", "matrix": SKEW}, r"^the damping term's matrix is not symmetric"),
        ({"of": "gyroscopic", "matrix": X}, r"^the gyroscopic term's matrix is not skew-symmetric"),
        ({"of": "stiffness", "matrix": X[:1]}, r"^matrix has shape \(1, 2\)"),
        ({"of": "stiffness", "matrix": X, "waveform": np.cos}, r"^waveform = .* is no waveform"),
        ({"of": "mass", "matrix": X, "waveform": waveforms.impulses([0.0], [1.0])}, r"^waveform of a mass term"),
    ],
)
def test_refuses_terms_by_name(arguments: dict[str, Any], says: str) -> None:
    with pytest.raises(ValueError, match=says):
        Term(**arguments)


@pytest.mark.parametrize(
    ("terms", "says"),
    [
        ([Term("state", X)], r"^terms\[0\] is of 'state'"),
        ([Term("damping", X), "K1c"], r"^terms\[1\] = 'K1c' is no Term"),
        ([Term("damping", np.eye(3))], r"^terms\[0\] has a matrix of shape \(3, 3\); give \(2, 2\)"),
        (3, r"^terms = 3 is no sequence"),
    ],
)
def test_refuses_terms_that_do_not_fit(terms: Any, says: str) -> None:
    with pytest.raises(ValueError, match=says):
        PeriodicSystem(np.eye(2), terms=terms)


def test_a_mass_that_becomes_singular_is_refused_with_its_phase() -> None:
    made = system(Term("mass", np.diag([1.0, 0.0]), waveforms.cosine(1, phase=0.3)))
    check_mass(made, 0.99)
    with pytest.raises(ValueError, match=r"eps = 1.01 is not positive definite at the phase 0\.[78]"):
        check_mass(made, 1.01)
    # between samples: the mass is negative in two parts in a thousand of the period
    with pytest.raises(ValueError, match=r"not positive definite at the phase 0\.(799|80[01])"):
        check_mass(made, 1.00002)
    jumping = system(Term("mass", np.eye(2), waveforms.rectangular(0.999, phase=0.2)))
    with pytest.raises(ValueError, match=r"not positive definite at the phase 0\.199"):
        check_mass(jumping, 1.0)


GENERAL = [system(Term("damping", X)), system(Term("stiffness", X, power=2)), FirstOrderSystem(np.eye(2))]


@pytest.mark.parametrize("made", GENERAL)
def test_methods_for_stiffness_alone_refuse_everything_else(made: Any) -> None:
    assert any_member_at(made, 1.0) is made
    calls = [
        lambda: stiffness_alone(made),
        lambda: member_at(made, 1.0),
        lambda: trace_regions(made, (1.0, 2.0), (0.0, 0.1), progress=False),
        lambda: reduce_system(made, 0.1, 1.0),
        lambda: rigid_basis(made, 0.1),
    ]
    for call in calls:
        with pytest.raises(ValueError, match=r"(is of first order|has a term of).*this method takes.*alone"):
            call()
    if isinstance(made, PeriodicSystem):
        with pytest.raises(ValueError, match="has a term of"):
            subsystems(made)
