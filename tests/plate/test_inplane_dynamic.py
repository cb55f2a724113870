"""In-plane inertia: an exact wave solution, eq. (8) by brute force, limits, and the checked reduction."""

from __future__ import annotations

import warnings
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.polynomial import Legendre
from numpy.typing import NDArray

from periodic.checks import ComplexArray
from plate import EdgeLoad, InPlaneGrowthWarning, InPlaneResonanceWarning, MovingPlate, StressField, transverse
from plate.basis import gauss_legendre
from plate.inplane import InPlaneProblem

OBLIQUE = EdgeLoad.linear(0.5, 1.5).with_waveform({1: (1.0, 0.4), 2: (EdgeLoad.partial(0.4, 0.3), 0.2)})


@pytest.mark.parametrize("Omega", [20.0, 90.0, 150.0])
@pytest.mark.parametrize("damping", [0.0, 1e-3])
@pytest.mark.parametrize("r", [0.7, 1.0])
def test_travelling_waves_without_poissons_ratio(Omega: float, damping: float, r: float) -> None:
    # nu = 0 and a uniform load: u(X, t) alone, two waves between the edges where N_xx = f (theory of the bar that moves
    # through its supports); damping makes C^2 complex.
    plate = MovingPlate(
        aspect_ratio=r, poisson_ratio=0, thickness_ratio=0.05, damping=damping, inplane="dynamic", inplane_terms=(15, 3)
    )
    C, V, f = np.sqrt(12 / 0.05**2 * (1 + 1j * Omega * damping)), plate.speed, plate.tension
    k1, k2 = Omega / (C - V), Omega / (C + V)
    A = f * (1 - np.exp(-1j * k2 * r)) / (np.exp(1j * k1 * r) - np.exp(-1j * k2 * r))
    field = plate.stress(Omega, 1)
    exact = A * np.exp(1j * k1 * field.x) + (f - A) * np.exp(-1j * k2 * field.x)
    np.testing.assert_allclose(field.N_xx, np.tile(exact, (41, 1)), atol=1e-8 * f)
    np.testing.assert_allclose(field.N_yy, 0.0, atol=1e-8 * f)
    np.testing.assert_allclose(field.N_xy, 0.0, atol=1e-8 * f)


def brute_force(plate: MovingPlate, w: float, f_c: Any, f_s: Any, X: Any, Y: Any) -> ComplexArray:
    """Stresses at w from the weak form of (2a, b) by quadrature, rigid translation and both symmetries included."""
    r, nu, V, c, beta = (
        plate.aspect_ratio,
        plate.poisson_ratio,
        plate.speed,
        plate.damping,
        12 / plate.thickness_ratio**2,
    )
    M, N = plate.terms.inplane

    def functions(x: NDArray[np.float64], y: NDArray[np.float64], order: tuple[int, int], kind: str) -> Any:
        across = np.array([Legendre.basis(n, domain=[0, 1]).deriv(order[1])(y) for n in range(N)])
        k = np.pi / r * np.arange(1, M + 1)[:, None]
        sine = [np.sin(k * x), k * np.cos(k * x), -(k**2) * np.sin(k * x)][order[0]]
        polynomial = np.array([Legendre.basis(m, domain=[0, r]).deriv(order[0])(x) for m in range(M)])
        return np.einsum("mx,ny->mnxy", polynomial if kind == "u" else sine, across).reshape(M * N, -1)

    (x, W_x), (y, W_y) = gauss_legendre(60, 0.0, r), gauss_legendre(30, 0.0, 1.0)
    W = np.outer(W_x, W_y).ravel()
    u, u_X, u_XX, u_Y = (functions(x, y, order, "u") for order in ((0, 0), (1, 0), (2, 0), (0, 1)))
    v, v_X, v_XX, v_Y = (functions(x, y, order, "v") for order in ((0, 0), (1, 0), (2, 0), (0, 1)))

    def inner(test: Any, trial: Any) -> Any:
        return (test * W) @ trial.T

    shear = (1 - nu) / 2
    K_uu, K_vv = inner(u_X, u_X) + shear * inner(u_Y, u_Y), inner(v_Y, v_Y) + shear * inner(v_X, v_X)
    K_uv = nu * inner(u_X, v_Y) + shear * inner(u_Y, v_X)
    K = beta * np.block([[K_uu, K_uv], [K_uv.T, K_vv]])
    inertia_u = -(w**2) * inner(u, u) + 2j * w * V * inner(u, u_X) + V**2 * inner(u, u_XX)
    inertia_v = -(w**2) * inner(v, v) + 2j * w * V * inner(v, v_X) + V**2 * inner(v, v_XX)
    A = (1 + 1j * w * c) * K
    A[: M * N, : M * N] += inertia_u
    A[M * N :, M * N :] += inertia_v
    # f [phi(r, Y) - phi(0, Y)], by a rule that is exact between the jumps of these loads at 0.1 and 0.5
    force = np.zeros(2 * M * N, dtype=complex)
    for start, end in ((0.0, 0.1), (0.1, 0.5), (0.5, 1.0)):
        nodes, weights = gauss_legendre(20, start, end)
        load = weights * (f_c(nodes) - 1j * f_s(nodes))
        right, left = (functions(np.array([edge]), nodes, (0, 0), "u") for edge in (r, 0.0))
        force[: M * N] += (right - left) @ load
    U = np.linalg.solve(A, force)
    a, b = U[: M * N], U[M * N :]
    u_X, u_Y = (a @ functions(X, Y, order, "u") for order in ((1, 0), (0, 1)))
    v_X, v_Y = (b @ functions(X, Y, order, "v") for order in ((1, 0), (0, 1)))
    strains = np.array([u_X + nu * v_Y, v_Y + nu * u_X, shear * (u_Y + v_X)])
    return plate.tension * beta * (1 + 1j * w * c) * strains.reshape(3, X.size, Y.size)


@pytest.mark.parametrize(
    "parameters",
    [
        {"thickness_ratio": 0.05, "damping": 1e-4},
        {"thickness_ratio": 0.01, "damping": 0.0},
        {"thickness_ratio": 0.1, "damping": 1e-3, "aspect_ratio": 1.7, "speed": -2.5, "poisson_ratio": -0.2},
    ],
)
def test_every_harmonic_against_brute_force(parameters: dict[str, float]) -> None:
    plate = MovingPlate(**parameters, load=OBLIQUE, inplane="dynamic", inplane_terms=(7, 6))
    at_rest = replace(plate, speed=0.0)
    X, Y = np.linspace(0, plate.aspect_ratio, 5), np.linspace(0, 1, 4)
    system = plate.at(37.0)
    rules = gauss_legendre(50, 0.0, plate.aspect_ratio), gauss_legendre(40, 0.0, 1.0)
    for j in (1, 2):
        # F, all of it
        exact = brute_force(plate, j * 37.0, *OBLIQUE.harmonic(j), rules[0][0], rules[1][0])
        F = transverse.stress_stiffness(exact, *rules, plate.terms.axial, plate.terms.lateral, plate.aspect_ratio)
        found = system.cosine[j - 1] - 1j * system.sine[j - 1]
        np.testing.assert_allclose(found, F, atol=1e-9 * np.abs(F).max())
        # of the stress, what inertia adds
        exact = brute_force(plate, j * 37.0, *OBLIQUE.harmonic(j), X, Y)
        inertial = exact - brute_force(at_rest, 1e-4, *OBLIQUE.harmonic(j), X, Y)  # at w = 0 it is singular
        found = values(plate.stress(37.0, j, X, Y)) - values(replace(plate, inplane="static").stress(37.0, j, X, Y))
        np.testing.assert_allclose(found, inertial, atol=1e-9 * np.abs(exact).max())


def values(field: StressField) -> ComplexArray:
    return np.array([field.N_xx.T, field.N_yy.T, field.N_xy.T])


def from_full_solution(plate: MovingPlate, Omega: float, j: int) -> ComplexArray:
    """F_cj - i F_sj (times f0) from the full system, integrated on another grid."""
    rules = gauss_legendre(50, 0.0, plate.aspect_ratio), gauss_legendre(40, 0.0, 1.0)
    problem = InPlaneProblem(plate.aspect_ratio, plate.poisson_ratio, *plate.terms.inplane)
    f_c, f_s = plate.load.harmonic(j)
    w, C = j * Omega, np.sqrt(12) / plate.thickness_ratio
    response = problem.response(problem.force(f_c) - 1j * problem.force(f_s), w / C, plate.speed / C, w * plate.damping)
    stresses = plate.tension * problem.stresses(response, rules[0][0], rules[1][0])
    return transverse.stress_stiffness(stresses, *rules, plate.terms.axial, plate.terms.lateral, plate.aspect_ratio)


@pytest.mark.filterwarnings("ignore::plate.InPlaneGrowthWarning")
@pytest.mark.filterwarnings("ignore::plate.InPlaneResonanceWarning")
@pytest.mark.parametrize("thickness_ratio", [0.01, 0.05, 0.2])
@pytest.mark.parametrize("damping", [0.0, 1e-4])
@pytest.mark.parametrize("inplane_terms", [(5, 4), (9, 9)])
def test_reduction_agrees_with_the_full_solution(thickness_ratio: float, damping: float, inplane_terms: Any) -> None:
    plate = MovingPlate(
        thickness_ratio=thickness_ratio, damping=damping, load=OBLIQUE, inplane="dynamic", inplane_terms=inplane_terms
    )
    for Omega in np.linspace(0.0, 200.0, 9):
        system = plate.at(float(Omega))
        for j in (1, 2):
            F = from_full_solution(plate, float(Omega), j)
            found = system.cosine[j - 1] - 1j * system.sine[j - 1]
            np.testing.assert_allclose(found, F, atol=1e-9 * np.abs(F).max())


def test_reduction_serves_a_chart_of_a_thin_plate(monkeypatch: pytest.MonkeyPatch) -> None:
    # On the standard plate no frequency of a chart needs the full system: refuse to solve it after the basis is made.
    plate_ = MovingPlate(inplane="dynamic", load=OBLIQUE)
    plate_.at(1.0)
    monkeypatch.setattr("plate.inplane.InPlaneSubsystem.solve", None)
    for Omega in np.linspace(1, 120, 40):
        plate_.at(float(Omega))


@pytest.mark.filterwarnings("ignore::plate.InPlaneGrowthWarning")
@pytest.mark.filterwarnings("ignore::plate.InPlaneResonanceWarning")
def test_answers_do_not_depend_on_earlier_questions() -> None:
    def make() -> MovingPlate:
        return MovingPlate(inplane="dynamic", load=OBLIQUE, thickness_ratio=0.1)

    frequencies = np.linspace(5, 150, 7)
    one, other = make(), make()
    forward = [one.at(float(Omega)).cosine for Omega in frequencies]
    backward = [other.at(float(Omega)).cosine for Omega in frequencies[::-1]][::-1]
    np.testing.assert_array_equal(forward, backward)


def test_inertia_is_of_second_order_in_the_thickness() -> None:
    load = EdgeLoad.partial(0.5)
    static = MovingPlate(inplane="static", load=load).at(30.0)
    ratios = np.array([0.04, 0.02, 0.01, 0.005])
    X, Y = np.linspace(0, 1, 7), np.linspace(0, 1, 8)
    static_stress = values(MovingPlate(inplane="static", load=load).stress(30.0, 1, X, Y))
    excitation, stiffness, stress = [], [], []
    for ratio in ratios:
        plate = MovingPlate(inplane="dynamic", load=load, thickness_ratio=ratio)
        dynamic = plate.at(30.0)
        excitation.append(np.abs(dynamic.cosine - 1j * dynamic.sine - static.cosine).max())
        stiffness.append(np.abs(dynamic.stiffness - static.stiffness).max())
        stress.append(np.abs(values(plate.stress(30.0, 1, X, Y)) - static_stress).max())
    for differences in (excitation, stiffness, stress):
        assert np.polyfit(np.log(ratios), np.log(differences), 1)[0] == pytest.approx(2, abs=0.05)


@pytest.mark.filterwarnings("ignore::plate.InPlaneGrowthWarning")
def test_slow_excitation_is_quasi_static() -> None:
    # j Omega -> 0: the excitation becomes the static stress of eq. (8), V^2 K_ig included.
    plate_ = MovingPlate(inplane="dynamic", thickness_ratio=0.1, load=EdgeLoad.parabolic())
    quasi = plate_.tension * plate_.static_stress_stiffness
    np.testing.assert_allclose(plate_.at(0.0).cosine[0], quasi, atol=1e-9 * np.abs(quasi).max())
    differences = [np.abs(plate_.at(Omega).cosine[0] - quasi).max() for Omega in (0.5, 1.0, 2.0)]
    np.testing.assert_allclose(np.diff(np.log2(differences)), 2.0, atol=0.01)


@pytest.mark.filterwarnings("ignore::plate.InPlaneGrowthWarning")
def test_static_transport_term_changes_the_divergence_speed() -> None:
    # F_c0 at V_cr, not at the plate's own speed, decides: both plates have one V_cr, at which K_o is singular.
    slow, fast = (MovingPlate(speed=V, inplane="dynamic", thickness_ratio=0.2) for V in (0.0, 4.0))
    critical = slow.critical_speed()
    assert critical == fast.critical_speed()
    assert np.abs(slow.static_stress_stiffness - fast.static_stress_stiffness).max() > 1e-3
    at_critical = MovingPlate(speed=critical * (1 - 1e-9), inplane="dynamic", thickness_ratio=0.2)
    assert abs(np.linalg.eigvalsh(at_critical.at(1.0).stiffness)[0]) < 1e-5


@pytest.mark.filterwarnings("ignore::plate.InPlaneGrowthWarning")
@pytest.mark.filterwarnings("ignore:harmonic 1 of the excitation comes near:plate.InPlaneResonanceWarning")
@pytest.mark.parametrize(
    ("r", "tension", "thickness", "nu"), [(0.10798, 54.98, 0.09208, -0.3363), (0.21156, 3220.7, 0.051076, 0.2871)]
)
def test_the_lowest_speed_at_which_a_thick_plate_diverges(
    r: float, tension: float, thickness: float, nu: float
) -> None:
    common: dict[str, Any] = {"poisson_ratio": nu, "inplane": "dynamic", "thickness_ratio": thickness}
    resting = MovingPlate(aspect_ratio=r, tension=tension, speed=0.0, axial_terms=6, lateral_terms=8, **common)
    critical = resting.critical_speed()
    lowest = [
        np.linalg.eigvalsh(replace(resting, speed=part * critical).at(0.0).stiffness)[0]
        for part in (*np.linspace(0.0, 0.99, 12), 1 - 1e-6)
    ]
    assert min(lowest) > 0
    assert lowest[-1] < 1e-2 * lowest[-2]


def test_a_plate_that_diverges_in_its_own_plane_first_is_refused() -> None:
    # without tension across it would diverge at 0.57 C, but in its plane it does so at 0.475 C
    with pytest.raises(ValueError, match=r"diverges in its own plane first, at speed 40\.6"):
        MovingPlate(
            aspect_ratio=1.0966,
            tension=2512.0,
            thickness_ratio=0.040493,
            poisson_ratio=0.0625,
            speed=0.0,
            axial_terms=6,
            lateral_terms=8,
            inplane="dynamic",
            inplane_terms=(17, 9),
        )


def test_each_harmonic_has_its_own_frequency_and_phase() -> None:
    one = MovingPlate(inplane="dynamic", thickness_ratio=0.05, load=EdgeLoad.uniform().with_waveform({2: (0.0, 1.0)}))
    other = MovingPlate(inplane="dynamic", thickness_ratio=0.05)
    second, first = one.at(20.0), other.at(40.0)
    # sin(2 Omega t) = Re[-i e^{2 i Omega t}]
    F = -1j * (first.cosine[0] - 1j * first.sine[0])
    np.testing.assert_allclose(second.cosine[1], F.real, atol=1e-9 * np.abs(F).max())
    np.testing.assert_allclose(second.sine[1], -F.imag, atol=1e-9 * np.abs(F).max())
    assert not second.cosine[0].any()


def test_stresses_are_symmetric_matrices() -> None:
    system = MovingPlate(inplane="dynamic", load=OBLIQUE, thickness_ratio=0.1, damping=1e-3).at(33.0)
    for F in (*system.cosine, *system.sine):
        np.testing.assert_array_equal(F, F.T)
        assert F.any()


@pytest.mark.parametrize("harmonic", [1, 3])
def test_resonances_are_announced(harmonic: int) -> None:
    plate_ = MovingPlate(
        inplane="dynamic", thickness_ratio=0.05, load=EdgeLoad.uniform().with_waveform({harmonic: (1.0, 0.0)})
    )
    resonance = plate_.inplane_frequencies().symmetric[0]
    for share in (0.97, 1.0, 1.03):
        with pytest.warns(InPlaneResonanceWarning, match=f"harmonic {harmonic} .* {resonance:.6g}") as caught:
            plate_.at(share * resonance / harmonic)
        assert caught[0].filename == __file__
    plate_.at(0.8 * resonance / harmonic)  # warnings are errors here


def test_resonances_that_are_not_excited_are_not_announced() -> None:
    plate_ = MovingPlate(inplane="dynamic", thickness_ratio=0.05)
    plate_.at(plate_.inplane_frequencies().antisymmetric[0])
    with pytest.warns(InPlaneResonanceWarning):
        MovingPlate(inplane="dynamic", thickness_ratio=0.05, load=EdgeLoad.linear(0, 2)).at(
            plate_.inplane_frequencies().antisymmetric[0] * 1.01
        )


def test_damping_removes_resonances() -> None:
    plate_ = MovingPlate(inplane="dynamic", thickness_ratio=0.05, damping=5e-3)
    plate_.at(plate_.inplane_frequencies().symmetric[0])


def test_a_resonance_is_announced_once_for_a_chart() -> None:
    plate_ = MovingPlate(inplane="dynamic", thickness_ratio=0.05)
    resonance = plate_.inplane_frequencies().symmetric[0]
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("default")
        for share in np.linspace(0.96, 1.04, 20):
            plate_.at(share * resonance)
    assert len(caught) == 1


@pytest.mark.parametrize("speed", [0.0, 6.0, 20.0])
def test_in_plane_frequencies_of_a_moving_bar(speed: float) -> None:
    # nu = 0, u(X, t) alone with u_X = 0 at both ends: waves of speed C - V and C + V, w_n = n pi (C^2 - V^2) / (C r).
    plate = MovingPlate(
        aspect_ratio=1.3, speed=speed, tension=500.0, poisson_ratio=0, thickness_ratio=0.05, inplane_terms=(17, 1)
    )
    C = np.sqrt(12) / 0.05
    exact = np.arange(1, 4) * np.pi * (C**2 - speed**2) / (C * 1.3)
    found = plate.inplane_frequencies()
    bars = [found.symmetric[np.argmin(np.abs(found.symmetric - w))] for w in exact]
    np.testing.assert_allclose(bars, exact, rtol=1e-6)


def test_the_full_equation_resonates_at_the_frequencies_of_the_moving_plate() -> None:
    # By brute force, from the weak form: the response peaks at the frequency of the moving plate, not at that at rest.
    plate = MovingPlate(speed=20.0, tension=600.0, thickness_ratio=0.05, inplane_terms=(7, 6))
    X, Y = np.array([0.3]), np.array([0.2])
    lowest = plate.inplane_frequencies().symmetric[0]
    at_rest = replace(plate, speed=0.0).inplane_frequencies().symmetric[0]
    assert lowest < 0.95 * at_rest
    peak, beside = (
        np.abs(brute_force(plate, w, *plate.load.harmonic(1), X, Y)).max() for w in (lowest * (1 + 1e-7), at_rest)
    )
    assert peak > 1e4 * beside


def test_in_plane_modes_that_grow_are_said() -> None:
    # V/C = 0.3: the plate does not diverge in its own plane, but the highest modes grow.
    thick: dict[str, Any] = {"speed": 20.785, "tension": 800.0, "thickness_ratio": 0.05, "inplane": "dynamic"}
    with pytest.warns(InPlaneGrowthWarning, match=r"speed = 20.785, 0.3 of the in-plane wave speed"):
        MovingPlate(**thick)
    MovingPlate(inplane="dynamic")  # warnings are errors here
    growth = [InPlaneProblem(1.0, 0.3, M, 9).growth(0.3, 0.0).real for M in (9, 13)]
    assert 1 < growth[0] < growth[1]
    assert InPlaneProblem(1.0, 0.3, 9, 9).growth(0.3, 1.0) == 0  # strong damping stops it
