"""The claims of one cell."""

from __future__ import annotations

import math
from typing import Any

from flint import arb, arb_mat

from floquet.certified.checking.arithmetic import (
    UNIT,
    Model,
    add,
    const,
    degrees,
    moved,
    mul,
    part,
    rows_norm,
    size,
    spread,
    total,
)
from floquet.certified.checking.reading import Refused, demand

# How often a cell is cut into four for its clusters to be seen isolated.
QUARTERINGS = 3


class NotIsolated(Refused):
    """A cluster may be isolated, but that is not seen by these bounds."""


def isolated(M: Model, m: int) -> tuple[Model, Model]:
    """X and A: the columns of [I; X] span an invariant subspace, on which M acts as A."""
    I, K = range(m), range(m, M[0].nrows())
    II, IK, KI, KK = (part(M, rows, columns) for rows in (I, K) for columns in (I, K))
    if not K:
        return [arb_mat(0, m)] * len(M), M
    a, b, places = KK[0].mid(), II[0].mid(), [(i, j) for i in K for j in I]

    def sylvester(outer: arb_mat, inner: arb_mat) -> arb_mat:
        """The matrix of H -> outer H - H inner."""
        return arb_mat(
            [
                [(outer[i - m, p - m] if j == q else arb(0)) - (inner[q, j] if i == p else arb(0)) for p, q in places]
                for i, j in places
            ]
        )

    L = sylvester(a, b)
    inverse = L.inv()

    def residual(X: Model, blocks: list[Model]) -> Model:
        II, IK, KI, KK = blocks
        return add(add(add(KI, mul(KK, X)), mul(X, II), -1), mul(X, mul(IK, X)), -1)

    X = [arb_mat(len(K), m)] * len(M)
    for p in range(1, degrees(M)[-1][0] + 1):  # each pass gains a degree
        blocks = [[Z.mid() for Z in P[: size(p)]] for P in (II, IK, KI, KK)]
        for at, R in enumerate(residual(X[: size(p)], blocks)):
            change = inverse * arb_mat(len(places), 1, R.mid().entries())
            X[at] = (X[at] - arb_mat(len(K), m, change.entries())).mid() if at else X[at]
    wrong = inverse * arb_mat(len(places), 1, spread(residual(X, [II, IK, KI, KK])).entries())
    eta = max((abs(x).upper() for x in wrong.entries()), key=float)
    outer, inner = spread(add(KK, mul(X, IK), -1)) - a, spread(add(II, mul(IK, X))) - b
    alpha = rows_norm(inverse * sylvester(outer, inner))
    bent = rows_norm(inverse) * sum((abs(x) for x in spread(IK).entries()), arb(0))
    if not (alpha < 1 and (1 - alpha) ** 2 > 4 * bent * eta):
        raise NotIsolated("a cluster is not isolated")
    beta = (2 * eta / (1 - alpha + ((1 - alpha) ** 2 - 4 * bent * eta).sqrt())).upper()
    X = [X[0] + arb_mat(len(K), m, [beta * UNIT] * len(places)), *X[1:]]
    return X, add(II, mul(IK, X))


def definite(S: arb_mat) -> bool:
    a = S.tolist()
    for k, row in enumerate(a):
        if not row[k] > 0:
            return False
        for other in a[k + 1 :]:
            factor = other[k] / row[k]
            for j in range(k, len(a)):
                other[j] -= factor * row[j]
    return True


def signs(A: Model, reciprocal: bool) -> tuple[list[Model], Model]:
    """The polynomials of section 9, and the determinant, by Faddeev and Leverrier's recursion."""
    m = A[0].nrows()
    demand(m <= 4, "a cluster is too large")
    one = arb_mat([[int(i == j) for j in range(m)] for i in range(m)])
    P, e = const(one, A), [const(arb_mat([[1]]), A)]
    for k in range(1, m + 1):
        P = mul(A, P)
        e.append([arb_mat([[sum((X[i, i] for i in range(m)), arb(0)) * (-1) ** (k + 1) / k]]) for X in P])
        P = [X - one * (Y[0, 0] * (-1) ** (k + 1)) for X, Y in zip(P, e[-1], strict=True)]

    def mix(*weights: Any) -> Model:
        return [total([E[at] * w for w, E in zip(weights, e, strict=False)], e[0][0]) for at in range(len(A))]

    if reciprocal and m == 2:
        return [mix(2, -1), mix(2, 1)], e[-1]
    if reciprocal:
        return [mix(2, -2, 1), mix(2, 2, 1), mix(4, -1), mix(4, 1), add(mix(8, 0, -4), mul(e[1], e[1]))], e[-1]
    c = []
    for power in range(m + 1):
        ways = [
            sum(math.comb(m - k, power - i) * math.comb(k, i) * (-1) ** i for i in range(power + 1) if power >= i)
            for k in range(m + 1)
        ]
        c.append(mix(*((-1) ** k * w for k, w in enumerate(ways))))
    if m < 3:
        return c, e[-1]
    minor = add(mul(c[1], c[2]), mul(c[0], c[3]), -1)
    if m == 3:
        return [*c, [X / 8 for X in minor]], e[-1]
    largest = add(mul(c[3], minor), mul(c[4], mul(c[1], c[1])), -1)
    return [c[0], c[2], c[3], c[4], [X / 64 for X in largest]], e[-1]


def cell(
    P: Model,
    B: arb_mat,
    sizes: list[int],
    listed: dict[tuple[int, int], tuple[Model, float]],
    whole: bool,
    J: arb_mat | None,
    reversible: bool,
    quarterings: int = QUARTERINGS,
) -> None:
    """Check every claim of a cell; of its quarters, if a cluster is not seen to be isolated in the whole."""
    try:
        _cell(P, B, sizes, listed, whole, J, reversible)
    except NotIsolated:
        if not quarterings:
            raise
        for x in (-0.5, 0.5):
            for y in (-0.5, 0.5):
                quarter = (x, 0.5, y, 0.5)
                signs = {key: (moved(coef, *quarter), radius) for key, (coef, radius) in listed.items()}
                cell(moved(P, *quarter), B, sizes, signs, whole, J, reversible, quarterings - 1)


def _cell(
    P: Model,
    B: arb_mat,
    sizes: list[int],
    listed: dict[tuple[int, int], tuple[Model, float]],
    whole: bool,
    J: arb_mat | None,
    reversible: bool,
) -> None:
    """Check every claim of a cell."""
    N, inverse, start = B.nrows(), B.inv(), 0
    demand(all(m > 0 for m in sizes) and sum(sizes) == N, "clusters do not add up")
    demand(all(0 <= cluster < len(sizes) for cluster, _ in listed), "a sign is of no cluster")
    subspaces = []
    for cluster, m in enumerate(sizes):
        order = [*range(start, start + m), *range(start), *range(start + m, N)]
        start += m
        mine = {number: one for (c, number), one in listed.items() if c == cluster}
        if not (whole or mine):
            continue
        turned = [arb_mat([[X[i, j] for j in order] for i in order]) for X in (inverse * Y * B for Y in P)]
        X, A = isolated(turned, m)
        W = [
            arb_mat([*([int(at == 0 and i == j) for j in range(m)] for i in range(m)), *Y.tolist()])
            for at, Y in enumerate(X)
        ]
        subspaces += [[row[order.index(i)] for i in range(N)] for row in spread(W).transpose().tolist()]
        if J is not None:
            turn = arb_mat([[B[i, j] for j in order] for i in range(N)])
            Q = mul([Y.transpose() for Y in W], mul(const(turn.transpose() * J * turn, W), W))
            S = mul(Q, A)
            form = spread(add(S, [Y.transpose() for Y in S]))
            if not mine and (definite(form) or definite(form * -1)):
                continue
            demand(not spread(Q).det().contains(0), "a cluster is not closed under inversion")
        elif reversible and m < N:
            Z = isolated(
                [
                    arb_mat([[X[i, j] for j in (*range(m, N), *range(m))] for i in (*range(m, N), *range(m))])
                    for X in turned
                ],
                N - m,
            )[0]
            mirror = arb_mat([[(-1 if 2 * i < N else 1) * B[i, j] for j in order] for i in range(N)])
            R = mul(const(arb_mat([inverse.tolist()[i] for i in order]) * mirror, W), W)
            C, D = part(R, range(m), range(m)), part(R, range(m, N), range(m))
            demand(not spread(add(C, mul(Z, D), -1)).det().contains(0), "a cluster is not closed under inversion")
        found, determinant = signs(A, J is not None or reversible)
        demand(J is not None or not reversible or spread(determinant)[0, 0] > 0, "a determinant is not 1")
        demand(all(number in range(len(found)) for number in mine), "there is no such sign")
        for number, g in enumerate(found):
            if number in mine:
                coef, radius = mine[number]
                own = [X[0, 0] for X in g]
                said = [X[0, 0] for X in coef] + [arb(0)] * len(own)
                off = sum((abs(x - y) for x, y in zip(own, said, strict=False)), arb(0))
                demand(len(coef) <= len(own) and off <= radius, "a polynomial is not within its radius")
            elif whole:
                demand(spread(g)[0, 0] > 0, "a sign that is not listed is not positive")
    demand(not whole or not arb_mat(subspaces).det().contains(0), "the subspaces do not span the space")
