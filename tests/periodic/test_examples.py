"""Example systems: bad arguments, and the known answers their docstrings promise, by DOP853 and exact flows."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.special import mathieu_a, mathieu_b

from periodic import PeriodicSystem
from periodic.examples import blade_flap, coupled_mathieu, gyroscopic_rotor, mathieu, meissner, quadrupole_trap


def multipliers(system: PeriodicSystem, Omega: float, eps: float) -> np.ndarray:
    """Floquet multipliers of ``system`` by SciPy's DOP853."""
    n, harmonics = system.size, np.arange(1, system.harmonics + 1)
    inverse = np.linalg.inv(system.mass)

    def right_hand_side(t: float, flat: np.ndarray) -> np.ndarray:
        phase = harmonics * Omega * t
        F = np.tensordot(np.cos(phase), system.cosine, 1) + np.tensordot(np.sin(phase), system.sine, 1)
        w, v = flat.reshape(2, n, 2 * n)
        force = (system.gyroscopic + system.damping) @ v + (system.stiffness + eps * F) @ w
        return np.concatenate([v, -inverse @ force]).ravel()

    T = 2.0 * np.pi / Omega
    end = solve_ivp(right_hand_side, (0.0, T), np.eye(2 * n).ravel(), "DOP853", rtol=1e-12, atol=1e-13).y[:, -1]
    return np.linalg.eigvals(end.reshape(2 * n, 2 * n))


@pytest.mark.parametrize(
    ("example", "argument", "value"),
    [
        (mathieu, "delta", np.nan),
        (mathieu, "delta", "1"),
        (mathieu, "damping", -0.1),
        (quadrupole_trap, "a", "0.2"),
        (blade_flap, "gamma", -1.0),
        (blade_flap, "p", 0.0),
        (coupled_mathieu, "type", "product"),
        (coupled_mathieu, "frequencies", [1.0]),
        (coupled_mathieu, "frequencies", [1.0, 0.0]),
        (coupled_mathieu, "frequencies", [1.0, np.inf]),
        (coupled_mathieu, "frequencies", 1.0),
        (coupled_mathieu, "coupling", 1j),
        (coupled_mathieu, "damping", [0.1, -0.1]),
        (coupled_mathieu, "damping", [[0.1, 0.1]]),
        (gyroscopic_rotor, "stiffness", [4.0, -4.0]),
        (gyroscopic_rotor, "stiffness", "44"),
        (gyroscopic_rotor, "spin", np.inf),
        (gyroscopic_rotor, "damping", -1.0),
        (meissner, "delta", None),
        (meissner, "damping", -1.0),
        (meissner, "harmonics", 0),
        (meissner, "harmonics", 3.0),
        (meissner, "harmonics", True),
        (meissner, "harmonics", 10**12),
    ],
)
def test_bad_arguments_are_named(example: Any, argument: str, value: Any) -> None:
    with pytest.raises(ValueError, match=rf"^{argument}"):
        example(**{argument: value})


@pytest.mark.parametrize("n", [1, 2, 3])
@pytest.mark.parametrize("q", [0.5, 2.0])
def test_mathieu_boundaries_are_the_characteristic_values(n: int, q: float) -> None:
    """On a = a_n(q), b_n(q) there is a periodic solution: a double multiplier (-1)^n (DLMF 28.2(iv))."""
    for a in (mathieu_a(n, q), mathieu_b(n, q)):
        mu = multipliers(mathieu(delta=float(a)), Omega=2.0, eps=2.0 * q)  # a = 4 delta / Omega^2, q = 2 eps / Omega^2
        # The trace is exact to about 1e-11; the two multipliers themselves only to its square root.
        assert mu.sum().real == pytest.approx(2.0 * (-1.0) ** n, abs=1e-9)


def test_damping_scales_the_multipliers_of_mathieu() -> None:
    d, delta, Omega, eps = 0.3, 1.3, 2.1, 0.8
    plain = multipliers(mathieu(delta - d**2 / 4), Omega, eps)
    damped = multipliers(mathieu(delta, damping=d), Omega, eps)
    np.testing.assert_allclose(np.sort(damped), np.sort(plain) * np.exp(-d * np.pi / Omega), rtol=1e-9)


@pytest.mark.parametrize("eps", [0.3, 1.5])
def test_coupled_mathieu_with_equal_frequencies_is_two_mathieu_equations(eps: float) -> None:
    coupled = multipliers(coupled_mathieu("sum", frequencies=(1.2, 1.2), damping=(0.1, 0.1)), 2.3, eps)
    alone = [multipliers(mathieu(1.44, damping=0.1), 2.3, sign * eps) for sign in (1, -1)]
    np.testing.assert_allclose(
        np.sort_complex(np.round(coupled, 9)), np.sort_complex(np.round(np.concatenate(alone), 9)), atol=2e-9
    )


def test_coupled_mathieu_opens_the_region_of_its_kind() -> None:
    at_sum = multipliers(coupled_mathieu("sum"), 2.7, 0.2), multipliers(coupled_mathieu("difference"), 2.7, 0.2)
    at_difference = multipliers(coupled_mathieu("difference"), 0.7, 0.2), multipliers(coupled_mathieu("sum"), 0.7, 0.2)
    for unstable, stable in (at_sum, at_difference):
        assert np.abs(unstable).max() > 1.05
        assert np.abs(stable).max() == pytest.approx(1.0, abs=1e-9)


@pytest.mark.parametrize("Omega", [4.0, 1.7])
def test_round_rotor_is_mathieu_in_fixed_axes(Omega: float) -> None:
    k, spin, eps = 4.0, 0.7, 1.1
    rotor = multipliers(gyroscopic_rotor((k, k), spin), Omega, eps)
    fixed = multipliers(mathieu(k), Omega, eps)
    turned = [mu * np.exp(sign * 2j * np.pi * spin / Omega) for mu in fixed for sign in (1, -1)]
    np.testing.assert_allclose(np.sort_complex(np.round(rotor, 9)), np.sort_complex(np.round(turned, 9)), atol=2e-9)


def test_rotor_frequencies() -> None:
    (k1, k2), s = (4.0, 9.0), 1.1
    squares = np.roots([1.0, -(k1 + k2 + 2 * s**2), (k1 - s**2) * (k2 - s**2)])
    mu = multipliers(gyroscopic_rotor((k1, k2), s), Omega=20.0, eps=0.0)
    np.testing.assert_allclose(
        np.sort(np.abs(np.angle(mu)))[::2] * 20.0 / (2 * np.pi), np.sqrt(np.sort(squares)), rtol=1e-9
    )


def meissner_trace(delta: float, eps: float, Omega: float) -> float:
    """Discriminant in closed form (docstring of `meissner`)."""
    u, v = (np.pi * np.sqrt(complex(delta + sign * eps)) / Omega for sign in (1, -1))
    return float((2 * np.cos(u) * np.cos(v) - (u / v + v / u) * np.sin(u) * np.sin(v)).real)


@pytest.mark.parametrize(("delta", "eps", "Omega"), [(1.0, 0.4, 1.9), (0.3, 1.5, 1.3)])
def test_meissner_converges_to_the_square_wave(delta: float, eps: float, Omega: float) -> None:
    """Harmonics left out act from second order on: the error falls as sum over j > J of 1/j^4, J^-3."""
    J = np.array([5, 9, 17])
    error = [
        abs(multipliers(meissner(delta, harmonics=j), Omega, eps).sum() - meissner_trace(delta, eps, Omega)) for j in J
    ]
    order = -np.polyfit(np.log(J + 1.0), np.log(error), 1)[0]
    assert 2.8 < order < 3.3
