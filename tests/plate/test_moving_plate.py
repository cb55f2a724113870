"""The membrane plate against exact solutions and independent numbers; symmetries; limits; SI units."""

from __future__ import annotations

import pickle
from dataclasses import FrozenInstanceError, replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.linalg import eigh

from plate import EdgeLoad, MovingPlate
from tests.plate.plate_oracles import modes


def case(key: str) -> dict[str, float]:
    """Parameters of a key of references.json such as "a/b=1 V=3 f0=10"."""
    names = {"a/b": "aspect_ratio", "V": "speed", "f0": "tension"}
    return {names[name]: float(value) for name, value in (pair.split("=") for pair in key.split())}


@pytest.mark.parametrize("r", ["1", "2"])
@pytest.mark.parametrize("f0", ["0", "10"])
def test_frequencies_at_rest_are_levys(references: dict[str, Any], r: str, f0: str) -> None:
    # Lévy's exact solution, SFSF; 15 lateral terms converge spectrally, the axial sines are exact.
    plate = MovingPlate(aspect_ratio=float(r), speed=0, tension=float(f0), axial_terms=3, lateral_terms=15)
    omega = np.sqrt(eigh(plate.at(1.0).stiffness, eigvals_only=True))
    exact = [float(mode["omega"]) for mode in references["levy_sfsf_nu0.3"][r][f0]]
    np.testing.assert_allclose(omega[: len(exact)], exact, rtol=1e-9)


@pytest.mark.parametrize("r", ["1", "2"])
@pytest.mark.parametrize("f0", ["0", "10"])
def test_divergence_speed_is_exact(references: dict[str, Any], r: str, f0: str) -> None:
    plate = MovingPlate(aspect_ratio=float(r), speed=0, tension=float(f0), lateral_terms=11)
    assert plate.critical_speed() == pytest.approx(float(references["critical_speed_uniform"][r][f0]), rel=1e-11)


@pytest.mark.parametrize("r", [0.3, 1.0, 20.0, 500.0])
def test_divergence_speed_of_limits(r: float) -> None:
    # nu = 0: a beam, V_cr^2 = f0 + (pi/r)^2. Long: anticlastic bending, V_cr = sqrt(1 - nu^2) pi/r at f0 = 0.
    beam = MovingPlate(aspect_ratio=r, speed=0, tension=7.0, poisson_ratio=0)
    assert beam.critical_speed() == pytest.approx(np.sqrt(7 + (np.pi / r) ** 2), rel=1e-13)
    plate = MovingPlate(aspect_ratio=r, speed=0, tension=0)
    if r >= 20:
        assert plate.critical_speed() == pytest.approx(np.sqrt(1 - 0.3**2) * np.pi / r, rel=1 / r**2)


@pytest.mark.parametrize("key", ["a/b=1 V=3 f0=10", "a/b=1 V=5 f0=50", "a/b=2 V=2 f0=10"])
def test_moving_plate(references: dict[str, Any], key: str) -> None:
    reference = references["moving_plate_membrane"][key]
    plate = MovingPlate(**case(key), axial_terms=24, lateral_terms=12)
    found = modes(plate.at(1.0), plate.elastic_stiffness)
    # the sines converge algebraically: 3e-8 at 24 terms, more for high modes and for energies
    np.testing.assert_allclose(found.omega[:6], np.array(reference["omega"], float), rtol=1e-6)
    np.testing.assert_allclose(found.decay[:3], np.array(reference["c_p"], float), rtol=2e-6)


@pytest.mark.parametrize("key", ["a/b=1 V=1 f0=0", "a/b=1 V=3 f0=10", "a/b=2 V=2 f0=10"])
def test_moving_beam(references: dict[str, Any], key: str) -> None:
    plate = MovingPlate(**case(key), poisson_ratio=0, axial_terms=40, lateral_terms=1)
    found = modes(plate.at(1.0), plate.elastic_stiffness).omega[:4]
    np.testing.assert_allclose(found, np.array(references["moving_beam_nu0"][key], float), rtol=2e-7)


def test_convergence_in_axial_terms_is_of_order_five(references: dict[str, Any]) -> None:
    # At the supports w_XXXX = -2 V w_Xt is not zero, so that the coefficients of sin(k pi X/r) fall like k^-5, and the
    # energies left out sum to K^-5. Mode 1 meets only even k there: that sum, from K + 2 by 2, is centred on K + 1.
    exact = float(references["moving_beam_nu0"]["a/b=1 V=3 f0=10"][0])
    terms = np.array([8, 16, 32, 64])
    errors = []
    for K in terms:
        plate = MovingPlate(poisson_ratio=0, axial_terms=int(K), lateral_terms=1)
        errors.append(modes(plate.at(1.0), plate.elastic_stiffness).omega[0] / exact - 1)
    order = np.polyfit(np.log(terms + 1), np.log(errors), 1)[0]
    assert order == pytest.approx(-5, abs=0.03)  # found: -5.00


@pytest.mark.parametrize("key", ["a/b=1 V=3 f0=10", "a/b=2 V=2 f0=10"])
def test_first_order_slopes(references: dict[str, Any], key: str) -> None:
    plate = MovingPlate(**case(key), axial_terms=16, lateral_terms=11)
    system = plate.at(1.0)
    found = modes(system, plate.elastic_stiffness)
    for name, reference in references["first_order_membrane"][key].items():
        p, q = map(int, name.split("+"))
        assert found.slope(system, p, q) == pytest.approx(float(reference["sqrtL"]), rel=1e-4, abs=1e-9)


def test_defaults_are_as_accurate_as_documented(references: dict[str, Any]) -> None:
    plate = MovingPlate()
    exact = np.array(references["moving_plate_membrane"]["a/b=1 V=3 f0=10"]["omega"], float)
    np.testing.assert_allclose(modes(plate.at(1.0), plate.elastic_stiffness).omega[:3], exact[:3], rtol=2e-4)


def test_string_limit_of_the_slopes(references: dict[str, Any]) -> None:
    # Large tension at v = V / sqrt(f0): sqrt(L) / sqrt(f0) tends to the string's figures. What is left of 1e-3 is
    # bending, O(1 / sqrt(f0)), and the slow convergence of a string's sines.
    f0 = 1e6
    for v in ("0.3", "0.5"):
        plate = MovingPlate(speed=float(v) * np.sqrt(f0), tension=f0, poisson_ratio=0, axial_terms=50, lateral_terms=1)
        system = plate.at(1.0)
        found = modes(system, plate.elastic_stiffness)
        for name, reference in references["string_W"][f"v={v}"].items():
            p, q = map(int, name.split("+"))
            assert found.slope(system, p, q) / np.sqrt(f0) == pytest.approx(float(reference), abs=1e-3)


MODELS = ("membrane", "static", "dynamic")
OBLIQUE = EdgeLoad.linear(0.5, 1.5).with_waveform({1: (1.0, 0.4), 2: (EdgeLoad.partial(0.4, 0.3), 0.2)})


@pytest.mark.parametrize("inplane", MODELS)
def test_mirror_in_x_reverses_the_speed(inplane: str) -> None:
    there, back = (MovingPlate(speed=V, damping=1e-4, inplane=inplane, load=OBLIQUE).at(30.0) for V in (3.0, -3.0))
    # x -> a - x turns sin(k pi x/a) into (-1)^(k+1) times itself
    mirror = np.repeat((-1.0) ** np.arange(4), 7)
    for name in ("gyroscopic", "damping", "stiffness", "cosine", "sine"):
        one, other = getattr(there, name), getattr(back, name)
        np.testing.assert_allclose(mirror[:, None] * one * mirror, other, atol=1e-9 * max(np.abs(one).max(), 1))
    np.testing.assert_array_equal(there.gyroscopic, -back.gyroscopic)


@pytest.mark.parametrize("inplane", MODELS)
def test_mirror_in_y_turns_the_load(inplane: str) -> None:
    one, other = (MovingPlate(inplane=inplane, load=EdgeLoad.linear(*ends)).at(30.0) for ends in ((1, 3), (3, 1)))
    mirror = np.tile((-1.0) ** np.arange(7), 4)  # y -> b - y turns q_l into (-1)^l q_l
    np.testing.assert_allclose(mirror[:, None] * one.stiffness * mirror, other.stiffness, atol=1e-8)
    np.testing.assert_allclose(mirror[:, None] * one.cosine * mirror, other.cosine, atol=1e-8)


@pytest.mark.parametrize("inplane", MODELS)
@pytest.mark.parametrize("load", [EdgeLoad.uniform(), EdgeLoad.partial(0.5)], ids=["uniform", "middle half"])
def test_symmetric_loads_keep_even_and_odd_modes_apart(inplane: str, load: EdgeLoad) -> None:
    system = MovingPlate(inplane=inplane, load=load).at(30.0)
    odd = np.tile(np.arange(7) % 2 == 1, 4)
    for F in (system.stiffness, *system.cosine, *system.sine):
        assert np.abs(F[np.ix_(odd, ~odd)]).max() < 1e-12 * np.abs(system.stiffness).max()


@pytest.mark.parametrize("inplane", MODELS)
def test_stiffness_is_positive_definite_exactly_below_the_divergence_speed(inplane: str) -> None:
    def at_speed(V: float) -> MovingPlate:
        return MovingPlate(speed=V, inplane=inplane, load=OBLIQUE, thickness_ratio=0.05)

    critical = at_speed(0.0).critical_speed()
    below = at_speed(critical * (1 - 1e-7))
    assert below.critical_speed() == critical
    # near V_cr the lowest eigenvalue of K_o is about 2 (1 - V/V_cr) V^2 (pi/r)^2 = 4e-5
    assert 0 < np.linalg.eigvalsh(below.at(1.0).stiffness)[0] < 1e-4
    for V in (critical * (1 + 1e-7), -critical * (1 + 1e-7)):
        with pytest.raises(ValueError, match=f"speed = {V!r} .* divergence speed {critical:.10g}"):
            at_speed(V)


def test_compression_beyond_buckling_names_the_limit() -> None:
    with pytest.raises(ValueError, match=r"tension = -20.0 buckles .* beyond -9\.398915") as message:
        MovingPlate(speed=0, tension=-20)
    limit = float(str(message.value).split("beyond ")[1].split()[0])
    # under uniform compression the plate at rest buckles at -V_cr^2 of the plate without tension
    assert -limit == pytest.approx(MovingPlate(speed=0, tension=0).critical_speed() ** 2, rel=1e-9)
    assert MovingPlate(speed=0, tension=limit * (1 - 1e-6)).critical_speed() < 1e-2
    with pytest.raises(ValueError, match="buckles"):
        MovingPlate(speed=0, tension=limit * (1 + 1e-6))


def test_tension_can_buckle_where_the_load_pushes() -> None:
    bending = EdgeLoad.linear(-8, 10)  # compresses nearly half of the plate
    with pytest.raises(ValueError, match=r"buckles the plate at rest, as every tension beyond \d") as message:
        MovingPlate(speed=0, tension=1e3, load=bending)
    limit = float(str(message.value).split("beyond ")[1].split()[0])
    assert MovingPlate(speed=0, tension=limit * (1 - 1e-6), load=bending).critical_speed() < 1e-1


def test_no_tension_no_excitation() -> None:
    system = MovingPlate(tension=0, load=OBLIQUE).at(10.0)
    assert system.harmonics == 2
    assert not system.cosine.any()
    assert not system.sine.any()


def test_excitation_is_linear_in_the_load() -> None:
    plate = MovingPlate(load=EdgeLoad.uniform().with_waveform({1: (2.0, -0.5), 2: (0.0, 3.0)}))
    unit = MovingPlate().at(1.0).cosine[0]
    np.testing.assert_allclose(unit, plate.tension * plate.static_stress_stiffness, rtol=1e-14)
    system = plate.at(1.0)
    np.testing.assert_allclose(system.cosine, [2 * unit, 0 * unit], atol=1e-12)
    np.testing.assert_allclose(system.sine, [-0.5 * unit, 3 * unit], atol=1e-12)


def test_damping_is_the_elastic_stiffness() -> None:
    plate = MovingPlate(damping=2e-3)
    np.testing.assert_array_equal(plate.at(1.0).damping, 2e-3 * plate.elastic_stiffness)


@pytest.mark.parametrize("inplane", MODELS)
def test_only_the_excitation_of_the_dynamic_model_depends_on_frequency(inplane: str) -> None:
    plate = MovingPlate(inplane=inplane, thickness_ratio=0.05)
    slow, fast = plate.at(10.0), plate.at(20.0)
    assert (slow is fast) == (inplane != "dynamic")
    for name in ("mass", "gyroscopic", "damping", "stiffness"):
        np.testing.assert_array_equal(getattr(slow, name), getattr(fast, name))


STEEL = {
    "length": 1.2,
    "width": 0.8,
    "thickness": 0.004,
    "density": 7850.0,
    "youngs_modulus": 2.06e11,
    "poisson_ratio": 0.29,
    "speed": 25.0,
    "tension": 3e4,
    "damping": 2e-6,
}


def test_from_si_and_back() -> None:
    plate = MovingPlate.from_si(**STEEL, inplane="static", axial_terms=3)
    assert plate.aspect_ratio * plate.length_unit == pytest.approx(STEEL["length"], rel=1e-14)
    assert plate.thickness_ratio * plate.length_unit == pytest.approx(STEEL["thickness"], rel=1e-14)
    assert plate.speed * plate.speed_unit == pytest.approx(STEEL["speed"], rel=1e-14)
    assert plate.tension * plate.tension_unit == pytest.approx(STEEL["tension"], rel=1e-14)
    assert plate.damping * plate.time_unit == pytest.approx(STEEL["damping"], rel=1e-14)
    assert plate.frequency_unit * plate.time_unit == pytest.approx(1, rel=1e-14)
    assert (plate.inplane, plate.terms.axial) == ("static", 3)


def test_from_si_against_a_textbook_beam() -> None:
    # Bernoulli–Euler beam on pinned ends, nu = 0, per unit width: E I = E h^3 / 12, rho A = rho h,
    # omega_1^2 = (E I (pi/a)^4 + T (pi/a)^2) / (rho A), V_cr^2 = (T + E I (pi/a)^2) / (rho A).
    a, h, rho, E, T = 2.0, 0.01, 2700.0, 7e10, 5e3
    plate = MovingPlate.from_si(
        length=a, width=0.5, thickness=h, density=rho, youngs_modulus=E, poisson_ratio=0, speed=0, tension=T
    )
    critical = np.sqrt((T + E * h**3 / 12 * (np.pi / a) ** 2) / (rho * h))
    assert plate.critical_speed() * plate.speed_unit == pytest.approx(critical, rel=1e-12)
    lowest = np.sqrt(eigh(plate.at(1.0).stiffness, eigvals_only=True)[0]) * plate.frequency_unit
    assert lowest == pytest.approx(np.pi / a * critical, rel=1e-9)


@pytest.mark.filterwarnings("ignore::plate.SoftMaterialWarning")
def test_units_by_hand() -> None:
    # D = 96 / 8 / (12 (1 - 1/4)) = 4/3 N m and rho h = 3 kg/m^2: time sqrt(3 / (4/3)) = 1.5 s, tension 4/3 N/m
    plate = MovingPlate.from_si(
        length=1, width=1, thickness=0.5, density=6, youngs_modulus=96, poisson_ratio=0.5, speed=0, tension=1
    )
    assert plate.time_unit == pytest.approx(1.5, rel=1e-14)
    assert plate.tension_unit == pytest.approx(4 / 3, rel=1e-14)
    assert plate.speed_unit == pytest.approx(1 / 1.5, rel=1e-14)


@settings(max_examples=15, deadline=None)
@given(st.floats(-2, 2), st.floats(-2, 2), st.floats(-2, 2))
def test_units_do_not_matter(length: float, mass: float, time: float) -> None:
    # The same plate measured in other units of length, mass and time has the same dimensionless parameters.
    m, kg, s = 10.0**length, 10.0**mass, 10.0**time
    factors = {"length": m, "width": m, "thickness": m, "density": kg / m**3, "youngs_modulus": kg / (m * s**2)}
    factors |= {"poisson_ratio": 1.0, "speed": m / s, "tension": kg / s**2, "damping": s}
    one = MovingPlate.from_si(**STEEL)
    other = MovingPlate.from_si(**{name: value * factors[name] for name, value in STEEL.items()})
    for name in ("aspect_ratio", "speed", "tension", "damping", "thickness_ratio"):
        assert getattr(one, name) == pytest.approx(getattr(other, name), rel=1e-12)
    assert other.frequency_unit == pytest.approx(one.frequency_unit / s, rel=1e-12)


def test_units_follow_a_changed_plate() -> None:
    thick = MovingPlate.from_si(**(STEEL | {"thickness": 0.006}))
    changed = replace(MovingPlate.from_si(**STEEL), thickness_ratio=thick.thickness_ratio)
    assert changed.time_unit == thick.time_unit
    assert changed.tension_unit == thick.tension_unit


@pytest.mark.parametrize("name", ["length_unit", "time_unit", "frequency_unit", "speed_unit", "tension_unit"])
def test_a_plate_without_si_units_says_so(name: str) -> None:
    with pytest.raises(ValueError, match="from_si"):
        getattr(MovingPlate(), name)


def test_plates_are_values() -> None:
    one, other = (MovingPlate(load=EdgeLoad.partial(0.5), inplane="dynamic") for _ in range(2))
    assert one == other
    assert hash(one) == hash(other)
    one.at(20.0)
    copy = pickle.loads(pickle.dumps(one))
    assert copy == one
    np.testing.assert_array_equal(copy.at(33.0).cosine, other.at(33.0).cosine)
    with pytest.raises(FrozenInstanceError):
        one.speed = 1.0  # type: ignore[misc]
    for array in (one.elastic_stiffness, one.static_stress_stiffness, one.transport_stiffness):
        assert not array.flags.writeable


NOT_NUMBERS = (np.nan, np.inf, -np.inf, "1", None, True, 1j, [1.0], np.ones(2))
BAD: list[tuple[str, Any]] = [
    *[(name, value) for name in ("aspect_ratio", "thickness_ratio") for value in (0, -1.0, 1e9)],
    *[
        (name, value)
        for name in ("aspect_ratio", "speed", "tension", "damping", "poisson_ratio", "thickness_ratio")
        for value in NOT_NUMBERS
    ],
    ("damping", -1e-9),
    *[("poisson_ratio", value) for value in (-1.0, 0.51, 1.0, 2.0)],
    ("thickness_ratio", 1.0),
    *[(name, value) for name in ("axial_terms", "lateral_terms") for value in (0, -1, 2.0, "4", True, 10**6)],
    *[("inplane_terms", value) for value in (9, "99", (9,), (9, 9, 9), (1, 9), (9, 0), (9.0, 9), (9, 10**6))],
    *[("inplane", value) for value in ("plane", "", None, 1, "Static")],
    *[("load", value) for value in (None, "uniform", 1.0, EdgeLoad, EdgeLoad.uniform().static)],
    ("si", 1.0),
]


@pytest.mark.parametrize(("name", "value"), BAD)
def test_bad_parameters_are_named(name: str, value: Any) -> None:
    with pytest.raises(ValueError, match=name):
        MovingPlate(**{name: value})


@pytest.mark.parametrize("inplane", ["static", "dynamic"])
def test_too_few_functions_for_a_long_plate_are_refused(inplane: str) -> None:
    with pytest.raises(ValueError, match=r"inplane_terms\[0\] = 9 .* aspect_ratio = 9\.5"):
        MovingPlate(aspect_ratio=9.5, inplane=inplane, inplane_terms=(9, 9))
    # with enough of them a long plate is nearly a membrane
    long = MovingPlate(aspect_ratio=9.5, inplane=inplane, inplane_terms=(15, 9))
    assert long.critical_speed() == pytest.approx(MovingPlate(aspect_ratio=9.5).critical_speed(), rel=1e-4)


def test_too_many_coordinates_are_refused() -> None:
    with pytest.raises(ValueError, match=r"axial_terms \* lateral_terms = 10000"):
        MovingPlate(axial_terms=100, lateral_terms=100)


@pytest.mark.parametrize("name", STEEL)
@pytest.mark.parametrize("value", [np.nan, np.inf, "1", None, -np.inf])
def test_bad_si_properties_are_named(name: str, value: Any) -> None:
    with pytest.raises(ValueError, match=name):
        MovingPlate.from_si(**(STEEL | {name: value}))


@pytest.mark.parametrize("name", ["length", "width", "thickness", "density", "youngs_modulus"])
@pytest.mark.parametrize("value", [0.0, -1.0])
def test_si_properties_are_positive(name: str, value: float) -> None:
    with pytest.raises(ValueError, match=name):
        MovingPlate.from_si(**(STEEL | {name: value}))


@pytest.mark.filterwarnings("ignore::plate.SoftMaterialWarning")
@pytest.mark.parametrize(
    "changes", [{"thickness": 1e-110}, {"youngs_modulus": 1e-320}, {"width": 1e160, "length": 1e160}]
)
def test_units_beyond_floating_point_are_refused(changes: dict[str, float]) -> None:
    with pytest.raises(ValueError, match="out of range"):
        MovingPlate.from_si(**(STEEL | changes))


@pytest.mark.parametrize("Omega", [-1.0, 1e160, np.nan, np.inf, "20", None, [20.0], True])
@pytest.mark.parametrize("inplane", MODELS)
def test_bad_frequencies_are_refused(Omega: Any, inplane: str) -> None:
    with pytest.raises(ValueError, match="Omega"):
        MovingPlate(inplane=inplane).at(Omega)
    with pytest.raises(ValueError, match="Omega"):
        MovingPlate(inplane=inplane).stress(Omega, 1)


@pytest.mark.parametrize(("thickness_ratio", "tension"), [(0.9, 1e3), (0.6, 1.0), (0.1, 1e3)])
def test_in_plane_waves_that_are_slower_than_divergence_are_refused(thickness_ratio: float, tension: float) -> None:
    # not as buckling, though the stress near the speed of shear waves buckles any plate
    with pytest.raises(ValueError, match=f"thickness_ratio = {thickness_ratio} is too large for tension = {tension}"):
        MovingPlate(speed=0.0, thickness_ratio=thickness_ratio, tension=tension, inplane="dynamic")


def test_a_hundred_coordinates() -> None:
    small, large = (
        MovingPlate(axial_terms=K, lateral_terms=lateral, inplane="static") for K, lateral in ((4, 7), (10, 10))
    )
    assert large.at(1.0).size == 100
    lowest = [modes(plate.at(1.0), plate.elastic_stiffness).omega[0] for plate in (small, large)]
    assert lowest[0] * (1 - 2e-4) < lowest[1] < lowest[0]  # the larger space holds the smaller


@pytest.mark.parametrize("r", [0.1, 0.4, 1.0, 2.4, 10.0])
@pytest.mark.parametrize("load", [EdgeLoad.uniform(), EdgeLoad.partial(0.5)], ids=["uniform", "middle half"])
def test_terms_by_aspect_ratio_resolve_the_six_lowest_modes(r: float, load: EdgeLoad) -> None:
    rest = MovingPlate(aspect_ratio=r, speed=0.0, load=load, inplane="static")
    speed, terms = 0.8 * rest.critical_speed(), rest.terms
    finer = {"axial_terms": terms.axial + 6, "lateral_terms": 16, "inplane_terms": (terms.inplane[0] + 6, 19)}
    omega, exact = (
        modes(plate.at(0.0), plate.elastic_stiffness).omega[:6]
        for plate in (replace(rest, speed=speed), replace(rest, speed=speed, **finer))
    )
    np.testing.assert_allclose(omega, exact, rtol=0.005)


def test_terms_follow_a_changed_aspect_ratio_unless_given() -> None:
    assert replace(MovingPlate(), aspect_ratio=0.1).terms.lateral == 14
    assert replace(MovingPlate(lateral_terms=7), aspect_ratio=0.1).terms.lateral == 7
