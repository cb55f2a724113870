"""Models in ball arithmetic: lists of ball matrices, those of xi^j eta^k by degree j + k and then by k.

A model stands for all functions whose values at every |xi|, |eta| <= 1 are sums of these monomials with matrices out of
the balls. What is cut goes to the ball of the constant.
"""

from __future__ import annotations

import math
from typing import Any

from flint import arb, arb_mat

UNIT = arb(0, 1)
Model = list[arb_mat]


def size(d: int) -> int:
    return (d + 1) * (d + 2) // 2


def degrees(P: Model) -> list[tuple[int, int]]:
    return [(t, k) for t in range((math.isqrt(8 * len(P) + 1) - 1) // 2) for k in range(t + 1)]


def moduli(X: arb_mat) -> arb_mat:
    return arb_mat(X.nrows(), X.ncols(), [abs(x).upper() for x in X.entries()])


def total(X: list[arb_mat], like: arb_mat) -> arb_mat:
    return sum(X, arb_mat(like.nrows(), like.ncols()))


def spread(P: Model) -> arb_mat:
    """Values of the model at all points."""
    return total([moduli(X) * UNIT for X in P[1:]], P[0]) + P[0]


def cut(P: Model, d: int) -> Model:
    return [P[0] + total([moduli(X) * UNIT for X in P[size(d) :]], P[0]), *P[1 : size(d)]]


def mul(P: Model, Q: Model) -> Model:
    if len(Q) < len(P):
        Q = Q + [Q[0] * 0] * (len(P) - len(Q))
    d = degrees(P)[-1][0]
    zero = P[0] * 0 * Q[0]
    zero = arb_mat(zero.nrows(), zero.ncols())
    out = [zero] * len(P)
    where = list(zip(degrees(P), P, strict=True)), list(zip(degrees(Q), Q, strict=True))
    filled = [[((t, k), X) for (t, k), X in one if any(x != 0 or x.rad() != 0 for x in X.entries())] for one in where]
    for (t, k), X in filled[0]:
        for (s, m), Y in filled[1]:
            if t + s <= d:
                at = size(t + s - 1) + k + m
                out[at] = out[at] + X * Y
    tops = [
        [total([moduli(X) for (t, _), X in one if t == s], one[0][1]) if one else None for s in range(d + 1)]
        for one in filled
    ]
    for i, A in enumerate(tops[0]):
        for j, B in enumerate(tops[1]):
            if i + j > d and A is not None and B is not None:
                out[0] = out[0] + A * B * UNIT
    return out


def add(P: Model, Q: Model, factor: Any = 1) -> Model:
    return [X + Y * factor for X, Y in zip(P, Q, strict=True)]


def const(X: arb_mat, like: Model) -> Model:
    return [X] + [arb_mat(X.nrows(), X.ncols())] * (len(like) - 1)


def part(P: Model, rows: range, columns: range) -> Model:
    return [
        arb_mat([[X[i, j] for j in columns] for i in rows]) if rows and columns else arb_mat(len(rows), len(columns))
        for X in P
    ]


def moved(P: Model, x0: float, hx: float, y0: float, hy: float) -> Model:
    out, d = list(P), degrees(P)[-1][0]
    for a in range(d + 1):
        for i in range(d - a):
            for b in range(d - a - 1, i - 1, -1):
                t = a + b
                out[size(t - 1) + a] += out[size(t) + a] * arb(x0)
    for a in range(d + 1):
        for i in range(d - a):
            for b in range(d - a - 1, i - 1, -1):
                t = a + b
                out[size(t - 1) + b] += out[size(t) + b + 1] * arb(y0)
    return [X * (arb(hx) ** (t - k) * arb(hy) ** k) for (t, k), X in zip(degrees(P), out, strict=True)]


def rows_norm(X: arb_mat) -> arb:
    return max((sum(map(abs, row), arb(0)).upper() for row in X.tolist()), key=float, default=arb(0))
