"""From an enclosed monodromy matrix to discs that contain its multipliers, and proofs that all are on the unit circle.

docs/certify.md, section 3, has the proofs.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from flint import acb, acb_mat, arb, arb_mat, ctx
from scipy.sparse.csgraph import connected_components

from floquet.certified.equation import norm

# Angles of multipliers closer than this, in radians, are one angle to the choice of an invariant form. The form then
# need not tell them apart; if it must, they are told apart as simple multipliers.
MIN_ANGLE_DIFFERENCE = 1e-6
# The matrix is perturbed by this many bits above its rounding, so that multiple multipliers come apart by more than the
# QR algorithm neglects.
PERTURBATION_BITS = 16


class Discs(NamedTuple):
    """Discs that contain the multipliers: every union of k discs disjoint from the others contains exactly k.

    Attributes
    ----------
    centres : list of flint.acb
    radii : list of flint.arb
    vectors : flint.acb_mat
        Approximate eigenvectors, column by column.
    """

    centres: list[acb]
    radii: list[arb]
    vectors: acb_mat


def enclosed_spectrum(Phi: arb_mat) -> Discs | None:
    """Return Gershgorin's discs of Phi in a basis of approximate eigenvectors, or None if that basis is singular."""
    size = Phi.nrows()
    fuzz = norm(Phi) * arb(2) ** (PERTURBATION_BITS - ctx.prec) + sum((entry.rad() for entry in Phi.entries()), arb(0))
    random = np.random.default_rng(0).uniform(-1.0, 1.0, size**2)
    nearby = (Phi + arb_mat(size, size, [fuzz * x for x in random.tolist()])).mid()
    try:
        columns = acb_mat(nearby).eig(right=True, algorithm="approx")[1].transpose().tolist()
        # of equal length: otherwise one disc would be small at the cost of another
        vectors = acb_mat([[x / sum(map(abs, column)) for x in column] for column in columns]).transpose().mid()
        with ctx.extraprec(ctx.prec):  # at a boundary the vectors are parallel to half the digits
            similar = (vectors.inv() * acb_mat(Phi) * vectors).tolist()
    except (ValueError, ZeroDivisionError):
        return None
    if not all(entry.is_finite() for row in similar for entry in row):
        return None
    centres = [similar[i][i] for i in range(size)]
    radii = [sum((abs(x) for j, x in enumerate(similar[i]) if j != i), arb(0)).upper() for i in range(size)]
    return Discs(centres, radii, vectors)


def largest_modulus(spectrum: Discs) -> tuple[arb, arb]:
    """Return a lower and an upper bound of max|mu|."""
    centres, radii, _ = spectrum
    discs = list(zip(centres, radii, strict=True))
    touching = np.array([[not abs(c - d) > r + s for d, s in discs] for c, r in discs])
    count, label = connected_components(touching, directed=False)
    # each union of touching discs holds a multiplier, which may be at its point next to zero
    inner = [(abs(c) - r).lower() for c, r in discs]
    least = max(min(bound for bound, part in zip(inner, label, strict=True) if part == union) for union in range(count))
    return least, max((abs(c) + r).upper() for c, r in discs)


def on_unit_circle(spectrum: Discs) -> bool:
    """Return whether every multiplier is simple and of modulus 1, if with every mu 1 / conj(mu) is a multiplier.

    A disc disjoint from all others holds one multiplier mu. If its image under reflection in the unit circle is
    disjoint from the others as well, then 1 / conj(mu) can be in no other disc, so it is mu.
    """
    for i, (centre, radius) in enumerate(zip(spectrum.centres, spectrum.radii, strict=True)):
        box = centre + acb(radius * arb(0, 1), radius * arb(0, 1))
        image = 1 / box.conjugate()
        for j, (other, reach) in enumerate(zip(spectrum.centres, spectrum.radii, strict=True)):
            if j != i and not (abs(box - other) > reach and abs(image - other) > reach):
                return False
    return True


def has_definite_form(Phi: arb_mat, J: arb_mat, spectrum: Discs) -> bool:
    """Return whether z^T B z, B = Y + Y^T with Y = J p(Phi), is proved positive definite for some real polynomial p.

    Phi^T J Phi = J gives Phi^T Y Phi = Y: B is invariant, and if definite it keeps every motion bounded. On an
    eigenvector x with mu = e^{i theta} the form is -2 kappa Im p(mu), where i kappa = x^H J x; p is chosen to make
    Im p(mu) = -sign(kappa) sin theta. That can be done if and only if the system is strongly stable (Krein).
    """
    n = Phi.nrows() // 2
    columns = spectrum.vectors.transpose().tolist()
    upper = [(complex(mu), x) for mu, x in zip(spectrum.centres, columns, strict=True) if mu.imag > 0]
    if len(upper) != n:
        return False
    form = np.array([[float(entry) for entry in row] for row in J.tolist()])
    vectors = np.array([[complex(entry) for entry in x] for _, x in upper])
    kappa = np.einsum("li,ij,lj->l", vectors.conj(), form, vectors).imag
    angle = np.angle([mu for mu, _ in upper])
    powers = np.arange(1, n + 1)
    # Im p(mu) / sin theta = sum_k c_k sin(k theta) / sin theta
    ratios = np.sin(np.outer(angle, powers)) / np.sin(angle)[:, None]
    c = np.linalg.lstsq(ratios, -np.sign(kappa), rcond=MIN_ANGLE_DIFFERENCE)[0]
    polynomial = arb_mat(2 * n, 2 * n)
    for coefficient in c[::-1].tolist():
        polynomial = (polynomial + arb(coefficient) * arb_mat(np.eye(2 * n).tolist())) * Phi
    Y = J * polynomial
    return _is_positive_definite(Y + Y.transpose())


def is_definite(form: arb_mat) -> bool:
    """Return whether the symmetric matrix in this ball is proved positive or negative definite."""
    return _is_positive_definite(form) or _is_positive_definite(-form)


def _is_positive_definite(matrix: arb_mat) -> bool:
    """Return whether every pivot of the symmetric matrix in this ball is proved positive."""
    a = matrix.tolist()
    for k, row in enumerate(a):
        if not row[k] > 0:
            return False
        for other in a[k + 1 :]:
            factor = other[k] / row[k]
            for j in range(k + 1, len(a)):
                other[j] -= factor * row[j]
    return True
