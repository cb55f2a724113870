"""Taylor steps with a proved remainder (docs/certify.md, sections 1 and 2)."""

from __future__ import annotations

import math
from collections.abc import Iterator
from fractions import Fraction
from typing import Any, NamedTuple

import numpy as np
from flint import arb, arb_mat

from floquet.certified.equation import Equation, around_zero, identity, norm
from floquet.certified.waves import FLOATS, Arithmetic, Majorant, ball, balls, harmonic_powers, majorant

# Length of a step times the norm that governs its Taylor coefficients. The largest term exceeds the sum by up to
# exp(8), which costs 12 bits; longer steps save little work.
MAX_STEP_NORM = 8.0
# The same where waveforms are known within a bound: what that does to a step grows like exp of twice this.
MAX_LOOSE_STEP_NORM = 0.5
# Steps in a period times the cost of a product of matrices, in multiplications: some ten minutes at 128 bits. A point
# that needs more is refused.
MAX_WORK = 1e7
# What a product of matrices costs besides its multiplications, in multiplications.
PRODUCT_OVERHEAD = 60
# How often a step is halved in which E is not proved regular.
MAX_MASS_HALVINGS = 8
# Part of E that may change in a step, as planned: it enters the remainder as 1 / (1 - change).
MAX_MASS_CHANGE = 0.95


class Bounds(NamedTuple):
    """What bounds the Taylor coefficients in a segment: majorants of A and B together, and of E."""

    rates: Majorant
    E: Majorant


class Plan(NamedTuple):
    """How a segment is integrated: number of steps, degree of a step's polynomial, radius of its majorant."""

    steps: int
    order: int
    radius: arb


def bounds_in(equation: Equation, inside: Fraction) -> Bounds:
    """Return majorants of the coefficients in the segment round the phase ``inside``."""
    steady = (norm(equation.A) + norm(equation.B)).max(equation.scale)
    rates = [
        (part.wave, sum((norm(X) for X in (part.A, part.B) if X is not None), arb(0)))
        for part in equation.parts
        if part.A is not None or part.B is not None
    ]
    masses = [(part.wave, norm(part.E)) for part in equation.parts if part.E is not None]
    return Bounds(majorant(steady, rates, inside), majorant(arb(0), masses, inside))


def _exponent(bounds: Bounds, T: Any, length: Any, radius: Any, inverse: Any, m: Arithmetic) -> tuple[Any, Any]:
    """Return log x(radius) of the majorant x of a step's flow, and what has to be below 1 for it.

    ``inverse`` bounds the norm of E^-1 at the start of the step, and is at least 1.
    """
    change = inverse * bounds.E.increase(length, radius, m)
    return inverse * T * length * bounds.rates.integral(length, radius, m) / (1 - change), change


def plan_of(equation: Equation, a: Fraction, b: Fraction, bits: int) -> Plan | None:
    """Return the plan of a segment for the least work; None if it is constant.

    Any plan gives a valid enclosure; `_remainder` proves it.
    """
    inside = (a + b) / 2
    T, part = float(equation.period), float(b - a)
    bounds = bounds_in(equation, inside)
    inverse = _typical_inverse(equation, a, b)
    total = inverse * T * part * float(bounds.rates.value(FLOATS.number(0), 0.0, FLOATS))
    n, N = equation.A.nrows(), equation.states
    constant = all(one.wave.is_constant_at(inside) and not one.wave.rest for one in equation.parts)
    fewest = total / (MAX_LOOSE_STEP_NORM if equation.has_rest else MAX_STEP_NORM)
    most = MAX_WORK / (n * n * N + PRODUCT_OVERHEAD)
    if not fewest < most:
        raise ValueError(
            f"n = {n} coordinates at Omega = {float(equation.Omega)!r} need {fewest:.3g} steps in a period, beyond the "
            f"{most:.0f} that are practical in ball arithmetic; give a higher Omega or fewer coordinates"
        )
    if constant:
        return None
    harmonics = max([*bounds.rates.harmonics, *bounds.E.harmonics], default=1)
    largest = max(1.0, fewest)
    steps = np.unique(np.ceil(np.geomspace(largest, max(largest, 2 * total + 8 * part * harmonics), 40)))
    radius = np.geomspace(1.05, 200.0, 100)[:, None]
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        exponent, change = _exponent(bounds, T, part / steps, radius, inverse, FLOATS)
        # a change beyond what is planned for would make the majorant useless
        exponent = np.where((change < MAX_MASS_CHANGE) & ~np.isnan(exponent), exponent, np.inf)
        orders = np.ceil((exponent + bits * math.log(2) - np.log(radius - 1)) / np.log(radius)).clip(min=2)
    order = orders.min(axis=0)
    # products of matrices: a term of the series takes one for each term before it, and some ten in any case
    best = int(np.argmin(steps * order * (order / 2 * bool(equation.parts) + 10)))
    if not np.isfinite(order[best]):
        raise ValueError(
            f"the mass at Omega = {float(equation.Omega)!r} changes too much between the phases {float(a):.6g} and "
            f"{float(b):.6g} of the period to be enclosed; give a smaller eps"
        )
    return Plan(int(steps[best]), int(order[best]), arb(float(radius[orders[:, best].argmin(), 0])))


def _typical_inverse(equation: Equation, a: Fraction, b: Fraction) -> float:
    """Return about the largest norm of E^-1 in a segment, at least 1."""
    if not equation.moves:
        return 1.0
    harmonics = max((j for part in equation.parts for j in part.wave.harmonics), default=1)
    phases = [a + (b - a) * Fraction(i, 4 * harmonics + 4) for i in range(4 * harmonics + 5)]
    masses = (equation.matrices(phase, (a + b) / 2)[0] for phase in phases)
    return max(1.0, *(float(norm(E.mid().inv())) for E in masses))


class Steps:
    """The steps of one segment; what does not change from step to step is kept.

    Parameters
    ----------
    equation : Equation
    inside : Fraction
        A phase in the segment.
    plan : Plan
    """

    def __init__(self, equation: Equation, inside: Fraction, plan: Plan) -> None:
        self.equation, self.inside, self.plan = equation, inside, plan
        self.bounds = bounds_in(equation, inside)
        self.powers: dict[Fraction, dict[int, list[arb]]] = {}
        self.remainders: dict[Fraction, arb_mat | None] = {}

    def between(self, a: Fraction, b: Fraction) -> Iterator[arb_mat]:
        """Yield the flows of the steps from phase ``a`` to phase ``b``."""
        length = (b - a) / self.plan.steps
        for m in range(self.plan.steps):
            yield from self._flows(a + m * length, length, MAX_MASS_HALVINGS)

    def _flows(self, start: Fraction, length: Fraction, halvings: int) -> Iterator[arb_mat]:
        """Yield the flow from the phase ``start`` on; of halves, if E is not proved regular."""
        inverse = None
        if self.equation.moves:
            inverse = self.equation.matrices(start, self.inside)[0].inv()
            remainder = self._remainder(length, norm(inverse).max(arb(1)))
        else:
            if length not in self.remainders:
                self.remainders[length] = self._remainder(length, arb(1))
            remainder = self.remainders[length]
        if remainder is not None:
            yield self._polynomial(start, length, inverse) + remainder
        elif halvings:
            yield from self._flows(start, length / 2, halvings - 1)
            yield from self._flows(start + length / 2, length / 2, halvings - 1)
        else:
            raise ValueError(
                f"the mass is not proved regular next to the phase {float(start):.6g} of the period; give a smaller eps"
            )

    def _remainder(self, length: Fraction, inverse: arb) -> arb_mat | None:
        """Return balls about zero that contain what the polynomial leaves out at the end of a step.

        The Taylor coefficients of the equation's matrices have norms at most those of scalar functions. Those of the
        flow are then at most those of x, x' = alpha x / (1 - change). Cauchy's estimate on |s| = radius bounds their
        sum from order + 1 on. None if E is not proved regular for |s| <= radius.
        """
        m, T, h = balls(), self.equation.period, ball(length)
        exponent, change = _exponent(self.bounds, T, h, self.plan.radius, inverse, m)
        if not change < 1:
            return None
        bound = (exponent - self.plan.order * self.plan.radius.log()).exp() / (self.plan.radius - 1)
        if self.equation.has_rest:
            unknown = self._unknown(h, inverse)
            if unknown is None:
                return None
            bound += _exponent(self.bounds, T, h, arb(1), inverse, m)[0].exp() * (T * h * unknown).expm1()
        return around_zero(self.equation.states, bound)

    def _unknown(self, h: arb, inverse: arb) -> arb | None:
        """Return a bound of what the waveforms leave out of the matrix of z' in a step, or None."""
        parts = self.equation.parts
        rates = sum((norm(X) * p.wave.rest for p in parts for X in (p.A, p.B) if X is not None), arb(0))
        masses = sum((norm(p.E) * p.wave.rest for p in parts if p.E is not None), arb(0))
        m = balls()
        largest = inverse / (1 - inverse * self.bounds.E.increase(h, arb(1), m))  # of E^-1
        if not largest * masses < 1:
            return None
        value = largest * self.bounds.rates.value(h, arb(1), m)
        return largest * (rates + masses * value) / (1 - largest * masses)

    def _polynomial(self, start: Fraction, length: Fraction, inverse: arb_mat | None) -> arb_mat:
        """Return the Taylor polynomial of a step's flow, at its end.

        E_0 (k + 1) u_{k+1} = h sum_i (A_i u_{k-i} + B_i v_{k-i}) - sum_{i > 0} E_i (k + 1 - i) u_{k+1-i},
        (k + 1) v_{k+1} = h scale u_k.
        """
        equation, order = self.equation, self.plan.order
        n, N = equation.A.nrows(), equation.states
        h = equation.period * ball(length)
        if length not in self.powers:
            self.powers[length] = harmonic_powers((part.wave for part in equation.parts), length, order)
        parts = [
            (part, part.wave.series(start, length, self.inside, order, self.powers[length])) for part in equation.parts
        ]
        A = _Convolution(equation.A, [(part.A, series) for part, series in parts], h)
        B = _Convolution(equation.B, [(part.B, series) for part, series in parts], h)
        E = _Convolution(arb_mat(n, n), [(part.E, series[1:]) for part, series in parts], arb(1))
        rows = identity(N).tolist()
        u, slopes = [arb_mat(rows[:n])], [arb_mat(n, N)]
        v = [arb_mat(rows[n:])] if equation.is_second_order else []
        sum_u, sum_v = u[0], v[0] if v else arb_mat(0, N)
        for k in range(order):
            slope = A(u, k)
            if v:
                slope = slope + B(v, k)
                v.append(u[k] * (h * equation.scale / (k + 1)))
                sum_v = sum_v + v[-1]
            if inverse is not None:
                slope = inverse * (slope - E(slopes, k))
                slopes.append(slope)
            u.append(slope / (k + 1))
            sum_u = sum_u + u[-1]
        return arb_mat(sum_u.tolist() + sum_v.tolist())


class _Convolution:
    """Makes sum_i X_i y_{k-i} from X_0 = factor (constant + ...), X_i = factor sum_r f_{r,i} M_r.

    With few M_r the sums over i are formed first, otherwise the X_i: whatever needs fewer multiplications.
    """

    def __init__(self, constant: arb_mat, terms: list[tuple[arb_mat | None, list[arb]]], factor: arb) -> None:
        self.constant = constant * factor
        self.is_constant_zero = all(entry.is_zero() for entry in constant.entries())
        self.terms = [(M * factor, series) for M, series in terms if M is not None and series]
        self.matrices: list[arb_mat] = []
        if 2 * len(self.terms) >= constant.nrows():
            for i in range(max(len(series) for _, series in self.terms)):
                found = [M * series[i] for M, series in self.terms if i < len(series)]
                self.matrices.append(sum(found[1:], found[0]))
            if not self.is_constant_zero:
                self.matrices[0] += self.constant

    def __call__(self, y: list[arb_mat], k: int) -> arb_mat:
        """Return the sum."""
        if self.matrices:
            total = self.matrices[0] * y[k]
            for i in range(1, min(k + 1, len(self.matrices))):
                total += self.matrices[i] * y[k - i]
            return total
        total = arb_mat(y[k].nrows(), y[k].ncols()) if self.is_constant_zero else self.constant * y[k]
        for M, series in self.terms:
            weighted = y[k] * series[0]
            for i in range(1, min(k + 1, len(series))):
                weighted += y[k - i] * series[i]
            total += M * weighted
        return total
