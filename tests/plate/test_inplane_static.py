"""The static in-plane problem: identities of virtual work, independent stresses, frequencies and slopes."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from plate import EdgeLoad, MovingPlate, transverse
from plate.basis import gauss_legendre
from plate.inplane import InPlaneProblem
from tests.plate.plate_oracles import modes

LOADS = {"uniform": EdgeLoad.uniform(), "middle half": EdgeLoad.partial(0.5), "oblique": EdgeLoad.linear(0.2, 1.8)}
CASES = {
    "uniform": "static: B uniform edge load, in-plane v=0",
    "middle half": "static: C middle-half edge load 2f0, in-plane v=0",
}


class Ritz:
    """The static stress of the trial space (6), from which F is made, on Gauss points."""

    def __init__(self, plate: MovingPlate) -> None:
        problem = InPlaneProblem(plate.aspect_ratio, plate.poisson_ratio, *plate.terms.inplane)
        self.rules = gauss_legendre(50, 0.0, plate.aspect_ratio), gauss_legendre(40, 0.0, 1.0)
        (self.X, self.W_X), (self.Y, self.W_Y) = self.rules
        coefficients = problem.static_response(problem.force(plate.load.static))
        self.stresses = plate.tension * problem.stresses(coefficients, self.X, self.Y)

    def integral(self, values: NDArray[np.float64]) -> float:
        return float(self.W_X @ values @ self.W_Y)


@pytest.mark.parametrize("r", [1, 2])
@pytest.mark.parametrize("load", CASES)
def test_frequencies_and_slopes(references: dict[str, Any], load: str, r: int) -> None:
    reference = references[CASES[load]][f"a/b={r} V=3 f0=10"]
    plate = MovingPlate(
        aspect_ratio=r, load=LOADS[load], inplane="static", axial_terms=20, lateral_terms=10, inplane_terms=(15, 15)
    )
    system = plate.at(1.0)
    found = modes(system, plate.elastic_stiffness)
    np.testing.assert_allclose(found.omega[:6], np.array(reference["omega"], float), rtol=2e-5)
    np.testing.assert_allclose(found.decay[:3], np.array(reference["c_p"], float), rtol=2e-5)
    assert plate.critical_speed() == pytest.approx(float(reference["Vcr"]), abs=2e-6)
    for name, slope in reference["sqrtL"].items():
        p, q = map(int, name.split("+"))
        assert found.slope(system, p, q) == pytest.approx(float(slope), rel=1e-3, abs=1e-9)


@pytest.mark.parametrize("load", CASES)
def test_default_terms_are_as_accurate_as_documented(references: dict[str, Any], load: str) -> None:
    # (9, 9) in the plane: 2e-5 in frequency, 2e-3 in slope; both below what 4 x 7 transverse terms cost
    reference = references[CASES[load]]["a/b=1 V=3 f0=10"]
    plate = MovingPlate(load=LOADS[load], inplane="static", axial_terms=12, lateral_terms=11)
    system = plate.at(1.0)
    found = modes(system, plate.elastic_stiffness)
    np.testing.assert_allclose(found.omega[:3], np.array(reference["omega"][:3], float), rtol=3e-5)
    for name, slope in reference["sqrtL"].items():
        p, q = map(int, name.split("+"))
        assert found.slope(system, p, q) == pytest.approx(float(slope), rel=2e-3, abs=1e-9)


@pytest.mark.parametrize("r", ["1", "2"])
def test_in_plane_frequencies(references: dict[str, Any], r: str) -> None:
    # W = omega b sqrt(rho/E) of the references is omega in units of sqrt(12 (1 - nu^2)) b/h
    plate = MovingPlate(aspect_ratio=float(r), speed=0, inplane_terms=(13, 13))
    unit = np.sqrt(12 * (1 - plate.poisson_ratio**2)) / plate.thickness_ratio
    found = plate.inplane_frequencies()
    listed = references["inplane_freq_nu0.3 (omega b sqrt(rho/E))"][r]
    # pure shear u = cos(n pi y): even about the mid-line for even n; n = 0 is the rigid translation, left out
    symmetric = {"sym": True, "anti": False, "shear n=1": False, "shear n=2": True}
    for wanted, frequencies in ((True, found.symmetric), (False, found.antisymmetric)):
        exact = [float(mode["W"]) for mode in listed if symmetric.get(mode["type"]) == wanted]
        np.testing.assert_allclose(frequencies[: len(exact)] / unit, exact, rtol=1e-6)


@pytest.mark.parametrize("load", LOADS.values(), ids=LOADS)
@pytest.mark.parametrize("nu", [-0.4, 0.0, 0.3, 0.5])
def test_virtual_work_of_uniform_strains(load: EdgeLoad, nu: float) -> None:
    # u = X and u = X (Y - 1/2) are in the trial space: internal virtual work equals that of the edge load, exactly.
    plate = MovingPlate(speed=0, aspect_ratio=1.6, poisson_ratio=nu, load=load, inplane="static", inplane_terms=(6, 5))
    ritz = Ritz(plate)
    N_xx, _, N_xy = ritz.stresses
    moments = load.static.projection(2) / [1.0, np.sqrt(12)]
    assert ritz.integral(N_xx) == pytest.approx(plate.tension * 1.6 * moments[0], rel=1e-11)
    work = ritz.integral(N_xx * (ritz.Y - 0.5) + N_xy * ritz.X[:, None])
    assert work == pytest.approx(plate.tension * 1.6 * moments[1], rel=1e-11, abs=1e-10)


@pytest.mark.parametrize("load", LOADS.values(), ids=LOADS)
def test_stiffness_is_the_integral_of_the_stress(load: EdgeLoad) -> None:
    plate = MovingPlate(load=load, aspect_ratio=1.3, inplane="static")
    ritz = Ritz(plate)
    F = transverse.stress_stiffness(
        ritz.stresses, *ritz.rules, plate.terms.axial, plate.terms.lateral, plate.aspect_ratio
    )
    system = plate.at(1.0)
    np.testing.assert_allclose(F, system.cosine[0], atol=1e-11 * np.abs(F).max())
    np.testing.assert_allclose(
        system.cosine[0], plate.tension * plate.static_stress_stiffness, atol=1e-11 * np.abs(F).max()
    )
    assert not system.sine.any()


def test_stress_of_a_symmetric_load_is_symmetric() -> None:
    field = MovingPlate(inplane="static", load=EdgeLoad.partial(0.5)).stress(1.0, 0)
    for N, parity_x, parity_y in ((field.N_xx, 1, 1), (field.N_yy, 1, 1), (field.N_xy, -1, -1)):
        np.testing.assert_allclose(N, parity_x * N[:, ::-1], atol=1e-11)
        np.testing.assert_allclose(N, parity_y * N[::-1], atol=1e-11)


def test_stress_superposes() -> None:
    one, other = EdgeLoad.parabolic(), EdgeLoad.partial(0.4, 0.3)
    both = EdgeLoad.uniform().with_waveform({1: (one, other), 2: (2 * one.static + other.static, 0.0)})
    plate = MovingPlate(inplane="static", load=both)
    first, second = plate.stress(1.0, 1), plate.stress(1.0, 2)
    np.testing.assert_allclose(second.N_yy, 2 * first.N_yy.real - first.N_yy.imag, atol=1e-11)


def test_without_poissons_ratio_a_uniform_load_is_a_membrane() -> None:
    field = MovingPlate(poisson_ratio=0, inplane="static").stress(1.0, 0)
    np.testing.assert_allclose(field.N_xx, 10.0, rtol=1e-12)
    np.testing.assert_allclose(field.N_yy, 0.0, atol=1e-12)
    np.testing.assert_allclose(field.N_xy, 0.0, atol=1e-12)


def test_without_poissons_ratio_a_linear_load_tends_to_a_membrane() -> None:
    # The exact solution is u = (X - r/2) f, v = (r X - X^2) f'/2, N_xx = f. The sines of that parabola fall like k^-3,
    # so that the energy of the error falls like M^-3.
    terms, energies = np.array([8, 16, 32, 48]), []
    for M in terms:
        plate = MovingPlate(poisson_ratio=0, load=LOADS["oblique"], inplane="static", inplane_terms=(int(M), 3))
        ritz = Ritz(plate)
        N_xx, N_yy, N_xy = ritz.stresses
        error = N_xx - 10 * LOADS["oblique"].static(ritz.Y)
        energies.append(ritz.integral(error**2 + N_yy**2 + 2 * N_xy**2))
    assert np.polyfit(np.log(terms), np.log(energies), 1)[0] == pytest.approx(-3, abs=0.05)  # found: -2.98


def test_without_poissons_ratio_other_loads_are_no_membranes() -> None:
    # compatibility, (N_xx + N_yy) harmonic, needs f'' = 0: Saint-Venant's principle spreads any other load
    for load in (EdgeLoad.parabolic(), EdgeLoad.partial(0.5)):
        membrane, static = (
            MovingPlate(poisson_ratio=0, load=load, inplane=m).at(1.0).cosine for m in ("membrane", "static")
        )
        assert np.abs(static - membrane).max() > 0.1 * np.abs(membrane).max()


def test_membrane_stress_is_the_load() -> None:
    load = EdgeLoad.partial(0.4, 0.3).with_waveform({1: (EdgeLoad.parabolic(), 0.5)})
    plate = MovingPlate(load=load)
    static, first = plate.stress(1.0, 0), plate.stress(1.0, 1)
    np.testing.assert_array_equal(static.N_xx, np.tile(10 * load.static(static.y)[:, None], 41))
    np.testing.assert_array_equal(
        first.N_xx[:, 0], 10 * (EdgeLoad.parabolic().static(first.y) - 0.5j * load.static(first.y))
    )
    for field in (static, first):
        assert not field.N_yy.any()
        assert not field.N_xy.any()


def test_shape_of_a_stress_field() -> None:
    field = MovingPlate(aspect_ratio=2).stress(1.0, 0)
    assert field.x.shape == field.y.shape == (41,)
    assert (field.x[-1], field.y[-1]) == (2.0, 1.0)
    field = MovingPlate(inplane="static").stress(1.0, 0, [0.1, 0.2, 0.3], [0.5, 1.0])
    assert field.N_xx.shape == field.N_yy.shape == field.N_xy.shape == (2, 3)
    assert not field.N_xx.flags.writeable
    for inplane in ("membrane", "static"):  # rounding beyond the end of the plate is its end
        field = MovingPlate(inplane=inplane).stress(1.0, 0, [1 + 1e-13], [1 + 1e-13])
        assert field.x == field.y == 1.0


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((1.0, 2), "harmonic = 2"),
        ((1.0, -1), "harmonic = -1"),
        ((1.0, 1.0), "harmonic = 1.0"),
        ((1.0, 0, [-0.1]), "x runs from -0.1"),
        ((1.0, 0, [0.0, 1.5]), "x runs from 0 to 1.5"),
        ((1.0, 0, [0.5, 0.2]), "x is not strictly increasing"),
        ((1.0, 0, []), "x is empty"),
        ((1.0, 0, None, [np.nan]), "y has the entry nan"),
        ((1.0, 0, None, [2.0]), "y runs from"),
        ((1.0, 0, "x"), "x has entries"),
    ],
)
def test_bad_grids_are_refused(arguments: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        MovingPlate(inplane="static").stress(*arguments)
