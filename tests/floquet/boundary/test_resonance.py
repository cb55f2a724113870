"""Which resonance a frequency means."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import scipy.linalg as sla

from floquet import trace_boundary
from floquet.boundary import Resonance, natural_modes, nearest_resonance
from periodic import PeriodicSystem
from periodic.examples import coupled_mathieu, gyroscopic_rotor, mathieu
from tests.floquet.oracle_systems import first_order, random_system


def nearest(system: PeriodicSystem, near: float, **meant: tuple[Any, ...]) -> Resonance:
    return nearest_resonance(natural_modes(system, near), near, **meant)


def name(system: PeriodicSystem, near: float) -> tuple[int, int, int, str]:
    return nearest(system, near)[:4]


@pytest.mark.parametrize(
    ("near", "expected"),
    [
        (2.0, (1, 1, 1, "sum")),
        (4.04, (2, 2, 1, "sum")),
        (3.02, (2, 1, 1, "sum")),
        (1.02, (2, 1, 1, "difference")),
        (1.0, (1, 1, 2, "sum")),  # the tongue 2 omega_1 / 2, exactly
        (0.99, (1, 1, 2, "sum")),  # a guess: nearer than the difference
        (3.0, (2, 1, 1, "sum")),  # a guess
        (1.51, (2, 1, 2, "sum")),
        (0.51, (2, 1, 2, "difference")),
    ],
)
def test_names(near: float, expected: tuple[int, int, int, str]) -> None:
    assert name(coupled_mathieu("sum", (1.0, 2.02)), near) == expected


def test_low_order_is_preferred_to_near() -> None:
    # 2 omega_2 / 2 = 1.95 is nearer to 1.96 than 2 omega_1 = 2, but much narrower; asked for exactly it is found
    system = coupled_mathieu("sum", (1.0, 1.95))
    assert name(system, 1.96) == (1, 1, 1, "sum")
    assert name(system, 1.95) == (2, 2, 2, "sum")


def test_sums_are_preferred_to_differences() -> None:
    # 2 omega_1 = omega_2 - omega_1 = 2
    assert name(coupled_mathieu("sum", (1.0, 3.0)), 2.0) == (1, 1, 1, "sum")


def test_solutions_are_two_modes() -> None:
    system = random_system(12, 3, damping=0.1)
    stiff = type(system)(
        system.mass, system.gyroscopic, system.damping, system.stiffness + 3 * np.eye(3), system.cosine
    )
    A = first_order(stiff, 1.0, 0.0, 0.0)
    exponents = np.linalg.eigvals(A)
    exponents = exponents[exponents.imag > 0]
    exponents = exponents[np.argsort(exponents.imag)]
    for near, p, q, conjugate in (
        (exponents[2].imag + exponents[0].imag, 2, 0, True),
        (exponents[1].imag - exponents[0].imag, 1, 0, False),
    ):
        found = nearest(stiff, near)
        assert (found.p - 1, found.q - 1) == (p, q)
        assert found.centre == pytest.approx(near, rel=1e-12)
        modes = natural_modes(stiff, near)
        assert modes.decay(found) == pytest.approx(-exponents[p].real - exponents[q].real, abs=1e-12)
        partner = exponents[q].conj() if conjugate else exponents[q]
        expected = modes.solutions(found) * np.array([exponents[p], partner])
        assert A @ modes.solutions(found) == pytest.approx(expected, abs=1e-11)


def test_gyroscopic_frequencies() -> None:
    # sqrt(k) ± s
    assert nearest(gyroscopic_rotor((4.0, 4.0), 0.5), 4.0).centre == pytest.approx(4.0, rel=1e-14)
    assert nearest(gyroscopic_rotor((4.0, 4.0), 0.5), 3.0).centre == pytest.approx(3.0, rel=1e-14)


def test_overdamped_modes_do_not_resonate() -> None:
    system = type(mathieu())(
        np.eye(2), np.zeros((2, 2)), np.diag([0.0, 10.0]), np.eye(2), sla.hilbert(2)[None]
    )  # the second mode decays without oscillating
    assert nearest(system, 2.0).p == 1


def test_far_from_everything() -> None:
    with pytest.raises(ValueError, match=r"near = 2\.5 is not within 5% of any"):
        nearest(mathieu(), 2.5)


def test_what_is_meant_can_be_said() -> None:
    # 4.015 - 3 lies between the sums 0.5 + 0.5 and 0.5 + 0.52, and next to 0.52 + 1.51 halved
    w = np.array([0.5, 0.52, 1.51, 3.0, 4.015])
    system = PeriodicSystem(np.eye(5), np.zeros((5, 5)), np.zeros((5, 5)), np.diag(w**2), [np.ones((5, 5))])
    assert nearest(system, 1.015).type == "sum"
    found = nearest(system, 1.015, types=("difference",))
    assert (found.p, found.q, found.j) == (5, 4, 1)
    found = nearest(system, 1.015, orders=(2,))
    assert (found.p, found.q, found.type) == (3, 2, "sum")
    trace = trace_boundary(system, 1.015, [0.01], type="difference", j=1)
    assert (trace.resonance.p, trace.resonance.q) == (5, 4)
    assert not trace.is_open.any()  # a symmetric load opens no difference


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"type": "product"}, "type = 'product' is not known"),
        ({"j": 0}, "j = 0 is out of range"),
        ({"type": "difference"}, r"not within 5% of any \(omega_p - omega_q\) / j with j <= 8"),
        ({"j": 3}, r"\(omega_p ± omega_q\) / j with j = 3"),
    ],
)
def test_what_is_meant_has_to_exist(wrong: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        trace_boundary(mathieu(), 2.0, [0.1], **wrong)
