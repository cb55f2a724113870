"""Proved bounds of the growth rate and a proved verdict at one point (Omega, eps); docs/certify.md has the proofs.

Needs python-flint, the extra ``certify``: ``from floquet.certified.growth import certified_growth``.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from enum import StrEnum
from typing import NamedTuple

import numpy as np
from scipy.sparse.csgraph import connected_components

from periodic import PeriodicSystem, SystemFamily
from periodic.checks import real_number, whole_number

try:
    from flint import acb, acb_mat, arb, arb_mat, ctx
except ModuleNotFoundError:
    raise ImportError(
        "floquet.certified needs python-flint; install the extra certify: pip install 'floquet-charts[certify]'"
    ) from None

from floquet.certified.enclosure import Equation, blocks, equation_of_motion, flow, norm

# Decides nearly every point; each further doubling of the precision costs about four times as much.
FIRST_BITS = 128
LEAST_BITS, MOST_BITS = 64, 2048
# Angles of multipliers closer than this are one angle to the choice of an invariant form. The form then need not tell
# them apart; if it must, they are told apart as simple multipliers.
SAME_ANGLE = 1e-6


class Verdict(StrEnum):
    """What is proved about the solutions at one (Omega, eps)."""

    STABLE = "stable"
    UNSTABLE = "unstable"
    UNDECIDED = "undecided"


@dataclass(frozen=True)
class CertifiedGrowth:
    """Proved bounds of the growth rate max log|mu| / T at one (Omega, eps).

    Attributes
    ----------
    lower, upper : float
        The growth rate lies in [lower, upper], in the units of Omega; rounded outwards.
    verdict : Verdict
        STABLE: every solution is bounded for t >= 0. UNSTABLE: some solution grows exponentially. UNDECIDED: neither
        could be proved with the precision allowed, as happens on a boundary of stability itself.
    bits : int
        Working precision at which the verdict fell, or the highest that was tried.
    reason : str
        How it was decided, or why not.
    """

    lower: float
    upper: float
    verdict: Verdict
    bits: int
    reason: str


def certified_monodromy(family: SystemFamily, Omega: float, eps: float, *, bits: int = FIRST_BITS) -> arb_mat:
    """Return a rigorous enclosure of the monodromy matrix over T = 2 pi / Omega.

    Parameters
    ----------
    family : SystemFamily
        A `PeriodicSystem`, or anything whose ``at(Omega)`` returns one; its entries are taken as exact binary numbers.
    Omega : float
        Excitation frequency, positive, in the units of the system; exact.
    eps : float
        Relative excitation amplitude, any sign, dimensionless; exact.
    bits : int
        Working precision, 64 to 2048. More bits give a narrower enclosure; every enclosure is valid.

    Returns
    -------
    flint.arb_mat, shape (2n, 2n)
        Phi with q(T) = Phi q(0), q = (W', W). Its entries are balls, with the methods ``mid()`` and ``rad()``.

    Raises
    ------
    ValueError
        If an argument is wrong, or n and the number of steps in a period are too large for ball arithmetic.
    """
    system, Omega, eps = _checked(family, Omega, eps)
    bits = whole_number("bits", bits, least=LEAST_BITS, most=MOST_BITS)
    with ctx.workprec(bits):
        equation = equation_of_motion(system, Omega, eps)
        zero = arb_mat(system.size, system.size)
        to_q = blocks([[equation.basis, zero], [zero, equation.basis / equation.scale]])
        return to_q * flow(equation, bits) * to_q.inv()


def certified_growth(
    family: SystemFamily, Omega: float, eps: float, *, max_bits: int = 4 * FIRST_BITS
) -> CertifiedGrowth:
    """Return proved bounds of the growth rate and a proved verdict, raising the precision until one falls.

    Parameters
    ----------
    family, Omega, eps
        As for `certified_monodromy`.
    max_bits : int
        Highest working precision, 128 to 2048. The first is 128; each attempt has twice the one before.

    Returns
    -------
    CertifiedGrowth

    Raises
    ------
    ValueError
        As `certified_monodromy`.

    Notes
    -----
    python-flint keeps one working precision for the whole process: do not call this from several threads at once.
    """
    system, Omega, eps = _checked(family, Omega, eps)
    max_bits = whole_number("max_bits", max_bits, least=FIRST_BITS, most=MOST_BITS)
    parts = [_growth_of_block(block, Omega, eps, max_bits) for block in _independent_blocks(system, eps)]
    verdicts = {part.verdict for part in parts}
    verdict = next((v for v in (Verdict.UNSTABLE, Verdict.UNDECIDED) if v in verdicts), Verdict.STABLE)
    deciding = [part for part in parts if part.verdict is verdict]
    return CertifiedGrowth(
        lower=max(part.lower for part in parts),
        upper=max(part.upper for part in parts),
        verdict=verdict,
        bits=max(part.bits for part in deciding),
        reason="; ".join(dict.fromkeys(part.reason for part in deciding)),
    )


def _checked(family: SystemFamily, Omega: float, eps: float) -> tuple[PeriodicSystem, float, float]:
    Omega = real_number("Omega", Omega, positive=True)
    eps = real_number("eps", eps)
    if not callable(getattr(family, "at", None)):
        raise ValueError(f"family = {family!r} has no method at(Omega); give a PeriodicSystem or a family of them")
    system = family.at(Omega)
    if not isinstance(system, PeriodicSystem):
        raise ValueError(f"family.at({Omega!r}) returned {system!r}; it must return a PeriodicSystem")
    return system, Omega, eps


def _independent_blocks(system: PeriodicSystem, eps: float) -> Iterator[PeriodicSystem]:
    """Yield the subsystems that exact zeros in all matrices keep apart; their multipliers are the system's."""
    constant = (system.mass, system.gyroscopic, system.damping, system.stiffness)
    excitation = (*system.cosine, *system.sine) if eps else ()
    coupled = np.any(np.array((*constant, *excitation)) != 0, axis=0)
    count, label = connected_components(coupled, directed=False)
    for block in range(count):
        index = np.flatnonzero(label == block)
        part = np.ix_(index, index)
        M, G, C, K = (matrix[part] for matrix in constant)
        Fc, Fs = (matrices[:, part[0], part[1]] for matrices in (system.cosine, system.sine))
        yield PeriodicSystem(M, G, C, K, Fc, Fs)


def _growth_of_block(system: PeriodicSystem, Omega: float, eps: float, max_bits: int) -> CertifiedGrowth:
    bits = FIRST_BITS
    while True:
        with ctx.workprec(bits):
            equation = equation_of_motion(system, Omega, eps)
            if not equation.F:
                # nothing has the period, so any will do: in a short one no frequency is an alias of another
                equation = equation._replace(Omega=4 * equation.scale)
            found = _decide(equation, flow(equation, bits), bits)
        if found.verdict is not Verdict.UNDECIDED or 2 * bits > max_bits:
            return found
        bits *= 2


def _decide(equation: Equation, Phi: arb_mat, bits: int) -> CertifiedGrowth:
    """Return what follows from an enclosure of the monodromy matrix."""
    period = 2 * arb.pi() / equation.Omega
    lower, upper = equation.mean_growth, norm(Phi).log() / period
    spectrum = _spectrum(Phi)
    if spectrum is not None:
        least, most = _largest_modulus(spectrum)
        upper = upper.min(most.log() / period)
        if least > 0:
            lower = lower.max(least.log() / period)
    if lower > 0:
        verdict, reason = Verdict.UNSTABLE, "a multiplier lies outside the unit circle"
    elif upper < 0:
        verdict, reason = Verdict.STABLE, "every multiplier lies inside the unit circle"
    elif spectrum is not None and equation.reciprocal and _on_unit_circle(spectrum):
        verdict, reason = Verdict.STABLE, "every multiplier is simple and, reciprocal to itself, on the unit circle"
    elif spectrum is not None and equation.form is not None and _has_definite_form(Phi, equation.form, spectrum):
        verdict, reason = Verdict.STABLE, "every motion keeps a positive definite quadratic form constant"
    else:
        verdict, reason = Verdict.UNDECIDED, _obstacle(equation)
    if verdict is Verdict.STABLE and equation.reciprocal:
        lower = upper = arb(0)
    return CertifiedGrowth(_float_below(lower), 0.0 - _float_below(-upper), verdict, bits, reason)


def _obstacle(equation: Equation) -> str:
    if equation.mean_growth == 0 and not equation.reciprocal:
        return (
            "K, F_cj or F_sj is not exactly symmetric, so that nothing holds multipliers on the unit circle; "
            "if the asymmetry is rounding, give the symmetric parts"
        )
    return "multipliers within the error of the unit circle, or too close to each other on it"


def _float_below(ball: arb) -> float:
    """Return a float not above any number in ``ball``."""
    bound = ball.lower()
    nearest = float(bound)
    return nearest if arb(nearest) <= bound else math.nextafter(nearest, -math.inf)


# The multipliers: docs/certify.md, section 3


class _Spectrum(NamedTuple):
    """Discs that contain the multipliers: every union of k discs that is apart from the others contains exactly k."""

    centres: list[acb]
    radii: list[arb]
    vectors: acb_mat  # approximate eigenvectors, column by column


def _spectrum(Phi: arb_mat) -> _Spectrum | None:
    """Return Gershgorin's discs of Phi in a basis of approximate eigenvectors, or None if that basis is singular."""
    size = Phi.nrows()
    # Eigenvectors of a generic matrix nearby, where multiple multipliers have come apart by more than QR neglects.
    fuzz = norm(Phi) * arb(2) ** (16 - ctx.prec) + sum((entry.rad() for entry in Phi.entries()), arb(0))
    random = np.random.default_rng(0).uniform(-1.0, 1.0, size**2)
    nearby = (Phi + arb_mat(size, size, [fuzz * x for x in random.tolist()])).mid()
    try:
        columns = acb_mat(nearby).eig(right=True, algorithm="approx")[1].transpose().tolist()
        # of equal length, lest one disc be small at the cost of another
        vectors = acb_mat([[x / sum(map(abs, column)) for x in column] for column in columns]).transpose().mid()
        with ctx.extraprec(ctx.prec):  # at a boundary the vectors are parallel to half the digits
            similar = (vectors.inv() * acb_mat(Phi) * vectors).tolist()
    except (ValueError, ZeroDivisionError):
        return None
    if not all(entry.is_finite() for row in similar for entry in row):
        return None
    centres = [similar[i][i] for i in range(size)]
    radii = [sum((abs(x) for j, x in enumerate(similar[i]) if j != i), arb(0)).upper() for i in range(size)]
    return _Spectrum(centres, radii, vectors)


def _largest_modulus(spectrum: _Spectrum) -> tuple[arb, arb]:
    """Return a lower and an upper bound of max|mu|."""
    centres, radii, _ = spectrum
    discs = list(zip(centres, radii, strict=True))
    touching = np.array([[not abs(c - d) > r + s for d, s in discs] for c, r in discs])
    count, label = connected_components(touching, directed=False)
    # each union of touching discs holds a multiplier, which may be at its point next to zero
    inner = [(abs(c) - r).lower() for c, r in discs]
    least = max(min(bound for bound, part in zip(inner, label, strict=True) if part == union) for union in range(count))
    return least, max((abs(c) + r).upper() for c, r in discs)


def _on_unit_circle(spectrum: _Spectrum) -> bool:
    """Return whether every multiplier is simple and of modulus 1, if with every mu 1 / conj(mu) is a multiplier.

    A disc apart from all others holds one multiplier mu. If its image under reflection in the unit circle is apart
    from the others as well, then 1 / conj(mu) can be in no other disc, so it is mu.
    """
    for i, (centre, radius) in enumerate(zip(spectrum.centres, spectrum.radii, strict=True)):
        box = centre + acb(radius * arb(0, 1), radius * arb(0, 1))
        image = 1 / box.conjugate()
        for j, (other, reach) in enumerate(zip(spectrum.centres, spectrum.radii, strict=True)):
            if j != i and not (abs(box - other) > reach and abs(image - other) > reach):
                return False
    return True


def _has_definite_form(Phi: arb_mat, J: arb_mat, spectrum: _Spectrum) -> bool:
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
    c = np.linalg.lstsq(ratios, -np.sign(kappa), rcond=SAME_ANGLE)[0]
    polynomial = arb_mat(2 * n, 2 * n)
    for coefficient in c[::-1].tolist():
        polynomial = (polynomial + arb(coefficient) * arb_mat(np.eye(2 * n).tolist())) * Phi
    Y = J * polynomial
    return _is_positive_definite(Y + Y.transpose())


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
