"""Polynomials whose signs decide whether the multipliers of a cluster are on or in the unit circle (section 9)."""

from __future__ import annotations

import math

import numpy as np

from floquet.certified.areas.models import SAFE, TINY, Model, combined, constant, gamma

# Multipliers of a cluster that polynomials decide.
LARGEST_CLUSTER = 4


def elementary(A: Model) -> list[Model]:
    """Return e_0, .., e_m with det(z - A) = e_0 z^m - e_1 z^(m-1) + e_2 z^(m-2) - ..., by Newton's identities."""
    m = A.shape[0]
    bare = A._replace(radius=0.0)
    square = bare @ bare if m > 1 else bare
    powers = [bare, square]
    if m > 2:
        powers += [square @ bare, square @ square]
    largest = (A.frobenius() + A.radius) * SAFE
    traces = []
    for k, P in enumerate(powers[:m], start=1):
        coef = np.trace(P.coef, axis1=1, axis2=2).reshape(-1, 1, 1)
        # |tr R| <= sqrt(m) |R|; an error of A in one of k factors after the other
        radius = math.sqrt(m) * (P.radius + k * A.radius * largest ** (k - 1) + gamma(m + 1) * P.frobenius())
        traces.append(Model(np.ascontiguousarray(coef), A.degree, radius * SAFE + TINY))
    e = [constant([[1.0]], A.degree)]
    for k in range(1, m + 1):
        terms = [e[k - i] @ traces[i - 1] for i in range(1, k + 1)]
        e.append(combined([(-1.0) ** (i - 1) / k for i in range(1, k + 1)], terms))
    return e


def reciprocal_signs(e: list[Model]) -> list[Model]:
    """Return what is all positive where the multipliers are on the circle and distinct, and negative only elsewhere.

    det(z - A) = z^2 - s z + 1, or (z^2 - s_1 z + 1)(z^2 - s_2 z + 1) with e_1 = s_1 + s_2, e_2 = 2 + s_1 s_2. All s
    must be real, distinct, and between -2 and 2.
    """
    if len(e) == 3:
        return [combined([2, -1], e[:2]), combined([2, 1], e[:2])]
    return [
        combined([2, -2, 1], e[:3]),  # (2 - s_1)(2 - s_2)
        combined([2, 2, 1], e[:3]),  # (2 + s_1)(2 + s_2)
        combined([4, -1], e[:2]),
        combined([4, 1], e[:2]),
        combined([8, 1, -4], [e[0], e[1] @ e[1], e[2]]),  # (s_1 - s_2)^2
    ]


def damped_signs(e: list[Model]) -> list[Model]:
    """Return what is all positive where the multipliers are inside the circle, and negative only if one is outside.

    With z = (1 + w) / (1 - w) det(z - A) (1 - w)^m is c_m w^m + ... + c_0, whose roots have to be in the left half
    plane: Lienard's and Chipart's conditions.
    """
    m = len(e) - 1
    plus, minus = np.poly1d([1.0, 1.0]), np.poly1d([-1.0, 1.0])
    # e_k z^(m-k) becomes (-1)^k e_k (1 + w)^(m-k) (1 - w)^k; the weights are whole numbers
    weights = np.array([np.asarray(plus ** (m - k) * minus**k)[::-1] * (-1.0) ** k for k in range(m + 1)])
    c = [combined(weights[:, power].tolist(), e) for power in range(m + 1)]
    if m <= 2:
        return c
    # Hurwitz' determinant, divided by a power of two: the product of all 1 - z_i z_j, i < j
    if m == 3:
        return [*c, combined([1 / 8, -1 / 8], [c[1] @ c[2], c[0] @ c[3]])]
    minor = combined([1 / 64, -1 / 64], [c[1] @ c[2], c[0] @ c[3]])
    return [c[0], c[2], c[3], c[4], combined([1, -1 / 64], [c[3] @ minor, c[4] @ (c[1] @ c[1])])]
