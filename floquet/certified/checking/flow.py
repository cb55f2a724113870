"""The monodromy matrix over a patch, by other steps and other bounds than those of the certificate."""

from __future__ import annotations

import math
from typing import Any

from flint import arb, arb_mat, fmpq

from floquet.certified.checking.arithmetic import UNIT, Model, degrees, mul, rows_norm, size, total

# Length of a step times the norm, angle of a harmonic in a step, order of a step.
STEP_SIZE, ANGLE, SERIES_ORDER = 0.7, 0.7, 24


def monodromy(A: arb_mat, waves: list[tuple[int, bool, arb_mat]], quarter: bool, patch: list[float], d: int) -> Model:
    """The model of the flow over a period, from theta = 0 or pi / 2."""
    l0, h1, e0, h2 = map(arb, patch)
    a, f = rows_norm(A), [rows_norm(X) for _, _, X in waves]
    high = max((j for j, _, _ in waves), default=1)
    N = max(
        2,
        math.ceil(
            2 * math.pi * max(float((l0 + h1) * (a + (abs(e0) + h2) * sum(f, arb(0)))) / STEP_SIZE, high / ANGLE)
        ),
    )
    k = 2 * arb.pi() / N

    def phi(rho: Any) -> arb:
        return sum(((j * k * rho).expm1() / (j * k) * n for (j, _, _), n in zip(waves, f, strict=True)), arb(0))

    # the coefficients of X are at most those of exp k (l0 + h1 xi) (a s + (|e0| + h2 eta) phi(s))
    bounds = [
        ((l0 + h1) * k * (a * rho + (abs(e0) + h2) * phi(arb(rho))) - SERIES_ORDER * arb(rho).log()).exp() / (rho - 1)
        for rho in range(2, 30)
    ]
    time = min((one.upper() for one in bounds), key=float)
    inner = a + abs(e0) * phi(arb(1))
    p, q = k * (h1 * inner + l0 * h2 * phi(arb(1))), k * h1 * h2 * phi(arb(1))
    c, older = [arb(1)], arb(0)
    for m in range(1, d + 1):
        c, older = [*c, (p * c[-1] + 2 * q * older) / m], c[-1]
    tail = (k * l0 * inner).exp() * ((p + q).exp() - sum(c, arb(0)))
    n = A.nrows()
    error = arb_mat(n, n, [(2 * time + abs(tail).upper()) * UNIT] * n**2)
    one = arb_mat([[int(i == j) for j in range(n)] for i in range(n)])
    factors = []
    for m in range(N):
        tables = []
        for j, is_sine, _ in waves:
            angle = fmpq(2 * j * m, N) + (fmpq(j, 2) if quarter else 0) - (fmpq(1, 2) if is_sine else 0)
            tables.append(
                [
                    (j * k) ** i / math.factorial(i) * arb.cos_pi_fmpq(angle + fmpq(i, 2))
                    for i in range(SERIES_ORDER + 1)
                ]
            )
        X = [[one] + [arb_mat(n, n)] * (size(d) - 1)]
        for i in range(SERIES_ORDER):
            Y = [A * Z for Z in X[i]]
            for (_, _, F), table in zip(waves, tables, strict=True):
                for at, (t, kk) in enumerate(degrees(X[0])):
                    if t > 2 * i:
                        break
                    V = F * total([X[i - u][at] * table[u] for u in range(i + 1) if t <= 2 * (i - u)], one)
                    Y[at] = Y[at] + V * e0
                    if t < d:
                        Y[size(t) + kk + 1] = Y[size(t) + kk + 1] + V * h2
            Z = [U * (l0 * k / (i + 1)) for U in Y]
            for at, (t, kk) in enumerate(degrees(Y)):
                if t < d and t <= 2 * i + 1:
                    Z[size(t) + kk] = Z[size(t) + kk] + Y[at] * (h1 * k / (i + 1))
            X.append(Z)
        step = [total([Z[at] for Z in X], one) for at in range(size(d))]
        factors.append([step[0] + error, *step[1:]])
    while len(factors) > 1:
        joined = [mul(later, earlier) for earlier, later in zip(factors[::2], factors[1::2], strict=False)]
        factors = joined + factors[2 * len(joined) :]
    return factors[0]
