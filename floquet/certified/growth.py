"""Proved bounds of the growth rate and a proved verdict at one point (Omega, eps); docs/certify.md has the proofs."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum

from flint import arb, arb_mat, ctx

from floquet.certified.enclosure import flow
from floquet.certified.equation import Equation, norm
from floquet.certified.reading import equation_of, uncoupled_subsystems
from floquet.certified.spectrum import (
    enclosed_spectrum,
    has_definite_form,
    is_definite,
    largest_modulus,
    on_unit_circle,
)
from periodic import AnyFamily, AnySystem, any_member_at
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
        How it was decided, or why not, and what the statement is about if not the matrices as given.
    change : float
        By how much C and the skew part of K were changed to be exactly M' and G' / 2, as a part of the largest entries;
        zero if the system was taken as given. The bounds and the verdict are those of the system so changed.
    """

    lower: float
    upper: float
    verdict: ProvedVerdict
    bits: int
    reason: str
    change: float = 0.0


def certified_monodromy(family: AnyFamily, Omega: float, eps: float, *, bits: int = FIRST_BITS) -> arb_mat:
    """Return a rigorous enclosure of the monodromy matrix over T = 2 pi / Omega.

    Parameters
    ----------
    family : AnyFamily
        A `PeriodicSystem`, a `FirstOrderSystem` or anything whose ``at(Omega)`` returns one; its numbers are taken as
        exact binary numbers. Of a waveform that stands for a function, every one within its ``rest`` is enclosed.
    Omega : float
        Excitation frequency, positive, in the units of the system; exact.
    eps : float
        Relative excitation amplitude, any sign, dimensionless; exact.
    bits : int
        Working precision, 64 to 2048. More bits give a narrower enclosure; every enclosure is valid.

    Returns
    -------
    flint.arb_mat, shape (2n, 2n) or (n, n)
        Phi with q(T) = Phi q(0) from just after t = 0, q = (W', W) or x. Its entries are balls, with the methods
        ``mid()`` and ``rad()``.

    Raises
    ------
    ValueError
        If an argument is wrong, n and the number of steps in a period are too large for ball arithmetic, or the mass
        is not proved regular at all times.
    """
    system, Omega, eps = _checked(family, Omega, eps)
    bits = whole_number("bits", bits, least=MIN_BITS, most=MAX_BITS)
    with ctx.workprec(bits):
        equation = equation_of(system, Omega, eps, as_given=True)
        return equation.to_state * flow(equation, bits) * equation.to_state.inv()


def certified_growth(
    family: AnyFamily, Omega: float, eps: float, *, max_bits: int = LAST_BITS, progress: bool = True
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
        change=max(one.change for one in found),
    )


def _checked(family: AnyFamily, Omega: float, eps: float) -> tuple[AnySystem, float, float]:
    Omega = real_number("Omega", Omega, positive=True)
    eps = real_number("eps", eps)
    return any_member_at(family, Omega, "family"), Omega, eps


def _growth_of_subsystem(system: AnySystem, Omega: float, eps: float, max_bits: int, progress: bool) -> CertifiedGrowth:
    bits = FIRST_BITS
    while True:
        with ctx.workprec(bits):
            equation = equation_of(system, Omega, eps)
            if equation.is_constant:
                # any period will do: in a short one no frequency is an alias of another
                equation = equation._replace(Omega=4 * equation.rate)
            found = _decide(equation, flow(equation, bits, progress=progress), bits)
        # where waveforms are known within a bound, more bits say no more
        if found.verdict is not ProvedVerdict.UNDECIDED or 2 * bits > max_bits or equation.has_rest:
            return found
        bits *= 2


def _decide(equation: Equation, Phi: arb_mat, bits: int) -> CertifiedGrowth:
    """Return what follows from an enclosure of the monodromy matrix."""
    period = 2 * arb.pi() / equation.Omega
    lower, upper = _mean_growth(equation, Phi, period), norm(Phi).log() / period
    if equation.reciprocal:
        lower = lower.max(arb(0))
    spectrum = enclosed_spectrum(Phi)
    if spectrum is not None:
        least, most = largest_modulus(spectrum)
        upper = upper.min(most.log() / period)
        if least > 0:
            lower = lower.max(least.log() / period)
    form, skew = equation.form, equation.skew
    if lower > 0:
        verdict, reason = ProvedVerdict.UNSTABLE, "a multiplier lies outside the unit circle"
    elif upper < 0:
        verdict, reason = ProvedVerdict.STABLE, "every multiplier lies inside the unit circle"
    elif spectrum is not None and equation.reciprocal and on_unit_circle(spectrum):
        verdict, reason = (
            ProvedVerdict.STABLE,
            "every multiplier is simple and, as its own mirror image, on the unit circle",
        )
    elif form is not None and (
        (spectrum is not None and has_definite_form(Phi, form, spectrum)) if skew else is_definite(form)
    ):
        verdict, reason = ProvedVerdict.STABLE, "every motion keeps a positive definite quadratic form constant"
    else:
        verdict, reason = ProvedVerdict.UNDECIDED, _obstacle(equation)
    if verdict is ProvedVerdict.STABLE and equation.reciprocal:
        lower = upper = arb(0)
    return CertifiedGrowth(
        _float_below(lower), 0.0 - _float_below(-upper), verdict, bits, reason + _about(equation), equation.change
    )


def _mean_growth(equation: Equation, Phi: arb_mat, period: arb) -> arb:
    """Return a lower bound of the growth rate: the mean over all multipliers."""
    if equation.mean_growth is not None:
        return equation.mean_growth
    least = Phi.det().abs_lower()
    return least.log() / (equation.states * period) if least > 0 else arb("-inf")


def _about(equation: Equation) -> str:
    """Return what the statement is about, where it is not about the matrices as given."""
    about = ""
    if equation.change:
        about += (
            "; this holds for the system with exactly C = M' and K - K^T = G', from which the given one differs by "
            f"less than {equation.change:.1e} of its largest entries"
        )
    if equation.has_rest:
        about += "; this holds for all functions that differ from the waveforms by no more than their rest"
    return about


def _obstacle(equation: Equation) -> str:
    if equation.reciprocal:
        return "multipliers within the error of the unit circle, or too close to each other on it"
    return (
        "multipliers within the error of the unit circle, and the system is not exactly Hamiltonian or reversible, so "
        "that nothing holds them there; if a matrix is symmetric but for rounding, give the symmetric part"
    )


def _float_below(ball: arb) -> float:
    """Return a float not above any number in ``ball``."""
    bound = ball.lower()
    nearest = float(bound)
    return nearest if arb(nearest) <= bound else math.nextafter(nearest, -math.inf)
