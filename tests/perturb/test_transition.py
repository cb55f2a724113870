"""First-order transition curves: closed forms, references, growth rates, order of the error, refusals."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from periodic import PeriodicSystem
from periodic.examples import coupled_mathieu, gyroscopic_rotor, mathieu, meissner
from perturb import TransitionCurve, gyroscopic_modes, transition_curves
from perturb.coupling import amplitude, products
from plate import MovingPlate
from tests.perturb.perturb_oracles import (
    changed,
    fitted_order,
    hill_edges,
    hill_growth,
    moving_string,
    random_system,
)

few = settings(deadline=None, max_examples=20)
seeds = st.integers(0, 10**6)
EVERYTHING = (0.0, 1e6)


def curve(family: Any, label: str, Omega_range: tuple[float, float] = EVERYTHING, **options: Any) -> TransitionCurve:
    """The one curve of that name."""
    (found,) = [c for c in transition_curves(family, Omega_range, **options) if c.label == label]
    return found


# --- systems with known answers --------------------------------------------------------------------------------------


@pytest.mark.parametrize("damping", [0.0, 0.07])
def test_mathieu(damping: float) -> None:
    """Omega = 2 omega ± sqrt((eps / (2 omega))^2 - d^2) (docstring of `mathieu`)."""
    omega, eps = 1.3, np.array([0.05, 0.3, 0.6])
    (only,) = transition_curves(mathieu(omega**2, damping), EVERYTHING)
    assert (only.p, only.q, only.j, only.type, only.order, only.label) == (1, 1, 1, "sum", 1, "2ω₁")
    assert only.centre == pytest.approx(2 * omega, rel=1e-14)
    assert only.slope == pytest.approx(0.5 / omega, rel=1e-13)
    assert only.tip == pytest.approx(2 * omega * damping, rel=1e-13)
    with np.errstate(invalid="ignore"):
        half = np.sqrt((eps / (2 * omega)) ** 2 - damping**2)
    np.testing.assert_allclose(only.edges(eps), (2 * omega - half, 2 * omega + half), rtol=1e-13)


@pytest.mark.parametrize("type", ["sum", "difference"])
def test_coupled_mathieu(type: str) -> None:
    """Docstring of `coupled_mathieu`; only the region of its type is open."""
    (w1, w2), b, (d1, d2) = (1.1, 1.9), 0.7, (0.01, 0.05)
    centre = w1 + w2 if type == "sum" else w2 - w1
    label = "ω₁+ω₂" if type == "sum" else "ω₂−ω₁"
    L, eps = b**2 / (4 * w1 * w2), np.array([0.3, 0.5])
    elastic = curve(coupled_mathieu(type, (w1, w2), b), label)
    damped = curve(coupled_mathieu(type, (w1, w2), b, (d1, d2)), label)
    np.testing.assert_allclose(elastic.edges(eps), (centre - eps * np.sqrt(L), centre + eps * np.sqrt(L)), rtol=1e-13)
    half = (d1 + d2) / 2 * np.sqrt(eps**2 * L / (d1 * d2) - 1)
    np.testing.assert_allclose(damped.edges(eps), (centre - half, centre + half), rtol=1e-12)
    assert damped.tip == pytest.approx(np.sqrt(d1 * d2 / L), rel=1e-12)
    assert damped.slope == pytest.approx((d1 + d2) / (2 * np.sqrt(d1 * d2)) * elastic.slope, rel=1e-12)
    for system in (coupled_mathieu(type, (w1, w2), b), coupled_mathieu(type, (w1, w2), b, (d1, d2))):
        for other in transition_curves(system, EVERYTHING):
            assert (other.label == label) == np.isfinite(other.tip)


def test_damping_widens_a_combination_region_above_a_multiple_of_its_tip() -> None:
    """From eps = tip (C_p + C_q) / |C_p - C_q| on the damped region is the wider one."""
    d1, d2 = 0.01, 0.05
    elastic = curve(coupled_mathieu(), "ω₁+ω₂")
    damped = curve(coupled_mathieu(damping=(d1, d2)), "ω₁+ω₂")
    turn = damped.tip * (d1 + d2) / (d2 - d1)
    for eps, sign in ((0.99 * turn, -1), (1.01 * turn, 1)):
        assert sign * (np.diff(damped.edges(eps)) - np.diff(elastic.edges(eps))) > 0


def test_round_rotor_has_the_combination_region_only() -> None:
    k, s = 4.0, 0.5
    curves = {c.label: c for c in transition_curves(gyroscopic_rotor((k, k), s), EVERYTHING)}
    assert curves["ω₁+ω₂"].slope == pytest.approx(0.5 / np.sqrt(k), rel=1e-13)  # as `mathieu`
    assert curves["2ω₁"].slope == curves["2ω₂"].slope == 0.0
    wider = curve(gyroscopic_rotor((k, k), s), "ω₁+ω₂", vanishing_damping=np.eye(2))
    assert wider.slope / curves["ω₁+ω₂"].slope == pytest.approx(1 / np.sqrt(1 - s**2 / k), rel=1e-12)
    assert wider.tip == 0.0
    np.testing.assert_allclose(wider.edges(0.1), (4 - 0.1 * wider.slope, 4 + 0.1 * wider.slope), rtol=1e-12)


def test_moving_string_references(references: dict[str, Any]) -> None:
    """sqrt(L) of each resonance by itself; the sine series converges like n^-3 and is extrapolated."""
    for speed, table in references["string_W"].items():
        v = float(speed.removeprefix("v="))
        systems = [moving_string(v, n) for n in (40, 80)]
        coarse, fine = (np.sqrt(products(gyroscopic_modes(s), amplitude(s, 1), "sum").real) for s in systems)
        for label, value in table.items():
            p, q = map(int, label.split("+"))
            extrapolated = fine[p - 1, q - 1] + (fine[p - 1, q - 1] - coarse[p - 1, q - 1]) / 7
            assert extrapolated == pytest.approx(float(value), abs=5e-6), (speed, label)


# --- references for the plate ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("case", "ratio", "speed", "tension"),
    [
        ("a/b=1 V=3 f0=10", 1.0, 3.0, 10.0),
        ("a/b=2 V=2 f0=10", 2.0, 2.0, 10.0),
    ],
)
def test_plate_references(references: dict[str, Any], case: str, ratio: float, speed: float, tension: float) -> None:
    """Slopes to 1e-4, elastic and by the literal eq. (25); decay coefficients; zero width by symmetry, exactly."""
    plate = MovingPlate(aspect_ratio=ratio, speed=speed, tension=tension, axial_terms=14, lateral_terms=10)
    modes = gyroscopic_modes(plate.at(1.0))
    decay = [float(c) for c in references["moving_plate_membrane"][case]["c_p"]]
    np.testing.assert_allclose(modes.decay_coefficients(plate.elastic_stiffness)[:3], decay, rtol=1e-5)
    elastic, literal = (
        {(c.q, c.p): c for c in transition_curves(plate, (0, 80), types=["sum"], vanishing_damping=D)}
        for D in (None, plate.elastic_stiffness)
    )
    for label, expected in references["first_order_membrane"][case].items():
        p, q = map(int, label.split("+"))
        pair = (p, q)
        assert elastic[pair].centre == pytest.approx(float(expected["centre"]), rel=1e-5)
        assert elastic[pair].slope == pytest.approx(float(expected["sqrtL"]), rel=1e-4, abs=0.0)
        assert literal[pair].slope == pytest.approx(float(expected["paper25_alpha0"]), rel=1e-4)


# --- against Floquet -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("symmetric", [True, False])
@pytest.mark.parametrize("label", ["2ω₁", "ω₁+ω₂", "2ω₂", "2ω₁/2", "(ω₁+ω₂)/2", "ω₂−ω₁"])
def test_growth_rate_error_is_of_second_order(label: str, symmetric: bool) -> None:
    """Damped, near the centre of the region, against Hill's determinant; unsymmetric F has complex L."""
    eps = np.array([0.04, 0.02, 0.01])
    error = []
    for value in eps:
        system = random_system(15, 2, harmonics=2, damping=0.02 * value, symmetric=symmetric)
        found = curve(system, label)
        Omega = found.centre + 0.02 * value
        error.append(abs(found.growth_rate(Omega, value) - hill_growth(system, Omega, value, cut=6)))
    assert 1.7 < fitted_order(eps, np.array(error)) < 2.3


@pytest.mark.parametrize("damping", [(0.0, 0.0), (0.01, 0.08)])
def test_gap_is_of_second_order(damping: tuple[float, float]) -> None:
    """Undamped edges against eq. (25) at c = eps alpha; unequal damping, so that mistaking one for the other shows."""
    eps = np.array([0.2, 0.1, 0.05])
    gap = []
    for value in eps:
        system = coupled_mathieu("sum", damping=np.array(damping) * value / eps[0])
        found = curve(system, "ω₁+ω₂")
        lower, upper = found.edges(value)
        exact = hill_edges(system, found.centre, upper - lower, value, 0.0 if any(damping) else 1e-7)
        gap.append(max(abs(lower - exact[0]), abs(upper - exact[1])))
    assert 1.9 < fitted_order(eps, np.array(gap)) < 2.1


# --- invariances -----------------------------------------------------------------------------------------------------


@few
@given(seeds, st.floats(0.1, 10))
def test_unit_of_time(seed: int, unit: float) -> None:
    """t = unit t': frequencies, slopes and growth rates scale, tips do not."""
    system = random_system(seed, 2, damping=0.01)
    other = changed(
        system, mass=system.mass / unit**2, gyroscopic=system.gyroscopic / unit, damping=system.damping / unit
    )
    for here, there in zip(transition_curves(system, EVERYTHING), transition_curves(other, EVERYTHING), strict=True):
        assert there.label == here.label
        assert there.tip == pytest.approx(here.tip, rel=1e-9)
        for name in ("centre", "slope"):
            assert getattr(there, name) == pytest.approx(unit * getattr(here, name), rel=1e-9)
        growth = here.growth_rate(here.centre, 0.3)
        assert there.growth_rate(there.centre, 0.3) == pytest.approx(unit * growth, rel=1e-9, abs=1e-12)


@few
@given(seeds)
def test_sign_of_eps_decides_nothing(seed: int) -> None:
    for found in transition_curves(random_system(seed, 3, symmetric=False, damping=0.01), EVERYTHING):
        np.testing.assert_array_equal(found.edges(-0.2), found.edges(0.2))


def test_no_difference_type_for_symmetric_excitation() -> None:
    for damping in (0.0, 0.1):
        for found in transition_curves(random_system(7, 4, damping=damping), EVERYTHING, types=["difference"]):
            assert (found.slope, found.tip) == (0.0, np.inf)
            assert np.isnan(found.edges([0.0, 0.1, 10.0])).all()


# --- the list --------------------------------------------------------------------------------------------------------


def test_lists_every_resonance_of_the_range_once() -> None:
    system = random_system(8, 4, harmonics=3)
    omega = gyroscopic_modes(system).frequencies
    expected = set()
    low, high = 0.5, 3.0
    for j in (1, 2, 3):
        for p in range(4):
            for q in range(p + 1):
                if low <= (omega[p] + omega[q]) / j <= high:
                    expected.add((p + 1, q + 1, j, "sum"))
                if p > q and low <= (omega[p] - omega[q]) / j <= high:
                    expected.add((p + 1, q + 1, j, "difference"))
    curves = transition_curves(system, (low, high))
    assert {(c.p, c.q, c.j, c.type) for c in curves} == expected
    assert len(curves) == len(expected)
    centres = [c.centre for c in curves]
    assert centres == sorted(centres)
    sums = transition_curves(system, (low, high), types=("sum",))
    assert {(c.p, c.q, c.j) for c in sums} == {key[:3] for key in expected if key[3] == "sum"}


def test_equal_frequencies_have_no_difference() -> None:
    labels = [c.label for c in transition_curves(coupled_mathieu(frequencies=(1.2, 1.2)), EVERYTHING)]
    assert labels == ["2ω₁", "ω₁+ω₂", "2ω₂"]


def test_labels() -> None:
    curves = transition_curves(random_system(9, 12, harmonics=2), EVERYTHING)
    labels = {(c.p, c.q, c.j, c.type): c.label for c in curves}
    assert labels[1, 1, 1, "sum"] == "2ω₁"
    assert labels[3, 1, 1, "sum"] == "ω₁+ω₃"
    assert labels[3, 1, 1, "difference"] == "ω₃−ω₁"
    assert labels[1, 1, 2, "sum"] == "2ω₁/2"
    assert labels[12, 1, 2, "sum"] == "(ω₁+ω₁₂)/2"
    assert labels[12, 10, 2, "difference"] == "(ω₁₂−ω₁₀)/2"
    assert len(set(labels.values())) == len(labels)


def test_higher_harmonics_open_regions_at_fractions() -> None:
    """Harmonic j of Meissner's excitation: centre 2 omega / j, half width |F_cj| / (2 omega j); none for even j."""
    for found in transition_curves(meissner(1.44, harmonics=5), EVERYTHING):
        amplitude = 4 / (np.pi * found.j) if found.j % 2 else 0.0
        assert found.centre == pytest.approx(2.4 / found.j, rel=1e-13)
        assert found.slope == pytest.approx(amplitude / (2 * 1.2 * found.j), rel=1e-13)
        assert found.tip == (0.0 if found.j % 2 else np.inf)


def test_edges_of_a_higher_harmonic_are_those_of_the_first_at_a_fraction_of_the_frequency() -> None:
    one, eps = coupled_mathieu(damping=(0.02, 0.01)), np.array([0.1, 0.3])
    third = changed(one, cosine=[0 * one.cosine[0], 0 * one.cosine[0], one.cosine[0]], sine=np.zeros((3, 2, 2)))
    slow = curve(third, "(ω₁+ω₂)/3")
    for edge, expected in zip(slow.edges(eps), curve(one, "ω₁+ω₂").edges(eps), strict=True):
        assert edge == pytest.approx(expected / 3, rel=1e-13)


def test_a_family_is_taken_at_the_centre_of_each_region() -> None:
    class Family:
        def at(self, Omega: float) -> PeriodicSystem:
            return changed(coupled_mathieu(), cosine=[Omega**2 * np.ones((2, 2))])

    constant = changed(coupled_mathieu(), cosine=[np.ones((2, 2))])
    for found, unit in zip(
        transition_curves(Family(), EVERYTHING), transition_curves(constant, EVERYTHING), strict=True
    ):
        assert found.slope == pytest.approx(found.centre**2 * unit.slope, rel=1e-12)


def test_edges_keep_the_shape_of_eps() -> None:
    found = curve(mathieu(1.0, 0.05), "2ω₁")
    for eps in (0.2, [0.2], [[0.05, 0.2], [0.3, 0.4]], np.zeros((2, 0))):
        lower, upper = found.edges(eps)
        assert np.shape(lower) == np.shape(upper) == np.shape(eps)
    assert np.isnan(found.edges(0.05)).all()
    assert found.growth_rate([[1.9], [2.0]], [0.1, 0.2, 0.3]).shape == (2, 3)


# --- refusals --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("options", "says"),
    [
        ({"family": None}, r"^family = None is no system"),
        ({"family": np.eye(2)}, r"^family = array"),
        ({"family": mathieu(0.0)}, r"^family has, without excitation, an eigenvalue 0\+0j that is defective"),
        ({"Omega_range": 3.0}, r"^Omega_range"),
        ({"Omega_range": (1.0, 2.0, 3.0)}, r"^Omega_range"),
        ({"Omega_range": (2.0, 1.0)}, r"^Omega_range"),
        ({"Omega_range": (-1.0, 1.0)}, r"^Omega_range\[0\]"),
        ({"Omega_range": (0.0, np.inf)}, r"^Omega_range\[1\]"),
        ({"Omega_range": (np.nan, 1.0)}, r"^Omega_range\[0\]"),
        ({"Omega_range": ("a", "b")}, r"^Omega_range\[0\]"),
        ({"order": 0}, r"^order = 0"),
        ({"order": 3}, r"^order = 3"),
        ({"order": 1.0}, r"^order = 1\.0"),
        ({"order": True}, r"^order = True"),
        ({"order": "1"}, r"^order = '1'"),
        ({"types": "sum"}, r"^types = 'sum' is not a sequence"),
        ({"types": None}, r"^types = None"),
        ({"types": ()}, r"^types = \(\)"),
        ({"types": ("sum", "product")}, r"^types = 'product'"),
        ({"types": ("sum", "sum")}, r"^types = .*repeats"),
        ({"types": (1,)}, r"^types = 1"),
        ({"vanishing_damping": np.eye(3)}, r"^vanishing_damping has shape \(3, 3\)"),
        ({"vanishing_damping": 1.0}, r"^vanishing_damping has shape"),
        ({"vanishing_damping": [[1.0, 0.0], [0.5, 1.0]]}, r"^vanishing_damping is not symmetric"),
        ({"vanishing_damping": -np.eye(2)}, r"^vanishing_damping makes a mode grow"),
        ({"vanishing_damping": np.full((2, 2), np.nan)}, r"^vanishing_damping has the entry nan"),
        ({"vanishing_damping": np.eye(2), "order": 2}, r"^vanishing_damping is for undamped systems at order = 1"),
        (
            {"vanishing_damping": np.eye(2), "family": coupled_mathieu(damping=(0.1, 0.1))},
            r"^vanishing_damping is for undamped systems",
        ),
        (
            {"vanishing_damping": np.eye(2), "family": changed(coupled_mathieu(), damping=np.diag([0.1, -0.2]))},
            r"^vanishing_damping is for undamped systems of the form of eq\. \(11\)",
        ),
    ],
)
def test_bad_arguments_are_named(options: dict[str, Any], says: str) -> None:
    arguments: dict[str, Any] = {"family": coupled_mathieu(), "Omega_range": (0.0, 5.0)} | options
    with pytest.raises(ValueError, match=says):
        transition_curves(**arguments)


def test_a_family_must_return_systems() -> None:
    class Family:
        def at(self, Omega: float) -> float:
            return Omega

    with pytest.raises(ValueError, match=r"^family\.at\(5\.0\) gave 5\.0"):
        transition_curves(Family(), (0.0, 5.0))  # type: ignore[arg-type]


@pytest.mark.parametrize("bad", [None, "0.1", 0.1j, np.nan, [0.1, np.inf], [[0.1], [0.1, 0.2]]])
def test_curves_refuse_bad_eps_and_Omega(bad: Any) -> None:
    found = curve(mathieu(), "2ω₁")
    with pytest.raises(ValueError, match=r"^eps "):
        found.edges(bad)
    with pytest.raises(ValueError, match=r"^Omega "):
        found.growth_rate(bad, 0.1)
    with pytest.raises(ValueError, match=r"^eps "):
        found.growth_rate(2.0, bad)


def test_growth_rate_names_both_shapes() -> None:
    with pytest.raises(ValueError, match=r"^Omega has shape \(3,\) and eps \(2,\)"):
        curve(mathieu(), "2ω₁").growth_rate([1.0, 2.0, 3.0], [0.1, 0.2])


def test_a_curve_in_one_line() -> None:
    (curve,) = transition_curves(mathieu(damping=0.02), (1.5, 2.5))
    assert repr(curve) == "<TransitionCurve 2ω₁ at 2: order 1, slope 0.5, tip 0.04, meant up to eps = 0.3>"
