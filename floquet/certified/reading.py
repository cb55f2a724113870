"""From a system to its equation, E(t) u' = A(t) u + B(t) v, v' = scale u (docs/certify.md, section 1)."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from fractions import Fraction
from typing import Any, NamedTuple

import numpy as np
from flint import arb, arb_mat
from scipy.linalg import matrix_balance
from scipy.sparse.csgraph import connected_components

from floquet.certified.equation import Equation, Part, block_matrix, exact, norm
from floquet.certified.structure import conserved_form, coupling, hamiltonian_change, is_reversible
from floquet.certified.waves import Piece, Wave, wave_of
from periodic import AnySystem, FirstOrderSystem, PeriodicSystem, Term, check_mass, excitation
from periodic.checks import FloatArray
from periodic.waveforms import Impulses


class Contribution(NamedTuple):
    """wave X, a part of the matrix ``of``."""

    of: str
    wave: Wave
    X: arb_mat


def equation_of(system: AnySystem, Omega: float, eps: float, *, as_given: bool = False) -> Equation:
    """Return the equation with all floats taken as exact, at the working precision.

    A system that is Hamiltonian but for rounding is made exactly so, unless ``as_given``.
    """
    if isinstance(system, FirstOrderSystem):
        return _first_order(system, Omega, eps)
    check_mass(system, eps)
    return _second_order(system, Omega, eps, as_given)


def uncoupled_subsystems(system: AnySystem, eps: float) -> Iterator[AnySystem]:
    """Yield the subsystems that exact zeros in all matrices uncouple; their multipliers are those of the system."""
    coupled = np.any(np.array(coupling(system, eps)) != 0, axis=0)
    count, label = connected_components(coupled, directed=False)
    for number in range(count):
        rows, columns = np.ix_(*2 * (np.flatnonzero(label == number),))

        def within(X: FloatArray, rows: Any = rows, columns: Any = columns) -> FloatArray:
            return X[..., rows, columns]

        inside = [(term, within(term.matrix)) for term in system.terms]
        terms = [Term(term.of, X, term.waveform, term.power) for term, X in inside if X.any()]
        Fc, Fs = within(system.cosine), within(system.sine)
        if isinstance(system, FirstOrderSystem):
            yield FirstOrderSystem(within(system.constant), Fc, Fs, terms=terms)
        else:
            M, G, C, K = map(within, (system.mass, system.gyroscopic, system.damping, system.stiffness))
            yield PeriodicSystem(M, G, C, K, Fc, Fs, terms=terms)


def _contributions(system: AnySystem, eps: float) -> tuple[list[Contribution], list[tuple[str, Fraction, arb_mat]]]:
    """Return what depends on time, but for pulses, and the pulses with their phases."""
    smooth: dict[tuple[str, object], Contribution] = {}
    waves: dict[object, Wave] = {}
    pulses = []
    for of, g, X, power in excitation(system) if eps else ():
        matrix = exact(X) * arb(eps) ** power
        if isinstance(g, Impulses):
            pulses += [(of, Fraction(at), matrix * arb(weight)) for at, weight in zip(g.phases, g.weights, strict=True)]
        else:
            wave = waves.setdefault(g, wave_of(g))
            smooth[of, g] = Contribution(of, wave, smooth[of, g].X + matrix if (of, g) in smooth else matrix)
    return list(smooth.values()), pulses


def _second_order(system: PeriodicSystem, Omega: float, eps: float, as_given: bool) -> Equation:
    n = system.size
    smooth, pulses = _contributions(system, eps)
    constant = {of: exact(getattr(system, of)) for of in ("mass", "gyroscopic", "damping", "stiffness")}
    change = hamiltonian_change(system, Omega, eps)
    if change and not as_given:
        constant, smooth, pulses = _made_hamiltonian(constant, smooth, pulses, arb(Omega))
    hamiltonian = change is not None and not (change and as_given)
    start = {of: _at_start(of, constant[of], smooth) for of in ("mass", "gyroscopic")}
    smooth = _without_means(constant, smooth)

    basis = exact(_modal_basis(system))

    def congruent(matrix: arb_mat) -> arb_mat:
        return basis.transpose() * matrix * basis

    M, G, C, K = (congruent(constant[of]) for of in ("mass", "gyroscopic", "damping", "stiffness"))
    inverse = M.inv()  # that it exists proves M and basis nonsingular
    waves = [(of, wave, inverse * congruent(X)) for of, wave, X in smooth]
    damping = inverse * C
    P, Q = inverse * G + damping, inverse * K

    p = norm(P) + _size((wave, X) for of, wave, X in waves if of in ("gyroscopic", "damping"))
    q = norm(Q) + _size((wave, X) for of, wave, X in waves if of == "stiffness")
    # makes the rows p + q / scale and scale alike; the last term is for systems without stiffness
    rate = (p + (p * p + 4 * q).sqrt()) / 2 + arb(Omega) / 16
    scale = arb(2) ** math.frexp(float(rate))[1]

    rows = {"mass": ("E", arb(1)), "stiffness": ("B", -1 / scale)}
    parts = _joined((wave, *rows.get(of, ("A", arb(-1))), X) for of, wave, X in waves)
    zero = arb_mat(n, n)
    kicks: dict[Fraction, arb_mat] = {}
    for of, phase, X in pulses:
        X = inverse * congruent(X)
        row = [zero, X / -scale] if of == "stiffness" else [-X, zero]
        kicks[phase] = kicks.get(phase, arb_mat(2 * n, 2 * n)) + block_matrix([row, [zero, zero]])

    form = None
    if hamiltonian:
        M0, G0 = congruent(start["mass"]), congruent(start["gyroscopic"])
        form = block_matrix([[zero, M0], [-M0, G0 / -scale]])
    mean_growth = None
    if not any(of == "mass" for of, _, _ in waves):
        trace = damping.trace() + _mean_trace((wave, X) for of, wave, X in waves if of == "damping")
        trace += sum(((inverse * congruent(X)).trace() for of, _, X in pulses if of == "damping"), arb(0)) * (
            arb(Omega) / (2 * arb.pi())
        )
        mean_growth = -trace / (2 * n)
    return Equation(
        to_state=block_matrix([[basis, zero], [zero, basis / scale]]),
        scale=scale,
        Omega=arb(Omega),
        A=-P,
        B=Q / -scale,
        parts=parts,
        pulses=kicks,
        form=form,
        skew=True,
        reciprocal=hamiltonian or is_reversible(system, eps),
        mean_growth=mean_growth,
        change=change or 0.0 if hamiltonian else 0.0,
    )


def _made_hamiltonian(
    constant: dict[str, arb_mat],
    smooth: list[Contribution],
    pulses: list[tuple[str, Fraction, arb_mat]],
    Omega: arb,
) -> tuple[dict[str, arb_mat], list[Contribution], list[tuple[str, Fraction, arb_mat]]]:
    """Return the system with C = M', K - K^T = G' and pulses with a skew part of half the jump of G."""

    def symmetric(X: arb_mat) -> arb_mat:
        return (X + X.transpose()) / 2

    kept = [one for one in smooth if one.of in ("mass", "gyroscopic")]
    kept += [one._replace(X=symmetric(one.X)) for one in smooth if one.of == "stiffness"]
    kicks = [(of, phase, symmetric(X)) for of, phase, X in pulses]
    for of, wave, X in smooth:
        if of == "mass":
            kept.append(Contribution("damping", wave.derivative(Omega), X))
        elif of == "gyroscopic":
            kept.append(Contribution("stiffness", wave.derivative(Omega), X / 2))
            for before, after in zip((*wave.pieces[-1:], *wave.pieces), wave.pieces, strict=False):
                jump = _at_end(after, -1) - _at_end(before, 1)
                if not jump.is_zero():
                    kicks.append(("stiffness", after.start, X * (jump / 2)))
    fixed = constant | {"damping": constant["damping"] * 0, "stiffness": symmetric(constant["stiffness"])}
    return fixed, kept, kicks


def _first_order(system: FirstOrderSystem, Omega: float, eps: float) -> Equation:
    N = system.size
    constant = {"state": exact(system.constant)}
    smooth, pulses = _contributions(system, eps)
    smooth = _without_means(constant, smooth)
    largest = np.max(np.abs(coupling(system, eps)), axis=0)
    T = exact(np.diag(matrix_balance(largest, permute=False, separate=True)[1][0]))
    inverse = T.inv()

    def similar(X: arb_mat) -> arb_mat:
        return inverse * X * T

    kicks: dict[Fraction, arb_mat] = {}
    for _, phase, X in pulses:
        kicks[phase] = kicks.get(phase, arb_mat(N, N)) + similar(X)
    trace = constant["state"].trace() + _mean_trace((wave, X) for _, wave, X in smooth)
    trace += sum((X.trace() for _, _, X in pulses), arb(0)) * (arb(Omega) / (2 * arb.pi()))
    found = conserved_form(system, eps)
    form = None if found is None else T * arb_mat([[arb(x) for x in row] for row in found[0]]) * T
    return Equation(
        to_state=T,
        scale=arb(0),
        Omega=arb(Omega),
        A=similar(constant["state"]),
        B=arb_mat(N, N),
        parts=_joined((wave, "A", arb(1), similar(X)) for _, wave, X in smooth),
        pulses=kicks,
        form=form,
        skew=found is not None and found[1] < 0,
        # a single multiplier that is 1 is its own reciprocal
        reciprocal=form is not None or (N == 1 and trace.is_zero()),
        mean_growth=trace / N,
        change=0.0,
    )


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


def _size(parts: Iterable[tuple[Wave, arb_mat]]) -> arb:
    """Return a bound of the norm of a sum of waves."""
    total = arb(0)
    for wave, X in parts:
        largest = sum((abs(c) + abs(s) for c, s in wave.harmonics.values()), arb(0))
        for piece in wave.pieces:
            largest = largest.max(sum(map(abs, piece.coefficients), arb(0)))
        total += norm(X) * largest
    return total


def _mean_trace(parts: Iterable[tuple[Wave, arb_mat]]) -> arb:
    return sum(((wave.mean() + wave.rest * arb(0, 1)) * X.trace() for wave, X in parts), arb(0))


def _at_start(of: str, constant: arb_mat, smooth: list[Contribution]) -> arb_mat:
    """Return the matrix ``of`` just after theta = 0."""
    total = constant
    for name, wave, X in smooth:
        if name == of:
            first = min((piece.start for piece in wave.pieces if piece.start), default=Fraction(1))
            total += X * wave.value(Fraction(0), first / 2)
    return total


def _without_means(constant: dict[str, arb_mat], smooth: list[Contribution]) -> list[Contribution]:
    """Add to the constants what is constant in Fourier sums, and return the rest."""
    found = []
    means: dict[int, Wave] = {}
    for of, wave, X in smooth:
        if 0 in wave.harmonics:
            constant[of] += X * wave.harmonics[0][0]
            moving = {j: pair for j, pair in wave.harmonics.items() if j}
            wave = means.setdefault(id(wave), wave._replace(harmonics=moving))
        if wave.harmonics or wave.pieces or wave.rest:
            found.append(Contribution(of, wave, X))
    return found


def _joined(parts: Iterable[tuple[Wave, str, arb, arb_mat]]) -> list[Part]:
    """Return one part for each wave, from waves with the name of a matrix and factor X as a part of it."""
    found: dict[int, Part] = {}
    for wave, name, factor, X in parts:
        part = found.get(id(wave), Part(wave, None, None, None))
        before = part.matrix(name)
        rest = {other: part.matrix(other) for other in ("E", "A", "B")}
        found[id(wave)] = Part(wave, **rest | {name: X * factor if before is None else before + X * factor})
    return list(found.values())


def _at_end(piece: Piece, x: int) -> arb:
    return sum((c * x**k for k, c in enumerate(piece.coefficients)), arb(0))
