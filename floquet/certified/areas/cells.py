"""What is proved of a cell: one cluster after the other, then the whole (docs/certify.md, sections 8 and 9)."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from scipy.linalg import lapack, schur
from scipy.sparse.csgraph import connected_components

from floquet.certified.areas.coefficients import COEFFICIENT_ERROR, Coefficients
from floquet.certified.areas.isolation import defect, form_on, in_basis, is_definite, is_regular, isolated
from floquet.certified.areas.models import ROUNDING, SAFE, Model, combined, constant, frobenius, gamma, norm
from floquet.certified.areas.patches import Patch
from floquet.certified.areas.signs import LARGEST_CLUSTER, damped_signs, elementary, reciprocal_signs
from periodic.checks import FloatArray

# Multipliers nearer to each other than so many times the change of Phi over the cell are one cluster.
LINKS = (1.0, 4.0)
# Multipliers of a cluster that a definite form may decide.
LARGEST_DEFINITE = 8
# What is dropped from a polynomial may add this much to a radius that is smaller.
DROPPED = 1e-13


# A cell is halved whose polynomials have a radius above this, unless they leave hardly anything open.
SIGN_RADIUS = 1e-7


class Cell(NamedTuple):
    """The part |xi - x0| <= hx, |eta - y0| <= hy of a patch."""

    x0: float
    hx: float
    y0: float
    hy: float

    def halves(self, along_xi: bool) -> tuple[Cell, Cell]:
        """Return both halves; all numbers are dyadic, and so exact."""
        if along_xi:
            h = self.hx / 2
            return self._replace(x0=self.x0 - h, hx=h), self._replace(x0=self.x0 + h, hx=h)
        h = self.hy / 2
        return self._replace(y0=self.y0 - h, hy=h), self._replace(y0=self.y0 + h, hy=h)


class Sign(NamedTuple):
    """A polynomial in the cell's variables with its radius, and where it is from: which cluster, which sign of it."""

    coef: FloatArray
    radius: float
    cluster: int
    number: int

    @property
    def degree(self) -> int:
        """Degree of the polynomial."""
        return int((math.isqrt(8 * len(self.coef) + 1) - 3) // 2)


class Proof(NamedTuple):
    """What is proved of a cell.

    At every point: if a sign is below -radius, unstable; if ``whole`` and all signs are above their radius, stable.

    Attributes
    ----------
    whole : bool
        Whether ``signs`` are all that can be negative.
    signs : list of Sign
        Those that are not above their radius in the whole cell.
    basis : ndarray, shape (2n, 2n)
        B, cluster by cluster.
    sizes : list of int
        Multipliers in each cluster.
    along_xi : bool
        Which way to halve the cell.
    """

    whole: bool
    signs: list[Sign]
    basis: FloatArray
    sizes: list[int]
    along_xi: bool

    @property
    def is_stable(self) -> bool:
        """Whether every point is stable."""
        return self.whole and not self.signs

    @property
    def is_unstable(self) -> bool:
        """Whether every point is unstable."""
        return any(highest(sign) < -sign.radius for sign in self.signs)

    @property
    def radius(self) -> float:
        """The largest radius."""
        return max((sign.radius for sign in self.signs), default=0.0)


def highest(sign: Sign) -> float:
    """Return a bound of the polynomial from above."""
    rest = float(np.abs(sign.coef[1:]).sum())
    return float(sign.coef[0]) + rest + (abs(sign.coef[0]) + rest) * 2 * len(sign.coef) * ROUNDING


def lowest(sign: Sign) -> float:
    """Return a bound of the polynomial from below."""
    return -highest(sign._replace(coef=-sign.coef))


def proof_of(patch: Patch, cell: Cell, equation: Coefficients) -> Proof:
    """Return what is proved of a cell."""
    P = patch.model.moved(*cell)
    P = P.lowered(max(P.radius, DROPPED))
    T, Z = schur(P.coef[0], output="real")
    change = P.two() - norm(P.coef[0]) + P.radius
    along_xi = bool(frobenius(P.coef[1]) >= frobenius(P.coef[2]))
    best = Proof(False, [], Z, [len(T)], along_xi)
    reaches = [link * change for link in LINKS]
    if len(T) <= LARGEST_CLUSTER:
        # all multipliers together need not be isolated; only a definite form asks for the smallest clusters
        reaches = [math.inf] if equation.form is None else [reaches[0], math.inf]
    tried: set[tuple[int, ...]] = set()
    for reach in reaches:
        labels = _clusters(T, reach, equation.reciprocal)
        key = tuple(labels.tolist())
        if key in tried:
            continue
        tried.add(key)
        found = proof_in_basis(P, *_basis(T, Z, labels), equation, along_xi)
        if found is None:
            continue
        if found.is_unstable or (found.whole and found.radius <= SIGN_RADIUS):
            return found
        if (found.whole, bool(found.signs)) > (best.whole, bool(best.signs)):
            best = found
    return best


def _eigenvalues(T: FloatArray) -> np.ndarray:
    """Return the eigenvalues of a real Schur form, in its order."""
    N = len(T)
    mu = np.diag(T).astype(complex)
    for i in range(N - 1):
        if T[i + 1, i] != 0:
            mu[i : i + 2] += np.array([1j, -1j]) * np.sqrt(abs(T[i, i + 1] * T[i + 1, i]))
    return mu


def _clusters(T: FloatArray, reach: float, reciprocal: bool) -> np.ndarray:
    """Return to which cluster each multiplier belongs: with it its conjugate and, if ``reciprocal``, its inverse."""
    mu = _eigenvalues(T)
    near = np.abs(mu[:, None] - mu) <= reach
    i = np.arange(len(mu))
    near[i, np.abs(mu[:, None].conj() - mu).argmin(axis=1)] = True
    if reciprocal:
        near[i, np.abs(1 / mu[:, None] - mu).argmin(axis=1)] = True
    labels = connected_components(near, directed=False)[1]
    return np.asarray(labels)


def _basis(T: FloatArray, Z: FloatArray, labels: np.ndarray) -> tuple[FloatArray, list[int]]:
    """Return orthonormal bases of the clusters' invariant subspaces, one beside the other, and the clusters' sizes."""
    sizes = np.bincount(labels).tolist()
    B = np.empty_like(Z)
    at = 0
    for label, m in enumerate(sizes):
        chosen = (labels == label).astype(np.int32)
        Q = lapack.dtrsen(chosen, T, Z, job=b"N")[1] if m < len(T) else Z
        B[:, at : at + m] = Q[:, :m]
        at += m
    return B, sizes


def proof_in_basis(P: Model, B: FloatArray, sizes: list[int], equation: Coefficients, along_xi: bool) -> Proof | None:
    """Return what is proved with this basis of clusters, or None if it is singular."""
    try:
        Y = np.asarray(np.linalg.inv(B), dtype=np.float64)
    except np.linalg.LinAlgError:
        return None
    M = in_basis(P, B, Y)
    if M is None:
        return None
    signs: list[Sign] = []
    whole, joint, at = True, 0.0, 0
    most = LARGEST_CLUSTER if equation.form is None else LARGEST_DEFINITE
    for cluster, m in enumerate(sizes):
        order = np.concatenate([np.arange(at, at + m), np.arange(at), np.arange(at + m, len(B))])
        at += m
        mine = None
        if m <= most:
            turned = M._replace(coef=np.ascontiguousarray(M.coef[:, order[:, None], order]))
            mine = _signs_of(turned, B[:, order], Y[order], m, equation)
        if mine is None:
            whole = False
            continue
        found, reach = mine
        joint += reach * reach
        for number, one in enumerate(found):
            sign = Sign(one.coef.reshape(-1), one.radius, cluster, number)
            if not lowest(sign) > sign.radius:
                signs.append(sign)
    # bases of all the invariant subspaces together are I + Xi, of which this bounds Xi
    whole &= joint * SAFE < 1
    return Proof(whole, signs, B, sizes, along_xi)


def _signs_of(
    M: Model, B: FloatArray, Y: FloatArray, m: int, equation: Coefficients
) -> tuple[list[Model], float] | None:
    """Return the polynomials that decide the first m coordinates, and how far their subspace moves; None if none do."""
    found = isolated(M, m)
    if found is None:
        return None
    X, A = found
    reach = X.frobenius() + X.radius
    if equation.form is not None:
        fb = frobenius(B)
        error = (gamma(2 * len(B) + 2) + COEFFICIENT_ERROR) * fb * fb * frobenius(equation.form) * SAFE
        Q = form_on(B.T @ equation.form @ B, error, X)
        S = Q @ A
        if is_definite(combined([1, 1], [S, S.T])):
            return [], reach
        if m > LARGEST_CLUSTER or not is_regular(Q):
            return None
        return reciprocal_signs(elementary(A)), reach
    if not equation.reversible:
        return damped_signs(elementary(A)), reach
    e = elementary(A)
    return (reciprocal_signs(e), reach) if _is_mirrored(M, X, e[-1], B, Y) else None


def _is_mirrored(M: Model, X: Model, determinant: Model, B: FloatArray, Y: FloatArray) -> bool:
    """Return whether the cluster is its own image under mu -> 1 / mu, with determinant 1, at every point of the cell.

    If mu is in it and 1 / mu is not, R W x is in the invariant subspace [X'; I] of the others for an eigenvector W x,
    W = [I; X]: with R W = [C; D], C x = X' D x. That cannot be where C - X' D is regular.
    """
    if not lowest(Sign(determinant.coef.reshape(-1), determinant.radius, 0, 0)) > determinant.radius:
        return False
    m, N = X.shape[1], len(B)
    if m == N:
        return True
    turned = np.roll(np.arange(N), N - m)
    others = isolated(M._replace(coef=np.ascontiguousarray(M.coef[:, turned[:, None], turned])), N - m)
    if others is None:
        return False
    # B^-1 R B; the entries of R are -1 and 1
    e = defect(Y, B)
    signs = np.repeat([-1.0, 1.0], N // 2)
    R = (Y * signs) @ B
    error = (gamma(N + 2) + e / (1 - e)) * frobenius(Y) * frobenius(B) * SAFE**2
    first, rest = slice(None, m), slice(m, None)
    C, D = (
        combined([1, 1], [constant(R[rows, first], X.degree), constant(R[rows, rest], X.degree) @ X])
        for rows in (first, rest)
    )
    slack = error * (1 + X.two() + X.radius)
    below = (others.X.frobenius() + others.X.radius) * (D.frobenius() + D.radius + slack)
    return is_regular(C.widened(slack + below))
