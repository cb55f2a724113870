"""The monodromy matrix in ball arithmetic: Taylor steps with a proved remainder (docs/certify.md, sections 1 and 2).

Every number is a ball, a midpoint with a radius, that contains the exact value, and every operation keeps it so (Arb,
part of FLINT: F. Johansson, IEEE Transactions on Computers 66 (2017) 1281-1292). Nothing is shared with the integrators
that are held against this.
"""

from __future__ import annotations

import math
from functools import reduce
from itertools import chain
from typing import NamedTuple

import numpy as np
from flint import arb, arb_mat, fmpq
from tqdm import tqdm

from periodic import PeriodicSystem, stiffness_alone
from periodic.checks import FloatArray

# Length of a step times the norm that governs its Taylor coefficients. The largest term exceeds the sum by up to
# exp(8), which costs 12 bits; longer steps save little work.
MAX_STEP_NORM = 8.0
# Steps in a period times the cost of a product of matrices, in multiplications: some ten minutes at 128 bits. A point
# that needs more is refused.
MAX_WORK = 1e7
# A bar shows the progress of what takes longer than this, in seconds.
PROGRESS_DELAY = 2.0
# What a product of matrices costs besides its multiplications, in multiplications.
PRODUCT_OVERHEAD = 60


class Equation(NamedTuple):
    """z' = [[-P, -(Q + sum_j F_j(t)) / scale], [scale I, 0]] z, where W = basis y and z = (y', scale y).

    Any nonsingular basis and positive scale leave the multipliers alone; these make norms small in any units of W.

    Attributes
    ----------
    basis : flint.arb_mat, shape (n, n)
    scale : flint.arb
        Per unit of time.
    Omega : flint.arb
    P, Q : flint.arb_mat, shape (n, n)
        M^-1 (G + C) and M^-1 K.
    F : dict
        eps M^-1 F_cj at (j, 0) and eps M^-1 F_sj at (j, 3): sin u = cos(u + 3 pi / 2).
    steady : flint.arb
        Norm (largest absolute row sum) of the constant part of the equation's matrix.
    pulsating : dict
        Bound of the norm of the part with frequency j Omega.
    form : flint.arb_mat or None
        Skew J with Phi^T J Phi = J, if the system is conservative.
    reciprocal : bool
        Proved: with mu, 1 / conj(mu) is a multiplier.
    mean_growth : flint.arb
        Mean of log|mu| / T over all multipliers, by Liouville's formula.
    """

    basis: arb_mat
    scale: arb
    Omega: arb
    P: arb_mat
    Q: arb_mat
    F: dict[tuple[int, int], arb_mat]
    steady: arb
    pulsating: dict[int, arb]
    form: arb_mat | None
    reciprocal: bool
    mean_growth: arb


def equation_of_motion(system: PeriodicSystem, Omega: float, eps: float) -> Equation:
    """Return the equation with all floats taken as exact, at the working precision."""
    basis = _exact(_modal_basis(stiffness_alone(system)))

    def congruent(matrix: FloatArray) -> arb_mat:
        return basis.transpose() * _exact(matrix) * basis

    mass, gyroscopic = congruent(system.mass), congruent(system.gyroscopic)
    inverse = mass.inv()  # that it exists proves M and basis nonsingular
    damping = inverse * congruent(system.damping)
    P, Q = inverse * gyroscopic + damping, inverse * congruent(system.stiffness)
    excitation = {
        (j, quarters): matrix
        for quarters, matrices in ((0, system.cosine), (3, system.sine))
        for j, matrix in enumerate(matrices, start=1)
        if eps and matrix.any()
    }
    F = {key: inverse * congruent(matrix) * arb(eps) for key, matrix in excitation.items()}

    p, q, f = norm(P), norm(Q), sum(map(norm, F.values()), arb(0))
    # makes the rows p + (q + f) / scale and scale alike; the last term is for systems without stiffness
    rate = (p + (p * p + 4 * (q + f)).sqrt()) / 2 + arb(Omega) / 16
    scale = arb(2) ** math.frexp(float(rate))[1]
    pulsating: dict[int, arb] = {}
    for (j, _), matrix in F.items():
        pulsating[j] = pulsating.get(j, arb(0)) + norm(matrix) / scale

    zero = arb_mat(system.size, system.size)
    # structure is read off the given matrices: it holds exactly or not at all
    undamped = not system.damping.any()
    symmetric = all(np.array_equal(a, a.T) for a in (system.stiffness, *excitation.values()))
    even = not system.gyroscopic.any() and all(quarters == 0 for _, quarters in excitation)
    return Equation(
        basis=basis,
        scale=scale,
        Omega=arb(Omega),
        P=P,
        Q=Q,
        F=F,
        steady=(p + q / scale).max(scale),
        pulsating=pulsating,
        form=block_matrix([[zero, mass], [-mass, gyroscopic / -scale]]) if undamped and symmetric else None,
        reciprocal=undamped and (symmetric or even),
        mean_growth=-damping.trace() / (2 * system.size),
    )


def flow(equation: Equation, bits: int, *, progress: bool = False) -> arb_mat:
    """Return an enclosure of the monodromy matrix, z(T) = flow z(0); ``progress`` shows a bar if that takes long."""
    steps, order, radius = _plan(equation, bits)
    h = 2 * arb.pi() / equation.Omega / steps
    # Taylor coefficients of -h F_j / scale in s = t / h but for the phase, all that changes from step to step
    series = {}
    for (j, quarters), matrix in equation.F.items():
        terms = [matrix * (-h / equation.scale)]
        for i in range(1, order):
            terms.append(terms[-1] * (2 * j * arb.pi() / (steps * i)))
        series[j, quarters] = terms
    remainder = _remainder(equation, steps, order, radius)
    label = f"n = {equation.P.nrows()}, {bits} bits"
    bar = tqdm(range(steps), label, unit="step", delay=PROGRESS_DELAY, leave=False, disable=not progress)
    maps = [_step(equation, h, _coefficients(equation, h, series, steps, m), order) + remainder for m in bar]
    # by halves: in a product from one end to the other the balls would grow like the product of the steps' norms
    while len(maps) > 1:
        pairs = [later * earlier for earlier, later in zip(maps[::2], maps[1::2], strict=False)]
        maps = pairs + maps[2 * len(pairs) :]
    return maps[0]


def norm(matrix: arb_mat) -> arb:
    """Largest absolute row sum."""
    rows = [sum(map(abs, row), arb(0)) for row in matrix.tolist()]
    return reduce(arb.max, rows)


def block_matrix(rows: list[list[arb_mat]]) -> arb_mat:
    """Return the matrix that consists of these square matrices, row by row."""
    return arb_mat([list(chain(*parts)) for row in rows for parts in zip(*(one.tolist() for one in row), strict=True)])


def _exact(matrix: FloatArray) -> arb_mat:
    return arb_mat(matrix.tolist())


def _modal_basis(system: PeriodicSystem) -> FloatArray:
    """Return approximate modes of the symmetric part of the stiffness, normalised to unit mass."""
    scale = 1 / np.sqrt(np.diag(system.mass))
    masses, axes = np.linalg.eigh(scale[:, None] * system.mass * scale)
    whitened = scale[:, None] * axes / np.sqrt(np.maximum(masses, np.finfo(float).eps))
    with np.errstate(over="ignore", invalid="ignore"):
        stiffness = whitened.T @ system.stiffness @ whitened
    if not np.isfinite(stiffness).all():
        raise ValueError("stiffness divided by mass exceeds the range of floating-point numbers; change the units")
    return np.asarray(whitened @ np.linalg.eigh(0.5 * stiffness + 0.5 * stiffness.T)[1])


def _plan(equation: Equation, bits: int) -> tuple[int, int, arb]:
    """Return the number of steps, the degree of a step's polynomial and the radius of its majorant for the least work.

    Any values give a valid enclosure; `_remainder` proves it.
    """
    n, Omega = equation.P.nrows(), float(equation.Omega)
    steady = float(2 * arb.pi() * equation.steady / equation.Omega)
    j = np.array(list(equation.pulsating), dtype=float)
    # above zero also where it underflows, for 0 times infinity is no number
    amplitude = np.array([max(float(g / (k * equation.Omega)), 1e-300) for k, g in equation.pulsating.items()])
    total = steady + 2 * math.pi * float(j @ amplitude)
    fewest, most = total / MAX_STEP_NORM, MAX_WORK / (2 * n**3 + PRODUCT_OVERHEAD)
    if not fewest < most:
        raise ValueError(
            f"n = {n} coordinates at Omega = {Omega!r} need {fewest:.3g} steps in a period, beyond the {most:.0f} "
            "that are practical in ball arithmetic; give a higher Omega or fewer coordinates"
        )
    steps = np.unique(np.ceil(np.geomspace(max(1.0, fewest), 2 * total + 8 * max(j, default=1.0), 40)))
    radius = np.geomspace(1.05, 200.0, 100)[:, None]
    with np.errstate(over="ignore"):
        exponent = steady * radius / steps
        for k, g in zip(j, amplitude, strict=True):
            exponent = exponent + g * np.expm1(2 * math.pi * k * radius / steps)
    orders = np.ceil((exponent + bits * math.log(2) - np.log(radius - 1)) / np.log(radius)).clip(min=2)
    order = orders.min(axis=0)
    # products of matrices: a term of the series takes one for each term before it, and some ten in any case
    best = int(np.argmin(steps * order * (order / 2 * bool(j.size) + 10)))
    return int(steps[best]), int(order[best]), arb(float(radius[orders[:, best].argmin(), 0]))


def _remainder(equation: Equation, steps: int, order: int, radius: arb) -> arb_mat:
    """Return balls about zero that contain the Taylor series of a step beyond degree ``order``, at the step's end.

    The Taylor coefficients of the equation's matrix have norms at most those of a scalar function alpha. Those of the
    flow are then at most those of exp(int_0^s alpha). Cauchy's estimate on |s| = radius bounds their sum from
    order + 1 on.
    """
    exponent = 2 * arb.pi() / equation.Omega / steps * equation.steady * radius
    for j, amplitude in equation.pulsating.items():
        exponent += amplitude / (j * equation.Omega) * (2 * j * arb.pi() * radius / steps).expm1()
    bound = (exponent - order * radius.log()).exp() / (radius - 1)
    size = 2 * equation.P.nrows()
    return arb_mat(size, size, [bound * arb(0, 1)] * size**2)


def _coefficients(
    equation: Equation, h: arb, series: dict[tuple[int, int], list[arb_mat]], steps: int, m: int
) -> list[arb_mat]:
    """Return the Taylor coefficients of -h (Q + sum_j F_j(t)) / scale about the start of step ``m``."""
    constant = equation.Q * (-h / equation.scale)
    if not series:
        return [constant]
    # the i-th derivative of cos(j Omega t + quarters pi / 2) is a cosine i quarter turns on
    cosine = {
        j: [arb.cos_pi_fmpq(fmpq(4 * j * m + quarter * steps, 2 * steps)) for quarter in range(4)]
        for j in equation.pulsating
    }
    coefficients = []
    for i in range(len(next(iter(series.values())))):
        terms = [matrices[i] * cosine[j][(i + quarters) % 4] for (j, quarters), matrices in series.items()]
        coefficients.append(sum(terms[1:], terms[0]))
    coefficients[0] += constant
    return coefficients


def _step(equation: Equation, h: arb, coefficients: list[arb_mat], order: int) -> arb_mat:
    """Return the Taylor polynomial of degree ``order`` of a step's flow, at its end.

    (k + 1) u_{k+1} = -h P u_k + sum_i coefficients[i] v_{k-i},   (k + 1) v_{k+1} = h scale u_k,   z = (u, v).
    """
    n = equation.P.nrows()
    identity = np.eye(2 * n)
    u, v = _exact(identity[:n]), [_exact(identity[n:])]
    damping = equation.P * -h
    damped = not all(entry.is_zero() for entry in damping.entries())
    sum_u, sum_v = u, v[0]
    for k in range(order):
        slope = coefficients[0] * v[k]
        for i in range(1, min(k + 1, len(coefficients))):
            slope += coefficients[i] * v[k - i]
        if damped:
            slope += damping * u
        v.append(u * (h * equation.scale / (k + 1)))
        u = slope / (k + 1)
        sum_u, sum_v = sum_u + u, sum_v + v[-1]
    return arb_mat(sum_u.tolist() + sum_v.tolist())
