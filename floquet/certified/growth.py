"""Proved bounds of the growth rate and a proved verdict at one point (Omega, eps); docs/certify.md has the proofs."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from flint import arb, arb_mat, ctx
from scipy.sparse.csgraph import connected_components

from floquet.certified.enclosure import Equation, block_matrix, equation_of_motion, flow, norm
from floquet.certified.spectrum import enclosed_spectrum, has_definite_form, largest_modulus, on_unit_circle
from periodic import PeriodicSystem, SystemFamily, member_at, stiffness_alone
from periodic.checks import real_number, whole_number

# Working precision of the first attempt: it decides nearly every point. Each doubling costs about four times as much.
FIRST_BITS = 128
# Working precision that may be asked for.
MIN_BITS, MAX_BITS = 64, 2048
# Working precision of the last attempt, where the caller asks for nothing else.
LAST_BITS = 512


class ProvedVerdict(StrEnum):
    """What is proved about the solutions at one (Omega, eps): see `CertifiedGrowth`."""

    STABLE = "stable"
    UNSTABLE = "unstable"
    UNDECIDED = "undecided"


@dataclass(frozen=True)
class CertifiedGrowth:
    """Proved bounds of the growth rate max log|mu| / T at one (Omega, eps).

    Attributes
    ----------
    lower, upper : float
        The growth rate lies in [lower, upper], in the units of Omega. Both are rounded outwards.
    verdict : ProvedVerdict
        STABLE: every solution is bounded for t >= 0. UNSTABLE: some solution grows exponentially. UNDECIDED: neither
        could be proved with the precision allowed, as happens on a boundary of stability itself.
    bits : int
        Working precision at which the verdict fell, or the highest that was tried.
    reason : str
        How it was decided, or why not.
    """

    lower: float
    upper: float
    verdict: ProvedVerdict
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
    bits = whole_number("bits", bits, least=MIN_BITS, most=MAX_BITS)
    with ctx.workprec(bits):
        equation = equation_of_motion(system, Omega, eps)
        zero = arb_mat(system.size, system.size)
        to_q = block_matrix([[equation.basis, zero], [zero, equation.basis / equation.scale]])
        return to_q * flow(equation, bits) * to_q.inv()


def certified_growth(
    family: SystemFamily, Omega: float, eps: float, *, max_bits: int = LAST_BITS, progress: bool = True
) -> CertifiedGrowth:
    """Return proved bounds of the growth rate and a proved verdict, raising the precision until one falls.

    Parameters
    ----------
    family, Omega, eps
        As for `certified_monodromy`.
    max_bits : int
        Highest working precision, 128 to 2048. The first attempt has 128 bits, and each further one twice as many.
    progress : bool
        Show a bar for what takes longer than two seconds.

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
    max_bits = whole_number("max_bits", max_bits, least=FIRST_BITS, most=MAX_BITS)
    subsystems = uncoupled_subsystems(system, eps)
    found = [_growth_of_subsystem(subsystem, Omega, eps, max_bits, progress) for subsystem in subsystems]
    verdicts = {one.verdict for one in found}
    by_weight = (ProvedVerdict.UNSTABLE, ProvedVerdict.UNDECIDED, ProvedVerdict.STABLE)
    verdict = next(one for one in by_weight if one in verdicts)
    deciding = [one for one in found if one.verdict is verdict]
    return CertifiedGrowth(
        lower=max(one.lower for one in found),
        upper=max(one.upper for one in found),
        verdict=verdict,
        bits=max(one.bits for one in deciding),
        reason="; ".join(dict.fromkeys(one.reason for one in deciding)),
    )


def _checked(family: SystemFamily, Omega: float, eps: float) -> tuple[PeriodicSystem, float, float]:
    Omega = real_number("Omega", Omega, positive=True)
    eps = real_number("eps", eps)
    return member_at(family, Omega, "family"), Omega, eps


def uncoupled_subsystems(system: PeriodicSystem, eps: float) -> Iterator[PeriodicSystem]:
    """Yield the subsystems that exact zeros in all matrices uncouple; their multipliers are those of the system."""
    stiffness_alone(system)
    constant = (system.mass, system.gyroscopic, system.damping, system.stiffness)
    excitation = (*system.cosine, *system.sine) if eps else ()
    coupled = np.any(np.array((*constant, *excitation)) != 0, axis=0)
    count, label = connected_components(coupled, directed=False)
    for number in range(count):
        index = np.flatnonzero(label == number)
        rows, columns = np.ix_(index, index)
        M, G, C, K = (matrix[rows, columns] for matrix in constant)
        Fc, Fs = (matrices[:, rows, columns] for matrices in (system.cosine, system.sine))
        yield PeriodicSystem(M, G, C, K, Fc, Fs)


def _growth_of_subsystem(
    system: PeriodicSystem, Omega: float, eps: float, max_bits: int, progress: bool
) -> CertifiedGrowth:
    bits = FIRST_BITS
    while True:
        with ctx.workprec(bits):
            equation = equation_of_motion(system, Omega, eps)
            if not equation.F:
                # without excitation any period will do: in a short one no frequency is an alias of another
                equation = equation._replace(Omega=4 * equation.scale)
            found = _decide(equation, flow(equation, bits, progress=progress), bits)
        if found.verdict is not ProvedVerdict.UNDECIDED or 2 * bits > max_bits:
            return found
        bits *= 2


def _decide(equation: Equation, Phi: arb_mat, bits: int) -> CertifiedGrowth:
    """Return what follows from an enclosure of the monodromy matrix."""
    period = 2 * arb.pi() / equation.Omega
    lower, upper = equation.mean_growth, norm(Phi).log() / period
    spectrum = enclosed_spectrum(Phi)
    if spectrum is not None:
        least, most = largest_modulus(spectrum)
        upper = upper.min(most.log() / period)
        if least > 0:
            lower = lower.max(least.log() / period)
    if lower > 0:
        verdict, reason = ProvedVerdict.UNSTABLE, "a multiplier lies outside the unit circle"
    elif upper < 0:
        verdict, reason = ProvedVerdict.STABLE, "every multiplier lies inside the unit circle"
    elif spectrum is not None and equation.reciprocal and on_unit_circle(spectrum):
        verdict, reason = (
            ProvedVerdict.STABLE,
            "every multiplier is simple and, as its own mirror image, on the unit circle",
        )
    elif spectrum is not None and equation.form is not None and has_definite_form(Phi, equation.form, spectrum):
        verdict, reason = ProvedVerdict.STABLE, "every motion keeps a positive definite quadratic form constant"
    else:
        verdict, reason = ProvedVerdict.UNDECIDED, _obstacle(equation)
    if verdict is ProvedVerdict.STABLE and equation.reciprocal:
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
