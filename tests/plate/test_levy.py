"""The exact static stress: independent numbers, identities of virtual work, field equations next to singular points."""

from __future__ import annotations

from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.polynomial import Polynomial
from numpy.typing import NDArray
from scipy.special import expn, zeta

import plate.levy
from plate import Distribution, EdgeLoad, transverse
from plate.basis import gauss_legendre
from plate.inplane import InPlaneProblem
from plate.levy import exponential_integral, smoothed, static_stresses, sum_of_tail
from tests.plate.plate_oracles import distributions

LOADS = {
    "uniform": EdgeLoad.uniform().static,
    "middle half": EdgeLoad.partial(0.5).static,
    "oblique": EdgeLoad.linear(0.2, 1.8).static,
    "skew part": EdgeLoad.partial(0.4, 0.3).static,
    "parabola": EdgeLoad.parabolic().static,
    "half wave": EdgeLoad.cosine(0.3).static,
    "samples": EdgeLoad.from_samples([0.0, 0.2, 0.25, 0.7, 1.0], [0.3, 2.0, 0.1, 1.0, 1.4]).static,
    "pieces": Distribution((0.0, 0.3, 0.9, 1.0), ((1.0, 0.5), (2.0, -0.3, 0.4, 0.5), (0.0,))),
}
# Every load and every aspect ratio; half of the pairs in `make test`.
LOADS_AND_RATIOS = [
    pytest.param(load, r, marks=[pytest.mark.slow] * ((i + j) % 2))
    for i, load in enumerate(LOADS)
    for j, r in enumerate([0.001, 0.1, 1.0, 3.0, 10.0, 50.0])
]


class Grid(NamedTuple):
    """Nodes and weights along x and across y, for integrands with singular points on the edges."""

    X: NDArray[np.float64]
    W_X: NDArray[np.float64]
    Y: NDArray[np.float64]
    W_Y: NDArray[np.float64]

    @classmethod
    def over(cls, f: Distribution, r: float, levels: int = 8, nodes: int = 6) -> Grid:
        return cls(*graded([0.0, r], levels, nodes), *graded(f.breaks, levels, nodes))

    def integral(self, values: NDArray[np.float64]) -> float:
        return float(self.W_X @ values @ self.W_Y)


def graded(places: Any, levels: int, nodes: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Gauss's rule on panels that halve towards each of the places."""
    half = np.concatenate([[0.0], 0.5 ** np.arange(levels, 0, -1)])
    ends = np.concatenate([half, 1 - half[-2::-1]])
    panels = [start + (end - start) * ends for start, end in pairwise(places)]
    rules = [gauss_legendre(nodes, low, high) for panel in panels for low, high in pairwise(panel)]
    places_of_rules, weights = zip(*rules, strict=True)
    return np.concatenate(places_of_rules), np.concatenate(weights)


@pytest.mark.parametrize("r", [1, 2])
@pytest.mark.parametrize(("load", "key"), [("uniform", "uniform f=1"), ("middle half", "middle half f=2")])
def test_stresses_at_points(references: dict[str, Any], load: str, key: str, r: int) -> None:
    for point in references["inplane_static_nu0.3"][f"a/b={r} {key}"]:
        found = static_stresses(LOADS[load], r, 0.3, np.array([point["x_a"] * r]), np.array([point["y_b"]]))
        exact = [float(point[name]) for name in ("Nxx", "Nyy", "Nxy")]
        np.testing.assert_allclose(found[:, 0, 0], exact, atol=6e-10)  # the references have nine decimals


loads = distributions() | st.sampled_from(list(LOADS.values()))
polynomials = st.lists(st.integers(-3, 3), min_size=1, max_size=4).map(Polynomial)


@settings(max_examples=20, deadline=None)
@given(loads, st.floats(0.3, 5), st.floats(-0.5, 0.5), polynomials, polynomials, polynomials, polynomials)
def test_virtual_work(
    f: Distribution, r: float, nu: float, a: Polynomial, b: Polynomial, c: Polynomial, d: Polynomial
) -> None:
    # Virtual displacements u = a(X/r) b(Y), v = X (r - X) c(X/r) d(Y): equilibrium inside, and tractions at all edges.
    grid = Grid.over(f, r)
    N_xx, N_yy, N_xy = static_stresses(f, r, nu, grid.X, grid.Y)
    t, Y = Polynomial([0, 1 / r]), grid.Y
    u, v = a(t), Polynomial([0, r, -1]) * c(t)
    work = (
        N_xx * np.outer(u.deriv()(grid.X), b(Y))
        + N_yy * np.outer(v(grid.X), d.deriv()(Y))
        + N_xy * (np.outer(u(grid.X), b.deriv()(Y)) + np.outer(v.deriv()(grid.X), d(Y)))
    )
    scale = grid.integral(np.abs(work)) + np.abs(f(Y)).max()
    assert grid.integral(work) == pytest.approx((u(r) - u(0)) * (grid.W_Y @ (f(Y) * b(Y))), abs=1e-6 * scale)


@settings(max_examples=8, deadline=None)
@given(loads, st.floats(0.3, 5), st.floats(-0.5, 0.5), polynomials, polynomials)
def test_complementary_virtual_work(f: Distribution, r: float, nu: float, a: Polynomial, b: Polynomial) -> None:
    # Virtual stresses of Airy's function X (r - X) a(X/r) Y^2 (1 - Y)^2 b(Y) act on no edge except along v at X = 0, r:
    # the strains are those of displacements with v = 0 there.
    grid = Grid.over(f, r)
    N_xx, N_yy, N_xy = static_stresses(f, r, nu, grid.X, grid.Y)
    g, h = Polynomial([0, r, -1]) * a(Polynomial([0, 1 / r])), Polynomial([0, 0, 1, -2, 1]) * b
    work = (
        (N_xx - nu * N_yy) * np.outer(g(grid.X), h.deriv(2)(grid.Y))
        + (N_yy - nu * N_xx) * np.outer(g.deriv(2)(grid.X), h(grid.Y))
        - 2 * (1 + nu) * N_xy * np.outer(g.deriv()(grid.X), h.deriv()(grid.Y))
    )
    scale = grid.integral(np.abs(work)) + np.abs(f(grid.Y)).max()
    assert grid.integral(work) == pytest.approx(0, abs=1e-6 * scale)


@pytest.mark.parametrize(("load", "r"), LOADS_AND_RATIOS)
def test_edges(load: str, r: float) -> None:
    f, nu = LOADS[load], 0.3
    X, Y = r * np.array([0.0, 1e-9, 1e-5, 1e-3, 0.1, 0.37, 0.5, 0.9, 1.0]), np.linspace(0, 1, 38)  # on no jump
    N_xx, N_yy, N_xy = static_stresses(f, r, nu, X, Y)
    scale = np.abs(f(Y)).max()
    for edge in (0, -1):
        np.testing.assert_allclose(N_yy[:, edge], 0, atol=1e-11 * scale)
        np.testing.assert_allclose(N_xy[:, edge], 0, atol=1e-11 * scale)
        np.testing.assert_allclose(N_xx[edge], f(Y), atol=1e-11 * scale)
        # v_Y = 0 there
        np.testing.assert_allclose(N_yy[edge, 1:-1], nu * f(Y[1:-1]), atol=1e-11 * scale)


def test_stress_at_a_jump() -> None:
    # Polar coordinates rho, theta about a jump J of f: (N_xx - N_yy) / 2 jumps by (1 - nu) J / 2 along the edge, as the
    # harmonic function (1 - nu) J theta / (2 pi) does. By equilibrium N_xy has its conjugate, with log(rho) for theta.
    f, r, nu, J = LOADS["skew part"], 1.5, 0.3, 2.5
    X = r * np.array([0.0, 1e-9, 1e-7, 1e-5])
    N_xx, N_yy, N_xy = static_stresses(f, r, nu, X, np.array([0.1, 0.5]))
    np.testing.assert_allclose(N_xx, J / 2, atol=1e-4)
    np.testing.assert_allclose(N_yy, nu * J / 2, atol=1e-4)
    growth = np.diff(N_xy[1:], axis=0) / np.log(100)
    np.testing.assert_allclose(growth, (1 - nu) * J / (2 * np.pi) * np.array([[1, -1]] * 2), rtol=1e-4)
    assert np.isfinite(N_xy[0]).all()


@pytest.mark.parametrize("load", ["middle half", "oblique", "samples"])
@pytest.mark.parametrize("distance", [1e-1, 1e-2, 1e-3, 1e-4, 1e-5])
def test_field_equations_next_to_singular_points(load: str, distance: float) -> None:
    # Fourth-order differences over hundredths of the distance: an error of some 1e-7 of the derivatives' scale.
    r, nu, f = 1.3, 0.3, LOADS[load]
    h = distance / 100
    slope, bend = np.array([1, -8, 0, 8, -1]) / (12 * h), np.array([-1, 16, -30, 16, -1]) / (12 * h**2)
    steps = h * np.arange(-2, 3)
    for x in (0.0, 0.4):
        for y in (0.0, 0.25, 1.0):
            X = x + distance + steps
            for Y in (y + 0.7 * distance + steps, y - 0.7 * distance + steps):
                if Y[0] > 0 and Y[-1] < 1:
                    N = static_stresses(f, r, nu, X, Y)
                    N_xx, N_yy, N_xy = N
                    scale = np.abs(N).max() / distance
                    assert slope @ N_xx[:, 2] + N_xy[2] @ slope == pytest.approx(0, abs=1e-6 * scale)
                    assert slope @ N_xy[:, 2] + N_yy[2] @ slope == pytest.approx(0, abs=1e-6 * scale)
                    trace = N_xx + N_yy  # harmonic
                    assert bend @ trace[:, 2] + trace[2] @ bend == pytest.approx(0, abs=1e-5 * scale / distance)


@pytest.mark.parametrize(("load", "r"), LOADS_AND_RATIOS)
def test_terms_in_closed_form_are_those_left_out(monkeypatch: pytest.MonkeyPatch, load: str, r: float) -> None:
    places = np.array([0.0, 1e-9, 1e-6, 1e-3, 0.05, 0.25, 0.3 + 1e-5, 0.5])
    X, Y = r * places, np.concatenate([places, (1 - places[-2::-1])])
    many = static_stresses(LOADS[load], r, 0.3, X, Y)
    monkeypatch.setattr(plate.levy, "MAX_SUMMED_ALPHA", 2000.0)
    few = static_stresses(LOADS[load], r, 0.3, X, Y)
    np.testing.assert_allclose(few, many, atol=1e-11 if r < 50 else 5e-11)  # the waves of a long plate nearly coincide


@pytest.mark.parametrize("nu", [-0.9, 0.0, 0.3, 0.5])
@pytest.mark.parametrize("load", LOADS)
def test_mirror_across_the_mid_lines(load: str, nu: float) -> None:
    f, r, X, Y = LOADS[load], 1.7, np.linspace(0.1, 1.6, 11), np.linspace(0.01, 0.99, 11)
    turned = Distribution(
        tuple(1 - y for y in f.breaks[::-1]),
        tuple(tuple((-1) ** n * c for n, c in enumerate(row)) for row in f.coefficients[::-1]),
    )
    N, other = static_stresses(f, r, nu, X, Y), static_stresses(turned, r, nu, X, Y)
    sign = np.array([1, 1, -1])[:, None, None]
    np.testing.assert_allclose(N, sign * N[:, ::-1], atol=1e-12)
    np.testing.assert_allclose(N, sign * other[:, :, ::-1], atol=1e-12)


def test_without_poissons_ratio_a_linear_load_is_a_membrane() -> None:
    # u = (X - r/2) f, v = (r X - X^2) f'/2: N_xx = f everywhere
    X, Y = np.linspace(0, 2, 9), np.linspace(0, 1, 9)
    N = static_stresses(LOADS["oblique"], 2.0, 0.0, X, Y)
    np.testing.assert_allclose(N[0], np.tile(LOADS["oblique"](Y), (9, 1)), atol=1e-13)
    np.testing.assert_allclose(N[1:], 0, atol=1e-13)


def test_stress_spreads_evenly_in_the_middle_of_a_long_plate() -> None:
    # Saint-Venant: far from the ends only resultant and moment count; what balances itself falls like exp(-4.21 X) or
    # faster (Fadle and Papkovich)
    Y = np.linspace(0, 1, 11)
    for load in ("middle half", "skew part", "half wave"):
        f = LOADS[load]
        mean, moment = f.projection(2)
        even = mean + moment * np.sqrt(3) * (2 * Y - 1)
        differences = []
        for X in (2.0, 2.5, 3.0):
            N = static_stresses(f, 12.0, 0.3, np.array([X]), Y)[:, 0]
            differences.append(np.abs(N - [even, 0 * Y, 0 * Y]).max())
        assert differences[-1] < 1e-4
        assert np.exp(-6) < differences[2] / differences[0] < np.exp(-3)


@pytest.mark.parametrize("k", range(-1, 5))
def test_tails_by_direct_summation(k: int) -> None:
    start = 321
    m = np.arange(start, 200_000, 2, dtype=np.longdouble)
    z = np.array([1e-3, 0.003 - 0.002j, 0.01, 0.05 - 0.1j, 0.1, 0.03 - 1.5j])
    direct = (np.exp(-np.outer(z.astype(np.clongdouble), m)) * m**-k).sum(axis=1)
    # where |start z| is just below MIN_ASYMPTOTIC_ARGUMENT the recursion of E_k has lost four digits
    np.testing.assert_allclose(sum_of_tail(k, start, z), direct.astype(complex), rtol=1e-11)
    if k > 0:  # as z -> 0: (1 - 2^-k) zeta(k) less the first terms
        if k > 1:
            first = ((1 - 2.0**-k) * zeta(k) - (np.arange(1.0, start, 2) ** -k).sum()) * start ** (k - 1)
            np.testing.assert_allclose(sum_of_tail(k, start, np.array([1e-14j])) * start ** (k - 1), first, rtol=1e-6)
        x = np.array([1e-3, 0.5, 7.0, 49.0, 51.0, 200.0])
        np.testing.assert_allclose(exponential_integral(k, x.astype(complex)), expn(k, x), rtol=1e-11)


@pytest.mark.parametrize(
    ("width", "row", "nearest", "tolerance"),
    [
        pytest.param(0.1, (0.4, -1.1, 0.9, 0.5), 0.0, 1e-5, marks=pytest.mark.slow),
        pytest.param(0.01, (0.4, -1.1, 0.9, 0.5), 0.0, 1e-5, marks=pytest.mark.slow),
        (0.1, (0.4, -1.1, 0.9, 0.5, 0.0, 0.3, -0.4), 0.0, 1e-4),
        pytest.param(0.01, (0.4, -1.1, 0.9, 0.5, 0.0, 0.3, -0.4), 0.0, 2e-4, marks=pytest.mark.slow),
        # taken as straight, which tells at Y within the piece
        (3e-5, (0.4, -1.1, 0.9, 0.5, 0.0, 0.3, -0.4), 1e-2, 1e-2),
        pytest.param(1e-7, (0.4, -1.1, 0.9, 0.5), 1e-2, 2e-2, marks=pytest.mark.slow),
    ],
)
def test_a_rough_piece_against_a_fine_polygon(
    width: float, row: tuple[float, ...], nearest: float, tolerance: float
) -> None:
    # A polygon needs none of what is done for curved pieces. With 1000 corners it misses the piece by 2e-6 (degree 3)
    # or 1e-5 (degree 6), and the stress close to the edge by a few times that.
    r, low, high = 1.3, 0.4, 0.4 + width
    rough = Distribution((0.0, low, high, 1.0), ((1.0, 0.5), row, (2.0, -0.3)))
    corners = np.linspace(low, high, 1001)
    f = np.polynomial.legendre.legval(np.linspace(-1, 1, 1001), row)
    polygon = Distribution(
        (0.0, *corners, 1.0), ((1.0, 0.5), *zip((f[1:] + f[:-1]) / 2, (f[1:] - f[:-1]) / 2, strict=True), (2.0, -0.3))
    )
    X = r * np.array([x for x in (0.0, 1e-4, 1e-3, 1e-2, 0.3) if x >= nearest])
    Y = np.array([0.0, 0.35, low - width / 3, low + 0.3 * width, high + width / 2, 0.9])
    one, other = (static_stresses(load, r, 0.3, X, Y) for load in (rough, polygon))
    np.testing.assert_allclose(one, other, atol=tolerance)


def test_rough_pieces_are_cut_into_hermite_cubics() -> None:
    rough = Distribution((0.0, 0.4, 0.41, 1.0), ((1.0, 0.5), (0.4, -1.1, 0.9, 0.5, 0.0, 0.3, -0.4), (2.0, -0.3)))
    cut = smoothed(rough)
    assert len(cut.coefficients) == 2 + 6**2
    y = np.linspace(0, 1, 2001)
    np.testing.assert_allclose(cut(y), rough(y), atol=1e-4)
    for one, other in ((cut, rough), (cut.derivative, rough.derivative)):
        jumps = one.jumps[1:-1]
        np.testing.assert_allclose(jumps[[0, -1]], other.jumps[1:-1], rtol=1e-9)
        np.testing.assert_allclose(jumps[1:-1], 0, atol=1e-9 * np.abs(jumps).max())
    assert smoothed(LOADS["half wave"]) == LOADS["half wave"]


@pytest.mark.parametrize(
    ("load", "order"),
    # in the number of terms each way: 4 if the load reaches the corners, where the stress depends on direction, else 5
    [
        pytest.param("uniform", 4, marks=pytest.mark.slow),
        pytest.param("oblique", 4, marks=pytest.mark.slow),
        ("middle half", 5),
        pytest.param("parabola", 5, marks=pytest.mark.slow),
    ],
)
def test_stiffness_of_the_trial_space_tends_to_the_integral_of_the_exact_stress(load: str, order: int) -> None:
    r, nu, K, lateral = 1.4, 0.3, 2, 3
    f = LOADS[load]
    grid = Grid.over(f, r)
    rules = (grid.X, grid.W_X), (grid.Y, grid.W_Y)
    exact = transverse.stress_stiffness(static_stresses(f, r, nu, grid.X, grid.Y), *rules, K, lateral, r)
    terms, errors = np.array([12, 18, 27, 40]), []
    for count in terms:
        problem = InPlaneProblem(r, nu, int(count), int(count))
        F = problem.stress_stiffness(problem.static_response(problem.force(f)), K, lateral)
        errors.append(np.abs(F - exact).max() / np.abs(exact).max())
    assert -np.polyfit(np.log(terms), np.log(errors), 1)[0] == pytest.approx(order, abs=0.2)
    assert errors[-1] < 5e-6
