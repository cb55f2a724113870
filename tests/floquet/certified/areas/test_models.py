"""Taylor models against exact rational arithmetic, and the polynomials that decide against multipliers given."""

from __future__ import annotations

import math
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

pytest.importorskip("flint", reason="python-flint, the extra certify, is not installed")

from floquet.certified.areas.isolation import in_basis, is_definite, is_regular, isolated
from floquet.certified.areas.models import Model, combined, norm, size
from floquet.certified.areas.patches import _tail
from floquet.certified.areas.ranges import open_on_line, open_part
from floquet.certified.areas.signs import damped_signs, elementary, reciprocal_signs

RNG = np.random.default_rng(18)
DEGREE = 4


def model(rows: int, columns: int, radius: float = 0.0, scale: float = 1.0) -> Model:
    coef = RNG.uniform(-1, 1, (size(DEGREE), rows, columns))
    for i in range(1, len(coef)):
        coef[i] *= scale
    return Model(coef, DEGREE, radius)


def exact(one: Model, x: Fraction, y: Fraction) -> list[list[Fraction]]:
    """Value of the polynomial, without rounding."""
    powers = [x ** (t - k) * y**k for t in range(one.degree + 1) for k in range(t + 1)]
    rows, columns = one.shape
    return [
        [
            sum((Fraction(c[i, j]) * p for c, p in zip(one.coef, powers, strict=True)), Fraction(0))
            for j in range(columns)
        ]
        for i in range(rows)
    ]


def times(A: list[list[Fraction]], B: list[list[Fraction]]) -> list[list[Fraction]]:
    return [
        [sum((a * b for a, b in zip(row, col, strict=True)), Fraction(0)) for col in zip(*B, strict=True)] for row in A
    ]


def distance(A: list[list[Fraction]], B: list[list[Fraction]]) -> Fraction:
    """Square of the Frobenius norm of the difference."""
    return sum(((a - b) ** 2 for p, q in zip(A, B, strict=True) for a, b in zip(p, q, strict=True)), Fraction(0))


CORNERS = [(Fraction(a), Fraction(b)) for a, b in ((1, 1), (-1, 1), (1, -1), (0, 0))] + [
    (Fraction(1, 3), Fraction(-5, 7))
]


def test_a_product_of_models_holds_the_product_of_what_they_hold() -> None:
    """Each factor is off by its whole radius; what is cut at the degree and rounded is in the radius of the product."""
    A, B = model(3, 4, 1e-3), model(4, 2, 1e-2)
    for one in (A, B):
        one.coef[size(2) :] *= 0.1
    offsets = [RNG.normal(size=one.shape) for one in (A, B)]
    offsets = [one.radius * X / np.linalg.norm(X) * (1 - 1e-12) for one, X in zip((A, B), offsets, strict=True)]
    product = A @ B
    for x, y in CORNERS:
        factors = [
            [
                [a + Fraction(b) for a, b in zip(row, off, strict=True)]
                for row, off in zip(exact(one, x, y), X, strict=True)
            ]
            for one, X in zip((A, B), offsets, strict=True)
        ]
        assert distance(times(*factors), exact(product, x, y)) <= Fraction(product.radius) ** 2
    bare = A._replace(radius=0.0) @ B._replace(radius=0.0)
    cut = max(distance(times(exact(A, x, y), exact(B, x, y)), exact(bare, x, y)) for x, y in CORNERS)
    assert 0 < cut <= Fraction(bare.radius) ** 2


def test_the_radius_of_a_product_is_attained() -> None:
    """Functions with positive coefficients, off by their whole radius at (1, 1), leave nothing of the bound over."""
    A, B = model(1, 1, 1e-3), model(1, 1, 1e-2)
    A, B = (one._replace(coef=np.abs(one.coef)) for one in (A, B))
    product = A @ B
    one = Fraction(1)
    (((a,),), ((b,),), ((c,),)) = (exact(each, one, one) for each in (A, B, product))
    gap = (a + Fraction(A.radius)) * (b + Fraction(B.radius)) - c
    assert Fraction(0.999) * Fraction(product.radius) < gap <= Fraction(product.radius)


def test_rounding_is_in_the_radius() -> None:
    """Polynomials whose product is not cut: only rounding is left, and it is there."""
    A, B = model(3, 3), model(3, 3)
    for one in (A, B):
        one.coef[size(2) :] = 0.0
    Y, X = RNG.normal(size=(3, 3)), RNG.normal(size=(3, 3))
    found = {
        "product": (A @ B, lambda x, y: times(exact(A, x, y), exact(B, x, y))),
        "moved": (
            A.moved(0.3125, 0.25, -0.5, 0.125),
            lambda x, y: exact(A, Fraction(5, 16) + x / 4, y / 8 - Fraction(1, 2)),
        ),
        "between": (A.between(Y, X), lambda x, y: times(times(exactly(Y), exact(A, x, y)), exactly(X))),
        "combined": (
            combined([1 / 3, -1], [A, B]),
            lambda x, y: [
                [Fraction(1 / 3) * a - b for a, b in zip(p, q, strict=True)]
                for p, q in zip(exact(A, x, y), exact(B, x, y), strict=True)
            ],
        ),
    }
    for name, (one, truth) in found.items():
        errors = [distance(truth(x, y), exact(one, x, y)) for x, y in CORNERS]
        assert 0 < max(errors) <= Fraction(one.radius) ** 2, name
        assert one.radius < 1e-12, name


def exactly(X: Any) -> list[list[Fraction]]:
    return [[Fraction(x) for x in row] for row in X.tolist()]


def test_what_is_dropped_is_in_the_radius() -> None:
    A = model(2, 2, 1e-9, 1e-3)
    low = A.lowered(0.05)
    assert low.degree < DEGREE
    assert max(distance(exact(A, x, y), exact(low, x, y)) for x, y in CORNERS) <= Fraction(low.radius) ** 2


@pytest.mark.parametrize("shape", [(2, 2), (5, 3), (12, 12)])
def test_norms_are_bounds_and_sharp(shape: tuple[int, int]) -> None:
    for _ in range(20):
        X = RNG.normal(size=shape)
        true = float(np.linalg.norm(X, 2))
        assert true <= norm(X) <= 1.2 * true


@pytest.mark.parametrize(("a", "b", "degree"), [(0.3, 0.1, 4), (2.0, 0.0, 6), (1.5, 0.7, 12), (8.0, 1.0, 10)])
def test_the_tail_of_the_exponential_series(a: float, b: float, degree: int) -> None:
    """exp(a t + b t^2) = e^(a t) e^(b t^2): products of the coefficients of both, in rational numbers."""
    A, B = Fraction(a), Fraction(b)
    tail = Fraction(0)
    for i in range(60):
        for k in range(30):
            if i + 2 * k > degree:
                tail += A**i * B**k / (math.factorial(i) * math.factorial(k))
    assert tail <= Fraction(_tail(a, b, degree)) <= Fraction(3, 2) * tail


def polynomials(multipliers: list[complex], kind: Any) -> list[float]:
    """Return the signs of a constant matrix with these multipliers."""
    companion = np.array(np.real(np.poly(multipliers)), dtype=float)
    n = len(multipliers)
    A = np.diag(np.ones(n - 1), -1)
    A[0] = -companion[1:]
    coef = np.zeros((3, n, n))
    coef[0] = A
    return [float(one.coef[0, 0, 0]) for one in kind(elementary(Model(coef, 1)))]


def test_elementary_functions_are_those_of_the_multipliers() -> None:
    values = [0.3 + 0.4j, 0.3 - 0.4j, -0.7, 1.2]
    coef = np.zeros((3, 4, 4))
    V = RNG.normal(size=(4, 4))
    coef[0] = np.real(
        V @ np.array([[0.3, 0.4, 0, 0], [-0.4, 0.3, 0, 0], [0, 0, -0.7, 0], [0, 0, 0, 1.2]]) @ np.linalg.inv(V)
    )
    found = [one.coef[0, 0, 0] for one in elementary(Model(coef, 1))]
    np.testing.assert_allclose(found, np.real(np.poly(values)) * [1, -1, 1, -1, 1], atol=1e-10)


@pytest.mark.parametrize("count", [1, 2, 3, 4])
def test_damped_signs_tell_inside_from_outside(count: int) -> None:
    seen = set()
    for _ in range(150):
        moduli = RNG.uniform(0.5, 1.2, 4)
        mu: list[complex] = []
        while len(mu) < count:
            r = moduli[len(mu)]
            mu += (
                [r * np.exp(1j * a) for a in (lambda t: (t, -t))(RNG.uniform(0, np.pi))]
                if count - len(mu) > 1 and RNG.random() < 0.7
                else [r * RNG.choice([-1, 1])]
            )
        signs = polynomials(mu, damped_signs)
        inside = max(abs(m) for m in mu) < 1
        assert all(s > 0 for s in signs) == inside, (mu, signs)
        seen.add(inside)
    assert seen == {True, False}


def test_reciprocal_signs_tell_the_circle_from_elsewhere() -> None:
    def pair(kind: str) -> list[complex]:
        t = RNG.uniform(0.1, 3)
        r = 1 + RNG.uniform(0.05, 0.5)
        return {"circle": [np.exp(1j * t), np.exp(-1j * t)], "real": [r, 1 / r], "negative": [-r, -1 / r]}[kind]

    for _ in range(60):
        kinds = RNG.choice(["circle", "real", "negative"], 2, p=[0.6, 0.2, 0.2]).tolist()
        for some in (kinds[:1], kinds):
            signs = polynomials([m for kind in some for m in pair(kind)], reciprocal_signs)
            assert all(s > 0 for s in signs) == (set(some) == {"circle"})
        mu = (1 + RNG.uniform(0.01, 0.4)) * np.exp(1j * RNG.uniform(0.1, 3))
        assert min(polynomials([mu, mu.conjugate(), 1 / mu, 1 / mu.conjugate()], reciprocal_signs)) < 0


def test_an_isolated_block_has_the_multipliers_of_the_whole() -> None:
    """At random points: eigenvalues of A lie among those of the matrix, as near as the radius says."""
    N, m = 5, 2
    M = model(N, N)
    for t in range(1, DEGREE + 1):
        M.coef[size(t - 1) : size(t)] *= 0.02**t
    M.coef[0] = np.diag([0.1, 0.3, 2.0, 3.0, 4.0]) + 1e-3 * RNG.normal(size=(N, N))
    M.coef[0][:m, m:] = M.coef[0][m:, :m] = 0
    found = isolated(M, m)
    assert found is not None
    assert found.A.radius < 1e-6
    for x, y in RNG.uniform(-1, 1, (20, 2)):
        powers = [x ** (t - k) * y**k for t in range(DEGREE + 1) for k in range(t + 1)]
        whole, part = (np.tensordot(powers, one.coef, 1) for one in (M, found.A))
        near = np.sort(np.linalg.eigvals(whole).real)[:m]
        np.testing.assert_allclose(np.sort(np.linalg.eigvals(part).real), near, atol=50 * found.A.radius)
    assert isolated(M.widened(0.5), m) is None


def test_a_basis_that_is_no_inverse_is_refused() -> None:
    P, B = model(3, 3), RNG.normal(size=(3, 3))
    good = in_basis(P, B, np.linalg.inv(B))
    assert good is not None
    assert in_basis(P, B, np.eye(3)) is None
    rough = in_basis(P, B, np.linalg.inv(B) * (1 + 1e-6))
    assert rough is not None
    assert np.linalg.norm(rough.coef[0] - good.coef[0]) <= rough.radius


def test_definite_and_regular_hold_at_every_point() -> None:
    S = Model(np.zeros((3, 2, 2)), 1)
    S.coef[0] = [[2.0, 0.5], [0.5, 1.0]]
    S.coef[1] = 0.3 * np.eye(2)
    assert is_definite(S)
    assert is_regular(S)
    assert is_definite(S._replace(coef=-S.coef))
    for wide in (S.widened(0.9), S._replace(coef=S.coef + np.array([0, 0, 1])[:, None, None] * np.eye(2))):
        assert not is_definite(wide)
        assert not is_regular(wide)
    S.coef[0] = [[1.0, 3.0], [3.0, 1.0]]
    assert not is_definite(S)


def test_areas_and_lines_that_are_open() -> None:
    """g = xi - 1/4 eta^2, and g = xi^2: bands of known size."""
    straight, bent = np.zeros(6), np.zeros(6)
    straight[1], straight[5] = 1.0, -0.25
    bent[3] = 1.0
    assert 1e-3 <= open_part(straight, 2, 1e-3) <= 1.1e-3  # 2e-3 x 2 of 4
    assert np.sqrt(1e-6) <= open_part(bent, 2, 1e-6) <= 2.1 * np.sqrt(1e-6)
    first, degrees, radii = np.array([0, 6]), np.array([2]), np.array([1e-3])
    ((low, high),) = open_on_line(straight, first, degrees, radii, True, 0.8, 0.0)
    assert low <= 0.159
    assert high >= 0.161
    assert high - low < 2.001e-3
    assert open_on_line(straight, first, degrees, radii, False, 0.8, 0.0)[-1][1] == 1.0
