"""The monodromy matrix in ball arithmetic, from jump to jump (docs/certify.md, sections 1 and 2).

Every number is a ball, a midpoint with a radius, that contains the exact value, and every operation keeps it so (Arb,
part of FLINT: F. Johansson, IEEE Transactions on Computers 66 (2017) 1281-1292). Nothing is shared with the integrators
that are held against this.
"""

from __future__ import annotations

from fractions import Fraction

from flint import arb_mat
from tqdm import tqdm

from floquet.certified.equation import Equation, block_matrix, identity
from floquet.certified.steps import Steps, plan_of
from floquet.certified.waves import ball

# A bar shows the progress of what takes longer than this, in seconds.
PROGRESS_DELAY = 2.0


def flow(equation: Equation, bits: int, *, progress: bool = False) -> arb_mat:
    """Return an enclosure of the monodromy matrix, z(T) = flow z(0); ``progress`` shows a bar if that takes long."""
    segments = equation.segments()
    insides = [(a + b) / 2 for a, b in segments]
    plans = [plan_of(equation, a, b, bits) for a, b in segments]
    label = f"{equation.states} states, {bits} bits"
    factors: list[arb_mat] = []
    with tqdm(
        total=sum(plan.steps for plan in plans if plan),
        desc=label,
        unit="step",
        delay=PROGRESS_DELAY,
        leave=False,
        disable=not progress,
    ) as bar:
        for (a, b), plan, inside, after in zip(segments, plans, insides, [*insides[1:], insides[0]], strict=True):
            if plan is None:
                factors.append(_exponential(equation, a, b))
            else:
                for step in Steps(equation, inside, plan).between(a, b):
                    factors.append(step)
                    bar.update()
            factors += _jump(equation, b, inside, after)
    # by halves: in a product from one end to the other the balls would grow like the product of the steps' norms
    while len(factors) > 1:
        pairs = [later * earlier for earlier, later in zip(factors[::2], factors[1::2], strict=False)]
        factors = pairs + factors[2 * len(pairs) :]
    return factors[0]


def _exponential(equation: Equation, a: Fraction, b: Fraction) -> arb_mat:
    """Return the flow of a segment in which nothing depends on time."""
    inside = (a + b) / 2
    E, A, B = equation.matrices(inside, inside)
    h = equation.period * ball(b - a)
    if equation.moves:
        inverse = E.inv()
        A, B = inverse * A, inverse * B
    if not equation.is_second_order:
        return (A * h).exp()
    n = A.nrows()
    return block_matrix([[A * h, B * h], [identity(n) * (equation.scale * h), arb_mat(n, n)]]).exp()


def _jump(equation: Equation, phase: Fraction, before: Fraction, after: Fraction) -> list[arb_mat]:
    """Return what happens at the end ``phase`` of a segment, between the phases ``before`` and ``after``."""
    start = phase % 1
    found = []
    inverse = identity(equation.A.nrows())
    if equation.moves:
        inverse = equation.loose_mass(start, after).inv()
        if any(part.E is not None and part.wave.pieces for part in equation.parts):
            # the momentum goes on
            found.append(_first_rows(equation, inverse * equation.loose_mass(phase, before)))
    if start in equation.pulses:
        found.append((_first_rows(equation, inverse) * equation.pulses[start]).exp())
    return found


def _first_rows(equation: Equation, X: arb_mat) -> arb_mat:
    """Return the matrix that applies X to u and leaves v."""
    if not equation.is_second_order:
        return X
    zero, one = arb_mat(X.nrows(), X.nrows()), identity(X.nrows())
    return block_matrix([[X, zero], [zero, one]])
